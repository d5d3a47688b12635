//! An error in a mechanism with a loop is not reported again at uses of the mechanism.

use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * y)]
struct SliderCrank {
    r: f64,
    l: f64,
    #[body(mass = 1, com = r / 2 * x, inertia = rod(1, r, x))]
    crank: Body,
    #[body(mass = 1, com = l / 2 * x, inertia = rod(1, ll, x))]
    rod: Body,
    #[body(mass = 1)]
    piston: Body,
    #[joint(ground -> crank, about = z)]
    main: Pin,
    #[joint(crank.at(r * x) -> rod, about = z)]
    big_end: Pin,
    #[joint(ground -> piston, along = x)]
    cylinder: Sleeve,
    #[joint(rod.at(l * x) -> piston, about = z)]
    small_end: Pin,
    #[acts(on = main)]
    motor: Torque,
    #[output(reaction_force(small_end))]
    load: Vector,
}

fn main() {
    let slider = SliderCrank { r: 0.1, l: 0.3 };
    let q = slider.assemble(&SVector::from([0.3, -0.4, 0.4]), &[0]).unwrap();
    let v = slider.project_velocity(&q, &SVector::from([1.0, 0.0, 0.0])).unwrap();
    let v = slider.complete_velocity(&q, &v, &[0]).unwrap();
    let (a, _) = slider.constrained_dynamics(&q, &v, &SVector::zeros());
    let rates = slider.constraint_rates(&q, &a);
    let load = slider.load(&q, &v, &SVector::from([0.0]));
    println!("{rates} {load}");
    let _ = simulate(&slider).from(q, v).duration(1.0).finish();
}
