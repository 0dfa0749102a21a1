//! By what a tool is led beside its way where no table of the shop states it: a comment has its
//! radius, or says that the way is that of its centre already and its offset holds wear alone; or
//! the built-in tool table has a tool of this number.
use crate::{modes::compensation::Compensation, words::Words};
use diag::Diagnostic;

/// A comment says that the offset holds wear alone.
pub(super) fn on_the_way(words: &Words, number: u32, code: u16, comment: &str) -> Diagnostic {
    let g = crate::codes::spelling::written(code);
    let text = format!(
        "G{g} D{number} leads the tool on the programmed way: it is that of the tool's centre, as the comment \"{comment}\" says"
    );
    Diagnostic::note("I0575", words.place.span, text)
}

/// A comment states the radius.
pub(super) fn by_comment(
    words: &Words,
    (number, code): (u32, u16),
    radius: f64,
    comment: &str,
    is_turned: bool,
) -> Diagnostic {
    let g = crate::codes::spelling::written(code);
    let text = format!(
        "G{g} leads T{number} {radius:.4} beside the way, the radius by its comment \"{comment}\""
    );
    let note = Diagnostic::note("I0575", words.place.span, text);
    if is_turned { note } else { note.with_help(is_centre(number)) }
}

/// The built-in tool table has the radius, which nothing of the shop states.
pub(super) fn by_example(
    words: &Words,
    (number, code): (u32, u16),
    radius: f64,
    tool: &str,
) -> Diagnostic {
    let g = crate::codes::spelling::written(code);
    let text = format!(
        "G{g} leads T{number} {radius:.4} beside the way, the radius of \"{tool}\" of the built-in tool table"
    );
    Diagnostic::note("I0575", words.place.span, text).with_help(format!(
        "a comment states another one, as in (T{number} D=12. FLAT END MILL), or the shop's own tool table"
    ))
}

/// What a program says whose way is that of the tool's centre.
fn is_centre(number: u32) -> String {
    format!(
        "where the way is already that of the tool's centre, D{number} holds wear alone: a comment (D{number} WEAR) says so"
    )
}

/// What is wrong beside the way, with what to look at where a comment states the radius.
pub(super) fn as_beside(compensation: Option<&Compensation>, fault: Diagnostic) -> Diagnostic {
    let Some(number) = compensation.and_then(|compensation| compensation.by_comment) else {
        return fault;
    };
    let help = match &fault.help {
        Some(help) => format!("{help}; {}", is_centre(number)),
        None => format!("the radius is that of T{number}'s comment; {}", is_centre(number)),
    };
    fault.with_help(help)
}
