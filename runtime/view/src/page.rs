//! Pages: the motions as data, and what shows them.

use crate::{Error, Motion, text};
use std::path::Path;

/// A page of HTML that shows motions, and needs nothing else: neither files nor a network.
///
/// Motions stand side by side, under one time. Drag to turn, with two fingers or the right button to move,
/// pinch or turn the wheel to zoom; the space bar plays and stops, arrows step, `+` and `−` zoom, `f` shows
/// frames, `c` follows the motion, `0` looks as at the beginning.
#[derive(Clone, Debug, Default)]
pub struct Page {
    title: String,
    text: String,
    motions: Vec<Motion>,
}

impl Page {
    /// A page without motions.
    pub fn new(title: &str) -> Page {
        Page { title: title.to_string(), ..Page::default() }
    }

    /// What stands below the title, in paragraphs with blank lines between them: the first one, and the
    /// others when they are asked for. Lines that begin with `- ` are a list, words in backticks code, and
    /// those between asterisks are emphasised.
    pub fn text(mut self, text: &str) -> Page {
        self.text = text.to_string();
        self
    }

    /// Adds a motion, to the right of those before it.
    pub fn motion(mut self, motion: Motion) -> Page {
        self.motions.push(motion);
        self
    }

    /// The whole page.
    pub fn html(&self) -> String {
        let (title, mut about) = (text::html(&self.title), text::blocks(&self.text));
        if about.len() > 1 {
            let more = about.split_off(1).concat();
            about.push(format!("<details><summary>More</summary>{more}</details>"));
        }
        let mut missing: Vec<&str> = self.motions.iter().flat_map(Motion::missing_meshes).collect();
        missing.sort_unstable();
        missing.dedup();
        if !missing.is_empty() {
            let paths: Vec<String> =
                missing.iter().map(|path| format!("<code>{}</code>", text::html(path))).collect();
            about.push(format!(
                "<p>Drawn by mass properties, since these meshes were not read: {}.</p>",
                paths.join(", ")
            ));
        }
        let about: String = about.iter().map(|block| format!("{block}\n")).collect();
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <link rel=\"icon\" href=\"data:,\">\n\
             <title>{title}</title>\n<style>\n{}</style>\n</head>\n<body class=\"linkwork-page\">\n\
             <header><h1>{title}</h1>\n{about}</header>\n{}\n<script>\n{}</script>\n</body>\n</html>\n",
            Page::style(),
            self.fragment(),
            Page::script(),
        )
    }

    /// The motions as an element of another page, which has [`style`](Self::style) in its head, and
    /// [`script`](Self::script) once behind all of them.
    pub fn fragment(&self) -> String {
        let motions = text::list(self.motions.iter().map(Motion::json));
        format!(
            "<div class=\"linkwork-view\" role=\"group\" aria-label=\"{}\"><script type=\"application/json\">{motions}</script></div>",
            text::html(&self.title)
        )
    }

    /// What [fragments](Self::fragment) look like: the content of a `style` element.
    pub fn style() -> &'static str {
        include_str!("view.css")
    }

    /// What plays [fragments](Self::fragment): the content of a `script` element.
    pub fn script() -> &'static str {
        include_str!("view.js")
    }

    /// Writes the page into a file; its folder is made if there is none.
    ///
    /// # Errors
    ///
    /// If the system does not let it.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let made = folder.map_or(Ok(()), std::fs::create_dir_all);
        let failed = |cause| Error::File { path: path.to_path_buf(), cause };
        made.and_then(|()| std::fs::write(path, self.html())).map_err(failed)
    }
}
