//! G10, and T of a lathe: what sets offsets, and what brings a tool with its own.
use super::{
    Fanuc,
    words::{Said, Sense},
};
use crate::{
    execute::Executor,
    fault::{Outcome, refuse},
    words::near_whole,
};
use units::Length;

impl Fanuc {
    pub(super) fn is_tool_offset(&self, said: &[Said]) -> bool {
        said.iter().any(|s| s.letter == b'L' && matches!(s.value, 10.0..=13.0))
    }

    /// G10: L2 sets a work offset, L10 and L11 a tool's length and its wear.
    pub(super) fn set_offset(&self, ex: &mut Executor, p: Option<u32>, l: Option<u32>) -> Outcome {
        let span = ex.words.place.span;
        match (l, p) {
            (Some(2), Some(p @ 1..=6)) | (Some(20), Some(p @ 1..=3)) => {
                // G54.1 P1 to P3 are the offsets seven to nine
                let p = if l == Some(20) { p + 6 } else { p };
                ex.words.put(b'L', 2.0, span)?;
                ex.words.put(b'P', f64::from(p), span)?;
                if ex.state.incremental {
                    for axis in 0..3 {
                        let letter = b"XYZ"[axis];
                        let first = crate::Parameters::work_offset(p as usize);
                        let now = ex.store.numbered.at(first + axis) / ex.state.units.in_mm();
                        let now = if axis == 0 && ex.state.diameter { 2.0 * now } else { now };
                        ex.words.add(letter, now);
                    }
                }
                Ok(())
            }
            (Some(2), _) => refuse("I0617", span, "G10 L2 needs P: 1 to 6 for G54 to G59"),
            (Some(20), _) => refuse("I0617", span, "G10 L20 needs P: 1 to 3 for G54.1 P1 to P3"),
            (Some(kind @ 10..=13), Some(p)) => {
                let Some(value) = ex.words.take(b'R') else {
                    return refuse(
                        "I1022",
                        span,
                        format!("G10 L{kind} needs R, the tool's offset"),
                    );
                };
                let mm = value * ex.state.units.in_mm();
                let Some(mut tool) = ex.tools.get(p).cloned() else {
                    return refuse(
                        "I0611",
                        span,
                        format!("tool offset {p}: tool {p} is not in the tool table"),
                    );
                };
                let wear = matches!(kind, 11 | 13) || ex.state.incremental;
                // L12 and L13 are radii
                let (offset, mm) = match kind {
                    12 | 13 => (&mut tool.diameter, 2.0 * mm),
                    _ => (&mut tool.length, mm),
                };
                *offset = Length::mm(if wear { offset.value() + mm } else { mm });
                ex.tools.insert(tool);
                Ok(())
            }
            (Some(kind), _) => {
                let text = format!(
                    "G10 L{kind} is not executed by Leadscrew yet: L2, L10 to L13 and L20 are"
                );
                refuse("I0614", span, text)
            }
            (None, _) => refuse(
                "I0616",
                span,
                "G10 needs L2 or L20 (work offset), L10 or L11 (tool length and wear), L12 or L13 (tool radius and wear)",
            ),
        }
    }

    /// T0102 of a lathe: tool 1 with offset 2.
    pub(super) fn turret(&self, ex: &mut Executor, word: &Said, sense: Sense) -> Outcome {
        let Some(number) = near_whole(word.value).and_then(|n| u32::try_from(n).ok()) else {
            return refuse(
                "I0610",
                word.span,
                format!("expected a tool and its offset as in T0101, found {}", word.value),
            );
        };
        let (tool, offset) = (number / 100, number % 100);
        if tool != 0 && tool != ex.state.current_tool {
            ex.words.put(b'T', f64::from(tool), word.span)?;
            ex.words.take_m(6.0, word.span)?;
            // a turret indexes while the spindle turns
            match ex.state.spindle.turning {
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
}
