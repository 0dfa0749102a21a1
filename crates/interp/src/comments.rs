//! Comments that ask for something: MSG, DEBUG, PRINT, LOG.
//!
//! In DEBUG, PRINT and LOG, `#5` and `#<name>` stand for their values, with six decimals; `%d`
//! switches to whole numbers from there on, `%.2f` to two decimals, `%f` back.
use crate::{
    call::{Call, Sink},
    eval::Values,
    execute::Executor,
    fault::Outcome,
    names,
};
use diag::Diagnostic;
use gcode::{Block, CommentKind};

impl Executor {
    /// Say what the comments of a block ask for. ABORT comes back as a fault.
    pub(crate) fn comments<S: Sink>(&mut self, block: &Block, sink: &mut S) -> Outcome {
        for comment in &block.comments {
            let text = block.text(comment.text);
            match comment.kind {
                CommentKind::Plain => self.say(sink, &Call::Comment(text)),
                CommentKind::Message => self.say(sink, &Call::Message(text)),
                CommentKind::Debug => {
                    let text = expand(text, &self.values());
                    self.say(sink, &Call::Message(&text));
                }
                CommentKind::Print => {
                    let text = expand(text, &self.values());
                    self.say(sink, &Call::Print(&text));
                }
                CommentKind::Log => {
                    let text = expand(text, &self.values());
                    self.say(sink, &Call::Log(&text));
                }
                CommentKind::LogOpen | CommentKind::LogAppend => {
                    self.say(sink, &Call::LogOpen(text))
                }
                CommentKind::LogClose => self.say(sink, &Call::LogClose),
                CommentKind::Abort => {
                    let text = expand(text, &self.values());
                    return crate::fault::refuse(
                        "I0316",
                        comment.span,
                        format!("the program ends itself: {text}"),
                    );
                }
                CommentKind::ProbeOpen | CommentKind::ProbeClose | CommentKind::Python => {
                    let text = "this comment asks for something that Leadscrew does not do: it is passed over";
                    self.remarks.push(Diagnostic::warning("I0317", comment.span, text));
                }
            }
        }
        Ok(())
    }
}

/// The text with values in the place of parameters.
fn expand(text: &str, values: &Values) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    let mut decimals = 6;
    let mut rest = text;
    while let Some(at) = rest.find(['#', '%']) {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        let (used, value) = if rest.starts_with('#') {
            parameter(rest, values)
        } else {
            directive(rest, &mut decimals)
        };
        match (used, value) {
            (0, _) => {
                out.push_str(&rest[..1]);
                rest = &rest[1..];
                continue;
            }
            (_, Some(Some(value))) => out.push_str(&format!("{value:.decimals$}")),
            (_, Some(None)) => out.push_str("######"),
            (_, None) => {}
        }
        rest = &rest[used..];
    }
    out.push_str(rest);
    out
}

/// Length of the parameter that the text begins with, and its value if it has one.
fn parameter(text: &str, values: &Values) -> (usize, Option<Option<f64>>) {
    if let Some(inner) = text[1..].strip_prefix('<') {
        let Some(end) = inner.find('>') else { return (0, None) };
        let name: String =
            inner[..end].chars().filter(|c| !c.is_whitespace()).collect::<String>().to_lowercase();
        let value = values.store.named(&name).or_else(|| names::system(values.state, &name));
        return (end + 3, Some(value));
    }
    let digits = text[1..].bytes().take_while(u8::is_ascii_digit).count();
    let Ok(number) = text[1..=digits].parse::<usize>() else { return (0, None) };
    let there = i64::try_from(number).is_ok_and(names::exists);
    (digits + 1, Some(there.then(|| names::numbered(values.state, values.store, number))))
}

/// Length of the format that the text begins with.
fn directive(text: &str, decimals: &mut usize) -> (usize, Option<Option<f64>>) {
    let bytes = text.as_bytes();
    match bytes {
        [b'%', b'd', ..] => *decimals = 0,
        [b'%', b'f', ..] => *decimals = 6,
        [b'%', b'l', b'f', ..] => {
            *decimals = 6;
            return (3, None);
        }
        [b'%', b'.', digit @ b'0'..=b'9', b'f', ..] => {
            *decimals = usize::from(digit - b'0');
            return (4, None);
        }
        _ => return (0, None),
    }
    (2, None)
}
