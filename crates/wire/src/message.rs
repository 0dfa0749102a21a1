//! What is said.
use bus::{AXES, Command, EngagedTool, EngagementEvidence, Feedback, RunDownKind, SPINDLES, Truth};
use serde::{Deserialize, Serialize, Serializer};
use units::{Length, Time};

/// Longest name.
const LONGEST_NAME: usize = 255;
/// Longest text.
const LONGEST_TEXT: usize = 8192;

/// A frame's content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // one at a time, on the stack; boxes would be made each period
pub enum Message {
    /// A control reports.
    Hello(Hello),
    /// The machine simulator takes it.
    Welcome(Welcome),
    /// The machine simulator does not, or has stopped: one sentence.
    Refused(#[serde(serialize_with = "cut_text")] String),
    /// What the machine shall do for a period, and which tool the control has in the work.
    Command(Command, Option<EngagedTool>),
    /// What came of it.
    Observed(Observed),
    /// Something for the machine simulator itself, instead of a session.
    Order(Order),
    /// Its answer, as JSON.
    Told(#[serde(serialize_with = "cut_text")] String),
    /// Between two periods of a session: a person has put a new tool of this number in the place of
    /// the old one. The answer is what is observed.
    RenewTool(u32),
}

/// Who controls.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// For people.
    #[serde(serialize_with = "cut_name")]
    pub name: String,
    /// The machine it is set up for.
    #[serde(serialize_with = "cut_name")]
    pub machine: String,
}

/// Which machine it is, and what its encoders know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Welcome {
    /// Name in its file.
    #[serde(serialize_with = "cut_name")]
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
    /// How the drives came to rest when they were left alone; of several times since a tool went
    /// into the work, the one that leaves least certain how far it is from its coupling.
    pub stop: RunDownKind,
    /// Whether a tool is in the work.
    pub evidence: EngagementEvidence,
    /// Where everything stands.
    pub observed: Observed,
}

/// One period, as the machine simulator has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observed {
    /// What it says.
    pub feedback: Feedback,
    /// What it knows besides, if it is simulated.
    pub truth: Option<Truth>,
}

/// Something for the machine simulator itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Order {
    /// Say how it is.
    Status,
    /// Cut the power and give it back.
    PowerCut,
    /// End.
    Quit,
    /// A person has seen that no tool is in the work.
    ToolIsFree,
}

impl Message {
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
            Self::RenewTool(_) => "a new tool",
        }
    }

    /// What drives are told is a number, and of axes and spindles that there are; a tool in the
    /// work has a number.
    pub(crate) fn makes_sense(&self) -> bool {
        match self {
            Self::Command(command, engagement) => {
                obeys(command) && engagement.is_none_or(|it| makes_sense(&it))
            }
            Self::Welcome(welcome) => {
                welcome.evidence.in_work.is_none_or(|tool| makes_sense(&tool))
            }
            _ => true,
        }
    }
}

/// True of a tool that can be in the work.
fn makes_sense(tool: &EngagedTool) -> bool {
    tool.number > 0 && tool.sync_error.is_finite() && tool.sync_error >= Length::ZERO
}

/// Whether drives can obey.
fn obeys(command: &Command) -> bool {
    let axes = command
        .axes
        .iter()
        .all(|axis| axis.position.is_finite() && axis.speed.is_finite() && axis.force.is_finite());
    let spindles = command.spindles.iter().all(|spindle| {
        let turned = spindle.orient.is_none_or(|to| to.angle.is_finite());
        spindle.angle.is_finite()
            && spindle.spin.is_finite()
            && spindle.torque.is_finite()
            && turned
    });
    let coupled = command.coupled.is_none_or(|it| {
        usize::from(it.axis) < AXES
            && usize::from(it.spindle) < SPINDLES
            && it.angle.is_finite()
            && it.place.is_finite()
            && it.lead.is_finite()
    });
    axes && spindles && coupled && command.outputs.analogue.iter().all(|value| value.is_finite())
}

/// A text cut to so many bytes, between two characters.
fn cut<S: Serializer, const LONGEST: usize>(text: &str, to: S) -> Result<S::Ok, S::Error> {
    let end = (0..=text.len().min(LONGEST)).rev().find(|at| text.is_char_boundary(*at));
    to.serialize_str(&text[..end.unwrap_or(0)])
}

fn cut_name<S: Serializer>(name: &str, to: S) -> Result<S::Ok, S::Error> {
    cut::<S, LONGEST_NAME>(name, to)
}

fn cut_text<S: Serializer>(text: &str, to: S) -> Result<S::Ok, S::Error> {
    cut::<S, LONGEST_TEXT>(text, to)
}
