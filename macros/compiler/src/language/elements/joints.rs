//! Joints.

use super::super::Words;
use super::words::{END, LIMITED, RATIO, TURNED};

/// A row of the table of joints.
#[derive(Debug)]
pub struct JointRow {
    /// The name of the type.
    pub name: &'static str,
    /// Words of other tools, without the word `joint`.
    pub synonyms: &'static str,
    /// The arguments beside the two ends.
    pub arguments: &'static [&'static str],
    /// How it is declared.
    pub example: &'static str,
}

const ABOUT: &str = "#[joint(parent -> child, about = z)]";
const ALONG: &str = "#[joint(parent -> child, along = x)]";
const BARE: &str = "#[joint(parent -> child)]";

const fn row(
    name: &'static str,
    synonyms: &'static str,
    arguments: &'static [&'static str],
    example: &'static str,
) -> JointRow {
    JointRow { name, synonyms, arguments, example }
}

table! {
    /// A kind of joint.
    JointKind: JointRow {
        /// Rotation about an axis (revolute, hinge).
        Pin = row("Pin",
            "revolute hinge continuous rotary rotational rotation rotating pivot axle bearing turn turning swivel",
            &["about"], ABOUT);
        /// Translation along an axis (prismatic).
        Sleeve = row("Sleeve",
            "prismatic slider slide sliding translational translation linear rail piston telescopic",
            &["along"], ALONG);
        /// Rotation about and translation along one axis, coupled by a pitch (helical).
        Screw = row("Screw",
            "helical helix leadscrew ballscrew nut",
            &["about", "along", "pitch", "lead"], ABOUT);
        /// Rotation about and translation along one axis, independent (cylindrical).
        Collar = row("Collar", "cylindrical cylinder", &["about", "along"], ABOUT);
        /// Translation along one axis, then rotation about another.
        Slot = row("Slot", "", &["about", "along"], ABOUT);
        /// Rotations about two axes in turn.
        Universal = row("Universal", "cardan hooke gimbal cv", &["about"], ABOUT);
        /// All rotations (spherical).
        Ball = row("Ball", "spherical socket ballsocket ballandsocket quaternion", &[], BARE);
        /// Two translations and a rotation about their normal (dual sleeve-pin).
        Planar = row("Planar", "dualsleevepin planar2d", &["about", "along"], ABOUT);
        /// Two or three translations (x-y and x-y-z stage).
        Stage = row("Stage", "xystage xyzstage xy xyz cartesian gantry translation3d", &["along"], ALONG);
        /// All motions (six degrees of freedom).
        Free = row("Free",
            "floating floatingbase freebase sixdof 6dof freeflyer freeflying unconstrained bushing",
            &[], BARE);
        /// No motion (fixed).
        Weld = row("Weld", "fixed rigid weld welded locked lock glue fix", &[], BARE);
    }
}

impl JointKind {
    /// Returns the name with its article: `a Pin`.
    pub fn phrase(self) -> String {
        format!("a {}", self.name())
    }
}

/// Words of other tools for the arguments of a joint; `NAME` is its name.
pub const JOINT_WORDS: Words = &[
    ("axis axes direction dir rotationaxis hingeaxis normal", "about"),
    ("axis axes direction dir slideaxis", "along"),
    ("origin pos position at anchor offset xyz point translation location", END),
    ("rpy orientation angle rotation axes rotated euler quat quaternion tilt", TURNED),
    (
        "damping damper c viscous",
        "a joint moves freely; a damper is a field of its own: `#[acts(on = NAME, damping = c)] damper: Dashpot`",
    ),
    (
        "stiffness spring k",
        "a joint moves freely; a spring is a field of its own: `#[acts(on = NAME, stiffness = k)] spring: Spring`",
    ),
    (
        "friction coulomb frictionloss",
        "a joint moves freely; friction is a field of its own: `#[acts(on = NAME, coulomb = f)] friction: Friction`",
    ),
    (
        "torque motor actuator effort drive",
        "what drives a joint is a field of its own: `#[acts(on = NAME)] motor: Torque`",
    ),
    ("force", "what drives a joint is a field of its own: `#[acts(on = NAME)] motor: Force`"),
    (
        "limit limits lower upper range min max from to maxspeed maxvelocity maxeffort maxtorque maxforce",
        LIMITED,
    ),
    ("ratio mimic gear", RATIO),
    (
        "coordinate coordinates q name symbol speed speeds",
        "the joint's name is its coordinate, `rate(NAME)` its rate",
    ),
    (
        "driven prescribed",
        "a motion that is given is a body placed by time: `#[body(massive, at = …, frame = …)]`",
    ),
];
