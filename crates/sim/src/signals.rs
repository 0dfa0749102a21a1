//! What stands on the machine's inputs: by a script, or by what its outputs move.
//!
//! ```text
//!   output 1 ──┐  clamp   ┌──────────              analogue input 0, bar
//!              └──────────┘          ┌──after──╮        ╭───────── on
//!   input 1                ──────────┘  0.3 s  │      ╭╯  1 − e^(−t/τ)
//!                                              off ───╯
//! ```
//!
//! A digital input follows an output once that has been the same for the delay: what is reversed on
//! its way begins anew. An analogue one goes to its value for that state with a time constant.
use bus::Signals;
use units::Time;

/// What one input shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Which of its kind, counted from 0.
    pub number: u8,
    /// On or off; else a value.
    pub digital: bool,
    /// By what.
    pub source: InputSource,
}

/// What decides what an input shows. Of a digital one 0 is off, all else on.
#[derive(Clone, Debug, PartialEq)]
pub enum InputSource {
    /// This, and from each moment on that.
    Timed {
        /// From the beginning.
        first: f64,
        /// Later, in their order.
        changes: Vec<(Time, f64)>,
    },
    /// What a digital output moves.
    Follows {
        /// Which output.
        output: u8,
        /// What is shown while the output is off, and while it is on.
        values: [f64; 2],
        /// How long it takes until something is seen of a change.
        after: Time,
        /// Time constant of an analogue input from then on.
        within: Time,
    },
}

/// All inputs, and how far they are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inputs {
    inputs: Vec<(Input, Follower)>,
    shown: Signals,
}

/// How far an input has followed its output.
#[derive(Clone, Copy, Debug, Default)]
struct Follower {
    /// The output as it is, and for how long, s.
    output: bool,
    same_s: f64,
    /// The output as it is seen.
    seen: bool,
    value: f64,
}

impl Inputs {
    /// At the beginning: all outputs have been off for long.
    pub(crate) fn new(inputs: Vec<Input>) -> Self {
        let begun = |input: Input| {
            let value = match &input.source {
                InputSource::Timed { first, .. } => *first,
                InputSource::Follows { values, .. } => values[0],
            };
            (input, Follower { value, ..Follower::default() })
        };
        let mut new =
            Self { inputs: inputs.into_iter().map(begun).collect(), shown: Signals::default() };
        new.show();
        new
    }

    /// What they show.
    pub(crate) const fn shown(&self) -> Signals {
        self.shown
    }

    /// One period, which ends at this time, with these outputs.
    pub(crate) fn step(&mut self, outputs: &Signals, now: Time, period: Time) {
        for (input, follower) in &mut self.inputs {
            match &input.source {
                InputSource::Timed { changes, .. } => {
                    let last = changes.iter().take_while(|(at, _)| *at <= now).last();
                    follower.value = last.map_or(follower.value, |(_, value)| *value);
                }
                InputSource::Follows { output, values, after, within } => {
                    follower.step(outputs.is_on(*output), *after, period);
                    let wanted = values[usize::from(follower.seen)];
                    let lag = within.value();
                    let share = if input.digital || lag <= 0.0 {
                        1.0
                    } else {
                        1.0 - (-period.value() / lag).exp()
                    };
                    follower.value += (wanted - follower.value) * share;
                }
            }
        }
        self.show();
    }

    fn show(&mut self) {
        for (input, follower) in &self.inputs {
            if input.digital {
                self.shown.switch(input.number, follower.value != 0.0);
            } else if let Some(slot) = self.shown.analogue.get_mut(usize::from(input.number)) {
                *slot = follower.value;
            }
        }
    }
}

impl Follower {
    fn step(&mut self, output: bool, after: Time, period: Time) {
        self.same_s = if output == self.output { self.same_s + period.value() } else { 0.0 };
        self.output = output;
        if self.same_s + 1e-9 >= after.value() {
            self.seen = output;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Time = Time::s(0.001);

    fn after(inputs: &mut Inputs, outputs: Signals, from_ms: u32, ms: u32) -> Signals {
        for k in from_ms..from_ms + ms {
            inputs.step(&outputs, PERIOD * f64::from(k + 1), PERIOD);
        }
        inputs.shown()
    }

    #[test]
    fn a_clamp_is_closed_so_long_after_its_output_and_a_reversal_begins_anew() {
        let source = InputSource::Follows {
            output: 1,
            values: [0.0, 1.0],
            after: Time::s(0.3),
            within: Time::ZERO,
        };
        let mut inputs = Inputs::new(vec![Input { number: 7, digital: true, source }]);
        let (off, mut on) = (Signals::default(), Signals::default());
        on.switch(1, true);
        assert!(!after(&mut inputs, on, 0, 299).is_on(7));
        after(&mut inputs, off, 299, 10);
        assert!(!after(&mut inputs, on, 309, 299).is_on(7));
        assert!(after(&mut inputs, on, 608, 3).is_on(7));
        assert!(after(&mut inputs, off, 611, 290).is_on(7));
        assert!(!after(&mut inputs, off, 901, 20).is_on(7));
    }

    #[test]
    fn a_pressure_rises_by_its_time_constant() {
        let source = InputSource::Follows {
            output: 0,
            values: [2.0, 40.0],
            after: Time::ZERO,
            within: Time::s(0.2),
        };
        let mut inputs = Inputs::new(vec![Input { number: 3, digital: false, source }]);
        let mut on = Signals::default();
        on.switch(0, true);
        let bar = after(&mut inputs, on, 0, 200).analogue[3];
        let exact = 2.0 + 38.0 * (1.0 - (-1.0f64).exp());
        assert!((bar - exact).abs() < 0.2, "{bar} bar, {exact} by the closed form");
    }

    #[test]
    fn a_script_says_what_stands_there_when() {
        let at = |s, v| (Time::s(s), v);
        let source = InputSource::Timed { first: 1.0, changes: vec![at(0.01, 0.0), at(0.02, 1.0)] };
        let mut inputs = Inputs::new(vec![Input { number: 0, digital: true, source }]);
        assert!(inputs.shown().is_on(0));
        assert!(!after(&mut inputs, Signals::default(), 0, 15).is_on(0));
        assert!(after(&mut inputs, Signals::default(), 15, 6).is_on(0));
    }
}
