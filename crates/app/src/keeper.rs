//! Keeps the sync record on the disk while a program runs, beside the servo loop.
//!
//! ```text
//!   kernel ──wish──► keeper ──record──► thread: write, fsync, rename, fsync
//!          ◄──acknowledged──── keeper ◄──done, or why not──┘
//! ```
//!
//! In lock-step simulated time stands while the disk works, so a fast disk and a slow one would differ: there an
//! acknowledgement comes [`ALLOWANCE`] after the wish, by the machine's time, whenever the disk is done before. In real
//! time it comes when it comes.
use crate::refused::Refused;
use crate::typed;
use canon::{Holder, Op, OpKind, ToolKind, ToolLibrary};
use kernel::{Kernel, Wish, WorkRecord};
use plan::TiedCut;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use store::sync_record::slots::{Kept, Slots, StateFolder};
use store::sync_record::{Cut, Geared, Identity, Place, Retreat, Stage, Stroke, SyncRecord};
use units::{Angle, Length, Stiffness, Time};

/// What a record may take to be on the disk: four times the median of an fsync'ed write on a solid-state disk.
const ALLOWANCE: Time = Time::s(0.020);

/// The folder of a machine's state.
///
/// # Errors
/// None is named, and there is no home.
pub(crate) fn folder(named: Option<&Path>, identity: &Identity) -> Result<PathBuf, Refused> {
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
pub(crate) fn open(
    path: &Path,
    identity: &Identity,
) -> Result<Result<(Slots<StateFolder>, Kept), store::sync_record::Untrusted>, Refused> {
    Ok(Slots::open(StateFolder::open(path)?, identity))
}

/// Whether the record says that a tap is in the work, and the axis stands where it would be.
pub(crate) fn in_work(record: &SyncRecord, feedback: &bus::Feedback) -> bool {
    /// An axis that stands at PS within this is out.
    const AT_START: Length = Length::um(20.0);
    /// A tap whose tip stands higher over the surface than its holder gives is in the air: there its angle does not matter.
    const CLEAR: Length = Length::mm(1.0);
    let stroke = &record.stroke;
    if let Some(retreat) = stroke.retreat {
        let place = feedback.axes[usize::from(retreat.axis)].position;
        return record.stage.is_in_work() && retreat.inside(place) > AT_START;
    }
    let z = feedback.axes[usize::from(stroke.axis)].position;
    let below = if stroke.bottom < stroke.start { stroke.surface - z } else { z - stroke.surface };
    record.stage.is_in_work() && stroke.inside(z) > AT_START && below > -CLEAR
}

/// See the module's header.
pub(crate) struct Keeper {
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
    /// The hole whose tap a recovery has taken out, and its operation once the program has come to it.
    recovered: (Option<u32>, Option<u32>),
    /// Wishes on their way: number, and when they may be acknowledged.
    underway: VecDeque<(u32, Time)>,
    last: Option<SyncRecord>,
    problem: Option<String>,
}

impl Keeper {
    /// Start the thread. `before`: holes that the program made before it was begun in its middle. `recovered`: the hole
    /// whose tap a recovery took out.
    ///
    /// # Errors
    /// No thread can be started.
    pub(crate) fn start(
        mut slots: Slots<StateFolder>,
        identity: Identity,
        program: (&str, &[u8]),
        tools: &ToolLibrary,
        real_time: bool,
        before: u32,
        recovered: Option<u32>,
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
            program: program.0.to_owned(),
            checksum: crc32fast::hash(program.1),
            tools: tools.clone(),
            real_time,
            holes: BTreeMap::new(),
            made: before,
            gears: BTreeMap::new(),
            command: typed::of_this_run(),
            recovered: (recovered, None),
            underway: VecDeque::new(),
            last: None,
            problem: None,
        })
    }

    /// The program orders this.
    pub(crate) fn op(&mut self, index: u32, op: &Op) {
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
    pub(crate) const fn recovered(&self) -> Option<u32> {
        self.recovered.1
    }

    /// Take the kernel's wishes, hand it its acknowledgements.
    pub(crate) fn serve(&mut self, kernel: &mut Kernel, now: Time) {
        while let Some(wish) = kernel.next_wish() {
            let (record, number) = match (wish, &self.last) {
                (Wish::Inward(number, tap), _) => (self.record(&tap), Some(number)),
                (Wish::Outward, Some(last)) => {
                    (SyncRecord { stage: Stage::Outward, ..last.clone() }, None)
                }
                (Wish::Out, Some(last)) => (SyncRecord { stage: Stage::Out, ..last.clone() }, None),
                (Wish::Outward | Wish::Out, None) => continue,
            };
            if let Some(number) = number {
                self.underway.push_back((number, now + ALLOWANCE));
            }
            self.last = Some(record.clone());
            // a thread that has ended has said why
            let _ = self.orders.send((record, number));
        }
        while let Some(&(number, due)) = self.underway.front() {
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
                    self.underway.pop_front();
                    kernel.acknowledge(number);
                }
                Ok((_, Ok(()))) => {}
            }
        }
    }

    fn fail(&mut self, kernel: &mut Kernel, why: &str) {
        self.underway.clear();
        self.problem.get_or_insert_with(|| why.to_owned());
        kernel.not_written();
    }

    fn record(&self, tap: &WorkRecord) -> SyncRecord {
        let tool = self.tools.get(tap.tool);
        let mut geared = self.gears.get(&tap.op).cloned();
        if let (Some(geared), Some(ToolKind::PolygonCutter(cutter))) =
            (&mut geared, tool.map(|tool| &tool.kind))
        {
            geared.radius = cutter.radius;
        }
        SyncRecord {
            identity: self.identity.clone(),
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
                stiffness: tool.map_or(Stiffness::ZERO, |tool| stiffness(&tool.kind)),
                geared,
            },
        }
    }

    /// Wait until everything is on the disk; why something is not.
    pub(crate) fn finish(self) -> Option<String> {
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

/// The gear that an operation engages.
fn gear(kind: &OpKind) -> Option<Geared> {
    match kind {
        OpKind::Polygon(polygon) => {
            let on_phase =
                polygon.oscillations.iter().filter(|o| o.on == canon::Oscillating::ToolPhase);
            let terms = on_phase.flat_map(|o| &o.harmonics);
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

/// Axial stiffness of what holds a tap.
fn stiffness(kind: &ToolKind) -> Stiffness {
    match kind {
        ToolKind::Tap(tap) => match tap.holder {
            Holder::Rigid { stiffness }
            | Holder::SoftSynchro { stiffness, .. }
            | Holder::TensionCompression { stiffness, .. }
            | Holder::Clutch { stiffness, .. } => stiffness,
        },
        ToolKind::Drill { .. }
        | ToolKind::SpotDrill { .. }
        | ToolKind::EndMill
        | ToolKind::PolygonCutter(_)
        | ToolKind::Insert(_)
        | ToolKind::Other => Stiffness::ZERO,
    }
}

/// Where the tool of a record is.
pub(crate) fn whereabouts(record: &SyncRecord) -> String {
    let Place { program, line, hole, .. } = &record.place;
    match record.stroke.cut {
        Cut::Tap => format!("hole {hole} of {program} (line {line})"),
        cut => format!("the work, {} of {program} (line {line})", cut.name()),
    }
}

/// The option that names a record's machine as it was named then, where it is not the usual one.
pub(crate) fn option_machine(record: &SyncRecord) -> String {
    let machine = &record.identity.machine;
    match typed::value(&record.place.command, "--machine") {
        Some(named) => format!(" --machine {}", typed::quoted(named)),
        None if machine == crate::recover::USUAL => String::new(),
        None => format!(" --machine {}", typed::quoted(machine)),
    }
}

/// What is said where a tap is in the work and somebody wants to move something else.
pub(crate) fn interlock(record: &SyncRecord, iron: &Path, state: Option<&Path>) -> Refused {
    let state = state.map_or_else(String::new, |path| format!(" --state {}", path.display()));
    let machine = option_machine(record);
    Refused::because(format!(
        "tool {} is in {}: nothing but recovery may move\n  take it out with: leadscrew recover --iron {}{machine}{state}",
        record.stroke.tool,
        whereabouts(record),
        iron.display(),
    ))
}

/// What is said where nobody can tell.
pub(crate) fn unsure(
    why: &store::sync_record::Untrusted,
    iron: &Path,
    state: Option<&Path>,
) -> Refused {
    if let store::sync_record::Untrusted::OtherMachine { .. } = why {
        return Refused::because(format!("{why}\n  name this machine's own folder with --state"));
    }
    let state = state.map_or_else(String::new, |path| format!(" --state {}", path.display()));
    let machine = typed::value(&typed::of_this_run(), "--machine")
        .map_or_else(String::new, |named| format!(" --machine {}", typed::quoted(named)));
    Refused::because(format!(
        "{why}\n  whether a tap is in the work is not known, so nothing may move. See for yourself; once no tool is in the work: leadscrew recover --iron {}{machine}{state} --discard-record",
        iron.display(),
    ))
}
