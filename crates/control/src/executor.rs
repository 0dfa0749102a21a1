//! One servo period: the kernel answers what the machine has said, and the machine obeys. Nothing else calls `tick`.
//!
//! ```text
//!   feedback ─► Kernel::tick ─► command ─► observe ─► exchange ─► next feedback
//!                    ▲                                    │
//!                    └── readings of periods that were missed
//! ```
use crate::Plant;
use crate::missed::missed;
use crate::timings::TickTimes;
use bus::{Machine, Sample, State};
use kernel::Kernel;
use std::ops::ControlFlow;

/// A kernel, and the machine that it controls.
pub struct Executor {
    /// The kernel.
    pub kernel: Kernel,
    /// The machine.
    pub machine: Plant,
    /// How long its ticks take.
    pub ticks: TickTimes,
}

impl Executor {
    /// One servo period; see [`period`].
    pub fn period(&mut self, observe: impl FnOnce(&mut Kernel, &mut Plant, &Sample)) -> Sample {
        let Self { kernel, machine, ticks } = self;
        let mut seen = Sample::default();
        // an observer that only looks breaks nothing off
        let _ = timed(kernel, machine, ticks, |kernel, machine, sample| {
            observe(kernel, machine, sample);
            seen = *sample;
            ControlFlow::<()>::Continue(())
        });
        seen
    }
}

/// One servo period. `observe` sees what was heard and what is commanded before the command is sent; if it breaks off,
/// nothing is sent. A machine whose control is gone (a simulated failure) goes on without a tick.
pub fn period<B>(
    kernel: &mut Kernel,
    machine: &mut Plant,
    observe: impl FnOnce(&mut Kernel, &mut Plant, &Sample) -> ControlFlow<B>,
) -> ControlFlow<B> {
    timed(kernel, machine, &mut TickTimes::new(false), observe)
}

fn timed<B>(
    kernel: &mut Kernel,
    machine: &mut Plant,
    ticks: &mut TickTimes,
    observe: impl FnOnce(&mut Kernel, &mut Plant, &Sample) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let feedback = machine.feedback();
    let mut sample = Sample { feedback, truth: machine.truth(), ..Sample::default() };
    let is_abandoned = machine.is_abandoned();
    if !is_abandoned {
        sample.command = ticks.time(|| kernel.tick(&feedback));
    }
    sample.report = kernel.report();
    if is_abandoned {
        sample.report.state = State::Faulted;
    }
    // observers see positions, the machine is told what its encoders count
    let command = sample.command;
    kernel.in_positions(&mut sample);
    observe(kernel, machine, &sample)?;
    if is_abandoned {
        machine.wait();
        return ControlFlow::Continue(());
    }
    let heard = machine.exchange(&command);
    for between in missed(&feedback, &heard, machine.period()) {
        kernel.tick(&between);
    }
    ControlFlow::Continue(())
}
