//! Passes from `Model` to `Model` that choose link frames and redistribute mass properties so that the
//! equations cost less. Every pass is exact up to rounding and can be switched off.

use crate::kinematics::{Joint, joints_of_model};
use crate::mechanism::Model;

mod candidates;
mod cost;
mod frames;
mod motions;
mod number;
mod parallel;
mod regroup;
mod slide;

pub use frames::{characteristic_link_sizes, choose_link_frames};
pub use motions::VanishingMomentConvention;
pub use parallel::variants_in_common_axes;
pub use regroup::{RegroupOptions, move_inertias_to_parents};

/// Selection of the passes over the model that run.
#[derive(Clone, Copy, Debug)]
pub struct PassSelection {
    /// Whether the pass runs that chooses link frames with sparse placements.
    pub frames: bool,
    /// Whether the pass runs that moves mass properties towards the base.
    pub regroup: bool,
    /// Whether expressions of parameters alone are treated as free, because they are computed in advance.
    pub free_parameters: bool,
    /// Resolves links on parallel revolute joints in common axes, where that costs less.
    pub parallel: bool,
    /// Whether identical limbs, and joints of one path to the root, are evaluated in SIMD lanes.
    pub lanes: bool,
}

impl Default for PassSelection {
    fn default() -> PassSelection {
        PassSelection { frames: true, regroup: true, free_parameters: false, parallel: true, lanes: true }
    }
}

impl PassSelection {
    /// Returns the numbers of SIMD lanes that are tried for joints of one path. Code without lanes is tried
    /// in
    /// every case.
    pub fn tried_lane_counts(&self, nv: usize) -> &'static [usize] {
        match nv {
            _ if !self.lanes => &[],
            0..4 => &[],
            4..12 => &[4],
            _ => &[4, 8],
        }
    }
}

/// Model that is equivalent to the original one, in other frames or with other mass properties.
#[derive(Clone)]
pub struct ModelVariant<'g> {
    /// Model with mass properties resolved in the axes of its joints.
    pub model: Model<'g>,
    /// Joints of the variant's model.
    pub joints: Vec<Joint<'g>>,
    /// True if masses were also moved to children, which pays for inverse dynamics only.
    pub for_inverse_dynamics: bool,
}

/// Runs the passes; returns variants with the same frames and different distributions of mass properties.
pub fn model_variants<'g>(model: &Model<'g>, passes: PassSelection) -> Vec<ModelVariant<'g>> {
    let mut start = model.clone();
    if passes.regroup {
        // Frames are chosen by the mass properties that remain.
        move_inertias_to_parents(&mut start, RegroupOptions::default());
    }
    if passes.frames {
        slide::slide_frames(&mut start);
        choose_link_frames(&mut start, &characteristic_link_sizes(model), passes.free_parameters);
    }
    let joints = joints_of_model(&start);
    if !passes.regroup {
        return vec![ModelVariant { model: start, joints, for_inverse_dynamics: false }];
    }
    let mut variants: Vec<ModelVariant<'g>> = Vec::new();
    let small = model.nv() <= EXHAUSTIVE_VELOCITIES;
    for (gauge, to_children, symbolic, always) in DISTRIBUTIONS {
        if !(small || always) {
            continue;
        }
        let mut model = start.clone();
        move_inertias_to_parents(&mut model, RegroupOptions { gauge, to_children, symbolic });
        add_distinct_variant(
            &mut variants,
            ModelVariant { model, joints: joints.clone(), for_inverse_dynamics: to_children },
        );
    }
    if !passes.frames {
        add_distinct_variant(
            &mut variants,
            ModelVariant { model: model.clone(), joints, for_inverse_dynamics: false },
        );
    }
    variants
}

/// Maximum number of velocities for which all distributions are tried; beyond it their savings are not worth
/// the time.
const EXHAUSTIVE_VELOCITIES: usize = 18;

/// Distributions: gauge, masses also to children, symbolic properties too, tried for any number of
/// velocities.
const DISTRIBUTIONS: [(VanishingMomentConvention, bool, bool, bool); 6] = [
    (VanishingMomentConvention::Second, false, false, true),
    (VanishingMomentConvention::First, false, false, false),
    (VanishingMomentConvention::Second, false, true, true),
    (VanishingMomentConvention::Second, true, false, true),
    (VanishingMomentConvention::First, true, false, false),
    (VanishingMomentConvention::Flat, true, false, true),
];

/// Adds a variant to the list unless an equal one is in it.
fn add_distinct_variant<'g>(variants: &mut Vec<ModelVariant<'g>>, variant: ModelVariant<'g>) {
    let inertias_of_links =
        |f: &ModelVariant<'g>| f.model.links.iter().map(|l| l.inertia).collect::<Vec<_>>();
    if !variants.iter().any(|known| inertias_of_links(known) == inertias_of_links(&variant)) {
        variants.push(variant);
    }
}
