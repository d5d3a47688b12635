//! Values that the compiler rejects as numbers are rejected by `validate` as parameters.

use linkwork::lanes::f64x4;
use linkwork::{Fault, Lanes, ParameterError, Real, mechanism};
use proc_macro2::{Group, TokenStream, TokenTree};
use std::path::Path;

/// Defines a mechanism with parameters, and a constant with the text of its elements.
macro_rules! with_text {
    ($text:ident, $name:ident { $($parameter:ident: $value:literal,)* } { $($elements:tt)* }) => {
        #[mechanism(gravity = -9.81 * y)]
        #[derive(Clone, Copy)]
        struct $name<T> { $($parameter: T,)* $($elements)* }

        impl<T: Real> $name<T> {
            fn sound_parameters() -> Self {
                $name { $($parameter: linkwork::nalgebra::convert($value),)* }
            }

            fn set_parameter(&mut self, name: &str, value: T) {
                match name {
                    $(stringify!($parameter) => self.$parameter = value,)*
                    _ => panic!("no parameter {name}"),
                }
            }
        }

        const $text: (&[(&str, f64)], &str) = (&[$((stringify!($parameter), $value),)*], stringify!($($elements)*));
    };
}

with_text! { ARM, Arm {
    m: 2.0, offset: 0.1, xx: 0.2, yy: 0.3, zz: 0.4, radius: 0.1, height: 0.3, load: 0.5, reach: 0.6, d: 0.1, dry: 0.2,
    b: 0.3, smooth: 0.01, rotor: 0.02, low: -1.0, high: 1.0, fast: 3.0, strong: 50.0,
} {
    #[body(mass = m, com = [offset, 0, 0], inertia = [[xx, 0, 0], [0, yy, 0], [0, 0, zz]])]
    arm: Body,
    #[body(mass = 1, inertia = cylinder(1, radius, height, z))]
    drum: Body,
    #[particle(mass = load, at = arm.at(0.1 * x))]
    tool: Particle,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[joint(arm.at(reach * x) -> drum, about = x)]
    axle: Pin,
    #[acts(on = hinge, damping = d)]
    dashpot: Dashpot,
    #[acts(on = axle, coulomb = dry, viscous = b, speed = smooth)]
    friction: Friction,
    #[acts(on = axle, inertance = rotor)]
    motor: Inerter,
    #[limit(on = hinge, from = low, to = high, max_speed = fast, max_effort = strong)]
    range: Limit,
} }

with_text! { WHEELS, Wheels {
    size: 0.3, half: 0.4, grip: 0.5, smooth: 0.01, qx: 0.0, qw: 1.0,
} {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    wheel: Body,
    #[joint(ground.rotated(quaternion(qx, 0, 0, qw)) -> wheel)]
    pose: Free,
    #[constraint(slips(wheel.sphere(size), ground.plane(y)), friction = grip, speed = smooth)]
    contact: Slipping,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    top: Body,
    #[joint(ground -> top)]
    flight: Free,
    #[constraint(rolls(top.cone(half, z), ground.plane(y)))]
    rolling: Rolling,
} }

/// Returns the tokens of a mechanism with parameters replaced by numbers.
fn tokens_with_substituted_parameters(tokens: TokenStream, values: &[(&str, f64)]) -> TokenStream {
    let replace_by_number = |token: TokenTree| match &token {
        TokenTree::Ident(name) => match values.iter().find(|(known, _)| name == known) {
            Some((_, value)) => format!("({value:e})").parse().unwrap(),
            None => TokenStream::from(token),
        },
        TokenTree::Group(group) => {
            let inner = tokens_with_substituted_parameters(group.stream(), values);
            TokenTree::from(Group::new(group.delimiter(), inner)).into()
        }
        _ => token.into(),
    };
    tokens.into_iter().map(replace_by_number).collect()
}

/// Returns the error messages of the compiler for the mechanism with these numbers.
fn compiler_messages((values, elements): (&[(&str, f64)], &str), change: (&str, f64)) -> Vec<String> {
    let values: Vec<(&str, f64)> =
        values.iter().map(|(name, x)| (*name, if *name == change.0 { change.1 } else { *x })).collect();
    // No parameter of these mechanisms has the name of an attribute.
    let elements = tokens_with_substituted_parameters(elements.parse().unwrap(), &values);
    let item = quote::quote!(struct Machine { #elements });
    linkwork_compiler::check_mechanism("gravity = -9.81 * y".parse().unwrap(), item, Path::new(""))
}

/// A parameter, a value without physical meaning, the fault, and a part of the message.
const ARM_ROWS: [(&str, f64, Fault, &str); 21] = [
    ("m", -1.0, Fault::Negative, "the mass of `arm`"),
    ("m", 1e200, Fault::TooLarge, "the mass of `arm`"),
    ("m", 1e-305, Fault::TooSmall, "the mass of `arm`"),
    ("offset", 1e80, Fault::TooLarge, "the centre of mass of `arm`"),
    ("xx", 0.8, Fault::Inertia, "the inertia of `arm`"),
    ("xx", 0.701, Fault::Inertia, "the inertia of `arm`"),
    ("yy", -0.1, Fault::Inertia, "the inertia of `arm`"),
    ("zz", 1e160, Fault::TooLarge, "the inertia of `arm`"),
    ("radius", -0.1, Fault::Negative, "the radius of a `cylinder`"),
    ("height", -0.1, Fault::Negative, "the height of a `cylinder`"),
    ("load", -0.5, Fault::Negative, "the mass of `tool`"),
    ("reach", -1e80, Fault::TooLarge, "the position of a joint on `arm`"),
    ("d", -0.1, Fault::Negative, "the damping of `dashpot`"),
    ("dry", -0.1, Fault::Negative, "friction"),
    ("b", -0.1, Fault::Negative, "friction"),
    ("smooth", 0.0, Fault::NotPositive, "speed"),
    ("rotor", -0.1, Fault::Negative, "inertance"),
    ("low", 1.5, Fault::EmptyRange, "the range of `hinge`"),
    ("high", -1.5, Fault::EmptyRange, "the range of `hinge`"),
    ("fast", -1.0, Fault::Negative, "the largest speed of `hinge`"),
    ("strong", -1.0, Fault::Negative, "the largest effort of `hinge`"),
];

const WHEEL_ROWS: [(&str, f64, Fault, &str); 7] = [
    ("size", 0.0, Fault::NotPositive, "the radius of a sphere"),
    ("half", -0.4, Fault::NotHalfAngle, "the half angle of a cone"),
    ("half", 1.6, Fault::NotHalfAngle, "the half angle of a cone"),
    ("grip", -0.5, Fault::Negative, "the friction of `contact`"),
    ("smooth", -0.1, Fault::NotPositive, "the speed of `contact`"),
    ("qx", 0.1, Fault::NotUnit, "a quaternion"),
    ("qw", 0.5, Fault::NotUnit, "a quaternion"),
];

/// Checks that each row is rejected, that the error names the parameter, and that the compiler rejects the
/// number, too.
macro_rules! check {
    ($name:ident, $text:ident, $rows:ident) => {
        assert_eq!($name::<f64>::sound_parameters().validate(), Ok(()));
        assert_eq!($name::<f32>::sound_parameters().validate(), Ok(()));
        assert_eq!(compiler_messages($text, ("", 0.0)), Vec::<String>::new());
        for (parameter, value, fault, figure) in $rows {
            let mut wrong = $name::<f64>::sound_parameters();
            wrong.set_parameter(parameter, value);
            let error: ParameterError = wrong.validate().expect_err(parameter);
            assert_eq!(error.fault, fault, "{parameter} = {value}: {error}");
            assert!(error.parameters.contains(&parameter), "{error}");
            assert!(error.figure.contains(figure), "{error}");
            let said = compiler_messages($text, (parameter, value));
            assert_eq!(said.len(), 1, "{parameter} = {value}: {said:?}");
            // One of four lanes is wrong.
            let mut lanes = $name::<f64x4>::sound_parameters();
            let own = $text.0.iter().find(|(name, _)| *name == parameter).unwrap().1;
            lanes.set_parameter(parameter, Lanes([own, own, value, own]));
            assert_eq!(lanes.validate().map_err(|e| e.fault), Err(fault), "a lane of {parameter}");
        }
        for (parameter, _) in $text.0 {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut wrong = $name::<f64>::sound_parameters();
                wrong.set_parameter(parameter, value);
                let error = wrong.validate().expect_err(parameter);
                assert_eq!(error.fault, Fault::NotFinite, "{parameter} = {value}: {error}");
                assert!(error.parameters.contains(parameter), "{error}");
            }
        }
    };
}

#[test]
fn invalid_numbers_and_parameters_break_the_same_conditions() {
    check!(Arm, ARM, ARM_ROWS);
    check!(Wheels, WHEELS, WHEEL_ROWS);
}

/// A load of zero mass and the inertia of a rod, which is at the bound of physical consistency, are accepted.
#[test]
fn mass_properties_at_the_physical_bound_are_valid() {
    assert_eq!(Arm { load: 0.0, ..Arm::<f64>::sound_parameters() }.validate(), Ok(()));
    assert_eq!(Arm { xx: 0.1, yy: 0.3, zz: 0.4, ..Arm::<f64>::sound_parameters() }.validate(), Ok(()));
    assert_eq!(Arm { xx: 0.1, yy: 0.3, zz: 0.4, ..Arm::<f32>::sound_parameters() }.validate(), Ok(()));
    assert_eq!(Arm { m: 0.0, offset: -2.0, ..Arm::<f64>::sound_parameters() }.validate(), Ok(()));
}

/// Trusted inertia is not validated, nor is a parameter that no element uses, nor the sign of a stiffness,
/// which may be negative.
#[mechanism(inertia = trust)]
struct ArmWithTrustedInertia {
    moment: f64,
    stiffness: f64,
    _own: f64,
    #[body(mass = 1, inertia = diagonal(moment, 1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    hinge: Pin,
    #[acts(on = hinge, stiffness = stiffness)]
    spring: Spring,
}

#[test]
fn trusted_inertia_need_only_be_finite() {
    let sound = ArmWithTrustedInertia { moment: 5.0, stiffness: -1.0, _own: f64::NAN };
    assert_eq!(sound.validate(), Ok(()));
    let error = ArmWithTrustedInertia { moment: f64::NAN, ..sound }.validate().unwrap_err();
    assert_eq!((error.fault, error.parameters), (Fault::NotFinite, &["moment"][..]));
    let error = ArmWithTrustedInertia { stiffness: f64::INFINITY, ..sound }.validate().unwrap_err();
    assert_eq!(error.to_string(), "the parameter `stiffness` is not a finite number: it is inf");
}
