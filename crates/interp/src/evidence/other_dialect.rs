//! A program that was written for another dialect than the one it is read in: its own words give it
//! away.
//!
//! ```text
//!   %
//!   O1000               a numbered program      2 ┐
//!   G65 P9100 A1.       a macro is called       4 ├─► Fanuc 6 > LinuxCNC 0: said before all that follows from it
//!   IF[#1GT5]GOTO20     a jump                  4 ┘
//! ```
//!
//! Each kind of word counts once, for the dialects that have it, by how little the others could
//! mean by it: 1 is a hint, 4 is a word that no other dialect has. The dialect at hand is
//! questioned where another one has at least [`DECISIVE`] and more than itself. Read are the
//! letters alone, not what they do, and only the first lines: what a program is written for is seen
//! at its beginning.
//!
//! Source: the code lists of Fanuc's series 30i (machining centres, lathes), of LinuxCNC 2.9 and of
//! Brother's CNC-B00; figures 8 and 9 of JPH0622778B2 for Toyoda.
use crate::{
    dialect::Dialect,
    evidence::{
        line::{BYTES, LINES, SplitLine},
        other_machine::{has_letter, is_turned},
        words::{CHIP_REMOVAL, Evidence, WITHOUT_R, speaks},
    },
    setup::Setup,
};
use diag::{Diagnostic, Span};

/// Weight from which on a dialect is suspected.
const DECISIVE: u32 = 4;
/// Pieces of evidence that are named.
const NAMED: usize = 4;
/// The dialect that a program is written for, if that is plainly not the one it is read in.
pub fn looks_like(source: &[u8], read_in: Dialect) -> Option<Dialect> {
    heaviest(&gather(source), read_in, is_of_a_lathe(source, read_in))
}

/// True for a program that turns: a dialect of mills is none of its own, whoever made the control.
fn is_of_a_lathe(source: &[u8], own: Dialect) -> bool {
    is_turned(source) || own.has_turret() && !has_letter(source, 'Y')
}

fn heaviest(evidence: &[Evidence], own: Dialect, turns: bool) -> Option<Dialect> {
    let weight = |dialect: Dialect| -> u32 {
        evidence.iter().filter(|e| e.belongs_to(dialect)).map(|e| e.weight).sum()
    };
    let family = |dialect: Dialect| dialect.rules().evidence;
    // of two as likely, the one with the rarer words
    let is_fanucs = |other: &Dialect| other.grammar() == gcode::Grammar::Fanuc;
    let others = Dialect::BY_RARITY
        .into_iter()
        .filter(|other| family(*other) != family(own))
        .filter(|other| !(turns && is_fanucs(other) && !other.has_turret()));
    // and before that one for the same kind of machine
    let alike = |other: &Dialect| other.has_turret() == own.has_turret();
    let (alike, unlike): (Vec<_>, Vec<_>) = others.partition(alike);
    let others = alike.into_iter().chain(unlike);
    // where nothing else tells it from the own one, it may as well be a mistake
    let tells = |e: &&Evidence, other| e.belongs_to(other) && !e.belongs_to(own);
    let is_told = |other| evidence.iter().any(|e| tells(&e, other) && e.what != WITHOUT_R);
    let mut best = (DECISIVE.max(weight(own) + 1) - 1, None);
    for other in others {
        if weight(other) > best.0 && is_told(other) {
            best = (weight(other), Some(other));
        }
    }
    best.1
}

/// The words by which a program tells that it is for this dialect, each with its line.
pub fn telling_words(source: &[u8], dialect: Dialect) -> String {
    placed(&speaking(&gather(source), dialect))
}

/// What speaks most for a dialect, in the order of the program.
fn speaking(evidence: &[Evidence], dialect: Dialect) -> Vec<&Evidence> {
    let mut speaks: Vec<_> = evidence.iter().filter(|e| e.belongs_to(dialect)).collect();
    speaks.sort_by_key(|e| core::cmp::Reverse(e.weight));
    speaks.truncate(NAMED);
    speaks.sort_by_key(|e| e.span.start);
    speaks
}

fn placed(speaks: &[&Evidence]) -> String {
    let named: Vec<_> =
        speaks.iter().map(|e| format!("{} in line {}", e.written, e.span.line)).collect();
    named.join(", ")
}

/// What a program looks like, if that is not the dialect it is read in; a warning, at the program's
/// first line.
pub fn other_dialect(source: &[u8], setup: &Setup) -> Option<Diagnostic> {
    let (mut evidence, own) = (gather(source), setup.dialect);
    if setup.cycles.chip_removal.is_some() {
        evidence.retain(|e| e.what != CHIP_REMOVAL); // every dialect has the words there
    }
    let other = heaviest(&evidence, own, is_of_a_lathe(source, own))?;
    let speaks = speaking(&evidence, other);
    let end = source.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(source.len());
    let span = Span { file: 0, line: 1, start: 0, end: end as u32 };
    let text = format!(
        "this looks like a program for {}, and is read as one for {}: {}",
        other.rules().people,
        own.rules().people,
        placed(&speaks)
    );
    let help = format!(
        "read it with --dialect {name}, or set dialect = \"{name}\" under [control] of the machine's file; what \
         follows may be due to that alone",
        name = other.name()
    );
    let mut finding = Diagnostic::warning("I0909", span, text).with_help(help);
    for e in speaks {
        finding = finding.with_label(e.span, e.what);
    }
    Some(finding)
}

/// Each kind of evidence once.
fn gather(source: &[u8]) -> Vec<Evidence> {
    let mut all: Vec<Evidence> = Vec::new();
    let (mut start, mut first) = (0_u32, true);
    for (number, text) in source.split(|byte| *byte == b'\n').take(LINES).enumerate() {
        if start > BYTES {
            break;
        }
        let line =
            SplitLine::read(text, Span { file: 0, line: number as u32 + 1, start, end: start });
        start += text.len() as u32 + 1;
        speaks(&line, first, &mut |e| {
            if !all.iter().any(|known| known.what == e.what) {
                all.push(e);
            }
        });
        first &= line.code.is_empty() || line.code == "%" || line.code.starts_with('[');
    }
    all
}
