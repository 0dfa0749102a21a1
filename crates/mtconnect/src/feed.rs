//! From a control's pictures and events to observations.
//!
//! What the program does and who leads the axes come from the control's events alone: each change
//! is observed, in its order, however short it was. Everything else comes from pictures: events and
//! conditions from each, samples ten times a second.
use crate::buffer::{Buffer, FaultValue, Value};
use crate::device::Device;
use crate::documents::{Asset, CUTTING_TOOL};
use control::operation::hosted::{Journaled, Picture};
use control::operation::{Alarm, Event, Execution, Mode, Status, said_of};
use std::sync::Arc;
use units::Length;
use verify::{Feature, FeatureKind, Verdict};

/// Samples are observed so often, ms.
const SAMPLES_MS: u64 = 100;
/// Longest text of a block or a message, characters.
const LONGEST_TEXT: usize = 300;

/// What an agent is told: a picture, the events before it, and the time.
pub struct Observable<'a> {
    /// The latest picture.
    pub picture: &'a Picture,
    /// What has happened since the last time, oldest first …
    pub events: &'a [Journaled],
    /// … and how much that is no longer kept.
    pub lost: u64,
    /// Now, ms since 1970.
    pub unix_ms: u64,
    /// Machine time that passes in a second on the wall.
    pub pace: f64,
    /// Names of programs as clients see them.
    pub shown: &'a dyn Fn(&str) -> String,
}

/// What is remembered from one picture to the next.
#[derive(Debug, Default)]
pub(crate) struct Feed {
    has_begun: bool,
    /// When samples are due.
    samples_ms: u64,
    is_automatic: bool,
    part_count: u64,
    /// Faults so far: each has its own number.
    faults: u64,
    /// An alarm is there since this machine time.
    alarm_since: Option<f64>,
    /// The program's text and line of the block that was observed last.
    block: Option<(usize, u32)>,
    pub(crate) assets: Vec<Asset>,
}

fn text(text: &str) -> Value {
    let text: String = text.chars().take(LONGEST_TEXT).collect();
    Value::Text(text.into())
}

fn number(value: f64, decimals: u8) -> Value {
    if !value.is_finite() {
        return Value::Unavailable;
    }
    let scale = 10_f64.powi(i32::from(decimals));
    Value::Number((value * scale).round() / scale + 0.0) // no -0
}

const fn switch(is_on: bool) -> Value {
    Value::Word(if is_on { "ON" } else { "OFF" })
}

impl Feed {
    /// What there is to observe.
    pub(crate) fn take(&mut self, seen: &Observable<'_>, device: &Device, buffer: &mut Buffer) {
        let (at, now, status) = (&device.at, seen.unix_ms, &seen.picture.status);
        if !self.has_begun {
            self.begin(seen, device, buffer);
        }
        for event in seen.events {
            self.event(event, seen, device, buffer);
        }
        if seen.lost > 0 {
            buffer.observe(at.execution, now, Value::Word(status.execution));
            buffer.observe(at.mode, now, Value::Word(status.mode));
        }
        self.clear_alarms(seen, device, buffer);
        self.tools(seen, device, buffer);
        self.states(seen, device, buffer);
        if now >= self.samples_ms {
            self.samples_ms = now + SAMPLES_MS;
            samples(status, now, device, buffer);
        }
    }

    /// Each data item has an observation from the beginning.
    fn begin(&mut self, seen: &Observable<'_>, device: &Device, buffer: &mut Buffer) {
        self.has_begun = true;
        let (at, now, status) = (&device.at, seen.unix_ms, &seen.picture.status);
        for (number, item) in device.items.iter().enumerate() {
            buffer.observe(number, now, item.kind.always.map_or(Value::Unavailable, Value::Word));
        }
        buffer.observe(at.availability, now, Value::Word("AVAILABLE"));
        buffer.observe(at.execution, now, Value::Word(status.execution));
        buffer.observe(at.mode, now, Value::Word(status.mode));
        buffer.observe(at.part_count, now, Value::Count(0));
        self.is_automatic = status.mode == Mode::Automatic.name();
        buffer.observe(at.alarms, now, Value::Normal);
        let told = |alarm: &Alarm| {
            let is_told =
                |event: &&Journaled| matches!(&*event.event, Event::Alarm(a) if a == alarm);
            seen.events.iter().any(|event| is_told(&event))
        };
        for alarm in seen.picture.alarms.iter() {
            if !alarm.is_cleared && !told(alarm) {
                self.fault(alarm, now, device, buffer);
            }
        }
    }

    fn event(
        &mut self,
        event: &Journaled,
        seen: &Observable<'_>,
        device: &Device,
        buffer: &mut Buffer,
    ) {
        let at = &device.at;
        let ago = (seen.picture.status.time_s - event.time.value()).max(0.0) / seen.pace;
        let when = seen.unix_ms.saturating_sub((ago * 1e3) as u64);
        match &*event.event {
            Event::Execution(execution) => {
                buffer.observe(at.execution, when, Value::Word(execution.name()));
                if *execution == Execution::ProgramCompleted && self.is_automatic {
                    self.part_count += 1;
                    buffer.observe(at.part_count, when, Value::Count(self.part_count));
                }
            }
            Event::Mode(mode) => {
                self.is_automatic = *mode == Mode::Automatic;
                buffer.observe(at.mode, when, Value::Word(mode.name()));
            }
            Event::Alarm(alarm) => {
                self.alarm_since = Some(event.time.value());
                self.fault(alarm, when, device, buffer);
            }
            Event::Notice(notice) => buffer.push(at.message, when, text(&(seen.shown)(notice))),
            Event::Feature(cut) => feature(cut, when, device, buffer),
            Event::DrivesReady => {} // the pictures have power
        }
    }

    fn fault(&mut self, alarm: &Alarm, when: u64, device: &Device, buffer: &mut Buffer) {
        self.faults += 1;
        self.alarm_since = Some(self.alarm_since.unwrap_or(alarm.time.value()));
        let fault = FaultValue {
            id: format!("{}-{}", alarm.number, self.faults),
            native_code: alarm.number.to_string(),
            text: format!("{}: {}", alarm.text, alarm.remedy),
        };
        buffer.push(device.at.alarms, when, Value::Fault(Arc::new(fault)));
    }

    /// A picture from before an alarm does not say that it is gone.
    fn clear_alarms(&mut self, seen: &Observable<'_>, device: &Device, buffer: &mut Buffer) {
        let picture = seen.picture;
        let is_after = self.alarm_since.is_some_and(|since| picture.status.time_s > since);
        if is_after && picture.alarms.iter().all(|alarm| alarm.is_cleared) {
            self.alarm_since = None;
            buffer.observe(device.at.alarms, seen.unix_ms, Value::Normal);
        }
    }

    fn tools(&mut self, seen: &Observable<'_>, device: &Device, buffer: &mut Buffer) {
        let (at, now, tools) = (&device.at, seen.unix_ms, &seen.picture.tools);
        for tool in tools.iter() {
            let id = asset_id(device, tool.number);
            let known = self.assets.iter().position(|asset| asset.id == id);
            let asset = Asset { id, unix_ms: now, is_removed: false, tool: tool.clone() };
            if let Some(number) = known {
                let before = &self.assets[number];
                if before.tool == asset.tool && !before.is_removed {
                    continue;
                }
                buffer.push(at.asset_changed, now, text(&asset.id));
                self.assets[number] = asset;
            } else {
                buffer.push(at.asset_changed, now, text(&asset.id));
                self.assets.push(asset);
            }
        }
        for asset in &mut self.assets {
            let is_there = tools.iter().any(|tool| tool.number == asset.tool.number);
            if !is_there && !asset.is_removed {
                (asset.is_removed, asset.unix_ms) = (true, now);
                buffer.push(at.asset_removed, now, text(&asset.id));
            }
        }
        buffer.observe(at.asset_count, now, Value::Assets(tools.len() as u64));
    }

    fn states(&mut self, seen: &Observable<'_>, device: &Device, buffer: &mut Buffer) {
        let (at, now, status) = (&device.at, seen.unix_ms, &seen.picture.status);
        let mut observe = |item, value| buffer.observe(item, now, value);
        let available = |value: Option<Value>| value.unwrap_or(Value::Unavailable);
        observe(at.emergency_stop, Value::Word(status.emergency_stop));
        observe(at.power, Value::Word(status.power));
        observe(at.single_block, switch(status.switches.single_block));
        observe(at.optional_stop, switch(status.switches.optional_stop));
        observe(at.feed_override, number(status.overrides.feed_percent, 1));
        observe(at.rapid_override, number(status.overrides.rapid_percent, 1));
        observe(at.work_offset, text(&status.work_offset));
        observe(at.activity, Value::Word(status.activity));
        observe(at.waiting_for, available(status.waiting_for.as_ref().map(|w| text(&w.what))));
        observe(at.recovery, Value::Word(recovery(status)));
        let tool = status.tool.map(|tool| text(&tool.to_string()));
        observe(at.tool, available(tool));
        let held = status.tool.filter(|tool| *tool != 0);
        observe(at.tool_asset, available(held.map(|tool| text(&asset_id(device, tool)))));
        let program = status.program.as_ref();
        observe(at.program, available(program.map(|p| text(&(seen.shown)(&p.name)))));
        let line = program.map(|program| program.line).filter(|line| *line != 0);
        observe(at.line, available(line.map(|line| Value::Count(u64::from(line)))));
        for (axis, at) in status.axes.iter().zip(&at.axes) {
            observe(at.homed, Value::Word(if axis.is_homed { "YES" } else { "NO" }));
        }
        for at in &at.spindles {
            observe(at.speed_override, number(status.overrides.spindle_percent, 1));
        }
        self.block(seen, line, device, buffer);
    }

    /// The text of the line that is executed, where it is one of the loaded program.
    fn block(
        &mut self,
        seen: &Observable<'_>,
        line: Option<u32>,
        device: &Device,
        buffer: &mut Buffer,
    ) {
        let loaded = seen.picture.program.as_ref();
        let executed = seen.picture.status.program.as_ref();
        let same = loaded.filter(|loaded| executed.is_some_and(|p| p.name == loaded.name));
        let block = same.zip(line).map(|(loaded, line)| (Arc::as_ptr(loaded) as usize, line));
        if block == self.block && self.block.is_some() {
            return;
        }
        self.block = block;
        let found = same.zip(line).and_then(|(loaded, line)| {
            let found = loaded.text.split(|byte| *byte == b'\n').nth(line as usize - 1)?;
            Some(text(String::from_utf8_lossy(found).trim()))
        });
        buffer.observe(device.at.block, seen.unix_ms, found.unwrap_or(Value::Unavailable));
    }
}

/// What was cut, each time anew.
fn feature(feature: &Feature, when: u64, device: &Device, buffer: &mut Buffer) {
    let at = &device.at;
    let millimetres = |length: Length| number(length.value(), 5);
    let class = match &feature.kind {
        FeatureKind::Thread(thread) => Some(thread.class_name()),
        // of a turned thread no other class is tried than the one asked
        FeatureKind::Turned(thread) if matches!(feature.verdict, Verdict::Pass) => {
            Some(thread.class).filter(|class| !class.is_empty())
        }
        _ => None,
    };
    let verdict = match feature.verdict {
        Verdict::Pass => "GOOD",
        Verdict::Fail { .. } => "FAILED",
        Verdict::NotJudged { .. } => "NOT_JUDGED",
    };
    buffer.push(at.feature, when, text(&said_of(feature)));
    buffer.push(at.verdict, when, Value::Word(verdict));
    let measures = [
        (at.sync_error, feature.sync_error_max().map(millimetres)),
        (at.depth_error, feature.depth_error().map(millimetres)),
        (at.class, class.map(text)),
    ];
    for (item, value) in measures {
        match value {
            Some(value) => buffer.push(item, when, value),
            None => buffer.observe(item, when, Value::Unavailable),
        }
    }
}

fn samples(status: &Status, now: u64, device: &Device, buffer: &mut Buffer) {
    let at = &device.at;
    let mut observe = |item: usize, value: f64| {
        buffer.observe(item, now, number(value, device.items[item].kind.decimals));
    };
    observe(at.feedrate, status.path_mm_per_min / 60.0);
    for (axis, at) in status.axes.iter().zip(&at.axes) {
        observe(at.machine, axis.machine);
        observe(at.work, axis.work);
        if let Some(load) = at.load {
            observe(load, axis.load_percent.unwrap_or(f64::NAN));
        }
    }
    for (spindle, at) in status.spindles.iter().zip(&at.spindles) {
        observe(at.ordered, spindle.ordered_rpm);
        observe(at.measured, spindle.measured_rpm);
        observe(at.load, spindle.load_percent.unwrap_or(f64::NAN));
        observe(at.torque, spindle.torque_n_m.unwrap_or(f64::NAN));
    }
}

fn recovery(status: &Status) -> &'static str {
    if status.activity == bus::State::Recovering.name() {
        "RECOVERING"
    } else if status.is_tool_in_work {
        "TOOL_IN_WORK"
    } else {
        "NONE"
    }
}

/// Of a tool: no other machine's tool is called so.
fn asset_id(device: &Device, tool: u32) -> String {
    format!("{}.{CUTTING_TOOL}.T{tool}", device.name)
}
