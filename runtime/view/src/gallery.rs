//! Index of several pages.

use crate::{Page, text};

/// Returns an index of pages with their still pictures. Each entry is the address of a page and the page.
#[doc(hidden)]
pub fn gallery(title: &str, pages: &[(String, Page)]) -> String {
    let title = text::html(title);
    let cards: String = pages.iter().map(|(address, page)| page.card(address)).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n\
         <body class=\"linkwork-page\">\n<header><h1>{title}</h1></header>\n\
         <main class=\"linkwork-view cards\">\n{cards}</main>\n</body>\n</html>\n",
        Page::style()
    )
}
