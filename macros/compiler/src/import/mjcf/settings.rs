//! `<compiler>` and `<option>`: settings for the interpretation of the file.

use super::defaults::{numbers_with_defaults, read_boolean_attribute};
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, read_number_attribute, read_numbers_attribute,
};
use crate::import::imported::Located;

/// Source from which mass properties of MJCF bodies are taken.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum MassSource {
    /// Mass properties from `<inertial>`, or from the geometry of bodies without it.
    Auto,
    /// Mass properties from the geometry of all bodies.
    Geometry,
    /// Mass properties from `<inertial>` alone.
    Inertial,
}

/// Settings of an MJCF file: its `<compiler>` and `<option>` elements.
pub(super) struct MjcfSettings {
    /// Whether angles of the file are in degrees.
    pub(super) degrees: bool,
    /// Axes of the Euler angles in order; capital letters for fixed axes.
    pub(super) euler: [char; 3],
    /// Whether the presence of a range activates the limit of a joint or tendon.
    pub(super) autolimits: bool,
    /// Source from which mass properties of bodies are taken.
    pub(super) source: MassSource,
    /// First and last geometry group that contributes mass.
    pub(super) groups: [f64; 2],
    /// Whether inertias that violate the triangle inequality are replaced by that of a ball.
    pub(super) balance: bool,
    /// Minimum mass of a body, kg.
    pub(super) least_mass: f64,
    /// Minimum principal moment of inertia of a body, kg·m².
    pub(super) least_inertia: f64,
    /// Total mass to which all bodies are scaled, kg.
    pub(super) total_mass: Option<f64>,
    /// Folder that contains the meshes.
    pub(super) meshes: String,
    /// Gravitational acceleration of the file, m/s².
    pub(super) gravity: Located<[f64; 3]>,
    gravitates: bool,
    /// Nonzero properties of the fluid: density, viscosity and wind.
    pub(super) medium: Vec<(&'static str, Located<[f64; 3]>)>,
    /// Whether springs of joints and tendons are enabled.
    pub(super) springs: bool,
    /// Whether dampers of joints and tendons are enabled.
    pub(super) dampers: bool,
    /// Whether constraints of all kinds are enabled.
    constraints: bool,
    /// Whether dry friction is enabled.
    friction: bool,
    /// Whether couplings and loop constraints are enabled.
    equality: bool,
    /// Whether ranges of joints and tendons are enabled.
    limits: bool,
    /// Whether contacts are enabled.
    contacts: bool,
    /// Whether a body does not collide with its parent.
    pub(super) filter_parent: bool,
    /// Whether actuators are enabled.
    pub(super) actuation: bool,
    /// Whether actuator inputs are clamped to their ranges.
    pub(super) clamped: bool,
    /// Groups of actuators that are disabled.
    pub(super) disabled_groups: Vec<f64>,
    /// Whether the axes of free bodies are aligned with their principal axes by default.
    pub(super) align_free: bool,
    /// Whether the folders in names of mesh files are ignored.
    pub(super) strip_paths: bool,
}

impl MjcfSettings {
    /// Reads the `<compiler>` and `<option>` elements of an MJCF file.
    pub(super) fn read_settings(root: Node<'_>, cx: &mut Cx<'_>) -> MjcfSettings {
        let mut all = MjcfSettings {
            degrees: true,
            euler: ['x', 'y', 'z'],
            autolimits: true,
            source: MassSource::Auto,
            groups: [0.0, 5.0],
            balance: false,
            least_mass: 0.0,
            least_inertia: 0.0,
            total_mass: None,
            meshes: String::new(),
            gravity: Located { value: [0.0, 0.0, -9.81], place: element_source_position(root, cx) },
            gravitates: true,
            medium: Vec::new(),
            springs: true,
            dampers: true,
            constraints: true,
            friction: true,
            equality: true,
            limits: true,
            contacts: true,
            filter_parent: true,
            actuation: true,
            clamped: true,
            disabled_groups: Vec::new(),
            align_free: false,
            strip_paths: false,
        };
        for node in child_elements(root) {
            match node.tag_name().name() {
                "compiler" => all.read_compiler_settings(node, cx),
                "option" => all.read_option_settings(node, cx),
                _ => {}
            }
        }
        if !all.gravitates {
            all.gravity.value = [0.0; 3];
        }
        // Wind has no effect without density and viscosity.
        if all.medium.iter().all(|(which, _)| *which == "wind") {
            all.medium.clear();
        }
        all
    }

    fn read_compiler_settings(&mut self, node: Node<'_>, cx: &mut Cx<'_>) {
        let trimmed_attribute_word = |attribute: &str| node.attribute(attribute).map(str::trim);
        let mut report_unknown_value = |attribute: &str, expected: &str| {
            let value = node.attribute_node(attribute);
            let at = value.map_or(node.range().start, |value| value.range_value().start);
            let found = quote_word(node.attribute(attribute).unwrap_or_default());
            let message = format!("unknown `{attribute}` {found}");
            cx.report_error(&cx.source_position(at), message, |d| d.add_help(format!("expected {expected}")));
        };
        match trimmed_attribute_word("angle") {
            Some("radian") => self.degrees = false,
            Some("degree") => self.degrees = true,
            Some(_) => report_unknown_value("angle", "`degree` or `radian`"),
            None => {}
        }
        if trimmed_attribute_word("coordinate")
            .is_some_and(|trimmed_attribute_word| trimmed_attribute_word != "local")
        {
            report_unknown_value(
                "coordinate",
                "`local`: MuJoCo has no other since version 2.3.4; let an older one convert the file",
            );
        }
        if let Some(order) = trimmed_attribute_word("eulerseq") {
            let mut axes = order.chars();
            match [axes.next(), axes.next(), axes.next(), axes.next()] {
                [Some(a), Some(b), Some(c), None]
                    if [a, b, c].iter().all(|axis| "xyzXYZ".contains(*axis)) =>
                {
                    self.euler = [a, b, c];
                }
                _ => report_unknown_value(
                    "eulerseq",
                    "three letters of `x`, `y`, `z`, capital about fixed axes",
                ),
            }
        }
        if let Some(trimmed_attribute_word) = trimmed_attribute_word("inertiafromgeom") {
            match trimmed_attribute_word {
                "auto" => self.source = MassSource::Auto,
                "true" => self.source = MassSource::Geometry,
                "false" => self.source = MassSource::Inertial,
                _ => report_unknown_value("inertiafromgeom", "`true`, `false` or `auto`"),
            }
        }
        self.autolimits = read_boolean_attribute(node, "autolimits", cx).unwrap_or(self.autolimits);
        self.balance = read_boolean_attribute(node, "balanceinertia", cx).unwrap_or(self.balance);
        self.align_free = read_boolean_attribute(node, "alignfree", cx).unwrap_or(self.align_free);
        self.strip_paths = read_boolean_attribute(node, "strippath", cx).unwrap_or(self.strip_paths);
        if let Some(groups) = read_numbers_attribute(node, "inertiagrouprange", cx) {
            self.groups = groups.value;
        }
        let mut set_from_attribute = |attribute: &str, to: &mut f64| {
            if let Some(found) = read_number_attribute(node, attribute, cx) {
                *to = found.value;
            }
        };
        set_from_attribute("boundmass", &mut self.least_mass);
        set_from_attribute("boundinertia", &mut self.least_inertia);
        self.total_mass = read_number_attribute(node, "settotalmass", cx)
            .map(|mass| mass.value)
            .or(self.total_mass)
            .filter(|mass| *mass > 0.0);
        if let Some(folder) =
            trimmed_attribute_word("assetdir").filter(|_| trimmed_attribute_word("meshdir").is_none())
        {
            self.meshes = folder.to_string();
        }
        if let Some(folder) = trimmed_attribute_word("meshdir") {
            self.meshes = folder.to_string();
        }
    }

    fn read_option_settings(&mut self, node: Node<'_>, cx: &mut Cx<'_>) {
        if let Some(gravity) = read_numbers_attribute(node, "gravity", cx) {
            self.gravity = gravity;
        }
        for which in ["density", "viscosity", "wind"] {
            let Some(found) = numbers_with_defaults(node, which, [0.0; 3], cx) else { continue };
            self.medium.retain(|(known, _)| *known != which);
            if found.value != [0.0; 3] {
                self.medium.push((which, found));
            }
        }
        if let Some(found) = node.attribute_node("actuatorgroupdisable") {
            let place = cx.source_position(found.range_value().start);
            let groups = found
                .value()
                .split_ascii_whitespace()
                .map(|trimmed_attribute_word| trimmed_attribute_word.parse::<u8>().ok());
            match groups.map(|group| group.filter(|group| *group <= 30).map(f64::from)).collect() {
                Some(groups) => self.disabled_groups = groups,
                None => {
                    let message = format!("`actuatorgroupdisable` is {}", quote_word(found.value()));
                    cx.report_error(&place, message, |d| {
                        d.add_help("expected numbers of groups from 0 to 30")
                    });
                }
            }
        }
        for flag in child_elements(node).filter(|child| child.tag_name().name() == "flag") {
            self.read_flag_element(flag, cx);
        }
    }

    fn read_flag_element(&mut self, flag: Node<'_>, cx: &mut Cx<'_>) {
        let mut set =
            |attribute: &str, to: &mut bool| *to = read_boolean_attribute(flag, attribute, cx).unwrap_or(*to);
        // Older versions have one flag for springs and dampers.
        let mut passive = true;
        set("passive", &mut passive);
        (self.springs, self.dampers) = (self.springs && passive, self.dampers && passive);
        set("spring", &mut self.springs);
        set("damper", &mut self.dampers);
        set("constraint", &mut self.constraints);
        set("frictionloss", &mut self.friction);
        set("equality", &mut self.equality);
        set("limit", &mut self.limits);
        set("contact", &mut self.contacts);
        set("filterparent", &mut self.filter_parent);
        set("actuation", &mut self.actuation);
        set("clampctrl", &mut self.clamped);
        set("gravity", &mut self.gravitates);
    }

    /// Whether passive forces that are not constraint forces act: those of the fluid, and gravity
    /// compensation.
    pub(super) fn are_passive_forces_enabled(&self) -> bool {
        self.springs || self.dampers
    }

    /// Whether dry friction of joints and tendons acts.
    pub(super) fn is_dry_friction_enabled(&self) -> bool {
        self.constraints && self.friction
    }

    /// Whether couplings and loop constraints act.
    pub(super) fn are_equalities_enabled(&self) -> bool {
        self.constraints && self.equality
    }

    /// Whether ranges of joints and tendons act.
    pub(super) fn are_limits_enabled(&self) -> bool {
        self.constraints && self.limits
    }

    /// Whether contacts act in the simulation of the file.
    pub(super) fn are_contacts_enabled(&self) -> bool {
        self.constraints && self.contacts
    }

    /// Converts an angle of the MJCF file to radians.
    pub(super) fn angle_in_radians(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }
}
