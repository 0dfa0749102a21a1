//! What a process with a servo thread does once a period, whatever leads to its drives.
//!
//! ```text
//!   fieldbus ─► Feedback ─► requests, steps ─► tick ─► Command ─► fieldbus
//!                                               │
//!                                               └─► record, events ─► shared memory
//! ```
//!
//! LinuxCNC's HAL has one of these, whose fieldbus are pins; `leadscrew drives` is another. A
//! period takes no memory, no lock and calls no system, as far as its fieldbus does not.
use crate::attendant::{Attendant, Desk};
use crate::session::{ControlSession, ServoProcessOptions};
use crate::{Made, TiedPeriod};
use bus::{AXES, Command, Feedback, Report, RunDownKind, SPINDLES, STANDSTILL, WatchedInputs};
use kernel::{FaultKind, Kernel};
use rtrb::{Consumer, Producer, RingBuffer};
use servo::{PeriodAnswer, Record};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Release};
use units::{Angle, Spin, Time};

/// What leads from the servo thread to drives and back.
pub trait Fieldbus {
    /// Inputs that something drives at present. Where nothing can show that, all of them.
    fn driven(&self) -> WatchedInputs {
        WatchedInputs::ALL
    }

    /// Takes which inputs the machine's file relies on, from the next reading on.
    fn watch(&mut self, _: WatchedInputs) {}

    /// Reads what the machine says, at this time since the process began.
    fn read(&mut self, time: Time) -> Feedback;

    /// Writes what the machine shall do. Drives with a position loop of their own are told where
    /// the axis shall be when they obey.
    fn write(&mut self, command: &Command, report: &Report, to: &WriteTo);

    /// Commands nothing: drives off, spindles released.
    fn off(&mut self);

    /// A clock that never goes back, ns.
    fn now_ns(&self) -> i64;
}

/// What a fieldbus must know of a command beside it.
#[derive(Clone, Copy, Debug)]
pub struct WriteTo {
    /// Time after which each axis is where its drive was commanded to be.
    pub obeys_after: [Time; AXES],
    /// The same of spindles.
    pub spindles_obey_after: [Time; SPINDLES],
    /// Index marks that are looked for.
    pub marks: Marks,
}

/// Of which axes and spindles the next index mark is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// By bus index.
    pub axes: [bool; AXES],
    /// By spindle.
    pub spindles: [bool; SPINDLES],
}

impl Marks {
    fn of(kernel: &Kernel) -> Self {
        Self {
            axes: std::array::from_fn(|index| kernel.axis_looks_for_index(index)),
            spindles: std::array::from_fn(|index| kernel.looks_for_index(index)),
        }
    }
}

/// Time constant of the speeds that are taken from counts, s.
const SMOOTHED_S: f64 = 0.02;

/// A session is over when everything has stood for so long: a spindle that turns back stands for a
/// moment.
const STANDS_NS: u64 = 100_000_000;

/// Sessions on their way.
const SESSIONS: usize = 4;

/// See the module's header.
pub struct ServoProcess<F> {
    made: Arc<Made>,
    fieldbus: F,
    session: Option<Box<ControlSession>>,
    begin: Consumer<Box<ControlSession>>,
    over: Producer<Box<ControlSession>>,
    /// Since it was loaded, ns.
    time_ns: u64,
    period: Arc<AtomicU64>,
    driven: Arc<AtomicU64>,
    /// A panic has ended it: nothing is commanded any more.
    is_broken: bool,
    /// It is to be unloaded: what moves comes to rest, and no session begins.
    is_leaving: bool,
    /// The spindles a period ago, by their encoders, and how fast they turn, smoothed.
    angles: [Angle; SPINDLES],
    spins: [Spin; SPINDLES],
    /// For so long everything has stood, by setpoints and by encoders, ns.
    stood_ns: u64,
    _attendant: Attendant,
}

impl<F: Fieldbus> ServoProcess<F> {
    /// A process that no control leads.
    ///
    /// # Errors
    /// The operating system refuses shared memory or a thread.
    pub fn new(fieldbus: F, options: ServoProcessOptions) -> Result<Self, String> {
        let axes =
            (0..).zip(options.axes).fold(0, |mask, (index, has)| mask | u16::from(has) << index);
        let made =
            crate::make(&options.name, axes, options.spindles as u8, options.machine.as_deref())
                .map_err(|why| format!("no shared memory can be made: {why}"))?;
        let (made, period) = (Arc::new(made), Arc::new(AtomicU64::new(0)));
        let driven = Arc::new(AtomicU64::new(0));
        let (to_servo, begin) = RingBuffer::new(SESSIONS);
        let (over, from_servo) = RingBuffer::new(2 * SESSIONS);
        let attendant = Attendant::start(Desk {
            made: Arc::clone(&made),
            has: options,
            period: Arc::clone(&period),
            driven: Arc::clone(&driven),
            begin: to_servo,
            over: from_servo,
        })?;
        Ok(Self {
            made,
            fieldbus,
            session: None,
            begin,
            over,
            time_ns: 0,
            period,
            driven,
            is_broken: false,
            is_leaving: false,
            angles: [Angle::ZERO; SPINDLES],
            spins: [Spin::ZERO; SPINDLES],
            stood_ns: 0,
            _attendant: attendant,
        })
    }

    /// What leads to the drives.
    pub const fn fieldbus_mut(&mut self) -> &mut F {
        &mut self.fieldbus
    }

    /// A panic in a period: from now on everything is off.
    pub fn break_down(&mut self) {
        self.is_broken = true;
        self.made.keep(&TiedPeriod { stop: RunDownKind::Coasted, ..TiedPeriod::default() });
        self.fieldbus.off();
    }

    /// The process is to end: what moves comes to rest, and no session begins.
    pub const fn leave(&mut self) {
        self.is_leaving = true;
    }

    /// Nothing is commanded any more.
    pub const fn is_off(&self) -> bool {
        self.is_broken || self.session.is_none()
    }

    /// One servo period.
    pub fn update(&mut self, period_ns: u64) {
        if self.is_broken {
            return;
        }
        self.time_ns += period_ns;
        self.driven.store(self.fieldbus.driven().bits(), Release);
        self.period.store(period_ns, Release);
        self.made.period(period_ns);
        self.change_sessions(period_ns);
        let feedback = self.fieldbus.read(Time::s(self.time_ns as f64 / 1e9));
        self.follow_spindles(&feedback, period_ns);
        let Some(session) = &mut self.session else {
            return self.fieldbus.off();
        };
        let leaves = self.is_leaving.then_some(FaultKind::ComponentUnloaded);
        let lost = leaves.or_else(|| session.is_lost(self.fieldbus.now_ns(), period_ns));
        if let Some(kind) = lost {
            session.seat.kernel.report_control(kind);
        }
        session.seat.before_tick();
        let was_off = session.seat.kernel.is_off();
        let mut answer = PeriodAnswer::default();
        servo::answer(&mut session.seat.kernel, &feedback, &mut answer);
        let PeriodAnswer { sample, command } = answer;
        let turns = self.spins.iter().any(|spin| spin.abs() > STANDSTILL);
        let stands = session.seat.kernel.is_off() || session.seat.kernel.is_standing() && !turns;
        self.stood_ns = if stands { self.stood_ns.saturating_add(period_ns) } else { 0 };
        let goes_off = session.seat.kernel.is_off() && !was_off;
        self.made.keep(&TiedPeriod {
            spin: command
                .coupled
                .and_then(|coupled| self.spins.get(usize::from(coupled.spindle)).copied()),
            sync_error: sample.report.sync_error,
            stop: match (goes_off && turns, lost.is_some() || session.seat.rings.is_ended()) {
                (true, _) => RunDownKind::Coasted,
                (false, true) => RunDownKind::Coupled,
                (false, false) => RunDownKind::None,
            },
        });
        let number = session.seat.after_tick();
        let record = Record {
            number,
            sample,
            heard: feedback,
            picture: session.seat.kernel.picture(),
            taken: session.seat.taken(),
        };
        session.seat.rings.record(&record);
        let (obeys_after, spindles_obey_after) = session.obeys_after;
        let marks = Marks::of(&session.seat.kernel);
        let to = WriteTo { obeys_after, spindles_obey_after, marks };
        self.fieldbus.write(&command, &sample.report, &to);
    }

    /// How fast spindles turn, by their encoders: a count more or less is no turning.
    fn follow_spindles(&mut self, feedback: &Feedback, period_ns: u64) {
        let period = Time::s(period_ns as f64 / 1e9);
        let share = period.value() / (period.value() + SMOOTHED_S);
        let seen = self.angles.iter_mut().zip(&mut self.spins).zip(&feedback.spindles);
        for ((angle, spin), said) in seen {
            let turned = (said.angle - *angle) / period;
            if turned.is_finite() {
                *spin += (turned - *spin) * share;
            }
            *angle = said.angle;
        }
    }

    /// A session that is over and stands makes place for the next one.
    fn change_sessions(&mut self, period_ns: u64) {
        let now_ns = self.fieldbus.now_ns();
        if let Some(session) = &mut self.session
            && self.stood_ns >= STANDS_NS
            && (session.seat.rings.is_ended()
                || self.is_leaving
                || !self.begin.is_empty() && session.is_lost(now_ns, period_ns).is_some())
            && !self.over.is_full()
            && let Some(session) = self.session.take()
        {
            session.seat.rings.end();
            let _ = self.over.push(session); // there is room
        }
        if self.session.is_none()
            && !self.is_leaving
            && let Ok(session) = self.begin.pop()
        {
            session.seat.rings.begin();
            self.fieldbus.watch(session.watched);
            self.session = Some(session);
        }
    }
}
