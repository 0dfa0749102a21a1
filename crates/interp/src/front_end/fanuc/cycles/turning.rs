//! The lathe's multiple cycles along a profile of the tape: G70 to G73, in two lines each.
//!
//! ```text
//!   G71 U(depth) R(retract)               the first line sets what the second uses, and holds until it is set anew
//!   G71 P(first) Q(last) U(X) W(Z) F      profile: the blocks N first to N last; U and W are left on it
//!   G72 W(depth) R(retract)               the same, with passes along X
//!   G73 U(X) W(Z) R(times)                the profile so many times, from that far away
//!   G70 P(first) Q(last)                  along it once, with the feeds of its own blocks
//! ```
//!
//! The older form says all in one line: `G71 P Q U W D(depth)`, `G73 P Q I(X) K(Z) D(times) U W`.
//! It comes away by what a first line has said, else by 0.5 mm.
//!
//! The profile's blocks are taken down (`profile`), not moved along. After G71 to G73 the program
//! goes on behind them, after G70 behind its own block.
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "Multiple repetitive cycles".
use crate::{
    call::{Sink, out::Out},
    codes::number::{near_whole, tenths},
    cycles::turning,
    dialect::fanuc::codes::{Meaning, meaning},
    execute::{self, refused},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        calls::block_at,
        cycles::{
            grooving::pecking,
            growing::{growing_thread, grows_on},
            lengths::{across, long, word},
            threading::thread_passes,
        },
        state::{Fanuc, Said, Shape},
        words::translate,
    },
    motion,
    profile::{
        recording::{ProfileOrder, Recording},
        roughing::{Manner, Part, Roughing},
    },
    program::Program,
};
use canon::Plane;
use diag::Diagnostic;

/// More repetitions of a pattern than this are a slip of the pen.
const MAX_TIMES: u32 = 1_000;

/// How far a pass of the older form comes away, mm.
const AWAY_MM: f64 = 0.5;

/// The letters that a cycle takes, in both of its forms.
const fn takes(code: u16) -> &'static [u8] {
    match code {
        34 => b"GFSTMXZUWKQ",
        70 => b"GFSTMPQ",
        71..=73 => b"GFSTMPQUWRDIK",
        74 | 75 => b"GFSTMXZUWPQRIKD",
        _ => b"GFSTMXZUWPQRIKDA",
    }
}

/// Refuses a call, and a return, between the blocks of a profile: the control takes down no blocks
/// but those that stand there.
pub(crate) fn no_call_in_profile(fanuc: &Fanuc, it: &mut Program<'_>) -> Outcome {
    let own = &it.executor.settings.macro_calls;
    let calls = |said: &&Said| match (said.letter, tenths(said.value)) {
        (b'M', Some(980 | 990 | 1980)) => true,
        (b'G', Some(code)) => matches!(code, 650 | 660 | 661),
        _ => own.iter().any(|call| {
            let number = call.number.map(f64::from);
            char::from(said.letter) == call.letter && number.is_none_or(|n| n == said.value)
        }),
    };
    let Some(said) = fanuc.said.iter().find(calls) else { return Ok(()) };
    let written = format!("{}{}", char::from(said.letter), said.value);
    it.ended |= (said.letter, said.value) == (b'M', 99.0);
    let text = format!("{written} cannot stand inside a profile: no subprogram is followed there");
    let help = "write the moves themselves between the first and the last block of the profile";
    Err(error("I1033", said.span, text).with_help(help).into())
}

/// G70 to G76, G34 of the block at hand, on a lathe, as system B numbers them.
pub(crate) fn multiple_cycle(fanuc: &Fanuc) -> Option<u16> {
    let code = |said: &Said| match meaning(fanuc.kind, tenths(said.value)?) {
        Meaning::Multiple(code) => Some(code / 10),
        _ => None,
    };
    if !fanuc.is_lathe() {
        return None;
    }
    let said = fanuc.said.iter().filter(|said| said.letter == b'G').find_map(code);
    said.or_else(|| grows_on(fanuc).then_some(34))
}

/// Execute it: its F, S, T and M first.
pub(crate) fn multiple<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    code: u16,
    out: &mut Out<'_, S>,
) -> Outcome {
    let said = core::mem::take(&mut fanuc.said);
    let (span, own) = (it.block.span, fanuc.kind.own(code));
    if it.executor.recording.is_some() {
        it.ended = true;
        return refuse("I1033", span, format!("G{own} cannot stand inside a profile"));
    }
    if it.executor.modes.plane != Plane::ZX {
        return refuse("I0581", span, format!("G{own} works in X and Z: write G18 before"));
    }
    let threads = matches!(code, 34 | 76);
    let beside = |said: &&Said| match said.letter {
        letter if code == 70 && !takes(code).contains(&letter) => false,
        b'F' => !threads,
        b'G' => said.value != f64::from(own),
        letter => b"STM".contains(&letter),
    };
    let idle = said.iter().find(|said| !takes(code).contains(&said.letter));
    if let Some(idle) = idle.filter(|_| code == 70) {
        let text = format!("{} has no effect in G{own}, and is left out", idle.letter as char);
        let remark = Diagnostic::warning("I0113", idle.span, text).with_help(
            "a profile is finished as it is: the words of its roughing are none of G70's",
        );
        it.executor.remarks.push(remark);
    } else if let Some(idle) = idle {
        let text = format!("{} has no effect in G{own}", idle.letter as char);
        return refuse("I0110", idle.span, text);
    }
    fanuc.said = said.iter().filter(beside).copied().collect();
    it.executor.words.begin(&it.block);
    translate(fanuc, &mut it.executor)?;
    it.executor.modes.motion = crate::modes::Motion::None;
    execute::execute(&mut it.executor, out)?;
    it.executor.modes.motion = crate::modes::Motion::Rapid;
    (fanuc.lathe_cycle, fanuc.growing) = (None, false);
    match code {
        70..=73 if word(&said, b'P').is_some() => profile_cycle(fanuc, it, code, &said),
        70 => refuse(
            "I1030",
            span,
            format!("G{own} needs P and Q: the first and the last block of the profile"),
        ),
        71..=73 => first_line(fanuc, it, code, &said),
        74 | 75 => pecking(fanuc, it, code, &said, out),
        76 => thread_passes(fanuc, it, &said, out),
        _ => growing_thread(fanuc, it, &said, out),
    }
}

fn first_line(fanuc: &mut Fanuc, it: &Program<'_>, code: u16, said: &[Said]) -> Outcome {
    let (span, own) = (it.block.span, fanuc.kind.own(code));
    let [u, w, r] = [b'U', b'W', b'R'].map(|letter| long(fanuc, it, said, letter));
    if code == 73 {
        if let Some(times) = word(said, b'R') {
            let whole = near_whole(times.value).and_then(|n| u32::try_from(n).ok());
            let Some(times) = whole.filter(|n| (1..=MAX_TIMES).contains(n)) else {
                let text = format!(
                    "R is how often G{own} repeats, 1 to {MAX_TIMES}, found {}",
                    times.value
                );
                return refuse("I1031", span, text);
            };
            fanuc.first_lines.times = Some(times);
        }
        // both are radii
        let [z, x] = fanuc.first_lines.relief;
        fanuc.first_lines.relief = [w.unwrap_or(z), u.unwrap_or(x)];
        return Ok(());
    }
    if let Some(depth) = if code == 71 { u } else { w } {
        if depth <= 0.0 {
            let letter = if code == 71 { 'U' } else { 'W' };
            let text =
                format!("{letter} is the depth of each pass of G{own}, above 0, found {depth}");
            return refuse("I1031", span, text);
        }
        fanuc.first_lines.depth = Some(depth);
    }
    match r {
        Some(retract) if retract < 0.0 => {
            let text =
                format!("R is how far a pass of G{own} comes away, 0 or more, found {retract}");
            refuse("I1031", span, text)
        }
        retract => {
            fanuc.first_lines.retract = retract.unwrap_or(fanuc.first_lines.retract);
            Ok(())
        }
    }
}

/// The second line: take the profile down.
fn profile_cycle(fanuc: &mut Fanuc, it: &mut Program<'_>, code: u16, said: &[Said]) -> Outcome {
    let (span, own) = (it.block.span, fanuc.kind.own(code));
    let order = order(fanuc, it, code, said)?;
    let number = |letter: u8| {
        let value = word(said, letter).map(|said| said.value);
        value.and_then(near_whole).and_then(|n| u32::try_from(n).ok())
    };
    let (Some(first), Some(last)) = (number(b'P'), number(b'Q')) else {
        let text = format!("G{own} needs P and Q: the first and the last block of the profile");
        return refuse("I1030", span, text);
    };
    motion::check_cycle_feed(&it.executor.words, &it.executor.modes, own)?;
    let mut missing = None;
    let [begin, end] = [first, last].map(|n| {
        let at = block_at(fanuc, it, n);
        missing = missing.or(at.is_none().then_some(n));
        at
    });
    let (Some(begin), None, Some(_)) = (begin, missing, end) else {
        let number = missing.unwrap_or(last);
        if stands_in(it.sources[it.file], number) {
            refused::forget_blocks(&mut it.executor.modes); // it cannot be read, which is told there
        }
        let text = format!("there is no block N{number} in this program");
        let fault = error("I1032", span, text);
        return Err(fault.with_help("P and Q name the profile's first and last block").into());
    };
    let behind = it.parsers[it.file].position();
    let begin = begin.at; // the profile lies in the cycle's own program
    let back = (code == 70 || begin.0 < span.start).then_some(behind);
    fanuc.shape = Some(Shape { last, back, cycle: span.start });
    let mut recording = Recording::new(order, it.executor.words.place, it.executor.modes.at);
    recording.faults = it.faults;
    it.executor.recording = Some(Box::new(recording));
    it.jump(begin);
    Ok(())
}

fn order(fanuc: &Fanuc, it: &Program<'_>, code: u16, said: &[Said]) -> Outcome<ProfileOrder> {
    let left =
        [long(fanuc, it, said, b'W').unwrap_or(0.0), across(fanuc, it, said, b'U').unwrap_or(0.0)];
    let missing = |what: &str| {
        let own = fanuc.kind.own(code);
        let fault = error("I1031", it.block.span, format!("G{own} does not know {what}"));
        let (words, are) = match code {
            71 => ("U2. R0.5", "the depth of a pass and how far it comes away"),
            72 => ("W2. R0.5", "the depth of a pass and how far it comes away"),
            _ => ("U5. W5. R3", "how far away it begins, and how often it is cut"),
        };
        fault.with_help(format!("write a line G{own} {words} before it: {are}"))
    };
    if code == 70 {
        return Ok(ProfileOrder::Along);
    }
    if code == 73 {
        let times = match word(said, b'D') {
            Some(d) => near_whole(d.value).and_then(|n| u32::try_from(n).ok()),
            None => fanuc.first_lines.times,
        };
        let Some(times) = times.filter(|n| (1..=MAX_TIMES).contains(n)) else {
            return Err(missing("how often it repeats").into());
        };
        let [z, x] = fanuc.first_lines.relief;
        let one_line = [b'K', b'I'].map(|letter| long(fanuc, it, said, letter));
        let relief = [one_line[0].unwrap_or(z), one_line[1].unwrap_or(x)];
        return Ok(ProfileOrder::Repeat { relief, shift: left, times });
    }
    let depth = long(fanuc, it, said, b'D');
    let Some(step) = depth.filter(|d| *d > 0.0).or(fanuc.first_lines.depth) else {
        return Err(missing("how deep a pass is").into());
    };
    let away = AWAY_MM / it.executor.modes.units.in_mm();
    let unset = depth.is_some() && fanuc.first_lines.depth.is_none();
    let retract = if unset { away } else { fanuc.first_lines.retract };
    let how = Roughing { part: Part::All, step, retract, manner: Manner::Fanuc };
    Ok(ProfileOrder::Shifted { across: code == 72, shift: left, how })
}

/// After each block: was it the profile's last?
pub(crate) fn end_of_shape<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(shape) = fanuc.shape else { return Ok(()) };
    let here = it.block.number.map(|number| number as u32);
    if here != Some(shape.last) || it.block.span.start == shape.cycle {
        return Ok(());
    }
    fanuc.shape = None;
    let Some(recording) = it.executor.recording.take() else { return Ok(()) };
    it.executor.modes.at = recording.start;
    if let Some(back) = shape.back {
        it.jump(back);
    }
    if recording.faults != it.faults {
        return Ok(());
    }
    turning::cut_profile(
        &mut it.executor.words,
        &mut it.executor.modes,
        (&it.executor.settings, &mut it.executor.tools),
        &recording,
        out,
    )
}

/// Whether a line of the text begins with N and this number, readable or not.
fn stands_in(text: &[u8], number: u32) -> bool {
    text.split(|byte| *byte == b'\n').any(|line| {
        let Some((b'N' | b'n', rest)) = line.trim_ascii_start().split_first() else { return false };
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let written = core::str::from_utf8(&rest[..digits]).ok();
        written.and_then(|digits| digits.parse().ok()) == Some(number)
    })
}
