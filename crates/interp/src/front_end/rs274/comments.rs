//! Comments that ask for something: MSG, DEBUG, PRINT, LOG.
//!
//! In DEBUG, PRINT and LOG, `#5` and `#<name>` stand for their values, with six decimals; `%d`
//! switches to whole numbers from there on, `%.2f` to two decimals, `%f` back.
use crate::{
    call::{Call, Sink, out::Out},
    fault::Outcome,
    modes::Modes,
    words::{
        eval::Values,
        names::{self, Store},
    },
};
use diag::Diagnostic;
use gcode::{Block, CommentKind};
use std::fmt::Write;

/// Say what the comments of a block ask for. ABORT comes back as a fault. Of comments that are only
/// for people the last one in brackets is said, as LinuxCNC does.
pub(crate) fn comments<S: Sink>(
    modes: &Modes,
    store: &Store,
    block: &Block,
    source: &[u8],
    out: &mut Out<'_, S>,
) -> Outcome {
    for (i, comment) in block.comments.iter().enumerate() {
        let text = block.text(comment.text);
        match comment.kind {
            CommentKind::Plain => {
                let bracketed = source.get(comment.span.start as usize) == Some(&b'(');
                if bracketed && i + 1 == block.comments.len() && !text.is_empty() {
                    out.say(&Call::Comment(text.trim_start()));
                }
            }
            CommentKind::Message => out.say(&Call::Message(text)),
            CommentKind::Debug if store.numbered.at(5599) == 0.0 => {}
            CommentKind::Debug => {
                let text = expand(text, &Values { store, modes });
                out.say(&Call::Message(&text));
            }
            CommentKind::Print => {
                let text = expand(text, &Values { store, modes });
                out.say(&Call::Print(&text));
            }
            CommentKind::Log => {
                let text = expand(text, &Values { store, modes });
                out.say(&Call::Log(&text));
            }
            CommentKind::LogOpen | CommentKind::LogAppend => {
                out.say(&Call::LogOpen(text));
            }
            CommentKind::LogClose => out.say(&Call::LogClose),
            CommentKind::Abort => {
                let text = expand(text, &Values { store, modes });
                return crate::fault::refuse(
                    "I0316",
                    comment.span,
                    format!("the program ends itself: {text}"),
                );
            }
            CommentKind::ProbeOpen | CommentKind::ProbeClose | CommentKind::Python => {
                if comment.kind != CommentKind::Python {
                    let text = format!("{}{text}", comment.kind.keyword());
                    out.say(&Call::Comment(&text));
                }
                let text =
                    "this comment asks for something that Leadscrew does not do: it is passed over";
                out.remarks.push(Diagnostic::warning("I0317", comment.span, text));
            }
        }
    }
    Ok(())
}

/// The text with values in the place of parameters.
fn expand(text: &str, values: &Values) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    let mut decimals = 6;
    let mut rest = text;
    while let Some(at) = rest.find(['#', '%']) {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        if let Some((used, new)) = directive(rest) {
            decimals = new;
            rest = &rest[used..];
        } else if let Some((used, value)) = parameter(rest, values) {
            match value {
                Some(value) => _ = write!(out, "{value:.decimals$}"), // a String takes everything
                None => out.push_str("######"),
            }
            rest = &rest[used..];
        } else {
            out.push_str(&rest[..1]);
            rest = &rest[1..];
        }
    }
    out.push_str(rest);
    out
}

/// Length of the parameter that the text begins with, and its value if it has one.
fn parameter(text: &str, values: &Values) -> Option<(usize, Option<f64>)> {
    let inner = text.strip_prefix('#')?;
    if let Some(inner) = inner.strip_prefix('<') {
        let end = inner.find('>')?;
        let name: String = inner[..end].chars().filter(|c| !c.is_whitespace()).collect();
        let name = name.to_lowercase();
        let value = values.store.named(&name).or_else(|| names::system(values.modes, &name));
        return Some((end + 3, value));
    }
    let digits = inner.bytes().take_while(u8::is_ascii_digit).count();
    let number = inner[..digits].parse::<usize>().ok()?;
    let there = i64::try_from(number).is_ok_and(names::exists);
    Some((digits + 1, there.then(|| names::numbered(values.modes, values.store, number))))
}

/// Length of the format that the text begins with, and the decimals it asks for.
fn directive(text: &str) -> Option<(usize, usize)> {
    match text.as_bytes() {
        [b'%', b'd', ..] => Some((2, 0)),
        [b'%', b'f', ..] => Some((2, 4)),
        [b'%', b'.', digit @ b'0'..=b'9', b'f', ..] => Some((4, usize::from(digit - b'0'))),
        _ => None,
    }
}
