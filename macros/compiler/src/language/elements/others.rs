//! Elements other than bodies, joints and force elements.

use super::super::Words;
use super::keys::{Key, Relation};
use super::words::ON;
use Key::{
    Dissipation, Friction, From, Hertz, MaxEffort, MaxSpeed, Restitution, RollingFriction, Speed,
    StaticFriction, Stiffness, To, TorsionalFriction,
};

/// A row of the table of other elements.
#[derive(Debug)]
pub struct OtherRow {
    /// The name of the type.
    pub name: &'static str,
    /// Words of other tools for the type.
    pub synonyms: &'static str,
    /// The attributes that belong to it.
    pub attributes: &'static [&'static str],
    /// Names of the arguments that belong to this element alone, before the others.
    pub own: &'static [&'static str],
    /// The other arguments, in the order in which messages list them.
    pub arguments: &'static [Key],
    /// Arguments that must be given, with an example each.
    pub required: &'static [(Key, &'static str)],
    /// Conditions on which arguments are given together.
    pub relations: &'static [Relation],
    /// Words of other tools for its arguments.
    pub words: Words,
    /// Example of a declaration of the element.
    pub example: &'static str,
}

const fn row(
    name: &'static str,
    synonyms: &'static str,
    attributes: &'static [&'static str],
    words: Words,
    example: &'static str,
) -> OtherRow {
    OtherRow {
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
    OtherKind: OtherRow {
        /// Generalized coordinate that belongs to no joint.
        Coordinate = row("Coordinate",
            "symbol symbols dynamicsymbol dynamicsymbols generalizedcoordinate generalisedcoordinate \
             variable dof unknown",
            &[], &[], "name: Coordinate");
        /// Input of the mechanism: an entry of `u`.
        Input = row("Input", "control signal command controlinput inputs", &[], &[], "name: Input");
        /// A frame.
        Frame = row("Frame", "referenceframe axes coordinatesystem csys basis",
            &["frame"], &[], "#[frame(ground, z(angle))]");
        /// A point.
        Point = OtherRow {
            own: &["on", "at"],
            ..row("Point", "site marker location position landmark waypoint",
            &["point"], POINT, "#[point(on = body, at = length * x)]")
        };
        /// A limit of a coordinate.
        Limit = OtherRow {
            own: &["on"],
            arguments: &[From, To, MaxSpeed, MaxEffort, Restitution],
            relations: &[Relation::requirement_relation(
                Restitution,
                &[From, To],
                "a restitution needs a bound",
                "add `from = …`, `to = …`, or both",
            )],
            ..row("Limit", "limits range bounds jointlimit jointlimits",
            &["limit"], LIMIT, "#[limit(on = joint, from = a, to = b)]")
        };
        /// A potential energy.
        Potential = row("Potential", "potentialenergy energy", &["energy"], &[], "#[energy(expression)]");
        /// A Rayleigh dissipation function.
        Rayleigh = row("Rayleigh", "dissipation dissipationfunction rayleighdissipation",
            &["dissipation"], &[], "#[dissipation(expression)]");
        /// A constraint on the configuration.
        Holonomic = row("Holonomic", "holonomicconstraint equation loop closure distance",
            &["constraint"], &[], "#[constraint(norm(r(tip / base)) = length)]");
        /// A constraint on the velocity.
        Nonholonomic = row("Nonholonomic", "nonholonomicconstraint skate noslip",
            &["constraint"], &[], "#[constraint(dot(v(skate / ground / ground), sled.y) = 0)]");
        /// Two surfaces that roll on each other.
        Rolling = row("Rolling", "",
            &["constraint"], ROLLING, "#[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]");
        /// Two surfaces that slip on each other, with friction.
        Slipping = OtherRow {
            arguments: &[Friction, Speed],
            required: &[(Friction, "mu")],
            ..row("Slipping",
            "",
            &["constraint"], &[], "#[constraint(slips(disk.circle(radius, y), ground.plane(z)), friction = mu)]")
        };
        /// A unilateral contact.
        Contact = OtherRow {
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
            ..row("Contact",
            "",
            &["contact"], CONTACT, "#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]")
        };
        /// A state of first order.
        State = OtherRow {
            own: &["rate"],
            ..row("State", "", &["state"], &[], "#[state(rate = (command - level) / lag)]")
        };
        /// An equilibrium.
        Equilibrium = row("Equilibrium", "", &["equilibrium"], &[], "#[equilibrium(joint = angle)]");
        /// A generalized speed.
        Speed = row("Speed",
            "generalizedspeed generalisedspeed quasivelocity quasicoordinate pseudovelocity motionvariable \
             speeds",
            &["speed"], &[], "#[speed(rate(psi) * sin(theta))]");
        /// Named scalar: a definition or an output.
        Scalar = row("Scalar", "", &["define", "output"], &[], "#[output(expression)]");
        /// Named vector.
        Vector = OtherRow {
            own: AXES,
            ..row("Vector", "vector3 vec3 vector3d vec",
            &["define", "output"], AXES_WORDS, "#[output(expression)]")
        };
        /// Named matrix.
        Matrix = OtherRow {
            own: AXES,
            ..row("Matrix", "", &["define", "output"], AXES_WORDS, "#[output(expression)]")
        };
        /// A free-body diagram.
        FreeBody = OtherRow {
            own: AXES,
            ..row("FreeBody", "", &["output"], AXES_WORDS, "#[output(body)]")
        };
    }
}

/// Words of other tools for the arguments of a contact.
const CONTACT: Words = &[
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

/// Words of other tools for the arguments of a limit.
const LIMIT: Words = &[
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

/// Words of other tools for the arguments of a point.
const POINT: Words = &[("body parent frame link", "on"), ("pos position xyz offset location r vector", "at")];

/// Words for the axes of an output's components.
const AXES_WORDS: Words = &[("frame axes basis in of expressedin resolved resolvedin", "resolved_in")];

/// Words of other tools for the arguments of rolling surfaces.
const ROLLING: Words = &[(
    "friction speed",
    "surfaces with friction slip: declare a `Slipping` with `slips(…)` in place of `rolls(…)`",
)];

/// Argument with the axes of an output's components.
const AXES: &[&str] = &["resolved_in"];

/// Conditions on the arguments of rigid and of compliant contact surfaces, which exclude each other.
const COMPLIANCE: &[Relation] = &[
    Relation::exclusion_relation(
        Hertz,
        &[Stiffness],
        "`NAME` has two stiffnesses",
        "`stiffness` is force per penetration depth, `hertz` force per depth to the power 3/2: give one",
    ),
    Relation::requirement_relation(Dissipation, &[Stiffness, Hertz], RIGID, ADD_STIFFNESS),
    Relation::requirement_relation(Speed, &[Stiffness, Hertz], RIGID, ADD_STIFFNESS),
    Relation::exclusion_relation(
        Restitution,
        &[Stiffness, Hertz],
        "compliant surfaces have no coefficient of restitution",
        "use `dissipation`, s/m, for the energy loss of their impacts",
    ),
    Relation::exclusion_relation(
        StaticFriction,
        &[Stiffness, Hertz],
        "the friction of compliant surfaces is smooth in the slip velocity and has no stiction",
        "remove `stiffness` or `hertz`, or remove `stiction`",
    ),
    Relation::requirement_relation(
        StaticFriction,
        &[Friction],
        "`NAME` has stiction, but no sliding friction",
        "add `friction = …`: the coefficient of sliding friction, at most that of stiction",
    ),
];
const RIGID: &str = "`NAME` is rigid and has no compliance";
const ADD_STIFFNESS: &str = "add `stiffness = …`, N/m, for compliant surfaces";

impl OtherKind {
    /// Returns the names of all arguments, as messages list them.
    pub fn argument_names(self) -> Vec<&'static str> {
        let row = self.row();
        row.own.iter().copied().chain(row.arguments.iter().map(|key| key.name())).collect()
    }
}
