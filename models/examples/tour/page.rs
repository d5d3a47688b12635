//! Report of the tour as one self-contained web page: text, tables, SVG plots and animated scenes.

use crate::report::{Section, Table, format_number};
use std::fmt::Write;

/// Returns the complete report as an HTML page.
pub fn page_html(sections: &[Section]) -> String {
    let all_checks = || sections.iter().flat_map(|s| &s.checks);
    let (held, total) = (all_checks().filter(|check| check.is_below_bound()).count(), all_checks().count());
    let mut body = String::new();
    for (k, section) in sections.iter().enumerate() {
        write_section(&mut body, k + 1, section);
    }
    format!(
        "<!doctype html>\n<html lang='en'>\n<meta charset='utf-8'>\n\
         <meta name='viewport' content='width=device-width, initial-scale=1'>\n\
         <title>A tour of Linkwork</title>\n<style>\n{}</style>\n<main>\n\
         <header><h1>A tour of Linkwork</h1>\n\
         <p>Mechanisms declared as annotated Rust structs or URDF files, compiled to equations of motion. \
         Everything here was computed from generated code by \
         <code>cargo run --release --example tour -p linkwork-models</code>: \
         {held} of {total} checks hold.</p></header>\n\
         {body}</main>\n<script>\n{}</script>\n</html>\n",
        include_str!("page.css"),
        include_str!("player.js"),
    )
}

fn write_section(out: &mut String, number: usize, s: &Section) {
    let _ = writeln!(
        out,
        "<section>\n<h2><span>{number}</span>{}</h2>\n<p>{}</p>",
        escape_html(&s.title),
        escape_html(&s.text)
    );
    let blocks = [("declared", s.declaration.as_str()), ("derived", s.equations)];
    out.push_str("<div class='code'>");
    for (title, text) in blocks.iter().filter(|(_, text)| !text.is_empty()) {
        let _ = writeln!(out, "<div><h3>{title}</h3><pre>{}</pre></div>", escape_html(text));
    }
    out.push_str("</div>\n");
    out.push_str("<div class='figures'>\n");
    for scene in &s.scenes {
        let shape = scene.view.size[0] / scene.view.size[1];
        let class = if shape > 1.6 { "broad" } else { "tall" };
        let _ = writeln!(
            out,
            "<figure class='scene {class}'><figcaption>{}</figcaption>\
             <div class='stage' style='aspect-ratio:{shape:.3}'><canvas></canvas></div>\
             <div class='controls'><button>Pause</button>\
             <input type='range' min='0' max='{}' value='0' aria-label='time'><output></output></div>\
             <script type='application/json'>{}</script></figure>",
            escape_html(scene.title),
            scene.frames.len().saturating_sub(1),
            scene.scene_json()
        );
    }
    for picture in &s.pictures {
        let _ = writeln!(
            out,
            "<figure class='plot'><figcaption>{}</figcaption>{}</figure>",
            escape_html(picture.title),
            picture.svg
        );
    }
    out.push_str("</div>\n");
    out.push_str("<div class='tables'>");
    for table in &s.tables {
        write_table(out, table);
    }
    out.push_str("</div>\n");
    out.push_str("<ul class='checks'>");
    for check in &s.checks {
        let (class, mark) = if check.is_below_bound() { ("holds", '✓') } else { ("fails", '✗') };
        let _ = write!(
            out,
            "<li class='{class}'><b>{mark}</b> {} <span>{} &lt; {}</span></li>",
            escape_html(check.what),
            format_number(check.value),
            format_number(check.bound)
        );
    }
    out.push_str("</ul>\n</section>\n");
}

fn write_table(out: &mut String, table: &Table) {
    out.push_str("<div class='wide'><table>");
    if !table.head.is_empty() {
        let heads: String = table.head.iter().map(|h| format!("<th>{}</th>", escape_html(h))).collect();
        let _ = write!(out, "<thead><tr>{heads}</tr></thead>");
    }
    for row in &table.rows {
        let cells: String = row.iter().map(|c| format!("<td>{}</td>", escape_html(c))).collect();
        let _ = write!(out, "<tr>{cells}</tr>");
    }
    out.push_str("</table></div>\n");
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
