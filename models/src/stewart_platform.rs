use linkwork::mechanism;

/// Macro that declares the legs of the platform: for each leg, the fields of its two halves and its joints,
/// and the angles of its ends.
macro_rules! stewart_platform {
    ($($lower:ident $upper:ident $foot:ident $slide:ident $head:ident $force:ident ($a:literal, $b:literal)),+) => {
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
            $(
                #[body(mass = leg_mass, com = leg / 2 * z, inertia = rod(leg_mass, leg, z))]
                $lower: Body,
                #[body(mass = leg_mass, com = -leg / 2 * z, inertia = rod(leg_mass, leg, z))]
                $upper: Body,
                #[joint(
                    ground.at(base_radius * (cos($a * pi / 180) * x + sin($a * pi / 180) * y)) -> $lower,
                    about = (x, y)
                )]
                $foot: Universal,
                #[joint($lower -> $upper, along = z)]
                $slide: Sleeve,
                #[joint(
                    $upper -> platform.at(platform_radius * (cos($b * pi / 180) * x + sin($b * pi / 180) * y))
                )]
                $head: Ball,
                #[acts(on = $slide)]
                $force: Force,
            )+
        }
    };
}

stewart_platform! {
    lower1 upper1 foot1 slide1 head1 force1 (10, 50),
    lower2 upper2 foot2 slide2 head2 force2 (110, 70),
    lower3 upper3 foot3 slide3 head3 force3 (130, 170),
    lower4 upper4 foot4 slide4 head4 force4 (230, 190),
    lower5 upper5 foot5 slide5 head5 force5 (250, 290),
    lower6 upper6 foot6 slide6 head6 force6 (350, 310)
}
