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
