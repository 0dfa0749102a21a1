//! What other controls take in another way than this one, or without effect: done as far as it can
//! be, and remarked upon.
use crate::{
    call::{Call, Sink, out::Out},
    codes::{GGroup, Letters, MGroup, set},
    fault::{Outcome, refuse, unknown::Unknown},
    modes::Motion,
    state::executor::Executor,
    words::Words,
};

/// The machine's feed, where a program has said none.
pub(crate) fn assume_feed<S: Sink>(
    ex: &mut Executor,
    motion: Option<Motion>,
    out: &mut Out<'_, S>,
) {
    let needs = motion.is_some_and(|motion| !matches!(motion, Motion::Rapid | Motion::None));
    let modes = &mut ex.modes;
    let Some(feed) = ex.settings.leaves.feed.filter(|_| needs && modes.feed == 0.0) else { return };
    if modes.feed_mode != crate::modes::FeedMode::PerMinute {
        return;
    }
    let rate = feed.in_mm_per_min() / modes.units.in_mm();
    modes.feed = rate;
    out.say(&Call::FeedRate { rate, duration_s: None });
    if modes.unknown.has(Unknown::FEED) {
        return; // a refused block has the F
    }
    let text =
        format!("no F before this move: it goes with F{}", crate::codes::spelling::short(rate));
    ex.remarks.push(
        diag::Diagnostic::warning("I0324", ex.words.place.span, text)
            .with_help("feed_mm_per_min under [control.programs] of the machine's file says so"),
    );
}

/// M4 of a program that was made for a laser.
pub(crate) fn remark_on_laser(ex: &mut Executor) {
    if ex.words.m(MGroup::Spindle) != Some(4) || ex.idle_told & set("M") != 0 {
        return;
    }
    ex.idle_told |= set("M");
    let text = "M4 turns a spindle counter-clockwise here; to a laser it means power that follows the speed";
    ex.remarks.push(diag::Diagnostic::note("I0647", ex.words.place.span, text).with_help(
        "Leadscrew does not simulate lasers; a spindle turns clockwise with M3. Said once",
    ));
}

/// `G4 S2`: seconds where no P stands.
pub(crate) fn dwell_by_s(ex: &mut Executor) -> Outcome {
    if ex.words.g(GGroup::NonModal) != Some(40) || ex.words.get(b'P').is_some() {
        return Ok(());
    }
    let span = ex.words.span(b'S');
    let Some(seconds) = ex.words.take(b'S') else { return Ok(()) };
    ex.words.put(b'P', seconds, span)?;
    if ex.idle_told & set("S") == 0 {
        ex.idle_told |= set("S");
        let text = format!("S of G4 is read as a wait of {seconds} s, as Marlin has it");
        let remark = diag::Diagnostic::warning("I0648", span, text);
        ex.remarks.push(remark.with_help("Grbl itself takes P. Said once"));
    }
    Ok(())
}

/// N of a block that these controls take.
pub(crate) fn block_number(words: &Words) -> Outcome {
    const HIGHEST: u32 = 9_999_999;
    let Some(number) = words.place.number.filter(|number| *number > HIGHEST) else { return Ok(()) };
    let text = format!("N{number} is too high: Grbl and grblHAL take N0 to N{HIGHEST} (error 27)");
    refuse("I0436", words.place.span, text)
}

/// Codes that are executed, and that the controls of this dialect do not have.
pub(crate) fn remark_on_lacking(ex: &mut Executor) {
    let lacks = ex.settings.rules.lacks;
    for (i, code) in lacks.iter().enumerate() {
        if !ex.words.has_g(*code) || ex.lack_told & 1 << i != 0 {
            continue;
        }
        ex.lack_told |= 1 << i;
        let text = format!(
            "neither Grbl 1.1 nor grblHAL has G{}: they answer error 20",
            crate::codes::spelling::written(*code)
        );
        let remark = diag::Diagnostic::warning("I0115", ex.words.place.span, text);
        ex.remarks.push(remark.with_help("it is executed here as LinuxCNC does. Said once"));
    }
}

/// The end of a scaling that has not begun.
pub(crate) fn remark_on_scaling(ex: &mut Executor, span: diag::Span) {
    if ex.idle_told & set("G") != 0 {
        return;
    }
    ex.idle_told |= set("G");
    let text = "G50 has no effect here, and is left out";
    ex.remarks.push(
        diag::Diagnostic::warning("I0113", span, text)
            .with_help("it ends a scaling, which this dialect does not begin. Said once"),
    );
}

/// Two codes of one group: the manuals say that the last of them is valid.
pub(crate) fn remark_on_outdone(ex: &mut Executor) {
    let Some((other, code, span)) = ex.words.outdone.take().filter(|(a, b, _)| a != b) else {
        return;
    };
    let [other, code] = [other, code].map(crate::codes::spelling::written);
    let text = format!("G{other} has no effect beside G{code}: of one group the last acts");
    ex.remarks.push(
        diag::Diagnostic::warning("I0114", span, text)
            .with_help("write one of them, or two blocks: other controls stop here with an alarm"),
    );
}

/// Words that the dialect takes without effect.
pub(crate) fn drop_idle(ex: &mut Executor, modal: Letters) {
    let Some((letter, span)) = ex.words.drop_idle(ex.settings.rules.idle, modal) else { return };
    if ex.idle_told & set(letter.encode_utf8(&mut [0; 4])) != 0 {
        return;
    }
    ex.idle_told |= set(letter.encode_utf8(&mut [0; 4]));
    let text = format!("{letter} has no effect here, and is left out");
    ex.remarks.push(
        diag::Diagnostic::warning("I0113", span, text)
            .with_help("no code of this block takes it. Said once for each letter"),
    );
}
