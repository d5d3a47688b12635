//! Names that generated code could use for its own values.

#![deny(warnings)]

use linkwork::prelude::*;

#[mechanism(gravity = -q0 * r#type * y)]
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case, reason = "a name of generated code")]
pub struct Names {
    pub q: f64,
    pub v: f64,
    pub a: f64,
    pub u: f64,
    pub tau: f64,
    pub dv: f64,
    pub p: f64,
    pub o: f64,
    pub zero: f64,
    pub frame: f64,
    pub constant: f64,
    pub sin_cos: f64,
    pub mul_add: f64,
    pub missing: f64,
    pub from: f64,
    pub to: f64,
    pub q0: f64,
    pub v0: f64,
    pub t0: f64,
    pub t1: f64,
    pub r0: f64,
    pub x0: f64,
    pub linkwork: f64,
    pub core: f64,
    pub r#type: f64,
    pub r#match: f64,
    pub mass_matrix: f64,
    pub neutral: f64,
    pub NQ: f64,
    pub masse_größe: f64,
    #[body(
        mass = q + v + a + u + tau + dv + p + o + zero + frame + constant + sin_cos + mul_add + missing,
        com = (from * to + q0 * v0) * y + (t0 / t1) * x,
        inertia = diagonal(1 + r0, 1 + x0, 1)
    )]
    r#loop: Body,
    #[body(mass = linkwork + core + r#type + r#match + mass_matrix + neutral + NQ + masse_größe)]
    _1: Body,
    #[joint(ground -> r#loop, about = z)]
    v1: Pin,
    #[joint(r#loop -> _1, along = x)]
    r#fn: Sleeve,
    #[acts(on = r#fn, stiffness = t0 * from)]
    r#struct: Spring,
    #[acts(on = v1)]
    self_: Torque,
}

#[mechanism]
pub struct Generic<T> {
    pub constant: T,
    pub q0: T,
    pub t0: T,
    #[body(mass = constant, com = sin(q0) * cos(t0) * x)]
    pub arm: Body,
    #[joint(ground -> arm, about = z)]
    pub hinge: Pin,
}

#[test]
fn generated_variable_names_do_not_clash_with_user_names() {
    let names = Names {
        q: 1.0,
        v: 1.0,
        a: 1.0,
        u: 1.0,
        tau: 1.0,
        dv: 1.0,
        p: 1.0,
        o: 1.0,
        zero: 1.0,
        frame: 1.0,
        constant: 1.0,
        sin_cos: 1.0,
        mul_add: 1.0,
        missing: 1.0,
        from: 1.0,
        to: 1.0,
        q0: 1.0,
        v0: 1.0,
        t0: 1.0,
        t1: 1.0,
        r0: 1.0,
        x0: 1.0,
        linkwork: 1.0,
        core: 1.0,
        r#type: 1.0,
        r#match: 1.0,
        mass_matrix: 1.0,
        neutral: 1.0,
        NQ: 1.0,
        masse_größe: 1.0,
    };
    let q = names.neutral();
    assert_eq!(names.total_mass(), 22.0);
    assert_eq!(names.mass_matrix(&q)[(1, 1)], 8.0);
    assert_eq!(Names::VELOCITIES, ["v1", "fn"]);
    assert_eq!(Names::FRAMES, ["loop", "_1"]);
    let _ = names.frame_placement(frame!(Names, "loop"), &q);
    let generic = Generic { constant: 2.0_f32, q0: 1.0, t0: 1.0 };
    assert!(generic.mass_matrix(&generic.neutral())[0] > 0.0);
}
