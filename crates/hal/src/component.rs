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
use crate::pins::Pins;
use bus::{AXES, Sample};
use kernel::FaultKind;
use rtrb::{Consumer, Producer, RingBuffer};
use servo::{Record, Seat};
use shm::{Made, ServoSide};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Release};
use units::Time;

/// Sessions on their way.
const SESSIONS: usize = 4;

/// A control that leads the machine, and the kernel that it leads.
pub(crate) struct ControlSession {
    pub(crate) seat: Seat<ServoSide>,
    /// Drives obey so much later than they are told.
    pub(crate) obeys_after: [Time; AXES],
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
            _attendant: attendant,
            hal: hal.member(),
        })
    }

    /// A panic in a period: from now on everything is off.
    pub(crate) fn break_down(&mut self) {
        self.is_broken = true;
        self.pins.off();
    }

    /// One servo period.
    pub(crate) fn update(&mut self, period_ns: u64) {
        if self.is_broken {
            return;
        }
        self.time_ns += period_ns;
        self.period.store(period_ns, Release);
        self.made.period(period_ns);
        self.change_sessions();
        let feedback = self.pins.read(Time::s(self.time_ns as f64 / 1e9));
        let Some(session) = &mut self.session else {
            return self.pins.off();
        };
        let lost = session.is_lost();
        if let Some(kind) = lost {
            session.seat.kernel.report_control(kind);
        }
        session.seat.before_tick();
        let mut sample = Sample { feedback, ..Sample::default() };
        sample.command = session.seat.kernel.tick(&feedback);
        sample.report = session.seat.kernel.report();
        let command = sample.command;
        session.seat.kernel.in_positions(&mut sample);
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

    /// A session that is over and stands makes place for the next one.
    fn change_sessions(&mut self) {
        if let Some(session) = &self.session
            && (session.is_over() || !self.begin.is_empty() && session.is_lost_and_stands())
            && !self.over.is_full()
            && let Some(session) = self.session.take()
        {
            session.seat.rings.end();
            let _ = self.over.push(session); // there is room
        }
        if self.session.is_none()
            && let Ok(session) = self.begin.pop()
        {
            session.seat.rings.begin();
            self.session = Some(session);
        }
    }
}

impl ControlSession {
    /// Its control is gone, or not to be believed.
    fn is_lost(&mut self) -> Option<FaultKind> {
        let silent = self.seat.rings.silence(ffi::now_ns());
        if self.seat.rings.is_damaged() {
            Some(FaultKind::ControlSenseless)
        } else if silent > self.most_silent_ns || self.seat.rings.is_ended() {
            Some(FaultKind::ControlSilent)
        } else {
            None
        }
    }

    fn stands(&self) -> bool {
        self.seat.kernel.is_off() || self.seat.kernel.is_standing()
    }

    /// Its control has ended it, and everything stands.
    fn is_over(&self) -> bool {
        self.seat.rings.is_ended() && self.stands()
    }

    /// Its control is gone without having ended it, and everything stands.
    fn is_lost_and_stands(&self) -> bool {
        self.stands()
            && (self.seat.rings.is_damaged() || self.seat.rings.silent_ns() > self.most_silent_ns)
    }
}
