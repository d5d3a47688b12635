//! Mechanisms with prescribed positions, velocities and accelerations: loops without a degree of freedom,
//! forces of drives and bearings over a turn, and the assembly of linkages.

mod assembly;
mod cam;
mod four_bar;
mod frames;
mod jansen;
mod prelude;
mod slider_crank;
mod yoke;

/// Returns the derivative of a function of time, by central differences of order six.
fn time_derivative(f: impl Fn(f64) -> f64, t: f64) -> f64 {
    let h = 2e-3;
    let odd_difference = |k: f64| f(t + k * h) - f(t - k * h);
    (45.0 * odd_difference(1.0) - 9.0 * odd_difference(2.0) + odd_difference(3.0)) / (60.0 * h)
}
