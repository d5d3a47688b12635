use linkwork::mechanism;

/// Andrews' squeezing mechanism: seven bodies in three loops that one motor drives, the best known test of
/// methods for constrained motion.
///
/// Source: Hairer and Wanner, *Solving Ordinary Differential Equations II* (1996), §VI.9; parameters of the
/// Test Set for IVP Solvers (Mazzia and Magherini), problem `andrews`.
///
/// - Coordinates: seven angles `β`, `Θ`, `γ`, `Φ`, `δ`, `Ω`, `ε`, rad. The pins `e3`, `e4` and `e6` close the
///   loops, all at one point of `k2`.
#[mechanism(derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AndrewsSqueezer {
    #[body(mass = 0.04325, com = 92e-5 * x, inertia = diagonal(1.097e-6, 1.097e-6, 2.194e-6))]
    k1: Body,
    #[body(mass = 0.00365, com = -115e-4 * x, inertia = diagonal(2.205e-7, 2.205e-7, 4.410e-7))]
    k2: Body,
    #[body(
        mass = 0.02373, com = 1043e-5 * x - 1874e-5 * y, inertia = diagonal(2.6275e-6, 2.6275e-6, 5.255e-6)
    )]
    k3: Body,
    #[body(mass = 0.00706, com = -(2e-2 - 1421e-5) * y, inertia = diagonal(2.8335e-7, 2.8335e-7, 5.667e-7))]
    k4: Body,
    #[body(mass = 0.07050, com = 2308e-5 * x + 916e-5 * y, inertia = diagonal(5.845e-6, 5.845e-6, 1.169e-5))]
    k5: Body,
    #[body(mass = 0.00706, com = (2e-2 - 1421e-5) * x, inertia = diagonal(2.8335e-7, 2.8335e-7, 5.667e-7))]
    k6: Body,
    #[body(mass = 0.05498, com = -449e-5 * x - 1228e-5 * y, inertia = diagonal(9.56e-6, 9.56e-6, 1.912e-5))]
    k7: Body,

    #[joint(ground -> k1, about = z)]
    beta: Pin,
    #[joint(k1.at(7e-3 * x) -> k2, about = z)]
    theta: Pin,
    #[joint(ground.at(-0.03635 * x + 0.03273 * y) -> k3, about = z)]
    gamma: Pin,
    #[joint(k5.at(4e-2 * x) -> k4, about = z)]
    phi: Pin,
    #[joint(ground.at(-0.06934 * x - 0.00227 * y) -> k5, about = z)]
    delta: Pin,
    #[joint(k7.at(-4e-2 * y) -> k6, about = z)]
    omega_: Pin,
    #[joint(ground.at(-0.06934 * x - 0.00227 * y) -> k7, about = z)]
    epsilon: Pin,
    #[joint(k2.at(-28e-3 * x) -> k3.at(-35e-3 * y), about = z)]
    e3: Pin,
    #[joint(k2.at(-28e-3 * x) -> k4.at(-2e-2 * y), about = z)]
    e4: Pin,
    #[joint(k2.at(-28e-3 * x) -> k6.at(2e-2 * x), about = z)]
    e6: Pin,

    #[acts(on = beta, value = 0.033)]
    motor: Torque,
    #[acts(
        between = (ground.at(0.014 * x + 0.072 * y), k3.at(2e-2 * x - 18e-3 * y)), stiffness = 4530,
        free_length = 7785e-5
    )]
    spring: Spring,
}

impl AndrewsSqueezer {
    /// Initial configuration in the problem of the test set, at rest, with closed loops.
    pub const START: [f64; 7] = [
        -0.061_713_890_014_276_45,
        0.0,
        0.455_279_819_163_070_38,
        0.222_668_390_165_885_88,
        0.487_364_979_543_842_55,
        -0.222_668_390_165_885_88,
        1.230_547_444_549_821_2,
    ];
}
