//! What the codes of a block make of its other words: P of a dwell is a time, P of a call a
//! program.
use crate::{
    codes::number::tenths,
    dialect::fanuc::{
        codes::{Meaning, meaning},
        counts::gears_hob,
    },
    fault::Outcome,
    front_end::fanuc::{
        mapping::incremental,
        state::{Fanuc, Said},
    },
    modes::{FeedMode, Motion},
    state::executor::Executor,
};
use diag::Diagnostic;

/// What the block's codes make of its other words.
#[allow(clippy::struct_excessive_bools)] // each is a fact of its own about the block
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sense {
    pub(crate) dwell: bool,
    pub(crate) cycle: bool,
    pub(crate) thread: bool,
    pub(crate) set_offset: bool,
    /// A tapping cycle: its I and J are no lengths.
    pub(crate) tap: bool,
    /// G92, G50.
    pub(crate) position: bool,
    /// G54.1; G54 with P.
    pub(crate) more_offsets: bool,
    /// G5, G5.1, G8: P, Q, R say how motion is smoothed.
    pub(crate) smoothing: bool,
    /// A straight feed, and nothing that takes its words away.
    pub(crate) feed: bool,
    /// G7.1, G22, G23: its words are no places.
    pub(crate) zone: bool,
    /// G30.
    pub(crate) reference: bool,
    /// M98, M198, M99.
    pub(crate) call: bool,
    pub(crate) in_file: bool,
    /// M97 of Haas: P is a block of this program.
    pub(crate) local: bool,
    /// G187 of Haas: P and E say how corners are taken.
    pub(crate) smoothness: bool,
    pub(crate) back: bool,
    pub(crate) surface_speed: bool,
    pub(crate) per_revolution: bool,
    pub(crate) motion: bool,
    pub(crate) spindle: bool,
    /// G81 that gears the work to the hob.
    pub(crate) hobbing: bool,
    /// M19.
    pub(crate) orient: bool,
}

/// What the codes of the block say about the other words.
pub(crate) fn sense(fanuc: &mut Fanuc, ex: &Executor, said: &[Said]) -> Sense {
    let mut sense = Sense {
        cycle: matches!(ex.modes.motion, Motion::Cycle(_)),
        tap: matches!(ex.modes.motion, Motion::Cycle(cycle) if cycle.tap_sense().is_some()),
        thread: ex.modes.motion == Motion::Thread,
        feed: in_force(ex) == Motion::Feed,
        per_revolution: ex.modes.feed_mode == FeedMode::PerRevolution,
        ..Sense::default()
    };
    let mut plain_offset = false;
    for word in said.iter().filter(|word| matches!(word.letter, b'G' | b'M')) {
        match (word.letter, tenths(word.value)) {
            (b'G', Some(code)) => match meaning(fanuc.kind, code) {
                Meaning::Shared(40) => sense.dwell = true,
                Meaning::Shared(100) => sense.set_offset = true,
                Meaning::Shared(920) => sense.position = said.iter().any(|s| s.letter == b'S'),
                Meaning::Shared(541) => sense.more_offsets = true,
                Meaning::Shared(540) => {
                    plain_offset = said.iter().any(|s| s.letter == b'P');
                }
                Meaning::Shared(300) => sense.reference = true,
                Meaning::Smoothing => sense.smoothing = true,
                Meaning::Smoothness => sense.smoothness = true,
                Meaning::Skip | Meaning::Check => {
                    (sense.motion, sense.cycle) = (true, false);
                    fanuc.growing = false;
                }
                Meaning::StrokeCheck(_) | Meaning::Cylinder => {
                    (sense.zone, sense.cycle) = (true, false);
                }
                Meaning::Shared(960) => sense.surface_speed = true,
                Meaning::Shared(code @ (940 | 950)) => sense.per_revolution = code == 950,
                Meaning::Shared(code @ (0..=30 | 730..=890 | crate::codes::OWN..)) => {
                    sense.motion = true;
                    sense.feed = code == 10;
                    sense.cycle = code >= 730 && code != 800;
                    sense.tap = matches!(code, 740 | 840 | 842 | 843);
                    sense.thread = false;
                    (fanuc.lathe_cycle, fanuc.growing) = (None, false);
                }
                Meaning::Thread => {
                    (sense.motion, sense.cycle, sense.thread) = (true, false, true);
                    (fanuc.lathe_cycle, fanuc.growing) = (None, false);
                }
                Meaning::Box(code) => {
                    (sense.motion, sense.cycle) = (true, false);
                    (fanuc.lathe_cycle, fanuc.growing) = (Some(code), false);
                    fanuc.corner = None;
                    sense.thread = code == 780;
                }
                _ => {}
            },
            (b'M', Some(code @ (980 | 1980))) => {
                (sense.call, sense.in_file) = (true, code == 1980);
            }
            (b'M', Some(970)) if fanuc.kind.variant().calls_by_m97 => {
                (sense.call, sense.local) = (true, true);
            }
            (b'M', Some(990)) => sense.back = true,
            (b'M', Some(code @ (30 | 40 | 50 | 190))) => {
                (sense.spindle, sense.orient) = (true, code == 190);
            }
            _ => {}
        }
    }
    if sense.cycle && gears_hob(&fanuc.letters) {
        (sense.hobbing, sense.cycle) = (true, false);
    }
    sense.thread |= fanuc.lathe_cycle == Some(780);
    let other = sense.dwell || sense.set_offset || sense.position || sense.reference || sense.zone;
    sense.feed &= !(other || sense.thread || sense.call);
    // P of G54 belongs to what else the block orders
    sense.more_offsets |= plain_offset && !(sense.call || sense.dwell || sense.cycle);
    sense
}

/// Words that the shared codes need and Fanuc leaves out.
pub(crate) fn complete(fanuc: &mut Fanuc, ex: &mut Executor, sense: &Sense) -> Outcome {
    let span = ex.words.place.span;
    if sense.cycle
        && ex.words.get(b'P').is_none()
        && ex.modes.sticky.is_none_or(|s| s.dwell.is_none())
    {
        let waits = matches!(ex.words.g(crate::codes::GGroup::Motion), Some(820 | 860 | 880 | 890));
        if waits {
            ex.words.put(b'P', 0.0, span)?;
        }
    }
    if fanuc.kind.variant().cycles_without_r && sense.cycle {
        level_where_it_stands(ex)?;
    }
    if sense.thread
        && fanuc.lathe_cycle.is_none()
        && let Some(lead) = fanuc.lead.filter(|_| ex.words.any(crate::codes::AXES))
    {
        ex.words.put(b'K', lead, span)?;
    }
    if ex.words.m(crate::codes::MGroup::Spindle) == Some(19) && ex.words.get(b'R').is_none() {
        ex.words.put(b'R', 0.0, span)?;
    }
    if sense.surface_speed {
        if ex.words.get(b'S').is_none() {
            ex.words.put(b'S', ex.modes.spindle.speed, span)?;
        }
        if ex.words.g(crate::codes::GGroup::SpindleMode).is_none() {
            ex.words.take_g(96.0, span)?;
        }
        if let Some(top) = fanuc.top_speed {
            ex.words.put(b'D', top, span)?;
        }
    }
    Ok(())
}

/// A cycle of Haas' without R, where none before it has one: it feeds from where the tool stands.
fn level_where_it_stands(ex: &mut Executor) -> Outcome {
    let kept = ex.modes.sticky.is_some() && matches!(ex.modes.motion, Motion::Cycle(_));
    if kept || ex.words.get(b'R').is_some() || !ex.words.any(crate::codes::AXES) {
        return Ok(());
    }
    let span = ex.words.place.span;
    let normal = ex.modes.plane.normal().index();
    let level = if incremental(ex) { 0.0 } else { ex.modes.at[normal] };
    ex.words.put(b'R', level, span)?;
    let letter = char::from(b"XYZ"[normal]);
    let at = crate::codes::spelling::short(ex.modes.at[normal]);
    let text = format!("no R: the cycle feeds from where the tool stands, {letter}{at}");
    let remark = Diagnostic::warning("I1064", span, text);
    ex.remarks.push(remark.with_help("write R, the level just above the work"));
    Ok(())
}

/// The motion in force: a profile that is taken down has its own.
pub(crate) fn in_force(ex: &Executor) -> Motion {
    ex.recording.as_ref().map_or(ex.modes.motion, |recording| recording.motion())
}
