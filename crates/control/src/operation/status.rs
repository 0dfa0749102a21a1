//! How a control is: all that a panel shows, as plain values with their units in their names.
use super::control::Control;
use super::features::{FeatureCount, WorkpieceStatus, said_of};
use super::message::MessageStatus;
use super::offsets;
use super::state::{EmergencyStop, Execution, Mode, Need, Power};
use units::{Length, Spin, Time};
use verify::Feature;

/// An axis.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct AxisStatus {
    /// Its letter.
    pub letter: char,
    /// What its coordinates are measured in: `mm` or `deg`.
    pub unit: &'static str,
    /// Setpoint in machine coordinates.
    pub machine: f64,
    /// The tool's tip in the work offset in force.
    pub work: f64,
    /// Way to where the operation that is executed leads it, of a tap to its bottom; `None`: no
    /// program moves it.
    pub to_go: Option<f64>,
    /// It is homed.
    pub is_homed: bool,
    /// Setpoint less position by its encoder.
    pub following_error: f64,
    /// Force that its drive measures, in percent of what it can hold for ever, over 20 ms; `None`:
    /// it does not measure it, or the machine's file does not say what it can hold.
    pub load_percent: Option<f64>,
    /// How warm its drive is by its load, in percent of what it bears for ever.
    pub thermal_percent: Option<f64>,
}

/// A spindle.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct SpindleStatus {
    /// Speed that it is ordered to have, rev/min; positive is M3.
    pub ordered_rpm: f64,
    /// Speed by its encoder, rev/min, over 20 ms; positive is M3.
    pub measured_rpm: f64,
    /// Torque that its drive measures, else the torque commanded, N·m without its sign, over 20 ms;
    /// `None`: its drive is commanded by speed, and does not say its torque.
    pub torque_n_m: Option<f64>,
    /// The same in percent of what the drive can hold for ever at this speed.
    pub load_percent: Option<f64>,
    /// How warm its drive is by its load, in percent of what it bears for ever.
    pub thermal_percent: Option<f64>,
    /// Angle within its turn, degrees.
    pub angle_deg: f64,
}

/// What the operator has switched.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct Switches {
    /// Hold after each block.
    pub single_block: bool,
    /// Stop at M1.
    pub optional_stop: bool,
    /// Levels of `/`, 1 to 9, whose blocks the next start leaves out.
    pub block_skip: Vec<u8>,
}

/// A value that is in force and is not, or is not known to be, what the control wrote last.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct StateChangeStatus {
    /// Its name: `G54 X`, `tool 3 length_mm`; or the file, where nothing more is known.
    pub datum: String,
    /// As the control wrote it last.
    pub before: String,
    /// As it is in force.
    pub now: String,
    /// Which copy is in force, from when, and why.
    pub why: String,
}

/// Something that a request may need, and that is not so now.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct NeedStatus {
    /// Its name, as `GET machine` has it with the requests that need it.
    pub need: &'static str,
    /// Why such a request is refused now.
    pub reason: String,
    /// What would make it possible, where the reason does not say it.
    pub remedy: Option<String>,
}

/// What the operator has turned.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct Overrides {
    /// Percent of the programmed feed.
    pub feed_percent: f64,
    /// Percent of the rapids.
    pub rapid_percent: f64,
    /// Percent of the programmed spindle speed.
    pub spindle_percent: f64,
    /// A synchronised cut locks them now.
    pub is_locked: bool,
}

/// A wait.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct WaitingStatus {
    /// For what.
    pub what: String,
    /// For how long it has lasted, s.
    pub age_s: f64,
    /// How long it may last, s; `None`: as long as it takes.
    pub limit_s: Option<f64>,
}

/// A text that is being read and judged for a request.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct LoadingStatus {
    /// Its name; `MDI` of what was typed.
    pub name: String,
    /// How much of it is done, percent.
    pub percent: f64,
}

/// The program that is loaded or under way.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct ProgramStatus {
    /// Its name; `MDI` of what was typed.
    pub name: String,
    /// The line that is executed; 0 is none.
    pub line: u32,
    /// How long it is planned to take, s; `None`: a long program whose time is still being planned.
    pub planned_s: Option<f64>,
    /// For how long it has been under way, s.
    pub elapsed_s: f64,
    /// Planned time, at overrides of 100 %, of what is still to be done, s; `None`: as above.
    pub left_s: Option<f64>,
    /// How long what is planned, and waits to be executed, will take, s; what has no planned time
    /// counts nothing.
    pub ahead_s: f64,
}

/// The control.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
#[allow(clippy::struct_excessive_bools)] // each is shown by itself
pub struct Status {
    /// Machine time, s.
    pub time_s: f64,
    /// The emergency stop chain: `ARMED`, `TRIGGERED`.
    pub emergency_stop: &'static str,
    /// The drives: `OFF`, `ON`.
    pub power: &'static str,
    /// The drives are up, and nothing has stopped the machine.
    pub is_ready: bool,
    /// `AUTOMATIC`, `MANUAL_DATA_INPUT`, `MANUAL`.
    pub mode: &'static str,
    /// What the program does.
    pub execution: &'static str,
    /// What the axes do.
    pub activity: &'static str,
    /// What it waits for, since when, and for how long at most.
    pub waiting_for: Option<WaitingStatus>,
    /// The axes, X first.
    pub axes: Vec<AxisStatus>,
    /// The spindles.
    pub spindles: Vec<SpindleStatus>,
    /// Tool in the spindle; `None` while it is changed, 0 is none.
    pub tool: Option<u32>,
    /// The work offset in force.
    pub work_offset: String,
    /// Codes in force at the block that is executed; none are known of a program that asks the
    /// machine something.
    pub codes: Vec<String>,
    /// Coolant flows: flood.
    pub flood: bool,
    /// The same: mist.
    pub mist: bool,
    /// Speed of the path of X, Y and Z as it is ordered, mm/min, over 20 ms.
    pub path_mm_per_min: f64,
    /// Overrides.
    pub overrides: Overrides,
    /// Single block, optional stop, block skip.
    pub switches: Switches,
    /// The program.
    pub program: Option<ProgramStatus>,
    /// What is being read for a request that is not answered yet.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub loading: Option<LoadingStatus>,
    /// Distance of the follower from its coupling, while one is engaged in the material, µm.
    pub sync_error_um: Option<f64>,
    /// A tool that is tied to a spindle is in the work.
    pub is_tool_in_work: bool,
    /// What is known of it, where a control before this one has left it there.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub left_in_work: Option<super::LeftInWork>,
    /// The tool change that is under way or was left half way, where a sequence works it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub sequence: Option<super::SequenceStatus>,
    /// Where the tools are, where a sequence works the changer.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub magazine: Option<super::MagazineStatus>,
    /// What the program has said last to the operator, since it was started.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub message: Option<MessageStatus>,
    /// Features of the workpiece, over all programs that were started on it.
    pub features: FeatureCount,
    /// The workpiece.
    pub workpiece: WorkpieceStatus,
    /// Alarms that no reset has cleared.
    pub alarms: Vec<String>,
    /// What is in force and is not what the control wrote last: until it is acknowledged, no
    /// program, no blocks and no homing are started.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", ts(optional, as = "Option<Vec<StateChangeStatus>>"))]
    pub state_changes: Vec<StateChangeStatus>,
    /// What requests may need and is not so now.
    pub unmet: Vec<NeedStatus>,
    /// How the servo thread keeps its time, in real time.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", ts(optional))]
    pub real_time: Option<crate::RealTimeFigures>,
}

/// Codes in force, with those of the coolant that flows: it may have been switched by hand.
fn with_coolant(mut codes: Vec<String>, flows: [bool; 2]) -> Vec<String> {
    const CODES: [&str; 2] = ["M7", "M8"];
    let says = CODES.map(|code| codes.iter().any(|other| other == code));
    if says != flows {
        codes.retain(|code| !["M7", "M8", "M9"].contains(&code.as_str()));
        let on = CODES.iter().zip(flows).filter(|(_, flows)| *flows);
        codes.extend(on.map(|(code, _)| (*code).to_owned()));
        if flows == [false; 2] {
            codes.push("M9".into());
        }
    }
    codes
}

impl StateChangeStatus {
    fn of(change: &store::state::StateChange) -> Self {
        let store::state::StateChange { datum, before, now, why } = change.clone();
        Self { datum, before, now, why }
    }
}

impl Control {
    /// How it is.
    pub fn status(&self) -> Status {
        let kernel = &self.executor.kernel;
        let (feedback, report) = (self.executor.machine.feedback(), kernel.report());
        let operator = kernel.operator();
        Status {
            time_s: feedback.time.value(),
            emergency_stop: self.emergency_stop().name(),
            power: self.power.name(),
            is_ready: self.power == Power::On && kernel.is_ready(),
            mode: self.mode.name(),
            execution: self.execution.name(),
            activity: report.state.name(),
            waiting_for: kernel.waiting().map(|waiting| WaitingStatus {
                what: waiting.what.to_string(),
                age_s: waiting.age.value(),
                limit_s: waiting.limit.map(units::Time::value),
            }),
            axes: self.axes(feedback),
            spindles: self.spindles(feedback),
            tool: feedback.tool,
            work_offset: offsets::name(self.work_offset()),
            codes: self.codes(),
            flood: kernel.coolant()[1],
            mist: kernel.coolant()[0],
            path_mm_per_min: self.meters.path_speed() * 60.0,
            overrides: Overrides {
                feed_percent: percent(operator.share(false)),
                rapid_percent: percent(operator.share(true)),
                spindle_percent: percent(operator.spindle_share()),
                is_locked: kernel.engaged().is_some(),
            },
            switches: Switches {
                single_block: operator.single_block(),
                optional_stop: operator.optional_stop(),
                block_skip: self.options.program.block_skip.clone(),
            },
            program: self.program_status(report.line),
            loading: None,
            sync_error_um: report.sync_error.map(Length::in_um),
            is_tool_in_work: self.is_tap_in_thread(),
            left_in_work: self.left_in_work(),
            sequence: self.sequence_status(),
            magazine: self.magazine_status(),
            message: self.message.clone(),
            features: self.counted(),
            workpiece: self.workpiece_status(),
            alarms: self.uncleared(),
            state_changes: self.state_changes.iter().map(StateChangeStatus::of).collect(),
            unmet: self.unmet(),
            real_time: self.real_time(),
        }
    }

    /// Execution, mode, power and emergency stop.
    pub fn states(&self) -> (Execution, Mode, Power, EmergencyStop) {
        (self.execution, self.mode, self.power, self.emergency_stop())
    }

    fn codes(&self) -> Vec<String> {
        let codes = match (&self.under_way, &self.data.rest) {
            (Some(under_way), _) => under_way.codes(),
            (None, Some(rest)) => rest.standing().codes,
            (None, None) => return Vec::new(),
        };
        with_coolant(codes, self.executor.kernel.coolant())
    }

    fn unmet(&self) -> Vec<NeedStatus> {
        let unmet = |need: &Need| {
            let (reason, remedy) = self.meets(need).err()?.reason();
            Some(NeedStatus { need: need.name(), reason, remedy })
        };
        Need::ALL.iter().filter_map(unmet).collect()
    }

    fn uncleared(&self) -> Vec<String> {
        let uncleared = self.alarms.iter().filter(|alarm| !alarm.is_cleared);
        uncleared.map(|alarm| alarm.text.clone()).collect()
    }

    fn axes(&self, feedback: &bus::Feedback) -> Vec<AxisStatus> {
        let system = self.work_offset();
        let goal = self.under_way.as_ref().and_then(super::under_way::UnderWay::goal);
        let status = |axis: &store::machine::Axis| {
            let letter = axis.letter;
            let counted = feedback.axes[letter.index()].position;
            let read = counted + self.executor.kernel.shift(letter);
            let machine = self.executor.kernel.setpoint(letter).unwrap_or(read);
            AxisStatus {
                letter: letter.letter(),
                unit: letter.kind().unit_name(),
                machine: machine.value(),
                work: (machine - self.tip(letter) - self.zero_of(system, letter)).value(),
                to_go: goal.map(|goal| (goal.along(letter) - machine).value()),
                is_homed: self.is_homed(letter),
                following_error: (machine - read).value(),
                load_percent: self.meters.axis(letter).map(|drive| percent(drive.load)),
                thermal_percent: self.meters.axis(letter).map(|drive| percent(drive.thermal)),
            }
        };
        self.base.machine.axes.iter().flatten().map(status).collect()
    }

    fn spindles(&self, feedback: &bus::Feedback) -> Vec<SpindleStatus> {
        let kernel = &self.executor.kernel;
        // without power nothing is ordered
        let ordered = |index| if kernel.is_off() { Spin::ZERO } else { kernel.ordered_spin(index) };
        let spindles = self.base.machine.spindles.iter().zip(&feedback.spindles).enumerate();
        let status = |(index, (_, feedback)): (usize, (_, &bus::SpindleFeedback))| SpindleStatus {
            ordered_rpm: ordered(index).in_rpm(),
            measured_rpm: self.meters.speed(index).in_rpm(),
            torque_n_m: self.meters.spindle(index).map(|drive| drive.effort),
            load_percent: self.meters.spindle(index).map(|drive| percent(drive.load)),
            thermal_percent: self.meters.spindle(index).map(|drive| percent(drive.thermal)),
            angle_deg: (feedback.angle + kernel.spindle_shift(index)).value().rem_euclid(1.0)
                * 360.0,
        };
        spindles.map(status).collect()
    }

    fn program_status(&self, line: u32) -> Option<ProgramStatus> {
        if let Some(under_way) = &self.under_way {
            return Some(ProgramStatus {
                name: under_way.name.clone(),
                line,
                planned_s: under_way.timeline.as_ref().map(|timeline| timeline.planned().value()),
                elapsed_s: (self.now() - under_way.running.begun()).value(),
                left_s: under_way.left(self.now()).map(Time::value),
                ahead_s: under_way.running.ahead().value(),
            });
        }
        let loaded = self.loaded.as_ref()?;
        let planned_s = loaded.planned.map(Time::value);
        Some(ProgramStatus {
            name: loaded.name.clone(),
            line: 0,
            planned_s,
            elapsed_s: 0.0,
            left_s: planned_s,
            ahead_s: 0.0,
        })
    }

    /// What was cut from the workpiece so far, with its verdicts: the newest, and all of the last
    /// program.
    pub fn features(&self) -> Vec<Feature> {
        self.judged()
    }

    /// The same, a line each.
    pub fn features_said(&self) -> Vec<String> {
        self.judged().iter().map(said_of).collect()
    }

    /// A work offset as a program writes it.
    pub fn work_offset_name(&self, system: u8) -> String {
        offsets::name(system)
    }

    /// What may never happen and did.
    pub fn breaches(&self) -> Vec<String> {
        self.workpiece.watch.breaches().iter().map(ToString::to_string).collect()
    }

    /// How many of them.
    pub fn breach_count(&self) -> usize {
        match &self.under_way {
            Some(under_way) => under_way.running.breach_count(),
            None => self.workpiece.watch.breaches().len(),
        }
    }

    /// How many features were judged: another number means that there are others.
    pub fn feature_count(&self) -> usize {
        let FeatureCount { good, failed, not_judged } = self.counted();
        good + failed + not_judged
    }
}

fn percent(share: f64) -> f64 {
    share * 100.0
}
