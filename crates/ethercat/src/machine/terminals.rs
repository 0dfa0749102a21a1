//! Terminals: digital signals of the machine, and a tool changer that is told a number and says
//! one.
//!
//! ```text
//!   tool changer   outputs  0 nothing is asked   255 no tool shall be in the spindle   else: this one
//!                  inputs   0 it is changing     255 no tool is in the spindle         else: this one
//! ```
use crate::bus::Bus;
use bus::{DIGITAL, Feedback, Signals};

/// A tool changer's word for an empty spindle.
const EMPTY: u8 = 0xFF;
/// Bytes of a terminal that are looked at.
const BYTES: usize = DIGITAL / 8;

/// A device without axes that has a meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terminal {
    /// Digital signals.
    Digital {
        /// Position of the device.
        device: usize,
        /// Number of the signal that its first input is.
        inputs_from: Option<u8>,
        /// Number of the signal that its first output is.
        outputs_from: Option<u8>,
    },
    /// A tool changer: a byte each way.
    ToolChanger {
        /// Position of the device.
        device: usize,
    },
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Terminals(Vec<Terminal>);

impl Terminals {
    pub(crate) fn new(all: &[Terminal]) -> Self {
        Self(all.to_vec())
    }

    /// Takes what they say.
    pub(crate) fn read(&self, bus: &Bus<'_, '_>, feedback: &mut Feedback) {
        for terminal in &self.0 {
            let mut bytes = [0; BYTES];
            match *terminal {
                Terminal::Digital { device, inputs_from: Some(from), .. } => {
                    let there = bus.inputs(device, &mut bytes).min(BYTES) * 8;
                    let bits = u64::from_le_bytes(bytes);
                    for bit in 0..there.min(DIGITAL.saturating_sub(usize::from(from))) {
                        feedback.inputs.switch(from + bit as u8, bits >> bit & 1 == 1);
                    }
                }
                Terminal::Digital { .. } => {}
                Terminal::ToolChanger { device } => {
                    bus.inputs(device, &mut bytes);
                    feedback.tool = match bytes[0] {
                        0 => None,
                        EMPTY => Some(0),
                        number => Some(u32::from(number)),
                    };
                }
            }
        }
    }

    /// Tells them; `None`: no tool is asked for.
    pub(crate) fn write(&self, bus: &mut Bus<'_, '_>, outputs: &Signals, tool: Option<u32>) {
        for terminal in &self.0 {
            match *terminal {
                Terminal::Digital { device, outputs_from: Some(from), .. } => {
                    let bits = outputs.digital.checked_shr(u32::from(from)).unwrap_or(0);
                    bus.set_outputs(device, &bits.to_le_bytes());
                }
                Terminal::Digital { .. } => {}
                Terminal::ToolChanger { device } => {
                    // a number that the byte does not hold is not asked for, and never there
                    let number = match tool {
                        Some(0) => EMPTY,
                        Some(number) => {
                            u8::try_from(number).ok().filter(|n| *n < EMPTY).unwrap_or(0)
                        }
                        None => 0,
                    };
                    bus.set_outputs(device, &[number]);
                }
            }
        }
    }
}
