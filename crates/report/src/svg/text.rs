//! Text and numbers for markup: escaped, rounded, and well formed by construction.
use std::fmt::Write as _;

/// A text in which nothing is markup any more, for element content and quoted attributes alike.
/// Control characters, which neither HTML nor XML may hold, become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// A number with so many decimals; never "-0", and "–" for what is no number.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.into(),
        _ => text,
    }
}

/// A picture coordinate: tenths, without a trailing ".0"; 0 for what is no number.
pub(crate) fn coordinate(out: &mut String, value: f64) {
    let tenths = if value.is_finite() { (value * 10.0).round() as i64 } else { 0 };
    let (sign, magnitude) = (if tenths < 0 { "-" } else { "" }, tenths.unsigned_abs());
    let _ = match magnitude % 10 {
        0 => write!(out, "{sign}{}", magnitude / 10),
        tenth => write!(out, "{sign}{}.{tenth}", magnitude / 10),
    };
}

/// An element being written: attributes first, then content. `Tag::new("g").class("in").text("…")`.
pub(crate) struct Tag {
    name: &'static str,
    head: String,
}

impl Tag {
    /// An element of this name.
    pub(crate) fn new(name: &'static str) -> Self {
        Self { name, head: format!("<{name}") }
    }

    /// With an attribute; its value is escaped.
    pub(crate) fn with(mut self, attribute: &str, value: &str) -> Self {
        let _ = write!(self.head, " {attribute}=\"{}\"", escape(value));
        self
    }

    /// With its class.
    pub(crate) fn class(self, class: &str) -> Self {
        self.with("class", class)
    }

    /// With an attribute that is a picture coordinate.
    pub(crate) fn at(mut self, attribute: &str, value: f64) -> Self {
        let _ = write!(self.head, " {attribute}=\"");
        coordinate(&mut self.head, value);
        self.head.push('"');
        self
    }

    /// Without content.
    pub(crate) fn empty(mut self) -> String {
        self.head.push_str("/>");
        self.head
    }

    /// Around a text, which is escaped.
    pub(crate) fn text(self, text: &str) -> String {
        let inner = escape(text);
        self.around(&inner)
    }

    /// Around markup that is finished already.
    pub(crate) fn around(mut self, markup: &str) -> String {
        let _ = write!(self.head, ">{markup}</{}>", self.name);
        self.head
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_in_a_program_name_becomes_harmless_text() {
        insta::assert_snapshot!(
            escape("<script>alert('a & \"b\"')</script>\u{1b}[31m"),
            @"&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;�[31m"
        );
        insta::assert_snapshot!(Tag::new("a").with("title", "\"><b>").text("<i>"), @r#"<a title="&quot;&gt;&lt;b&gt;">&lt;i&gt;</a>"#);
    }

    #[test]
    fn numbers_are_rounded_without_a_negative_zero_and_without_nan() {
        let numbers = [(-0.04, 1), (-0.05001, 1), (2.0 / 3.0, 3), (f64::NAN, 2), (-1234.5, 0)];
        let texts: Vec<_> = numbers.iter().map(|&(v, d)| fixed(v, d)).collect();
        assert_eq!(texts, ["0.0", "-0.1", "0.667", "–", "-1234"]);
        let mut out = String::new();
        for v in [0.0, -0.04, 12.0, -0.25, 99.96, f64::NAN, -7.5] {
            coordinate(&mut out, v);
            out.push(' ');
        }
        assert_eq!(out, "0 0 12 -0.3 100 0 -7.5 ");
    }
}
