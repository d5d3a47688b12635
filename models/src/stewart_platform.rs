use linkwork::mechanism;

/// Stewart platform: six legs of variable length support and move a free platform. Also called a
/// hexapod; Gough's tyre testing machine and flight simulators are its best known uses.
///
/// Source: Stewart, *A platform with six degrees of freedom*, Proc. Inst. Mech. Eng. 180 (1965);
/// Merlet, *Parallel Robots* (2006), ch. 3 and 9.
///
/// - Coordinates of a leg: `foot.first` and `foot.second`, angles about x and the rotated y, rad, and
///   `slide`, its length, m. The ball joints `head` close the loops. Of the platform: position and
///   unit quaternion of `pose`. z points up.
/// - Inputs: the forces along the legs, N.
/// - Inverse kinematics: with the platform at `p`, `R` a leg has the length `|p + R bᵢ − aᵢ|`, where
///   `aᵢ` and `bᵢ` are on circles of the two radii.
/// - Statics: with `nᵢ` along the legs, `Σ fᵢ (nᵢ, R bᵢ × nᵢ)` is the force and torque on the load.
#[mechanism(gravity = -g * z)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StewartPlatform {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Radius of the circle of the feet, m.
    pub base_radius: f64,
    /// Radius of the circle of the heads on the platform, m.
    pub platform_radius: f64,
    /// Mass of the platform, kg.
    pub platform_mass: f64,
    /// Moment of inertia of the platform about x and y, kg·m².
    pub across: f64,
    /// Moment of inertia of the platform about z, kg·m².
    pub axial: f64,
    /// Mass of each half of a leg, kg.
    pub leg_mass: f64,
    /// Length of each half of a leg, m.
    pub leg: f64,

    #[body(mass = platform_mass, inertia = diagonal(across, across, axial))]
    platform: Body,
    #[joint(ground -> platform)]
    pose: Free,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower1: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper1: Body,
    #[joint(
        ground.at(base_radius * (cos(10 * pi / 180) * x + sin(10 * pi / 180) * y)) -> lower1,
        about = (x, y)
    )]
    foot1: Universal,
    #[joint(lower1 -> upper1, along = z)]
    slide1: Sleeve,
    #[joint(
        upper1 -> platform.at(platform_radius * (cos(50 * pi / 180) * x + sin(50 * pi / 180) * y))
    )]
    head1: Ball,
    #[acts(on = slide1)]
    force1: Force,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower2: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper2: Body,
    #[joint(
        ground.at(base_radius * (cos(110 * pi / 180) * x + sin(110 * pi / 180) * y)) -> lower2,
        about = (x, y)
    )]
    foot2: Universal,
    #[joint(lower2 -> upper2, along = z)]
    slide2: Sleeve,
    #[joint(
        upper2 -> platform.at(platform_radius * (cos(70 * pi / 180) * x + sin(70 * pi / 180) * y))
    )]
    head2: Ball,
    #[acts(on = slide2)]
    force2: Force,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower3: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper3: Body,
    #[joint(
        ground.at(base_radius * (cos(130 * pi / 180) * x + sin(130 * pi / 180) * y)) -> lower3,
        about = (x, y)
    )]
    foot3: Universal,
    #[joint(lower3 -> upper3, along = z)]
    slide3: Sleeve,
    #[joint(
        upper3 -> platform.at(platform_radius * (cos(170 * pi / 180) * x + sin(170 * pi / 180) * y))
    )]
    head3: Ball,
    #[acts(on = slide3)]
    force3: Force,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower4: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper4: Body,
    #[joint(
        ground.at(base_radius * (cos(230 * pi / 180) * x + sin(230 * pi / 180) * y)) -> lower4,
        about = (x, y)
    )]
    foot4: Universal,
    #[joint(lower4 -> upper4, along = z)]
    slide4: Sleeve,
    #[joint(
        upper4 -> platform.at(platform_radius * (cos(190 * pi / 180) * x + sin(190 * pi / 180) * y))
    )]
    head4: Ball,
    #[acts(on = slide4)]
    force4: Force,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower5: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper5: Body,
    #[joint(
        ground.at(base_radius * (cos(250 * pi / 180) * x + sin(250 * pi / 180) * y)) -> lower5,
        about = (x, y)
    )]
    foot5: Universal,
    #[joint(lower5 -> upper5, along = z)]
    slide5: Sleeve,
    #[joint(
        upper5 -> platform.at(platform_radius * (cos(290 * pi / 180) * x + sin(290 * pi / 180) * y))
    )]
    head5: Ball,
    #[acts(on = slide5)]
    force5: Force,

    #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    lower6: Body,
    #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
    upper6: Body,
    #[joint(
        ground.at(base_radius * (cos(350 * pi / 180) * x + sin(350 * pi / 180) * y)) -> lower6,
        about = (x, y)
    )]
    foot6: Universal,
    #[joint(lower6 -> upper6, along = z)]
    slide6: Sleeve,
    #[joint(
        upper6 -> platform.at(platform_radius * (cos(310 * pi / 180) * x + sin(310 * pi / 180) * y))
    )]
    head6: Ball,
    #[acts(on = slide6)]
    force6: Force,
}
