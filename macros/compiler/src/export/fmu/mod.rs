//! Export to FMUs of the Functional Mock-up Interface 3.0, for model exchange and co-simulation.
//!
//! An FMU contains the functions in C (`export::c`), handwritten C99 sources that implement the interface,
//! and a header that connects the two.

mod description;
mod library;
mod model;
mod units;
mod values;
mod variables;

use super::c;
use super::mechanism::{ExportObstacle, ExportedMechanism, Options};
use crate::derive::DerivationOutput;
use crate::mechanism::Model;
pub use library::export_fmu_for_runtime_library;
pub use values::{StartValues, TableValues};
use variables::FmuVariables;

/// Handwritten sources, which need no other file than `lw_model.h` and the functions in C. No identifier of a
/// model begins with `lw_`.
const SOURCES: [(&str, &str); 9] = [
    ("lw_fmi3.h", include_str!("templates/lw_fmi3.h")),
    ("lw_common.h", include_str!("templates/lw_common.h")),
    ("lw_library.h", include_str!("templates/lw_library.h")),
    ("lw_dynamics.h", include_str!("templates/lw_dynamics.h")),
    ("lw_integration.h", include_str!("templates/lw_integration.h")),
    ("lw_derivatives.h", include_str!("templates/lw_derivatives.h")),
    ("lw_modes.h", include_str!("templates/lw_modes.h")),
    ("lw_unused.h", include_str!("templates/lw_unused.h")),
    (MAIN, include_str!("templates/lw_fmi3.c")),
];

/// Name of the C source file that includes all others.
const MAIN: &str = "lw_fmi3.c";

/// Texts of the files of an FMU.
#[derive(Clone, Debug)]
pub struct FmuFiles {
    /// Model identifier of the FMU.
    pub identifier: String,
    /// Paths within the FMU, with the text of each file.
    pub files: Vec<(String, String)>,
    /// Paths of the source files that a compiler is given.
    pub sources: Vec<String>,
    /// Whether importers can compile the sources. Otherwise the binary contains the run-time library.
    pub has_sources: bool,
}

/// Advice for contacts and constraints that the sources in C cannot have.
const SIMULATE: &str = "`--library FILE` puts the run-time library into the FMU, which has all contacts: \
                        `cargo build --release -p linkwork-c` builds it, and FILE is \
                        `target/release/liblinkwork_c.so`; compliant contacts (`stiffness = …`) need no \
                        library";

/// Returns the reason why a mechanism cannot be exported as an FMU, and what to do instead.
pub fn export_obstacle(model: &Model<'_>, output: &DerivationOutput) -> Option<(String, &'static str)> {
    use crate::catalogue::GeneratedId;
    let has_function = |id: GeneratedId| output.functions.iter().any(|f| f.id == id);
    if model.kinematic || model.nv() == 0 || !has_function(GeneratedId::MassMatrix) {
        let what = "an FMU is for mechanisms that move, and this one has no equations of motion";
        return Some((what.to_string(), "give its bodies masses and joints"));
    }
    if has_function(GeneratedId::SlippingResponse) {
        return Some(("the sources of FMUs have no constraints with friction".to_string(), SIMULATE));
    }
    if !model.polytopes.is_empty() {
        let what = "the sources of FMUs have no contacts of hulls and cylinders with each other, and of \
                    hulls with boxes and capsules";
        return Some((what.to_string(), SIMULATE));
    }
    let contact =
        model.contacts.iter().find(|c| c.rates.len() > 1 || c.pressed_by.is_some() || c.of_impulses)?;
    let what = if contact.of_impulses { "restitution by Poisson's law" } else { "friction" };
    Some((
        format!(
            "the contact `{}` has {what}: the sources of FMUs have contacts without friction, with Newton's \
             restitution",
            contact.name
        ),
        SIMULATE,
    ))
}

/// Exports a mechanism whose programs have no vector lanes; `tables` are the names of its tables. With
/// `has_derivatives` the FMU provides directional and adjoint derivatives.
///
/// # Errors
/// The mechanism is not supported, for the reason in [`ExportObstacle`].
pub fn export_fmu(
    model: &Model<'_>,
    output: &DerivationOutput,
    tables: &[String],
    options: &Options,
    start: &StartValues,
    has_derivatives: bool,
) -> Result<FmuFiles, ExportObstacle> {
    let code = c::export_c_source(model, output, tables, options)?;
    let signatures = ExportedMechanism::new(model, output, tables, options)?;
    let variables = FmuVariables::new(model, &signatures, start, has_derivatives);
    let identifier = code.prefix.clone();
    let model_text = model::model_header(model, output, &signatures, &variables, start);
    let token = instantiation_token(&[&code.source, &code.header, &model_text]);
    let description = description::model_description_text(model, &identifier, &token, &variables);
    let sources = vec![format!("sources/{identifier}.c"), format!("sources/{MAIN}")];
    let mut files = vec![
        ("modelDescription.xml".to_string(), description),
        ("sources/buildDescription.xml".to_string(), description::build_description_xml(&identifier, MAIN)),
        (sources[0].clone(), code.source),
        (format!("sources/{identifier}.h"), code.header),
        ("sources/lw_model.h".to_string(), model_text.replace("@TOKEN@", &token)),
    ];
    files.extend(SOURCES.map(|(name, text)| (format!("sources/{name}"), text.to_string())));
    Ok(FmuFiles { identifier, files, sources, has_sources: true })
}

/// Returns a token that identifies the model: a hash of its texts, in the form of a UUID.
fn instantiation_token(texts: &[&str]) -> String {
    let hash_of_texts = |seed: u64| {
        let bytes = texts.iter().flat_map(|text| text.bytes());
        bytes.fold(seed, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    };
    let (a, b) = (hash_of_texts(0xcbf2_9ce4_8422_2325), hash_of_texts(0x6c62_272e_07bb_0142));
    format!(
        "{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}",
        a >> 32,
        (a >> 16) & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    )
}
