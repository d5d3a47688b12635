//! What a mechanism does not have, with the reason: functions of words that it does not name, of constraints that it has
//! none of, Jacobians of outputs that depend on accelerations.

use super::signatures::{self, Sizes};
use crate::emit::{Absent, Function};
use crate::syntax::Requests;

/// Functions of mechanisms with constraints that are written as they are.
const SOLVED: [&str; 6] = [
    "assemble",
    "complete_velocity",
    "constrained_dynamics",
    "constraint_correction",
    "project_configuration",
    "project_velocity",
];

/// Functions of the configuration space, which `batch` gives for several states too.
const MANIFOLD: [&str; 3] = ["difference", "integrate", "tangent_rate"];

/// All that a mechanism with these functions and outputs lacks.
pub fn absent(
    sizes: &Sizes,
    requests: Requests,
    functions: &[Function],
    outputs: &[String],
    constrained: bool,
) -> Vec<Absent> {
    let mut all = on_request(sizes, requests, functions, constrained);
    if functions.iter().all(|f| f.name != "mass_matrix") {
        // Kinematics alone: whatever else there may be needs inertia first.
        let dynamics = signatures::always(sizes);
        let words = all.iter().flat_map(|absent| absent.functions.iter().cloned());
        let constants = all.iter().flat_map(|absent| absent.constants.iter().copied()).collect();
        let solved = constrained.then_some(SOLVED.map(ToString::to_string)).into_iter().flatten();
        let functions = public(&dynamics).chain(solved).chain(words).collect();
        all = vec![Absent { reason: "HasInertia", functions, constants }];
    }
    if !constrained {
        let functions = signatures::constrained(sizes, 1, 1, 0, false);
        all.push(Absent {
            reason: "HasConstraints",
            functions: public(&functions).chain(SOLVED.map(ToString::to_string)).collect(),
            constants: vec!["CONSTRAINTS", "NC", "NH", "NP", "NS"],
        });
    }
    all.push(Absent {
        reason: "HasJacobiansOfAccelerations",
        functions: outputs.iter().map(|name| format!("{name}_jacobian")).collect(),
        constants: Vec::new(),
    });
    // Outputs may have such a name.
    for absent in &mut all {
        absent.functions.retain(|name| functions.iter().all(|f| f.name != *name));
    }
    all
}

/// The functions of the words that are not given.
fn on_request(sizes: &Sizes, requests: Requests, functions: &[Function], constrained: bool) -> Vec<Absent> {
    let derivatives = signatures::derivatives(sizes);
    let into: Vec<Function> = derivatives.iter().filter_map(|f| signatures::into(f, sizes.nv)).collect();
    let mut derivatives: Vec<String> = public(&derivatives).chain(public(&into)).collect();
    let mut unconstrained = Vec::new();
    if constrained {
        let is_other = |name: &String| !name.starts_with("forward_dynamics_derivatives_");
        unconstrained = derivatives.iter().filter(|name| !is_other(name)).cloned().collect();
        derivatives.retain(is_other);
    }
    let prepare = vec!["prepare".to_string()];
    let in_lanes = public(functions)
        .filter(|name| functions.iter().any(|f| f.name == *name && !f.arguments.is_empty()))
        .chain(MANIFOLD.map(ToString::to_string))
        .chain(constrained.then(|| "forward_dynamics".to_string()))
        .map(|name| format!("{name}_lanes"));
    let words = [
        (requests.derivatives, "AsksForDerivatives", derivatives, vec![]),
        (requests.centroidal, "AsksForCentroidal", public(&signatures::centroidal(sizes)).collect(), vec![]),
        (
            requests.regressor,
            "AsksForRegressor",
            public(&signatures::regressor(sizes, 0, 0)).collect(),
            vec!["BASE_PARAMETERS", "BODIES"],
        ),
        (
            requests.sensitivities,
            "AsksForSensitivities",
            public(&signatures::sensitivities(sizes, 0)).collect(),
            vec!["PARAMETERS"],
        ),
        (
            requests.packed,
            "AsksForPacked",
            public(&signatures::packed(sizes, &[])).collect(),
            vec!["MASS_MATRIX_ENTRIES"],
        ),
        (requests.prepare, "AsksForPrepare", prepare, vec![]),
        (requests.batch, "AsksForBatch", in_lanes.collect(), vec![]),
        (!constrained, "HasNoConstraints", unconstrained, vec![]),
    ];
    let missing = words.into_iter().filter(|(given, ..)| !given);
    let mut missing: Vec<Absent> =
        missing.map(|(_, reason, functions, constants)| Absent { reason, functions, constants }).collect();
    if requests.batch {
        for absent in missing.iter_mut().filter(|absent| absent.reason != "AsksForPrepare") {
            let in_lanes: Vec<String> = absent.functions.iter().map(|name| format!("{name}_lanes")).collect();
            absent.functions.extend(in_lanes);
        }
    }
    missing
}

/// The names of the functions that are not hidden.
fn public(functions: &[Function]) -> impl Iterator<Item = String> + '_ {
    functions.iter().filter(|f| !f.docs.is_empty()).map(|f| f.name.clone())
}
