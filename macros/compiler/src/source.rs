//! A mechanism as read from the struct and its imported file, and its public interface.

use crate::catalogue::{self, ConstraintFacts, ContactCounts, Facts};
use crate::diag::Diagnostics;
use crate::emit::{self, Constraints, GeneratedCode, Interface, emit_error_stubs};
use crate::syntax::contact::MAX_CONTACT_POINTS;
use crate::syntax::{self, Mechanism};
use crate::{derive, import, mechanism, resolve};
use proc_macro2::TokenStream;
use std::path::{Path, PathBuf};

/// Parsed source of a mechanism with its imported file.
pub struct ParsedSource {
    /// Contents of the struct and of the imported file.
    pub mechanism: Mechanism,
    /// Paths of all files that were read for the mechanism.
    files: Vec<PathBuf>,
    /// False if the mechanism imports a file that could not be read.
    pub(crate) imported: bool,
}

/// Parses the struct and imports its file. Returns `None` if the item is not a struct that can be analysed
/// further.
pub fn parse_source_and_import(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
    cx: &mut Diagnostics,
) -> Option<ParsedSource> {
    parse_source_with_contact_limit(arguments, item, folder, MAX_CONTACT_POINTS, cx)
}

/// Parses the struct and imports its file with at most `limit` contact points, see
/// [`separate_contacts`](ParsedSource::separate_contacts). Returns `None` if the item is not a struct that
/// can be analysed further.
pub fn parse_source_with_contact_limit(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
    limit: usize,
    cx: &mut Diagnostics,
) -> Option<ParsedSource> {
    let mut mechanism = syntax::parse_mechanism(arguments, item, cx)?;
    let (mut files, before) = (Vec::new(), cx.len());
    mechanism.description.drawing = mechanism.requests.drawing;
    if let Some(options) = &mut mechanism.file {
        options.collisions = options.contacts != syntax::ContactOption::Ignore
            || mechanism.description.contacts.iter().any(syntax::Contact::uses_file_collisions);
        options.visuals = mechanism.requests.drawing;
        options.contact_points = limit;
        let path = folder.join(&options.path.text);
        let text = import::read_imported_file(&path, options, cx);
        files.extend(text.is_some().then_some(path));
        if let Some(imported) = text.and_then(|text| import::import_file(&text, folder, options, cx)) {
            files.extend(imported.files.iter().cloned());
            merge_imported_file(&mut mechanism, imported, cx);
        }
    }
    files.extend(import::read_hulls(&mut mechanism.description, folder, limit, cx));
    Some(ParsedSource { mechanism, files, imported: cx.len() == before })
}

impl ParsedSource {
    /// Whether the declared contacts have more contact points than a mechanism.
    pub fn exceeds_contact_points(&self) -> bool {
        import::exceeds_contact_points(&self.mechanism.description)
    }

    /// Removes the contacts without compliance from the mechanism and returns them. Returns `None` if they
    /// cannot be separated ([`import::separate_contacts`]), or with the option `derivatives`, which is for
    /// all contacts together.
    pub fn separate_contacts(&mut self) -> Option<Vec<import::SeparateContact>> {
        if self.mechanism.requests.has_option(syntax::RequestOption::Derivatives) {
            return None;
        }
        import::separate_contacts(&mut self.mechanism.description)
    }
}

/// Merges the mechanism of an imported file into the description. Elements of the file precede those of the
/// struct.
fn merge_imported_file(mechanism: &mut Mechanism, imported: import::ImportedMechanism, cx: &mut Diagnostics) {
    let Mechanism { description, shell, requests, .. } = mechanism;
    // All of it: a part that is not named here does not compile.
    let import::ImportedMechanism {
        bodies,
        joints,
        drives,
        dissipations,
        constraints,
        gravity,
        limits,
        fields,
        rates,
        is_ground,
        contacts,
        collisions,
        visuals,
        snapped,
        left_out,
        files: _,
    } = imported;
    for field in &fields {
        if let Some(own) = description.parameters.iter().find(|own| own.text == field.ident) {
            cx.report_error(own.place.clone(), format!("the name `{}` is used twice", own.text)).add_help(
                format!("the field for values of `{}` in the file has this name: choose another", field.of),
            );
        }
    }
    for field in &fields {
        let place = description.name.place.clone();
        let name_at_place = |text| syntax::Name { text, place: place.clone() };
        if let Some((text, rate)) = rates.iter().find(|(text, _)| *text == field.ident) {
            description.states.push((name_at_place(text.clone()), description.parameters.len()));
            description.outputs.push(syntax::Definition {
                name: name_at_place(format!("{text}{}", syntax::RATE_OF_STATE)),
                rank: syntax::Rank::Scalar,
                value: rate.clone(),
                resolved_in: None,
            });
        }
        description.parameters.extend(field.value_access_paths().into_iter().map(name_at_place));
        description.file_units.extend(&field.units);
    }
    requests.file_parameters |= !rates.is_empty();
    requests.sensitivities |= requests.derivatives && !rates.is_empty();
    shell.file_fields = fields;
    let own_bodies = std::mem::replace(&mut description.bodies, bodies);
    let own_joints = std::mem::replace(&mut description.joints, joints);
    for own in &own_bodies {
        if description.bodies.iter().any(|b| b.name.text == own.name.text) {
            cx.report_error(
                own.name.place.clone(),
                format!("the file already has a link `{}`", own.name.text),
            )
            .add_help("choose another name, or use the link by its name without declaring it");
        }
    }
    for own in &own_joints {
        if description.joints.iter().any(|b| b.name.text == own.name.text) {
            cx.report_error(
                own.name.place.clone(),
                format!("the file already has a joint `{}`", own.name.text),
            )
            .add_help("choose another name, or use the joint by its name without declaring it");
        }
    }
    description.bodies.extend(own_bodies);
    description.joints.extend(own_joints);
    // Limits of the file come first.
    description.limits.splice(0..0, limits);
    description.collisions = collisions;
    description.contacts.splice(0..0, contacts);
    description.visuals = visuals;
    description.drives = drives;
    description.dissipations.splice(0..0, dissipations);
    description.constraints.splice(0..0, constraints);
    description.snapped = snapped;
    description.left_out = left_out;
    description.ground_frame = is_ground;
    if description.gravity.is_none() {
        let place = description.name.place.clone();
        let default_gravity = || syntax::Expr::vector_at([0.0, 0.0, -9.81], &place);
        description.gravity = Some(gravity.unwrap_or_else(default_gravity));
    }
}

impl ParsedSource {
    /// Returns the fields that are tables, with the number of variables of each.
    pub fn tables_with_variable_counts(&self) -> Vec<(String, usize)> {
        let tables = &self.mechanism.description.tables;
        tables.iter().map(|table| (table.name.text.clone(), table.variables)).collect()
    }

    /// Returns one line per joint with its type and the bodies that it connects.
    pub fn joint_structure_lines(&self) -> Vec<String> {
        self.mechanism.description.joints.iter().map(joint_documentation_line).collect()
    }

    /// Emits the Rust code of the compiled mechanism.
    pub fn emit_mechanism(
        &self,
        m: &mechanism::Model<'_>,
        output: &derive::DerivationOutput,
    ) -> GeneratedCode {
        emit::emit_mechanism(&self.public_interface(m, output), output)
    }

    /// Returns the public interface of the compiled mechanism.
    fn public_interface(&self, m: &mechanism::Model<'_>, output: &derive::DerivationOutput) -> Interface<'_> {
        let bare = self.model_independent_interface();
        let base = output.constants.iter().find(|constant| constant.name == "BASE_PARAMETERS");
        let base = base.map_or(0, |constant| constant.list.len());
        let facts = Facts { base, ..Facts::from_model(m, self.mechanism.requests) };
        Interface {
            configuration: m.configuration.clone(),
            velocities: m.velocities.iter().map(|(name, _)| name.clone()).collect(),
            inputs: m.inputs.iter().map(|(name, _)| name.clone()).collect(),
            frames: m.frames.iter().map(|f| f.name.clone()).collect(),
            diagrams: m
                .outputs
                .iter()
                .filter_map(|output| Some((output.name.clone(), output.diagram.clone()?)))
                .collect(),
            units: m.units.clone(),
            constraints: Constraints::from_model(m),
            contacts: emit::UnilateralContact::from_model(m),
            polytopes: emit::ContactPolytopes::from_model(m),
            limits: emit::CoordinateLimitIndices::from_model(m),
            figures: emit::ParameterCondition::conditions_of_model(m),
            absent: emit::items_that_mechanism_lacks(&facts, &output.functions, &bare.outputs),
            facts,
            ..bare
        }
    }

    /// Returns the part of the interface that does not depend on the model.
    fn model_independent_interface(&self) -> Interface<'_> {
        let d = &self.mechanism.description;
        Interface {
            shell: &self.mechanism.shell,
            scalar: d.scalar.clone(),
            configuration: Vec::new(),
            velocities: Vec::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
            structure: self.joint_structure_lines(),
            constraints: Constraints::default(),
            contacts: Vec::new(),
            polytopes: emit::ContactPolytopes::default(),
            limits: Vec::new(),
            figures: Vec::new(),
            states: d.states.iter().map(|(name, k)| (name.text.clone(), *k)).collect(),
            outputs: d.outputs.iter().map(|output| output.name.text.clone()).collect(),
            diagrams: Vec::new(),
            units: mechanism::Units::default(),
            facts: Facts::default(),
            detect: !self.mechanism.requests.target_only,
            snapped: &d.snapped,
            left_out: &d.left_out,
            absent: Vec::new(),
            files: self.files.iter().map(|f| f.to_string_lossy().into_owned()).collect(),
        }
    }

    /// Emits the interface of a mechanism that failed to compile, as far as it can be guessed.
    pub(crate) fn emit_error_stubs(&self) -> GeneratedCode {
        let outline = resolve::outline_of_description(&self.mechanism.description);
        let facts = self.guess_signature_facts(&outline);
        let mut functions = catalogue::functions_derived_before_outputs(&facts);
        for output in outline.outputs.iter().filter(|output| is_unreserved_identifier(&output.name)) {
            if output.has_contact_forces && !catalogue::has_function(&output.name, &facts) {
                functions.push(catalogue::contact_force_output_function(&output.name, output.size, &facts));
                continue;
            }
            for f in catalogue::output_functions(&output.name, output.size, output.uses, &facts) {
                // The name of an output may be invalid.
                if !catalogue::has_function(&f.name, &facts)
                    && functions.iter().all(|known| known.name != f.name)
                {
                    functions.push(f);
                }
            }
        }
        functions.extend(catalogue::functions_derived_after_outputs(&facts));
        let functions: Vec<derive::Function> =
            functions.into_iter().map(derive::Function::empty_function).collect();
        let mut constants = Vec::new();
        if facts.requests.regressor {
            constants.extend(derive::AssociatedConstant::regressor_name_constants(
                &outline.bodies,
                &vec![String::new(); facts.base],
            ));
        }
        if facts.requests.sensitivities {
            let parameters: Vec<String> =
                self.mechanism.description.parameters.iter().map(|p| p.text.clone()).collect();
            constants.push(derive::AssociatedConstant::parameter_names_constant(&parameters));
        }
        if facts.requests.conserved {
            constants.push(derive::AssociatedConstant::conserved_names_constant(&vec![
                String::new();
                facts.conserved
            ]));
        }
        if facts.requests.routh {
            constants.push(derive::AssociatedConstant::cyclic_coordinate_constant(&[]));
        }
        let equilibria = self.mechanism.description.equilibria.iter();
        let unknown: Vec<_> = equilibria.map(|e| (e.name.text.clone(), Default::default())).collect();
        constants.extend(derive::AssociatedConstant::linear_equation_constants(&unknown));
        if facts.requests.drawing {
            constants.push(derive::AssociatedConstant::drawing_pieces_constant(&[]));
        }
        if facts.requests.packed {
            constants.push(derive::AssociatedConstant::packed_entries_constant(&facts.entries));
        }
        let bare = self.model_independent_interface();
        let interface = Interface {
            absent: emit::items_that_mechanism_lacks(&facts, &functions, &bare.outputs),
            configuration: outline.configuration,
            velocities: outline.velocities,
            inputs: outline.inputs,
            frames: outline.frames,
            diagrams: outline
                .diagrams
                .into_iter()
                .filter(|(name, _)| is_unreserved_identifier(name) && !catalogue::has_function(name, &facts))
                .collect(),
            constraints: if outline.constrained {
                Constraints::placeholder_constraints(outline.slipping)
            } else {
                Constraints::default()
            },
            contacts: if facts.contacts.count > 0 {
                vec![emit::UnilateralContact::placeholder_contact()]
            } else {
                Vec::new()
            },
            facts,
            ..bare
        };
        emit_error_stubs(&interface, &functions, &constants)
    }

    /// Guesses the properties of a mechanism that failed to compile on which the signatures of its functions
    /// depend.
    fn guess_signature_facts(&self, outline: &resolve::Outline) -> Facts {
        let (description, requests) = (&self.mechanism.description, self.mechanism.requests);
        let kinematic = description.inertias == syntax::InertiaOption::None;
        let nv = outline.velocities.len();
        let constraints = outline.constrained.then(|| ConstraintFacts {
            all: 1,
            holonomic: 1,
            slipping: usize::from(outline.slipping),
            ..ConstraintFacts::default()
        });
        Facts {
            nq: outline.configuration.len(),
            nv,
            nu: outline.inputs.len(),
            time: outline.time,
            velocity_inputs: outline.velocity_inputs,
            kinematic,
            speeds: !description.speeds.is_empty(),
            requests: match kinematic {
                true => {
                    let (batch, drawing) = (requests.batch, requests.drawing);
                    syntax::RequestedFunctions { batch, drawing, ..syntax::RequestedFunctions::default() }
                }
                false => requests,
            },
            constraints,
            contacts: if description.contacts.iter().all(syntax::Contact::is_compliant) {
                ContactCounts::default()
            } else {
                ContactCounts { count: 1, rates: 1 }
            },
            bodies: outline.bodies.len(),
            // Only the equations determine the number of base parameters.
            base: 7 * nv,
            parameters: description.parameters.len(),
            equilibria: description.equilibria.len(),
            entries: vec![(0, 0); nv * (nv + 1) / 2],
            ..Facts::default()
        }
    }
}

/// Returns true for valid identifiers that are not reserved for generated items.
pub(crate) fn is_unreserved_identifier(name: &str) -> bool {
    syn::parse_str::<syn::Ident>(name).is_ok()
        && !catalogue::is_known_constant_name(name)
        && !name.starts_with("__")
}

/// Returns the documentation line of a joint: its type and the bodies that it connects.
fn joint_documentation_line(joint: &syntax::Joint) -> String {
    let kind = joint.kind.name();
    let (parent, child) = (&joint.parent.body.text, &joint.child.body.text);
    format!("`{}`: {kind}, `{parent}` → `{child}`", joint.name.text)
}
