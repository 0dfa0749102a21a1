//! Requests as a client writes them, and what the control is asked for.
use super::values::{axis_named, of_axis, share, system, wrong};
use crate::folder::Folder;
use control::job::restart::From as Begin;
use control::operation::hosted::RefusalData;
use control::operation::{Jog, Request, SequenceOrder, ToolField};
use serde::Deserialize;
use store::machine::MachineFile;
use units::{Angle, CoordinateSpeed, Spin};

/// Longest text of blocks that are typed.
const LONGEST_BLOCKS: usize = 16 * 1024;

/// A request: `{"request":"jog_increment","axis":"X","by_mm":10}`, of an axis that turns
/// `{"request":"jog_increment","axis":"A","by_deg":10}`.
#[derive(Clone, Debug, PartialEq, Deserialize, ts_rs::TS, utoipa::ToSchema)]
#[serde(tag = "request", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum RequestBody {
    /// Drives on or off.
    Power { on: bool },
    /// Press the emergency stop (true) or release it.
    EmergencyStop { on: bool },
    /// Home an axis, or all in the machine's order.
    Home {
        #[serde(default)]
        #[ts(optional)]
        axis: Option<String>,
    },
    /// Jog on and on: a lease of 200 ms, to be renewed every 100 ms or sooner.
    JogContinuous {
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        mm_per_min: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        deg_per_min: Option<f64>,
    },
    /// Jog by so much.
    JogIncrement {
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        by_mm: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        by_deg: Option<f64>,
    },
    /// Jog to a machine coordinate.
    JogTo {
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        to_mm: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        to_deg: Option<f64>,
    },
    /// Turn the handwheel: from where it has sent the axis so far.
    Handwheel {
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        by_mm: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        by_deg: Option<f64>,
    },
    /// Bring to rest what is moved by hand.
    JogStop {},
    /// Turn a spindle by hand: a lease like a jog.
    TurnSpindle { spindle: u32, rpm: f64 },
    /// Bring a spindle to an angle within its turn.
    OrientSpindle { spindle: u32, angle_deg: f64 },
    /// Load a program of the folder; `dialect`: it is written for another one than the machine's.
    Load {
        program: String,
        #[serde(default)]
        #[ts(optional)]
        dialect: Option<String>,
    },
    /// Find where the next start begins: at one of the three.
    Search {
        #[serde(default)]
        #[ts(optional)]
        line: Option<u32>,
        #[serde(default)]
        #[ts(optional)]
        hole: Option<u32>,
        #[serde(default)]
        #[ts(optional)]
        tool: Option<u32>,
        /// Also where the program was changed since it was left half done.
        #[serde(default)]
        #[ts(optional)]
        program_changed: Option<bool>,
    },
    /// Start the program that is loaded.
    Start {},
    /// Execute blocks.
    ManualDataInput { blocks: String },
    /// Hold the feed.
    FeedHold {},
    /// Go on after a hold or a block.
    Resume {},
    /// Go on after M0 or M1.
    Confirm {},
    /// Give the program up.
    Stop {},
    /// Back a tap out of its thread.
    Retract {},
    /// Take a tool out after drives, power or an encoder were gone.
    Recover {},
    /// State that no tool is in the work.
    ToolIsFree {},
    /// Lead a tool change that was left half way on to its end.
    SequenceGoOn {},
    /// Undo a tool change that was left half way.
    SequenceUndo {},
    /// Do the next step of it alone.
    SequenceStep {},
    /// Undo the step before alone.
    SequenceStepBack {},
    /// State that it was brought to rest by hand, with this tool in the spindle; 0 is none.
    SequenceDone { tool: u32 },
    /// State which pocket of the carousel is at the spindle.
    CarouselIsAt { pocket: u32 },
    /// State which tool is in a pocket; tool 0: none; pocket 0: the tool is not in the machine.
    SetPocket { pocket: u32, tool: u32 },
    /// Another workpiece is clamped: what is cut from now on counts for it.
    BeginWorkpiece {
        #[serde(default)]
        #[ts(optional)]
        name: Option<String>,
    },
    /// The workpiece is done: the next start begins another one.
    EndWorkpiece {},
    /// State that what is in force was compared with what the control wrote last.
    AcknowledgeState {},
    /// Clear alarms.
    Reset {},
    /// Hold after each block.
    SingleBlock { on: bool },
    /// Stop at M1.
    OptionalStop { on: bool },
    /// Switch the flood coolant, until the program does.
    Flood { on: bool },
    /// Switch the mist coolant, likewise.
    Mist { on: bool },
    /// Leave out blocks of a level of `/`, 1 to 9.
    BlockSkip { level: u8, on: bool },
    /// Percent of the programmed feed.
    FeedOverride { percent: f64 },
    /// Percent of the rapids.
    RapidOverride { percent: f64 },
    /// Percent of the programmed spindle speed.
    SpindleOverride { percent: f64 },
    /// The tool's tip is at this coordinate of the work offset in force.
    TouchOff {
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        at_mm: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        at_deg: Option<f64>,
    },
    /// Set the zero of a work offset, `G54` to `G59.3`, in machine coordinates.
    SetWorkOffset {
        work_offset: String,
        axis: String,
        #[serde(default)]
        #[ts(optional)]
        at_mm: Option<f64>,
        #[serde(default)]
        #[ts(optional)]
        at_deg: Option<f64>,
    },
    /// Set what the control believes of a tool.
    EditTool { tool: u32, field: ToolFieldName, value_mm: f64 },
    /// A new tool is in its place: its life begins anew, and it is not worn.
    RenewTool { tool: u32 },
    /// So many holes or threads a tool may cut; null: they are only counted.
    LimitTool { tool: u32, uses: Option<u32> },
}

/// What of a tool is edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ts_rs::TS, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ToolFieldName {
    /// From the gauge line to the tip.
    Length,
    /// Cutting diameter.
    Diameter,
    /// Wear of the length.
    WearLength,
    /// Wear of the radius.
    WearRadius,
}

/// Who a client is.
#[derive(Clone, Debug, Deserialize, ts_rs::TS, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SessionOrder {
    /// As the others see it.
    pub name: String,
    /// Its token, where the server asks for one.
    #[serde(default)]
    #[ts(optional)]
    pub token: Option<String>,
}

/// What a client does about the right to command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ts_rs::TS, utoipa::ToSchema)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum OperatorOrder {
    /// It asks for it.
    Ask {},
    /// Its holder hands it over.
    Grant {},
    /// Its holder keeps it.
    Keep {},
    /// Its holder gives it back.
    Release {},
}

impl RequestBody {
    /// It stops or holds something: allowed to every session of the role operator.
    pub(crate) const fn is_stop(&self) -> bool {
        matches!(
            self,
            Self::EmergencyStop { on: true } | Self::FeedHold {} | Self::Stop {} | Self::JogStop {}
        )
    }

    /// What the control is asked for.
    ///
    /// # Errors
    /// A value is out of its range: the sentence says which range works.
    #[allow(clippy::too_many_lines)] // a line or two for each request
    pub(crate) fn read(
        self,
        machine: &MachineFile,
        folder: &Folder,
    ) -> Result<Request, RefusalData> {
        let overrides = &machine.control.overrides;
        Ok(match self {
            Self::Power { on } => Request::Power(on),
            Self::EmergencyStop { on } => Request::EmergencyStop(on),
            Self::Home { axis } => {
                Request::Home(axis.map(|letter| axis_named(&letter, machine)).transpose()?)
            }
            Self::JogContinuous { axis, mm_per_min, deg_per_min } => {
                let named = ("mm_per_min", mm_per_min, "deg_per_min", deg_per_min);
                let (axis, per_min) = of_axis(&axis, machine, named)?;
                Request::Jog(axis, Jog::Continuous(CoordinateSpeed::per_min(per_min.value())))
            }
            Self::JogIncrement { axis, by_mm, by_deg } => {
                let (axis, by) = of_axis(&axis, machine, ("by_mm", by_mm, "by_deg", by_deg))?;
                Request::Jog(axis, Jog::Increment(by))
            }
            Self::JogTo { axis, to_mm, to_deg } => {
                let (axis, to) = of_axis(&axis, machine, ("to_mm", to_mm, "to_deg", to_deg))?;
                Request::Jog(axis, Jog::To(to))
            }
            Self::Handwheel { axis, by_mm, by_deg } => {
                let (axis, by) = of_axis(&axis, machine, ("by_mm", by_mm, "by_deg", by_deg))?;
                Request::Jog(axis, Jog::Handwheel(by))
            }
            Self::JogStop {} => Request::JogStop,
            Self::TurnSpindle { spindle, rpm } => {
                Request::TurnSpindle(spindle as usize, Spin::rpm(rpm))
            }
            Self::OrientSpindle { spindle, angle_deg } => {
                Request::OrientSpindle(spindle as usize, Angle::deg(angle_deg))
            }
            Self::Load { program, dialect } => load(folder, &program, dialect.as_deref())?,
            Self::Search { line, hole, tool, program_changed } => {
                let from = match (line, hole, tool) {
                    (Some(line), None, None) => Begin::Line(line),
                    (None, Some(hole), None) => Begin::Hole(hole),
                    (None, None, Some(tool)) => Begin::Tool(tool),
                    _ => return Err(wrong("a search names one of line, hole and tool".into())),
                };
                Request::Search(from, program_changed.unwrap_or(false))
            }
            Self::Start {} => Request::Start,
            Self::ManualDataInput { blocks } if blocks.len() > LONGEST_BLOCKS => {
                return Err(wrong(format!(
                    "blocks are {LONGEST_BLOCKS} bytes at most, found {}: load a program instead",
                    blocks.len()
                )));
            }
            Self::ManualDataInput { blocks } => Request::ManualDataInput(blocks),
            Self::FeedHold {} => Request::FeedHold,
            Self::Resume {} => Request::Resume,
            Self::Confirm {} => Request::Confirm,
            Self::Stop {} => Request::Stop,
            Self::Retract {} => Request::Retract,
            Self::Recover {} => Request::Recover,
            Self::ToolIsFree {} => Request::ToolIsFree,
            Self::SequenceGoOn {} => Request::Sequence(SequenceOrder::GoOn),
            Self::SequenceUndo {} => Request::Sequence(SequenceOrder::Undo),
            Self::SequenceStep {} => Request::Sequence(SequenceOrder::Step),
            Self::SequenceStepBack {} => Request::Sequence(SequenceOrder::StepBack),
            Self::SequenceDone { tool } => Request::Sequence(SequenceOrder::Done(tool)),
            Self::CarouselIsAt { pocket } => Request::Sequence(SequenceOrder::Carousel(pocket)),
            Self::SetPocket { pocket, tool } => {
                Request::Sequence(SequenceOrder::Pocket(pocket, tool))
            }
            Self::BeginWorkpiece { name } => Request::BeginWorkpiece(name),
            Self::EndWorkpiece {} => Request::EndWorkpiece,
            Self::AcknowledgeState {} => Request::AcknowledgeState,
            Self::Reset {} => Request::Reset,
            Self::SingleBlock { on } => Request::SingleBlock(on),
            Self::OptionalStop { on } => Request::OptionalStop(on),
            Self::Flood { on } => Request::Flood(on),
            Self::Mist { on } => Request::Mist(on),
            Self::BlockSkip { level, on } => Request::BlockSkip(level, on),
            Self::FeedOverride { percent } => Request::FeedOverride(share(
                "feed override",
                percent,
                0.0,
                overrides.feed_most_share,
            )?),
            Self::RapidOverride { percent } => {
                Request::RapidOverride(share("rapid override", percent, 0.0, 1.0)?)
            }
            Self::SpindleOverride { percent } => Request::SpindleOverride(share(
                "spindle override",
                percent,
                overrides.spindle_least_share,
                overrides.spindle_most_share,
            )?),
            Self::TouchOff { axis, at_mm, at_deg } => {
                let (axis, at) = of_axis(&axis, machine, ("at_mm", at_mm, "at_deg", at_deg))?;
                Request::TouchOff(axis, at)
            }
            Self::SetWorkOffset { work_offset, axis, at_mm, at_deg } => {
                let (axis, at) = of_axis(&axis, machine, ("at_mm", at_mm, "at_deg", at_deg))?;
                Request::SetWorkOffset(system(&work_offset)?, axis, at)
            }
            Self::EditTool { tool, field, value_mm } => {
                let field = match field {
                    ToolFieldName::Length => ToolField::Length,
                    ToolFieldName::Diameter => ToolField::Diameter,
                    ToolFieldName::WearLength => ToolField::WearLength,
                    ToolFieldName::WearRadius => ToolField::WearRadius,
                };
                Request::EditTool(tool, field, value_mm)
            }
            Self::RenewTool { tool } => Request::RenewTool(tool),
            Self::LimitTool { tool, uses } => Request::LimitTool(tool, uses),
        })
    }
}

/// A program of the folder, in the machine's dialect or another one.
fn load(folder: &Folder, program: &str, dialect: Option<&str>) -> Result<Request, RefusalData> {
    let path = folder.existing(program)?;
    match dialect {
        None => Ok(Request::Load(path)),
        Some(name) => {
            let dialect = control::job::dialect::named(name).map_err(wrong)?;
            Ok(Request::LoadAs(path, dialect))
        }
    }
}
