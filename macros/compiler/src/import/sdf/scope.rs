//! Scopes of names: translate the names inside a model or world to full names.

use crate::import::element::{Node, child_elements};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Name of the frame of the world and of the outermost model, to which all other frames are relative.
pub(super) const WORLD: &str = "world";

/// Scope in which names are looked up: a model or the world.
#[derive(Clone, Debug)]
pub(super) enum Scope {
    /// Scope of a model: the prefix of the full names of its elements, for example `arm::hand::`. The prefix
    /// is empty for the only model of a file.
    Model(String),
    /// Scope of the world around the models.
    WorldNames(Rc<WorldNames>),
}

/// Names that an SDF world defines for its joints and frames.
#[derive(Debug, Default)]
pub(super) struct WorldNames {
    /// Prefix of the full names of elements in each model of the world.
    models: BTreeMap<String, String>,
    /// Full name of each frame and joint of the world.
    parts: BTreeMap<String, String>,
}

impl WorldNames {
    /// Collects the names in the SDF world `node`, if it exists, whose `models` have these prefixes.
    pub(super) fn new(node: Option<Node<'_>>, models: &[(Node<'_>, String)]) -> WorldNames {
        let name_attribute = |node: &Node<'_>| node.attribute("name").map(str::to_string);
        // Elements of a model without a prefix keep their names; equal names of the world get a prefix
        // instead.
        let bare = models.iter().filter(|(_, prefix)| prefix.is_empty());
        let taken: BTreeSet<String> = bare
            .flat_map(|(model, _)| child_elements(*model))
            .filter_map(|part| name_attribute(&part))
            .collect();
        let parts = node.into_iter().flat_map(child_elements);
        let parts = parts.filter(|part| matches!(part.tag_name().name(), "frame" | "joint"));
        let name_and_full_name = |name: String| match taken.contains(&name) {
            true => (name.clone(), format!("{WORLD}::{name}")),
            false => (name.clone(), name),
        };
        WorldNames {
            models: models
                .iter()
                .filter_map(|(model, prefix)| Some((name_attribute(model)?, prefix.clone())))
                .collect(),
            parts: parts.filter_map(|part| name_attribute(&part)).map(name_and_full_name).collect(),
        }
    }
}

impl Scope {
    /// Returns the full name to which `name` refers in this scope.
    pub(super) fn full_name(&self, name: &str) -> String {
        match (self, name) {
            (_, WORLD) => WORLD.to_string(),
            (Scope::Model(prefix), "__model__") => full_model_frame_name(prefix),
            (Scope::Model(prefix), _) => format!("{prefix}{name}"),
            (Scope::WorldNames(world), _) => {
                let (first, rest) = name.split_once("::").unwrap_or((name, "__model__"));
                match (world.models.get(first), world.parts.get(name)) {
                    (Some(prefix), _) => format!("{prefix}{rest}"),
                    (None, Some(whole)) => whole.clone(),
                    (None, None) => name.to_string(),
                }
            }
        }
    }

    /// Returns the full name of an element that is declared with this name.
    pub(super) fn full_name_of_declared_element(&self, name: &str) -> String {
        match self {
            Scope::Model(prefix) => format!("{prefix}{name}"),
            Scope::WorldNames(_) => self.full_name(name),
        }
    }

    /// Returns the full name of the frame of the model, or of the world.
    pub(super) fn full_name_of_scope_frame(&self) -> String {
        match self {
            Scope::Model(prefix) => full_model_frame_name(prefix),
            Scope::WorldNames(_) => WORLD.to_string(),
        }
    }
}

/// Returns the full name of the frame of a model.
fn full_model_frame_name(prefix: &str) -> String {
    format!("{prefix}__model__")
}
