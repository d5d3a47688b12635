//! `linkwork gallery`: pages that simulate several mechanisms, and an index of them.

use crate::{Stop, commands, view};
use clap::ArgMatches;
use linkwork_view::Page;
use std::path::{Path, PathBuf};

/// Writes a page for each line of the list, and the index.
pub fn write_gallery(matches: &ArgMatches) -> Result<(), Stop> {
    let list: &PathBuf =
        matches.get_one("list").ok_or_else(|| Stop::Failure("expected a list".to_string()))?;
    let out = matches.get_one("out").cloned().unwrap_or_else(|| PathBuf::from("gallery"));
    let text = std::fs::read_to_string(list)
        .map_err(|error| Stop::Failure(format!("{}: {error}", list.display())))?;
    let mut pages: Vec<(String, Page)> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let here = format!("{}:{}", list.display(), number + 1);
        let (name, page) = page_of_line(list, line).map_err(|stop| match stop {
            Stop::Failure(why) => Stop::Failure(format!("{here}: {why}")),
            other => {
                crate::note!("linkwork: {here}: the mechanism has errors");
                other
            }
        })?;
        let mut address = format!("{name}.html");
        if pages.iter().any(|(known, _)| *known == address) {
            address = format!("{name}-{}.html", number + 1);
        }
        page.write(out.join(&address))?;
        pages.push((address, page));
    }
    if pages.is_empty() {
        return Err(Stop::Failure(format!("{}: there is no mechanism", list.display())));
    }
    let index = out.join("index.html");
    std::fs::write(&index, linkwork_view::gallery("Mechanisms", &pages))?;
    crate::say!("{}", index.display());
    Ok(())
}

/// Returns the name and the page of the mechanism of a line.
fn page_of_line(list: &Path, line: &str) -> Result<(String, Page), Stop> {
    let mut words = split_quoted_words(line)?;
    if let Some(folder) = list.parent() {
        resolve_paths(&mut words, folder);
    }
    let all = ["view".to_string(), "--live".to_string()].into_iter().chain(words);
    let matches = commands::view_command()
        .try_get_matches_from(all)
        .map_err(|error| Stop::Failure(error.to_string().trim_end().to_string()))?;
    view::mechanism_name_and_page(&matches)
}

/// Makes the paths of a line relative to the folder of the list: the file, and the values of `--table` and
/// `--meshes`.
fn resolve_paths(words: &mut [String], folder: &Path) {
    let resolve_path_in_folder = |path: &str| folder.join(path).display().to_string();
    for k in 0..words.len() {
        let option = if k == 0 { "" } else { words[k - 1].as_str() };
        words[k] = match (option, words[k].split_once('=')) {
            ("", _) | ("--meshes", _) => resolve_path_in_folder(&words[k]),
            ("--table", Some((name, file))) => format!("{name}={}", resolve_path_in_folder(file)),
            (_, Some(("--meshes", folder))) => format!("--meshes={}", resolve_path_in_folder(folder)),
            (_, Some(("--table", table))) => match table.split_once('=') {
                Some((name, file)) => format!("--table={name}={}", resolve_path_in_folder(file)),
                None => continue,
            },
            _ => continue,
        };
    }
}

/// Splits a line at spaces outside of double quotes.
fn split_quoted_words(line: &str) -> Result<Vec<String>, Stop> {
    let mut out: Vec<String> = Vec::new();
    for (k, part) in line.split('"').enumerate() {
        match k % 2 {
            0 => out.extend(part.split_whitespace().map(ToString::to_string)),
            _ => out.push(part.to_string()),
        }
    }
    match line.matches('"').count() % 2 {
        0 => Ok(out),
        _ => Err(Stop::Failure("a quote is not closed".to_string())),
    }
}
