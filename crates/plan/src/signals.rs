//! Inputs and outputs of a program, as the kernel executes them. When an output switches with the
//! next move, its operation comes right before that move, so its step needs no word of it.
use motion::{Await, InputWait, Output, Signal};

/// An output.
pub(crate) const fn output(output: &canon::Output) -> Output {
    let signal = match output.signal {
        canon::Signal::Digital { on } => Signal::Digital { on },
        canon::Signal::Analogue { value } => Signal::Analogue { value },
    };
    Output { number: output.number, signal }
}

/// A wait for an input.
pub(crate) const fn input(wait: &canon::InputWait) -> InputWait {
    let until = match wait.until {
        canon::Await::Nothing => Await::Nothing,
        canon::Await::Rise => Await::Rise,
        canon::Await::Fall => Await::Fall,
        canon::Await::On => Await::On,
        canon::Await::Off => Await::Off,
    };
    InputWait { number: wait.number, digital: wait.digital, until, longest: wait.longest }
}
