//! `linkwork convert`: converts a robot file to a Rust struct for further editing.

use crate::Stop;
use crate::export::write_output;
use crate::input::MechanismInput;
use crate::names::StructFieldNames;
use crate::written::{self, NameRole, format_number, format_vector};
use clap::ArgMatches;
use linkwork_compiler::compile;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::syntax::{
    Body, ConstraintKind, Description, Endpoint, Expr, ExprKind, FileForceElement, FileForceLaw,
    FileForceTarget, GROUND, InertiaOption, Joint, JointKind, Key, Limit, Name, RequestedFunctions, Wrench,
};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

pub fn run_convert(matches: &ArgMatches) -> Result<(), Stop> {
    let input = MechanismInput::select_one_mechanism(matches)?;
    if !input.is_robot {
        return Err(Stop::Failure(format!(
            "{} is not a robot file: there is nothing to convert",
            input.file.display()
        )));
    }
    if let Some(out) = matches.get_one::<PathBuf>("out")
        && out.extension().is_none_or(|ending| ending != "rs")
    {
        let out = out.display();
        return Err(Stop::Failure(format!(
            "`convert` writes Rust: `--out` names a file that ends in .rs, not {out}"
        )));
    }
    let cx = &mut Diagnostics::new();
    let source = input.parse_source(cx);
    let source = input.result_without_errors(source, cx)?;
    if !source.mechanism.shell.file_fields.is_empty() {
        return Err(Stop::Failure("`parameters` is for structs that refer to the file".to_string()));
    }
    if source.mechanism.requests != RequestedFunctions::default() {
        return Err(Stop::Failure(
            "`convert` takes the options for reading the file: write options that request functions in the \
             struct"
                .to_string(),
        ));
    }
    let description = &source.mechanism.description;
    let is_expression_drive =
        |drive: &&FileForceElement| matches!(drive.law, FileForceLaw::Expression { .. });
    if let Some(drive) = description.drives.iter().find(is_expression_drive) {
        return Err(Stop::Failure(format!(
            "`convert` cannot write the actuator `{}`, whose force depends on a state or on its inputs: keep \
             the file, `#[mechanism(mjcf = \"…\")]`",
            drive.name.text
        )));
    }
    // A file that would not compile itself, for example with limits that exclude every value, has no valid
    // struct either.
    let graph = Graph::new();
    input.result_without_errors(compile(&source, &graph, cx), cx)?;
    let mut struct_of = ConvertedStruct::new(description);
    let text = struct_of.convert_to_struct(&input);
    struct_of.notes.iter().for_each(|note| crate::note!("linkwork: {note}"));
    struct_of.print_renamed_elements();
    write_output(matches, &text)
}

struct ConvertedStruct<'a> {
    description: &'a Description,
    links: StructFieldNames,
    joints: StructFieldNames,
    others: StructFieldNames,
    /// Names of drives on cable lengths that do not change with the motion.
    constant: BTreeSet<String>,
    fields: String,
    /// Notes on what the converted struct does not take over from the file.
    notes: Vec<String>,
    /// Description of each renamed element with its name in the file, and its new name.
    renamed: Vec<(String, String)>,
}

/// Number of renamed elements printed on the terminal; the documentation of the struct lists all.
const RENAMED_SHOWN: usize = 4;

impl<'a> ConvertedStruct<'a> {
    fn new(description: &'a Description) -> ConvertedStruct<'a> {
        let mut taken = StructFieldNames::default();
        let links = taken.add_names_of_kind(description.bodies.iter().map(|body| &*body.name.text), "link");
        let joints =
            taken.add_names_of_kind(description.joints.iter().map(|joint| &*joint.name.text), "joint");
        let (fields, notes, renamed) = (String::new(), Vec::new(), Vec::new());
        let constant = drives_on_constant_lengths(description);
        let mut made =
            ConvertedStruct { description, links, joints, others: taken, constant, fields, notes, renamed };
        let links = description
            .bodies
            .iter()
            .map(|body| ("link", &body.name.text, made.links.field_name_or_original(&body.name.text)));
        let joints = description
            .joints
            .iter()
            .map(|joint| ("joint", &joint.name.text, made.joints.field_name_or_original(&joint.name.text)));
        let all: Vec<_> = links.chain(joints).collect();
        all.into_iter().for_each(|(kind, name, field)| made.record_renamed_element(kind, name, &field));
        made
    }

    /// Records an element whose name in the struct differs from its name in the file.
    fn record_renamed_element(&mut self, kind: &str, name: &str, field: &str) {
        if name != field {
            self.renamed.push((format!("{kind} `{name}`"), field.to_string()));
        }
    }

    /// Prints the first elements whose names in the struct differ from those in the file.
    fn print_renamed_elements(&self) {
        let shown = self.renamed.iter().take(RENAMED_SHOWN);
        let shown: Vec<String> = shown.map(|(what, field)| format!("{what} is `{field}`")).collect();
        let more = match self.renamed.len().saturating_sub(RENAMED_SHOWN) {
            0 => String::new(),
            more => format!(", and {more} more that the struct's documentation lists"),
        };
        if !shown.is_empty() {
            crate::note!("linkwork: names that differ from the file: {}{more}", shown.join(", "));
        }
    }

    fn convert_to_struct(&mut self, input: &MechanismInput) -> String {
        let d = self.description;
        d.bodies.iter().filter(|body| body.name.text != GROUND).for_each(|body| self.add_body(body));
        d.joints.iter().for_each(|joint| self.add_joint(joint));
        d.joints.iter().for_each(|joint| self.add_joint_elements(joint));
        self.add_input_fields();
        d.drives.iter().for_each(|drive| self.add_force_element(drive));
        for (name, e) in &d.dissipations {
            let e = self.format_expression(e);
            self.declare_named_element(
                &format!("#[dissipation({e})]"),
                ("dissipation", &name.text),
                "Rayleigh",
            );
        }
        for constraint in &d.constraints {
            let (value, other) = (self.format_expression(&constraint.value), constraint.other.as_ref());
            let other = other.map_or(String::new(), |other| format!(" = {}", self.format_expression(other)));
            let kind =
                if constraint.kind == ConstraintKind::Holonomic { "Holonomic" } else { "Nonholonomic" };
            let named = ("constraint", constraint.name.text.as_str());
            self.declare_named_element(&format!("#[constraint({value}{other})]"), named, kind);
        }
        d.limits.iter().for_each(|limit| self.add_limit(limit));
        if d.limits.iter().any(|limit| limit.arguments.expression_of_key(Key::Restitution).is_some()) {
            self.notes.push("limits are bounds here, not stops".to_string());
        }
        if !d.contacts.is_empty() {
            self.notes.push(format!("contacts, which `#[contact]` declares: {}", d.contacts.len()));
        }
        self.note_initial_coordinates();
        let mut options = vec![format!(
            "gravity = {}",
            d.gravity.as_ref().map_or("0 * z".to_string(), written::format_gravity)
        )];
        match d.inertias {
            InertiaOption::Check => {}
            InertiaOption::Trust => options.push("inertia = trust".to_string()),
            InertiaOption::None => options.push("inertia = none".to_string()),
        }
        let file = input.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut text = format!("use linkwork::prelude::*;\n\n/// From `{file}`.\n");
        self.notes.dedup();
        let rounded = d.snapped.iter().map(|line| format!("rounded: {line}"));
        let aside = d.left_out.iter().chain(&self.notes).cloned().chain(rounded);
        let aside: Vec<String> = aside.map(|line| line.replace('\n', " ")).collect();
        if !aside.is_empty() {
            text.push_str("///\n/// Differences from the file:\n");
            aside.iter().for_each(|line| {
                let _ = writeln!(text, "/// - {line}");
            });
        }
        if !self.renamed.is_empty() {
            text.push_str("///\n/// Names that differ from the file:\n");
            self.renamed.iter().for_each(|(what, field)| {
                let _ = writeln!(text, "/// - {what} is `{field}`");
            });
        }
        let _ =
            writeln!(text, "#[mechanism({})]\npub struct {} {{", options.join(", "), input.declaration.name);
        text.push_str(&self.fields);
        text.push_str("}\n");
        text
    }

    /// Notes the coordinates at which the file places its bodies, because structs declare none.
    fn note_initial_coordinates(&mut self) {
        let initial: Vec<String> = self
            .description
            .joints
            .iter()
            .filter(|joint| !joint.initial.is_empty())
            .map(|joint| {
                let field = self.joints.field_name_or_original(&joint.name.text);
                let values: Vec<String> = joint.initial.iter().map(ToString::to_string).collect();
                format!("`{field}` {}", values.join(" "))
            })
            .collect();
        if !initial.is_empty() {
            self.notes.push(format!(
                "initial coordinates of {} joints, which programs pass to `from` of a simulation: {}",
                initial.len(),
                initial.join(", ")
            ));
        }
    }

    fn add_field(&mut self, attribute: &str, name: &str, kind: &str) {
        let _ = writeln!(self.fields, "    {attribute}\n    {name}: {kind},");
    }

    /// Adds a field with a unique name, and returns the name.
    fn add_unique_field(&mut self, attribute: &str, name: &str, kind: &str) -> String {
        let name = self.others.unused_field_name(name, "element");
        self.add_field(attribute, &name, kind);
        name
    }

    /// Adds a field for a named element of the file, and records the name if it must be changed.
    fn declare_named_element(&mut self, attribute: &str, (what, name): (&str, &str), kind: &str) {
        let field = self.add_unique_field(attribute, name, kind);
        self.record_renamed_element(what, name, &field);
    }

    fn add_body(&mut self, body: &Body) {
        let mut figures = Vec::new();
        figures.extend(body.mass.as_ref().map(|e| format!("mass = {}", self.format_expression(e))));
        figures.extend(body.com.as_ref().map(|e| format!("com = {}", self.format_vector(e))));
        figures.extend(
            body.inertia
                .as_ref()
                .map(|e| format!("inertia = {}", written::format_inertia(e, &self.format_expression(e)))),
        );
        let attribute = if figures.is_empty() {
            "#[body]".to_string()
        } else {
            format!("#[body({})]", figures.join(", "))
        };
        let name = self.links.field_name_or_original(&body.name.text);
        self.add_field(&attribute, &name, "Body");
    }

    fn add_joint(&mut self, joint: &Joint) {
        let mut figures = vec![format!(
            "{} -> {}",
            self.format_endpoint(&joint.parent),
            self.format_endpoint(&joint.child)
        )];
        for (word, axes) in [("about", &joint.about), ("along", &joint.along)] {
            let axes: Vec<String> = axes.iter().map(written::format_axis).collect();
            match axes.as_slice() {
                [] => {}
                [one] => figures.push(format!("{word} = {one}")),
                several => figures.push(format!("{word} = ({})", several.join(", "))),
            }
        }
        for (word, e) in [("pitch", &joint.pitch), ("lead", &joint.lead)] {
            figures.extend(e.as_ref().map(|e| format!("{word} = {}", self.format_expression(e))));
        }
        let name = self.joints.field_name_or_original(&joint.name.text);
        self.add_field(&format!("#[joint({})]", figures.join(", ")), &name, &format!("{:?}", joint.kind));
    }

    fn format_endpoint(&self, end: &Endpoint) -> String {
        let mut text = self.links.field_name_or_original(&end.body.text);
        if let Some(at) = &end.at {
            let _ = write!(text, ".at({})", self.format_vector(at));
        }
        if !end.rotated.is_empty() {
            let steps: Vec<String> = end.rotated.iter().map(|step| self.format_expression(step)).collect();
            let _ = write!(text, ".rotated({})", steps.join(", "));
        }
        text
    }

    /// Adds the elements that belong to a joint: damping, friction, and the constraint of a mimic joint.
    fn add_joint_elements(&mut self, joint: &Joint) {
        let on = self.joints.field_name_or_original(&joint.name.text);
        if let Some(damping) = &joint.damping {
            let e = self.format_expression(damping);
            self.add_unique_field(
                &format!("#[acts(on = {on}, damping = {e})]"),
                &format!("{on}_damping"),
                "Dashpot",
            );
        }
        if let Some(friction) = &joint.friction {
            let e = self.format_expression(friction);
            self.add_unique_field(
                &format!("#[acts(on = {on}, coulomb = {e})]"),
                &format!("{on}_friction"),
                "Friction",
            );
        }
        if let Some(mimic) = &joint.mimic {
            let master = self.joints.field_name_or_original(&mimic.joint.text);
            let mut rule = format!("{on} = {} * {master}", format_number(mimic.multiplier));
            if mimic.offset != 0.0 {
                let _ = write!(rule, " + {}", format_number(mimic.offset));
            }
            self.add_unique_field(&format!("#[constraint({rule})]"), &format!("{on}_follows"), "Holonomic");
            self.notes.push(format!(
                "`{on}` follows `{master}` by a constraint, and has a velocity of its own here"
            ));
        }
    }

    /// Adds the input fields of the struct, in the order of the robot file.
    fn add_input_fields(&mut self) {
        for joint in self.description.joints.iter().filter(|joint| joint.driven && joint.mimic.is_none()) {
            let on = self.joints.field_name_or_original(&joint.name.text);
            let attribute = format!("#[acts(on = {on})]");
            let motor = self.add_unique_field(&attribute, &format!("{on}_motor"), motor_type(joint.kind));
            self.record_renamed_element("input", &joint.name.text, &motor);
        }
        let is_driven_by_input = |drive: &&FileForceElement| matches!(drive.law, FileForceLaw::Input(_));
        for drive in self.description.drives.iter().filter(is_driven_by_input) {
            if let [(joint, 1.0)] = drive.on.weighted_joints() {
                let on = self.joints.field_name_or_original(&joint.text);
                let kind = motor_type(self.kind_of_joint(&joint.text));
                self.declare_named_element(&format!("#[acts(on = {on})]"), ("input", &drive.name.text), kind);
            } else if let Some(on) = self.force_element_length_text(drive) {
                self.declare_named_element(
                    &format!("#[acts(on = {on})]"),
                    ("input", &drive.name.text),
                    "Force",
                );
            } else {
                let name = self.others.unused_field_name(&drive.name.text, "input");
                self.record_renamed_element("input", &drive.name.text, &name);
                let _ = writeln!(self.fields, "    {name}: Input,");
                if let FileForceTarget::Wrench(wrench) = &drive.on {
                    self.add_wrench(wrench, &name, &name);
                }
            }
        }
    }

    /// Returns the length or the weighted sum of coordinates that a drive acts on; `None` if it does not
    /// change with the motion, and for a drive at a point of a body.
    fn force_element_length_text(&self, drive: &FileForceElement) -> Option<String> {
        match &drive.on {
            FileForceTarget::Length(length) => {
                (!self.constant.contains(&drive.name.text)).then(|| self.format_expression(length))
            }
            FileForceTarget::Sum(terms) => {
                let terms = terms.iter().filter(|(_, weight)| *weight != 0.0);
                let weighted_joint_term = |(joint, weight): &(Name, f64)| {
                    format!(
                        "{} * {}",
                        format_number(*weight),
                        self.joints.field_name_or_original(&joint.text)
                    )
                };
                terms
                    .map(weighted_joint_term)
                    .reduce(|sum, weighted_joint_term| format!("{sum} + {weighted_joint_term}"))
            }
            FileForceTarget::Wrench(_) => None,
        }
    }

    /// Adds forces and torques that are the components of a wrench times a factor.
    fn add_wrench(&mut self, wrench: &Wrench, name: &str, factor: &str) {
        let Some((point, body)) = self.point_and_body_of_wrench(wrench, name) else { return };
        for (kind, on, vector) in [("Force", &point, wrench.force), ("Torque", &body, wrench.torque)] {
            if vector != [0.0; 3] {
                let value = format_vector_in_axes(vector, &body);
                let attribute = format!("#[acts(on = {on}, value = {factor} * ({value}))]");
                self.add_unique_field(&attribute, &format!("{name}_{}", kind.to_ascii_lowercase()), kind);
            }
        }
    }

    /// Adds dashpots for the damping along the velocity of a wrench's point.
    fn add_wrench_damping(&mut self, wrench: &Wrench, name: &str, damping: f64) {
        let Some((point, body)) = self.point_and_body_of_wrench(wrench, name) else { return };
        let mut rates = Vec::new();
        if wrench.force != [0.0; 3] {
            rates.push(format!(
                "dot(v({point} / ground / ground), {})",
                format_vector_in_axes(wrench.force, &body)
            ));
        }
        if wrench.torque != [0.0; 3] {
            rates.push(format!(
                "dot(omega({body} / ground), {})",
                format_vector_in_axes(wrench.torque, &body)
            ));
        }
        if !rates.is_empty() {
            let rate = rates.join(" + ");
            let loss = format!("#[dissipation({} * pow({rate}, 2))]", format_number(damping / 2.0));
            self.declare_named_element(&loss, ("element", name), "Rayleigh");
        }
    }

    /// Returns the point of application of a wrench, and its body. A wrench with a reaction on another body,
    /// or on a body that is fixed to the ground, is omitted and noted.
    fn point_and_body_of_wrench(&mut self, wrench: &Wrench, name: &str) -> Option<(String, String)> {
        if wrench.against.is_some() {
            self.notes.push(format!("`{name}`, which acts between points of two bodies, has no effect here"));
            return None;
        }
        let body = match &wrench.on.kind {
            ExprKind::Method(body, ..) => body.as_name(),
            _ => wrench.on.as_name(),
        };
        let body = body.filter(|body| *body != GROUND)?;
        if self.is_welded_to_ground(body) {
            let note =
                format!("`{name}`, which acts on a body that is fixed to the ground, has no effect here");
            self.notes.push(note);
            return None;
        }
        let point = written::format_point(&wrench.on, &|name| self.links.field_name(name));
        Some((point, self.links.field_name_or_original(body)))
    }

    /// Whether welds alone lead from the ground to a body.
    fn is_welded_to_ground(&self, body: &str) -> bool {
        let joints = &self.description.joints;
        let mut at = body;
        // A chain is no longer than the list of joints.
        for _ in 0..=joints.len() {
            if at == GROUND {
                return true;
            }
            let weld = joints.iter().find(|joint| joint.child.body.text == at);
            let Some(weld) = weld.filter(|joint| joint.kind == JointKind::Weld) else { return false };
            at = &weld.parent.body.text;
        }
        false
    }

    fn kind_of_joint(&self, joint: &str) -> JointKind {
        let found = self.description.joints.iter().find(|known| known.name.text == joint);
        found.map_or(JointKind::Pin, |joint| joint.kind)
    }

    /// Adds a spring or another element of a file. On one joint, its weight is a factor of the coefficients.
    fn add_force_element(&mut self, drive: &FileForceElement) {
        let name = drive.name.text.as_str();
        if matches!(drive.law, FileForceLaw::Input(_)) {
            return;
        }
        if let FileForceTarget::Wrench(wrench) = &drive.on {
            match drive.law {
                FileForceLaw::Push(force) => self.add_wrench(wrench, name, &format_number(force)),
                FileForceLaw::Damper(damping) => self.add_wrench_damping(wrench, name, damping),
                // The other laws have no effect without a length.
                _ => {}
            }
            return;
        }
        let Some(on) = self.force_element_length_text(drive) else {
            return self.notes.push(format!("`{name}`, which acts on a constant length, is omitted"));
        };
        // The friction law is regularised in the velocity of the weighted sum, and polynomials have several
        // powers of it, so that the weight cannot become a factor.
        let is_scaled = match drive.law {
            FileForceLaw::Friction(_) | FileForceLaw::PolynomialDamper(_) => true,
            FileForceLaw::Slack { stiffness, .. } => stiffness[1..] != [0.0; 2],
            _ => false,
        };
        if let [(joint, w)] = drive.on.weighted_joints()
            && (*w == 1.0 || !is_scaled || (*w == -1.0 && matches!(drive.law, FileForceLaw::Friction(_))))
        {
            let (on, w, kind) =
                (self.joints.field_name_or_original(&joint.text), *w, self.kind_of_joint(&joint.text));
            let (figures, element) = match drive.law {
                FileForceLaw::Slack { stiffness, range } => {
                    let range = range.map(|end| end / w);
                    (
                        written::slack_spring_energy_source(
                            stiffness.map(|k| k * w * w),
                            if w < 0.0 { [range[1], range[0]] } else { range },
                        ),
                        "Spring",
                    )
                }
                FileForceLaw::Spring { stiffness, free } => {
                    let word = if kind == JointKind::Sleeve { "free_length" } else { "free_angle" };
                    let free = if free == 0.0 {
                        String::new()
                    } else {
                        format!(", {word} = {}", written::format_angle(&format_number(free / w)))
                    };
                    (format!("stiffness = {}{free}", format_number(stiffness * w * w)), "Spring")
                }
                FileForceLaw::Damper(damping) => (written::damper_law_text(damping * w * w), "Dashpot"),
                FileForceLaw::PolynomialDamper(damping) => {
                    (written::polynomial_damper_law(damping), "Dashpot")
                }
                FileForceLaw::Friction(force) => {
                    (format!("coulomb = {}", format_number((force * w).abs())), "Friction")
                }
                FileForceLaw::Inerter(inertance) => {
                    (format!("inertance = {}", format_number(inertance * w * w)), "Inerter")
                }
                FileForceLaw::Push(force) => {
                    (format!("value = {}", format_number(force * w)), motor_type(kind))
                }
                FileForceLaw::Input(_) | FileForceLaw::Expression { .. } => return,
            };
            return self.declare_named_element(
                &format!("#[acts(on = {on}, {figures})]"),
                ("element", name),
                element,
            );
        }
        self.add_length_element(&on, name, &drive.law);
    }

    /// Adds a spring or another element on the length of a cable, or on a sum of coordinates.
    fn add_length_element(&mut self, on: &str, name: &str, law: &FileForceLaw) {
        let (figures, element) = match *law {
            FileForceLaw::Spring { stiffness, free } => (
                format!("stiffness = {}, free_length = {}", format_number(stiffness), format_number(free)),
                "Spring",
            ),
            FileForceLaw::Slack { stiffness, range } => {
                (written::slack_spring_energy_source(stiffness, range), "Spring")
            }
            FileForceLaw::Damper(damping) => (written::damper_law_text(damping), "Dashpot"),
            FileForceLaw::PolynomialDamper(damping) => (written::polynomial_damper_law(damping), "Dashpot"),
            FileForceLaw::Friction(force) => (format!("coulomb = {}", format_number(force)), "Friction"),
            FileForceLaw::Inerter(inertance) => {
                (format!("inertance = {}", format_number(inertance)), "Inerter")
            }
            FileForceLaw::Push(force) => (format!("value = {}", format_number(force)), "Force"),
            FileForceLaw::Input(_) | FileForceLaw::Expression { .. } => return,
        };
        self.declare_named_element(&format!("#[acts(on = {on}, {figures})]"), ("element", name), element);
    }

    fn add_limit(&mut self, limit: &Limit) {
        let mut figures = vec![format!("on = {}", self.format_expression(&limit.on))];
        for (key, e) in limit.arguments.keyed_expressions().filter(|(key, _)| *key != Key::Restitution) {
            let value = self.format_expression(e);
            let value =
                if matches!(key, Key::From | Key::To) { written::format_angle(&value) } else { value };
            figures.push(format!("{} = {value}", key.name()));
        }
        if figures.len() > 1 {
            let name = format!("{}_limit", limit.name.text);
            self.add_unique_field(&format!("#[limit({})]", figures.join(", ")), &name, "Limit");
        }
    }

    fn format_vector(&self, e: &Expr) -> String {
        format_vector(e).unwrap_or_else(|| self.format_expression(e))
    }

    fn format_expression(&self, e: &Expr) -> String {
        written::format_expression(e, &|name, role| match role {
            NameRole::Body => self.links.field_name(name),
            NameRole::Coordinate => self.joints.field_name(name).or_else(|| self.links.field_name(name)),
        })
    }
}

/// Returns the type of a motor: a force for a prismatic joint, otherwise a torque.
fn motor_type(kind: JointKind) -> &'static str {
    if kind == JointKind::Sleeve { "Force" } else { "Torque" }
}

/// Returns a constant vector in the axes of a body as source text.
fn format_vector_in_axes(vector: [f64; 3], body: &str) -> String {
    let parts = vector.into_iter().zip(["x", "y", "z"]).filter(|(x, _)| *x != 0.0);
    parts.map(|(x, axis)| format!("{} * {body}.{axis}", format_number(x))).collect::<Vec<_>>().join(" + ")
}

/// Returns the names of drives on lengths that do not change with the motion, so that the drives have no
/// effect.
fn drives_on_constant_lengths(description: &Description) -> BTreeSet<String> {
    let acts_on_length = |drive: &&FileForceElement| matches!(drive.on, FileForceTarget::Length(_));
    let lengths: Vec<&FileForceElement> = description.drives.iter().filter(acts_on_length).collect();
    // The forces on the lengths have different magnitudes, so that the model shows which of them it has.
    let element_with_distinct_force = |(k, drive): (usize, &&FileForceElement)| FileForceElement {
        law: FileForceLaw::Push(k as f64 + 1.0),
        ..(*drive).clone()
    };
    let with_distinct_forces = Description {
        drives: lengths.iter().enumerate().map(element_with_distinct_force).collect(),
        ..description.clone()
    };
    let graph = Graph::new();
    let Some(model) = build_model(&with_distinct_forces, &graph, &mut Diagnostics::new()) else {
        return BTreeSet::new();
    };
    let forces: Vec<f64> = model.loads.iter().filter_map(|load| load.force.constant_value()).collect();
    let has_constant_length = |k: usize| !forces.contains(&(k as f64 + 1.0));
    let names = lengths.iter().enumerate().filter(|(k, _)| has_constant_length(*k));
    names.map(|(_, drive)| drive.name.text.clone()).collect()
}
