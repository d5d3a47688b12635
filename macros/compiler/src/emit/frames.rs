//! Generated access to named frames. The functions of a frame call only the kinematic steps along its path
//! from the ground.

use super::body::write_body;
use super::instruction::BuildKind;
use super::interface::{ALLOW, ImplGenerics};
use super::signature::SignatureContext;
use crate::catalogue::Argument;
use crate::derive::{FrameRecursionPrograms, Function, LinkRecursionPrograms};
use crate::lower::Program;
use crate::mechanism::SuppliedQuantity;
use std::fmt::Write;

const PARENT: Argument = Argument::Given("p", SuppliedQuantity::Parent, 12);

/// Writes the kinematic steps and the functions that call them, for a type of this name: the placements of
/// all frames and the implementations of `NamedFrame`. The steps are methods of a private trait inside this
/// block, so that neither documentation nor editors list them.
pub fn write_frames(
    out: &mut String,
    name: &str,
    head: &ImplGenerics,
    (links, frames): (&[LinkRecursionPrograms], &[FrameRecursionPrograms]),
    speeds: bool,
    s: &SignatureContext<'_>,
) {
    let ImplGenerics { generics, arguments, bounds } = head;
    let steps = kinematic_step_methods(links, frames, s);
    let _ = writeln!(
        out,
        "const _: () = {{
        {ALLOW}trait __Steps{generics} {bounds} {{\n{}}}
        {ALLOW}impl{generics} __Steps{arguments} for {name}{arguments} {bounds} {{\n{}}}
        {ALLOW}impl{generics} {name}{arguments} {bounds} {{
        /// Placements of all frames in the ground, in the order of `FRAMES`.
        #[inline]\n#[must_use]
        pub fn frame_placements({}) -> [::linkwork::nalgebra::IsometryMatrix3<{}>; {}] {{",
        steps.declarations,
        steps.methods,
        s.parameter_list(&s.with_time_argument(&[Argument::Q])),
        s.scalar.scalar_name(),
        frames.len()
    );
    write_all_placements(out, links, frames, s);
    out.push_str("}\n}\n");
    for (k, frame) in frames.iter().enumerate() {
        let _ = writeln!(
            out,
            "{ALLOW}#[doc(hidden)]\nimpl{generics} ::linkwork::NamedFrame<{k}, {}, {}> for {name}{arguments} \
             {bounds} {{\ntype Scalar = {};",
            s.nq,
            s.nv,
            s.scalar.scalar_name()
        );
        write_frame_impl(out, k, frame, links, speeds, s);
        out.push_str("}\n");
    }
    out.push_str("};\n");
}

/// Methods of the private trait for the kinematic steps of frames.
#[derive(Default)]
struct FrameStepMethods {
    /// Declarations of the methods, for the trait's definition.
    declarations: String,
    /// Definitions of the methods, for the implementation of the trait.
    methods: String,
}

impl FrameStepMethods {
    /// Adds a method to both lists. `attribute` follows `inline` in its attribute, such as `(always)`.
    fn add_method(&mut self, attribute: &str, signature: &str, body: &str) {
        let _ = writeln!(self.declarations, "{signature};");
        let _ = writeln!(self.methods, "#[inline{attribute}]\n{signature} {{\n{body}}}");
    }
}

/// Returns the kinematic steps of all links and frames as private methods.
fn kinematic_step_methods(
    links: &[LinkRecursionPrograms],
    frames: &[FrameRecursionPrograms],
    s: &SignatureContext<'_>,
) -> FrameStepMethods {
    let mut steps = FrameStepMethods::default();
    let mut add_kinematic_step = |name: String, arguments: Vec<Argument>, n: usize, program: &Program| {
        let f = Function::hidden_part_function(name, arguments, n, program.clone());
        let mut body = String::new();
        write_body(&mut body, &f, s, false, BuildKind::Optimised);
        let signature = format!("fn {}({}) -> {}", f.name, s.parameter_list(&f.arguments), s.result_type(&f));
        steps.add_method("", &signature, &body);
    };
    for (k, link) in links.iter().enumerate() {
        let arguments_with_parent = |arguments: &[Argument], given: Argument| {
            let mut all = s.with_time_argument(arguments);
            all.extend(link.parent.map(|_| given));
            all
        };
        add_kinematic_step(
            format!("__link{k}_placement"),
            arguments_with_parent(&[Argument::Q], PARENT),
            12,
            &link.placement,
        );
        let twist = arguments_with_parent(
            &[Argument::Q, Argument::V],
            Argument::Given("p", SuppliedQuantity::Parent, 6),
        );
        add_kinematic_step(format!("__link{k}_twist"), twist, 6, &link.twist);
        let acceleration = arguments_with_parent(
            &[Argument::Q, Argument::V, Argument::A],
            Argument::Given("p", SuppliedQuantity::Parent, 12),
        );
        add_kinematic_step(format!("__link{k}_acceleration"), acceleration, 6, &link.acceleration);
        let mut columns = if link.driven { s.with_time_argument(&[Argument::Q]) } else { Vec::new() };
        columns.extend([
            Argument::Given("p", SuppliedQuantity::Parent, 12),
            Argument::Given("o", SuppliedQuantity::Origin, 3),
        ]);
        add_kinematic_step(format!("__link{k}_columns"), columns, 6 * link.velocities.len(), &link.columns);
    }
    for (k, frame) in frames.iter().enumerate() {
        let link_quantity_arguments = |n: usize| {
            frame
                .link
                .map(|_| Argument::Given("p", SuppliedQuantity::Parent, n))
                .into_iter()
                .collect::<Vec<_>>()
        };
        if !frame.is_link {
            add_kinematic_step(
                format!("__frame{k}_placement"),
                link_quantity_arguments(12),
                12,
                &frame.placement,
            );
        }
        add_kinematic_step(format!("__frame{k}_twist"), link_quantity_arguments(18), 6, &frame.twist);
        add_kinematic_step(
            format!("__frame{k}_acceleration"),
            link_quantity_arguments(24),
            6,
            &frame.acceleration,
        );
    }
    for (k, link) in links.iter().enumerate() {
        add_path_kinematics_methods(&mut steps, k, link, s);
        add_path_jacobian_methods(&mut steps, k, links, s);
    }
    steps
}

/// Returns `t, `, the first argument of a call, if functions take time; otherwise an empty text.
fn time_argument_prefix(s: &SignatureContext<'_>) -> &'static str {
    if s.time { "t, " } else { "" }
}

/// Returns the links from the ground to a link, that link included.
fn links_from_ground(links: &[LinkRecursionPrograms], mut link: Option<usize>) -> Vec<usize> {
    let mut path = Vec::new();
    while let Some(k) = link {
        path.push(k);
        link = links[k].parent;
    }
    path.reverse();
    path
}

fn write_link_placement(out: &mut String, k: usize, link: &LinkRecursionPrograms, s: &SignatureContext<'_>) {
    let t = time_argument_prefix(s);
    let parent = link.parent.map_or(String::new(), |p| format!(", &x{p}"));
    let _ = writeln!(out, "let x{k} = self.__link{k}_placement({t}q{parent});");
}

fn frame_placement_expression(k: usize, frame: &FrameRecursionPrograms) -> String {
    match frame.link {
        Some(link) if frame.is_link => format!("x{link}"),
        Some(link) => format!("self.__frame{k}_placement(&x{link})"),
        None if frame.is_link => "::linkwork::__private::identity_placement()".to_string(),
        None => format!("self.__frame{k}_placement()"),
    }
}

/// Writes the body of `frame_placements`, which computes each link placement once.
fn write_all_placements(
    out: &mut String,
    links: &[LinkRecursionPrograms],
    frames: &[FrameRecursionPrograms],
    s: &SignatureContext<'_>,
) {
    for (k, link) in links.iter().enumerate() {
        write_link_placement(out, k, link, s);
    }
    let list: Vec<String> = frames
        .iter()
        .enumerate()
        .map(|(k, frame)| {
            format!("::linkwork::__private::placement(&{})", frame_placement_expression(k, frame))
        })
        .collect();
    let _ = writeln!(out, "[{}]", list.join(",\n"));
}

/// Writes the methods of `NamedFrame` for one frame.
fn write_frame_impl(
    out: &mut String,
    k: usize,
    frame: &FrameRecursionPrograms,
    links: &[LinkRecursionPrograms],
    speeds: bool,
    s: &SignatureContext<'_>,
) {
    let scalar = s.scalar.scalar_name();
    // The steps take joint velocities.
    let (rates, accelerations) = match speeds {
        true => ("let v = &self.rates_of_speeds(q, v);\n", "let a = &self.__rate_accelerations(q, v, a);\n"),
        false => ("", ""),
    };
    let write_frame_method = |out: &mut String, name: &str, arguments: &[Argument], result: &str| {
        let all: Vec<Argument> = std::iter::once(Argument::T).chain(arguments.iter().copied()).collect();
        let _ = writeln!(out, "#[inline]\nfn {name}({}) -> {result} {{", s.parameter_list(&all));
    };
    let t = time_argument_prefix(s);
    write_frame_method(out, "placement", &[Argument::Q], &format!("[{scalar}; 12]"));
    write_frame_link_binding(out, frame.link, s);
    let _ = writeln!(out, "{}\n}}", frame_placement_expression(k, frame));

    write_frame_method(out, "twist", &[Argument::Q, Argument::V], &format!("[{scalar}; 6]"));
    out.push_str(rates);
    write_frame_link_binding(out, frame.link, s);
    let last = frame.link.map_or(String::new(), |l| {
        format!("&::linkwork::__private::join(&x{l}, &self.__link{l}_path_twist({t}q, v))")
    });
    let _ = writeln!(out, "self.__frame{k}_twist({last})\n}}");

    write_frame_method(
        out,
        "acceleration",
        &[Argument::Q, Argument::V, Argument::A],
        &format!("[{scalar}; 6]"),
    );
    out.push_str(accelerations);
    out.push_str(rates);
    write_frame_link_binding(out, frame.link, s);
    let last = frame.link.map_or(String::new(), |l| {
        format!("&::linkwork::__private::join(&x{l}, &self.__link{l}_path_motion({t}q, v, a))")
    });
    let _ = writeln!(out, "self.__frame{k}_acceleration({last})\n}}");
    write_jacobian(out, k, frame, links.len(), speeds, s);
}

/// Writes the statement that binds the placement of the frame's link.
fn write_frame_link_binding(out: &mut String, link: Option<usize>, s: &SignatureContext<'_>) {
    if let Some(k) = link {
        let _ = writeln!(out, "let x{k} = self.__link{k}_path_placement({}q);", time_argument_prefix(s));
    }
}

/// Adds the methods that compute kinematics of a link along its path from the ground: the placement, the
/// twist, and twist and acceleration together.
fn add_path_kinematics_methods(
    steps: &mut FrameStepMethods,
    k: usize,
    link: &LinkRecursionPrograms,
    s: &SignatureContext<'_>,
) {
    use Argument::{A, Q, V};
    let (scalar, t) = (s.scalar.scalar_name(), time_argument_prefix(s));
    let mut add_path_method = |name: &str, arguments: &[Argument], n: usize, body: &str| {
        let parameters = s.parameter_list(&s.with_time_argument(arguments));
        steps.add_method(
            "(always)",
            &format!("fn __link{k}_path_{name}({parameters}) -> [{scalar}; {n}]"),
            body,
        );
    };
    let parent_path_call_argument = |name: &str, state: &str| {
        link.parent.map_or(String::new(), |p| format!(", &self.__link{p}_path_{name}({t}{state})"))
    };
    let placement = format!("self.__link{k}_placement({t}q{})", parent_path_call_argument("placement", "q"));
    add_path_method("placement", &[Q], 12, &placement);
    let twist = format!("self.__link{k}_twist({t}q, v{})", parent_path_call_argument("twist", "q, v"));
    add_path_method("twist", &[Q, V], 6, &twist);
    let motion = match link.parent {
        Some(p) => format!(
            "let p = self.__link{p}_path_motion({t}q, v, a);\n\
             let w = self.__link{k}_twist({t}q, v, &::linkwork::__private::twist(&p));\n\
             ::linkwork::__private::join(&w, &self.__link{k}_acceleration({t}q, v, a, &p))"
        ),
        None => format!(
            "::linkwork::__private::join(&self.__link{k}_twist({t}q, v), &self.__link{k}_acceleration({t}q, \
             v, a))"
        ),
    };
    add_path_method("motion", &[Q, V, A], 12, &motion);
}

fn write_jacobian(
    out: &mut String,
    k: usize,
    frame: &FrameRecursionPrograms,
    links: usize,
    speeds: bool,
    s: &SignatureContext<'_>,
) {
    let (scalar, nv, t) = (s.scalar.scalar_name(), s.nv, time_argument_prefix(s));
    let matrix = format!("::linkwork::nalgebra::SMatrix<{scalar}, 6, {nv}>");
    let zero = format!("::linkwork::__private::constant::<{scalar}>(0.0)");
    let _ = writeln!(
        out,
        "#[inline]\nfn jacobian({}) -> {matrix} {{",
        s.parameter_list(&[Argument::T, Argument::Q])
    );
    let _ = writeln!(out, "let mut columns = [[{zero}; 6]; {nv}];");
    if let Some(l) = frame.link {
        let placement = match frame.is_link {
            true => format!("x[{l}]"),
            false => format!("self.__frame{k}_placement(&x[{l}])"),
        };
        let _ = writeln!(
            out,
            "let mut x = [[{zero}; 12]; {links}];
            self.__link{l}_path_placements({t}q, &mut x);
            let o = ::linkwork::__private::origin(&{placement});
            self.__link{l}_path_columns({t}q, &x, &o, &mut columns);"
        );
    }
    let _ = writeln!(
        out,
        "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage(columns)){}\n\
         }}",
        if speeds { " * self.__rate_matrix(q)" } else { "" }
    );
}

/// Adds the methods for frame Jacobians along the path of a link: the placements of the links from the ground
/// to it, and its columns for a point at `o`. Each method calls that of the parent link, so that the code of
/// a chain does not grow quadratically with its length.
fn add_path_jacobian_methods(
    steps: &mut FrameStepMethods,
    k: usize,
    links: &[LinkRecursionPrograms],
    s: &SignatureContext<'_>,
) {
    let (scalar, t, link, count) = (s.scalar.scalar_name(), time_argument_prefix(s), &links[k], links.len());
    let state = s.parameter_list(&s.with_time_argument(&[Argument::Q]));
    let (before, parent) = match link.parent {
        Some(p) => (format!("self.__link{p}_path_placements({t}q, x);\n"), format!(", &x[{p}]")),
        None => Default::default(),
    };
    steps.add_method(
        "(always)",
        &format!("fn __link{k}_path_placements({state}, x: &mut [[{scalar}; 12]; {count}])"),
        &format!("{before}x[{k}] = self.__link{k}_placement({t}q{parent});\n"),
    );
    let mut body = String::new();
    if let Some(p) = link.parent {
        let _ = writeln!(body, "self.__link{p}_path_columns({t}q, x, o, columns);");
    }
    let mut written = vec![false; s.nv];
    for &before in links_from_ground(links, link.parent).iter().flat_map(|l| &links[*l].velocities) {
        written[before] = true;
    }
    write_jacobian_columns(&mut body, k, link, &mut written, s);
    let signature = format!(
        "fn __link{k}_path_columns({state}, x: &[[{scalar}; 12]; {count}], o: &[{scalar}; 3], columns: &mut \
         [[{scalar}; 6]; {}])",
        s.nv
    );
    steps.add_method("(always)", &signature, &body);
}

/// Writes the columns of a link. Coupled coordinates share a column: their contributions are added.
fn write_jacobian_columns(
    out: &mut String,
    k: usize,
    link: &LinkRecursionPrograms,
    written: &mut [bool],
    s: &SignatureContext<'_>,
) {
    let state = if link.driven { format!("{}q, ", time_argument_prefix(s)) } else { String::new() };
    let call = format!("self.__link{k}_columns({state}&x[{k}], o)");
    let mut write_jacobian_column = |column: usize, value: &str, out: &mut String| {
        let value = match std::mem::replace(&mut written[column], true) {
            false => value.to_string(),
            true => format!("::linkwork::__private::sum(&columns[{column}], &{value})"),
        };
        let _ = writeln!(out, "columns[{column}] = {value};");
    };
    if let [column] = link.velocities[..] {
        write_jacobian_column(column, &call, out);
        return;
    }
    let variable_names_of_column =
        |c: usize| (0..6).map(|row| format!("j{c}_{row}")).collect::<Vec<_>>().join(", ");
    let all: Vec<String> = (0..link.velocities.len()).map(variable_names_of_column).collect();
    let _ = writeln!(out, "let [{}] = {call};", all.join(", "));
    for (column, entries) in link.velocities.iter().zip(&all) {
        write_jacobian_column(*column, &format!("[{entries}]"), out);
    }
}

/// Writes the functions of the trait `Frames`, which select an implementation of `NamedFrame` by index.
pub fn write_trait(out: &mut String, frames: usize, s: &SignatureContext<'_>) {
    use Argument::{A, Q, T, V};
    let (scalar, nq, nv) = (s.scalar.scalar_name(), s.nq, s.nv);
    let _ = writeln!(out, "type Scalar = {scalar};\nconst FRAMES: &'static [&'static str] = &Self::FRAMES;");
    let six = format!("::linkwork::nalgebra::SVector<{scalar}, 6>");
    for (name, function, arguments, result, make) in [
        (
            "placement_of",
            "placement",
            vec![T, Q],
            format!("::linkwork::nalgebra::IsometryMatrix3<{scalar}>"),
            "::linkwork::__private::placement(&",
        ),
        ("velocity_of", "twist", vec![T, Q, V], six.clone(), "::linkwork::__private::six("),
        ("acceleration_of", "acceleration", vec![T, Q, V, A], six, "::linkwork::__private::six("),
        (
            "jacobian_of",
            "jacobian",
            vec![T, Q],
            format!("::linkwork::nalgebra::SMatrix<{scalar}, 6, {nv}>"),
            "(",
        ),
    ] {
        let names: Vec<&str> = arguments.iter().map(|a| a.argument_name()).collect();
        let parameters = s.parameter_list(&arguments).replacen("&self, ", "&self, frame: usize, ", 1);
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({parameters}) -> ::core::option::Option<{result}> {{\n\
             ::core::option::Option::Some(match frame {{"
        );
        for k in 0..frames {
            let call =
                format!("::linkwork::NamedFrame::<{k}, {nq}, {nv}>::{function}(self, {})", names.join(", "));
            let _ = writeln!(out, "{k} => {make}{call}),");
        }
        out.push_str("_ => return ::core::option::Option::None,\n})\n}\n");
    }
}
