//! Table of the functions of expressions, except the elementary functions.

use super::dimension::{
    ACCELERATION, ANGULAR_MOMENTUM, DENSITY, Dimension, ENERGY, FORCE, INERTIA, LENGTH, MOMENTUM, PLAIN,
    POWER, PRESSURE, RATE, RATE_OF_RATE, SPEED,
};
use FunctionDependence::{Acceleration, Arguments, Motion, Power, Rate, Reaction};
use UnitRule::{
    Cable, Direction, EqualUnits, Gradient, Inverse, LikeFirst, LikeLast, Moment, Of, OfHeight, Places,
    Product, Quotient, TimeDerivative, Unknown,
};

/// Row of the table of functions.
#[derive(Debug)]
pub struct FunctionRow {
    /// Name of the function.
    pub name: &'static str,
    /// Names of the function in other tools.
    pub synonyms: &'static str,
    /// Arguments of the function, as the error message about wrong arguments lists them.
    pub takes: &'static str,
    /// Help line of the error message about wrong arguments of the function.
    pub usage: &'static str,
    /// Quantities on which the value of the function depends.
    pub depends_on: FunctionDependence,
    /// Dimension of the function's value, and dimensions that its arguments must have.
    pub unit: UnitRule,
}

/// The quantities that the value of a function depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionDependence {
    /// The configuration, and the quantities that its arguments depend on.
    Arguments,
    /// The value of the function depends on velocities.
    Motion,
    /// The value of the function depends on accelerations.
    Acceleration,
    /// Velocities, and accelerations where an argument is a motion itself.
    Rate,
    /// The value depends on velocities, and on inputs if an argument is a contact.
    Power,
    /// Velocities and inputs, which determine the forces of joints and contacts.
    Reaction,
}

/// Dimension of a function's value.
#[derive(Debug)]
pub enum UnitRule {
    /// Unknown dimension, which is inferred from the use of the value.
    Unknown,
    /// Fixed dimension, for the value and all arguments.
    Of(Dimension),
    /// The value has the dimension of a direction: dimensionless.
    Direction,
    /// The value has the dimension of the arguments, which must be equal.
    EqualUnits,
    /// The value is dimensionless; the dimensions of the arguments must be equal.
    Quotient,
    /// The value has the dimension of the first argument.
    LikeFirst,
    /// The value has the dimension of the last argument.
    LikeLast,
    /// Dimension of the product of the arguments; for a scalar the product of two directions is plain.
    Product {
        /// Whether the value of the function is a scalar.
        scalar: bool,
    },
    /// The value has the dimension of the first argument; it is dimensionless for a direction.
    Magnitude,
    /// Dimension of the first argument raised to the second argument.
    Power,
    /// The value has the dimension of the first argument over time.
    TimeDerivative,
    /// The value has the inverse of the dimension of the first argument.
    Inverse,
    /// The value has the dimension of a field over a length.
    Gradient,
    /// A fixed dimension; the first argument is a pair of points or frames, `y / x`.
    Places(Dimension),
    /// The value is a moment of inertia, if all directions are dimensionless.
    Moment,
    /// A length; the arguments are two points and a round surface.
    Cable,
    /// The value has this dimension, if it has a unit; the argument is a height.
    OfHeight(Option<Dimension>),
}

const ONE: &str = "1 argument";
const TWO: &str = "2 arguments";
const THREE: &str = "3 arguments";
const CURVE: &str = "a curve and the coordinate along it";
const MOVING: &str = "a body and a frame";

/// Returns a row of the table of functions from its fields, in their order.
const fn function_row(
    name: &'static str,
    synonyms: &'static str,
    (takes, usage): (&'static str, &'static str),
    depends_on: FunctionDependence,
    unit: UnitRule,
) -> FunctionRow {
    FunctionRow { name, synonyms, takes, usage, depends_on, unit }
}

table! {
    /// Function of the language that is not elementary.
    FunctionId: FunctionRow {
        /// The angle of the point `(x, y)`, from −π to π.
        Atan2 = function_row("atan2", "arctan2", (TWO, "write `atan2(y, x)`"), Arguments, Quotient);
        /// An angle given in degrees.
        Degrees = function_row("degrees", "radians deg2rad rad2deg degtorad deg degree torad rad radian",
            (ONE, "write `degrees(90)`"), Arguments, Unknown);
        /// Power with a constant exponent.
        Pow = function_row("pow", "power powi powf powr", (TWO, "write `pow(a, n)`"), Arguments,
            UnitRule::Power);
        /// The smaller of two values.
        Min = function_row("min", "minimum", (TWO, "write `min(a, b)`"), Arguments, EqualUnits);
        /// The larger of two values.
        Max = function_row("max", "maximum", (TWO, "write `max(a, b)`"), Arguments, EqualUnits);
        /// The scalar product.
        Dot = function_row("dot", "inner scalarproduct inp",
            (TWO, "write `dot(a, b)`; the rate of a coordinate is `rate(coordinate)`"),
            Arguments, Product { scalar: true });
        /// The vector product.
        Cross = function_row("cross", "wedge vectorproduct crossproduct", (TWO, "write `cross(a, b)`"),
            Arguments, Product { scalar: false });
        /// The length of a vector.
        Norm = function_row("norm", "length magnitude mag len modulus", (ONE, "write `norm(v)`"),
            Arguments, UnitRule::Magnitude);
        /// The direction of a vector.
        Unit = function_row("unit", "normalize normalise normalized normalised unitvector hat direction",
            (ONE, "write `unit(v)`"), Arguments, Direction);
        /// Position of a point relative to another point.
        Position = function_row("r", "position pos displacement", (TWO, "write `r(point / point)`"),
            Arguments, Places(LENGTH));
        /// The relative velocity of two points, seen from a frame.
        Velocity = function_row("v", "velocity vel linearvelocity", (THREE,
            "write `v(point / point / frame)`"),
            Motion, Places(SPEED));
        /// The relative acceleration of two points, seen from a frame.
        Acceleration = function_row("a", "acceleration acc accel linearacceleration",
            (THREE, "write `a(point / point / frame)`"), Acceleration, Places(ACCELERATION));
        /// Angular velocity of a frame relative to another frame.
        Omega = function_row("omega", "angularvelocity angvel w ω", (TWO, "write `omega(frame / frame)`"),
            Motion, Places(RATE));
        /// The relative angular acceleration of two frames, seen from a third.
        Alpha = function_row("alpha", "angularacceleration angacc α", (THREE,
            "write `alpha(frame / frame / frame)`"),
            Acceleration, Places(RATE_OF_RATE));
        /// The rate of a coordinate or of an expression.
        Rate = function_row("rate", "ddt dt der derivative diff derive dif speed qdot ratederivative",
            ("one coordinate", "write `rate(coordinate)`"), Rate, TimeDerivative);
        /// Angle between two vectors, or from one vector to another about a third.
        Angle = function_row("angle", "anglebetween",
            ("two vectors, and a third about which it is directed",
             "write `angle(a, b)` or `angle(a, b, normal)`"), Arguments, Of(PLAIN));
        /// The projection of a vector on another.
        Project = function_row("project", "proj projection", (TWO, "write `project(a, b)`"), Arguments,
            LikeFirst);
        /// The momentum of bodies.
        Momentum = function_row("momentum", "", ("a body", "write `momentum(body)`"), Motion,
            Places(MOMENTUM));
        /// The angular momentum of bodies about a point.
        AngularMomentum = function_row("angular_momentum", "",
            ("a body and a point", "write `angular_momentum(body / point)`"),
            Motion, Places(ANGULAR_MOMENTUM));
        /// The kinetic energy of bodies.
        KineticEnergy = function_row("kinetic_energy", "", ("a body", "write `kinetic_energy(body)`"),
            Motion, Places(ENERGY));
        /// A moment or product of inertia of bodies about a point.
        MomentOfInertia = function_row("moment_of_inertia", "",
            ("a body, a point and a direction",
             "write `moment_of_inertia(body / point, direction)`, with a second direction for a product of \
              inertia"),
            Arguments, Moment);
        /// The vector from a point to the centre of mass of bodies.
        CenterOfMass = function_row("center_of_mass", "",
            ("bodies and a point", "write `center_of_mass((first, second) / point)`"),
            Arguments, Places(LENGTH));
        /// The vector from a point to the centre of percussion of a body that rotates about it.
        CenterOfPercussion = function_row("center_of_percussion", "",
            ("a body, a point and an axis",
             "write `center_of_percussion(body / point, z)`: the body rotates about the axis through the \
              point"),
            Arguments, Places(LENGTH));
        /// The vector from a body's origin to its instantaneous centre of rotation.
        InstantCenter = function_row("instant_center", "", (MOVING, "write `instant_center(body / frame)`"),
            Motion, Places(LENGTH));
        /// The vector from a body's origin to the point without acceleration, for planar motion.
        AccelerationCenter = function_row("acceleration_center", "",
            (MOVING, "write `acceleration_center(body / frame)`"),
            Acceleration, Places(LENGTH));
        /// The vector from a body's origin to the nearest point of its screw axis.
        ScrewAxis = function_row("screw_axis", "",
            (MOVING, "write `screw_axis(body / frame)`"), Motion, Places(LENGTH));
        /// The advance of a body along its screw axis per radian.
        ScrewPitch = function_row("screw_pitch", "",
            (MOVING, "write `screw_pitch(body / frame)`"), Motion, Places(LENGTH));
        /// Matrix of the projection onto a line.
        Projector = function_row("projector", "", (ONE, "write `projector(a)`"), Arguments, Of(PLAIN));
        /// The matrix of a cross product.
        Skew = function_row("skew", "", (ONE, "write `skew(a)`"), Arguments, LikeFirst);
        /// The outer product `a bᵀ`.
        Outer = function_row("outer", "", (TWO, "write `outer(a, b)`"), Arguments, Product { scalar: false });
        /// Rotation matrix that takes the axes of one frame to those of another.
        Rotation = function_row("rotation", "",
            ("two frames", "write `rotation(B / A)`, which rotates the axes of A into those of B"),
            Arguments, Of(PLAIN));
        /// The inertia matrix of bodies about a point.
        Inertia = function_row("inertia", "",
            ("bodies and a point", "write `inertia(body / point)` or `inertia((first, second) / point)`"),
            Arguments, Places(INERTIA));
        /// The unit matrix.
        Identity = function_row("identity", "", ("no argument", "write `identity()`"), Arguments, Of(PLAIN));
        /// The transpose of a matrix.
        Transpose = function_row("transpose", "", (ONE, "write `transpose(a)`"), Arguments, LikeFirst);
        /// The sum of the diagonal of a matrix.
        Trace = function_row("trace", "", (ONE, "write `trace(a)`"), Arguments, LikeFirst);
        /// The curvature of a curve.
        Curvature = function_row("curvature", "",
            (CURVE, "write `curvature(curve, s)`, a vector that depends on a coordinate `s`"),
            Arguments, Inverse);
        /// The torsion of a curve.
        Torsion = function_row("torsion", "",
            (CURVE, "write `torsion(curve, s)`, a vector that depends on a coordinate `s`"),
            Arguments, Inverse);
        /// The length of a taut cable around a surface.
        Cable = function_row("cable", "",
            ("two points and a surface",
             "write `cable(a / b, drum.cylinder(radius, axis))` or `cable(a / b, ball.sphere(radius))`"),
            Arguments, Cable);
        /// The gradient of a field at a point.
        Gradient = function_row("gradient", "",
            ("a scalar and a point", "write `gradient(field / point)`, an expression of `r(point / ground)`"),
            Arguments, Gradient);
        /// The power of a force element, an input or a contact.
        Power = function_row("power", "", ("one force element", "write `power(spring)`"), Power, Of(POWER));
        /// The force that a joint transmits.
        ReactionForce = function_row("reaction_force", "force reaction",
            ("one joint", "write `reaction_force(hinge)`"),
            Reaction, Of(FORCE));
        /// The torque that a joint transmits.
        ReactionTorque = function_row("reaction_torque", "torque", ("one joint",
            "write `reaction_torque(hinge)`"),
            Reaction, Of(ENERGY));
        /// The force that a contact transmits.
        ContactForce = function_row("contact_force", "contactforce normalforce",
            ("one contact", "write `contact_force(foot)`"), Reaction, Of(FORCE));
        /// The friction moment that a contact transmits.
        ContactMoment = function_row("contact_moment", "contactmoment contacttorque",
            ("one contact", "write `contact_moment(foot)`"), Reaction, Of(ENERGY));
        /// The density of the standard atmosphere.
        Density = function_row("density", "", (ONE, "write `density(a)`"), Arguments,
            OfHeight(Some(DENSITY)));
        /// The pressure of the standard atmosphere.
        Pressure = function_row("pressure", "", (ONE, "write `pressure(a)`"), Arguments,
            OfHeight(Some(PRESSURE)));
        /// The temperature of the standard atmosphere.
        Temperature = function_row("temperature", "", (ONE, "write `temperature(a)`"), Arguments,
            OfHeight(None));
        /// The speed of sound of the standard atmosphere.
        SpeedOfSound = function_row("speed_of_sound", "", (ONE, "write `speed_of_sound(a)`"),
            Arguments, OfHeight(Some(SPEED)));
        /// The angle of attack of a body with a velocity.
        AngleOfAttack = function_row("angle_of_attack", "",
            (TWO, "write `angle_of_attack(a, b)`"), Arguments, Of(PLAIN));
        /// The sideslip of a body with a velocity.
        Sideslip = function_row("sideslip", "", (TWO, "write `sideslip(a, b)`"), Arguments, Of(PLAIN));
        /// The heading of a body.
        Heading = function_row("heading", "", (ONE, "write `heading(a)`"), Arguments, Of(PLAIN));
        /// The elevation of a body.
        Elevation = function_row("elevation", "", (ONE, "write `elevation(a)`"), Arguments, Of(PLAIN));
        /// The bank angle of a body.
        Bank = function_row("bank", "", (ONE, "write `bank(a)`"), Arguments, Of(PLAIN));
        /// The course of a velocity.
        Course = function_row("course", "", (ONE, "write `course(a)`"), Arguments, Of(PLAIN));
        /// The flight path angle of a velocity.
        FlightPath = function_row("flight_path", "", (ONE, "write `flight_path(a)`"), Arguments, Of(PLAIN));
        /// A vector by its components in stability axes.
        StabilityAxes = function_row("stability_axes", "",
            (THREE, "write `stability_axes(body, velocity, [a, b, c])`"), Arguments, LikeLast);
        /// A vector by its components in wind axes.
        WindAxes = function_row("wind_axes", "", (THREE, "write `wind_axes(body, velocity, [a, b, c])`"),
            Arguments, LikeLast);
    }
}
