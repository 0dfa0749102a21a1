//! A block's words in the shared language: units, seconds, repetitions, increments, codes.
pub(crate) mod accepted;
pub(crate) mod corner;
pub(crate) mod read;
pub(crate) mod sense;

use crate::{
    codes::{
        MGroup,
        number::{near_whole, tenths},
        spelling::written,
    },
    dialect::fanuc::{
        codes::{Meaning, is_shared_m, meaning},
        kind::Kind,
    },
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        mapping::{
            map, set_mapping,
            surface::{face, stands, unroll, words_on_surface},
        },
        offsets::{longer::lengthen, set_offset, turret},
        state::{Callee, Fanuc, Said, Then},
        stroke::set_stroke_check,
        words::{
            accepted::accept,
            corner::{corner_word, is_corner},
            read::{feed, scaled, start_angle, warn_of_points},
            sense::{Sense, complete, sense},
        },
    },
    state::executor::Executor,
};
use diag::{Diagnostic, Span};

/// Put the block's words as the shared language has them.
pub(crate) fn translate(fanuc: &mut Fanuc, ex: &mut Executor) -> Outcome<Then> {
    let said = core::mem::take(&mut fanuc.said);
    let result = translated(fanuc, ex, &said);
    fanuc.said = said;
    result
}

fn translated(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said]) -> Outcome<Then> {
    let mut sense = sense(fanuc, ex, said);
    warn_of_points(fanuc, ex, said);
    let mut p = None;
    let mut l = None;
    let mut start = None;
    for word in said {
        let value = scaled(fanuc, ex, word);
        match word.letter {
            b'G' | b'M' => {}
            b'P' | b'Q' | b'R' | b'X' | b'Y' | b'Z' if sense.smoothing => {}
            b'P' if sense.smoothness => smoothness(word)?,
            b'E' if sense.smoothness => ex.words.put(b'P', word.value, word.span)?,
            b'P' if sense.reference => crate::front_end::fanuc::reference::second(word)?,
            b'P' if sense.local => start = Some(*word),
            b'Q' if sense.call => start = Some(*word),
            b'H' if sense.call && fanuc.kind.variant().begins_calls_by_h => start = Some(*word),
            b'r' if sense.tap && fanuc.kind.variant().taps_by_r => rigid(ex, word)?,
            b'Q' if sense.set_offset => ex.words.put(b'Q', word.value, word.span)?,
            b'c' | b'r' => corner_word(fanuc, word, value)?,
            b'a' => line_angle(fanuc, ex, word, value)?,
            b'C' | b'R' | b'I' | b'K' if is_corner(fanuc, word, &sense) => {
                let length = Said { letter: b'r', ..*word };
                let value = scaled(fanuc, ex, &length);
                corner_word(fanuc, word, value)?;
            }
            b'P' if sense.call || sense.back || sense.more_offsets || sense.set_offset => {
                p = Some(*word);
            }
            b'P' if sense.orient && fanuc.kind.variant().orients_by_p => {
                ex.words.put(b'R', word.value, word.span)?;
            }
            b'P' if sense.dwell || sense.cycle => {
                let seconds = fanuc.kind.variant().waits_in_seconds && !word.counts;
                if !word.counts && word.value.fract() != 0.0 && !seconds {
                    let text =
                        format!("P counts milliseconds, without a point, found P{}", word.value);
                    return refuse("I1020", word.span, text);
                }
                let unit = if seconds { 1.0 } else { fanuc.increments.per_unit() };
                ex.words.put(b'P', word.value / unit, word.span)?;
            }
            b'X' | b'U' if sense.dwell => {
                let seconds = if word.counts && !fanuc.calculator {
                    word.value / fanuc.increments.per_unit()
                } else {
                    word.value
                };
                ex.words.put(b'P', seconds, word.span)?;
            }
            b'L' if sense.call || sense.set_offset => l = Some(*word),
            b'K' if sense.cycle => repetitions(ex, word)?,
            b'Q' if sense.thread && fanuc.is_lathe() => {
                fanuc.thread_angle = start_angle(fanuc, &[*word]);
            }
            b'F' | b'E' if sense.thread => {
                let lead = feed(fanuc, word, &sense);
                fanuc.lead = Some(lead);
            }
            b'F' => {
                let feed = feed(fanuc, word, &sense);
                ex.words.put(b'F', feed, word.span)?;
            }
            b'S' if sense.position => {
                fanuc.top_speed = Some(word.value);
                sense.surface_speed |= ex.modes.spindle.constant_surface_speed;
            }
            b'T' if fanuc.is_lathe() => turret(ex, word, sense)?,
            b'U' | b'V' | b'W' | b'H' if fanuc.is_lathe() && !sense.set_offset => {
                let (letter, axis) = match word.letter {
                    b'U' => (b'X', 0),
                    b'V' => (b'Y', 1),
                    b'W' => (b'Z', 2),
                    _ => (b'C', 5),
                };
                let turn = Said { letter: b'C', ..*word };
                let value = if axis == 5 { scaled(fanuc, ex, &turn) } else { value };
                let from = if ex.modes.incremental { 0.0 } else { stands(fanuc, ex, axis) };
                let from = if axis == 0 && ex.modes.diameter { 2.0 * from } else { from };
                fanuc.once.by_w |= axis == 2;
                ex.words.by_increments = true;
                ex.words.put(letter, from + value, word.span)?;
            }
            b'I' | b'J' if sense.tap => ex.words.put(word.letter, word.value, word.span)?,
            letter => ex.words.put(letter, value, word.span)?,
        }
    }
    codes(fanuc, ex, said, &sense)?;
    if fanuc.once.longer != 0 {
        lengthen(fanuc, ex, said, &sense)?;
    }
    if !(sense.dwell || sense.zone) {
        words_on_surface(fanuc, ex)?;
    }
    if !(sense.dwell || sense.set_offset) {
        map(fanuc, ex, sense.cycle)?;
    }
    accept(fanuc, ex, &sense)?;
    complete(fanuc, ex, &sense)?;
    numbers(fanuc, ex, &sense, p, l, start)
}

/// `,A45.`: the angle of a line to Z.
fn line_angle(fanuc: &Fanuc, ex: &mut Executor, word: &Said, value: f64) -> Outcome {
    if !fanuc.is_lathe() {
        let text = "A after a comma is for lathes: the angle of a line";
        return refuse("I0110", word.span, text);
    }
    ex.words.put(b'A', value, word.span)
}

/// K of a cycle.
fn repetitions(ex: &mut Executor, word: &Said) -> Outcome {
    if near_whole(word.value).is_none() {
        let text = format!(
            "K counts a cycle's repetitions here: expected a whole number, found {}",
            word.value
        );
        return refuse("I0108", word.span, text);
    }
    ex.words.put(b'L', word.value, word.span)
}

fn codes(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said], sense: &Sense) -> Outcome {
    let mut mapped = Vec::new();
    for word in said {
        let span = word.span;
        match word.letter {
            b'G' => match tenths(word.value).map(|code| (code, meaning(fanuc.kind, code))) {
                Some((_, Meaning::Shared(920))) if sense.position => {}
                Some((_, Meaning::Shared(541 | 100) | Meaning::Smoothing)) => {}
                Some((_, Meaning::Shared(540))) if sense.more_offsets => {}
                Some((_, Meaning::WorkOffset(number))) => {
                    fanuc.once.system = Some(9 + more_offsets(fanuc, u32::from(number), span)?);
                }
                Some((_, Meaning::Smoothness)) => ex.words.take_g(64.0, span)?,
                Some((_, Meaning::ExactBlock)) => fanuc.once.exact = true,
                Some((_, Meaning::Back)) => fanuc.once.back = true,
                Some((_, Meaning::Check)) => {
                    fanuc.once.check = true;
                    ex.words.take_g(0.0, span)?;
                }
                Some((_, Meaning::Cylinder)) => unroll(fanuc, ex, said)?,
                Some((_, Meaning::Face(on))) => face(fanuc, ex, said, on)?,
                Some((_, Meaning::Longer(by))) => fanuc.once.longer = by,
                Some((_, Meaning::StrokeCheck(on))) => set_stroke_check(fanuc, ex, on)?,
                Some((_, Meaning::Skip)) => {
                    fanuc.once.skip = true;
                    ex.words.take_g(1.0, span)?;
                }
                Some((_, Meaning::Shared(code))) => match crate::codes::g_code(code) {
                    Some(code) => ex.words.take_code(code, span)?,
                    None => ex.words.take_g(f64::from(code) / 10.0, span)?,
                },
                Some((_, Meaning::Mapping(code))) => mapped.push(code),
                Some((_, Meaning::Thread)) => ex.words.take_g(33.0, span)?,
                Some((_, Meaning::Off | Meaning::Box(_) | Meaning::Multiple(_))) => {}
                Some((code, Meaning::NotYet(name))) => {
                    let text =
                        format!("G{} ({name}) is not executed by Leadscrew yet", written(code));
                    let fault = error("I0103", span, text);
                    return Err(match crate::dialect::fanuc::codes::instead(code) {
                        "" => fault,
                        instead => fault.with_help(instead),
                    }
                    .into());
                }
                _ => return refuse("I0102", span, format!("G{} is no known code", word.value)),
            },
            b'M' => match near_whole(word.value) {
                Some(98 | 99 | 198) => {}
                Some(97) if sense.local => {}
                // T has changed the tool
                Some(6) if fanuc.is_lathe() && said.iter().any(|s| s.letter == b'T') => {}
                _ if ex.words.is_own_m(word.value) && !is_shared_m_word(fanuc.kind, word.value) => {
                    ex.words.take_own_m(word.value, span)?;
                }
                Some(number @ 0..=60) if is_shared_m(fanuc.kind, number as u16) => {
                    ex.words.take_m(word.value, span)?;
                }
                _ => {
                    let text = format!(
                        "M{} is no known code: its meaning is the machine builder's",
                        word.value
                    );
                    return refuse("I0105", span, text);
                }
            },
            _ => {}
        }
    }
    // ends before begins: what the block sets is set last
    let ends = |code: &u16| matches!(code, 150 | 500 | 501 | 690);
    for code in mapped.iter().filter(|code| ends(code)) {
        set_mapping(fanuc, ex, said, *code)?;
    }
    for code in mapped.iter().filter(|code| !ends(code)) {
        set_mapping(fanuc, ex, said, *code)?;
    }
    Ok(())
}

/// P and L where they are numbers of something.
fn numbers(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    sense: &Sense,
    p: Option<Said>,
    l: Option<Said>,
    start: Option<Said>,
) -> Outcome<Then> {
    let span = ex.words.place.span;
    let whole = |word: Option<Said>| match word {
        None => Ok(None),
        Some(word) => match near_whole(word.value).and_then(|n| u32::try_from(n).ok()) {
            Some(number) => Ok(Some(number)),
            None => refuse(
                "I0108",
                word.span,
                format!(
                    "expected a whole number after {}, found {}",
                    word.letter as char, word.value
                ),
            ),
        },
    };
    let (number, times, start) = (whole(p)?, whole(l)?, whole(start)?);
    if sense.set_offset {
        return set_offset(fanuc, ex, number, times).map(|()| Then::Next);
    }
    if sense.more_offsets {
        fanuc.once.system = Some(9 + more_offsets(fanuc, number.unwrap_or(0), span)?);
        return Ok(Then::Next);
    }
    if sense.back {
        return Ok(Then::Return(number));
    }
    if !sense.call {
        return Ok(Then::Next);
    }
    let in_file = sense.in_file;
    let call = |program, times| Ok(Then::Call(Callee { program, in_file, times, start }));
    match (fanuc.called.or(number), times) {
        (None, times) if start.is_some() && !in_file => call(None, times.unwrap_or(1)),
        (None, _) if sense.local => {
            refuse("I0302", span, "M97 needs P, the number N of the block where it begins")
        }
        (None, _) if in_file => refuse("I0302", span, "M198 needs P, the number of the program"),
        (None, _) => refuse("I0302", span, "M98 needs P, the number of the program"),
        (Some(number), Some(times)) => call(Some(number), times),
        // P51002: five times O1002
        (Some(both), None) if fanuc.called.is_none() && both > 9999 => {
            call(Some(both % 10_000), both / 10_000)
        }
        (Some(number), None) => call(Some(number), 1),
    }
}

/// The work offset beyond G59 with this number.
fn more_offsets(fanuc: &Fanuc, number: u32, span: Span) -> Outcome<u8> {
    if fanuc.mapping.changes() {
        let text = "G54.1 cannot be used while G51, G51.1 or G68 is in force";
        return refuse("I1045", span, text);
    }
    let (code, last) = fanuc.kind.variant().more_offsets;
    match u8::try_from(number) {
        Ok(number) if number > 0 && u32::from(number) <= last => Ok(number),
        _ => refuse("I1021", span, format!("{code} takes P1 to P{last}")),
    }
}

/// Whether an M word is one of the shared language.
fn is_shared_m_word(kind: Kind, value: f64) -> bool {
    let number = near_whole(value).and_then(|number| u16::try_from(number).ok());
    number.is_some_and(|number| is_shared_m(kind, number))
}

/// P of Haas' G187: rough, medium, finish. How far that rounds a corner is a setting there.
fn smoothness(word: &Said) -> Outcome {
    if matches!(word.value, 1.0 | 2.0 | 3.0) {
        return Ok(());
    }
    let text = format!("P of G187 is 1, 2 or 3: rough, medium, finish; found {}", word.value);
    refuse("I1065", word.span, text)
}

/// `,R` of Mitsubishi's taps.
fn rigid(ex: &mut Executor, word: &Said) -> Outcome {
    if word.value == 1.0 {
        ex.words.put_m(MGroup::Rigid, 290);
        return Ok(());
    }
    let text = format!(",R1 makes a tap that follows the spindle, found ,R{}", word.value);
    let help = "a tap in a holder with a clutch is a setting of the machine: --tapping floating";
    Err(error("I1065", word.span, text).with_help(help).into())
}

/// The one sentence for a lead that is missing.
pub(crate) fn no_lead(span: Span) -> Diagnostic {
    error("I0425", span, "a thread needs F, the advance per revolution")
}
