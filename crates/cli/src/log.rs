//! `--log`: what happened, a line for each change of state, as a machinist would note it.
//!
//! Positions are the tool *tip's*, in the work's frame (machine position less G54 less the tool's
//! length); the spindle angle is not shown modulo a turn, so that in a tap it can be checked
//! against the lead by hand.
use crate::lines::Lines;
use bus::{Sample, State};
use canon::{Position, ToolLibrary};
use control::observers::Observer;
use control::services::supervision;
use kernel::{Event, EventKind};
use motion::{Await, InputWait, Output, Signal};
use units::Length;

/// Prints to standard output.
pub(crate) struct Log {
    work: WorkFrame,
    last: Option<(State, u32)>,
    lines: Lines,
}

impl Log {
    /// A log for a workpiece whose zero is there.
    pub(crate) fn new(tools: ToolLibrary, zero: Position, mut lines: Lines) -> Self {
        lines.line("     t s  line  state              x        y        z       rev     rpm");
        Self { work: WorkFrame::new(tools, zero), last: None, lines }
    }
}

/// The tool's tip in the work's frame, and events in words of that frame.
pub(crate) struct WorkFrame {
    tools: ToolLibrary,
    zero: Position,
    length: Length,
}

impl WorkFrame {
    /// Of a workpiece whose zero is there.
    pub(crate) const fn new(tools: ToolLibrary, zero: Position) -> Self {
        Self { tools, zero, length: Length::ZERO }
    }

    /// Which tool is in the spindle.
    pub(crate) fn sample(&mut self, sample: &Sample) {
        if let Some(number) = sample.feedback.tool {
            self.length = self.tools.get(number).map_or(Length::ZERO, canon::Tool::worn_length);
        }
    }

    /// Where a probe has touched: the place of its tip, in the work's frame.
    fn probed(&self, contact: &Position, changed: bool) -> String {
        let [x, y, z] = [0, 1, 2].map(|i| {
            let tool = if i == 2 { self.length } else { Length::ZERO };
            (contact.linear[i] - self.zero.linear[i] - tool).value()
        });
        let what = if changed { "the probe changes at" } else { "no contact up to" };
        format!("{what} {} {} {}", tidy(x, 3), tidy(y, 3), tidy(z, 3))
    }

    /// What has happened, in words; `None`: it is of no use to people.
    pub(crate) fn text(&self, event: &Event) -> Option<String> {
        Some(match &event.kind {
            EventKind::FaultRaised(fault) => fault.to_string(),
            EventKind::FollowingWarning { axis, error } => {
                format!("following error of {}: {}", axis.letter(), small(*axis, *error))
            }
            EventKind::SyncWarning { error } => format!("sync error {:.1} µm", error.in_um()),
            EventKind::TapSupervised(seen) if supervision::is_remarkable(seen) => {
                format!("supervision: {}", supervision::sentence(seen))
            }
            EventKind::ChipRemovalBegun { spin, .. } => {
                format!("chip removal: told {:.0} rpm", spin.in_rpm())
            }
            EventKind::ChipsThrown { spin, .. } => {
                format!("chip removal: {:.0} rpm reached, turned round", spin.in_rpm())
            }
            EventKind::ChipRemovalEnded { spin, .. } => {
                format!("chip removal: over, {:.0} rpm", spin.in_rpm())
            }
            EventKind::RecoveryBegun { error, mover } => format!(
                "recovery: {:.1} µm off the coupling, {}",
                error.in_um(),
                match mover {
                    Some(sync::recovery::Mover::Feed) => "the feed overran and goes back",
                    Some(sync::recovery::Mover::Spindle) => "the spindle overran and turns back",
                    None => "none overran",
                }
            ),
            EventKind::OnCoupling => "recovery: on the coupling, coming out along it".to_owned(),
            EventKind::RecoveryEnded(figures) => format!(
                "recovery: out, at most {:.1} µm off the helix on the way",
                figures.helix_error_max.in_um()
            ),
            EventKind::Withdrawn { .. } => "recovery: the tool is off the work".to_owned(),
            EventKind::Homed { axis, deviation: None } => format!("{} is homed", axis.letter()),
            EventKind::Homed { axis, deviation: Some(by) } => {
                format!(
                    "{} is homed, {} from where it was before",
                    axis.letter(),
                    small(*axis, *by)
                )
            }
            EventKind::HomingStopped { axis } => {
                format!("homing of {} was stopped: it is not homed", axis.letter())
            }
            EventKind::StoppedBySwitch { axis } => {
                format!("{} stands on its limit switch", axis.letter())
            }
            EventKind::Operator(notice) => notice.to_string(),
            EventKind::OutputSet(Output { number, signal: Signal::Digital { on }, .. }) => {
                format!("digital output {number} {}", if *on { "on" } else { "off" })
            }
            EventKind::OutputSet(Output { number, signal: Signal::Analogue { value }, .. }) => {
                format!("analogue output {number} at {value}")
            }
            EventKind::InputRead { wait, value } => read_input(wait, *value),
            EventKind::Probed { contact, changed } => self.probed(contact, *changed),
            EventKind::ConfirmedAutomatically(what) => {
                control::observers::confirmed(*what, event.line)
            }
            EventKind::UserCode { number } => format!("M{number} done"),
            EventKind::ToolChanged { tool } => format!("tool {tool} in the spindle"),
            EventKind::SpindlesCoupled { follower } => {
                format!("spindle {follower} follows, speed and phase are reached")
            }
            _ => return None,
        })
    }
}

impl Observer for Log {
    /// A servo period.
    fn sample(&mut self, sample: &Sample) {
        self.work.sample(sample);
        let now = (sample.report.state, sample.report.line);
        if self.last == Some(now) {
            return;
        }
        self.last = Some(now);
        let tip = |axis: usize| {
            let tool = if axis == 2 { self.work.length } else { Length::ZERO };
            (sample.axis(axis).of_linear() - self.work.zero.linear[axis] - tool).value()
        };
        let spin = sample.truth.as_ref().map_or(sample.command.spindles[0].spin, |t| t.spins[0]);
        self.lines.line(&format!(
            "{:8.3} {:5}  {:<12} {:>8} {:>8} {:>8} {:>9} {:>7}",
            sample.feedback.time.value(),
            now.1,
            now.0.name(),
            tidy(tip(0), 2),
            tidy(tip(1), 2),
            tidy(tip(2), 2),
            tidy(sample.spindle(0).value(), 2),
            tidy(spin.in_rpm(), 0),
        ));
    }

    fn message(&mut self, at: u32, text: &str) {
        self.lines.line(&format!("{:8} {at:5}  says: {}", "", text.trim()));
    }

    /// Something that is no change of state.
    fn event(&mut self, event: &Event) {
        let Some(text) = self.work.text(event) else { return };
        self.lines.line(&format!("{:8.3} {:5}  {text}", event.time.value(), event.line));
    }
}

/// What came of a wait for an input.
fn read_input(wait: &InputWait, value: Option<f64>) -> String {
    let InputWait { number, digital, until, longest } = wait;
    let kind = if *digital { "digital" } else { "analogue" };
    match (until, value) {
        (_, None) => format!(
            "{kind} input {number}: what was waited for has not come within {} s",
            longest.value()
        ),
        (Await::Nothing, Some(value)) => format!("{kind} input {number} reads {value}"),
        (Await::Rise | Await::Fall | Await::On | Await::Off, Some(_)) => {
            format!("{kind} input {number}: what was waited for has come")
        }
    }
}

/// A number without "-0.00".
fn tidy(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.starts_with('-') && text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
        text[1..].to_owned()
    } else {
        text
    }
}
/// A small way of an axis.
pub(crate) fn small(axis: canon::Axis, way: units::Coordinate) -> String {
    const ARCSEC: f64 = 3600.0;
    match axis.reading(way) {
        units::Reading::Rotary(angle) => format!("{:.0} arcsec", angle.in_deg() * ARCSEC),
        units::Reading::Linear(length) => format!("{:.0} µm", length.in_um()),
    }
}
