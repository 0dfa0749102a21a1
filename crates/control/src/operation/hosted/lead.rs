//! The control's thread: what is asked for, periods by the clock, a picture 50 times a second.
use super::journal::Journal;
use super::loads::{BrokenOff, LoadMark, Loads};
use super::picture::Picture;
use super::recording::{Recording, SignalRows};
use super::refusal::RefusalData;
use super::renewal::{self, Renewal};
use super::stops::{StopMark, Stops};
use super::timing::{self, UnderTiming};
use super::{HostOptions, RequestAnswer, Shared, held};
use crate::Refused;
use crate::clock::now;
use crate::job::Interruption;
use crate::operation::writer::Ticket;
use crate::operation::{
    Accepted, Begun, Control, ControlOptions, EndedProgram, Event, Proven, Proving, Refusal,
    Request, Signals, Timed,
};
use std::sync::atomic::AtomicU64;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use units::Time;

/// The control is looked after so often.
const TURN: Duration = Duration::from_millis(2);
/// A picture is made so often.
const PICTURE: Duration = Duration::from_millis(20);
/// A machine that is further behind the clock than this gives up the rest.
const MOST_BEHIND: Duration = Duration::from_millis(100);
/// What was asked for meanwhile is looked at after so much time on the wall at the latest.
const LONGEST_TURN: Duration = Duration::from_millis(10);
/// How long moving things may take to come to rest at the end, machine time.
const COMES_TO_REST: Time = Time::s(120.0);

/// Where an answer goes.
pub(super) type Answered = Box<dyn FnOnce(RequestAnswer) + Send>;

/// Texts that wait to be proved; one more is refused.
const MOST_TEXTS: usize = 4;

/// A request that waits for its turn.
pub(super) struct WaitingRequest {
    pub(super) request: Request,
    /// Who asked is gone.
    pub(super) is_gone: Interruption,
    /// The stops that were asked for before it.
    pub(super) after: StopMark,
    pub(super) answer: Answered,
}

/// What the control's thread is told.
pub(super) enum Job {
    /// A request.
    Request(WaitingRequest),
    /// A text is proved that a request needs.
    Proven(Box<Proven>, ForWhom),
    /// The program that is loaded is proved again, or was broken off.
    Renewed(Box<Proven>),
    /// The time of a long program is planned, or that was broken off.
    Timed(Box<Timed>),
    /// Something of a front end in the same process.
    Work(Box<dyn FnOnce(&mut Control) + Send>),
    /// The last one.
    End,
}

/// Which of the texts that are proved it is, and the request that it is proved for.
type ForWhom = (LoadMark, WaitingRequest);
/// A text that is to be proved, and for whom.
type Text = (Box<Proving>, Option<ForWhom>);

/// The thread that proves texts, one after another, until the control's thread has ended.
fn prove(texts: &Receiver<Text>, jobs: &SyncSender<Job>) {
    while let Ok((text, whom)) = texts.recv() {
        let proven = Box::new(text.prove());
        let job = match whom {
            Some(whom) => Job::Proven(proven, whom),
            None => Job::Renewed(proven),
        };
        if jobs.send(job).is_err() {
            return;
        }
    }
}

/// The thread, from its start to its end.
pub(super) fn run(
    options: ControlOptions,
    mut host: HostOptions,
    up: &Sender<Result<Arc<Shared>, Refused>>,
    jobs: SyncSender<Job>,
    asked: &Receiver<Job>,
) {
    let (texts, unproved) = sync_channel(MOST_TEXTS);
    let prover = std::thread::Builder::new().name("proving".into());
    let proved = jobs.clone();
    if let Err(e) = prover.spawn(move || prove(&unproved, &proved)) {
        // who started it is gone
        let _ = up.send(Err(Refused::because(format!("cannot start a thread: {e}"))));
        return;
    }
    let mut control = match Control::new(options) {
        Ok(control) => control,
        Err(refused) => {
            let _ = up.send(Err(refused)); // who started it is gone
            return;
        }
    };
    if let Some(recording) = &host.recording {
        control.record_programs(recording.folder.clone());
    }
    control.keep_beside(std::mem::replace(&mut host.before_write, Box::new(|| ())));
    let signals = Signals::of(&control);
    let (lane, has_chain) = control.stops();
    let shared = Arc::new(Shared {
        picture: Mutex::new(Arc::new(Picture::first(&control))),
        journal: Mutex::new(Journal::default()),
        recording: Recording::default(),
        machine: control.machine().clone(),
        signals,
        stops: Stops::new(lane, has_chain),
        panel_count: AtomicU64::default(),
    });
    if up.send(Ok(Arc::clone(&shared))).is_ok() {
        let mut lead = Lead::new(control, (texts, jobs), shared, host);
        lead.until_end(asked);
        lead.come_to_rest();
    }
}

pub(super) struct Lead {
    pub(super) control: Control,
    /// To the thread that proves texts.
    texts: SyncSender<Text>,
    /// The one that is on its way.
    renewal: Option<Renewal>,
    /// Texts that are proved for a request.
    loads: Loads,
    /// What it tells itself from other threads.
    pub(super) jobs: SyncSender<Job>,
    /// The program whose time is being planned.
    timing: Option<UnderTiming>,
    /// When something was asked for last.
    asked: Instant,
    pub(super) shared: Arc<Shared>,
    host: HostOptions,
    /// The servo thread gives the time: periods are only looked at.
    is_real_time: bool,
    /// In lock-step machine time passes as on the wall: from this moment, at which it was this.
    clock: (Instant, Time),
    /// When the next picture is due.
    due: Instant,
    /// Something was asked for or has happened since the last one.
    has_changed: bool,
    /// Number of the next row, and the rows since the last picture.
    row: u64,
    rows: SignalRows,
}

impl Lead {
    fn new(
        control: Control,
        (texts, jobs): (SyncSender<Text>, SyncSender<Job>),
        shared: Arc<Shared>,
        host: HostOptions,
    ) -> Self {
        let (start, rows) = (now(), SignalRows::default());
        let clock = (start, control.now());
        let is_real_time = control.real_time().is_some();
        Self {
            control,
            texts,
            renewal: None,
            loads: Loads::default(),
            jobs,
            timing: None,
            asked: start,
            shared,
            host,
            is_real_time,
            clock,
            due: start,
            has_changed: true,
            row: 0,
            rows,
        }
    }

    fn until_end(&mut self, asked: &Receiver<Job>) {
        loop {
            match asked.recv_timeout(TURN) {
                Ok(job) => {
                    // however much is asked for, the machine is looked after in between
                    let (end, mut next) = (now() + TURN, Some(job));
                    while let Some(job) = next {
                        self.stop();
                        if !self.answer(job) {
                            return;
                        }
                        next = if now() < end { asked.try_recv().ok() } else { None };
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            self.stop();
            self.keep_up();
            if now() >= self.due {
                self.publish();
                self.renew();
                self.time();
            }
        }
    }

    /// False: it was the last one.
    fn answer(&mut self, job: Job) -> bool {
        match job {
            Job::Request(asked) => {
                self.asked = now();
                if asked.request == Request::Reset {
                    self.break_off(BrokenOff::Reset);
                }
                self.begin(asked);
                true
            }
            Job::Proven(proven, (mark, asked)) => {
                if let Some(why) = self.loads.end(&mark) {
                    (asked.answer)(Err(RefusalData::broken_off(why)));
                } else if let Some(asked) = self.still_due(asked) {
                    let kept = self.control.last_kept();
                    let answered = self.control.complete(*proven);
                    self.tell(answered, kept, asked.answer);
                }
                true
            }
            Job::Renewed(proven) => {
                if let Some(renewal) = self.renewal.take() {
                    if !renewal.is_stopped() {
                        self.control.renew(*proven);
                    }
                    for asked in renewal.over() {
                        self.answer(Job::Request(asked));
                    }
                }
                true
            }
            Job::Timed(timed) => {
                self.control.timed(*timed);
                self.has_changed = true;
                true
            }
            Job::Work(work) => {
                work(&mut self.control);
                self.take_events();
                self.has_changed = true;
                true
            }
            Job::End => false,
        }
    }

    fn begin(&mut self, asked: WaitingRequest) {
        let Some(asked) = self.still_due(asked) else { return };
        let kept = self.control.last_kept();
        match self.control.begin(&asked.request) {
            Begun::Answered(answered) => self.tell(answered, kept, asked.answer),
            Begun::Proving(text) => self.prove(asked, text),
        }
    }

    /// A request is refused where a stop has overtaken it that is meant for it.
    fn still_due(&self, asked: WaitingRequest) -> Option<WaitingRequest> {
        let Some(stop) = self.shared.stops.since(asked.after, &asked.request) else {
            return Some(asked);
        };
        (asked.answer)(Err(RefusalData::overtaken(stop)));
        None
    }

    /// Breaks off every request whose text is still read, also those that wait for a renewal: no
    /// program starts after the stop. True if there was one.
    fn break_off(&mut self, why: BrokenOff) -> bool {
        let waiting = self.renewal.as_mut().map(Renewal::take_waiting).unwrap_or_default();
        let is_reading = self.loads.break_off(why) || !waiting.is_empty();
        for asked in waiting {
            (asked.answer)(Err(RefusalData::broken_off(why)));
        }
        is_reading
    }

    /// A text is to be proved before a request is answered.
    fn prove(&mut self, asked: WaitingRequest, text: Box<Proving>) {
        if let Some(renewal) = &mut self.renewal {
            if renewal.is_of(&text) && renewal.waiting() < MOST_TEXTS {
                return renewal.wait(asked);
            }
            renewal.stop();
        }
        let of = (&asked.request, text.name());
        let (mark, interruption) = self.loads.begin(of, asked.is_gone.clone());
        let text = Box::new(text.unless(interruption));
        if let Err(TrySendError::Full((_, whom)) | TrySendError::Disconnected((_, whom))) =
            self.texts.try_send((text, Some((mark, asked))))
            && let Some((mark, asked)) = whom
        {
            self.loads.end(&mark);
            (asked.answer)(Err(RefusalData::busy(MOST_TEXTS)));
        }
    }

    /// What is loaded is proved for what is so now, where nothing else is to be done.
    fn renew(&mut self) {
        if self.renewal.is_some() || now() - self.asked < renewal::AFTER {
            return;
        }
        if let Some(proving) = self.control.renewal() {
            let (renewal, proving) = Renewal::of(proving);
            if self.texts.try_send((Box::new(proving), None)).is_ok() {
                self.renewal = Some(renewal);
            }
        }
    }

    /// How long a long program takes is planned, while it waits or is under way.
    fn time(&mut self) {
        let jobs = self.jobs.clone();
        timing::keep(&mut self.timing, &self.control, move |timed| {
            let _ = jobs.send(Job::Timed(Box::new(timed))); // the control has ended
        });
    }

    /// Answers; what a request has changed that is kept is on the disk before.
    fn tell(
        &mut self,
        answered: Result<Accepted, Refusal>,
        kept_before: Option<Ticket>,
        answer: Answered,
    ) {
        self.take_events();
        self.has_changed = true;
        self.show(); // who is answered sees what has come of it
        let answered = answered.map_err(|refusal| RefusalData::from(&refusal));
        match self.control.last_kept().filter(|kept| Some(*kept) != kept_before) {
            Some(kept) if answered.is_ok() => {
                self.control.when_kept(kept, |written| {
                    answer(written.map_err(|why| RefusalData::unkept(&why)).and(answered));
                });
            }
            Some(_) | None => answer(answered),
        }
    }

    /// Stops that were asked for: each acts already, and here the control follows.
    fn stop(&mut self) {
        for (request, askers) in self.shared.stops.take() {
            self.asked = now();
            let mut answered = self.control.request(&request);
            if !self.is_real_time {
                self.shared.stops.is_dealt_with(&request);
            }
            if request == Request::Stop && self.break_off(BrokenOff::Stop) {
                answered = answered.or_else(|_| Ok(Accepted::default()));
            }
            self.take_events();
            self.has_changed = true;
            self.show();
            let answered = answered.map_err(|refusal| RefusalData::from(&refusal));
            for answer in askers {
                answer(answered.clone());
            }
        }
    }

    /// Machine time comes up with the wall's, or as far as a turn allows.
    fn keep_up(&mut self) {
        if self.is_real_time {
            let turn = now();
            while self.control.periods_waiting() > 0 && now() - turn < LONGEST_TURN {
                self.period();
            }
            return;
        }
        let (began, at) = self.clock;
        let turn = now();
        let due = at + Time::s((turn - began).as_secs_f64() * self.host.pace);
        while self.control.now() < due && now() - turn < LONGEST_TURN {
            self.period();
        }
        let behind = (due - self.control.now()).value();
        if behind > MOST_BEHIND.as_secs_f64() * self.host.pace {
            self.clock = (now(), self.control.now()); // the machine has stood still meanwhile
        }
    }

    fn period(&mut self) {
        self.control.period();
        self.row += 1;
        if self.shared.recording.is_wanted() {
            if self.rows.values.is_empty() {
                let width = self.shared.signals.names().len();
                let start_s = self.control.now().value();
                self.rows = SignalRows { first: self.row, start_s, values: Vec::new(), width };
            }
            self.shared.signals.read(&self.control, &mut self.rows.values);
        }
        if let Some(ended) = self.control.take_ended() {
            self.recorded(ended);
        }
        self.ask_for_panel();
        self.take_events();
    }

    fn recorded(&mut self, ended: EndedProgram) {
        let Some(recording) = &mut self.host.recording else { return };
        if let Err(why) = (recording.ended)(ended) {
            let notice = Event::Notice(format!("this run is not kept: {why}"));
            held(&self.shared.journal).push(self.control.now(), notice);
        }
    }

    fn take_events(&mut self) {
        while let Some(event) = self.control.next_event() {
            self.has_changed = true;
            held(&self.shared.journal).push(self.control.now(), event);
        }
    }

    fn publish(&mut self) {
        self.due = now() + PICTURE;
        if !self.rows.values.is_empty() {
            self.shared.recording.push(std::mem::take(&mut self.rows));
        }
        self.show();
    }

    fn show(&mut self) {
        let before = Arc::clone(&held(&self.shared.picture));
        let next = Arc::new(before.next(&self.control, self.loads.status(), self.has_changed));
        self.has_changed = false;
        *held(&self.shared.picture) = next;
        (self.host.published)();
    }

    /// Programs and jogs are stopped before the control is switched off.
    fn come_to_rest(&mut self) {
        // what there is to stop is stopped; where there is nothing the refusal says so
        let _ = self.control.request(&Request::Stop);
        let _ = self.control.request(&Request::JogStop);
        let end = self.control.now() + COMES_TO_REST;
        let mut stops_spindles = true;
        while !self.control.is_at_standstill() && self.control.now() < end {
            self.control.period();
            if stops_spindles && !self.control.execution().is_under_way() {
                // one that turns on from what was typed
                stops_spindles = self.control.request(&Request::Reset).is_err();
            }
        }
        if let Some(ended) = self.control.take_ended() {
            self.recorded(ended);
        }
    }
}
