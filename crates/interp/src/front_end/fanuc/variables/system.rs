//! System variables: what a custom macro reads of the control, and what it may set there.
//!
//! | variables | are |
//! |---|---|
//! | #1000 – #1035 | inputs of the machine: 0, a simulated run has none |
//! | #1100 – #1131, #1132 | outputs 0 to 31, and all of them as bits: they are switched as M62 and M63 do, and read back |
//! | #2001 – #2999, #10001 – #19999 | tool offsets ([`tool_offsets`](crate::front_end::fanuc::offsets::tool_offsets)) |
//! | #3000, #3006 | set: alarm; stop with a message |
//! | #3001, #3002 | milliseconds, hours: each reading is a millisecond after the one before, so that waiting ends |
//! | #3003, #3004, #3005, #3901, #3902 | kept as they are set: a simulated run has no single block, no switches, no counter |
//! | #3011, #3012 | date and time: always 2000-01-01, 00:00:00, so that a run can be repeated |
//! | #5401 – #5600, #5701 – #5800 of Haas | timers and lives of tools, which do not go on here: 0 |
//! | #4001 – #4030, #4101 – #4130 (#4201 –, #4301 – alike) | modal codes, and the last D, F, H, M, N, S, T |
//! | #5001 –, #5021 –, #5041 – | end of the block before, in the work; machine position; position in the work |
//! | #5061 –, #5081 –, #5101 – | where G31 ended; tool offset in force; following error, which is 0 |
//! | #5201 – #5328 | the external work offset, G54 – G59 |
//! | #7001 – #7960, #14001 – #14960 of machining centres | G54.1 P1 – P48 |
//!
//! Source: Fanuc, operator's manual of series 30i, "System variables".
use crate::{
    Parameters,
    call::{Call, Sink, out::Out},
    fault::{Outcome, refuse},
    front_end::fanuc::{
        offsets::tool_offsets::{ToolVariable, set_tool, tool_value},
        state::{Fanuc, Kept},
        variables::MacroValues,
    },
    modes::{FeedMode, Motion},
    program::Program,
};
use canon::{Output, Signal};
use diag::Span;
use gcode::Block;

/// Axes by their number in system variables.
const MILL_AXES: [usize; 6] = [0, 1, 2, 3, 4, 5];
const LATHE_AXES: [usize; 3] = [0, 2, 5];
/// First variable of G54.1 P1, also as newer controls count.
const MORE: usize = 7001;
const MORE_NEW: usize = 14_001;
/// What the calendar says.
const DATE: f64 = 20_000_101.0;
const MS_PER_HOUR: f64 = 3_600_000.0;

/// Letters of [`Kept::words`], and the variable of each.
const LETTERS: [(u8, usize); 6] =
    [(b'B', 4102), (b'D', 4107), (b'E', 4108), (b'H', 4111), (b'M', 4113), (b'N', 4114)];

impl Kept {
    /// The last word of a letter that is kept.
    pub(crate) fn last(&self, letter: u8) -> f64 {
        let at = LETTERS.iter().position(|(kept, _)| *kept == letter);
        at.map_or(0.0, |at| self.words[at])
    }

    /// Remember a word that variables tell.
    pub(crate) fn word(&mut self, letter: u8, value: f64) {
        if !matches!(letter, b'B' | b'D' | b'E' | b'H' | b'M' | b'N') {
            return; // nearly all
        }
        if let Some(at) = LETTERS.iter().position(|(kept, _)| *kept == letter) {
            self.words[at] = value;
        }
    }
}

/// Which of the values that are kept.
const fn slot(number: usize) -> Option<usize> {
    match number {
        3003..=3005 => Some(number - 3003),
        3901 | 3902 => Some(number - 3898),
        _ => None,
    }
}

/// Work offset (0 is the external one, 10 and more are G54.1) and axis from 1 of a variable.
const fn work_offset(number: usize) -> Option<(usize, usize)> {
    let (first, system) = match number {
        5201..=5328 => (5201, 0),
        MORE..=7960 => (MORE, 10),
        MORE_NEW..=14_960 => (MORE_NEW, 10),
        _ => return None,
    };
    Some((system + (number - first) / 20, (number - first) % 20 + 1))
}

/// Set one.
pub(crate) fn set_system<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    number: usize,
    value: Option<f64>,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = it.block.span;
    let zero = value.unwrap_or(0.0);
    match number {
        1100..=1131 => switch(fanuc, number - 1100, zero != 0.0, out),
        1132 => {
            for output in 0..32 {
                let on = zero.max(0.0) as u64 >> output & 1 == 1;
                if on != (fanuc.kept.outputs >> output & 1 == 1) {
                    switch(fanuc, output, on, out);
                }
            }
        }
        3000 => return alarm(it, zero),
        3001 | 3002 => {
            let ms = if number == 3001 { zero } else { zero * MS_PER_HOUR };
            fanuc.kept.timers[number - 3001].set(ms);
        }
        3006 => {
            let text = comment(&it.block);
            out.say(&Call::Message(&text));
            out.say(&Call::Stop);
        }
        _ => {
            if let Some(at) = slot(number) {
                fanuc.kept.set[at] = zero;
                return Ok(());
            }
            if let Some((system, axis)) =
                work_offset(number).filter(|_| !(fanuc.is_lathe() && number >= MORE_NEW))
            {
                return set_work_offset(fanuc, it, system, axis, zero, out);
            }
            if let Some(tool) = ToolVariable::of(number, fanuc.is_lathe()) {
                set_tool(fanuc, &mut it.executor, tool, zero);
                return Ok(());
            }
            let text = format!(
                "#{number} cannot be set: programs set #1 to #33, #100 to #199, #500 to #999, offsets, timers and counters"
            );
            return refuse("I1012", span, text);
        }
    }
    Ok(())
}

/// A digital output.
fn switch<S: Sink>(fanuc: &mut Fanuc, output: usize, on: bool, out: &mut Out<'_, S>) {
    let bit = 1_u32 << output;
    fanuc.kept.outputs = if on { fanuc.kept.outputs | bit } else { fanuc.kept.outputs & !bit };
    let (number, signal) = (output as u8, Signal::Digital { on });
    out.say(&Call::Output(Output { number, signal, with_motion: false }));
}

fn alarm(it: &mut Program<'_>, value: f64) -> Outcome {
    it.ended = true;
    let number = 3000.0 + value;
    let text = format!("the program stops itself with alarm {number}: {}", comment(&it.block));
    refuse("I0316", it.block.span, text)
}

fn set_work_offset<S: Sink>(
    fanuc: &Fanuc,
    it: &mut Program<'_>,
    system: usize,
    count: usize,
    value: f64,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(axis) = axis(fanuc, count) else {
        return refuse("I1012", it.block.span, format!("this machine has no axis {count}"));
    };
    let mm = if axis < 3 { value * it.executor.modes.units.in_mm() } else { value };
    let first = Parameters::work_offset(system);
    it.executor.store.numbered.set(first + axis, fanuc.radius(axis, mm));
    crate::coordinates::offsets::offset_changed(
        &mut it.executor.modes,
        &mut it.executor.store,
        &it.executor.settings,
        system,
        out,
    );
    Ok(())
}

/// The axis that system variables count as this one, from 1.
fn axis(fanuc: &Fanuc, count: usize) -> Option<usize> {
    let axes: &[usize] = if fanuc.is_lathe() { &LATHE_AXES } else { &MILL_AXES };
    axes.get(count.checked_sub(1)?).copied()
}

/// Read one.
pub(crate) fn system(values: &MacroValues<'_>, number: usize, span: Span) -> Outcome<Option<f64>> {
    let modes = &values.executor.modes;
    let kept = &values.fanuc.kept;
    if let Some(at) = slot(number) {
        return Ok(Some(kept.set[at]));
    }
    let lathe = values.fanuc.is_lathe();
    if let Some((system, count)) = work_offset(number).filter(|_| !(lathe && number >= MORE_NEW)) {
        let mut point = values.executor.store.numbered.point(Parameters::work_offset(system));
        crate::geometry::frame::scale(&mut point, 1.0 / modes.units.in_mm());
        return coordinate(values, count, &point, span).map(Some);
    }
    if let Some(tool) = ToolVariable::of(number, lathe) {
        return Ok(Some(tool_value(values.fanuc, values.executor, tool)));
    }
    let coordinate = |first: usize, point: &crate::Point| {
        coordinate(values, number - first + 1, point, span).map(Some)
    };
    match number {
        1000..=1035 => Ok(Some(0.0)),
        1100..=1131 => Ok(Some(f64::from(kept.outputs >> (number - 1100) & 1))),
        1132 => Ok(Some(f64::from(kept.outputs))),
        5401..=5600 | 5701..=5800 if values.fanuc.kind.variant().has_tool_timers => Ok(Some(0.0)),
        3001 | 3002 => {
            let timer = &kept.timers[number - 3001];
            timer.set(timer.get() + 1.0);
            Ok(Some(if number == 3001 { timer.get() } else { timer.get() / MS_PER_HOUR }))
        }
        3011 => Ok(Some(DATE)),
        3012 => Ok(Some(0.0)),
        4001..=4030 | 4201..=4230 => modal(values, (number - 4001) % 200 + 4001, span),
        4101..=4130 | 4301..=4330 => modal(values, (number - 4101) % 200 + 4101, span),
        5001..=5020 => coordinate(5001, &modes.at),
        5021..=5040 => coordinate(5021, &modes.frame.to_machine(&modes.at)),
        5041..=5060 => coordinate(5041, &modes.place()),
        5061..=5080 => coordinate(5061, &values.executor.store.numbered.point(5061)),
        5081..=5100 => coordinate(5081, &modes.frame.tool),
        5101..=5120 => coordinate(5101, &[0.0; 9]),
        _ => {
            let text = format!("#{number} is not known to Leadscrew");
            refuse("I1013", span, text)
        }
    }
}

fn coordinate(
    values: &MacroValues<'_>,
    count: usize,
    point: &crate::Point,
    span: Span,
) -> Outcome<f64> {
    match axis(values.fanuc, count) {
        Some(axis) => Ok(values.fanuc.shown(axis, point[axis])),
        None => refuse("I1013", span, format!("this machine has no axis {count}")),
    }
}

/// A modal code, or the last word of a letter.
fn modal(values: &MacroValues<'_>, number: usize, span: Span) -> Outcome<Option<f64>> {
    let modes = &values.executor.modes;
    let pick = |first, second, is_first| Some(if is_first { first } else { second });
    let mapping = &values.fanuc.mapping;
    let feed = match modes.feed_mode {
        FeedMode::InverseTime => 93.0,
        FeedMode::PerMinute => own_code(values, 94),
        FeedMode::PerRevolution => own_code(values, 95),
    };
    Ok(match number {
        4001 => Some(motion_code(values)),
        4002 if values.fanuc.is_lathe() => pick(96.0, 97.0, modes.spindle.constant_surface_speed),
        4016 if values.fanuc.is_lathe() => Some(plane_code(values)),
        4002 => Some(plane_code(values)),
        4003 => pick(91.0, 90.0, modes.incremental),
        4004 => Some(if values.fanuc.is_lathe() { 69.0 } else { 23.0 }),
        4005 => Some(feed),
        4006 => pick(own_code(values, 20), own_code(values, 21), modes.units == crate::Units::Inch),
        4007 => Some(modes.compensation.as_ref().map_or(40.0, |c| f64::from(c.code) / 10.0)),
        4008 if !values.fanuc.is_lathe() => Some(values.fanuc.length_mode),
        4009 | 4010 if (number == 4010) == values.fanuc.is_lathe() => {
            let code = f64::from(modes.motion.code() % crate::codes::OWN) / 10.0;
            pick(code, 80.0, matches!(modes.motion, Motion::Cycle(_)))
        }
        4010 | 4011 if (number == 4011) == values.fanuc.is_lathe() => {
            pick(98.0, 99.0, modes.retract_to_initial)
        }
        4011 => pick(51.0, 50.0, mapping.scale.is_some()),
        4012 => pick(66.0, 67.0, values.fanuc.has_modal()),
        4013 if !values.fanuc.is_lathe() => pick(96.0, 97.0, modes.spindle.constant_surface_speed),
        4014 if modes.system > 9 => Some(54.1),
        4014 => Some(53.0 + f64::from(modes.system)),
        4015 => pick(64.0, 61.0, matches!(modes.corners, crate::Corners::Continuous(_))),
        4016 => pick(68.0, 69.0, mapping.rotation.is_some()),
        4017 => pick(16.0, 15.0, mapping.polar.is_some()),
        4022 => pick(51.1, 50.1, mapping.mirror.iter().any(Option::is_some)),
        4109 => Some(modes.feed),
        4115 => values
            .fanuc
            .program
            .filter(|n| *n < crate::front_end::fanuc::tape::NAMED)
            .map(f64::from),
        4119 => Some(modes.spindle.speed),
        4120 => Some(f64::from(modes.selected_tool)),
        4130 => Some(f64::from(modes.system.saturating_sub(9))),
        4021 => pick(12.1, 13.1, values.fanuc.surface.is_some_and(|s| s.is_face())),
        _ => match LETTERS.iter().position(|(_, kept)| *kept == number) {
            Some(at) => Some(values.fanuc.kept.words[at]),
            None => {
                return refuse("I1013", span, format!("#{number} is not known to Leadscrew"));
            }
        },
    })
}

fn plane_code(values: &MacroValues<'_>) -> f64 {
    match values.executor.modes.plane {
        canon::Plane::XY => 17.0,
        canon::Plane::ZX => 18.0,
        canon::Plane::YZ => 19.0,
    }
}

/// A code as this machine writes it.
fn own_code(values: &MacroValues<'_>, code: u16) -> f64 {
    f64::from(values.fanuc.kind.own(code))
}

/// The code of group 1: a cycle is none of it.
fn motion_code(values: &MacroValues<'_>) -> f64 {
    let motion = match values.executor.modes.motion {
        Motion::Cycle(_) | Motion::None => values.fanuc.before_cycle,
        other => other,
    };
    match values.fanuc.lathe_cycle {
        Some(code) => own_code(values, code / 10),
        None if values.fanuc.growing => own_code(values, 34),
        None if motion == Motion::Thread => own_code(values, 33),
        None => f64::from(motion.code()) / 10.0,
    }
}

fn comment(block: &Block) -> String {
    block.comments.last().map_or_else(String::new, |c| block.text(c.text).trim().to_owned())
}
