use super::{Table, TableError};
use crate::Real;
use crate::lanes::{Lanes, f64x4};

static X: [f64; 5] = [-1.0, 0.0, 0.5, 2.0, 3.5];
static Y: [f64; 4] = [0.0, 1.0, 1.5, 4.0];
static Z: [f64; 3] = [-2.0, -1.0, 1.0];

/// Returns a function that is quadratic in each variable.
fn biquadratic_function(x: f64, y: f64, z: f64) -> f64 {
    (1.0 + 2.0 * x - 0.5 * x * x) * (0.3 - y + 0.2 * y * y) + x * z - 0.7 * z * z * y
}

fn three_axis_grid_table() -> Table<3> {
    let mut values = std::vec::Vec::new();
    for x in X {
        for y in Y {
            values.extend(Z.map(|z| biquadratic_function(x, y, z)));
        }
    }
    Table::new([&X, &Y, &Z], values.leak()).unwrap()
}

#[test]
fn linear_table_interpolates_its_values() {
    let table = three_axis_grid_table();
    for (x, y, z) in [(0.0, 1.0, -1.0), (3.5, 4.0, 1.0), (-1.0, 0.0, -2.0)] {
        assert!((table.value::<f64>([x, y, z]) - biquadratic_function(x, y, z)).abs() < 1e-14);
    }
    let (a, b) = (table.value([0.5, 1.0, 1.0]), table.value([2.0, 1.0, 1.0]));
    assert!((table.value::<f64>([1.0, 1.0, 1.0]) - (a + (b - a) / 3.0)).abs() < 1e-14);
    assert!((table.slope::<f64>([1.0, 1.0, 1.0], 0) - (b - a) / 1.5).abs() < 1e-14);
}

#[test]
fn smooth_table_is_exact_for_parabolas() {
    let table = three_axis_grid_table().smooth();
    for k in 0..40 {
        let t = f64::from(k) / 39.0;
        let (x, y, z) = (-1.0 + 4.5 * t, 4.0 * (1.0 - t), -2.0 + 3.0 * t * t);
        assert!((table.value::<f64>([x, y, z]) - biquadratic_function(x, y, z)).abs() < 1e-12, "{x} {y} {z}");
        let slope = (2.0 - x) * (0.3 - y + 0.2 * y * y) + z;
        assert!((table.slope::<f64>([x, y, z], 0) - slope).abs() < 1e-12);
        let mixed = (2.0 - x) * (-1.0 + 0.4 * y);
        assert!((table.derivative([x, y, z], [1, 1, 0]) - mixed).abs() < 1e-12);
        let second = -(0.3 - y + 0.2 * y * y);
        assert!((table.derivative([x, y, z], [2, 0, 0]) - second).abs() < 1e-11);
        assert!(table.derivative([x, y, z], [3, 0, 0]).abs() < 1e-10);
    }
}

#[test]
fn slopes_of_a_smooth_table_are_continuous() {
    static WAVY: [f64; 5] = [0.0, 1.0, -2.0, 0.5, 4.0];
    let table = Table::new([&X], &WAVY).unwrap().smooth().extrapolated();
    for x in X {
        let (before, after) = (table.slope([x - 1e-9], 0), table.slope([x + 1e-9], 0));
        assert!((before - after).abs() < 1e-6, "{before} and {after} at {x}");
        assert!((table.value::<f64>([x - 1e-12]) - table.value([x + 1e-12])).abs() < 1e-10);
    }
    // The slopes agree with differences of the values.
    for x in [-1.7, -0.3, 0.2, 1.1, 2.9, 5.0] {
        let h = 1e-6;
        let change = (table.value::<f64>([x + h]) - table.value([x - h])) / (2.0 * h);
        assert!((table.slope::<f64>([x], 0) - change).abs() < 1e-8, "{x}");
    }
}

#[test]
fn extrapolation_beyond_grid_is_as_selected() {
    for table in [three_axis_grid_table(), three_axis_grid_table().smooth()] {
        let edge = table.value([3.5, 1.0, 0.0]);
        assert_eq!(table.value([9.0, 1.0, 0.0]), edge);
        assert_eq!(table.slope([9.0, 1.0, 0.0], 0), 0.0);
        let line = table.extrapolated();
        let slope = table.slope([3.5, 1.0, 0.0], 0);
        assert!((line.value::<f64>([4.5, 1.0, 0.0]) - (edge + slope)).abs() < 1e-12);
        assert!((line.slope::<f64>([4.5, 1.0, 0.0], 0) - slope).abs() < 1e-12);
        assert!(table.value([f64::NAN, 1.0, 0.0]).is_nan());
        assert!(line.slope([1.0, f64::NAN, 0.0], 0).is_nan());
    }
}

#[test]
fn lanes_are_looked_up_separately() {
    let x = [-3.0, 0.2, 0.5, 9.0];
    let (y, z) = ([0.1, 3.0, 1.0, 1.2], [0.0, -1.5, 1.0, 0.3]);
    for table in [
        three_axis_grid_table(),
        three_axis_grid_table().smooth(),
        three_axis_grid_table().extrapolated(),
        three_axis_grid_table().smooth().extrapolated(),
    ] {
        for orders in [[0, 0, 0], [1, 0, 0], [0, 1, 1], [2, 0, 0]] {
            let all: f64x4 = table.derivative([Lanes(x), Lanes(y), Lanes(z)], orders);
            for lane in 0..4 {
                let one = table.derivative([x[lane], y[lane], z[lane]], orders);
                assert!((all.0[lane] - one).abs() < 1e-12, "{orders:?} {lane}: {} {one}", all.0[lane]);
            }
        }
    }
}

#[test]
fn table_lookup_works_in_single_precision() {
    fn smooth_table_value<T: Real>(x: f64) -> f64 {
        let x = crate::private::constant::<T>(x);
        crate::private::to_f64(three_axis_grid_table().smooth().value([x, x, x]))
    }
    assert!((smooth_table_value::<f32>(0.7) - smooth_table_value::<f64>(0.7)).abs() < 1e-5);
}

#[test]
fn invalid_tables_are_rejected() {
    static ONE: [f64; 1] = [1.0];
    static BACK: [f64; 3] = [0.0, 2.0, 1.0];
    static HOLE: [f64; 2] = [0.0, f64::NAN];
    static TWO: [f64; 2] = [0.0, 1.0];
    let construction_error =
        |axes: [&'static [f64]; 1], values: &'static [f64]| Table::new(axes, values).err();
    assert_eq!(construction_error([&ONE], &ONE), Some(TableError::TooFewPoints { axis: 0 }));
    assert_eq!(construction_error([&BACK], &BACK), Some(TableError::NotIncreasing { axis: 0, place: 2 }));
    assert_eq!(construction_error([&HOLE], &TWO), Some(TableError::NotIncreasing { axis: 0, place: 1 }));
    assert_eq!(construction_error([&TWO], &HOLE), Some(TableError::NotFinite { place: 1 }));
    assert_eq!(construction_error([&TWO], &BACK), Some(TableError::Size { expected: 2, found: 3 }));
    let said = std::string::ToString::to_string(&TableError::Size { expected: 2, found: 3 });
    assert_eq!(said, "the grid of the table has 2 points, but there are 3 values");
}
