//! G10, and T of a lathe: what sets offsets, and what brings a tool with its own.
//!
//! ```text
//!   G10 L2 P0 to P6, L20 P1 to P48      work offsets: the external one, G54 to G59, G54.1
//!   G10 L10 P R, L11 (or L1)            a mill's tool: length, and its wear
//!   G10 L12 P R, L13                    its radius, and its wear
//!   G10 P X Z Y R Q (or U W V)          a lathe's tool: P is its wear, P10000 + number its geometry; P0 the external offset
//! ```
pub(crate) mod longer;
pub(crate) mod tool_offsets;

use crate::{
    Parameters,
    codes::number::near_whole,
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        mapping::incremental,
        offsets::tool_offsets::{Part, ToolVariable, set_tool, tool_value},
        state::{Fanuc, Said},
        words::sense::Sense,
    },
    state::executor::Executor,
};
use diag::Span;

/// A lathe's geometry has its number and this.
const GEOMETRY: u32 = 10_000;

/// G10.
pub(crate) fn set_offset(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    p: Option<u32>,
    l: Option<u32>,
) -> Outcome {
    let span = ex.words.place.span;
    match (l, p) {
        (Some(2), Some(p @ 0..=6)) => set_work(fanuc, ex, p as usize),
        (Some(20), Some(p)) if (1..=fanuc.kind.variant().more_offsets.1).contains(&p) => {
            set_work(fanuc, ex, 9 + p as usize)
        }
        (Some(2), _) => refuse(
            "I0617",
            span,
            "G10 L2 needs P: 1 to 6 for G54 to G59, 0 for the external offset",
        ),
        (Some(20), _) => {
            let last = fanuc.kind.variant().more_offsets.1;
            let text = format!("G10 L20 needs P: 1 to {last} for G54.1 P1 to P{last}");
            refuse("I0617", span, text)
        }
        (Some(kind @ (1 | 10..=13)), Some(p)) => {
            let Some(value) = ex.words.take(b'R') else {
                let text = format!("G10 L{kind} needs R, the tool's offset");
                return refuse("I1022", span, text);
            };
            let part = if matches!(kind, 12 | 13) { Part::Radius } else { Part::Z };
            let which = ToolVariable { tool: p, part, wear: matches!(kind, 1 | 11 | 13) };
            let now = if incremental(ex) { tool_value(fanuc, ex, which) } else { 0.0 };
            set_tool(fanuc, ex, which, now + value);
            Ok(())
        }
        (None, Some(p)) if fanuc.is_lathe() => set_lathe_tool(fanuc, ex, p, span),
        (Some(kind), _) => {
            let (what, instead) = match kind {
                3 => ("tool life data", "its tools do not wear out: leave the block away"),
                50..=52 => ("parameters of the control", "the machine's file has them"),
                _ => ("", "L2, L20 and L10 to L13 are known"),
            };
            let what = if what.is_empty() { String::new() } else { format!(" ({what})") };
            let text = format!("G10 L{kind}{what} is not executed by Leadscrew yet");
            Err(error("I0614", span, text).with_help(instead).into())
        }
        (None, _) => refuse(
            "I0616",
            span,
            "G10 needs L2 or L20 (work offset), L10 or L11 (tool length and wear), L12 or L13 (tool radius and wear)",
        ),
    }
}

/// Which offset of the shared language, and what it comes to under G91.
fn set_work(fanuc: &mut Fanuc, ex: &mut Executor, system: usize) -> Outcome {
    let first = Parameters::work_offset(system);
    for axis in 0..6 {
        let letter = b"XYZABC"[axis];
        let Some(word) = ex.words.take(letter) else { continue };
        let unit = if axis < 3 { ex.modes.units.in_mm() } else { 1.0 };
        let mm = fanuc.radius(axis, word * unit);
        let now = if incremental(ex) { ex.store.numbered.at(first + axis) } else { 0.0 };
        ex.store.numbered.set(first + axis, now + mm);
    }
    if ex.modes.compensating() && (system == 0 || system == usize::from(ex.modes.system)) {
        let text =
            "the work offset in force cannot be changed while cutter radius compensation is on";
        return Err(error("I0544", ex.words.place.span, text).with_help("write G40 before").into());
    }
    fanuc.once.changed = Some(system);
    Ok(())
}

/// G10 P X Z R Q of a lathe.
fn set_lathe_tool(fanuc: &mut Fanuc, ex: &mut Executor, p: u32, span: Span) -> Outcome {
    if p == 0 {
        return set_work(fanuc, ex, 0);
    }
    let geometry = p >= GEOMETRY;
    let tool = if geometry { p - GEOMETRY } else { p };
    let rows = [
        (b'X', b'U', Part::X),
        (b'Y', b'V', Part::Y),
        (b'Z', b'W', Part::Z),
        (b'R', b'C', Part::Radius),
    ];
    let mut any = false;
    for (letter, step, part) in rows {
        let which = ToolVariable { tool, part, wear: !geometry };
        let word = ex.words.take(letter);
        let more = ex.words.take(step);
        any |= word.is_some() || more.is_some();
        let now = tool_value(fanuc, ex, which);
        if let Some(more) = more.or(word.filter(|_| incremental(ex))) {
            set_tool(fanuc, ex, which, now + more);
        } else if let Some(value) = word {
            set_tool(fanuc, ex, which, value);
        }
    }
    if let Some(nose) = ex.words.take(b'Q') {
        let which = ToolVariable { tool, part: Part::Nose, wear: false };
        set_tool(fanuc, ex, which, nose);
        any = true;
    }
    if any {
        return Ok(());
    }
    refuse("I1022", span, "G10 P needs X, Z, R or Q, the tool's offsets, or U and W to add to them")
}

/// T0102 of a lathe: tool 1 with offset 2.
pub(crate) fn turret(ex: &mut Executor, word: &Said, sense: Sense) -> Outcome {
    let Some(number) = near_whole(word.value).and_then(|n| u32::try_from(n).ok()) else {
        return refuse(
            "I0610",
            word.span,
            format!("expected a tool and its offset as in T0101, found {}", word.value),
        );
    };
    let (tool, offset) = (number / 100, number % 100);
    if tool != 0 && tool != ex.modes.current_tool {
        ex.words.put(b'T', f64::from(tool), word.span)?;
        ex.words.take_m(6.0, word.span)?;
        // a turret indexes while the spindle turns
        match ex.modes.spindle.turning {
            Some(sense_now) if !sense.spindle => {
                let code = if sense_now == crate::Sense::Clockwise { 3.0 } else { 4.0 };
                ex.words.take_m(code, word.span)?;
            }
            _ => {}
        }
    }
    if offset == 0 {
        return ex.words.take_g(49.0, word.span);
    }
    ex.words.take_g(43.0, word.span)?;
    ex.words.put(b'H', f64::from(offset), word.span)
}
