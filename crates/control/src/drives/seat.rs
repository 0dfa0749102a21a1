//! A kernel in the servo thread of another process: the control leads it over shared memory, and
//! drives obey that kernel alone.
use super::Drives;
use bus::{Command, EngagedTool, Feedback, Machine};
use units::Time;

/// The place of a kernel in another process.
pub struct SharedSeat {
    /// The memory that both processes share; taken by the thread that bridges.
    pub(crate) side: Option<shm::ControlSide>,
    /// A control that shows no sign of life for this long is gone, and the machine is stopped.
    pub(crate) silent_after: Time,
    /// Time after which an axis is where its drive was commanded to be.
    pub(crate) obeys_after: [Time; bus::AXES],
    pub(crate) spindles_obey_after: [Time; bus::SPINDLES],
    /// Inputs that something must drive there.
    pub(crate) watched: bus::WatchedInputs,
    /// What is said of the other process.
    pub(crate) text: SeatText,
    period: Time,
    feedback: Feedback,
}

/// What is said of the process that has the servo thread.
#[derive(Clone, Copy, Debug)]
pub struct SeatText {
    /// Its name within a sentence.
    pub name: &'static str,
    /// What to look at where it does not begin a session.
    pub does_not_begin: &'static str,
    /// Its periods have stopped, in a sentence.
    pub stands_still: &'static str,
}

impl SharedSeat {
    /// A seat whose servo thread has this period. Each drive obeys `obeys_after` its command.
    pub fn new(
        side: shm::ControlSide,
        (period, silent_after, obeys_after): (Time, Time, Time),
        text: SeatText,
    ) -> Self {
        Self {
            side: Some(side),
            silent_after,
            obeys_after: [obeys_after; bus::AXES],
            spindles_obey_after: [obeys_after; bus::SPINDLES],
            watched: bus::WatchedInputs::default(),
            text,
            period,
            feedback: Feedback { tool: Some(0), ..Feedback::default() },
        }
    }

    /// The same seat, with inputs that something must drive.
    #[must_use]
    pub(super) const fn watching(mut self, watched: bus::WatchedInputs) -> Self {
        self.watched = watched;
        self
    }

    /// What the other process keeps of a tool in the work.
    pub(crate) fn retained(&self) -> Option<shm::RetainedMemory> {
        self.side.as_ref().map(shm::ControlSide::retained)
    }
}

/// Before its session, nothing moves and nothing is ready.
impl Machine for SharedSeat {
    fn period(&self) -> Time {
        self.period
    }

    fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    fn exchange(&mut self, _: &Command) -> &Feedback {
        self.feedback.time += self.period;
        &self.feedback
    }
}

impl Drives for SharedSeat {
    fn engage(&mut self, _: Option<EngagedTool>) {}

    fn renew_tool(&mut self, _: u32) {}

    fn lost(&self) -> Option<String> {
        None
    }

    fn outlives_control(&self) -> bool {
        true
    }

    fn seat(&mut self) -> Option<&mut SharedSeat> {
        Some(self)
    }
}
