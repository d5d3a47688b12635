//! Tests of error messages for element types in the terminology of other tools.

use super::{ARM, CART, ErrorRow, check_error_rows};

/// Type names of other tools, with the element of the language that corresponds to each.
const ONE: &[(&str, &str)] = &[
    ("RevoluteJoint", "Pin"),
    ("Revolute", "Pin"),
    ("HingeJoint", "Pin"),
    ("Rotary", "Pin"),
    ("PinJoint", "Pin"),
    ("Pivot", "Pin"),
    ("PrismaticJoint", "Sleeve"),
    ("Slide", "Sleeve"),
    ("Translational", "Sleeve"),
    ("Piston", "Sleeve"),
    ("FixedJoint", "Weld"),
    ("Locked", "Weld"),
    ("SphericalJoint", "Ball"),
    ("BallJoint", "Ball"),
    ("Socket", "Ball"),
    ("CylindricalJoint", "Collar"),
    ("HelicalJoint", "Screw"),
    ("LeadScrew", "Screw"),
    ("FreeJoint", "Free"),
    ("FloatingBase", "Free"),
    ("SixDOF", "Free"),
    ("Gimbal", "Universal"),
    ("XYStage", "Stage"),
    ("Cartesian", "Stage"),
    ("Rigid_Body", "Body"),
    ("Segment", "Body"),
    ("Linkage", "Body"),
    ("MassPoint", "Particle"),
    ("ShockAbsorber", "Dashpot"),
    ("TorsionSpring", "Spring"),
    ("RotationalSpring", "Spring"),
    ("LinearSpring", "Spring"),
    ("Servo", "Torque"),
    ("Moment", "Torque"),
    ("Thrust", "Force"),
    ("CoulombFriction", "Friction"),
    ("GeneralizedCoordinate", "Coordinate"),
    ("DynamicSymbol", "Coordinate"),
    ("Control", "Input"),
    ("ReferenceFrame", "Frame"),
    ("Marker", "Point"),
    ("Site", "Point"),
    ("PotentialEnergy", "Potential"),
    ("Dissipation", "Rayleigh"),
    ("Vec3", "Vector"),
    ("Real", "f64"),
    ("Float", "f64"),
    ("Parameter", "f64"),
    ("Constant", "f64"),
];

#[test]
fn synonyms_of_other_tools_get_suggestions() {
    for (said, meant) in ONE {
        let message = format!("unknown element type `{said}`");
        let help = format!("did you mean `{meant}`?");
        for attribute in ["", "#[joint(ground -> arm, about = z)] ", "#[acts(on = hinge)] "] {
            let fields = format!("{ARM} {attribute}other: {said}");
            let found = super::compiler_messages("", &fields);
            let good = matches!(found.as_slice(), [one] if one.starts_with(&message) && one.contains(&help));
            assert!(good, "{fields}\nexpected {help}\nfound {}", found.join("\n"));
        }
    }
}

/// Types without a corresponding element, which are expressed in another way.
const OTHERS: &[ErrorRow] = &[
    ("Mass", "unknown element type `Mass`", "if it is extended or rotates"),
    ("Joint", "unknown element type `Joint`", "`Pin`, `Sleeve`"),
    ("Gear", "unknown element type `Gear`", "`#[constraint(second + ratio * first = 0)] gear: Holonomic`"),
    ("Belt", "unknown element type `Belt`", "Holonomic"),
    ("Rope", "unknown element type `Rope`", "energy = k / 2 * pow(max(stretch, 0), 2)"),
    ("Tendon", "unknown element type `Tendon`", "max(stretch, 0)"),
    ("EndStop", "unknown element type `EndStop`", "energy = k / 2 * pow(min(stretch - low, 0), 2)"),
    ("EndStop", "unknown element type `EndStop`", "energy = k / 2 * pow(min(stretch - low, 0), 2)"),
    ("Collision", "unknown element type `Collision`", "are a `Contact`"),
    ("Wheel", "unknown element type `Wheel`", "rolls(wheel.circle(radius, y), ground.plane(z))"),
    ("Controller", "unknown element type `Controller`", "an input, `Force`, `Torque` or `Input`"),
    ("Geometry", "unknown element type `Geometry`", "inertia = cuboid(m, a, b, c)"),
    ("Ground", "unknown element type `Ground`", "a joint connects a body to it"),
    ("World", "unknown element type `World`", "a joint connects a body to it"),
    ("Lagrangian", "unknown element type `Lagrangian`", "`Potential`"),
    (
        "Constraint",
        "unknown element type `Constraint`",
        "`Holonomic`, `Nonholonomic`, `Rolling` or `Slipping`",
    ),
    ("Output", "unknown element type `Output`", "`Scalar` or `Vector` with `#[output(…)]`"),
    ("Sensor", "unknown element type `Sensor`", "`Scalar` or `Vector` with `#[output(…)]`"),
    ("SpringDamper", "unknown element type `SpringDamper`", "a `Spring` and a `Dashpot`, a field for each"),
    ("Time", "unknown element type `Time`", "time is `t`"),
    ("bool", "field `other` has a type that is not supported in a mechanism", "a field is a parameter"),
    ("usize", "the parameter `other` cannot have the type `usize`", "parameters are real numbers"),
    ("[f64; 3]", "field `other` has a type that is not supported in a mechanism", "a field is a parameter"),
    ("Vector3<f64>", "field `other` has a type that is not supported in a mechanism", "three parameters"),
    ("Spaceship", "unknown element type `Spaceship`", "`linkwork::elements` lists them"),
];

#[test]
fn foreign_concepts_get_an_explanation() {
    check_error_rows(|said| (String::new(), format!("{CART} other: {said}")), OTHERS);
}
