#![doc = include_str!("../README.md")]

pub mod diag;
pub mod emit;
pub mod expr;
pub mod import;
pub mod lower;
pub mod mechanics;
pub mod model;
pub mod passes;
pub mod syntax;

mod derive;

use derive::absent::absent;
use derive::signatures::{self, Sizes};
use diag::Diagnostics;
use emit::{Constraints, Emitted, Interface, emit_failed, emit_mechanism};
use expr::Graph;
use proc_macro2::TokenStream;
use std::path::{Path, PathBuf};
use syntax::{Description, Mechanism};

pub use derive::in_lanes;
pub use derive::{derive, derive_with, equations, equations_latex};

/// The whole compiler: `#[mechanism(arguments)] item` → the generated code, with one `compile_error!` for each mistake.
/// Files are looked up in `folder`.
pub fn expand(arguments: TokenStream, item: TokenStream, folder: &Path) -> Emitted {
    let mut cx = Diagnostics::new();
    let Some(source) = read(arguments, item, folder, &mut cx) else {
        return Emitted { tokens: cx.into_tokens(), text: String::new() };
    };
    let graph = Graph::new();
    let output = compile(&source, &graph, &mut cx);
    if let Some((model, output)) = &output {
        return emit_mechanism(&source.interface(model, output), output);
    }
    let mut emitted = source.emit_failed();
    emitted.tokens.extend(cx.into_tokens());
    emitted
}

/// Of a struct whose derives come before the attribute and have seen its elements: one `compile_error!`, and what keeps rustc
/// from saying the same for each element and derive.
pub fn expand_below_a_derive(arguments: TokenStream, item: TokenStream, folder: &Path) -> Emitted {
    let mut cx = Diagnostics::new();
    let Some(source) = read(arguments, item, folder, &mut cx) else {
        return Emitted { tokens: cx.into_tokens(), text: String::new() };
    };
    let mut emitted = source.emit_failed();
    if cx.is_empty() {
        emitted.tokens.extend(emit::with_elements(&source.mechanism.shell));
    }
    cx.error(proc_macro2::Span::call_site(), "`#[derive(…)]` stands above `#[mechanism]`")
        .help("write it below: there it sees the struct without its elements, which do not stay");
    emitted.tokens.extend(cx.into_tokens());
    emitted
}

/// The messages of the mistakes in a mechanism; empty if there is none.
pub fn check(arguments: TokenStream, item: TokenStream, folder: &Path) -> Vec<String> {
    let mut cx = Diagnostics::new();
    if let Some(source) = read(arguments, item, folder, &mut cx) {
        compile(&source, &Graph::new(), &mut cx);
    }
    cx.messages()
}

/// A mechanism as read, with its file.
pub struct Source {
    /// What the struct and the file say.
    pub mechanism: Mechanism,
    /// Where the file is.
    file: Option<PathBuf>,
}

/// Syntax and import: what the user wrote, from tokens and file. `None` if there is nothing to go on.
pub fn read(
    arguments: TokenStream,
    item: TokenStream,
    folder: &Path,
    cx: &mut Diagnostics,
) -> Option<Source> {
    let mut mechanism = syntax::parse_mechanism(arguments, item, cx)?;
    let mut file = None;
    if let Some(options) = &mechanism.urdf {
        let path = folder.join(&options.path.text);
        let text = import::read_file(&path, options, cx);
        file = text.is_some().then_some(path);
        if let Some(imported) = text.and_then(|text| import::import_urdf(&text, options, cx)) {
            merge(&mut mechanism.description, imported, cx);
        }
    }
    Some(Source { mechanism, file })
}

/// Puts the contents of a file before those of the struct.
fn merge(description: &mut Description, imported: import::Imported, cx: &mut Diagnostics) {
    let own_bodies = std::mem::replace(&mut description.bodies, imported.bodies);
    let own_joints = std::mem::replace(&mut description.joints, imported.joints);
    for own in &own_bodies {
        if description.bodies.iter().any(|b| b.name.text == own.name.text) {
            cx.error(own.name.place.clone(), format!("the file has a link `{}` already", own.name.text));
        }
    }
    for own in &own_joints {
        if description.joints.iter().any(|b| b.name.text == own.name.text) {
            cx.error(own.name.place.clone(), format!("the file has a joint `{}` already", own.name.text));
        }
    }
    description.bodies.extend(own_bodies);
    description.joints.extend(own_joints);
    description.snapped = imported.snapped;
    description.ground_frame = imported.is_ground;
    if description.gravity.is_none() {
        let place = description.name.place.clone();
        description.gravity = Some(syntax::Expr::vector([0.0, 0.0, -9.81], &place));
    }
}

/// Model and mechanics: the checked mechanism and everything that is generated from it.
pub fn compile<'g>(
    source: &Source,
    graph: &'g Graph,
    cx: &mut Diagnostics,
) -> Option<(model::Model<'g>, emit::Output)> {
    compile_with(source, graph, passes::Passes::default(), cx)
}

/// The same with a choice of passes.
pub fn compile_with<'g>(
    source: &Source,
    graph: &'g Graph,
    passes: passes::Passes,
    cx: &mut Diagnostics,
) -> Option<(model::Model<'g>, emit::Output)> {
    // What failed to parse would only lead to further complaints.
    if !cx.is_empty() {
        return None;
    }
    let model = model::build_model(&source.mechanism.description, graph, cx)?;
    let mut output = derive_with(&model, source.mechanism.requests, passes, cx)?;
    describe(&mut output, &source.mechanism);
    check_outputs(&source.mechanism.description, &output.functions, source.mechanism.requests, cx)
        .then_some((model, output))
}

/// Puts what the user says of an output before the documentation of its function.
fn describe(output: &mut emit::Output, mechanism: &Mechanism) {
    let outputs = &mechanism.description.outputs;
    let notes = mechanism.shell.notes.iter().filter(|(name, _)| outputs.iter().any(|o| o.name.text == *name));
    let prepared = output.prepared.iter_mut().flat_map(|prepared| &mut prepared.functions);
    let mut functions: Vec<&mut emit::Function> = output.functions.iter_mut().chain(prepared).collect();
    for (name, note) in notes {
        for f in functions.iter_mut().filter(|f| f.name == *name && !f.docs.is_empty()) {
            f.docs.insert(0, note.clone());
        }
    }
}

/// Functions that are not derived but written as they are, those of mechanisms with constraints included.
const WRITTEN: [&str; 17] = [
    "assemble",
    "complete_velocity",
    "constrained_dynamics",
    "constraint_correction",
    "difference",
    "forward_dynamics",
    "frame_acceleration",
    "frame_index",
    "frame_jacobian",
    "frame_placement",
    "frame_placements",
    "frame_velocity",
    "integrate",
    "project_configuration",
    "project_velocity",
    "tangent_rate",
    "try_constrained_dynamics",
];

/// Constants of mechanisms.
const CONSTANTS: [&str; 17] = [
    "BASE_PARAMETERS",
    "BODIES",
    "CONFIGURATION",
    "CONSTRAINTS",
    "EQUATIONS",
    "EQUATIONS_LATEX",
    "FRAMES",
    "INPUTS",
    "MASS_MATRIX_ENTRIES",
    "NC",
    "NH",
    "NP",
    "NQ",
    "NS",
    "NU",
    "NV",
    "PARAMETERS",
];

/// True for names that neither Rust nor what is generated needs.
fn can_be_a_function(name: &str) -> bool {
    syn::parse_str::<syn::Ident>(name).is_ok() && !CONSTANTS.contains(&name) && !name.starts_with("__")
}

/// Reports outputs that would be functions of the same name as others, or of none that a function can have.
fn check_outputs(
    description: &Description,
    functions: &[emit::Function],
    requests: syntax::Requests,
    cx: &mut Diagnostics,
) -> bool {
    let outputs = &description.outputs;
    let jacobian = |name: &str| format!("{name}_jacobian");
    // Each output brings one function of its name and may bring its Jacobian: what is there besides was there before.
    let is_taken = |name: &str| {
        let on_request = match name {
            "prepare" => requests.prepare,
            "linearize" | "forward_dynamics_derivatives" => requests.derivatives,
            _ => false,
        };
        if on_request {
            return true;
        }
        let own = outputs.iter().filter(|o| o.name.text == name || jacobian(&o.name.text) == name).count();
        let one = name.strip_suffix("_lanes").filter(|_| requests.batch);
        let in_lanes =
            one.is_some_and(|one| WRITTEN.contains(&one) || functions.iter().any(|f| f.name == one));
        in_lanes || WRITTEN.contains(&name) || functions.iter().filter(|f| f.name == name).count() > own
    };
    for name in outputs.iter().map(|output| &output.name) {
        let text = &name.text;
        if let Some(other) = outputs.iter().find(|other| jacobian(&other.name.text) == *text) {
            let other = &other.name.text;
            cx.error(name.place.clone(), format!("`{text}` is the Jacobian of the output `{other}`"))
                .help("each output has a function of its name and one of its name with `_jacobian`");
        } else if description.inertias == syntax::Inertias::None && functions.iter().all(|f| f.name != *text)
        {
            cx.error(
                name.place.clone(),
                format!("the output `{text}` names a reaction, which needs inertia"),
            )
            .help("remove it, or `inertia = none`: without inertia there are no dynamics");
        } else if !can_be_a_function(text) {
            cx.error(name.place.clone(), format!("a function of a mechanism cannot be called `{text}`"))
                .help(
                    "keywords, names of its constants and names with two underscores before them are taken",
                );
        } else if is_taken(text) {
            cx.error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has this function"),
            )
            .help("choose another name for the output");
        } else if is_taken(&jacobian(text)) {
            cx.error(
                name.place.clone(),
                format!("the name `{text}` is taken: every mechanism has `{}`", jacobian(text)),
            )
            .help("choose another name for the output");
        }
    }
    cx.is_empty()
}

impl Source {
    /// What the outside sees of the mechanism.
    fn interface(&self, m: &model::Model<'_>, output: &emit::Output) -> Interface<'_> {
        let bare = self.bare_interface();
        let constrained = !m.constraints.is_empty();
        Interface {
            configuration: m.configuration.clone(),
            velocities: m.velocities.iter().map(|(name, _)| name.clone()).collect(),
            inputs: m.inputs.iter().map(|(name, _)| name.clone()).collect(),
            frames: m.frames.iter().map(|f| f.name.clone()).collect(),
            units: m.units.clone(),
            time: m.time,
            velocity_inputs: m.velocity_inputs,
            constraints: Constraints::of(m),
            absent: absent(
                &Sizes::of(m),
                self.mechanism.requests,
                &output.functions,
                &bare.outputs,
                constrained,
            ),
            ..bare
        }
    }

    /// The part of it that needs no model.
    fn bare_interface(&self) -> Interface<'_> {
        let d = &self.mechanism.description;
        Interface {
            shell: &self.mechanism.shell,
            scalar: d.scalar.clone(),
            configuration: Vec::new(),
            velocities: Vec::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
            structure: d.joints.iter().map(structure_line).collect(),
            constraints: Constraints::default(),
            outputs: d.outputs.iter().map(|output| output.name.text.clone()).collect(),
            units: model::units::Units::default(),
            kinematic: d.inertias == syntax::Inertias::None,
            time: false,
            velocity_inputs: false,
            batch: self.mechanism.requests.batch,
            detect: !self.mechanism.requests.target_only,
            snapped: &d.snapped,
            absent: Vec::new(),
            file: self.file.as_ref().map(|f| f.to_string_lossy().into_owned()),
        }
    }

    /// The interface of a mechanism that failed to compile, as far as it can be guessed.
    fn emit_failed(&self) -> Emitted {
        let outline = model::outline(&self.mechanism.description);
        let sizes = Sizes {
            nq: outline.configuration.len(),
            nv: outline.velocities.len(),
            nu: outline.inputs.len(),
            time: outline.time,
            velocity_inputs: outline.velocity_inputs,
            massless: false,
        };
        let kinematic = self.mechanism.description.inertias == syntax::Inertias::None;
        let (mut functions, requests) = match kinematic {
            true => (signatures::kinematic(&sizes), syntax::Requests::default()),
            false => (signatures::always(&sizes), self.mechanism.requests),
        };
        functions.extend(signatures::requested(&sizes, requests));
        let mut constants = Vec::new();
        if requests.regressor {
            // How many base parameters there are, only the equations could tell.
            let base = vec![String::new(); 7 * sizes.nv];
            functions.extend(signatures::regressor(&sizes, outline.bodies.len(), base.len()));
            constants.extend(signatures::names(&outline.bodies, &base));
        }
        if requests.sensitivities {
            let parameters: Vec<String> =
                self.mechanism.description.parameters.iter().map(|p| p.text.clone()).collect();
            functions.extend(signatures::sensitivities(&sizes, parameters.len()));
            constants.push(signatures::parameters(&parameters));
        }
        if requests.packed {
            let entries = vec![(0, 0); sizes.nv * (sizes.nv + 1) / 2];
            functions.extend(signatures::packed(&sizes, &entries));
            constants.push(signatures::entries(&entries));
        }
        if outline.constrained && kinematic {
            functions.extend(signatures::constraints(&sizes, 1, 1));
        } else if outline.constrained {
            signatures::constrain(&mut functions, &sizes, usize::from(outline.slipping), requests);
        }
        for output in outline.outputs.iter().filter(|output| can_be_a_function(&output.name)) {
            for f in signatures::output(&output.name, output.size, output.uses, &sizes) {
                // An output may have the wrong name.
                if !WRITTEN.contains(&f.name.as_str()) && functions.iter().all(|known| known.name != f.name) {
                    functions.push(f);
                }
            }
        }
        let bare = self.bare_interface();
        let interface = Interface {
            absent: absent(&sizes, requests, &functions, &bare.outputs, outline.constrained),
            configuration: outline.configuration,
            velocities: outline.velocities,
            inputs: outline.inputs,
            frames: outline.frames,
            time: outline.time,
            velocity_inputs: outline.velocity_inputs,
            constraints: if outline.constrained {
                Constraints::unknown(outline.slipping)
            } else {
                Constraints::default()
            },
            ..bare
        };
        emit_failed(&interface, &functions, &constants, requests.prepare)
    }
}

/// What a joint joins, in a line of the documentation.
fn structure_line(joint: &syntax::Joint) -> String {
    let kind = syntax::element::kind_word(joint.kind);
    let (parent, child) = (&joint.parent.body.text, &joint.child.body.text);
    format!("`{}`: {kind}, `{parent}` → `{child}`", joint.name.text)
}
