//! Parameters: numbered, named, and those the interpreter answers itself.
use crate::{
    call::Sense,
    codes::number::near_whole,
    fault::{Outcome, error, refuse},
    modes::{FeedMode, Modes},
    setup::{MAX_PARAMETER, Parameters},
};
use canon::{Axis, Plane};
use diag::{Diagnostic, Span};
use std::collections::HashMap;

/// First and last of the parameters that only the interpreter sets.
const READ_ONLY: core::ops::RangeInclusive<usize> = 5400..=5428;
/// Parameters that belong to a subprogram's call.
pub(crate) const ARGUMENTS: usize = 30;

/// Values that programs set.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Store {
    pub(crate) numbered: Parameters,
    pub(crate) global: HashMap<Box<str>, f64>,
    /// Innermost last; the first belongs to the main program.
    pub(crate) local: Vec<HashMap<Box<str>, f64>>,
    pub(crate) saved: Vec<[f64; ARGUMENTS]>,
    /// How often the machine was asked something that is kept here.
    pub(crate) asked: u32,
}

impl Store {
    pub(crate) fn new(numbered: Parameters) -> Self {
        Self { numbered, local: vec![HashMap::new()], ..Self::default() }
    }

    /// A named parameter; one that begins with `_` is global.
    pub(crate) fn named(&self, name: &str) -> Option<f64> {
        if name.starts_with('_') { &self.global } else { self.local.last()? }.get(name).copied()
    }

    /// Set a named parameter.
    pub(crate) fn set_named(&mut self, name: &str, value: f64) {
        let scope =
            if name.starts_with('_') { Some(&mut self.global) } else { self.local.last_mut() };
        let Some(scope) = scope else { return };
        match scope.get_mut(name) {
            Some(slot) => *slot = value,
            None => _ = scope.insert(name.into(), value),
        }
    }

    /// How many named parameters are held.
    pub(crate) fn names(&self) -> usize {
        self.global.len() + self.local.iter().map(HashMap::len).sum::<usize>()
    }

    /// Enter a subprogram: #1 … #30 are its arguments, zero where it got none; names begin afresh.
    pub(crate) fn enter(&mut self, arguments: &[f64]) {
        let own = self.numbered.arguments_mut();
        let mut saved = [0.0; ARGUMENTS];
        saved.copy_from_slice(own);
        let (given, others) = own.split_at_mut(arguments.len().min(ARGUMENTS));
        given.copy_from_slice(&arguments[..given.len()]);
        others.fill(0.0);
        self.saved.push(saved);
        self.local.push(HashMap::new());
    }

    /// Leave it: #1 … #30 are the caller's again.
    pub(crate) fn leave(&mut self) {
        if let Some(saved) = self.saved.pop() {
            self.numbered.arguments_mut().copy_from_slice(&saved);
            self.local.pop();
        }
    }
}

/// A parameter's number, checked.
pub(crate) fn number(value: f64, span: Span) -> Outcome<usize> {
    match near_whole(value) {
        Some(number) if exists(number) => Ok(number as usize),
        _ => refuse(
            "I0205",
            span,
            format!("parameters are numbered 1 to {MAX_PARAMETER}, found #{value}"),
        ),
    }
}

/// Whether there is a parameter of this number.
pub(crate) fn exists(number: i64) -> bool {
    usize::try_from(number).is_ok_and(|n| (1..=MAX_PARAMETER).contains(&n))
}

/// Set a numbered parameter, unless it is the interpreter's own.
pub(crate) fn assign(store: &mut Store, number: usize, value: f64, span: Span) -> Outcome {
    if READ_ONLY.contains(&number) {
        return refuse(
            "I0206",
            span,
            format!("#{number} tells where the machine stands and cannot be set"),
        );
    }
    store.numbered.set(number, value);
    Ok(())
}

/// Whether a named parameter can be set: it is not one that the interpreter answers itself.
pub(crate) fn assignable(modes: &Modes, name: &str, span: Span) -> Outcome {
    if name.starts_with('_') && system(modes, name).is_some() {
        let text = format!("#<{name}> tells how things stand and cannot be set");
        return refuse("I0206", span, text);
    }
    Ok(())
}

/// Value of a numbered parameter.
pub(crate) fn numbered(modes: &Modes, store: &Store, number: usize) -> f64 {
    match number {
        5400 => f64::from(modes.current_tool),
        5401..=5409 => modes.loaded.offset[number - 5401],
        5410 => modes.loaded.diameter,
        5411 => modes.loaded.front_angle,
        5412 => modes.loaded.back_angle,
        5413 => f64::from(modes.loaded.orientation),
        5420..=5428 => modes.place()[number - 5420],
        _ => store.numbered.at(number),
    }
}

/// Value of a parameter as it is written behind `#`, if it has one: `5`, `<name>`.
pub(crate) fn written(modes: &Modes, store: &Store, text: &str) -> Option<f64> {
    if let Some(name) = text.strip_prefix('<').and_then(|name| name.strip_suffix('>')) {
        return store.named(name).or_else(|| system(modes, name));
    }
    let number: usize = text.parse().ok()?;
    let there = i64::try_from(number).is_ok_and(exists);
    there.then(|| numbered(modes, store, number))
}

/// Value of a parameter that the interpreter answers itself.
pub(crate) fn system(modes: &Modes, name: &str) -> Option<f64> {
    let name = name.strip_prefix('_')?;
    let truth = |b: bool| Some(f64::from(u8::from(b)));
    if let Some(axis) = name.strip_prefix("abs_") {
        return axis_of(axis).map(|i| modes.frame.to_machine(&modes.place())[i]);
    }
    if let Some(axis) = axis_of(name) {
        return Some(modes.place()[axis]);
    }
    let turning = modes.spindle.turning;
    match name {
        "vmajor" => Some(2.9), // the language's version: programs ask for what LinuxCNC 2.9 can do
        "vminor" | "task" | "remap_level" => Some(0.0),
        "line" => Some(f64::from(modes.line)),
        "motion_mode" => Some(f64::from(modes.motion.code())),
        "plane" => Some(match modes.plane {
            Plane::XY => 170.0,
            Plane::ZX => 180.0,
            Plane::YZ => 190.0,
        }),
        "ccomp" => Some(modes.compensation.as_ref().map_or(400.0, |c| f64::from(c.code))),
        "metric" => truth(modes.units == crate::Units::Millimetre),
        "imperial" => truth(modes.units == crate::Units::Inch),
        "absolute" => truth(!modes.incremental),
        "incremental" => truth(modes.incremental),
        "inverse_time" => truth(modes.feed_mode == FeedMode::InverseTime),
        "units_per_minute" => truth(modes.feed_mode == FeedMode::PerMinute),
        "units_per_rev" => truth(modes.feed_mode == FeedMode::PerRevolution),
        "coord_system" => Some(match modes.system {
            n @ 1..=6 => 530.0 + 10.0 * f64::from(n),
            n => 584.0 + f64::from(n),
        }),
        "tool_offset" => truth(modes.frame.tool != [0.0; 9]),
        "retract_r_plane" => truth(!modes.retract_to_initial),
        "retract_old_z" => truth(modes.retract_to_initial),
        "spindle_rpm_mode" => truth(!modes.spindle.constant_surface_speed),
        "spindle_css_mode" => truth(modes.spindle.constant_surface_speed),
        "ijk_absolute_mode" => truth(modes.absolute_centres),
        "lathe_diameter_mode" => truth(modes.diameter),
        "lathe_radius_mode" => truth(!modes.diameter),
        "spindle_on" => truth(turning.is_some()),
        "spindle_cw" => truth(turning == Some(Sense::Clockwise)),
        "mist" => truth(modes.mist),
        "flood" => truth(modes.flood),
        "speed_override" => truth(modes.speed_override),
        "feed_override" => truth(modes.feed_override),
        "adaptive_feed" => truth(modes.adaptive_feed),
        "feed_hold" => truth(modes.feed_hold),
        "feed" => Some(modes.feed),
        "rpm" => Some(modes.spindle.speed),
        "current_pocket" => Some(f64::from(modes.current_pocket)),
        "selected_pocket" => Some(modes.selected_pocket.map_or(-1.0, f64::from)),
        "current_tool" => Some(f64::from(modes.current_tool)),
        "selected_tool" => Some(f64::from(modes.selected_tool)),
        "call_level" => Some(modes.call_level as f64),
        "value" => Some(modes.value),
        "value_returned" => truth(modes.returned.is_some()),
        _ => None,
    }
}

fn axis_of(name: &str) -> Option<usize> {
    Axis::ALL
        .iter()
        .position(|axis| name.len() == 1 && name.eq_ignore_ascii_case(&axis.letter().to_string()))
}

/// The diagnostic for a name that has no value.
pub(crate) fn unknown(store: &Store, name: &str, span: Span) -> Diagnostic {
    let fault = error("I0207", span, format!("#<{name}> has no value yet"));
    if name.starts_with("_ini[") || name.starts_with("_hal[") {
        return fault
            .with_help("settings of a LinuxCNC machine are not known here: write the number");
    }
    let scope = store.local.last().into_iter().flat_map(HashMap::keys).chain(store.global.keys());
    let near = scope
        .filter(|known| distance(known, name) <= 1 + name.len() / 6)
        .min_by_key(|k| distance(k, name));
    match near {
        Some(known) => fault.with_help(format!("did you mean #<{known}>?")),
        None => fault.with_help("set it first, for instance `#<name> = 1`; names without a leading _ are known only in their own subprogram"),
    }
}

/// How many letters must be inserted, removed or replaced to make one word of the other.
pub(crate) fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().take(64).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
