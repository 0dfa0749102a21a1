//! What crosses the rings.
use bus::{Feedback, Sample};
use kernel::{Picture, Reply};
use serde::{Deserialize, Serialize};
use units::Time;

/// What the servo thread hands on of each period.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Record {
    /// Counts periods from 1.
    pub number: u64,
    /// What was heard and commanded.
    pub sample: Sample,
    /// What the machine has answered to that; with drives that answer a period later, what it said
    /// last.
    pub heard: Feedback,
    /// The kernel after it.
    pub picture: Picture,
    /// Steps that have gone into the kernel's queue, of all that were sent.
    pub taken: u64,
}

/// What the kernel says beside the record.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub enum Said {
    /// An event.
    Event(kernel::Event),
    /// An answer of the machine.
    Answered(kernel::Answered),
    /// What shall be written down.
    Record(kernel::RecordRequest),
}

/// A reply, and the kernel after it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Replied {
    /// What came of the request.
    pub reply: Reply,
    /// Periods that were over by then.
    pub number: u64,
    /// The kernel after it.
    pub picture: Picture,
    /// Steps that had gone into the kernel's queue.
    pub taken: u64,
}

/// What a servo thread in another process needs before its first period.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetUp {
    /// The kernel's.
    pub config: kernel::Config,
    /// A control that shows no sign of life for so long is gone.
    pub silent_after: Time,
    /// Drives that close their own position loop obey so much later than they are told, by axis:
    /// they are told where the axis shall be by then.
    pub obeys_after: [Time; bus::AXES],
    /// The same by spindle, of those whose drives are told an angle.
    pub spindles_obey_after: [Time; bus::SPINDLES],
    /// Inputs that something must drive.
    pub watched: bus::WatchedInputs,
}
