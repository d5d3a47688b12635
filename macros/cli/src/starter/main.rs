//! Cart on a rail with a pole: the starting point for the user's own mechanism.

use linkwork::prelude::*;
use linkwork_view::{Motion, Page};

/// The type of a field declares what it is, its attribute where it is attached. Fields of plain numbers are
/// parameters.
#[mechanism(gravity = -9.81 * y, drawing)]
pub struct CartPole {
    pub pole_length: f64,

    #[body(mass = 1, inertia = cuboid(1, 0.3, 0.15, 0.2))]
    cart: Body,
    #[body(mass = 0.1, com = pole_length / 2 * y, inertia = rod(0.1, pole_length, y))]
    pole: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[joint(cart -> pole, about = z)]
    hinge: Pin,
    #[acts(on = hinge, damping = 0.005)]
    bearing: Dashpot,
    /// Input, which is an entry of `u`.
    #[acts(on = cart, along = x)]
    push: Force,
}

/// Returns a page that shows how the pole falls, and how a controller keeps it upright.
pub fn cart_pole_page() -> Result<Page, Box<dyn std::error::Error>> {
    let cart_pole = CartPole { pole_length: 1.0 };
    // Initial configuration q and velocity v, whose entries are named by `CartPole::CONFIGURATION` and
    // `CartPole::VELOCITIES`.
    let simulate_cart_pole =
        || simulate(&cart_pole).from([0.0, 0.2], [0.0, 0.0]).duration(8.0).sample_every(1.0 / 60.0);
    let falls: Vec<_> = simulate_cart_pole().collect::<Result<_, _>>()?;
    // At positive angles the pole leans to the left, and the cart must follow it.
    let cart_pole_controller =
        |_t, q: &SVector<f64, 2>, v: &SVector<f64, 2>| [q[0] + 2.0 * v[0] - 30.0 * q[1] - 8.0 * v[1]].into();
    let stands: Vec<_> = simulate_cart_pole().inputs(cart_pole_controller).collect::<Result<_, _>>()?;
    let page = Page::new("A cart with a pole")
        .text("Drag to rotate, scroll to zoom; the space bar plays and stops.");
    let falls = Motion::of("It falls", &cart_pole, &falls)?.trail("pole", [0.0, 1.0, 0.0], 1.0)?;
    Ok(page.motion(falls).motion(Motion::of("It is kept upright", &cart_pole, &stands)?))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{}", CartPole::EQUATIONS);
    cart_pole_page()?.write("motion.html")?;
    println!("Open motion.html in a browser.");
    Ok(())
}
