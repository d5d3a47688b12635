//! HTML index of several pages of motions, with still pictures.

use crate::page::page_head;
use crate::{Page, text};

/// Returns an HTML index of pages with their still pictures. Each entry is the address of a page and the
/// page.
#[doc(hidden)]
pub fn gallery(title: &str, pages: &[(String, Page)]) -> String {
    let title = text::html(title);
    let cards: String = pages.iter().map(|(address, page)| page.html_link_to_page(address)).collect();
    format!(
        "{}<body class=\"linkwork-page\">\n<header><h1>{title}</h1></header>\n\
         <main class=\"linkwork-view cards\">\n{cards}</main>\n</body>\n</html>\n",
        page_head(&title)
    )
}
