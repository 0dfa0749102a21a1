//! A block's words with their values: variables read, increments counted.
use crate::{
    codes::number::tenths,
    dialect::fanuc::counts::counts,
    fault::Outcome,
    front_end::fanuc::{
        state::{Fanuc, Said},
        variables::values::{rounded, values_in},
        words::sense::Sense,
    },
    program::Program,
    state::executor::Executor,
};
use diag::Diagnostic;
use gcode::{Block, Value};

/// Evaluate the block's words; those without a value vanish.
#[inline]
pub(crate) fn read(fanuc: &mut Fanuc, it: &Program<'_>) -> Outcome {
    read_words(fanuc, &it.block, it.sources[it.file], &it.executor)
}

#[inline]
pub(crate) fn read_words(
    fanuc: &mut Fanuc,
    block: &Block,
    source: &[u8],
    ex: &Executor,
) -> Outcome {
    let mut said = core::mem::take(&mut fanuc.said);
    said.clear();
    fanuc.inch = counts_inches(fanuc, block, ex);
    for word in &block.words {
        let value = match word.value {
            Value::Number(number) => Some(number),
            value @ Value::Expression(_) => {
                let per_unit = per_unit(fanuc, word.letter, fanuc.inch);
                let values = values_in(fanuc, ex, per_unit);
                let value = values.value(block, value, word.span)?;
                value.map(|value| if per_unit > 1.0 { rounded(value, per_unit) } else { value })
            }
        };
        let Some(value) = value else { continue };
        fanuc.kept.word(word.letter, value);
        let text = source.get(word.span.start as usize..word.span.end as usize);
        // a number in brackets is an expression, in which numbers are whole units
        let is_meant = |text: &[u8]| text.contains(&b'.') || text.contains(&b'[');
        let counts = matches!(word.value, Value::Number(_)) && !text.is_some_and(is_meant);
        said.push(Said { letter: word.letter, value, counts, span: word.span });
    }
    let mut words = core::mem::take(&mut fanuc.letters);
    words.clear();
    if said.iter().any(|word| word.letter == b'G' || word.letter == b'M') {
        words.extend(said.iter().map(|word| (word.letter, word.value)));
        let counted = said.iter_mut().filter(|word| word.counts);
        for word in counted.filter(|word| b"HLPQRT".contains(&word.letter)) {
            word.counts = !counts(fanuc.kind, &words, word.letter);
        }
    }
    fanuc.letters = words;
    fanuc.said = said;
    Ok(())
}

/// Whether the block counts inches: its own G20 and G21 hold for it.
pub(crate) fn counts_inches(fanuc: &Fanuc, block: &Block, ex: &Executor) -> bool {
    let own = block.words.iter().find_map(|word| match (word.letter, word.value) {
        (b'G', Value::Number(number)) => match fanuc.kind.common(tenths(number)?) {
            Some(200) => Some(true),
            Some(210) => Some(false),
            _ => None,
        },
        _ => None,
    });
    own.unwrap_or(ex.modes.units == crate::Units::Inch)
}

/// How many least input increments make one unit of what a letter counts; 1 for what counts itself.
#[inline]
pub(crate) fn per_unit(fanuc: &Fanuc, letter: u8, inch: bool) -> f64 {
    let per_unit = fanuc.increments.per_unit();
    match letter {
        b'A' | b'B' | b'C' | b'a' => per_unit,
        b'X'..=b'Z' | b'U'..=b'W' | b'I'..=b'K' | b'Q' | b'R' | b'c' | b'r' => {
            per_unit * if inch { 10.0 } else { 1.0 }
        }
        _ => 1.0,
    }
}

/// A value in the program's unit of length (or degrees): increments counted.
#[inline]
pub(crate) fn scaled(fanuc: &Fanuc, executor: &Executor, said: &Said) -> f64 {
    if !said.counts || fanuc.calculator {
        return said.value;
    }
    let angle = fanuc.mapping.is_angle(executor, said.letter);
    let face = said.letter == b'C' && fanuc.surface.is_some_and(|surface| surface.is_face());
    said.value / per_unit(fanuc, if face { b'R' } else { said.letter }, fanuc.inch && !angle)
}

#[inline]
pub(crate) fn feed(fanuc: &Fanuc, said: &Said, sense: &Sense) -> f64 {
    if !said.counts || fanuc.calculator {
        return said.value;
    }
    said.value
        / match (sense.per_revolution || sense.thread, fanuc.inch, fanuc.is_lathe()) {
            (false, false, _) => 1.0,
            (false, true, _) | (true, false, false) => 100.0,
            (true, true, false) | (true, false, true) => 10_000.0,
            (true, true, true) => 1_000_000.0,
        }
}

/// F of a thread: length per revolution.
pub(crate) fn thread_lead(fanuc: &Fanuc, said: &Said) -> f64 {
    feed(fanuc, said, &Sense { thread: true, ..Sense::default() })
}

#[inline]
pub(crate) fn warn_of_points(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said]) {
    if fanuc.warned_of_point || fanuc.calculator {
        return;
    }
    let axis = |s: &&Said| s.counts && s.value != 0.0 && b"XYZUVWABC".contains(&s.letter);
    let Some(word) = said.iter().find(axis) else { return };
    if said.iter().any(|s| s.letter == b'G' && matches!(s.value, 4.0 | 65.0 | 66.0)) {
        return;
    }
    fanuc.warned_of_point = true;
    let (letter, number) = (word.letter as char, word.value);
    let unit = match (word.letter, fanuc.inch) {
        (b'A'..=b'C', _) => "degrees",
        (_, true) => "inch",
        _ => "mm",
    };
    let text = format!("{letter}{number} without a point is {} {unit}", scaled(fanuc, ex, word));
    let help = format!(
        "write {letter}{number}. for {number} {unit}; if the machine counts whole units without a point, say so with --decimal-point calculator. Said once"
    );
    ex.remarks.push(Diagnostic::warning("I1023", word.span, text).with_help(help));
}

/// Q of a thread: thousandths of a degree, or degrees with a point.
pub(crate) fn start_angle(fanuc: &Fanuc, said: &[Said]) -> Option<f64> {
    said.iter()
        .find(|said| said.letter == b'Q')
        .map(|q| if q.counts && !fanuc.calculator { q.value / 1000.0 } else { q.value })
}
