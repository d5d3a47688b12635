//! Frames: placements, velocities, accelerations and Jacobians of all frames by index. Links are traversed
//! from the ground outwards, with one step per link.

use super::batch::Batch;
use super::body::{Scope, write_program};
use super::docs;
use super::function::Outline;
use super::support::Support;
use crate::catalogue::Argument;
use crate::derive::{FrameSteps, LinkSteps, Output};
use crate::lower::Program;
use crate::mechanism::Supplied;
use std::fmt::Write;

const PLACED: Argument = Argument::Given("p", Supplied::Parent, 12);

/// C function of frames: its name, arguments, result and documentation.
struct Access {
    name: &'static str,
    arguments: &'static [Argument],
    result: &'static str,
    docs: &'static str,
}

const ACCESSES: [Access; 4] = [
    Access {
        name: "frame_placement",
        arguments: &[Argument::Q],
        result: "out: 12 numbers, the rotation matrix column by column (the frame's axes in ground axes), \
                 then the position of its origin, m",
        docs: "Placement of a frame in the ground.",
    },
    Access {
        name: "frame_velocity",
        arguments: &[Argument::Q, Argument::V],
        result: "out: 6 numbers, m/s, then rad/s",
        docs: "Velocity of a frame relative to the ground, in ground axes: velocity of its origin, then \
               angular velocity.",
    },
    Access {
        name: "frame_acceleration",
        arguments: &[Argument::Q, Argument::V, Argument::A],
        result: "out: 6 numbers, m/s^2, then rad/s^2",
        docs: "Acceleration of a frame relative to the ground, in ground axes, without gravity: acceleration \
               of its origin, then angular acceleration.",
    },
    Access {
        name: "frame_jacobian",
        arguments: &[Argument::Q],
        result: "out: 6 by NV, column by column",
        docs: "Jacobian of a frame: the velocity of the frame is this matrix times `v`.",
    },
];

fn access_signature(o: &Outline<'_>, access: &Access) -> String {
    let spelled =
        o.signature_with_results("int", access.name, &o.with_time_argument(access.arguments), &["result"]);
    // The index of the frame is the first argument after the parameters.
    let open = spelled.find('(').map_or(0, |at| at + 1);
    let at = if !o.has_own() { open } else { spelled.find(", ").map_or(open, |at| at + 2) };
    format!("{}int frame, {}", &spelled[..at], &spelled[at..])
}

/// Returns the C macros for the indices of the frames.
pub fn frame_index_constants(o: &Outline<'_>, frames: &[(String, String)]) -> String {
    let mut text = String::new();
    if frames.is_empty() {
        return text;
    }
    let upper = o.prefix.to_ascii_uppercase();
    text.push_str("/* Frames by number. */\nenum {\n");
    for (k, (name, says)) in frames.iter().enumerate() {
        let comma = if k + 1 < frames.len() { "," } else { "" };
        let _ =
            writeln!(text, "    {upper}_FRAME_{name} = {k}{comma} /* {} */", docs::comment_safe_text(says));
    }
    text.push_str("};\n\n");
    text
}

/// Returns the C declarations of the frame functions and the indices of the frames.
pub fn frame_declarations(o: &Outline<'_>, frames: &[(String, String)]) -> String {
    let mut text = frame_index_constants(o, frames);
    for access in ACCESSES.iter().filter(|_| !frames.is_empty()) {
        text.push_str(&docs::wrap_paragraph(access.docs, "/* ", " * "));
        text.push_str(" * Returns 0; 1 where there is no such frame.\n *\n");
        text.push_str(&docs::wrap_paragraph(access.result, " * result    ", " *           "));
        let _ = writeln!(text, " */\n{};\n", access_signature(o, access));
    }
    text
}

/// Returns the signatures of the C functions of frames.
pub fn frame_batches(output: &Output, o: &Outline<'_>) -> Vec<Batch> {
    let accesses = ACCESSES.iter().filter(|_| !output.frames.is_empty());
    let batch_of_access = |access: &Access| {
        let size = match access.name {
            "frame_placement" => 12,
            "frame_jacobian" => 6 * o.nv,
            _ => 6,
        };
        let arguments = o.with_time_argument(access.arguments);
        Batch {
            of_frame: true,
            ..Batch::handwritten_signature(access.name, &arguments, &[("result", size)], access.docs, o)
        }
    };
    accesses.map(batch_of_access).collect()
}

/// Returns the definitions of the C functions of frames.
pub fn frame_definitions(output: &Output, o: &Outline<'_>, support: &mut Support) -> String {
    let (links, frames) = (&output.links, &output.frames);
    if frames.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    let most = links.iter().map(|link| link.velocities.len()).max();
    if most.is_some() {
        write_tables(&mut text, links, frames);
        write_steps(&mut text, links, o, support);
    }
    write_frame_steps(&mut text, frames, o, support);
    for access in &ACCESSES {
        let body = access_body(access, o, most);
        let unused = o.silence_unused_arguments(&body, &o.with_time_argument(access.arguments), &["result"]);
        let _ = writeln!(text, "{} {{\n{unused}{body}}}\n", access_signature(o, access));
    }
    text
}

/// Writes the tables of parent links, and the function for the path from the ground to a frame.
fn write_tables(text: &mut String, links: &[LinkSteps], frames: &[FrameSteps]) {
    let optional_link_number = |link: Option<usize>| link.map_or("-1".to_string(), |k| k.to_string());
    let parents: Vec<String> = links.iter().map(|link| optional_link_number(link.parent)).collect();
    let carriers: Vec<String> = frames.iter().map(|frame| optional_link_number(frame.link)).collect();
    let _ = writeln!(text, "static const int lw_parent_of[{}] = {{{}}};", parents.len(), parents.join(", "));
    let _ =
        writeln!(text, "static const int lw_link_of[{}] = {{{}}};\n", carriers.len(), carriers.join(", "));
    let _ = writeln!(
        text,
        "/* The links from the ground to a frame, the last one first. */
static int lw_path_to(int frame, int *path) {{
    int count = 0;
    for (int link = lw_link_of[frame]; link >= 0; link = lw_parent_of[link]) {{
        path[count++] = link;
    }}
    return count;
}}
"
    );
}

/// Step of the recursion: a switch over links or frames.
struct Step<'a> {
    name: &'static str,
    arguments: Vec<Argument>,
    programs: Vec<(&'a Program, bool)>,
}

fn write_step(text: &mut String, step: &Step<'_>, o: &Outline<'_>, support: &mut Support) {
    let mut body = String::new();
    let scope = Scope { arguments: &step.arguments, parameters: o.parameters, tables: o.tables };
    for (k, (program, is_copy)) in step.programs.iter().enumerate() {
        let _ = writeln!(body, "    case {k}: {{");
        if *is_copy {
            body.push_str("    for (int k = 0; k < 12; ++k) {\n        result[k] = p[k];\n    }\n");
        } else {
            write_program(&mut body, program, &scope, &|k| Some(format!("result[{k}]")), support);
        }
        body.push_str("    break;\n    }\n");
    }
    let unused = o.silence_unused_arguments(&body, &step.arguments, &["result"]);
    let spelled = o.signature_with_results("static void", step.name, &step.arguments, &["result"]);
    // An argument may have the same name as the type.
    let spelled = spelled.replacen(
        &format!("(const {} *self", o.prefix),
        &format!("(const struct {} *self", o.prefix),
        1,
    );
    let spelled = spelled.replacen(
        &format!("{}_{}(", o.prefix, step.name),
        &format!("lw_{}(int which, ", step.name),
        1,
    );
    let _ = writeln!(
        text,
        "{spelled} {{\n{unused}    switch (which) {{\n{body}    default:\n        break;\n    }}\n}}\n"
    );
}

fn write_steps(text: &mut String, links: &[LinkSteps], o: &Outline<'_>, support: &mut Support) {
    use Argument::{A, Q, V};
    let parent_argument = |n| Argument::Given("p", Supplied::Parent, n);
    let programs =
        |program: fn(&LinkSteps) -> &Program| links.iter().map(|link| (program(link), false)).collect();
    let steps = [
        Step {
            name: "link_placement",
            arguments: [o.with_time_argument(&[Q]), vec![PLACED]].concat(),
            programs: programs(|l| &l.placement),
        },
        Step {
            name: "link_twist",
            arguments: [o.with_time_argument(&[Q, V]), vec![parent_argument(6)]].concat(),
            programs: programs(|l| &l.twist),
        },
        Step {
            name: "link_acceleration",
            arguments: [o.with_time_argument(&[Q, V, A]), vec![parent_argument(12)]].concat(),
            programs: programs(|l| &l.acceleration),
        },
        Step {
            name: "link_columns",
            arguments: [o.with_time_argument(&[Q]), vec![PLACED, Argument::Given("o", Supplied::Origin, 3)]]
                .concat(),
            programs: programs(|l| &l.columns),
        },
    ];
    steps.iter().for_each(|step| write_step(text, step, o, support));
    // Coordinates of joints that follow one another share a column.
    let columns: Vec<&usize> = links.iter().flat_map(|link| &link.velocities).collect();
    let mut firsts = Vec::new();
    let mut next = 0;
    for link in links {
        firsts.push(next.to_string());
        next += link.velocities.len();
    }
    firsts.push(next.to_string());
    let columns: Vec<String> = match columns.is_empty() {
        true => vec!["0".to_string()],
        false => columns.iter().map(ToString::to_string).collect(),
    };
    let _ = writeln!(text, "static const int lw_first_column[{}] = {{{}}};", firsts.len(), firsts.join(", "));
    let _ =
        writeln!(text, "static const int lw_column_of[{}] = {{{}}};\n", columns.len(), columns.join(", "));
}

fn write_frame_steps(text: &mut String, frames: &[FrameSteps], o: &Outline<'_>, support: &mut Support) {
    let parent_argument = |n| vec![Argument::Given("p", Supplied::Parent, n)];
    let programs =
        |program: fn(&FrameSteps) -> &Program| frames.iter().map(|frame| (program(frame), false)).collect();
    let placements =
        frames.iter().map(|frame| (&frame.placement, frame.is_link && frame.link.is_some())).collect();
    let steps = [
        Step { name: "placement_on_link", arguments: parent_argument(12), programs: placements },
        Step { name: "twist_on_link", arguments: parent_argument(18), programs: programs(|f| &f.twist) },
        Step {
            name: "acceleration_on_link",
            arguments: parent_argument(24),
            programs: programs(|f| &f.acceleration),
        },
    ];
    steps.iter().for_each(|step| write_step(text, step, o, support));
}

/// Returns the body of a frame function. `most` is the maximum number of columns of a link, if there are
/// links.
fn access_body(access: &Access, o: &Outline<'_>, most: Option<usize>) -> String {
    let has_links = most.is_some();
    let frames = format!("{}_FRAMES", o.prefix.to_ascii_uppercase());
    let own = if o.has_own() { "self, " } else { "" };
    let time = if o.time { "t, " } else { "" };
    let mut body = format!("    if (frame < 0 || frame >= {frames}) {{\n        return 1;\n    }}\n");
    // Placement, twist and acceleration, in this order.
    body.push_str("    double p[24] = {0.0};\n    p[0] = p[4] = p[8] = 1.0;\n");
    let is_jacobian = access.name == "frame_jacobian";
    let (twist, acceleration) = (access.name == "frame_velocity", access.name == "frame_acceleration");
    // The steps take joint velocities.
    let (v, a) = if o.speeds { ("rates", "changes") } else { ("v", "a") };
    if o.speeds && (twist || acceleration) {
        let call = o.timeless_call("rates_of_speeds", &["q", "v", "rates"]);
        let _ = writeln!(body, "    double rates[{}];\n    {call};", o.nv.max(1));
    }
    if o.speeds && acceleration {
        let call = o.timeless_call("rate_accelerations", &["q", "v", "a", "changes"]);
        let _ = writeln!(body, "    double changes[{}];\n    {call};", o.nv.max(1));
    }
    if has_links {
        let links = format!("{}_LINKS", o.prefix.to_ascii_uppercase());
        if is_jacobian {
            let _ = writeln!(body, "    double placements[12 * {links}];");
        }
        let _ = write!(
            body,
            "    int path[{links}];
    const int count = lw_path_to(frame, path);
    for (int k = count - 1; k >= 0; --k) {{
        double next[12];
        lw_link_placement(path[k], {own}{time}q, p, next);
        for (int i = 0; i < 12; ++i) {{
            p[i] = next[i];
        }}
"
        );
        if is_jacobian {
            write_copy_loop(&mut body, "        ", "placements[12 * k + i]", "next[i]", 12);
        }
        if acceleration {
            let _ = write!(
                body,
                "        lw_link_acceleration(path[k], {own}{time}q, {v}, {a}, p + 12, next + 6);\n        \
                 lw_link_twist(path[k], {own}{time}q, {v}, p + 12, next);\n"
            );
            write_copy_loop(&mut body, "        ", "p[12 + i]", "next[i]", 12);
        }
        if twist {
            let _ = writeln!(body, "        lw_link_twist(path[k], {own}{time}q, {v}, p + 12, next);");
            write_copy_loop(&mut body, "        ", "p[12 + i]", "next[i]", 6);
        }
        body.push_str("    }\n");
    }
    if is_jacobian {
        write_jacobian(&mut body, o, most);
    } else {
        let _ = match access.name {
            // The steps store rotation matrices by rows.
            "frame_placement" => writeln!(
                body,
                "    double placed[12];
    lw_placement_on_link(frame, {own}p, placed);
    for (int k = 0; k < 9; ++k) {{
        result[k] = placed[3 * (k % 3) + k / 3];
    }}
    for (int k = 9; k < 12; ++k) {{
        result[k] = placed[k];
    }}"
            ),
            "frame_velocity" => writeln!(body, "    lw_twist_on_link(frame, {own}p, result);"),
            _ => writeln!(body, "    lw_acceleration_on_link(frame, {own}p, result);"),
        };
    }
    body.push_str("    return 0;\n");
    body
}

/// Writes a C loop that copies `n` values from one array to another.
fn write_copy_loop(body: &mut String, indent: &str, to: &str, from: &str, n: usize) {
    let _ =
        writeln!(body, "{indent}for (int i = 0; i < {n}; ++i) {{\n{indent}    {to} = {from};\n{indent}}}");
}

/// Writes the sum of the columns of the links on the path to a frame into its Jacobian. With declared
/// generalized speeds, the Jacobian is with respect to them.
fn write_jacobian(body: &mut String, o: &Outline<'_>, most: Option<usize>) {
    let own = if o.has_own() { "self, " } else { "" };
    let time = if o.time { "t, " } else { "" };
    let _ = write!(
        body,
        "    double placement[12];
    lw_placement_on_link(frame, {own}p, placement);
    for (int k = 0; k < 6 * {}; ++k) {{
        result[k] = 0.0;
    }}
",
        o.nv
    );
    if let Some(most) = most {
        let _ = write!(
            body,
            "    for (int k = 0; k < count; ++k) {{
        double columns[{}] = {{0.0}};
        lw_link_columns(path[k], {own}{time}q, placements + 12 * k, placement + 9, columns);
        for (int c = lw_first_column[path[k]]; c < lw_first_column[path[k] + 1]; ++c) {{
            for (int i = 0; i < 6; ++i) {{
                result[6 * lw_column_of[c] + i] += columns[6 * (c - lw_first_column[path[k]]) + i];
            }}
        }}
    }}
",
            6 * most.max(1)
        );
    }
    if o.speeds {
        let call = o.timeless_call("rate_matrix", &["q", "z"]);
        let _ = write!(
            body,
            "    double joints[6 * {0}], z[{0} * {0}];
    {call};
    for (int k = 0; k < 6 * {0}; ++k) {{
        joints[k] = result[k];
    }}
    for (int j = 0; j < {0}; ++j) {{
        for (int i = 0; i < 6; ++i) {{
            double sum = 0.0;
            for (int k = 0; k < {0}; ++k) {{
                sum += joints[6 * k + i] * z[j * {0} + k];
            }}
            result[6 * j + i] = sum;
        }}
    }}
",
            o.nv.max(1)
        );
    }
}
