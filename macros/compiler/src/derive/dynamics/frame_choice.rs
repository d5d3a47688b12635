//! In which frames dynamics is derived.

use super::variants::Variants;
use crate::derive::specialisation::{Candidate, Specialisation};
use crate::machine::{COMPARED_OPERATIONS, COMPARED_VELOCITIES};
use crate::mechanics::speeds::InSpeeds;
use crate::mechanism::Model;
use crate::passes::{self, Passes, Variant};
use std::rc::Rc;

/// Of a mechanism with many operations, frames are not tried further that are larger by more than one in so many with the first
/// distribution of its masses, which is enough to tell there.
const SIMILAR_AT_FIRST: usize = 24;

/// A choice of frames: the variants of the model that have them, with their mass matrices and inverse dynamics.
pub struct FrameChoice<'g> {
    pub variants: Variants<'g>,
    pub masses: Vec<Candidate<'g>>,
    pub recursions: Vec<Candidate<'g>>,
    /// Of the smallest of both together.
    pub size: usize,
}

impl<'g> FrameChoice<'g> {
    /// All choices.
    pub fn all(
        model: &Model<'g>,
        passes: Passes,
        specialisation: Specialisation,
        speeds: Option<&Rc<InSpeeds<'g>>>,
    ) -> Vec<FrameChoice<'g>> {
        let mut choices = vec![passes::variants(model, passes)];
        if passes.frames && model.nv() <= COMPARED_VELOCITIES {
            choices.push(passes::variants(model, Passes { frames: false, ..passes }));
        }
        if passes.parallel {
            let common: Vec<Vec<Variant<'g>>> =
                choices.iter().map(|variants| passes::in_common_axes(variants)).collect();
            choices.extend(common.into_iter().filter(|variants| !variants.is_empty()));
        }
        let mut found: Vec<FrameChoice<'g>> = Vec::new();
        for variants in choices
            .into_iter()
            .map(|variants| Variants::new(variants, passes, specialisation, speeds.cloned()))
        {
            if found.first().is_none_or(|first| first.is_similar(&variants)) {
                found.push(FrameChoice::new(variants));
            }
        }
        found
    }

    /// False for frames that cost more, as far as the first distribution of the masses tells; of a mechanism with few operations
    /// all distributions are asked later.
    fn is_similar(&self, variants: &Variants<'g>) -> bool {
        let first = |masses: &[Candidate<'_>], recursions: &[Candidate<'_>]| {
            Some(masses.first()?.size + recursions.first()?.size)
        };
        let own = first(&self.masses, &self.recursions).filter(|own| *own > COMPARED_OPERATIONS);
        own.is_none_or(|own| {
            let [masses, recursions] = [
                variants.mass_matrices().take(1).collect(),
                variants.recursions(true).take(1).collect::<Vec<_>>(),
            ];
            first(&masses, &recursions).is_none_or(|other| other <= own + own / SIMILAR_AT_FIRST)
        })
    }

    fn new(variants: Variants<'g>) -> FrameChoice<'g> {
        let masses: Vec<Candidate<'g>> = variants.mass_matrices().collect();
        let recursions: Vec<Candidate<'g>> = variants.recursions(true).collect();
        let size = smallest(&masses).unwrap_or_default() + smallest(&recursions).unwrap_or_default();
        FrameChoice { variants, masses, recursions, size }
    }
}

/// The size of the smallest outputs.
pub fn smallest(all: &[Candidate<'_>]) -> Option<usize> {
    all.iter().map(|list| list.size).min()
}
