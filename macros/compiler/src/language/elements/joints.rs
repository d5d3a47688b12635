//! Table of the joints: names, axes, coordinates and examples.

use super::super::WordsWithMeanings;
use super::words::{END, LIMITED, RATIO, TURNED};
use crate::mechanism::PieceShape;
use JointTypeCoordinates::Plain;

/// Row of the table of joints.
#[derive(Debug)]
pub struct JointRow {
    /// Name of the joint's type in the language.
    pub name: &'static str,
    /// Names of the joint type in other tools, without the word `joint`.
    pub synonyms: &'static str,
    /// Arguments of the joint in addition to its two ends.
    pub arguments: &'static [&'static str],
    /// Names of the joint's coordinates, and whether they are angles.
    pub coordinates: JointTypeCoordinates,
    /// Piece of the drawing, and the argument whose first axis the piece shows.
    pub piece: Option<(PieceShape, Option<DrawnAxis>)>,
    /// Example of a declaration of the joint.
    pub example: &'static str,
}

/// Coordinates that a type of joint has.
#[derive(Clone, Copy, Debug)]
pub enum JointTypeCoordinates {
    /// Plain coordinates by name (empty for the name of the joint), with true for an angle.
    Plain(&'static [(&'static str, bool)]),
    /// Plain coordinates along the two or three given axes.
    PerAxis(&'static [(&'static str, bool)]),
    /// The joint's coordinates are a unit quaternion.
    Ball,
    /// The joint's coordinates are a position and a unit quaternion.
    Free,
}

/// The axis that the drawing of a joint shows.
#[derive(Clone, Copy, Debug)]
pub enum DrawnAxis {
    /// The drawing shows the first rotation axis of the joint.
    About,
    /// The drawing shows the first translation axis of the joint.
    Along,
}

const HINGE: Option<(PieceShape, Option<DrawnAxis>)> = Some((PieceShape::Hinge, Some(DrawnAxis::About)));
const SLIDE: Option<(PieceShape, Option<DrawnAxis>)> = Some((PieceShape::Slide, Some(DrawnAxis::Along)));
const BALL: Option<(PieceShape, Option<DrawnAxis>)> = Some((PieceShape::Ball, None));

const ANGLE: JointTypeCoordinates = Plain(&[("", true)]);
const LENGTH: JointTypeCoordinates = Plain(&[("", false)]);
const SLIDE_AND_TURN: JointTypeCoordinates = Plain(&[("slide", false), ("turn", true)]);

const ABOUT: &str = "#[joint(parent -> child, about = z)]";
const ALONG: &str = "#[joint(parent -> child, along = x)]";
const BARE: &str = "#[joint(parent -> child)]";

const fn joint_row(
    name: &'static str,
    synonyms: &'static str,
    arguments: &'static [&'static str],
    coordinates: JointTypeCoordinates,
    piece: Option<(PieceShape, Option<DrawnAxis>)>,
    example: &'static str,
) -> JointRow {
    JointRow { name, synonyms, arguments, coordinates, piece, example }
}

table! {
    /// Type of joint in the language.
    JointKind: JointRow {
        /// Rotation about an axis (revolute, hinge).
        Pin = joint_row("Pin",
            "revolute hinge continuous rotary rotational rotation rotating pivot axle bearing turn turning \
             swivel",
            &["about"], ANGLE, HINGE, ABOUT);
        /// Translation along an axis (prismatic).
        Sleeve = joint_row("Sleeve",
            "prismatic slider slide sliding translational translation linear rail piston telescopic",
            &["along"], LENGTH, SLIDE, ALONG);
        /// Rotation about and translation along one axis, coupled by a pitch (helical).
        Screw = joint_row("Screw", "helical helix leadscrew ballscrew nut",
            &["about", "along", "pitch", "lead"], ANGLE, HINGE, ABOUT);
        /// Rotation about and translation along one axis, independent (cylindrical).
        Collar = joint_row("Collar", "cylindrical cylinder",
            &["about", "along"], SLIDE_AND_TURN, HINGE, ABOUT);
        /// Translation along one axis, then rotation about another.
        Slot = joint_row("Slot", "",
            &["about", "along"], SLIDE_AND_TURN, SLIDE, ABOUT);
        /// Successive rotations about two axes.
        Universal = joint_row("Universal", "cardan hooke gimbal cv",
            &["about"], Plain(&[("first", true), ("second", true)]), BALL, ABOUT);
        /// Rotation about all axes (spherical joint).
        Ball = joint_row("Ball", "spherical socket ballsocket ballandsocket quaternion",
            &[], JointTypeCoordinates::Ball, BALL, BARE);
        /// Two translations and a rotation about their normal (dual sleeve-pin).
        Planar = joint_row("Planar", "dualsleevepin planar2d",
            &["about", "along"], Plain(&[("x", false), ("y", false), ("angle", true)]), HINGE, ABOUT);
        /// Two or three translations (x-y and x-y-z stage).
        Stage = joint_row("Stage",
            "xystage xyzstage xy xyz cartesian gantry translation3d",
            &["along"], JointTypeCoordinates::PerAxis(&[("x", false), ("y", false), ("z", false)]),
        SLIDE, ALONG);
        /// All motions (free joint with six degrees of freedom).
        Free = joint_row("Free",
            "floating floatingbase freebase sixdof 6dof freeflyer freeflying unconstrained bushing",
            &[], JointTypeCoordinates::Free, None, BARE);
        /// No motion (fixed joint).
        Weld = joint_row("Weld", "fixed rigid weld welded locked lock glue fix",
            &[], Plain(&[]), None, BARE);
    }
}

impl JointKind {
    /// Returns the plain coordinates of a joint with `along` translation axes: names (empty for the name of
    /// the joint), and true for an angle.
    fn plain_coordinates_with_angle_flags(self, along: usize) -> Option<&'static [(&'static str, bool)]> {
        match self.row().coordinates {
            Plain(all) => Some(all),
            JointTypeCoordinates::PerAxis(all) => all.get(..along.clamp(2, all.len())),
            JointTypeCoordinates::Ball | JointTypeCoordinates::Free => None,
        }
    }

    /// Returns the names of the entries of `q` and `v`; an empty name is that of the joint.
    pub fn configuration_and_velocity_names(self, along: usize) -> (Vec<&'static str>, Vec<&'static str>) {
        if let Some(plain) = self.plain_coordinates_with_angle_flags(along) {
            let names: Vec<&str> = plain.iter().map(|(name, _)| *name).collect();
            return (names.clone(), names);
        }
        let is_ball = matches!(self.row().coordinates, JointTypeCoordinates::Ball);
        let (q, v): (&[&str], &[&str]) = match is_ball {
            true => (&["qx", "qy", "qz", "qw"], &["wx", "wy", "wz"]),
            false => (&["x", "y", "z", "qx", "qy", "qz", "qw"], &["vx", "vy", "vz", "wx", "wy", "wz"]),
        };
        (q.to_vec(), v.to_vec())
    }

    /// Returns true for a joint that only rotates about one axis, false for a joint that only translates
    /// along one axis, and `None` for others.
    pub fn single_axis_joint_is_rotational(self) -> Option<bool> {
        match (self.row().coordinates, self.row().arguments) {
            (Plain([("", true)]), ["about"]) => Some(true),
            (Plain([("", false)]), ["along"]) => Some(false),
            (
                Plain(_)
                | JointTypeCoordinates::PerAxis(_)
                | JointTypeCoordinates::Ball
                | JointTypeCoordinates::Free,
                _,
            ) => None,
        }
    }

    /// True if a plain coordinate is an angle, false if it is a length.
    pub fn is_angle(self, coordinate: &str) -> bool {
        let plain = self.plain_coordinates_with_angle_flags(usize::MAX).unwrap_or_default();
        plain.iter().any(|(name, angle)| *name == coordinate && *angle)
    }

    /// Returns the type name with its indefinite article: `a Pin`.
    pub fn name_with_article(self) -> String {
        format!("a {}", self.name())
    }
}

/// Words of other tools for the arguments of a joint; `NAME` is its name.
pub const JOINT_WORDS: WordsWithMeanings = &[
    ("axis axes direction dir rotationaxis hingeaxis normal", "about"),
    ("axis axes direction dir slideaxis", "along"),
    ("origin pos position at anchor offset xyz point translation location", END),
    ("rpy orientation angle rotation axes rotated euler quat quaternion tilt", TURNED),
    (
        "damping damper c viscous",
        "a joint moves freely; a damper is a separate field: `#[acts(on = NAME, damping = c)] damper: \
         Dashpot`",
    ),
    (
        "stiffness spring k",
        "a joint moves freely; a spring is a separate field: `#[acts(on = NAME, stiffness = k)] spring: \
         Spring`",
    ),
    (
        "friction coulomb frictionloss",
        "a joint moves freely; friction is a separate field: `#[acts(on = NAME, coulomb = f)] friction: \
         Friction`",
    ),
    (
        "torque motor actuator effort drive",
        "the drive of a joint is a separate field: `#[acts(on = NAME)] motor: Torque`",
    ),
    ("force", "the drive of a joint is a separate field: `#[acts(on = NAME)] motor: Force`"),
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
        "a prescribed motion is a body placed by time: `#[body(massive, at = …, frame = …)]`",
    ),
];
