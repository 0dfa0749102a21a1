//! Inputs and outputs that a step reads, waits for or switches.
use units::Time;

/// An output and what it is switched to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Output {
    /// Which of its kind, counted from 0.
    pub number: u8,
    /// What it is to be.
    pub signal: Signal,
}

/// What an output is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Signal {
    /// On or off.
    Digital {
        /// On.
        on: bool,
    },
    /// A value in the machine's own unit.
    Analogue {
        /// The value.
        value: f64,
    },
}

/// What ends a probing move before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProbeEnd {
    /// Contact; else the end of contact.
    pub contact: bool,
    /// It is an alarm if that has not come at the end of the move.
    pub required: bool,
}

/// An input, and what is waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InputWait {
    /// Which of its kind, counted from 0.
    pub number: u8,
    /// On or off; else a value.
    pub digital: bool,
    /// What ends the wait.
    pub until: Await,
    /// How long it lasts at most.
    pub longest: Time,
}

/// Digital inputs that a step of a machine sequence waits for, all together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InputsWait {
    /// A bit for each input that must be on.
    pub on: u64,
    /// A bit for each input that must be off.
    pub off: u64,
    /// Time for which all of them must be so without a break: contacts bounce.
    pub steady: Time,
    /// Longest wait; an alarm ends a longer one.
    pub longest: Time,
    /// Usual duration, for estimates of the cycle time.
    pub usual: Time,
}

impl InputsWait {
    /// Bits of the inputs that are not as they must be.
    pub const fn wrong(&self, inputs: u64) -> u64 {
        self.on & !inputs | self.off & inputs
    }
}

/// Rising edges of a digital input to be counted while an output is on: a carousel that an indexing
/// motor turns from pocket to pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EdgeCount {
    /// Output that is on while edges are counted, and off whenever the step is over, however it
    /// ends.
    pub output: u8,
    /// Input whose rising edges are counted.
    pub input: u8,
    /// Number of edges.
    pub edges: u8,
    /// Time for which a new state must last to count: contacts bounce.
    pub steady: Time,
    /// Longest time from one edge to the next; an alarm ends a longer one.
    pub longest: Time,
    /// Usual duration of all of it, for estimates of the cycle time.
    pub usual: Time,
}

/// What a wait for an input waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Await {
    /// Nothing: the input is only read.
    Nothing,
    /// That it turns on.
    Rise,
    /// That it turns off.
    Fall,
    /// That it is on.
    On,
    /// That it is off.
    Off,
}
