//! Test mechanisms in the struct language: one for every type of joint, the equivalent chains of pins and
//! sleeves, one with every force element, and one with a free base.

use linkwork::mechanism;

/// Declares two bodies: a carrier on a pin, and a body on the carrier with the given joint. No axes or points
/// are aligned.
macro_rules! carried {
    ($(#[$doc:meta])* $name:ident: $joint:ident $(, $argument:ident = $value:tt)*) => {
        $(#[$doc])*
        #[mechanism(gravity = 0.3 * x - 0.4 * y - 9.7 * z)]
        pub struct $name {
            #[body(
                mass = 1.3,
                com = 0.1 * x - 0.2 * y + 0.05 * z,
                inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]]
            )]
            carrier: Body,
            #[body(
                mass = 0.7,
                com = [0.02, 0.15, -0.1],
                inertia = diagonal(0.011, 0.017, 0.013).rotated(z(0.3), x(0.7))
            )]
            carried: Body,
            #[joint(ground.at(0.2 * x + 0.1 * z).rotated(x(0.2)) -> carrier.at(0.3 * y), about = y)]
            pivot: Pin,
            #[joint(
                carrier.at([0.1, 0.2, 0.3]).rotated(z(0.4), x(-0.3))
                    -> carried.at(-0.1 * x + 0.05 * y).rotated(y(0.5), z(1.1))
                $(, $argument = $value)*
            )]
            joint: $joint,
        }
    };
}

/// Declares the same two bodies with a chain of massless bodies between them, the last of which is called
/// `last`.
macro_rules! chained {
    ($(#[$doc:meta])* $name:ident: $($between:tt)*) => {
        $(#[$doc])*
        #[mechanism(gravity = 0.3 * x - 0.4 * y - 9.7 * z)]
        pub struct $name {
            #[body(
                mass = 1.3,
                com = 0.1 * x - 0.2 * y + 0.05 * z,
                inertia = [[0.03, 0.002, -0.001], [0.002, 0.04, 0.003], [-0.001, 0.003, 0.05]]
            )]
            carrier: Body,
            #[body]
            socket: Body,
            #[body]
            last: Body,
            #[body(
                mass = 0.7,
                com = [0.02, 0.15, -0.1],
                inertia = diagonal(0.011, 0.017, 0.013).rotated(z(0.3), x(0.7))
            )]
            carried: Body,
            #[joint(ground.at(0.2 * x + 0.1 * z).rotated(x(0.2)) -> carrier.at(0.3 * y), about = y)]
            pivot: Pin,
            #[joint(carrier.at([0.1, 0.2, 0.3]).rotated(z(0.4), x(-0.3)) -> socket)]
            seat: Weld,
            $($between)*
            #[joint(last -> carried.at(-0.1 * x + 0.05 * y).rotated(y(0.5), z(1.1)))]
            plug: Weld,
        }
    };
}

carried! {
    /// Body on a pin (revolute joint), which is carried by another body.
    OnPin: Pin, about = x
}
carried! {
    /// Test body on a pin about a slanted axis.
    OnSlantedPin: Pin, about = [0.6, 0, -0.8]
}
carried! {
    /// Body on a sleeve (prismatic joint), which is carried by another body.
    OnSleeve: Sleeve, along = y
}
carried! {
    /// Body on a screw that advances 0.05 m per radian.
    OnScrew: Screw, about = z, pitch = 0.05
}
carried! {
    /// Body on a screw that advances 0.3 m per turn.
    OnScrewWithLead: Screw, along = z, lead = 0.3
}
carried! {
    /// Body on a collar (cylindrical joint), which is carried by another body.
    OnCollar: Collar, about = z
}
carried! {
    /// Body on a slot joint, which translates along one axis and rotates about another.
    OnSlot: Slot, along = x, about = z
}
carried! {
    /// Body on a universal joint, which is carried by another body.
    OnUniversal: Universal, about = (x, y)
}
carried! {
    /// Body on a ball joint, which is carried by another body.
    OnBall: Ball
}
carried! {
    /// Body on a planar joint that is declared by its normal.
    OnPlanar: Planar, about = z
}
carried! {
    /// Body on a planar joint, given by its two directions of translation.
    OnPlanarAlong: Planar, along = (x, y)
}
carried! {
    /// Test body on a stage that translates along two axes.
    OnStage: Stage, along = (x, y)
}
carried! {
    /// Test body on a stage that translates along three axes.
    OnStage3: Stage, along = (x, y, z)
}
carried! {
    /// Body that moves freely relative to a carrier, which moves itself.
    OnFree: Free
}
carried! {
    /// Test body that is welded to a moving carrier.
    OnWeld: Weld
}

chained! {
    /// Bodies connected by a sleeve joint and by a pin about its axis, equivalent to one `Collar` joint.
    ChainedCollar:
    #[body] slider: Body,
    #[joint(socket -> slider, along = z)] slide: Sleeve,
    #[joint(slider -> last, about = z)] turn: Pin,
}
chained! {
    /// Bodies connected by a sleeve joint and by a pin normal to its axis, equivalent to one `Slot` joint.
    ChainedSlot:
    #[body] slider: Body,
    #[joint(socket -> slider, along = x)] slide: Sleeve,
    #[joint(slider -> last, about = z)] turn: Pin,
}
chained! {
    /// Bodies connected by two pins with perpendicular axes, equivalent to one `Universal` joint.
    ChainedUniversal:
    #[body] cross: Body,
    #[joint(socket -> cross, about = x)] first: Pin,
    #[joint(cross -> last, about = y)] second: Pin,
}
chained! {
    /// Bodies connected by two sleeve joints and a pin, equivalent to one `Planar` joint.
    ChainedPlanar:
    #[body] slide1: Body,
    #[body] slide2: Body,
    #[joint(socket -> slide1, along = x)] sx: Sleeve,
    #[joint(slide1 -> slide2, along = y)] sy: Sleeve,
    #[joint(slide2 -> last, about = z)] angle: Pin,
}
chained! {
    /// Bodies connected by two sleeve joints, equivalent to one `Stage` joint with two axes.
    ChainedStage:
    #[body] slide1: Body,
    #[joint(socket -> slide1, along = x)] sx: Sleeve,
    #[joint(slide1 -> last, along = y)] sy: Sleeve,
}
chained! {
    /// Bodies connected by three sleeve joints, equivalent to one `Stage` joint with three axes.
    ChainedStage3:
    #[body] slide1: Body,
    #[body] slide2: Body,
    #[joint(socket -> slide1, along = x)] sx: Sleeve,
    #[joint(slide1 -> slide2, along = y)] sy: Sleeve,
    #[joint(slide2 -> last, along = z)] sz: Sleeve,
}
chained! {
    /// Ball joint modelled as a chain of three pins.
    ChainedBall:
    #[body] ring1: Body,
    #[body] ring2: Body,
    #[joint(socket -> ring1, about = z)] yaw: Pin,
    #[joint(ring1 -> ring2, about = y)] pitch: Pin,
    #[joint(ring2 -> last, about = x)] roll: Pin,
}
chained! {
    /// Free joint as a chain of a stage and three pins.
    ChainedFree:
    #[body] table: Body,
    #[body] ring1: Body,
    #[body] ring2: Body,
    #[joint(socket -> table, along = (x, y, z))] stage: Stage,
    #[joint(table -> ring1, about = z)] yaw: Pin,
    #[joint(ring1 -> ring2, about = y)] pitch: Pin,
    #[joint(ring2 -> last, about = x)] roll: Pin,
}

/// Mechanism with springs and dashpots on every kind of coordinate, and inputs on joints, bodies and points
/// of bodies.
#[mechanism(gravity = -g * y)]
pub struct CoordinateForceMechanism {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the arm, kg.
    pub m: f64,
    /// Length of the arm, m.
    pub l: f64,
    /// Stiffness of the spring in the shoulder, N·m/rad.
    pub shoulder_stiffness: f64,
    /// Angle at which the spring in the shoulder is slack, rad.
    pub shoulder_rest: f64,
    /// Damping coefficient of the joint in the shoulder, N·m·s/rad.
    pub shoulder_damping: f64,
    /// Stiffness of the spring along the track, N/m.
    pub track_stiffness: f64,
    /// Free length of the spring along the track, m.
    pub track_length: f64,
    /// Damping coefficient of translation along the track, N·s/m.
    pub slide_damping: f64,
    /// Damping coefficient of rotation on the track, N·m·s/rad.
    pub turn_damping: f64,

    #[body(mass = m, com = l / 2 * x, inertia = rod(m, l, x))]
    arm: Body,
    #[body(mass = m / 2, com = 0.02 * z, inertia = cuboid(m / 2, 0.2, 0.1, 0.3))]
    carriage: Body,
    #[particle(mass = m / 4, at = carriage.at(0.1 * y + 0.05 * z))]
    tip: Particle,
    #[joint(ground -> arm, about = z)]
    shoulder: Pin,
    #[joint(arm.at(l * x).rotated(y(0.4)) -> carriage, along = x, about = y)]
    track: Slot,

    #[acts(on = shoulder, stiffness = shoulder_stiffness, free_angle = shoulder_rest)]
    shoulder_spring: Spring,
    #[acts(on = track.slide, stiffness = track_stiffness, free_length = track_length)]
    track_spring: Spring,
    #[acts(on = shoulder, damping = shoulder_damping)]
    shoulder_dashpot: Dashpot,
    #[acts(on = track.slide, damping = slide_damping)]
    slide_dashpot: Dashpot,
    #[acts(on = track.turn, damping = turn_damping)]
    turn_dashpot: Dashpot,

    #[acts(on = shoulder)]
    motor: Torque,
    #[acts(on = track.slide)]
    drive: Force,
    #[acts(on = track.turn)]
    spin: Torque,
    #[acts(on = carriage.at(0.1 * y + 0.05 * z), along = x)]
    thrust: Force,
    #[acts(on = carriage.at(0.1 * y + 0.05 * z), along = ground.y)]
    lift: Force,
    #[acts(on = carriage, about = z)]
    wheel: Torque,
    #[acts(on = carriage, about = 0.6 * ground.z - 0.8 * ground.x)]
    gust: Torque,
}

/// Returns a workshop in which all parameters have different values.
pub fn sample_coordinate_force_mechanism() -> CoordinateForceMechanism {
    CoordinateForceMechanism {
        g: 9.7,
        m: 1.7,
        l: 0.8,
        shoulder_stiffness: 12.0,
        shoulder_rest: 0.3,
        shoulder_damping: 0.4,
        track_stiffness: 90.0,
        track_length: 0.15,
        slide_damping: 1.1,
        turn_damping: 0.05,
    }
}

/// Free base with a pin, a ball joint, a slot and an internal spring, without gravity.
#[mechanism]
pub struct Spacecraft {
    #[body(mass = 3, inertia = cuboid(3, 0.4, 0.3, 0.5))]
    hub: Body,
    #[body(mass = 0.4, com = 0.3 * x, inertia = rod(0.4, 0.6, x))]
    boom: Body,
    #[body(mass = 0.6, com = 0.1 * z - 0.05 * x, inertia = disk(0.6, 0.2, z))]
    mirror: Body,
    #[body(mass = 0.3, com = 0.02 * y, inertia = sphere(0.3, 0.05))]
    weight: Body,
    #[joint(ground -> hub)]
    pose: Free,
    #[joint(hub.at(0.2 * x) -> boom, about = z)]
    hinge: Pin,
    #[joint(hub.at(-0.15 * y) -> mirror.at(0.02 * y))]
    bearing: Ball,
    #[joint(boom.at(0.6 * x) -> weight, along = y, about = x)]
    rail: Slot,
    #[acts(on = hinge, stiffness = 2, free_angle = 0.5)]
    strut: Spring,
    #[acts(on = hinge)]
    motor: Torque,
}

/// Bead on a hoop that is driven about the vertical.
#[mechanism(gravity = -g * z, derivatives, sensitivities, prepare)]
#[derive(Clone, Copy)]
pub struct BeadOnRotatingHoop {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the bead, kg.
    pub m: f64,
    /// Radius of the hoop, m.
    pub radius: f64,
    /// Angular velocity of the hoop, rad/s.
    pub spin: f64,
    theta: Coordinate,
    #[frame(ground, z(spin * t))]
    hoop: Frame,
    #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))]
    bead: Particle,
}

/// Body in space with a pendulum on it. The generalized speeds are the velocity of the body's origin and the
/// angular velocity in ground axes.
#[mechanism(gravity = -9.81 * z, second_derivatives)]
pub struct SatelliteInSpeeds {
    #[body(mass = 2, com = 0.1 * x, inertia = diagonal(0.2, 0.3, 0.45))]
    hull: Body,
    #[body(mass = 0.5, com = -0.4 * z, inertia = rod(0.5, 0.8, z))]
    boom: Body,
    #[joint(ground -> hull)]
    pose: Free,
    #[joint(hull.at(0.2 * y) -> boom, about = y)]
    hinge: Pin,
    #[acts(on = hinge, damping = 0.1)]
    friction: Dashpot,
    #[acts(on = hull, along = x)]
    thrust: Force,
    #[speed(dot(v(hull / ground / ground), x))]
    ux: Speed,
    #[speed(dot(v(hull / ground / ground), y))]
    uy: Speed,
    #[speed(dot(v(hull / ground / ground), z))]
    uz: Speed,
    #[speed(dot(omega(hull / ground), x))]
    wx: Speed,
    #[speed(dot(omega(hull / ground), y))]
    wy: Speed,
    #[speed(dot(omega(hull / ground), z))]
    wz: Speed,
}

/// Declares several mechanisms that have the fields in braces in common, before those of each.
#[macro_export]
macro_rules! with_common_fields {
    (@declare { $($common:tt)* } $(# $attribute:tt)* struct $name:ident { $($field:tt)* }) => {
        $(# $attribute)*
        struct $name {
            $($common)*
            $($field)*
        }
    };
    ($common:tt $($(# $attribute:tt)* struct $name:ident $fields:tt)+) => {
        $($crate::with_common_fields!(@declare $common $(# $attribute)* struct $name $fields);)+
    };
}

/// Declares a slider-crank whose crank is `main`, with further fields.
#[macro_export]
macro_rules! slider_crank {
    ($(# $attribute:tt)* struct $name:ident { $($field:tt)* }) => {
        $(# $attribute)*
        struct $name {
            #[body(mass = 1.5, com = 0.1 * x, inertia = rod(1.5, 0.2, x))]
            crank: Body,
            #[body(mass = 0.8, com = 0.3 * x, inertia = rod(0.8, 0.6, x))]
            rod: Body,
            #[body(mass = 0.5)]
            piston: Body,
            #[joint(ground -> crank, about = z)]
            main: Pin,
            #[joint(crank.at(0.2 * x) -> rod, about = z)]
            big_end: Pin,
            #[joint(ground -> piston, along = x)]
            cylinder: Sleeve,
            #[joint(rod.at(0.6 * x) -> piston, about = z)]
            small_end: Pin,
            $($field)*
        }
    };
}
