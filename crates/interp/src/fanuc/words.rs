//! A block's words in the shared language: units, seconds, repetitions, increments, codes.
use super::{
    Fanuc, Then,
    codes::{Meaning, is_shared_m, meaning},
};
use crate::{
    execute::Executor,
    fault::{Outcome, error, refuse},
    interpreter::Interpreter,
    spelling::written,
    state::{FeedMode, Motion},
    words::{near_whole, tenths},
};
use diag::{Diagnostic, Span};
use gcode::Value;

/// A word with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Said {
    pub(super) letter: u8,
    pub(super) value: f64,
    /// Written as a number without a decimal point: it counts increments.
    pub(super) counts: bool,
    pub(super) span: Span,
}

/// What the block's codes make of its other words.
#[allow(clippy::struct_excessive_bools)] // each is a fact of its own about the block
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sense {
    dwell: bool,
    cycle: bool,
    thread: bool,
    set_offset: bool,
    /// A tapping cycle: its I and J are no lengths.
    tap: bool,
    /// G92, G50.
    position: bool,
    /// G54.1.
    more_offsets: bool,
    /// M98, M99.
    call: bool,
    back: bool,
    surface_speed: bool,
    per_revolution: bool,
    motion: bool,
    pub(super) spindle: bool,
}

impl Fanuc {
    /// Evaluate the block's words; those without a value vanish.
    pub(super) fn read(&mut self, it: &Interpreter<'_>) -> Outcome {
        let mut said = core::mem::take(&mut self.said);
        said.clear();
        for word in &it.block.words {
            let value = match word.value {
                Value::Number(number) => Some(number),
                value @ Value::Expression(_) => {
                    self.values(&it.executor).value(&it.block, value, word.span)?
                }
            };
            let Some(value) = value else { continue };
            let text = it.sources[0].get(word.span.start as usize..word.span.end as usize);
            let counts =
                matches!(word.value, Value::Number(_)) && !text.is_some_and(|t| t.contains(&b'.'));
            said.push(Said { letter: word.letter, value, counts, span: word.span });
        }
        self.said = said;
        Ok(())
    }

    /// A value in the program's unit of length (or degrees): increments counted.
    pub(super) fn scaled(&self, executor: &Executor, said: &Said) -> f64 {
        if !said.counts || self.calculator {
            return said.value;
        }
        let inch = executor.state.units == crate::Units::Inch;
        match said.letter {
            b'A' | b'B' | b'C' => said.value / 1000.0,
            letter if self.mapping.is_angle(executor, letter) => said.value / 1000.0,
            b'X' | b'Y' | b'Z' | b'U' | b'V' | b'W' | b'I' | b'J' | b'K' | b'Q' | b'R' => {
                said.value / if inch { 10_000.0 } else { 1000.0 }
            }
            _ => said.value,
        }
    }

    fn feed(&self, executor: &Executor, said: &Said, sense: &Sense) -> f64 {
        if !said.counts || self.calculator {
            return said.value;
        }
        let inch = executor.state.units == crate::Units::Inch;
        said.value
            / match (sense.per_revolution || sense.thread, inch, self.is_lathe()) {
                (false, false, _) => 1.0,
                (false, true, _) | (true, false, false) => 100.0,
                (true, true, false) | (true, false, true) => 10_000.0,
                (true, true, true) => 1_000_000.0,
            }
    }

    /// F of a thread: length per revolution.
    pub(super) fn thread_lead(&self, executor: &Executor, said: &Said) -> f64 {
        self.feed(executor, said, &Sense { thread: true, ..Sense::default() })
    }

    /// Put the block's words as the shared language has them.
    pub(super) fn translate(&mut self, ex: &mut Executor) -> Outcome<Then> {
        let said = core::mem::take(&mut self.said);
        let result = self.translated(ex, &said);
        self.said = said;
        result
    }

    fn translated(&mut self, ex: &mut Executor, said: &[Said]) -> Outcome<Then> {
        let mut sense = self.sense(ex, said);
        self.warn_of_points(ex, said);
        let mut p = None;
        let mut l = None;
        for word in said {
            let value = self.scaled(ex, word);
            match word.letter {
                b'G' | b'M' => {}
                b'P' if sense.call || sense.back || sense.more_offsets || sense.set_offset => {
                    p = Some(*word);
                }
                b'P' if sense.dwell || sense.cycle => {
                    if !word.counts && word.value.fract() != 0.0 {
                        let text = format!(
                            "P counts milliseconds, without a point, found P{}",
                            word.value
                        );
                        return refuse("I1020", word.span, text);
                    }
                    ex.words.put(b'P', word.value / 1000.0, word.span)?;
                }
                b'X' | b'U' if sense.dwell => {
                    let seconds = if word.counts && !self.calculator {
                        word.value / 1000.0
                    } else {
                        word.value
                    };
                    ex.words.put(b'P', seconds, word.span)?;
                }
                b'L' if sense.call || sense.set_offset => l = Some(*word),
                b'K' if sense.cycle => ex.words.put(b'L', word.value, word.span)?,
                b'Q' if sense.thread && self.is_lathe() => {
                    self.thread_angle = self.start_angle(&[*word]);
                }
                b'F' | b'E' if sense.thread => {
                    let lead = self.feed(ex, word, &sense);
                    self.lead = Some(lead);
                }
                b'F' => {
                    let feed = self.feed(ex, word, &sense);
                    ex.words.put(b'F', feed, word.span)?;
                }
                b'S' if sense.position => {
                    self.top_speed = Some(word.value);
                    sense.surface_speed |= ex.state.spindle.constant_surface_speed;
                }
                b'T' if self.is_lathe() => self.turret(ex, word, sense)?,
                b'U' | b'W' if self.is_lathe() => {
                    let (letter, axis) = if word.letter == b'U' { (b'X', 0) } else { (b'Z', 2) };
                    let from = if ex.state.incremental { 0.0 } else { ex.state.at[axis] };
                    let from = if axis == 0 && ex.state.diameter { 2.0 * from } else { from };
                    ex.words.put(letter, from + value, word.span)?;
                }
                b'I' | b'J' if sense.tap => ex.words.put(word.letter, word.value, word.span)?,
                letter => ex.words.put(letter, value, word.span)?,
            }
        }
        self.codes(ex, said, &sense)?;
        if !(sense.dwell || sense.set_offset) {
            self.map(ex, sense.cycle)?;
        }
        self.complete(ex, &sense)?;
        self.numbers(ex, &sense, p, l)
    }

    /// What the codes of the block say about the other words.
    fn sense(&mut self, ex: &Executor, said: &[Said]) -> Sense {
        let mut sense = Sense {
            cycle: matches!(ex.state.motion, Motion::Cycle(_)),
            tap: matches!(ex.state.motion, Motion::Cycle(cycle) if cycle.tap_sense().is_some()),
            thread: ex.state.motion == Motion::Thread,
            per_revolution: ex.state.feed_mode == FeedMode::PerRevolution,
            ..Sense::default()
        };
        for word in said {
            match (word.letter, tenths(word.value)) {
                (b'G', Some(code)) => match meaning(self.kind, code) {
                    Meaning::Shared(40) => sense.dwell = true,
                    Meaning::Shared(100) => sense.set_offset = true,
                    Meaning::Shared(920) => sense.position = said.iter().any(|s| s.letter == b'S'),
                    Meaning::Shared(541) => sense.more_offsets = true,
                    Meaning::Shared(960) => sense.surface_speed = true,
                    Meaning::Shared(code @ (940 | 950)) => sense.per_revolution = code == 950,
                    Meaning::Shared(code @ (0..=30 | 730..=890 | crate::codes::OWN..)) => {
                        sense.motion = true;
                        sense.cycle = code >= 730 && code != 800;
                        sense.tap = matches!(code, 740 | 840 | 842 | 843);
                        sense.thread = false;
                        self.lathe_cycle = None;
                    }
                    Meaning::Thread => {
                        (sense.motion, sense.cycle, sense.thread) = (true, false, true);
                        self.lathe_cycle = None;
                    }
                    Meaning::Box(code) => {
                        (sense.motion, sense.cycle) = (true, false);
                        self.lathe_cycle = Some(code);
                        self.corner = None;
                        sense.thread = code == 780;
                    }
                    _ => {}
                },
                (b'M', Some(980)) => sense.call = true,
                (b'M', Some(990)) => sense.back = true,
                (b'M', Some(30 | 40 | 50 | 190)) => sense.spindle = true,
                _ => {}
            }
        }
        sense.thread |= self.lathe_cycle == Some(780);
        sense
    }

    fn codes(&mut self, ex: &mut Executor, said: &[Said], sense: &Sense) -> Outcome {
        let mut mapped = Vec::new();
        for word in said {
            let span = word.span;
            match word.letter {
                b'G' => match tenths(word.value).map(|code| (code, meaning(self.kind, code))) {
                    Some((_, Meaning::Shared(920))) if sense.position => {}
                    Some((_, Meaning::Shared(541))) => {}
                    Some((_, Meaning::Shared(100))) if self.is_tool_offset(said) => {}
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
                        return refuse("I0103", span, text);
                    }
                    _ => return refuse("I0102", span, format!("G{} is no known code", word.value)),
                },
                b'M' => match near_whole(word.value) {
                    Some(98 | 99) => {}
                    Some(number @ 0..=60) if is_shared_m(number as u16) => {
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
            self.set_mapping(ex, said, *code)?;
        }
        for code in mapped.iter().filter(|code| !ends(code)) {
            self.set_mapping(ex, said, *code)?;
        }
        Ok(())
    }

    /// Words that the shared codes need and Fanuc leaves out.
    fn complete(&mut self, ex: &mut Executor, sense: &Sense) -> Outcome {
        let span = ex.words.place.span;
        if sense.cycle
            && ex.words.get(b'P').is_none()
            && ex.state.sticky.is_none_or(|s| s.dwell.is_none())
        {
            let waits =
                matches!(ex.words.g(crate::codes::GGroup::Motion), Some(820 | 860 | 880 | 890));
            if waits {
                ex.words.put(b'P', 0.0, span)?;
            }
        }
        if sense.thread
            && self.lathe_cycle.is_none()
            && let Some(lead) = self.lead.filter(|_| ex.words.any(crate::codes::AXES))
        {
            ex.words.put(b'K', lead, span)?;
        }
        if ex.words.m(crate::codes::MGroup::Spindle) == Some(19) && ex.words.get(b'R').is_none() {
            ex.words.put(b'R', 0.0, span)?;
        }
        if sense.surface_speed {
            if ex.words.get(b'S').is_none() {
                ex.words.put(b'S', ex.state.spindle.speed, span)?;
            }
            if ex.words.g(crate::codes::GGroup::SpindleMode).is_none() {
                ex.words.take_g(96.0, span)?;
            }
            if let Some(top) = self.top_speed {
                ex.words.put(b'D', top, span)?;
            }
        }
        Ok(())
    }

    /// P and L where they are numbers of something.
    fn numbers(
        &self,
        ex: &mut Executor,
        sense: &Sense,
        p: Option<Said>,
        l: Option<Said>,
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
        let (number, times) = (whole(p)?, whole(l)?);
        if sense.set_offset {
            return self.set_offset(ex, number, times).map(|()| Then::Next);
        }
        if sense.more_offsets {
            return match number {
                Some(n @ 1..=3) => {
                    ex.words.take_g(59.0 + f64::from(n) / 10.0, span)?;
                    Ok(Then::Next)
                }
                _ => refuse(
                    "I1021",
                    span,
                    "G54.1 takes P1 to P3 here: the offsets that the parameter file calls G59.1 to G59.3",
                ),
            };
        }
        if sense.back {
            return Ok(Then::Return(number));
        }
        if !sense.call {
            return Ok(Then::Next);
        }
        match (number, times) {
            (None, _) => refuse("I0302", span, "M98 needs P, the number of the program"),
            (Some(number), Some(times)) => Ok(Then::Call { number, times }),
            // P51002: five times O1002
            (Some(both), None) if both > 9999 => {
                Ok(Then::Call { number: both % 10_000, times: both / 10_000 })
            }
            (Some(number), None) => Ok(Then::Call { number, times: 1 }),
        }
    }

    fn warn_of_points(&mut self, ex: &mut Executor, said: &[Said]) {
        if self.warned_of_point || self.calculator {
            return;
        }
        let axis = |s: &&Said| s.counts && s.value != 0.0 && b"XYZUVWABC".contains(&s.letter);
        let Some(word) = said.iter().find(axis) else { return };
        if said.iter().any(|s| s.letter == b'G' && matches!(s.value, 4.0 | 65.0 | 66.0)) {
            return;
        }
        self.warned_of_point = true;
        let (letter, number) = (word.letter as char, word.value);
        let unit = match (word.letter, ex.state.units) {
            (b'A'..=b'C', _) => "degrees",
            (_, crate::Units::Inch) => "inch",
            _ => "mm",
        };
        let text = format!("{letter}{number} without a point is {} {unit}", self.scaled(ex, word));
        let help = format!(
            "write {letter}{number}. for {number} {unit}; if the machine counts whole units without a point, say so with --decimal-point calculator. Said once"
        );
        ex.remarks.push(Diagnostic::warning("I1023", word.span, text).with_help(help));
    }
}

/// The one sentence for a lead that is missing.
pub(super) fn no_lead(span: Span) -> Diagnostic {
    error("I0425", span, "a thread needs F, the advance per revolution")
}
