//! HTML pages: the data of motions, and the code that shows them.

use crate::{Error, Motion, text};
use std::path::Path;

/// HTML page that shows motions, without further files and without a network.
///
/// Motions are shown next to each other, with a common time. Drag to rotate the view, drag with two fingers
/// or the right button to move it, pinch or use the wheel to zoom. The space bar starts and stops, arrow keys
/// step, `+` and `−` zoom, `f` shows frames, `c` follows the motion,
/// `1`, `2` and `3` select the view from the front, the side and the top, `0` fits the initial view.
#[derive(Clone, Debug, Default)]
pub struct Page {
    title: String,
    text: String,
    equations: String,
    motions: Vec<Motion>,
}

impl Page {
    /// Creates a page with this title that contains no motions yet.
    pub fn new(title: &str) -> Page {
        Page { title: title.to_string(), ..Page::default() }
    }

    /// Sets the text below the title of the page, with paragraphs separated by blank lines. The first
    /// paragraph is always visible, the others can be unfolded. Lines that begin with `- ` are a list, words
    /// in backticks are code, and words between asterisks are emphasised.
    pub fn text(mut self, text: &str) -> Page {
        self.text = text.to_string();
        self
    }

    /// Sets the equations that the page shows below the plots: HTML with MathML, as the documentation of a
    /// mechanism contains them.
    #[doc(hidden)]
    pub fn equations(mut self, html: &str) -> Page {
        self.equations = html.to_string();
        self
    }

    /// Adds a motion to the page, to the right of the previous motions.
    pub fn motion(mut self, motion: Motion) -> Page {
        self.motions.push(motion);
        self
    }

    /// Returns the complete page as HTML.
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
        let equations = match self.equations.is_empty() {
            true => String::new(),
            false => format!(
                "<section class=\"equations\"><h2>Equations of motion</h2>{}</section>\n",
                self.equations
            ),
        };
        let about: String = about.iter().map(|block| format!("{block}\n")).collect();
        format!(
            "{}<body class=\"linkwork-page\">\n<header><h1>{title}</h1>\n{about}</header>\n{}\n\
             {equations}<script>\n{simulation}{}</script>\n</body>\n</html>\n",
            page_head(&title),
            self.fragment(),
            Page::script(),
            simulation = if self.has_simulation() { Page::simulation() } else { "" },
        )
    }

    /// Returns a link to the page with its title, the first paragraph of its text, and still pictures.
    pub(crate) fn html_link_to_page(&self, address: &str) -> String {
        let pictures: String = self.motions.iter().map(Motion::still_picture).collect();
        let about = text::blocks(&self.text).into_iter().next().unwrap_or_default();
        let (address, title) = (text::html(address), text::html(&self.title));
        format!("<article>{pictures}<h2><a href=\"{address}\">{title}</a></h2>{about}</article>\n")
    }

    /// Returns the motions of the page as an HTML element for another page. That page needs
    /// [`style`](Self::style) in its head, and [`script`](Self::script) once after all fragments.
    pub fn fragment(&self) -> String {
        let motions = text::list(self.motions.iter().map(Motion::motion_json));
        let pictures: String = self.motions.iter().map(Motion::still_picture).collect();
        format!(
            "<div class=\"linkwork-view\" role=\"group\" aria-label=\"{}\">\
             <script type=\"application/json\">{motions}</script>\
             <noscript><p>This page needs scripts to move; they are disabled in this browser. The drawing \
             shows the beginning.</p>{pictures}</noscript></div>",
            text::html(&self.title)
        )
    }

    /// Returns the style sheet for [fragments](Self::fragment) of pages: the content of a `style` element.
    pub fn style() -> &'static str {
        include_str!("view.css")
    }

    /// Returns the program that plays [fragments](Self::fragment) of pages: the content of a `script`
    /// element.
    pub fn script() -> &'static str {
        include_str!("view.js")
    }

    /// Returns the program that simulates mechanisms in [fragments](Self::fragment) of pages that `linkwork
    /// view --live` writes. It precedes [`script`](Self::script).
    pub fn simulation() -> &'static str {
        concat!(include_str!("simulate.js"), include_str!("controls.js"))
    }

    /// Returns the motions of the page as HTML to embed in another document, such as the documentation of a
    /// crate (`#![doc = include_str!("pendulum.html")]`): a style sheet, an element, and a script. A document
    /// may embed several such pages.
    pub fn embedded(&self) -> String {
        let simulation = if self.has_simulation() { Page::simulation() } else { "" };
        format!(
            "<style>\n{}</style>\n{}\n<script>\n{{\n{simulation}{}}}\n</script>\n",
            Page::style(),
            self.fragment(),
            Page::script()
        )
    }

    fn has_simulation(&self) -> bool {
        self.motions.iter().any(Motion::is_simulated_in_browser)
    }

    /// Writes the page to a file, and creates its folder if necessary.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the folder or file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let made = folder.map_or(Ok(()), std::fs::create_dir_all);
        let file_error = |cause| Error::File { path: path.to_path_buf(), cause };
        made.and_then(|()| std::fs::write(path, self.html())).map_err(file_error)
    }
}

/// Returns the beginning of an HTML page, up to its body. The title is escaped.
pub(crate) fn page_head(title: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <link rel=\"icon\" href=\"data:,\">\n\
         <title>{title}</title>\n<style>\n{}</style>\n</head>\n",
        Page::style()
    )
}
