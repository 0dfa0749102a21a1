//! Keeps the sync record on the disk while a program runs, beside the servo loop.
//!
//! ```text
//!   kernel ──request──► record_writer ──record──► thread: write, fsync, rename, fsync
//!          ◄──acknowledged──── record_writer ◄──done, or why not──┘
//! ```
//!
//! In lock-step simulated time stands while the disk works, so a fast disk and a slow one would
//! differ: there an acknowledgement comes `ALLOWANCE` after the request, by the machine's time,
//! whenever the disk is done before. In real time it comes when it comes.
use crate::Refused;
use crate::{KernelHandle, MachineHandle};
use bus::{EngagedTool, Feedback, State};
use canon::{Holder, Op, OpKind, ToolKind, ToolLibrary};
use kernel::{RecordRequest, WorkRecord};
use motion::TiedCut;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use store::sync_record::slots::{Kept, Slots, StateFolder};
use store::sync_record::{Cut, Geared, Identity, Place, Retreat, Stage, Stroke, SyncRecord};
use units::{Angle, Length, Stiffness, Time};

/// What a record may take to be on the disk: four times the median of an fsync'ed write on a
/// solid-state disk.
const ALLOWANCE: Time = Time::s(0.020);

/// The folder of a machine's state.
///
/// # Errors
/// None is named, and there is no home.
pub fn folder(named: Option<&Path>, identity: &Identity) -> Result<PathBuf, Refused> {
    if let Some(path) = named {
        return Ok(path.to_owned());
    }
    let variable = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let state = variable("XDG_STATE_HOME")
        .or_else(|| Some(variable("HOME")?.join(".local/state")))
        .ok_or_else(|| {
            Refused::because(
                "neither XDG_STATE_HOME nor HOME is set: name a state folder with --state",
            )
        })?;
    let machine: String = identity
        .machine
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' })
        .collect();
    Ok(state.join("leadscrew").join(format!("{machine}-{:x}", identity.serial)))
}

/// Open a machine's state; what it says of a tap in the work.
///
/// # Errors
/// A folder that cannot be used, and a record that is damaged or of another machine.
pub fn open(
    path: &Path,
    identity: &Identity,
) -> Result<Result<(Slots<StateFolder>, Kept), store::sync_record::Untrusted>, Refused> {
    Ok(Slots::open(StateFolder::open(path)?, identity))
}

/// Whether the record says that a tap is in the work, and the axis stands where it would be.
pub fn in_work(record: &SyncRecord, feedback: &bus::Feedback) -> bool {
    /// An axis that stands at PS within this is out.
    const AT_START: Length = Length::um(20.0);
    /// A tap whose tip stands higher over the surface than its holder gives is in the air: there
    /// its angle does not matter.
    const CLEAR: Length = Length::mm(1.0);
    let stroke = &record.stroke;
    if let Some(retreat) = stroke.retreat {
        let place = feedback.axes[usize::from(retreat.axis)].position.of_linear();
        return record.stage.is_in_work() && retreat.inside(place) > AT_START;
    }
    let z = feedback.axes[usize::from(stroke.axis)].position.of_linear();
    let below = if stroke.bottom < stroke.start { stroke.surface - z } else { z - stroke.surface };
    record.stage.is_in_work() && stroke.inside(z) > AT_START && below > -CLEAR
}

/// The program that a record is kept of.
pub struct Program<'a> {
    /// Its path, as it is shown.
    pub name: &'a str,
    /// CRC-32 of its texts.
    pub checksum: u32,
    /// The words that started it, for what goes on after a recovery.
    pub command: Vec<String>,
}

/// See the module's header.
pub struct RecordWriter {
    orders: Sender<(SyncRecord, Option<u32>)>,
    answers: Receiver<(Option<u32>, std::io::Result<()>)>,
    thread: JoinHandle<()>,
    identity: Identity,
    program: String,
    checksum: u32,
    tools: ToolLibrary,
    real_time: bool,
    /// Which hole an operation makes, counted from 1.
    holes: BTreeMap<u32, u32>,
    made: u32,
    /// Which gear an operation engages.
    gears: BTreeMap<u32, Geared>,
    /// What was typed.
    command: Vec<String>,
    /// The hole whose tap a recovery has taken out, and its operation once the program has come to
    /// it.
    recovered: (Option<u32>, Option<u32>),
    /// On the disk, and acknowledged as soon as the machine knows of the tool.
    written: VecDeque<u32>,
    /// Requests on their way: number, when they may be acknowledged, what is written.
    underway: VecDeque<(u32, Time, SyncRecord)>,
    last: Option<SyncRecord>,
    /// Number of the machine's last engagement, and the tool that the machine is told to be in its
    /// work.
    engaged: u64,
    engagement: Option<EngagedTool>,
    /// Where the workpiece begins, by the machine's set-up.
    top: Length,
    problem: Option<String>,
}

impl RecordWriter {
    /// Start the thread. `before`: holes that the program made before it was begun in its middle.
    /// `recovered`: the hole whose tap a recovery took out. `engaged`: number of the machine's last
    /// engagement. `top`: where the workpiece begins.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn start(
        mut slots: Slots<StateFolder>,
        identity: Identity,
        program: Program<'_>,
        tools: &ToolLibrary,
        real_time: bool,
        (before, recovered, engaged): (u32, Option<u32>, u64),
        top: Length,
    ) -> Result<Self, Refused> {
        let (orders, work) = channel::<(SyncRecord, Option<u32>)>();
        let (done, answers) = channel();
        let write = move || {
            for (record, number) in work {
                let written = slots.write(&record);
                if done.send((number, written)).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new()
            .name("record".into())
            .spawn(write)
            .map_err(|e| Refused::because(format!("cannot start the record's thread: {e}")))?;
        Ok(Self {
            orders,
            answers,
            thread,
            identity,
            program: program.name.to_owned(),
            checksum: program.checksum,
            tools: tools.clone(),
            real_time,
            holes: BTreeMap::new(),
            made: before,
            gears: BTreeMap::new(),
            command: program.command,
            recovered: (recovered, None),
            written: VecDeque::new(),
            underway: VecDeque::new(),
            last: None,
            engaged,
            engagement: None,
            top,
            problem: None,
        })
    }

    /// The program orders this.
    pub fn op(&mut self, index: u32, op: &Op) {
        if let Some(geared) = gear(&op.kind) {
            self.gears.insert(index, geared);
        }
        if matches!(op.kind, OpKind::Tap(_) | OpKind::Hole(_)) {
            self.made += 1;
            self.holes.insert(index, self.made);
            if self.recovered.0 == Some(self.made) {
                self.recovered.1 = Some(index);
            }
        }
    }

    /// The operation that makes a hole whose tap a recovery took out.
    pub const fn recovered(&self) -> Option<u32> {
        self.recovered.1
    }

    /// Take the kernel's requests, hand it its acknowledgements. The machine is told of the tool
    /// that is in the work from now on: from when the record is on the disk until the tool is out,
    /// and before the kernel may go in.
    pub fn serve(
        &mut self,
        kernel: &mut KernelHandle,
        machine: &mut MachineHandle,
        feedback: &Feedback,
    ) {
        let now = feedback.time;
        let shift = |axis: usize| kernel.shift(canon::Axis::ALL[axis]).of_linear();
        let shifts = Shifts {
            axes: std::array::from_fn(shift),
            spindles: std::array::from_fn(|spindle| kernel.spindle_shift(spindle)),
        };
        while let Some(request) = kernel.next_record_request() {
            let (record, number) = match (request, &self.last) {
                (RecordRequest::Inward(number, tap), _) => (self.record(&tap), Some(number)),
                (RecordRequest::Outward(number), Some(last)) => {
                    (SyncRecord { stage: Stage::Outward, ..last.clone() }, Some(number))
                }
                (RecordRequest::Out, Some(last)) => {
                    self.engagement = None;
                    machine.engage(None);
                    (SyncRecord { stage: Stage::Out, ..last.clone() }, None)
                }
                (RecordRequest::Outward(_) | RecordRequest::Out, None) => continue,
            };
            if let Some(number) = number {
                self.underway.push_back((number, now + ALLOWANCE, record.clone()));
            }
            self.last = Some(record.clone());
            // a thread that has ended has said why
            let _ = self.orders.send((as_encoders_read(record, &shifts), number));
        }
        self.acknowledge(kernel, machine, now);
        if let Some(engagement) = &mut self.engagement {
            let report = kernel.report();
            let taps = matches!(report.state, State::TapIn | State::TapBottom | State::TapOut);
            let inside =
                self.last.as_ref().map(|last| is_inside(last, &self.tools, self.top, feedback));
            engagement.touches = if taps { inside == Some(true) } else { engagement.touches };
            let error = report.sync_error.map_or(Length::ZERO, Length::abs);
            engagement.sync_error = engagement.sync_error.max(error);
        }
        machine.engage(self.engagement);
    }

    fn acknowledge(&mut self, kernel: &mut KernelHandle, machine: &mut MachineHandle, now: Time) {
        self.pass_on(kernel, machine);
        while let Some((number, due, _)) = self.underway.front() {
            let (number, due) = (*number, *due);
            let answer = if self.real_time {
                self.answers.try_recv()
            } else if now < due {
                return;
            } else {
                self.answers.recv().map_err(|_| TryRecvError::Disconnected)
            };
            match answer {
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    return self.fail(kernel, "its thread has ended");
                }
                Ok((_, Err(e))) => return self.fail(kernel, &e.to_string()),
                Ok((Some(done), Ok(()))) if done == number => {
                    if let Some((.., written)) = self.underway.pop_front() {
                        self.engage(&written);
                        machine.engage(self.engagement);
                    }
                    self.written.push_back(number);
                    self.pass_on(kernel, machine);
                }
                Ok((_, Ok(()))) => {}
            }
        }
    }

    /// The kernel hears that a record is on the disk, once the machine knows of the tool.
    fn pass_on(&mut self, kernel: &mut KernelHandle, machine: &MachineHandle) {
        while machine.has_engaged()
            && let Some(number) = self.written.pop_front()
        {
            kernel.acknowledge(number);
        }
    }

    /// A record is on the disk: its tool may go in, unless it has come out meanwhile.
    fn engage(&mut self, record: &SyncRecord) {
        let is_still = self
            .last
            .as_ref()
            .is_some_and(|last| last.engagement == record.engagement && last.stage.is_in_work());
        if is_still && self.engagement.is_none() {
            let (number, tool) = (record.engagement, record.stroke.tool);
            self.engaged = number;
            self.engagement = Some(EngagedTool { number, tool, ..EngagedTool::default() });
        }
    }

    fn fail(&mut self, kernel: &mut KernelHandle, why: &str) {
        self.underway.clear();
        self.problem.get_or_insert_with(|| why.to_owned());
        kernel.not_written();
    }

    fn record(&self, tap: &WorkRecord) -> SyncRecord {
        let tool = self.tools.get(tap.tool);
        let holder = tool.and_then(|tool| holder(&tool.kind));
        let mut geared = self.gears.get(&tap.op).cloned();
        if let (Some(geared), Some(ToolKind::PolygonCutter(cutter))) =
            (&mut geared, tool.map(|tool| &tool.kind))
        {
            geared.radius = cutter.radius;
        }
        // pecks of one tap are one engagement, and so is what is asked for anew before the tool has
        // gone in
        let goes_on = self.last.as_ref().filter(|l| l.place.op == tap.op && l.stage.is_in_work());
        let engagement = goes_on.map_or(self.engaged + 1, |last| last.engagement);
        SyncRecord {
            identity: self.identity.clone(),
            engagement,
            place: Place {
                program: self.program.clone(),
                checksum: self.checksum,
                op: tap.op,
                line: tap.line,
                hole: self.holes.get(&tap.op).copied().unwrap_or(0),
                command: self.command.clone(),
            },
            stage: Stage::Inward,
            stroke: Stroke {
                cut: match tap.cut {
                    None => Cut::Tap,
                    Some(TiedCut::Thread) => Cut::Thread,
                    Some(TiedCut::Cam) => Cut::Cam,
                    Some(TiedCut::Polygon) => Cut::Polygon,
                    Some(TiedCut::Gear) => Cut::Gear,
                    Some(TiedCut::FloatingTap) => Cut::FloatingTap,
                },
                retreat: tap.retreat.map(|(axis, clear, outward)| Retreat {
                    axis,
                    clear,
                    outward: outward > 0.0,
                }),
                axis: tap.axis,
                spindle: tap.spindle,
                tool: tap.tool,
                diameter: tool.map_or(Length::ZERO, |tool| tool.diameter),
                theta0: tap.theta0,
                z0: tap.z0,
                lead: tap.lead,
                growth: tap.growth,
                start: tap.start,
                bottom: tap.bottom,
                surface: tap.surface,
                spin: tap.spin,
                stiffness: holder.map_or(Stiffness::ZERO, Holder::stiffness),
                travel: holder.and_then(Holder::travel).unwrap_or_default(),
                thread_length: tool.map_or(Length::ZERO, |tool| thread_length(&tool.kind)),
                geared,
            },
        }
    }

    /// Number of the machine's last engagement, and the tool that the machine is told to be in its
    /// work.
    pub const fn engaged(&self) -> (u64, Option<EngagedTool>) {
        (self.engaged, self.engagement)
    }

    /// Wait until everything is on the disk; why something is not.
    pub fn finish(self) -> Option<String> {
        drop(self.orders);
        let mut problem = self.problem;
        while let Ok((_, written)) = self.answers.recv() {
            if let Err(e) = written {
                problem.get_or_insert_with(|| e.to_string());
            }
        }
        if let Err(panic) = self.thread.join() {
            std::panic::resume_unwind(panic); // a defect of ours: let it be seen as one
        }
        problem
    }
}

/// What was added to readings, near where they are, to make positions and angles of them.
struct Shifts {
    axes: [Length; bus::AXES],
    spindles: [Angle; bus::SPINDLES],
}

/// Places as the machine's own encoders read them: a control after this one knows them before
/// anything is homed.
fn as_encoders_read(mut record: SyncRecord, shifts: &Shifts) -> SyncRecord {
    let stroke = &mut record.stroke;
    let zero = shifts.axes[usize::from(stroke.axis)];
    stroke.theta0 -= shifts.spindles.get(usize::from(stroke.spindle)).copied().unwrap_or_default();
    for place in [&mut stroke.z0, &mut stroke.start, &mut stroke.bottom, &mut stroke.surface] {
        *place -= zero;
    }
    if let Some(retreat) = &mut stroke.retreat {
        retreat.clear -= shifts.axes[usize::from(retreat.axis)];
    }
    record
}

/// The gear that an operation engages.
fn gear(kind: &OpKind) -> Option<Geared> {
    match kind {
        OpKind::Polygon(polygon) => {
            let on_phase =
                polygon.oscillations.iter().filter(|o| o.on == canon::Oscillating::ToolPhase);
            let terms = on_phase.flat_map(|o| polygon.by_work(&o.harmonics));
            Some(Geared {
                follower: polygon.tool,
                turns: polygon.ratio.follower,
                master_turns: polygon.ratio.master,
                phase: polygon.phase,
                axis: None,
                radius: Length::ZERO, // of the cutter that the record names
                swing: terms.map(|h| (h.per_turn, h.cosine, h.sine)).collect(),
                swing_turns: polygon.period(),
            })
        }
        OpKind::Hob(hob) => Some(Geared {
            follower: hob.work,
            turns: hob.ratio().follower,
            master_turns: hob.ratio().master,
            phase: Angle::ZERO,
            axis: hob.lead().map(|lead| (canon::Axis::Z.index() as u8, lead * -1.0)),
            radius: hob.pitch_diameter() / 2.0,
            swing: Vec::new(),
            swing_turns: 1.0,
        }),
        _ => None,
    }
}

/// What holds a tap.
const fn holder(kind: &ToolKind) -> Option<Holder> {
    match kind {
        ToolKind::Tap(tap) => Some(tap.holder),
        ToolKind::Drill { .. }
        | ToolKind::SpotDrill { .. }
        | ToolKind::EndMill(_)
        | ToolKind::PolygonCutter(_)
        | ToolKind::Insert(_)
        | ToolKind::Hob(_)
        | ToolKind::Probe(_)
        | ToolKind::Other => None,
    }
}

/// The tip of a tap along Z is certainly in the workpiece: below where the program and the set-up
/// have it begin, by more than an axis' reading is off.
fn is_inside(record: &SyncRecord, tools: &ToolLibrary, top: Length, feedback: &Feedback) -> bool {
    const CERTAIN: Length = Length::mm(0.1);
    let stroke = &record.stroke;
    let length = tools.get(stroke.tool).map_or(Length::ZERO, canon::Tool::worn_length);
    let place = feedback.axes[usize::from(stroke.axis)].position.of_linear();
    if usize::from(stroke.axis) != canon::Axis::Z.index() || stroke.bottom > stroke.start {
        return stroke.inside(place) > stroke.inside(stroke.surface) + CERTAIN;
    }
    place < stroke.surface.min(top + length) - CERTAIN
}

/// How long the thread of a tap is.
const fn thread_length(kind: &ToolKind) -> Length {
    match kind {
        ToolKind::Tap(tap) => tap.thread_length,
        ToolKind::Drill { .. }
        | ToolKind::SpotDrill { .. }
        | ToolKind::EndMill(_)
        | ToolKind::PolygonCutter(_)
        | ToolKind::Insert(_)
        | ToolKind::Hob(_)
        | ToolKind::Probe(_)
        | ToolKind::Other => Length::ZERO,
    }
}
