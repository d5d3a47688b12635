//! Rust source of the crate: the declaration, the table of functions, and the exported functions.

use super::{Function, FunctionArgumentKind, LibraryData, parameter_indices_of_fields};
use crate::Stop;
use std::fmt::Write;

/// Returns the text of `lib.rs`. Without a declaration, the caller must append the generated code.
pub fn library_source_text(
    known: &LibraryData<'_, '_>,
    description: &str,
    declaration: &str,
) -> Result<String, Stop> {
    let m = known.model;
    let (kind, number, prefix) = (known.struct_type_text(), known.scalar_type_name(), known.prefix);
    let [nq, nv, nu] = [m.nq(), m.nv(), m.nu()];
    let mut text = format!(
        "use linkwork::prelude::*;\nuse linkwork_library::{{self as library, Failure, Function, Given, \
         Library, Motion, Results, Rollout, given, raw}};\n\
         use std::ffi::{{CStr, c_char, c_int}};\n\n{declaration}\n"
    );
    let _ =
        write!(
        text,
        "impl Library for {kind} {{
            type Number = {number};
            const PARAMETERS: usize = {};
            const DESCRIPTION: &'static CStr = match CStr::from_bytes_with_nul({:?}.as_bytes()) {{
                Ok(text) => text,
                Err(_) => c\"{{}}\",
            }};
            const FUNCTIONS: &'static [Function<Self>] = &[{}];
            fn from_parameters(parameters: &[{number}]) -> Self {{
                let parameter = |k: usize| parameters.get(k).copied().unwrap_or({number}::NAN);
                {}
            }}
            fn check(&self) -> Result<(), Failure> {{
                {}
            }}
            fn simulate(&self, motion: &mut Motion<'_, {number}>) -> Result<(), Failure> {{
                {}
            }}
            fn roll_out(&self, rollout: Rollout<'_, {number}>) -> Result<(), Failure> {{
                {}
            }}
        }}\n\n",
        m.parameters.len(),
        format!("{description}\0"),
        known.functions.iter().map(|f| function_table_row(f, nv)).collect::<String>(),
        constructor_expression(known),
        parameter_check_code(known),
        match (m.kinematic, known.has_contacts()) {
            (true, _) =>
                "let _ = motion;\nErr(Failure::new(\"the mechanism has no dynamics\"))".to_string(),
            (_, true) => format!("library::simulate_with_contacts::<Self, {number}, {nq}, {nv}, {nu}>(self, \
                                  motion)"),
            (_, false) => format!("library::simulate::<Self, {number}, {nq}, {nv}, {nu}>(self, motion)"),
        },
        match (m.kinematic || known.has_contacts(), known.source.mechanism.requests.batch) {
            (true, _) =>
                "let _ = rollout;\nErr(Failure::new(\"rollouts go through smooth motions: this mechanism has \
                 none\"))".to_string(),
            (_, true) => format!("library::roll_out_in_lanes::<Self, {number}, {nq}, {nv}, {nu}>(self, \
                                  rollout)"),
            (_, false) => format!("library::roll_out::<Self, {number}, {nq}, {nv}, {nu}>(self, rollout)"),
        },
    );
    text.push_str(&tables_as_constants(known));
    if known
        .functions
        .iter()
        .any(|f| f.arguments.iter().any(|(_, kind)| *kind == FunctionArgumentKind::Frame))
    {
        let _ = write!(
            text,
            "/// The number of a frame.\nfn frame(g: Given<'_, {number}>) -> Result<usize, Failure> {{
                let number: {number} = given(g, 0);
                if number >= 0.0 {{ Ok(number as usize) }} else {{ Err(Failure::new(\"there is no frame with \
                    this number\")) }}
            }}\n\n"
        );
    }
    write_common_exports(&mut text, known);
    for (k, f) in known.functions.iter().enumerate() {
        write_function_export(&mut text, k, f, prefix, number, !m.parameters.is_empty());
    }
    Ok(prettyplease::unparse(&syn::parse_str(&text)?))
}

/// Returns the row of a function in the library's function table.
fn function_table_row(f: &Function, nv: usize) -> String {
    let arguments: Vec<String> =
        f.arguments.iter().map(|(_, kind)| Function::argument_length(kind, nv).to_string()).collect();
    let results: Vec<String> =
        f.results.iter().map(|(_, shape)| shape.iter().product::<usize>().to_string()).collect();
    let format_row_closure = |call: &str| {
        let g = if f.arguments.is_empty() { "_" } else { "g" };
        format!("|m, {g}, to| Results::write_to_sink({call}, to)")
    };
    let eight = f.lanes.as_ref().map_or("None".to_string(), |call| {
        let call = call.replacen("_lanes(", "_lanes::<8>(", 1);
        format!("Some({})", format_row_closure(&call))
    });
    format!(
        "Function {{ arguments: &[{}], results: &[{}], one: {}, eight: {eight} }},\n",
        arguments.join(", "),
        results.join(", "),
        format_row_closure(&f.call)
    )
}

/// Returns the expression that constructs the mechanism from its parameters and tables.
fn constructor_expression(known: &LibraryData<'_, '_>) -> String {
    let shell = &known.source.mechanism.shell;
    let name = &known.input.declaration.name;
    let tables = shell.tables.iter().filter_map(|f| f.ident.as_ref()).enumerate();
    let tables: Vec<[String; 2]> =
        tables.map(|(k, field)| [field.to_string(), format!("TABLE_{k}")]).collect();
    let has_numbers = !known.model.parameters.is_empty();
    let unused = if has_numbers { "" } else { "let _ = parameter;\n" };
    let fields = parameter_indices_of_fields(&known.model.parameters);
    let own: Vec<String> =
        shell.parameters.iter().filter_map(|f| f.ident.as_ref().map(ToString::to_string)).collect();
    let index_of_field = |field: &str| {
        fields.get(field.trim_start_matches("r#")).and_then(|all| all.first()).copied().unwrap_or(usize::MAX)
    };
    if shell.file_fields.is_empty() {
        let numbers = own.iter().map(|field| format!("{field}: parameter({})", index_of_field(field)));
        let tables = tables.iter().map(|[field, table]| format!("{field}: {table}"));
        return format!("{unused}{name} {{ {} }}", numbers.chain(tables).collect::<Vec<_>>().join(", "));
    }
    if !has_numbers && own.is_empty() && tables.is_empty() {
        return format!("{unused}{name}::FILE");
    }
    let numbers = own.iter().map(|field| format!("parameter({})", index_of_field(field)));
    let tables = tables.iter().map(|[_, table]| table.clone());
    let values: Vec<String> = numbers.chain(tables).collect();
    if !has_numbers {
        return format!("{unused}{name}::from_file({})", values.join(", "));
    }
    let mut text = format!("let mut m = {name}::from_file({});\n", values.join(", "));
    for (k, member) in known.model.parameters.iter().enumerate().filter(|(_, member)| !own.contains(member)) {
        let _ = writeln!(text, "m.{member} = parameter({k});");
    }
    text + "m"
}

/// Returns the Rust text of the mechanism's tables as constants.
fn tables_as_constants(known: &LibraryData<'_, '_>) -> String {
    let mut text = String::new();
    for (k, grid) in known.tables.iter().enumerate() {
        let axes: Vec<String> = grid.axes.iter().map(|axis| format!("&{axis:?}")).collect();
        let smooth = if grid.smooth { ".smooth()" } else { "" };
        let extrapolated = if grid.extrapolated { ".extrapolated()" } else { "" };
        let _ = writeln!(
            text,
            "const TABLE_{k}: linkwork::Table<{}> = match linkwork::Table::new([{}], &{:?}) {{
                Ok(table) => table{smooth}{extrapolated},
                Err(error) => panic!(\"{{}}\", error.message()),
            }};",
            grid.axes.len(),
            axes.join(", "),
            grid.values
        );
    }
    text
}

fn parameter_check_code(known: &LibraryData<'_, '_>) -> &'static str {
    match known.model.parameters.is_empty() {
        true => "Ok(())",
        false => "self.validate().map_err(Failure::new)",
    }
}

/// Writes the exported C functions that every library has.
fn write_common_exports(text: &mut String, known: &LibraryData<'_, '_>) {
    let (prefix, kind, number, m) =
        (known.prefix, known.struct_type_text(), known.scalar_type_name(), known.model);
    let _ = write!(
        text,
        "/// Names, shapes, units and documentation, as JSON.
        #[unsafe(no_mangle)]
        pub extern \"C\" fn {prefix}_description() -> *const c_char {{
            <{kind} as Library>::DESCRIPTION.as_ptr()
        }}

        /// Why the last call of this thread failed.
        #[unsafe(no_mangle)]
        pub extern \"C\" fn {prefix}_message() -> *const c_char {{
            raw::message()
        }}

        /// Whether a mechanism can have these parameters.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_validate(parameters: *const {number}) -> c_int {{
            unsafe {{ raw::check::<{kind}>(parameters) }}
        }}

        /// A function by its number, for many states.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_call(
            function: usize,
            parameters: *const {number},
            arguments: *const *const {number},
            results: *const *mut {number},
            states: usize,
            threads: usize,
        ) -> c_int {{
            unsafe {{ raw::call::<{kind}>(function, parameters, arguments, results, states, threads) }}
        }}\n"
    );
    write_motion_functions(text, known);
    if !m.parameters.is_empty() {
        write_file_parameter_export(text, known);
    }
}

/// Writes the exported C functions for simulations and rollouts.
fn write_motion_functions(text: &mut String, known: &LibraryData<'_, '_>) {
    let (prefix, kind, number, m) =
        (known.prefix, known.struct_type_text(), known.scalar_type_name(), known.model);
    let [nq, nv, nu] = [m.nq(), m.nv(), m.nu()];
    let _ = write!(
        text,
        "
        /// A motion.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_simulate(
            parameters: *const {number},
            q: *const {number},
            v: *const {number},
            settings: *const raw::Settings<{number}>,
            samples: *mut {number},
            rows: usize,
            count: *mut usize,
        ) -> c_int {{
            unsafe {{ raw::simulate::<{kind}>([{nq}, {nv}, {nu}], parameters, q, v, settings, samples, rows, \
                count) }}
        }}

        /// Many motions.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_roll_out(
            parameters: *const {number},
            settings: *const raw::RolloutSettings<{number}>,
            inputs: *const {number},
            q: *mut {number},
            v: *mut {number},
        ) -> c_int {{
            unsafe {{ raw::roll_out::<{kind}>([{nq}, {nv}, {nu}], parameters, settings, inputs, q, v) }}
        }}\n"
    );
}

/// Writes the exported function for the parameters of a robot file.
fn write_file_parameter_export(text: &mut String, known: &LibraryData<'_, '_>) {
    let (prefix, number, m) = (known.prefix, known.scalar_type_name(), known.model);
    let of_file = known.source.mechanism.shell.file_fields.is_empty();
    let values: String = match of_file {
        true => format!("[{number}::NAN; {}]", m.parameters.len()),
        false => {
            let shell = &known.source.mechanism.shell;
            let own: Vec<String> =
                shell.parameters.iter().filter_map(|f| f.ident.as_ref().map(ToString::to_string)).collect();
            let given = vec![format!("{number}::NAN"); own.len()].join(", ");
            let list = m.parameters.iter().map(|member| format!("m.{member}")).collect::<Vec<_>>().join(", ");
            format!("{{ let m = {}::from_file({given}); [{list}] }}", known.input.declaration.name)
        }
    };
    let _ = write!(
        text,
        "/// The parameters that a file has; others are not numbers.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_defaults(parameters: *mut {number}) {{
            let values: [{number}; {}] = {values};
            unsafe {{ raw::copy(&values, parameters) }}
        }}\n",
        m.parameters.len()
    );
}

/// Writes the exported C function for a generated function, for one state.
fn write_function_export(
    text: &mut String,
    k: usize,
    f: &Function,
    prefix: &str,
    number: &str,
    has_parameters: bool,
) {
    let own = has_parameters.then(|| format!("own: *const {number}"));
    let given = f.arguments.iter().map(|(name, kind)| match kind {
        FunctionArgumentKind::Number => format!("{name}: {number}"),
        FunctionArgumentKind::Frame => format!("{name}: c_int"),
        _ => format!("{name}: *const {number}"),
    });
    // The prefix avoids clashes, since a result may have the name of an argument.
    let wanted = f.results.iter().map(|(name, _)| format!("to_{name}: *mut {number}"));
    let list: Vec<String> = own.into_iter().chain(given).chain(wanted).collect();
    let own = if has_parameters { "own" } else { "std::ptr::null()" };
    let given: Vec<String> = f
        .arguments
        .iter()
        .map(|(name, kind)| match kind {
            FunctionArgumentKind::Number => format!("&{name}"),
            FunctionArgumentKind::Frame => format!("&({name} as {number})"),
            _ => name.clone(),
        })
        .collect();
    let wanted: Vec<String> = f.results.iter().map(|(name, _)| format!("to_{name}")).collect();
    let _ = write!(
        text,
        "\n/// `{name}`, for one state.
        ///
        /// # Safety
        ///
        /// Arrays are as the header says.
        #[unsafe(no_mangle)]
        pub unsafe extern \"C\" fn {prefix}_{name}({}) -> c_int {{
            let (given, to): ([*const {number}; {}], [*mut {number}; {}]) = ([{}], [{}]);
            unsafe {{ {prefix}_call({k}, {own}, given.as_ptr(), to.as_ptr(), 1, 1) }}
        }}\n",
        list.join(", "),
        given.len(),
        wanted.len(),
        given.join(", "),
        wanted.join(", "),
        name = f.name,
    );
}
