//! Code of the features of polytopes in contact.

use super::signature::SignatureContext;
use crate::catalogue::CalledFunction;
use crate::mechanism::{Model, Polytope};
use std::fmt::Write;

/// Polytopes in contact, as data for code generation.
#[derive(Clone, Debug, Default)]
pub struct ContactPolytopes {
    /// Source text of each pair of polytopes.
    pairs: Vec<String>,
    /// Number of features of all pairs.
    features: usize,
}

impl ContactPolytopes {
    /// Returns the polytopes in contact of a model.
    pub fn from_model(model: &Model<'_>) -> ContactPolytopes {
        let pairs = model.polytopes.iter().map(|pair| {
            format!(
                "::linkwork::__private::PolytopePair {{ first: {}, second: {}, points: {} }}",
                polytope_text(&pair.first),
                polytope_text(&pair.second),
                pair.points
            )
        });
        ContactPolytopes { pairs: pairs.collect(), features: model.polytope_feature_count() }
    }

    /// Writes the function that returns the features of all pairs, and its variant for several states.
    pub fn write_methods(&self, out: &mut String, is_batched: bool, s: &SignatureContext<'_>) {
        if self.pairs.is_empty() {
            return;
        }
        let name = CalledFunction::ContactFeatures.function_name();
        let arguments = s.with_time_argument(CalledFunction::ContactFeatures.arguments());
        let names: Vec<&str> = arguments.iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[doc(hidden)]\nfn {name}({}) -> {} {{
                const PAIRS: [::linkwork::__private::PolytopePair<'static>; {}] = [{}];
                ::linkwork::__private::contact_features(&PAIRS, self.__polytope_poses({}).as_slice())
            }}",
            s.parameter_list(&arguments),
            s.vector_type(self.features),
            self.pairs.len(),
            self.pairs.join(", "),
            names.join(", "),
        );
        if !is_batched {
            return;
        }
        let in_lanes = s.scalar.spelling_in_lanes();
        let lanes = SignatureContext { scalar: &in_lanes, ..*s };
        let one = arguments.iter().map(|a| match a.argument_name() {
            "t" => "t.0[k]".to_string(),
            name => format!("&lane({name}, k)"),
        });
        let one: Vec<String> = one.collect();
        let _ = writeln!(
            out,
            "#[doc(hidden)]\nfn {name}_lanes<const LANES: usize>({}) -> {} {{
                use ::linkwork::__private::{{lane, lane_by_lane}};
                lane_by_lane(|k| self.{name}({}))
            }}",
            lanes.parameter_list(&arguments),
            lanes.vector_type(self.features),
            one.join(", "),
        );
    }
}

/// Returns the source text of a polytope.
fn polytope_text(polytope: &Polytope) -> String {
    const PATH: &str = "::linkwork::__private::Polytope";
    let faces = polytope.faces.iter().map(|face| {
        format!(
            "{PATH}Face {{ normal: {:?}, offset: {:?}, corners: &{:?} }}",
            face.normal, face.offset, face.corners
        )
    });
    let edges = polytope
        .edges
        .iter()
        .map(|edge| format!("{PATH}Edge {{ ends: {:?}, faces: {:?} }}", edge.ends, edge.faces));
    format!(
        "{PATH} {{ vertices: &{:?}, faces: &[{}], edges: &[{}], size: {:?}, radius: {:?} }}",
        polytope.vertices,
        faces.collect::<Vec<_>>().join(", "),
        edges.collect::<Vec<_>>().join(", "),
        polytope.half_sum_of_lengths(),
        polytope.radius
    )
}
