//! Leg of Jansen's Strandbeest on a crank with a given speed: eleven bars, the conditions of six loops, no
//! degree of freedom.

use linkwork::prelude::*;
use support::compare::assert_close;

#[mechanism(gravity = -9.81 * y)]
struct Leg {
    speed: f64,
    #[frame(ground, z(speed * t))]
    turned: Frame,
    #[body(mass = 0.1, com = 0.075 * x, inertia = rod(0.1, 0.15, x), frame = turned)]
    crank: Body,
    /// Upper triangle of the leg. The x axis is along its upper bar from the fixed pivot; the left corner
    /// follows from its distances.
    #[body(mass = 0.9, com = 0.2 * x + 0.13 * y, inertia = diagonal(0.02, 0.02, 0.03))]
    upper: Body,
    #[body(mass = 0.4, com = 0.1965 * x, inertia = rod(0.4, 0.393, x))]
    lower: Body,
    #[body(mass = 1.1, com = 0.2 * x + 0.2 * y, inertia = diagonal(0.03, 0.03, 0.05))]
    foot: Body,
    #[body(mass = 0.5, com = 0.25 * x, inertia = rod(0.5, 0.5, x))]
    to_upper: Body,
    #[body(mass = 0.6, com = 0.3095 * x, inertia = rod(0.6, 0.619, x))]
    to_lower: Body,
    #[body(mass = 0.4, com = 0.197 * x, inertia = rod(0.4, 0.394, x))]
    coupling: Body,
    #[joint(ground.at(-0.38 * x - 0.078 * y) -> upper, about = z)]
    upper_pivot: Pin,
    #[joint(ground.at(-0.38 * x - 0.078 * y) -> lower, about = z)]
    lower_pivot: Pin,
    #[joint(lower.at(0.393 * x) -> foot, about = z)]
    ankle: Pin,
    #[joint(crank.at(0.15 * x) -> to_upper, about = z)]
    upper_pin: Pin,
    #[joint(crank.at(0.15 * x) -> to_lower, about = z)]
    lower_pin: Pin,
    #[joint(upper.at(0.0260987951807229 * x + 0.400149788067062 * y) -> coupling, about = z)]
    knee: Pin,
    #[joint(to_upper.at(0.5 * x) -> upper.at(0.415 * x), about = z)]
    first: Pin,
    #[joint(to_lower.at(0.619 * x) -> lower.at(0.393 * x), about = z)]
    second: Pin,
    #[joint(coupling.at(0.394 * x) -> foot.at(0.367 * x), about = z)]
    third: Pin,
    #[output(crank)]
    on_crank: FreeBody,
    #[output(r(foot.at(-0.07746594 * x + 0.48383781 * y) / ground))]
    toe: Vector,
}

pub type Point = [f64; 2];

/// Returns the third corner of a triangle over `a` and `b` from its distances to them. The corner is to the
/// left of the direction from `a` to `b` if `side` is 1.
pub fn triangle_corner_from_sides(a: Point, b: Point, from_a: f64, from_b: f64, side: f64) -> Point {
    let d = [b[0] - a[0], b[1] - a[1]];
    let square = d[0] * d[0] + d[1] * d[1];
    let along = (from_a * from_a - from_b * from_b + square) / (2.0 * square);
    let across = side * (from_a * from_a / square - along * along).sqrt();
    [a[0] + along * d[0] - across * d[1], a[1] + along * d[1] + across * d[0]]
}

/// Returns the ground coordinates of a body's point (`x`, `y`), in the body's frame with origin `a` and x
/// axis towards `b`.
fn ground_coordinates_of_body_point(a: Point, b: Point, x: f64, y: f64) -> Point {
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let e = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    [a[0] + x * e[0] - y * e[1], a[1] + x * e[1] + y * e[0]]
}

/// Bars with their masses, centres of mass, moments of inertia and ends.
struct LegBars(Vec<(f64, Point, f64, [Point; 2])>);

/// Returns the bars of the leg at an angle of the crank. Their joints are intersections of circles.
fn bars_at_crank_angle(angle: f64) -> LegBars {
    let (pivot, centre) = ([-0.38, -0.078], [0.0, 0.0]);
    let pin = [0.15 * angle.cos(), 0.15 * angle.sin()];
    let top = triangle_corner_from_sides(pivot, pin, 0.415, 0.5, 1.0);
    let left = ground_coordinates_of_body_point(pivot, top, 0.026_098_795_180_722_9, 0.400_149_788_067_062);
    let bottom = triangle_corner_from_sides(pivot, pin, 0.393, 0.619, -1.0);
    let rear = triangle_corner_from_sides(left, bottom, 0.394, 0.367, -1.0);
    let rod_inertia = |m: f64, l: f64| m * l * l / 12.0;
    LegBars(vec![
        (0.1, [0.075, 0.0], rod_inertia(0.1, 0.15), [centre, pin]),
        (0.9, [0.2, 0.13], 0.03, [pivot, top]),
        (0.4, [0.1965, 0.0], rod_inertia(0.4, 0.393), [pivot, bottom]),
        (1.1, [0.2, 0.2], 0.05, [bottom, rear]),
        (0.5, [0.25, 0.0], rod_inertia(0.5, 0.5), [pin, top]),
        (0.6, [0.3095, 0.0], rod_inertia(0.6, 0.619), [pin, bottom]),
        (0.4, [0.197, 0.0], rod_inertia(0.4, 0.394), [left, rear]),
    ])
}

impl LegBars {
    fn angle_of_bar(&self, k: usize) -> f64 {
        let [a, b] = self.0[k].3;
        (b[1] - a[1]).atan2(b[0] - a[0])
    }

    fn center_of_bar(&self, k: usize) -> Point {
        let (_, com, _, [a, b]) = self.0[k];
        ground_coordinates_of_body_point(a, b, com[0], com[1])
    }
}

/// Returns the energy, with velocities from differences of the corners.
fn energy_at_time(speed: f64, t: f64) -> f64 {
    let time_derivative = |f: &dyn Fn(f64) -> f64| super::time_derivative(|t| f(speed * t), t);
    let here = bars_at_crank_angle(speed * t);
    let mut sum = 0.0;
    for (k, (mass, _, inertia, _)) in here.0.iter().enumerate() {
        let v = [0, 1].map(|i| time_derivative(&|angle| bars_at_crank_angle(angle).center_of_bar(k)[i]));
        // The difference starts at the current angle, so that no jump by a whole turn occurs.
        let base = here.angle_of_bar(k);
        let w = time_derivative(&|angle| {
            let turned = bars_at_crank_angle(angle).angle_of_bar(k) - base;
            turned.sin().atan2(turned.cos())
        });
        sum += mass * ((v[0] * v[0] + v[1] * v[1]) / 2.0 + 9.81 * here.center_of_bar(k)[1])
            + inertia * w * w / 2.0;
    }
    sum
}

/// The power of the crank equals the rate of the energy over a whole turn in which the leg stays in its
/// assembly mode.
#[test]
fn crank_power_equals_the_rate_of_energy() {
    assert_eq!((Leg::NV, Leg::NC, Leg::NS), (6, 6, 0));
    let speed = 2.0;
    let m = Leg { speed };
    let mut last: Option<SVector<f64, 6>> = None;
    for k in 0..=24 {
        let t = f64::from(k) * std::f64::consts::TAU / speed / 24.0;
        let s = bars_at_crank_angle(speed * t);
        let relative_angle = |k: usize, of: f64| {
            let angle = s.angle_of_bar(k) - of;
            angle.sin().atan2(angle.cos())
        };
        // The first guess follows from the corners, each later one from the previous instant.
        let turned = speed * t;
        let corners = [
            s.angle_of_bar(1),
            s.angle_of_bar(2),
            relative_angle(3, s.angle_of_bar(2)),
            relative_angle(4, turned),
            relative_angle(5, turned),
            relative_angle(6, s.angle_of_bar(1)),
        ];
        let q = m.assemble(t, &last.unwrap_or(corners.into()), &[]).unwrap();
        last = Some(q);
        for (found, corner) in q.iter().zip(corners) {
            let off = found - corner;
            assert!(off.sin().atan2(off.cos()).abs() < 1e-7, "{k}: {q} {corners:?}");
        }
        let v = m.project_velocity(t, &q, &SVector::zeros()).unwrap();
        let total_energy = |t: f64| energy_at_time(speed, t);
        let found = m.kinetic_energy(t, &q, &v) + m.potential_energy(t, &q);
        assert_close("energy", &[found], &[total_energy(t)], 1e-6);
        let place = *m.on_crank(t, &q, &v).get("crank.place").unwrap();
        assert_close("power", &[place.torque[2] * speed], &[super::time_derivative(total_energy, t)], 1e-5);
    }
}
