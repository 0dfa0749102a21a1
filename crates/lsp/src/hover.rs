//! What the word under the pointer does here, what is in force, and where the machine stands before
//! and after.
use crate::analysis::{Analysis, Visit};
use crate::document::Document;
use crate::{
    jumps::{self, Target},
    names, roles,
};
use canon::{Axis, Position};
use gcode::{Block, Control, Keyword, Parser, Word};
use interp::{CodeInfo, Dialect, Standing};
use std::fmt::Write;

/// Shown text, in Markdown, and the bytes it is about.
pub(crate) struct Hover {
    pub(crate) markdown: String,
    pub(crate) from: usize,
    pub(crate) to: usize,
}

/// At a byte of a line (from 0).
pub(crate) fn at(
    document: &Document,
    analysis: &mut Analysis,
    line: usize,
    byte: usize,
) -> Option<Hover> {
    let (from, to) = document.line(line);
    let dialect = analysis.setup.dialect;
    let mut parser = Parser::with_grammar(&document.text, 0, dialect.grammar());
    let number = line as u32 + 1;
    parser.seek(from as u32, number);
    let mut block = Block::new();
    // a line of Fanuc's can hold several blocks
    while parser.next(&mut block) && block.span.line == number && (block.span.end as usize) < byte {
    }
    if block.span.line != number || block.is_blank() {
        return None;
    }
    let name =
        names::in_line(document, line, dialect.grammar()).into_iter().find(|n| n.holds(byte));
    let shown = name.as_ref().and_then(names::Name::as_parameter);
    let visit = analysis.visit(document, number, shown.as_deref());
    let word = block.words.iter().find(|w| span_holds(w, byte));
    let mut markdown = String::new();
    let (mut first, mut last) = (from, to);
    if let (Some(shown), Some(name)) = (&shown, &name) {
        let value = visit.as_ref().and_then(|visit| visit.parameter);
        let value =
            value.map_or("has no value yet".to_owned(), |v| format!("= {v} before this block"));
        _ = writeln!(markdown, "`{shown}` {value}\n"); // a String takes everything
        (first, last) = (name.from, name.to);
    } else if let Some(word) = word {
        markdown.push_str(&about(word, &block, visit.as_ref(), dialect));
        (first, last) = (word.span.start as usize, word.span.end as usize);
    } else if let Some(text) = steering(&block) {
        _ = writeln!(markdown, "{text}\n");
        if block.control.is_some() {
            markdown.push_str(&leads_to(document, line, byte));
        }
    }
    match &visit {
        Some(visit) => markdown.push_str(&around(visit)),
        None if analysis.is_done() => markdown.push_str("This block is never executed.\n"),
        None => markdown.push_str("The program has not been executed up to this block yet.\n"),
    }
    Some(Hover { markdown, from: first, to: last })
}

/// Where the jump of this block leads.
fn leads_to(document: &Document, line: usize, byte: usize) -> String {
    match jumps::target(document, line, byte) {
        Some(Target::Block(span)) => {
            let text = &document.text[span.start as usize..span.end as usize];
            let text = String::from_utf8_lossy(text).replace('`', "'");
            format!("It leads to line {}: `{}`\n\n", span.line, text.trim())
        }
        Some(Target::Missing(number)) => {
            format!("There is no block N{number} in this program.\n\n")
        }
        None => String::new(),
    }
}

/// What a block does to the order of execution, or writes.
fn steering(block: &Block) -> Option<&'static str> {
    if block.output.is_some() {
        return Some("writes to the control's external device");
    }
    if let Some(control) = block.control {
        return Some(match control {
            Control::GoTo(_) => "**GOTO** goes on at the block N with this number",
            Control::IfGoTo { .. } => {
                "**IF … GOTO** goes on at the block N with this number if the condition holds"
            }
            Control::IfThen(_) => "**IF … THEN** does the rest of the block if the condition holds",
            Control::While { condition: Some(_), .. } => {
                "**WHILE … DO** repeats what follows up to its END while the condition holds"
            }
            Control::While { condition: None, .. } => "**DO** repeats what follows up to its END",
            Control::End(_) => "**END** goes back to its DO",
        });
    }
    Some(match block.o?.keyword {
        Keyword::Program => "a program begins here",
        Keyword::Sub => "a subprogram begins here",
        Keyword::EndSub => "the subprogram ends here",
        Keyword::Return => "goes back to the caller",
        Keyword::Call => "calls the subprogram; what stands in brackets is its #1, #2, …",
        Keyword::If => "what follows is done if the condition holds",
        Keyword::ElseIf => "what follows is done if no condition before holds, and this one does",
        Keyword::Else => "what follows is done if no condition before holds",
        Keyword::EndIf => "the end of what a condition decides",
        Keyword::While => "repeats while the condition holds",
        Keyword::Do => "what follows is done once, and again while the condition at its end holds",
        Keyword::Repeat => "repeats what follows so many times",
        Keyword::EndWhile | Keyword::EndRepeat => "the end of what is repeated",
        Keyword::Break => "leaves the loop",
        Keyword::Continue => "goes to the loop's next round",
    })
}

fn span_holds(word: &Word, byte: usize) -> bool {
    (word.span.start as usize..word.span.end as usize).contains(&byte)
}

/// What a word does.
fn about(word: &Word, block: &Block, visit: Option<&Visit>, dialect: Dialect) -> String {
    let comma = if word.letter.is_ascii_lowercase() { "," } else { "" };
    let letter = format!("{comma}{}", word.letter.to_ascii_uppercase() as char);
    if let Some(code) = meaning(word, dialect) {
        return describe(&code);
    }
    if matches!(word.letter, b'G' | b'M') {
        return match word.value {
            gcode::Value::Number(value) => format!("**{letter}{value}** is no known code\n\n"),
            gcode::Value::Expression(_) => format!("**{letter}** with a code that is computed\n\n"),
        };
    }
    let own = block.words.iter().filter_map(|word| meaning(word, dialect));
    let motion = visit.and_then(|v| v.before.codes.first().cloned());
    let codes = own.map(|c| c.code).chain(motion);
    let taken =
        codes.filter_map(|code| roles::role(dialect, word.letter, &code).map(|role| (role, code)));
    // A role that only this code has says more than one that all have.
    let general = roles::role(dialect, word.letter, "");
    let mut taken: Vec<_> = taken.collect();
    taken.sort_by_key(|(role, _)| Some(*role) == general);
    match taken.first() {
        Some((role, _)) if Some(*role) == general => format!("**{letter}** {role}\n\n"),
        Some((role, code)) => format!("**{letter}** of {code}: {role}\n\n"),
        None => match general {
            Some(role) => format!("**{letter}** {role}\n\n"),
            None => format!("**{letter}** has no effect here\n\n"),
        },
    }
}

fn meaning(word: &Word, dialect: Dialect) -> Option<CodeInfo> {
    match word.value {
        gcode::Value::Number(value) => interp::describe_in(dialect, word.letter, value),
        gcode::Value::Expression(_) => None,
    }
}

fn describe(code: &CodeInfo) -> String {
    let mut text = format!("**{}** {}", code.code, code.name);
    let lasting = if code.modal { "stays in force" } else { "this block only" };
    _ = write!(text, " — {}, {lasting}", code.group);
    if !code.letters.is_empty() {
        let spaced: Vec<_> = code.letters.chars().map(String::from).collect();
        _ = write!(text, "; takes {}", spaced.join(" "));
    }
    if !code.executed {
        text.push_str("; **Leadscrew refuses it**");
    }
    text.push_str("\n\n");
    text
}

/// Position and modes before and after.
fn around(visit: &Visit) -> String {
    let (before, after) = (&visit.before, &visit.after);
    let unit = match after.units {
        interp::Units::Inch => "inch",
        interp::Units::Millimetre => "mm",
    };
    let mut text = format!("| | program, {unit} | | machine, mm | |\n|---|---:|---:|---:|---:|\n");
    text.push_str("| | before | after | before | after |\n");
    for axis in Axis::ALL {
        let i = axis.index();
        let program = [before.program[i], after.program[i]];
        let machine = [along(&before.machine, axis), along(&after.machine, axis)];
        if i < 3 || program.iter().chain(&machine).any(|value| *value != 0.0) {
            let [a, b, c, d] = [program[0], program[1], machine[0], machine[1]].map(shown);
            _ = writeln!(text, "| {} | {a} | {b} | {c} | {d} |", axis.letter());
        }
    }
    _ = write!(text, "\nIn force: {}", in_force(after));
    let gone: Vec<_> = before.codes.iter().filter(|c| !after.codes.contains(c)).cloned().collect();
    if !gone.is_empty() {
        _ = write!(text, "\n\nBefore: {}", gone.join(" "));
    }
    text.push('\n');
    text
}

fn in_force(standing: &Standing) -> String {
    let mut text = standing.codes.join(" ");
    _ = write!(text, " F{} S{} T{}", standing.feed, standing.speed, standing.tool);
    if standing.selected_tool != standing.tool {
        _ = write!(text, " (T{} is next)", standing.selected_tool);
    }
    text
}

pub(crate) fn along(position: &Position, axis: Axis) -> f64 {
    position.along(axis).value()
}

/// Four decimals, as few as it takes.
fn shown(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
