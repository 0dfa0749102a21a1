//! G70, G71, G72 with the profile in a subprogram.
//!
//! | word | G70 | G71, G72 |
//! |---|---|---|
//! | Q | the subprogram | the subprogram |
//! | X Z | where the cycle begins | the same |
//! | D | distance of the first pass | what is left on the profile |
//! | E, P | distance of the last pass; passes | |
//! | I, R | | from level to level (1); how far a pass comes away (0.5) |
use crate::{
    call::{Call, Sink, out::Out},
    compensation::{self, beside},
    coordinates::target,
    cycles::record,
    fault::{Outcome, error, refuse},
    geometry::{
        frame::Point,
        offset_curve::{Flat, plus, times},
    },
    modes::{Modes, Motion},
    motion,
    profile::{
        parallel::parallel,
        recording::{ProfileOrder, Recording},
        roughing::{Manner, Part, Roughing, rough},
        shape::{Facing, Profile, ProfileMove, Unfit},
    },
    state::{
        executor::{Executor, Settings},
        tools::Tools,
    },
    words::Words,
};
use canon::Plane;

/// More passes than this are a slip of the pen.
const MAX_PASSES: f64 = 10_000.0;

/// G70 … G72.2: the tool goes to the begin, and the profile's blocks are taken down. Which
/// subprogram they are in.
pub(crate) fn turning<S: Sink>(ex: &mut Executor, tenths: u16, out: &mut Out<'_, S>) -> Outcome {
    let code = crate::codes::spelling::written(tenths);
    let span = ex.words.place.span;
    if ex.modes.plane != Plane::ZX {
        let text = format!("G{code} cuts a profile of X and Z: write G18 before");
        return refuse("I0581", span, text);
    }
    if tenths != 700 && ex.modes.compensating() {
        let text = format!("G{code} cannot be used with G41 or G42: roughing leaves material");
        let fault = error("I0582", span, text);
        return Err(fault.with_help("write G40 before it, and G42 before G70").into());
    }
    motion::check_cycle_feed(&ex.words, &ex.modes, code)?;
    if ex.words.get(b'Q').is_none() {
        let text = format!("G{code} needs Q, the number of the subprogram with the profile");
        return refuse("I0580", span, text);
    }
    let order = if tenths == 700 { finishing(&ex.words)? } else { roughing(&ex.words, tenths)? };
    let to = target::destination(&ex.words, &ex.modes, false)?;
    go_straight(&ex.words, &mut ex.modes, &ex.settings, true, &to, out)?;
    ex.recording = Some(Box::new(Recording::new(order, ex.words.place, to)));
    Ok(())
}

fn finishing(words: &Words) -> Outcome<ProfileOrder> {
    let passes = words.whole(b'P', 1_000)?.unwrap_or(1);
    if passes == 0 {
        return refuse("I0583", words.span(b'P'), "P counts passes: 1 or more");
    }
    let [first, last] = [b'D', b'E'].map(|letter| words.get(letter).unwrap_or(0.0));
    Ok(ProfileOrder::Finish { first, last, passes })
}

fn roughing(words: &Words, tenths: u16) -> Outcome<ProfileOrder> {
    let [step, retract] =
        [(b'I', 1.0), (b'R', 0.5)].map(|(letter, usual)| words.get(letter).unwrap_or(usual));
    if step <= 0.0 {
        let text = format!("I is the depth of each pass, above 0, found {step}");
        return refuse("I0583", words.span(b'I'), text);
    }
    if retract < 0.0 {
        let text = format!("R is how far a pass comes away, 0 or more, found {retract}");
        return refuse("I0583", words.span(b'R'), text);
    }
    let part = match tenths % 10 {
        1 => Part::FirstPocket,
        2 => Part::LaterPockets,
        _ => Part::All,
    };
    let how = Roughing { part, step, retract, manner: Manner::LinuxCnc };
    let leave = words.get(b'D').unwrap_or(0.0);
    Ok(ProfileOrder::Rough { across: tenths >= 720, leave, how })
}

/// The profile is known: cut it.
pub(crate) fn cut_profile<S: Sink>(
    words: &mut Words,
    modes: &mut Modes,
    (settings, tools): (&Settings, &mut Tools),
    recording: &Recording,
    out: &mut Out<'_, S>,
) -> Outcome {
    words.place = recording.place;
    out.place = recording.place;
    modes.at = recording.start;
    let Some(profile) = recording.profile() else {
        let text =
            "the profile has no moves: its first block leads to its begin, the others along it";
        return refuse("I0584", recording.place.span, text);
    };
    let start = [recording.start[2], recording.start[0]];
    let strokes = profile.and_then(|profile| match recording.order {
        ProfileOrder::Finish { first, last, passes } => {
            finish(start, &profile, first, last, passes)
        }
        ProfileOrder::Rough { across, leave, how } => roughed(start, &profile, across, leave, how),
        ProfileOrder::Along => Ok(recording.with_feeds(start)),
        ProfileOrder::Shifted { across, shift, how } => {
            let from = plus(start, shift);
            let shape = recording.without_withdrawal(profile, across).shifted(shift);
            let strokes = roughed(from, &shape, across, 0.0, how)
                .map_err(|why| why.shifted(times(shift, -1.0)))?;
            let back = (!strokes.is_empty()).then_some(ProfileMove::Rapid(start));
            Ok(strokes.into_iter().chain(back).collect())
        }
        ProfileOrder::Repeat { relief, shift, times } => {
            Ok(repeated(start, &profile, relief, shift, times))
        }
    });
    let strokes = match strokes {
        Ok(strokes) => strokes,
        Err(why) => return Err(record::unfit(words, modes, &why).into()),
    };
    if strokes.is_empty() {
        let text = format!("so small a depth would make more than {MAX_PASSES} passes");
        return refuse("I0583", recording.place.span, text);
    }
    modes.motion = Motion::Feed;
    for stroke in strokes {
        match stroke {
            ProfileMove::Side(code) => compensation::switch(words, modes, tools, code, out)?,
            stroke => cut(words, modes, settings, stroke, out)?,
        }
    }
    Ok(())
}

pub(crate) fn cut<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    stroke: ProfileMove,
    out: &mut Out<'_, S>,
) -> Outcome {
    let point = |at: &Point, [z, x]: Flat| -> Point {
        let mut to = *at;
        (to[0], to[2]) = (x, z);
        to
    };
    match stroke {
        ProfileMove::Rapid(to) => {
            go_straight(words, modes, settings, true, &point(&modes.at, to), out)
        }
        ProfileMove::Line(to) => {
            go_straight(words, modes, settings, false, &point(&modes.at, to), out)
        }
        ProfileMove::Arc { to, centre, turns } => {
            let to = point(&modes.at, to);
            if modes.compensating() {
                beside::arc_beside(words, modes, &to, centre, turns, out)?;
            } else {
                out.say(&Call::Arc { plane: Plane::ZX, to, centre, turns });
            }
            modes.at = to;
            Ok(())
        }
        ProfileMove::Feed(rate) => {
            modes.feed = rate;
            out.say(&Call::FeedRate { rate, duration_s: None });
            Ok(())
        }
        ProfileMove::Side(_) => Ok(()), // grooves have none
    }
}

fn go_straight<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    settings: &Settings,
    rapid: bool,
    to: &Point,
    out: &mut Out<'_, S>,
) -> Outcome {
    if modes.compensating() {
        beside::straight_beside(words, modes, settings, rapid, to, out)?;
    } else {
        out.say(&if rapid { Call::Rapid(*to) } else { Call::Line(*to) });
    }
    modes.at = *to;
    Ok(())
}

/// Along the profile, pass by pass, each from the start.
fn finish(
    start: Flat,
    profile: &Profile,
    first: f64,
    last: f64,
    passes: u32,
) -> Result<Vec<ProfileMove>, Unfit> {
    let along_z = Facing::of(profile, false);
    let one_way = profile.seen(along_z).parted().is_ok();
    let facing = if one_way { along_z } else { Facing::of(profile, true) };
    let (profile, start) = (profile.seen(facing), facing.to(start));
    let start = [start[0].min(profile.begin[0]), start[1]];
    let side = profile.side_of(start);
    let mut strokes = Vec::new();
    for pass in 1..=passes {
        let left = f64::from(passes - pass) / f64::from(passes);
        let beside = parallel(&profile, side * (last + left * (first - last)))
            .map_err(|why| why.seen_from(facing))?;
        strokes.extend([ProfileMove::Rapid(start), ProfileMove::Rapid(beside.begin)]);
        strokes.extend(beside.strokes());
    }
    Ok(strokes.into_iter().map(|stroke| facing.stroke(stroke)).collect())
}

/// The same way again and again, each time nearer.
fn repeated(
    start: Flat,
    profile: &Profile,
    relief: Flat,
    shift: Flat,
    count: u32,
) -> Vec<ProfileMove> {
    let mut strokes = Vec::new();
    for pass in 1..=count {
        let left = f64::from(count - pass) / f64::from((count - 1).max(1));
        let by = plus(shift, times(relief, left));
        let beside = profile.shifted(by);
        strokes.extend([ProfileMove::Rapid(plus(start, by)), ProfileMove::Rapid(beside.begin)]);
        strokes.extend(beside.strokes());
    }
    strokes.push(ProfileMove::Rapid(start));
    strokes
}

/// The strokes that leave so much on the profile; none if they are too many.
fn roughed(
    start: Flat,
    profile: &Profile,
    across: bool,
    leave: f64,
    how: Roughing,
) -> Result<Vec<ProfileMove>, Unfit> {
    let facing = Facing::of(profile, across);
    let profile = profile.seen(facing);
    let start = facing.to(start);
    let start = [start[0].min(profile.begin[0]), start[1]];
    let profile = parallel(&profile, profile.side_of(start) * leave)
        .and_then(|profile| profile.parted())
        .map_err(|why| why.seen_from(facing))?;
    let lowest = profile.ways.iter().map(|way| way.to[1]).fold(profile.begin[1], f64::min);
    if (start[1] - lowest) / how.step > MAX_PASSES {
        return Ok(Vec::new());
    }
    let strokes = std::iter::once(ProfileMove::Rapid(start)).chain(rough(start, &profile, how));
    Ok(strokes.map(|stroke| facing.stroke(stroke)).collect())
}
