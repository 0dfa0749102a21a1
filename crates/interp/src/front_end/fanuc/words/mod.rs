//! A block's words in the shared language: units, seconds, repetitions, increments, codes.
pub(crate) mod accepted;
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
        state::{Callee, Fanuc, Said, Then},
        variables::values::rounded,
        words::sense::Sense,
    },
    program::Program,
    state::executor::Executor,
};
use diag::{Diagnostic, Span};
use gcode::{Block, Value};

impl Fanuc {
    /// Evaluate the block's words; those without a value vanish.
    pub(crate) fn read(&mut self, it: &Program<'_>) -> Outcome {
        self.read_words(&it.block, it.sources[it.file], &it.executor)
    }

    pub(crate) fn read_words(&mut self, block: &Block, source: &[u8], ex: &Executor) -> Outcome {
        let mut said = core::mem::take(&mut self.said);
        said.clear();
        self.inch = self.counts_inches(block, ex);
        for word in &block.words {
            let value = match word.value {
                Value::Number(number) => Some(number),
                value @ Value::Expression(_) => {
                    let per_unit = self.per_unit(word.letter, self.inch);
                    let values = self.values_in(ex, per_unit);
                    let value = values.value(block, value, word.span)?;
                    value.map(|value| if per_unit > 1.0 { rounded(value, per_unit) } else { value })
                }
            };
            let Some(value) = value else { continue };
            self.kept.word(word.letter, value);
            let text = source.get(word.span.start as usize..word.span.end as usize);
            // a number in brackets is an expression, in which numbers are whole units
            let is_meant = |text: &[u8]| text.contains(&b'.') || text.contains(&b'[');
            let counts = matches!(word.value, Value::Number(_)) && !text.is_some_and(is_meant);
            said.push(Said { letter: word.letter, value, counts, span: word.span });
        }
        self.said = said;
        Ok(())
    }

    /// Whether the block counts inches: its own G20 and G21 hold for it.
    fn counts_inches(&self, block: &Block, ex: &Executor) -> bool {
        let own = block.words.iter().find_map(|word| match (word.letter, word.value) {
            (b'G', Value::Number(number)) => match self.kind.common(tenths(number)?) {
                Some(200) => Some(true),
                Some(210) => Some(false),
                _ => None,
            },
            _ => None,
        });
        own.unwrap_or(ex.modes.units == crate::Units::Inch)
    }

    /// How many least input increments make one unit of what a letter counts; 1 for what counts itself.
    pub(crate) fn per_unit(&self, letter: u8, inch: bool) -> f64 {
        let per_unit = self.increments.per_unit();
        match letter {
            b'A' | b'B' | b'C' => per_unit,
            b'X'..=b'Z' | b'U'..=b'W' | b'I'..=b'K' | b'Q' | b'R' | b'c' | b'r' => {
                per_unit * if inch { 10.0 } else { 1.0 }
            }
            _ => 1.0,
        }
    }

    /// A value in the program's unit of length (or degrees): increments counted.
    pub(crate) fn scaled(&self, executor: &Executor, said: &Said) -> f64 {
        if !said.counts || self.calculator {
            return said.value;
        }
        let angle = self.mapping.is_angle(executor, said.letter);
        let face = said.letter == b'C' && self.surface.is_some_and(|surface| surface.is_face());
        said.value / self.per_unit(if face { b'R' } else { said.letter }, self.inch && !angle)
    }

    pub(crate) fn feed(&self, said: &Said, sense: &Sense) -> f64 {
        if !said.counts || self.calculator {
            return said.value;
        }
        said.value
            / match (sense.per_revolution || sense.thread, self.inch, self.is_lathe()) {
                (false, false, _) => 1.0,
                (false, true, _) | (true, false, false) => 100.0,
                (true, true, false) | (true, false, true) => 10_000.0,
                (true, true, true) => 1_000_000.0,
            }
    }

    /// F of a thread: length per revolution.
    pub(crate) fn thread_lead(&self, said: &Said) -> f64 {
        self.feed(said, &Sense { thread: true, ..Sense::default() })
    }

    /// Put the block's words as the shared language has them.
    pub(crate) fn translate(&mut self, ex: &mut Executor) -> Outcome<Then> {
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
        let mut start = None;
        for word in said {
            let value = self.scaled(ex, word);
            match word.letter {
                b'G' | b'M' => {}
                b'P' | b'Q' | b'R' | b'X' | b'Y' | b'Z' if sense.smoothing => {}
                b'P' if sense.smoothness => smoothness(word)?,
                b'E' if sense.smoothness => ex.words.put(b'P', word.value, word.span)?,
                b'P' if sense.reference => crate::front_end::fanuc::reference::second(word)?,
                b'P' if sense.local => start = Some(*word),
                b'Q' if sense.call => start = Some(*word),
                b'H' if sense.call && self.kind == Kind::Mitsubishi => start = Some(*word),
                b'r' if sense.tap && self.kind == Kind::Mitsubishi => rigid(ex, word)?,
                b'Q' if sense.set_offset => ex.words.put(b'Q', word.value, word.span)?,
                b'c' | b'r' => self.corner_word(word, value)?,
                b'C' | b'R' | b'I' | b'K' if self.is_corner(word, &sense) => {
                    let length = Said { letter: b'r', ..*word };
                    let value = self.scaled(ex, &length);
                    self.corner_word(word, value)?;
                }
                b'P' if sense.call || sense.back || sense.more_offsets || sense.set_offset => {
                    p = Some(*word);
                }
                b'P' if sense.dwell || sense.cycle => {
                    let seconds = self.kind == Kind::Haas && !word.counts;
                    if !word.counts && word.value.fract() != 0.0 && !seconds {
                        let text = format!(
                            "P counts milliseconds, without a point, found P{}",
                            word.value
                        );
                        return refuse("I1020", word.span, text);
                    }
                    let unit = if seconds { 1.0 } else { self.increments.per_unit() };
                    ex.words.put(b'P', word.value / unit, word.span)?;
                }
                b'X' | b'U' if sense.dwell => {
                    let seconds = if word.counts && !self.calculator {
                        word.value / self.increments.per_unit()
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
                    let lead = self.feed(word, &sense);
                    self.lead = Some(lead);
                }
                b'F' => {
                    let feed = self.feed(word, &sense);
                    ex.words.put(b'F', feed, word.span)?;
                }
                b'S' if sense.position => {
                    self.top_speed = Some(word.value);
                    sense.surface_speed |= ex.modes.spindle.constant_surface_speed;
                }
                b'T' if self.is_lathe() => self.turret(ex, word, sense)?,
                b'U' | b'V' | b'W' | b'H' if self.is_lathe() && !sense.set_offset => {
                    let (letter, axis) = match word.letter {
                        b'U' => (b'X', 0),
                        b'V' => (b'Y', 1),
                        b'W' => (b'Z', 2),
                        _ => (b'C', 5),
                    };
                    let turn = Said { letter: b'C', ..*word };
                    let value = if axis == 5 { self.scaled(ex, &turn) } else { value };
                    let from = if ex.modes.incremental { 0.0 } else { self.stands(ex, axis) };
                    let from = if axis == 0 && ex.modes.diameter { 2.0 * from } else { from };
                    self.once.by_w |= axis == 2;
                    ex.words.by_increments = true;
                    ex.words.put(letter, from + value, word.span)?;
                }
                b'I' | b'J' if sense.tap => ex.words.put(word.letter, word.value, word.span)?,
                letter => ex.words.put(letter, value, word.span)?,
            }
        }
        self.codes(ex, said, &sense)?;
        if self.once.longer != 0 {
            self.lengthen(ex, said, &sense)?;
        }
        if !(sense.dwell || sense.zone) {
            self.words_on_surface(ex)?;
        }
        if !(sense.dwell || sense.set_offset) {
            self.map(ex, sense.cycle)?;
        }
        self.accept(ex, &sense)?;
        self.complete(ex, &sense)?;
        self.numbers(ex, &sense, p, l, start)
    }

    fn codes(&mut self, ex: &mut Executor, said: &[Said], sense: &Sense) -> Outcome {
        let mut mapped = Vec::new();
        for word in said {
            let span = word.span;
            match word.letter {
                b'G' => match tenths(word.value).map(|code| (code, meaning(self.kind, code))) {
                    Some((_, Meaning::Shared(920))) if sense.position => {}
                    Some((_, Meaning::Shared(541 | 100) | Meaning::Smoothing)) => {}
                    Some((_, Meaning::Shared(540))) if sense.more_offsets => {}
                    Some((_, Meaning::WorkOffset(number))) => {
                        self.once.system = Some(9 + self.more_offsets(u32::from(number), span)?);
                    }
                    Some((_, Meaning::Smoothness)) => ex.words.take_g(64.0, span)?,
                    Some((_, Meaning::ExactBlock)) => self.once.exact = true,
                    Some((_, Meaning::Back)) => self.once.back = true,
                    Some((_, Meaning::Check)) => {
                        self.once.check = true;
                        ex.words.take_g(0.0, span)?;
                    }
                    Some((_, Meaning::Cylinder)) => self.unroll(ex, said)?,
                    Some((_, Meaning::Face(on))) => self.face(ex, said, on)?,
                    Some((_, Meaning::Longer(by))) => self.once.longer = by,
                    Some((_, Meaning::StrokeCheck(on))) => self.set_stroke_check(ex, on)?,
                    Some((_, Meaning::Skip)) => {
                        self.once.skip = true;
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
                    Some(6) if self.is_lathe() && said.iter().any(|s| s.letter == b'T') => {}
                    _ if ex.words.is_own_m(word.value)
                        && !is_shared_m_word(self.kind, word.value) =>
                    {
                        ex.words.take_own_m(word.value, span)?;
                    }
                    Some(number @ 0..=60) if is_shared_m(self.kind, number as u16) => {
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

    /// P and L where they are numbers of something.
    fn numbers(
        &mut self,
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
            return self.set_offset(ex, number, times).map(|()| Then::Next);
        }
        if sense.more_offsets {
            self.once.system = Some(9 + self.more_offsets(number.unwrap_or(0), span)?);
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
        match (self.called.or(number), times) {
            (None, times) if start.is_some() && !in_file => call(None, times.unwrap_or(1)),
            (None, _) if sense.local => {
                refuse("I0302", span, "M97 needs P, the number N of the block where it begins")
            }
            (None, _) if in_file => {
                refuse("I0302", span, "M198 needs P, the number of the program")
            }
            (None, _) => refuse("I0302", span, "M98 needs P, the number of the program"),
            (Some(number), Some(times)) => call(Some(number), times),
            // P51002: five times O1002
            (Some(both), None) if self.called.is_none() && both > 9999 => {
                call(Some(both % 10_000), both / 10_000)
            }
            (Some(number), None) => call(Some(number), 1),
        }
    }

    /// The work offset beyond G59 with this number.
    fn more_offsets(&self, number: u32, span: Span) -> Outcome<u8> {
        if self.mapping.changes() {
            let text = "G54.1 cannot be used while G51, G51.1 or G68 is in force";
            return refuse("I1045", span, text);
        }
        let code = if self.kind == Kind::Haas { "G154" } else { "G54.1" };
        let last = self.kind.last_offset();
        match u8::try_from(number) {
            Ok(number) if number > 0 && u32::from(number) <= last => Ok(number),
            _ => refuse("I1021", span, format!("{code} takes P1 to P{last}")),
        }
    }

    pub(crate) fn warn_of_points(&mut self, ex: &mut Executor, said: &[Said]) {
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
        let unit = match (word.letter, self.inch) {
            (b'A'..=b'C', _) => "degrees",
            (_, true) => "inch",
            _ => "mm",
        };
        let text = format!("{letter}{number} without a point is {} {unit}", self.scaled(ex, word));
        let help = format!(
            "write {letter}{number}. for {number} {unit}; if the machine counts whole units without a point, say so with --decimal-point calculator. Said once"
        );
        ex.remarks.push(Diagnostic::warning("I1023", word.span, text).with_help(help));
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
