//! What is said.
use crate::bytes::{Reader, Writer};
use crate::truth::{read_truth, write_truth};
use bus::{
    ANALOGUE, AXES, AxisCommand, AxisFeedback, Command, Feedback, SPINDLES, Signals,
    SpindleCommand, SpindleFeedback, Truth,
};
use units::{Angle, Coordinate, CoordinateSpeed, Force, Length, Spin, Time, Torque};

/// Longest name.
const LONGEST_NAME: usize = 255;
/// Longest text.
const LONGEST_TEXT: usize = 8192;

/// A frame's content.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // one at a time, on the stack; boxes would be made each period
pub enum Message {
    /// A control reports.
    Hello(Hello),
    /// The machine simulator takes it.
    Welcome(Welcome),
    /// The machine simulator does not, or has stopped: one sentence.
    Refused(String),
    /// What the machine shall do for a period, and which tool the control has in the work.
    Command(Command, Option<Engagement>),
    /// What came of it.
    Observed(Observed),
    /// Something for the machine simulator itself, instead of a session.
    Order(Order),
    /// Its answer, as JSON.
    Told(String),
}

/// Who controls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    /// For people.
    pub name: String,
    /// The machine it is set up for.
    pub machine: String,
}

/// How drives came to rest that were left alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stop {
    /// They have not been left alone since the machine simulator was switched on.
    None = 0,
    /// Axes clamped, spindles coasted.
    Coasted = 1,
    /// Each drive braked by itself.
    QuickStop = 2,
    /// Coupled drives braked together.
    Coupled = 3,
}

/// A tool in the work that only recovery may take out: a tap in its thread, or one that is tied to a spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Engagement {
    /// The machine counts them, from 1.
    pub number: u64,
    /// The tool.
    pub tool: u32,
    /// It is certainly in the workpiece now; before its first touch and between two pecks it is not.
    pub touches: bool,
    /// How far the axis was from its coupling at most in the material, by the encoders.
    pub sync_error: Length,
    /// A recovery that has begun to move it knows that it may be broken; where it stands later does not show that any more.
    pub may_be_broken: bool,
}

/// In which sense a spindle turned that an axis was tied to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Sense {
    /// It has not turned since the tool went in.
    #[default]
    Unknown = 0,
    /// With growing angle.
    Positive = 1,
    /// With falling angle.
    Negative = 2,
}

/// What the machine itself keeps of a tool in its work, whatever becomes of the control and of its files.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// Number of the last engagement; 0: there has been none.
    pub last: u64,
    /// The tool that is in the work now; `None`: the control that led it there has taken it out.
    pub in_work: Option<Engagement>,
    /// How the spindle of the last engagement turned last while an axis was tied to it.
    pub sense: Sense,
}

/// Which machine it is, and what its encoders know.
#[derive(Clone, Debug, PartialEq)]
pub struct Welcome {
    /// Name in its file.
    pub machine: String,
    /// Number of this very machine.
    pub serial: u64,
    /// Changes whenever an encoder loses its reference.
    pub epoch: u64,
    /// Servo period.
    pub period: Time,
    /// Time passes by the clock on the wall; otherwise it waits for the control.
    pub real_time: bool,
    /// By spindle: it has lost count of its turns; the angle within a turn is right.
    pub turns_lost: [bool; SPINDLES],
    /// How the drives came to rest when they were left alone; of several times since a tool went into the work, the one
    /// that leaves least certain how far it is from its coupling.
    pub stop: Stop,
    /// Whether a tool is in the work.
    pub evidence: Evidence,
    /// Where everything stands.
    pub observed: Observed,
}

/// One period, as the machine simulator has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed {
    /// What it says.
    pub feedback: Feedback,
    /// What it knows besides, if it is simulated.
    pub truth: Option<Truth>,
}

/// Something for the machine simulator itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Order {
    /// Say how it is.
    Status = 1,
    /// Cut the power and give it back.
    PowerCut = 2,
    /// End.
    Quit = 3,
    /// Somebody has seen that no tool is in the work.
    ToolIsFree = 4,
}

impl Message {
    pub(crate) const fn kind(&self) -> u8 {
        match self {
            Self::Hello(_) => 1,
            Self::Welcome(_) => 2,
            Self::Refused(_) => 3,
            Self::Command(..) => 4,
            Self::Observed(_) => 5,
            Self::Order(_) => 6,
            Self::Told(_) => 7,
        }
    }

    /// For people.
    pub(crate) const fn name(&self) -> &'static str {
        match self {
            Self::Hello(_) => "a greeting",
            Self::Welcome(_) => "a welcome",
            Self::Refused(_) => "a refusal",
            Self::Command(..) => "a command",
            Self::Observed(_) => "feedback",
            Self::Order(_) => "an order",
            Self::Told(_) => "an answer",
        }
    }

    pub(crate) fn write(&self, w: &mut Writer<'_>) {
        match self {
            Self::Hello(hello) => {
                w.text(&hello.name, LONGEST_NAME);
                w.text(&hello.machine, LONGEST_NAME);
            }
            Self::Welcome(welcome) => write_welcome(w, welcome),
            Self::Refused(text) | Self::Told(text) => w.text(text, LONGEST_TEXT),
            Self::Command(command, engagement) => {
                write_command(w, command);
                write_engagement(w, engagement.as_ref());
            }
            Self::Observed(observed) => write_observed(w, observed),
            Self::Order(order) => w.u8(*order as u8),
        }
    }

    pub(crate) fn read(kind: u8, r: &mut Reader<'_>) -> Option<Self> {
        Some(match kind {
            1 => Self::Hello(Hello { name: r.text()?, machine: r.text()? }),
            2 => Self::Welcome(read_welcome(r)?),
            3 => Self::Refused(r.text()?),
            4 => Self::Command(read_command(r)?, read_engagement(r)?),
            5 => Self::Observed(read_observed(r)?),
            6 => Self::Order(match r.u8()? {
                1 => Order::Status,
                2 => Order::PowerCut,
                3 => Order::Quit,
                4 => Order::ToolIsFree,
                _ => return None,
            }),
            7 => Self::Told(r.text()?),
            _ => return None,
        })
    }
}

/// A bit for each that is not its default.
pub(crate) fn mask<T: PartialEq + Default>(all: &[T]) -> u16 {
    let nothing = T::default();
    all.iter().enumerate().filter(|(_, one)| **one != nothing).fold(0, |m, (i, _)| m | 1 << i)
}

/// The indices in a mask; `None` if it has others.
pub(crate) fn indices(mask: u16, of: usize) -> Option<impl Iterator<Item = usize>> {
    (u32::from(mask) < 1 << of).then(|| (0..of).filter(move |i| mask & (1 << i) != 0))
}

fn write_welcome(w: &mut Writer<'_>, welcome: &Welcome) {
    w.text(&welcome.machine, LONGEST_NAME);
    w.u64(welcome.serial);
    w.u64(welcome.epoch);
    w.f64(welcome.period.value());
    w.u8(welcome.real_time.into());
    w.u16(mask(&welcome.turns_lost));
    w.u8(welcome.stop as u8);
    w.u64(welcome.evidence.last);
    write_engagement(w, welcome.evidence.in_work.as_ref());
    w.u8(welcome.evidence.sense as u8);
    write_observed(w, &welcome.observed);
}

fn read_welcome(r: &mut Reader<'_>) -> Option<Welcome> {
    Some(Welcome {
        machine: r.text()?,
        serial: r.u64()?,
        epoch: r.u64()?,
        period: Time::s(r.f64()?),
        real_time: r.flag()?,
        turns_lost: flags(r)?,
        stop: match r.u8()? {
            0 => Stop::None,
            1 => Stop::Coasted,
            2 => Stop::QuickStop,
            3 => Stop::Coupled,
            _ => return None,
        },
        evidence: Evidence {
            last: r.u64()?,
            in_work: read_engagement(r)?,
            sense: match r.u8()? {
                0 => Sense::Unknown,
                1 => Sense::Positive,
                2 => Sense::Negative,
                _ => return None,
            },
        },
        observed: read_observed(r)?,
    })
}

fn write_engagement(w: &mut Writer<'_>, engagement: Option<&Engagement>) {
    w.u8(engagement.is_some().into());
    if let Some(engagement) = engagement {
        w.u64(engagement.number);
        w.u32(engagement.tool);
        w.u8(engagement.touches.into());
        w.f64(engagement.sync_error.value());
        w.u8(engagement.may_be_broken.into());
    }
}

/// `None`: none can be read; that there is none is something else.
#[allow(clippy::option_option)] // as said
fn read_engagement(r: &mut Reader<'_>) -> Option<Option<Engagement>> {
    if !r.flag()? {
        return Some(None);
    }
    let (number, tool, touches) = (r.u64()?, r.u32()?, r.flag()?);
    let (sync_error, may_be_broken) = (Length::mm(r.f64()?), r.flag()?);
    let is_possible = number > 0 && sync_error.is_finite() && sync_error >= Length::ZERO;
    is_possible.then_some(Some(Engagement { number, tool, touches, sync_error, may_be_broken }))
}

fn flags<const N: usize>(r: &mut Reader<'_>) -> Option<[bool; N]> {
    let mut flags = [false; N];
    for index in indices(r.u16()?, N)? {
        flags[index] = true;
    }
    Some(flags)
}

fn write_command(w: &mut Writer<'_>, command: &Command) {
    w.u16(mask(&command.axes));
    for axis in command.axes.iter().filter(|axis| **axis != AxisCommand::default()) {
        w.u8(axis.enable.into());
        w.f64s([axis.position.value(), axis.speed.value(), axis.force.value()]);
    }
    w.u16(mask(&command.spindles));
    for spindle in command.spindles.iter().filter(|one| **one != SpindleCommand::default()) {
        w.u8(spindle.enable.into());
        w.f64s([spindle.angle.value(), spindle.spin.value(), spindle.torque.value()]);
    }
    w.u32(command.tool);
    w.u8(command.flood.into());
    w.u8(command.mist.into());
    write_signals(w, &command.outputs);
    w.u8(command.coupled.is_some().into());
    if let Some(coupled) = &command.coupled {
        w.u8(coupled.axis);
        w.u8(coupled.spindle);
        w.f64s([coupled.angle.value(), coupled.place.value(), coupled.lead.value()]);
    }
}

/// What drives are told is a number, and of axes and spindles that there are.
fn read_command(r: &mut Reader<'_>) -> Option<Command> {
    let mut command = Command::default();
    for index in indices(r.u16()?, AXES)? {
        command.axes[index] = AxisCommand {
            enable: r.flag()?,
            position: Coordinate::new(r.finite()?),
            speed: CoordinateSpeed::new(r.finite()?),
            force: Force::n(r.finite()?),
        };
    }
    for index in indices(r.u16()?, SPINDLES)? {
        command.spindles[index] = SpindleCommand {
            enable: r.flag()?,
            angle: Angle::rev(r.finite()?),
            spin: Spin::rev_per_s(r.finite()?),
            torque: Torque::n_m(r.finite()?),
        };
    }
    command.tool = r.u32()?;
    command.flood = r.flag()?;
    command.mist = r.flag()?;
    command.outputs = read_signals(r)?;
    if !command.outputs.analogue.iter().all(|value| value.is_finite()) {
        return None;
    }
    command.coupled = if r.flag()? {
        let (axis, spindle) = (r.u8()?, r.u8()?);
        if usize::from(axis) >= AXES || usize::from(spindle) >= SPINDLES {
            return None;
        }
        Some(bus::Coupled {
            axis,
            spindle,
            angle: Angle::rev(r.finite()?),
            place: Length::mm(r.finite()?),
            lead: units::Lead::mm_per_rev(r.finite()?),
        })
    } else {
        None
    };
    Some(command)
}

fn write_signals(w: &mut Writer<'_>, signals: &Signals) {
    w.u64(signals.digital);
    w.u16(mask(&signals.analogue));
    for value in signals.analogue.iter().filter(|value| **value != 0.0) {
        w.f64(*value);
    }
}

fn read_signals(r: &mut Reader<'_>) -> Option<Signals> {
    let mut signals = Signals { digital: r.u64()?, ..Signals::default() };
    for index in indices(r.u16()?, ANALOGUE)? {
        signals.analogue[index] = r.f64()?;
    }
    Some(signals)
}

fn write_observed(w: &mut Writer<'_>, observed: &Observed) {
    let feedback = &observed.feedback;
    w.f64(feedback.time.value());
    w.u16(mask(&feedback.axes));
    for axis in feedback.axes.iter().filter(|axis| **axis != AxisFeedback::default()) {
        let [negative, positive] = axis.limit_switches;
        let (motor, index) = (axis.motor.is_some(), axis.index.is_some());
        w.u8(mask(&[axis.ready, motor, axis.home_switch, negative, positive, index]) as u8);
        w.f64(axis.position.value());
        for length in [axis.motor, axis.index].into_iter().flatten() {
            w.f64(length.value());
        }
    }
    w.u16(mask(&feedback.spindles));
    for spindle in feedback.spindles.iter().filter(|one| **one != SpindleFeedback::default()) {
        let flags = [spindle.ready, spindle.saturated, spindle.index.is_some()];
        w.u8(mask(&flags) as u8);
        w.f64(spindle.angle.value());
        if let Some(index) = spindle.index {
            w.f64(index.value());
        }
    }
    w.u8(feedback.tool.is_some().into());
    w.u32(feedback.tool.unwrap_or(0));
    w.u8(feedback.emergency_stop.into());
    w.u8(mask(&[feedback.probe, feedback.probe_age.is_some()]) as u8);
    feedback.probe_age.into_iter().for_each(|age| w.f64(age.value()));
    write_signals(w, &feedback.inputs);
    w.u8(observed.truth.is_some().into());
    if let Some(truth) = &observed.truth {
        write_truth(w, truth);
    }
}

fn read_observed(r: &mut Reader<'_>) -> Option<Observed> {
    let mut feedback = Feedback { time: Time::s(r.f64()?), ..Feedback::default() };
    for index in indices(r.u16()?, AXES)? {
        let flags = r.u8()?;
        if flags > 63 {
            return None;
        }
        feedback.axes[index] = AxisFeedback {
            ready: flags & 1 != 0,
            home_switch: flags & 4 != 0,
            limit_switches: [flags & 8 != 0, flags & 16 != 0],
            position: Coordinate::new(r.f64()?),
            motor: if flags & 2 == 0 { None } else { Some(Coordinate::new(r.f64()?)) },
            index: if flags & 32 == 0 { None } else { Some(Coordinate::new(r.f64()?)) },
        };
    }
    for index in indices(r.u16()?, SPINDLES)? {
        let flags = r.u8()?;
        if flags > 7 {
            return None;
        }
        feedback.spindles[index] = SpindleFeedback {
            ready: flags & 1 != 0,
            saturated: flags & 2 != 0,
            angle: Angle::rev(r.f64()?),
            index: if flags & 4 == 0 { None } else { Some(Angle::rev(r.f64()?)) },
        };
    }
    let (has_tool, tool) = (r.flag()?, r.u32()?);
    feedback.tool = has_tool.then_some(tool);
    feedback.emergency_stop = r.flag()?;
    let probe = r.u8()?;
    if probe > 3 {
        return None;
    }
    feedback.probe = probe & 1 != 0;
    feedback.probe_age = if probe & 2 == 0 { None } else { Some(Time::s(r.f64()?)) };
    feedback.inputs = read_signals(r)?;
    let truth = if r.flag()? { Some(read_truth(r)?) } else { None };
    Some(Observed { feedback, truth })
}
