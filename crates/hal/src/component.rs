//! The component: what HAL's servo thread does once a period.
//!
//! ```text
//!   pins ─► Feedback ─► requests, steps ─► tick ─► Command ─► pins
//!                                           │
//!                                           └─► record, events ─► shared memory
//! ```
use crate::attendant::{Attendant, Desk};
use crate::ffi::{self, Hal, Member};
use crate::parameters::LoadParameters;
use crate::pins::{ObeysAfter, Pins};
use bus::{Feedback, RunDownKind, SPINDLES, STANDSTILL};
use kernel::FaultKind;
use rtrb::{Consumer, Producer, RingBuffer};
use servo::{PeriodAnswer, Record, Seat};
use shm::{Made, ServoSide, TiedPeriod};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Release};
use units::{Angle, Spin, Time};

/// Time constant of the speeds that are taken from counts, s.
const SMOOTHED_S: f64 = 0.02;

/// A session is over when everything has stood for so long: a spindle that turns back stands for a
/// moment.
const STANDS_NS: u64 = 100_000_000;

/// Sessions on their way.
const SESSIONS: usize = 4;

/// A control that leads the machine, and the kernel that it leads.
pub(crate) struct ControlSession {
    pub(crate) seat: Seat<ServoSide>,
    /// Drives obey so much later than they are told.
    pub(crate) obeys_after: ObeysAfter,
    /// For so long its control may show no sign of life, ns.
    pub(crate) most_silent_ns: i64,
}

/// What `loadrt` has loaded.
pub(crate) struct Component {
    made: Arc<Made>,
    pins: Pins,
    session: Option<Box<ControlSession>>,
    begin: Consumer<Box<ControlSession>>,
    over: Producer<Box<ControlSession>>,
    /// Since it was loaded, ns.
    time_ns: u64,
    period: Arc<AtomicU64>,
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
    /// Who it is in HAL.
    pub(crate) hal: Member,
}

impl Component {
    /// With its pins, and no control that leads it.
    ///
    /// # Errors
    /// HAL or the operating system refuses something.
    pub(crate) fn new(hal: &Hal, parameters: &LoadParameters) -> Result<Self, String> {
        let pins = Pins::new(hal, parameters)?;
        let axes =
            (0..).zip(parameters.axes).fold(0, |mask, (index, has)| mask | u16::from(has) << index);
        let made = shm::make(&parameters.name, axes, parameters.spindles as u8)
            .map_err(|why| format!("no shared memory can be made: {why}"))?;
        let (made, period) = (Arc::new(made), Arc::new(AtomicU64::new(0)));
        let (to_servo, begin) = RingBuffer::new(SESSIONS);
        let (over, from_servo) = RingBuffer::new(2 * SESSIONS);
        let attendant = Attendant::start(Desk {
            made: Arc::clone(&made),
            has: parameters.clone(),
            period: Arc::clone(&period),
            begin: to_servo,
            over: from_servo,
        })?;
        Ok(Self {
            made,
            pins,
            session: None,
            begin,
            over,
            time_ns: 0,
            period,
            is_broken: false,
            is_leaving: false,
            angles: [Angle::ZERO; SPINDLES],
            spins: [Spin::ZERO; SPINDLES],
            stood_ns: 0,
            _attendant: attendant,
            hal: hal.member(),
        })
    }

    /// A panic in a period: from now on everything is off.
    pub(crate) fn break_down(&mut self) {
        self.is_broken = true;
        self.made.keep(&TiedPeriod { stop: RunDownKind::Coasted, ..TiedPeriod::default() });
        self.pins.off();
    }

    /// It is to be unloaded.
    pub(crate) const fn leave(&mut self) {
        self.is_leaving = true;
    }

    /// Nothing is commanded any more.
    pub(crate) const fn is_off(&self) -> bool {
        self.is_broken || self.session.is_none()
    }

    /// One servo period.
    pub(crate) fn update(&mut self, period_ns: u64) {
        if self.is_broken {
            return;
        }
        self.time_ns += period_ns;
        self.period.store(period_ns, Release);
        self.made.period(period_ns);
        self.change_sessions(period_ns);
        let feedback = self.pins.read(Time::s(self.time_ns as f64 / 1e9));
        self.follow_spindles(&feedback, period_ns);
        let Some(session) = &mut self.session else {
            return self.pins.off();
        };
        let leaves = self.is_leaving.then_some(FaultKind::ComponentUnloaded);
        let lost = leaves.or_else(|| session.is_lost(period_ns));
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
        let marks = std::array::from_fn(|index| session.seat.kernel.looks_for_index(index));
        self.pins.write(&command, &sample.report, &session.obeys_after, marks);
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
        if let Some(session) = &mut self.session
            && self.stood_ns >= STANDS_NS
            && (session.seat.rings.is_ended()
                || self.is_leaving
                || !self.begin.is_empty() && session.is_lost(period_ns).is_some())
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
            self.session = Some(session);
        }
    }
}

impl ControlSession {
    /// Its control is gone, or not to be believed.
    fn is_lost(&mut self, period_ns: u64) -> Option<FaultKind> {
        let silent = self.seat.rings.silence(ffi::now_ns(), period_ns);
        if self.seat.rings.is_damaged() {
            Some(FaultKind::ControlSenseless)
        } else if silent > self.most_silent_ns || self.seat.rings.is_ended() {
            Some(FaultKind::ControlSilent)
        } else {
            None
        }
    }
}
