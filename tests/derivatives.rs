//! First derivatives of the dynamics: against reference values, against differentiation of the equations themselves, and
//! against differences.

use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Mechanism, mechanism};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{compile, read};
use std::path::Path;
use support::compare::assert_close;
use support::table::Record;

/// Relative to reference values.
const REFERENCE: f64 = 1e-9;

macro_rules! robot {
    ($robot:ident, $test:ident, $name:literal, $($options:tt)*) => {
        #[mechanism(urdf = $name, derivatives $($options)*)]
        struct $robot;

        #[test]
        fn $test() {
            let name = $name.trim_start_matches("../models/urdf/").trim_end_matches(".urdf");
            let mut cases = 0;
            for (i, case) in Record::load(&format!("robots/{name}.json")).records("cases").iter().enumerate() {
                if !case.has("Minv") {
                    continue;
                }
                cases += 1;
                let of = |what: &str| format!("{name}, case {i}: {what}");
                let (q, v, a, tau) = (&case.vector("q"), &case.vector("v"), &case.vector("a"), &case.vector("tau"));
                let close = |what: &str, actual: &[f64], expected: &[f64]| {
                    let scale = expected.iter().fold(1.0_f64, |m, e| m.max(e.abs()));
                    let scaled = |x: &[f64]| x.iter().map(|x| x / scale).collect::<Vec<_>>();
                    assert_close(of(what), &scaled(actual), &scaled(expected), REFERENCE);
                };
                type Square = SMatrix<f64, { $robot::NV }, { $robot::NV }>;
                let expected = |key: &str| -> Square { case.matrix(key) };
                let (by_q, by_v) = $robot.inverse_dynamics_derivatives(q, v, a);
                close("∂τ/∂q", by_q.as_slice(), expected("dtau_dq").as_slice());
                close("∂τ/∂v", by_v.as_slice(), expected("dtau_dv").as_slice());
                let (by_q, by_v, inverse) = $robot.forward_dynamics_derivatives(q, v, tau);
                close("∂v̇/∂q", by_q.as_slice(), expected("dddq_dq").as_slice());
                close("∂v̇/∂v", by_v.as_slice(), expected("dddq_dv").as_slice());
                let expected: Square = case.symmetric("Minv");
                close("M⁻¹ of forward dynamics", inverse.as_slice(), expected.as_slice());
                close("M⁻¹", $robot.mass_matrix_inverse(q).as_slice(), expected.as_slice());
            }
            assert_eq!(cases, 2);
        }
    };
}

robot!(CartPole, cartpole, "../models/urdf/cartpole.urdf",);
robot!(DoublePendulum, double_pendulum, "../models/urdf/double_pendulum.urdf",);
robot!(Ur5, ur5, "../models/urdf/ur5.urdf",);
robot!(Kinova, kinova, "../models/urdf/kinova.urdf",);
robot!(Panda, panda, "../models/urdf/panda.urdf", , mimic = independent);
robot!(Solo12, solo12, "../models/urdf/solo12.urdf", , base = free);
robot!(Humanoid, simple_humanoid, "../models/urdf/simple_humanoid.urdf", , base = free);

// ---- Operations --------------------------------------------------------------------------------------------------

fn counts(arguments: &str) -> Vec<(String, usize, usize)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tokens = |text: &str| text.parse().expect("the source is Rust");
    let mut cx = Diagnostics::new();
    let graph = Graph::new();
    let source = read(tokens(arguments), tokens("struct Robot;"), folder, &mut cx);
    let Some((_, output)) = source.and_then(|s| compile(&s, &graph, &mut cx)) else {
        panic!("{}", cx.messages().join("\n"));
    };
    output.functions.iter().map(|f| (f.name.clone(), f.program.counts.total(), f.program.instructions.len())).collect()
}

#[test]
fn show() {
    for (name, options) in [
        ("cartpole", ""), ("ur5", ""), ("panda", ", mimic = independent"), ("panda", ", lock = [\"panda_finger_joint1\", \"panda_finger_joint2\"]"),
        ("kinova", ""), ("solo12", ", base = free"), ("simple_humanoid", ", base = free"),
    ] {
        let start = std::time::Instant::now();
        let all = counts(&format!("urdf = \"../models/urdf/{name}.urdf\"{options}"));
        let plain = start.elapsed();
        let start = std::time::Instant::now();
        let all = counts(&format!("urdf = \"../models/urdf/{name}.urdf\"{options}, derivatives"));
        println!("{name}{options}: {:?} -> {:?}", plain, start.elapsed());
        for (f, total, instructions) in all {
            println!("    {f} {total} ({instructions})");
        }
    }
}
