//! How a refusal is said: to people on standard error, to programs in JSON.
use crate::render::{self, Source};
use crate::say;
use control::Refused;

/// As `check --format json` prints findings: an array of objects.
pub(crate) fn json(refused: &Refused) -> String {
    format!("{:#}\n", serde_json::Value::Array(findings_as_json(refused)))
}

/// Each finding as an object; one sentence is a finding without a place.
pub(crate) fn findings_as_json(refused: &Refused) -> Vec<serde_json::Value> {
    match refused {
        Refused::Sentence(sentence) => vec![render::sentence_json(sentence)],
        Refused::Findings { name, text, drawn, findings } => {
            let source = Source { name, text, drawn };
            findings.iter().map(|finding| render::json(finding, &source)).collect()
        }
    }
}

/// For people, without colours: a sentence, or findings with carets.
pub(crate) fn plain(refused: &Refused) -> String {
    match refused {
        Refused::Sentence(sentence) => format!("refused: {sentence}"),
        Refused::Findings { name, text, drawn, findings } => {
            let errors: Vec<_> = findings.iter().filter(|f| f.is_error()).cloned().collect();
            let shown = render::text(&errors, &Source { name, text, drawn });
            format!("refused: {}\n{shown}", refused.sentence())
        }
    }
}

/// Tell the user.
pub(crate) fn say(refused: &Refused) {
    match refused {
        Refused::Sentence(sentence) => say::err(&format!("error: {sentence}\n")),
        Refused::Findings { name, text, drawn, findings } => {
            say::coloured_err(&render::text(findings, &Source { name, text, drawn }));
            let errors = findings.iter().filter(|f| f.is_error()).count();
            let plural = if errors == 1 { "error" } else { "errors" };
            say::err(&format!("{name}: refused, {errors} {plural}\n"));
        }
    }
}
