//! Force elements: springs, dashpots, inerters, friction, gravity, forces and torques.

use super::super::WordsWithMeanings;
use super::keys::{ArgumentRelation, Key};
use super::words::{AT, NO_INERTANCE, ON, SATURATION};
use crate::mechanism::PieceShape;
use Key::{
    About, Along, Constant, Coulomb, FreeAngle, FreeLength, Mu, Stiction, Strength, StribeckSpeed, Value,
    Viscous,
};

/// A row of the table of force elements.
#[derive(Debug)]
pub struct ForceRow {
    /// Name of the force element's type.
    pub name: &'static str,
    /// Names of the force element in other tools.
    pub synonyms: &'static str,
    /// Whether the element can act on a coordinate, a body or a length: `on = …`.
    pub on: bool,
    /// Whether the element can act between two points: `between = (…, …)`.
    pub between: bool,
    /// Arguments of the element after the points on which it acts, in the order in which messages list them.
    pub arguments: &'static [Key],
    /// Alternative arguments for the force law, exactly one of which is given. If it is missing, messages ask
    /// for the last one.
    pub laws: &'static [Key],
    /// Arguments that the element requires, with an example value for each.
    pub required: &'static [(Key, &'static str)],
    /// Conditions on which arguments may or must occur together.
    pub relations: &'static [ArgumentRelation],
    /// Names of the stretch and the speed in the expression of the law.
    pub locals: ForceLawVariables,
    /// Whether the element can act on a body, not only on a coordinate or a length.
    pub on_bodies: bool,
    /// Whether the element applies a torque to a body instead of a force.
    pub torque: bool,
    /// Whether the element applies a force at a single point of a body.
    pub at_point: bool,
    /// Pieces of the drawing: for a length, and for an angle.
    pub pieces: Option<[PieceShape; 2]>,
    /// Whether the element is drawn only between two points.
    pub drawn_between: bool,
    /// Names that other tools use for the arguments of the element.
    pub words: WordsWithMeanings,
    /// Example of a declaration of the force element.
    pub example: &'static str,
}

/// Variables that the expression of a force law may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceLawVariables {
    /// The expression of the force law has no variables of its own.
    None,
    /// The force law may use the variables `stretch` and `length`.
    Stretch,
    /// The force law may use the variable `speed`.
    Speed,
}

/// Row of the table with default values, from which other rows are derived.
const PLAIN: ForceRow = ForceRow {
    name: "",
    synonyms: "",
    on: true,
    between: true,
    arguments: &[],
    laws: &[],
    required: &[],
    relations: &[],
    locals: ForceLawVariables::None,
    on_bodies: false,
    torque: false,
    at_point: true,
    pieces: None,
    drawn_between: false,
    words: &[],
    example: "",
};

table! {
    /// Force element of the language, or an input that acts as a force.
    ForceKind: ForceRow {
        /// Spring: a force that depends on displacement.
        Spring = ForceRow {
            name: "Spring",
            synonyms: "torsionspring torsionalspring rotationalspring linearspring coilspring elastic \
                       elasticity compliance",
            arguments: &[Key::Stiffness, Key::Force, Key::Energy, FreeLength, FreeAngle],
            laws: &[Key::Force, Key::Energy, Key::Stiffness],
            required: &[(Key::Stiffness, "k")],
            relations: &[ArgumentRelation::exclusion_relation(
                FreeAngle,
                &[FreeLength],
                "a spring has one of `free_length` and `free_angle`",
                "`free_length` applies to translations, `free_angle` to rotations",
            )],
            locals: ForceLawVariables::Stretch,
            pieces: Some([PieceShape::Coil, PieceShape::Spiral]),
            words: &[
                (ON, "on"),
                ("points ends connects", "between"),
                ("k stiff springconstant springrate rate constant coefficient", "stiffness"),
                ("length l l0 x0 restlength naturallength unstretchedlength freelen rest natural free \
                  equilibrium", "free_length"),
                ("angle theta0 phi0 restangle naturalangle q0 rest natural free equilibrium", "free_angle"),
                ("inertance inerter", NO_INERTANCE),
                ("damping c d damper",
                    "a spring has no damping: add a separate `Dashpot`"),
                ("f law", "force"),
                ("potential u", "energy"),
            ],
            example: "#[acts(on = joint, stiffness = k)]",
            ..PLAIN
        };
        /// Dashpot: a force proportional to the relative velocity.
        Dashpot = ForceRow {
            name: "Dashpot",
            synonyms: "damper viscousdamper damping shock shockabsorber resistance drag",
            arguments: &[Key::Damping, Key::Force],
            laws: &[Key::Force, Key::Damping],
            required: &[(Key::Damping, "c")],
            locals: ForceLawVariables::Speed,
            pieces: Some([PieceShape::Damper, PieceShape::Brake]),
            words: &[
                (ON, "on"),
                ("points ends connects", "between"),
                ("c d b damp dampingcoefficient coefficient viscosity viscous resistance", "damping"),
                ("inertance inerter", NO_INERTANCE),
                ("coulomb friction mu dry", "dry friction is a separate `Friction`"),
                ("stiffness k",
                    "a dashpot has no stiffness: add a separate `Spring`"),
                ("f law", "force"),
            ],
            example: "#[acts(on = joint, damping = c)]",
            ..PLAIN
        };
        /// An inerter: a force proportional to the relative acceleration.
        Inerter = ForceRow {
            name: "Inerter",
            arguments: &[Key::Inertance],
            required: &[(Key::Inertance, "b")],
            words: &[(ON, "on"), ("points ends connects", "between"), ("b mass m inertia i", "inertance")],
            example: "#[acts(on = joint, inertance = b)]",
            ..PLAIN
        };
        /// Dry and viscous friction.
        Friction = ForceRow {
            name: "Friction",
            synonyms: "coulombfriction dryfriction coulomb stiction brake",
            between: false,
            arguments: &[Coulomb, Stiction, StribeckSpeed, Viscous, Key::Speed],
            required: &[(Coulomb, "f")],
            words: &[
                (ON, "on"),
                ("mu coefficient f friction force torque kinetic dynamic sliding normal",
                    "did you mean `coulomb`? it is a force or a torque: the coefficient times the normal \
                     force"),
                ("static breakaway stick fs", "stiction"),
                ("damping c d b", "viscous"),
                ("stribeck vs", "stribeck_speed"),
                ("smoothing regularization regularisation velocity eps", "speed"),
            ],
            example: "#[acts(on = joint, coulomb = f)]",
            ..PLAIN
        };
        /// Central gravity between two bodies, or towards a point.
        Gravity = ForceRow {
            name: "Gravity",
            arguments: &[Constant, Mu],
            at_point: false,
            words: ATTRACTING,
            example: "#[acts(between = (sun, planet), constant = g)]",
            ..PLAIN
        };
        /// Inverse-square attraction (repulsion if negative).
        Attraction = ForceRow {
            name: "Attraction",
            on: false,
            arguments: &[Strength],
            required: &[(Strength, "k")],
            words: ATTRACTING,
            example: "#[acts(between = (first, second), strength = k)]",
            ..PLAIN
        };
        /// A force: on a sliding coordinate, on a body or between two points; without a value an input.
        Force = ForceRow {
            name: "Force",
            synonyms: "thruster thrust load push pull wind",
            arguments: &[Along, Value],
            on_bodies: true,
            pieces: Some([PieceShape::Bar, PieceShape::Bar]),
            drawn_between: true,
            words: &[
                (ON, "on"),
                ("axis direction dir about", "along"),
                ("magnitude force f vector expression", "value"),
                ("at point position location", AT),
                ("max min limit limits saturation", SATURATION),
                ("points ends connects from to", "between"),
            ],
            example: "#[acts(on = body, along = x)]",
            ..PLAIN
        };
        /// A torque: on a rotating coordinate or on a body; without a value an input.
        Torque = ForceRow {
            name: "Torque",
            synonyms: "motor actuator servo moment couple drive servomotor",
            between: false,
            arguments: &[About, Value],
            on_bodies: true,
            torque: true,
            at_point: false,
            words: &[
                (ON, "on"),
                ("axis direction dir along", "about"),
                ("magnitude torque tau moment vector expression", "value"),
                ("at point position location", "a torque has no point: write `on = body`"),
                ("max min limit limits saturation", SATURATION),
            ],
            example: "#[acts(on = joint)]",
            ..PLAIN
        };
    }
}

/// Names of other tools for the arguments of gravity and of attraction.
const ATTRACTING: WordsWithMeanings = &[
    ("g constantg gravitationalconstant gamma", "constant"),
    ("gm standardgravitationalparameter parameter", "mu"),
    ("k constant charge", "strength"),
    ("from to bodies points on", "between"),
];

impl ForceKind {
    /// Returns the names of all arguments of the element, in the order of messages.
    pub fn argument_names(self) -> Vec<&'static str> {
        let row = self.row();
        let targets = [("on", row.on), ("between", row.between)].into_iter().filter(|(_, takes)| *takes);
        targets.map(|(word, _)| word).chain(row.arguments.iter().map(|key| key.name())).collect()
    }

    /// Returns the type name with its indefinite article: `an Inerter`.
    pub fn name_with_article(self) -> String {
        super::word_with_article(self.name())
    }
}
