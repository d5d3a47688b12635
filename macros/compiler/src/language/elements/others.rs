//! Elements other than bodies, joints and force elements.

use super::super::WordsWithMeanings;
use super::keys::{ArgumentRelation, Key};
use super::words::ON;
use Key::{
    Dissipation, Friction, From, Hertz, MaxEffort, MaxSpeed, Restitution, RollingFriction, Speed,
    StaticFriction, Stiffness, To, TorsionalFriction,
};

/// A row of the table of other elements.
#[derive(Debug)]
pub struct OtherElementRow {
    /// Name of the element's type.
    pub name: &'static str,
    /// Names of the element type in other tools.
    pub synonyms: &'static str,
    /// Attributes that the element type can have.
    pub attributes: &'static [&'static str],
    /// Names of arguments that only this element has; messages list them first.
    pub own: &'static [&'static str],
    /// Further arguments of the element, in the order in which messages list them.
    pub arguments: &'static [Key],
    /// Arguments that the element requires, with an example value for each.
    pub required: &'static [(Key, &'static str)],
    /// Conditions on which arguments may or must occur together.
    pub relations: &'static [ArgumentRelation],
    /// Names of the element's arguments in other tools.
    pub words: WordsWithMeanings,
    /// Example of a declaration of the element.
    pub example: &'static str,
}

const fn element_row(
    name: &'static str,
    synonyms: &'static str,
    attributes: &'static [&'static str],
    words: WordsWithMeanings,
    example: &'static str,
) -> OtherElementRow {
    OtherElementRow {
        name,
        synonyms,
        attributes,
        own: &[],
        arguments: &[],
        required: &[],
        relations: &[],
        words,
        example,
    }
}

table! {
    /// An element other than a body, a joint or a force element.
    OtherKind: OtherElementRow {
        /// Element type `Coordinate`: a generalized coordinate that belongs to no joint.
        Coordinate = element_row("Coordinate",
            "symbol symbols dynamicsymbol dynamicsymbols generalizedcoordinate generalisedcoordinate \
             variable dof unknown",
            &[], &[], "name: Coordinate");
        /// Element type `Input`: an entry of `u`.
        Input = element_row("Input", "control signal command controlinput inputs", &[], &[], "name: Input");
        /// Element type `Frame`: a named frame.
        Frame = element_row("Frame", "referenceframe axes coordinatesystem csys basis",
            &["frame"], &[], "#[frame(ground, z(angle))]");
        /// Element type `Point`: a named point of a body.
        Point = OtherElementRow {
            own: &["on", "at"],
            ..element_row("Point", "site marker location position landmark waypoint",
            &["point"], POINT, "#[point(on = body, at = length * x)]")
        };
        /// Element type `Limit`: limits of a coordinate.
        Limit = OtherElementRow {
            own: &["on"],
            arguments: &[From, To, MaxSpeed, MaxEffort, Restitution],
            relations: &[ArgumentRelation::relation_requiring_one_of(
                Restitution,
                &[From, To],
                "a restitution needs a bound",
                "add `from = …`, `to = …`, or both",
            )],
            ..element_row("Limit", "limits range bounds jointlimit jointlimits",
            &["limit"], LIMIT, "#[limit(on = joint, from = a, to = b)]")
        };
        /// Element type `Potential`: a potential energy.
        Potential = element_row("Potential", "potentialenergy energy", &["energy"], &[],
            "#[energy(expression)]");
        /// Element type `Rayleigh`: a Rayleigh dissipation function.
        Rayleigh = element_row("Rayleigh", "dissipation dissipationfunction rayleighdissipation",
            &["dissipation"], &[], "#[dissipation(expression)]");
        /// Element type `Holonomic`: a constraint on the configuration.
        Holonomic = element_row("Holonomic", "holonomicconstraint equation loop closure distance",
            &["constraint"], &[], "#[constraint(norm(r(tip / base)) = length)]");
        /// Element type `Nonholonomic`: a constraint on the velocity.
        Nonholonomic = element_row("Nonholonomic", "nonholonomicconstraint skate noslip",
            &["constraint"], &[], "#[constraint(dot(v(skate / ground / ground), sled.y) = 0)]");
        /// Element type `Rolling`: two surfaces that roll on each other.
        Rolling = element_row("Rolling", "",
            &["constraint"], ROLLING, "#[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]");
        /// Element type `Slipping`: two surfaces that slip on each other, with friction.
        Slipping = OtherElementRow {
            arguments: &[Friction, Speed],
            required: &[(Friction, "mu")],
            ..element_row("Slipping",
            "",
            &["constraint"], &[], "#[constraint(slips(disk.circle(radius, y), ground.plane(z)), friction = mu)]")
        };
        /// Element type `Contact`: a unilateral contact.
        Contact = OtherElementRow {
            arguments: &[
                Friction,
                StaticFriction,
                TorsionalFriction,
                RollingFriction,
                Restitution,
                Stiffness,
                Hertz,
                Dissipation,
                Speed,
            ],
            relations: COMPLIANCE,
            ..element_row("Contact",
            "",
            &["contact"], CONTACT, "#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]")
        };
        /// Element type `State`: a state of first order.
        State = OtherElementRow {
            own: &["rate"],
            ..element_row("State", "", &["state"], &[], "#[state(rate = (command - level) / lag)]")
        };
        /// Element type `Equilibrium`: a configuration about which equations are linearised.
        Equilibrium = element_row("Equilibrium", "", &["equilibrium"], &[], "#[equilibrium(joint = angle)]");
        /// Element type `Speed`: a generalized speed.
        Speed = element_row("Speed",
            "generalizedspeed generalisedspeed quasivelocity quasicoordinate pseudovelocity motionvariable \
             speeds",
            &["speed"], &[], "#[speed(rate(psi) * sin(theta))]");
        /// Element type `Scalar`: a named scalar, which is a definition or an output.
        Scalar = element_row("Scalar", "", &["define", "output"], &[], "#[output(expression)]");
        /// Element type `Vector`: a named vector.
        Vector = OtherElementRow {
            own: AXES,
            ..element_row("Vector", "vector3 vec3 vector3d vec",
            &["define", "output"], AXES_WORDS, "#[output(expression)]")
        };
        /// Element type `Matrix`: a named matrix.
        Matrix = OtherElementRow {
            own: AXES,
            ..element_row("Matrix", "", &["define", "output"], AXES_WORDS, "#[output(expression)]")
        };
        /// Element type `FreeBody`: the free-body diagram of a body.
        FreeBody = OtherElementRow {
            own: AXES,
            ..element_row("FreeBody", "", &["output"], AXES_WORDS, "#[output(body)]")
        };
    }
}

/// Names of other tools for the arguments of a contact.
const CONTACT: WordsWithMeanings = &[
    ("mu muk coefficient frictioncoefficient coulomb kinetic kineticfriction sliding", "friction"),
    ("mus static staticfriction breakaway stick fs", "stiction"),
    ("spinning spin torsion torsionalfriction spinningfriction mutorsion drilling", "torsional"),
    ("rollingfriction rollingresistance resistance murolling roll", "rolling"),
    ("e cor bounce bounciness elasticity rebound restitutioncoefficient", "restitution"),
    ("k compliance rigidity", "stiffness"),
    ("damping c damper", "dissipation"),
    (
        "on between surfaces bodies radius r size",
        "both surfaces come first: `ball.sphere(radius), ground.plane(z)`",
    ),
];

/// Names of other tools for the arguments of a limit.
const LIMIT: WordsWithMeanings = &[
    (ON, "on"),
    ("lower low min minimum least start lowerlimit", "from"),
    ("upper high max maximum most end upperlimit", "to"),
    ("velocity speed rate maxvelocity vmax maxrate", "max_speed"),
    ("effort force torque maxforce maxtorque fmax taumax", "max_effort"),
    (
        "stiffness damping",
        "a soft end stop is a `Spring` given by its energy: `energy = k / 2 * pow(min(stretch - low, 0), 2)`",
    ),
];

/// Names of other tools for the arguments of a point.
const POINT: WordsWithMeanings =
    &[("body parent frame link", "on"), ("pos position xyz offset location r vector", "at")];

/// Names of other tools for the argument with the axes of an output's components.
const AXES_WORDS: WordsWithMeanings =
    &[("frame axes basis in of expressedin resolved resolvedin", "resolved_in")];

/// Names of other tools for the arguments of rolling surfaces.
const ROLLING: WordsWithMeanings = &[(
    "friction speed",
    "surfaces with friction slip: declare a `Slipping` with `slips(…)` in place of `rolls(…)`",
)];

/// Name of the argument with the axes of an output's components.
const AXES: &[&str] = &["resolved_in"];

/// Conditions on the arguments of rigid and of compliant contact surfaces, which exclude each other.
const COMPLIANCE: &[ArgumentRelation] = &[
    ArgumentRelation::exclusion_relation(
        Hertz,
        &[Stiffness],
        "`NAME` has two stiffnesses",
        "`stiffness` is force per penetration depth, `hertz` force per depth to the power 3/2: give one",
    ),
    ArgumentRelation::relation_requiring_one_of(Dissipation, &[Stiffness, Hertz], RIGID, ADD_STIFFNESS),
    ArgumentRelation::relation_requiring_one_of(Speed, &[Stiffness, Hertz], RIGID, ADD_STIFFNESS),
    ArgumentRelation::exclusion_relation(
        Restitution,
        &[Stiffness, Hertz],
        "compliant surfaces have no coefficient of restitution",
        "use `dissipation`, s/m, for the energy loss of their impacts",
    ),
    ArgumentRelation::exclusion_relation(
        StaticFriction,
        &[Stiffness, Hertz],
        "the friction of compliant surfaces is smooth in the slip velocity and has no stiction",
        "remove `stiffness` or `hertz`, or remove `stiction`",
    ),
    ArgumentRelation::relation_requiring_one_of(
        StaticFriction,
        &[Friction],
        "`NAME` has stiction, but no sliding friction",
        "add `friction = …`: the coefficient of sliding friction, at most that of stiction",
    ),
];
const RIGID: &str = "`NAME` is rigid and has no compliance";
const ADD_STIFFNESS: &str = "add `stiffness = …`, N/m, for compliant surfaces";

impl OtherKind {
    /// Returns the names of all arguments of the element, in the order of messages.
    pub fn argument_names(self) -> Vec<&'static str> {
        let row = self.row();
        row.own.iter().copied().chain(row.arguments.iter().map(|key| key.name())).collect()
    }
}
