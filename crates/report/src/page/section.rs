//! What every page has: its style, and sections with headings.
use crate::svg::Tag;

pub(super) const STYLE: &str = include_str!("style.css");

/// A section with its heading; nothing if it has nothing in it.
pub(super) fn section(heading: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    Tag::new("section").around(&(Tag::new("h2").text(heading) + content))
}

/// Figures side by side; nothing if there are none.
pub(super) fn grid(figures: &str) -> String {
    if figures.is_empty() { String::new() } else { Tag::new("div").class("grid").around(figures) }
}

/// A whole page, in one file without outside resources. `main` is markup, `title` is text.
pub(super) fn document(title: &str, main: &str) -> String {
    let title = Tag::new("title").text(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>{title}<style>{STYLE}</style></head>\n\
         <body>{}</body></html>\n",
        Tag::new("main").around(main)
    )
}
