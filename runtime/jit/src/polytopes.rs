//! Features of polytopes in contact, which programs take as inputs.

use crate::layout::InputLayout;
use crate::routine::Values;
use crate::shared::SharedMechanism;
use linkwork::__private as runtime;
use linkwork_compiler::catalogue::{Argument, CalledFunction};
use linkwork_compiler::lower::Program;
use linkwork_compiler::mechanism::{Model, PAIR_POSE, Polytope, Quantity};

/// Name of the function that computes the poses of all pairs of polytopes.
const POSES: &str = "__polytope_poses";

/// Pairs of polytopes in contact.
#[derive(Default)]
pub(crate) struct Polytopes {
    /// Polytopes of both surfaces, and maximum number of contact points of a face.
    pairs: Vec<(Polytope, Polytope, usize)>,
    /// Number of features of all pairs.
    features: usize,
}

impl Polytopes {
    /// Returns the pairs of polytopes of a model.
    pub fn of_model(model: &Model<'_>) -> Polytopes {
        let pairs = model.polytopes.iter();
        Polytopes {
            pairs: pairs.map(|pair| (pair.first.clone(), pair.second.clone(), pair.points)).collect(),
            features: model.polytope_feature_count(),
        }
    }

    /// Returns true if no contact depends on features of polytopes.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Returns the features of all pairs in the given poses.
    fn features_in_poses(&self, poses: &[f64]) -> Vec<f64> {
        let mut features = vec![0.0; self.features];
        let mut rest = features.as_mut_slice();
        for ((first, second, points), pose) in self.pairs.iter().zip(poses.chunks_exact(PAIR_POSE)) {
            let faces = [first, second].map(borrowed_faces);
            let edges = [first, second].map(borrowed_edges);
            let [first, second] = [(first, 0), (second, 1)].map(|(shape, k)| runtime::Polytope {
                vertices: &shape.vertices,
                faces: &faces[k],
                edges: &edges[k],
                size: shape.half_sum_of_lengths(),
                radius: shape.radius,
            });
            let pair = runtime::PolytopePair { first, second, points: *points };
            let (own, others) = rest.split_at_mut(pair.feature_count());
            runtime::write_contact_features(&[pair], pose, own);
            rest = others;
        }
        features
    }
}

fn borrowed_faces(shape: &Polytope) -> Vec<runtime::PolytopeFace<'_>> {
    let faces = shape.faces.iter();
    faces
        .map(|face| runtime::PolytopeFace {
            normal: face.normal,
            offset: face.offset,
            corners: &face.corners,
        })
        .collect()
}

fn borrowed_edges(shape: &Polytope) -> Vec<runtime::PolytopeEdge> {
    shape.edges.iter().map(|edge| runtime::PolytopeEdge { ends: edge.ends, faces: edge.faces }).collect()
}

/// Whether a program takes features of polytopes as inputs.
pub(crate) fn takes_features(program: &Program) -> bool {
    let features = Argument::Called(CalledFunction::ContactFeatures);
    program
        .used_symbols()
        .into_iter()
        .any(|symbol| features.index_of_quantity(Quantity::from_symbol(symbol)).is_some())
}

impl SharedMechanism {
    /// Calls `f` with the inputs of a function, to which the features of polytopes are added.
    pub fn call_with_polytope_features(
        &self,
        values: Values<'_>,
        arguments: &[Argument],
        f: impl FnOnce(Values<'_>),
    ) {
        let poses = self.index.get(POSES).map(|function| {
            let mut poses = vec![0.0; self.entries[*function].length];
            self.call(*function, values, arguments, &[], &mut poses, &mut []);
            poses
        });
        let features = self.polytopes.features_in_poses(&poses.unwrap_or_default());
        let mut inputs: [&[f64]; InputLayout::MOST] = [&[]; InputLayout::MOST];
        let count = values.arguments.len();
        inputs[..count].copy_from_slice(values.arguments);
        inputs[count] = &features;
        f(Values { arguments: &inputs[..=count], ..values });
    }
}
