//! Access to named frames: for each frame, calls of the steps along its path, without computing anything else.

use super::function::write_function;
use super::signature::Signature;
use crate::catalogue::Argument;
use crate::derive::{FrameSteps, Function, LinkSteps};
use crate::lower::Program;
use std::fmt::Write;

const PARENT: Argument = Argument::Given("p", 0, 12);

/// Writes the private steps and the implementations of `NamedFrame`.
pub fn write_steps(out: &mut String, links: &[LinkSteps], frames: &[FrameSteps], s: &Signature<'_>) {
    let mut step = |name: String, arguments: Vec<Argument>, n: usize, program: &Program| {
        write_function(out, &Function::part(name, arguments, n, program.clone()), s, false);
    };
    for (k, link) in links.iter().enumerate() {
        let from_parent = |arguments: &[Argument], given: Argument| {
            let mut all = s.timed(arguments);
            all.extend(link.parent.map(|_| given));
            all
        };
        step(format!("__link{k}_placement"), from_parent(&[Argument::Q], PARENT), 12, &link.placement);
        let twist = from_parent(&[Argument::Q, Argument::V], Argument::Given("p", 0, 6));
        step(format!("__link{k}_twist"), twist, 6, &link.twist);
        let acceleration = from_parent(&[Argument::Q, Argument::V, Argument::A], Argument::Given("p", 0, 12));
        step(format!("__link{k}_acceleration"), acceleration, 6, &link.acceleration);
        let mut columns = if link.driven { s.timed(&[Argument::Q]) } else { Vec::new() };
        columns.extend([Argument::Given("p", 0, 12), Argument::Given("o", 12, 3)]);
        step(format!("__link{k}_columns"), columns, 6 * link.velocities.len(), &link.columns);
    }
    for (k, frame) in frames.iter().enumerate() {
        let given = |n: usize| frame.link.map(|_| Argument::Given("p", 0, n)).into_iter().collect::<Vec<_>>();
        if !frame.is_link {
            step(format!("__frame{k}_placement"), given(12), 12, &frame.placement);
        }
        step(format!("__frame{k}_twist"), given(18), 6, &frame.twist);
        step(format!("__frame{k}_acceleration"), given(24), 6, &frame.acceleration);
    }
}

/// Time as the first argument of a call, where functions take it.
fn time(s: &Signature<'_>) -> &'static str {
    if s.time { "t, " } else { "" }
}

/// The links from the ground to a link.
fn path(links: &[LinkSteps], mut link: Option<usize>) -> Vec<usize> {
    let mut path = Vec::new();
    while let Some(k) = link {
        path.push(k);
        link = links[k].parent;
    }
    path.reverse();
    path
}

fn write_link_placement(out: &mut String, k: usize, link: &LinkSteps, s: &Signature<'_>) {
    let t = time(s);
    let parent = link.parent.map_or(String::new(), |p| format!(", &x{p}"));
    let _ = writeln!(out, "let x{k} = self.__link{k}_placement({t}q{parent});");
}

fn frame_placement(k: usize, frame: &FrameSteps) -> String {
    match frame.link {
        Some(link) if frame.is_link => format!("x{link}"),
        Some(link) => format!("self.__frame{k}_placement(&x{link})"),
        None if frame.is_link => "::linkwork::__private::identity_placement()".to_string(),
        None => format!("self.__frame{k}_placement()"),
    }
}

/// Body of `frame_placements`: all frames at once, each link once.
pub fn write_all_placements(out: &mut String, links: &[LinkSteps], frames: &[FrameSteps], s: &Signature<'_>) {
    for (k, link) in links.iter().enumerate() {
        write_link_placement(out, k, link, s);
    }
    let list: Vec<String> = frames
        .iter()
        .enumerate()
        .map(|(k, frame)| format!("::linkwork::__private::placement(&{})", frame_placement(k, frame)))
        .collect();
    let _ = writeln!(out, "[{}]", list.join(",\n"));
}

/// The methods of `NamedFrame` for one frame.
pub fn write_frame_impl(
    out: &mut String,
    k: usize,
    frame: &FrameSteps,
    links: &[LinkSteps],
    s: &Signature<'_>,
) {
    let scalar = s.scalar.name();
    let path = path(links, frame.link);
    let method = |out: &mut String, name: &str, arguments: &[Argument], result: &str| {
        let all: Vec<Argument> = std::iter::once(Argument::T).chain(arguments.iter().copied()).collect();
        let _ = writeln!(out, "#[inline]\nfn {name}({}) -> {result} {{", s.parameters(&all));
    };
    method(out, "placement", &[Argument::Q], &format!("[{scalar}; 12]"));
    for link in &path {
        write_link_placement(out, *link, &links[*link], s);
    }
    let _ = writeln!(out, "{}\n}}", frame_placement(k, frame));

    method(out, "twist", &[Argument::Q, Argument::V], &format!("[{scalar}; 6]"));
    write_motion(out, &path, links, false, s);
    let last = path.last().map_or(String::new(), |l| format!("&::linkwork::__private::join(&x{l}, &w{l})"));
    let _ = writeln!(out, "self.__frame{k}_twist({last})\n}}");

    method(out, "acceleration", &[Argument::Q, Argument::V, Argument::A], &format!("[{scalar}; 6]"));
    write_motion(out, &path, links, true, s);
    let last = path.last().map_or(String::new(), |l| {
        let join = "::linkwork::__private::join";
        format!("&{join}(&{join}::<_, 12, 6, 18>(&x{l}, &w{l}), &a{l})")
    });
    let _ = writeln!(out, "self.__frame{k}_acceleration({last})\n}}");
    write_jacobian(out, k, frame, links, &path, s);
}

fn write_motion(
    out: &mut String,
    path: &[usize],
    links: &[LinkSteps],
    accelerations: bool,
    s: &Signature<'_>,
) {
    let t = time(s);
    for &k in path {
        write_link_placement(out, k, &links[k], s);
        let parent = links[k].parent.map_or(String::new(), |p| format!(", &w{p}"));
        let _ = writeln!(out, "let w{k} = self.__link{k}_twist({t}q, v{parent});");
        if accelerations {
            let parent = links[k]
                .parent
                .map_or(String::new(), |p| format!(", &::linkwork::__private::join(&w{p}, &a{p})"));
            let _ = writeln!(out, "let a{k} = self.__link{k}_acceleration({t}q, v, a{parent});");
        }
    }
}

fn write_jacobian(
    out: &mut String,
    k: usize,
    frame: &FrameSteps,
    links: &[LinkSteps],
    path: &[usize],
    s: &Signature<'_>,
) {
    let (scalar, nv) = (s.scalar.name(), s.nv);
    let matrix = format!("::linkwork::nalgebra::SMatrix<{scalar}, 6, {nv}>");
    let _ =
        writeln!(out, "#[inline]\nfn jacobian({}) -> {matrix} {{", s.parameters(&[Argument::T, Argument::Q]));
    for &link in path {
        write_link_placement(out, link, &links[link], s);
    }
    if !path.is_empty() {
        let placement = frame_placement(k, frame);
        let _ = writeln!(out, "let o = ::linkwork::__private::origin(&{placement});");
    }
    // Several coordinates that follow one another share a column.
    let mut columns: Vec<Vec<String>> = vec![Vec::new(); nv];
    for &link in path {
        let velocities = &links[link].velocities;
        let names: Vec<String> = (0..velocities.len()).map(|c| format!("j{link}_{c}")).collect();
        let state = if links[link].driven { format!("{}q, ", time(s)) } else { String::new() };
        let entries: Vec<String> =
            names.iter().map(|n| format!("{n}_0, {n}_1, {n}_2, {n}_3, {n}_4, {n}_5")).collect();
        let _ =
            writeln!(out, "let [{}] = self.__link{link}_columns({state}&x{link}, &o);", entries.join(", "));
        for (name, v) in names.iter().zip(velocities) {
            columns[*v].push(name.clone());
        }
    }
    if columns.iter().any(Vec::is_empty) {
        let _ = writeln!(out, "let zero = ::linkwork::__private::constant::<{scalar}>(0.0);");
    }
    let columns: Vec<String> = columns
        .iter()
        .map(|terms| {
            let entry = |row: usize| {
                let sum: Vec<String> = terms.iter().map(|t| format!("{t}_{row}")).collect();
                if sum.is_empty() { "zero".to_string() } else { sum.join(" + ") }
            };
            let entries: Vec<String> = (0..6).map(entry).collect();
            format!("[{}]", entries.join(", "))
        })
        .collect();
    let _ = writeln!(
        out,
        "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage([{}]))\n}}",
        columns.join(",\n")
    );
}

/// The trait of frames by number: each is found among its implementations of `NamedFrame`.
pub fn write_trait(out: &mut String, frames: usize, s: &Signature<'_>) {
    use Argument::{A, Q, T, V};
    let (scalar, nq, nv) = (s.scalar.name(), s.nq, s.nv);
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
        let names: Vec<&str> = arguments.iter().map(|a| a.name()).collect();
        let parameters = s.parameters(&arguments).replacen("&self, ", "&self, frame: usize, ", 1);
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({parameters}) -> ::core::option::Option<{result}> {{\n::core::option::Option::Some(match frame {{"
        );
        for k in 0..frames {
            let call =
                format!("::linkwork::NamedFrame::<{k}, {nq}, {nv}>::{function}(self, {})", names.join(", "));
            let _ = writeln!(out, "{k} => {make}{call}),");
        }
        out.push_str("_ => return ::core::option::Option::None,\n})\n}\n");
    }
}
