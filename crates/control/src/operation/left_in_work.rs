//! A tool that a control before this one has left in the work of a machine in another process: what
//! the operator sees of it, and its way out.
use super::control::Control;
use super::outside::{LeftInWork, Outside, OutsideKind, on_hal};
use super::request::{Accepted, Refusal};
use super::writer::Key;
use crate::job::Session;
use crate::job::restart::Restart;
use crate::outcome::unwritten_record;
use crate::recovery::{self, LeftTool, WayOut};
use crate::services::{RecordWriter, sync_record};
use bus::EngagedTool;
use store::sync_record::slots::Slots;
use store::sync_record::{Stage, SyncRecord};
use units::{Length, Time};

/// When the machine has certainly been told that a tool is out, the record says so, too.
const TOLD: Time = Time::s(0.010);

impl Control {
    /// A kernel in another process has begun a session: what it, the sync record and its encoders
    /// say of a tool in the work.
    pub(super) fn find_left_at_seat(&mut self) {
        if self.executor.machine.retained().is_none() {
            return;
        }
        let Self { executor, workpiece, .. } = self;
        executor.period(|_, _, sample| workpiece.sample(sample)); // where everything stands
        let Some(retained) = executor.machine.retained() else { return };
        let feedback = executor.machine.feedback();
        let (outside, said) = on_hal(&self.base.machine, &retained, feedback, &self.kept);
        self.outside = Some(outside);
        if let Some(said) = said {
            self.events.notice(said);
        }
    }

    /// Of what was kept of the machine's encoders, this holds.
    pub(super) fn epoch(&self) -> u64 {
        let simulated = |outside: &&Outside| outside.kind == OutsideKind::Simulator;
        // HAL's component does not know whether an axis has an encoder that keeps its count: the
        // machine's file says so
        self.outside.as_ref().filter(simulated).map_or(self.seed, |outside| outside.identity.epoch)
    }

    /// A control before this one has left a tool in the work, or may have.
    pub(super) fn is_tool_left(&self) -> bool {
        self.outside.as_ref().is_some_and(|outside| outside.left.is_some())
    }

    /// What is known of it.
    pub(super) fn left_in_work(&self) -> Option<LeftInWork> {
        let left = self.outside.as_ref()?.left.as_ref()?;
        let record = left.record();
        let (mut off, mut within, mut certain_by, mut whole) = (None, None, None, None);
        let mut refused = None;
        match left {
            LeftTool::OnThread(_, findings) => {
                match &findings.bound {
                    Ok((bound, why)) => {
                        off = Some(findings.stored.error(findings.at));
                        (within, certain_by) = (Some(*bound), Some(why.clone()));
                    }
                    Err(why) => certain_by = Some((*why).to_owned()),
                }
                whole.clone_from(&findings.not_known_whole);
            }
            LeftTool::OffWork(_, way) => match &way.off {
                Ok(found) => off = Some(found.length),
                Err(why) => certain_by = Some((*why).to_owned()),
            },
            LeftTool::Unmoved(_, why) => refused = Some(why.clone()),
        }
        let below = |place: Length, record: &SyncRecord| {
            let stroke = &record.stroke;
            let is_down = stroke.bottom < stroke.start;
            let below = if is_down { stroke.surface - place } else { place - stroke.surface };
            below.value()
        };
        let tap = record.filter(|record| record.stroke.retreat.is_none());
        let feedback = self.executor.machine.feedback();
        let stands = |record: &SyncRecord| {
            feedback.axes[usize::from(record.stroke.axis)].position.of_linear()
        };
        Some(LeftInWork {
            tool: record.map(|record| record.stroke.tool),
            program: record.map(|record| record.place.program.clone()),
            line: record.map(|record| record.place.line),
            hole: record.map(|record| record.place.hole),
            depth_mm: tap.map(|record| below(stands(record), record)),
            programmed_depth_mm: tap.map(|record| below(record.stroke.bottom, record)),
            off_thread_um: off.map(Length::in_um),
            within_um: within.map(Length::in_um),
            certain_by,
            moves_first: left.moves_first(),
            not_known_whole: whole,
            refused,
        })
    }

    /// How it is taken out, by record and encoders as they are now; `None`: no tool was left.
    pub(super) fn way_out_of_left(&mut self) -> Result<Option<WayOut>, Refusal> {
        let Some(outside) = self.outside.as_mut().filter(|outside| outside.left.is_some()) else {
            return Ok(None);
        };
        let machine = &self.base.machine;
        let Some(folder) = self.kept.folder() else {
            let why = outside.left.as_ref().map(|left| left.way_out(machine).err());
            return Err(Refusal::because(why.flatten().unwrap_or_default()));
        };
        if outside.left.as_ref().is_some_and(|left| left.record().is_some()) {
            // it may have been turned meanwhile
            outside.welcome.observed.feedback = *self.executor.machine.feedback();
            if let Ok(record) = outside.read(folder) {
                outside.look(record, folder.path(), machine);
            }
        }
        match &outside.left {
            Some(left) => {
                let way_out = left.way_out(machine).map_err(Refusal::because)?;
                outside.engagement = left.mark(outside.engagement);
                outside.welcome.evidence.in_work = outside.engagement;
                self.executor.machine.engage(outside.engagement);
                Ok(Some(way_out))
            }
            None => Err(Refusal::because("the encoders show the tool outside of the work")),
        }
    }

    /// A recovery has taken it out.
    pub(super) fn left_is_out(&mut self) {
        let Some(outside) = &mut self.outside else { return };
        // machine and record are told next
        let left = outside.left.take();
        if let Some(place) = left.as_ref().and_then(LeftTool::record).map(|record| &record.place) {
            self.events.notice(format!(
                "to go on: load {}, and search hole {}: its thread is cut again in the same groove",
                place.program, place.hole
            ));
        }
        self.take_homed();
    }

    /// A person has seen that no tool is in the work: record and machine forget it.
    pub(super) fn forget_left(&mut self) -> Result<(), Refusal> {
        let Some(outside) = &mut self.outside else { return Ok(()) };
        let Some(folder) = self.kept.folder() else {
            outside.left = None;
            return Ok(());
        };
        let (folder, no_tool) = (folder.for_record(), recovery::no_tool(&outside.identity));
        let discard = move |_: &mut _| {
            Slots::discard(folder, &no_tool)
                .map_err(|why| format!("the sync record cannot be discarded: {why}"))
        };
        self.kept.write(Key::Record, Box::new(discard)).map_err(Refusal::because)?;
        outside.left = None;
        Ok(())
    }

    /// What is left of a program's sync record is put on the disk.
    pub(super) fn keep_record(&mut self, record: Option<RecordWriter>) {
        let Some(record) = record else { return };
        let finish = move |_: &mut _| record.finish().map_or(Ok(()), |w| Err(unwritten_record(&w)));
        if let Err(why) = self.kept.write(Key::Record, Box::new(finish)) {
            self.events.notice(why);
        }
    }

    /// The loss of the machine that the operator has been told.
    pub(super) fn told_loss(&self) -> Option<String> {
        self.outside
            .as_ref()
            .filter(|outside| outside.has_told_loss)
            .and_then(|_| self.executor.machine.lost())
    }

    /// A period is over: machine and record hear that a tool is out, and the operator that the
    /// machine is gone.
    pub(super) fn follow_machine(&mut self) {
        let kernel = &self.executor.kernel;
        let stands = kernel.is_off() || kernel.is_standing();
        let is_out = self.under_way.is_none() && !self.is_recovering && stands;
        let is_out = is_out && !self.is_tap_in_thread();
        let (now, lost) = (self.now(), self.executor.machine.lost());
        let Some(outside) = &mut self.outside else { return };
        if is_out && outside.engagement.is_some() {
            outside.engagement = None;
            self.executor.machine.engage(None);
            outside.is_out = Some(now + TOLD);
        }
        if let Some(why) = lost.filter(|_| !outside.has_told_loss) {
            outside.has_told_loss = true;
            self.events.notice(why);
        }
        if outside.is_out.is_some_and(|due| now >= due) {
            outside.is_out = None;
            self.record_is_out();
        }
    }

    /// The record says that the tool is out.
    fn record_is_out(&mut self) {
        let (Some(outside), Some(folder)) = (&self.outside, self.kept.folder()) else { return };
        let (folder, identity) = (folder.for_record(), outside.identity.clone());
        let write = move |_: &mut _| {
            let Ok((mut slots, found)) = Slots::open(folder, &identity) else {
                return Ok(()); // it is not to be trusted: a start says so
            };
            let in_work = found.record.filter(|record| record.stage.is_in_work());
            let Some(record) = in_work else { return Ok(()) };
            slots.write(&SyncRecord { stage: Stage::Recovered, ..record }).map_err(|why| {
                format!(
                    "the tool is out, but the sync record cannot be written: {why}; free the disk"
                )
            })
        };
        if let Err(why) = self.kept.write(Key::Record, Box::new(write)) {
            self.events.notice(why);
        }
    }

    /// What keeps the sync record of a program that begins.
    pub(super) fn record_writer(
        &self,
        session: &Session,
        (name, text): (&str, &[u8]),
        restart: Option<&Restart>,
    ) -> Result<Option<RecordWriter>, Refusal> {
        let (Some(outside), Some(folder)) = (&self.outside, self.kept.folder()) else {
            return Ok(None);
        };
        if self.kept.is_writing_record() {
            let why = "the sync record of what was in the work before is still being written: ask again when the disk has taken it";
            return Err(Refusal::because(why));
        }
        let (slots, found) = Slots::open(folder.for_record(), &outside.identity)
            .map_err(|why| Refusal::because(why.to_string()))?;
        let texts = session.texts(text);
        let why = self.changed_since_recovery(found.record.as_ref(), name, &texts);
        if let Some(why) = why.filter(|_| restart.is_some()) {
            return Err(Refusal::because(why));
        }
        let checksum = texts.crc32();
        let of_this = |record: &SyncRecord| {
            record.stage == Stage::Recovered && record.place.checksum == checksum
        };
        let recovered = found.record.filter(|record| restart.is_some() && of_this(record));
        let known = (
            restart.map_or(0, |restart| restart.holes),
            recovered.map(|record| record.place.hole),
            outside.welcome.evidence.last,
        );
        let program = sync_record::Program { name, checksum, command: Vec::new() };
        let top = session.work_zero().linear[2] + session.machine.setup.stock.to[2];
        let identity = outside.identity.clone();
        let is_real_time = outside.welcome.real_time || self.options.real_time.is_some();
        RecordWriter::start(slots, identity, program, &session.tools, is_real_time, known, top)
            .map(Some)
            .map_err(|why| Refusal::because(why.to_string()))
    }

    /// What a program that is over has told the machine of tools in its work.
    pub(super) fn take_engagement(&mut self, engaged: Option<(u64, Option<EngagedTool>)>) {
        if let (Some(outside), Some((number, engagement))) = (&mut self.outside, engaged) {
            outside.welcome.evidence.last = number;
            outside.engagement = engagement;
        }
    }

    /// The chain of a machine in another process is not within reach: what moves is brought to rest
    /// instead, and that is said.
    pub(super) fn stop_instead(&mut self, pressed: bool) -> Result<Accepted, Refusal> {
        if !pressed {
            return Ok(Accepted::default());
        }
        let mut accepted = if self.under_way.is_some() { self.give_up() } else { self.stop_jog() }?;
        accepted.notes.push(
            "the emergency stop chain of this machine is its own: the control has brought what moves to rest instead"
                .into(),
        );
        Ok(accepted)
    }
}
