//! `Model` → `Model`: the same mechanism with other link frames and other mass properties, whose equations cost less.
//! Every pass is exact up to rounding and can be switched off.

use crate::kinematics::{Joint, joints};
use crate::mechanism::Model;

mod candidates;
mod cost;
mod frames;
mod motions;
mod number;
mod parallel;
mod regroup;
mod slide;

pub use frames::{place_frames, sizes};
pub use motions::Gauge;
pub use parallel::in_common_axes;
pub use regroup::{Regroup, regroup};

/// Which passes are run.
#[derive(Clone, Copy, Debug)]
pub struct Passes {
    /// Link frames are moved to where placements are sparse.
    pub frames: bool,
    /// Mass properties are moved towards the base.
    pub regroup: bool,
    /// What depends on parameters alone costs nothing: it is computed before.
    pub free_parameters: bool,
    /// Links that turn about parallel axes are described in common axes, where that costs less.
    pub parallel: bool,
    /// Alike limbs are evaluated as the lanes of one, and so are joints of one path to the root.
    pub lanes: bool,
}

impl Default for Passes {
    fn default() -> Passes {
        Passes { frames: true, regroup: true, free_parameters: false, parallel: true, lanes: true }
    }
}

impl Passes {
    /// In how many lanes joints of one path are tried, beside none, by the number of velocities.
    pub fn wide(&self, nv: usize) -> &'static [usize] {
        match nv {
            _ if !self.lanes => &[],
            0..4 => &[],
            4..12 => &[4],
            _ => &[4, 8],
        }
    }
}

/// A model that has the same functions as another.
#[derive(Clone)]
pub struct Variant<'g> {
    /// The model. Its mass properties are seen from the axes of its joints.
    pub model: Model<'g>,
    /// The model's joints.
    pub joints: Vec<Joint<'g>>,
    /// Masses were moved to children too: that is good for inverse dynamics alone.
    pub for_inverse_dynamics: bool,
}

/// The model after the passes, its mass properties distributed in several ways. The frames are the same in all.
pub fn variants<'g>(model: &Model<'g>, passes: Passes) -> Vec<Variant<'g>> {
    let mut start = model.clone();
    if passes.regroup {
        // Frames are chosen by what is left of the mass properties.
        regroup(&mut start, Regroup::default());
    }
    if passes.frames {
        slide::slide_frames(&mut start);
        place_frames(&mut start, &sizes(model), passes.free_parameters);
    }
    let joints = joints(&start);
    if !passes.regroup {
        return vec![Variant { model: start, joints, for_inverse_dynamics: false }];
    }
    let mut variants: Vec<Variant<'g>> = Vec::new();
    let small = model.nv() <= EXHAUSTIVE_VELOCITIES;
    for (gauge, to_children, symbolic, always) in DISTRIBUTIONS {
        if !(small || always) {
            continue;
        }
        let mut model = start.clone();
        regroup(&mut model, Regroup { gauge, to_children, symbolic });
        add(&mut variants, Variant { model, joints: joints.clone(), for_inverse_dynamics: to_children });
    }
    if !passes.frames {
        add(&mut variants, Variant { model: model.clone(), joints, for_inverse_dynamics: false });
    }
    variants
}

/// Up to how many velocities all distributions are tried: beyond, the little that some may save is not worth the time.
const EXHAUSTIVE_VELOCITIES: usize = 18;

/// Gauge, whether masses go to children, whether parameters are moved too, whether it is tried for any size.
const DISTRIBUTIONS: [(Gauge, bool, bool, bool); 6] = [
    (Gauge::Second, false, false, true),
    (Gauge::First, false, false, false),
    (Gauge::Second, false, true, true),
    (Gauge::Second, true, false, true),
    (Gauge::First, true, false, false),
    (Gauge::Flat, true, false, true),
];

/// Adds a variant unless it is there.
fn add<'g>(variants: &mut Vec<Variant<'g>>, variant: Variant<'g>) {
    let links = |f: &Variant<'g>| f.model.links.iter().map(|l| l.inertia).collect::<Vec<_>>();
    if !variants.iter().any(|known| links(known) == links(&variant)) {
        variants.push(variant);
    }
}
