//! Choice of the link frames in which the dynamics is derived.

use super::variants::ModelVariants;
use crate::derive::specialisation::{Candidate, ParameterSpecialisation};
use crate::machine::{COMPARED_OPERATIONS, COMPARED_VELOCITIES};
use crate::mechanics::speeds::SpeedTransformation;
use crate::mechanism::Model;
use crate::passes::{self, ModelVariant, PassSelection};
use std::rc::Rc;

/// Inverse tolerance of the first comparison of frames for a mechanism with many operations: frames that are
/// larger by more than one part in this number are excluded. One distribution of the masses suffices for this
/// decision.
const SIMILAR_AT_FIRST: usize = 24;

/// A frame choice: the variants of the model with these frames, their mass matrices and inverse dynamics.
pub struct FrameChoice<'g> {
    pub variants: ModelVariants<'g>,
    pub masses: Vec<Candidate<'g>>,
    pub recursions: Vec<Candidate<'g>>,
    /// Sum of the sizes of the smallest mass matrix and the smallest inverse dynamics.
    pub size: usize,
}

impl<'g> FrameChoice<'g> {
    /// Returns all frame choices that may be the cheapest.
    pub fn candidate_frame_choices(
        model: &Model<'g>,
        passes: PassSelection,
        specialisation: ParameterSpecialisation,
        speeds: Option<&Rc<SpeedTransformation<'g>>>,
    ) -> Vec<FrameChoice<'g>> {
        let mut choices = vec![passes::model_variants(model, passes)];
        if passes.frames && model.nv() <= COMPARED_VELOCITIES {
            choices.push(passes::model_variants(model, PassSelection { frames: false, ..passes }));
        }
        if passes.parallel {
            let common: Vec<Vec<ModelVariant<'g>>> =
                choices.iter().map(|variants| passes::variants_in_common_axes(variants)).collect();
            choices.extend(common.into_iter().filter(|variants| !variants.is_empty()));
        }
        let mut found: Vec<FrameChoice<'g>> = Vec::new();
        for variants in choices
            .into_iter()
            .map(|variants| ModelVariants::new(variants, passes, specialisation, speeds.cloned()))
        {
            if found.first().is_none_or(|first| first.is_competitive(&variants)) {
                found.push(FrameChoice::new(variants));
            }
        }
        found
    }

    /// Returns false for frames that cost more according to the first distribution of the masses. For a
    /// mechanism with few operations it returns true, since all distributions are compared later.
    fn is_competitive(&self, variants: &ModelVariants<'g>) -> bool {
        let size_of_first_candidates = |masses: &[Candidate<'_>], recursions: &[Candidate<'_>]| {
            Some(masses.first()?.size + recursions.first()?.size)
        };
        let own =
            size_of_first_candidates(&self.masses, &self.recursions).filter(|own| *own > COMPARED_OPERATIONS);
        own.is_none_or(|own| {
            let [masses, recursions] = [
                variants.mass_matrix_candidates().take(1).collect(),
                variants.inverse_dynamics_candidates(true).take(1).collect::<Vec<_>>(),
            ];
            size_of_first_candidates(&masses, &recursions)
                .is_none_or(|other| other <= own + own / SIMILAR_AT_FIRST)
        })
    }

    fn new(variants: ModelVariants<'g>) -> FrameChoice<'g> {
        let masses: Vec<Candidate<'g>> = variants.mass_matrix_candidates().collect();
        let recursions: Vec<Candidate<'g>> = variants.inverse_dynamics_candidates(true).collect();
        let size = smallest_candidate_size(&masses).unwrap_or_default()
            + smallest_candidate_size(&recursions).unwrap_or_default();
        FrameChoice { variants, masses, recursions, size }
    }
}

/// Returns the size of the candidate with the smallest outputs.
pub fn smallest_candidate_size(all: &[Candidate<'_>]) -> Option<usize> {
    all.iter().map(|list| list.size).min()
}
