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
