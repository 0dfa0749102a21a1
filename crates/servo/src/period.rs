//! One servo period of a kernel, in whichever process it runs: the one place that calls its tick,
//! which `xtask/tests/layout.rs` holds.
use bus::{Command, Feedback, Sample};
use kernel::Kernel;

/// What the kernel has answered in a period.
#[derive(Clone, Copy, Debug, Default)]
pub struct PeriodAnswer {
    /// What observers see: positions.
    pub sample: Sample,
    /// What the machine is told: what its encoders count.
    pub command: Command,
}

/// What the kernel commands after what the machine has said, in the place of the answer before.
#[inline]
pub fn answer(kernel: &mut Kernel, feedback: &Feedback, answer: &mut PeriodAnswer) {
    let PeriodAnswer { sample, command } = answer;
    *command = kernel.tick(feedback);
    sample.feedback = *feedback;
    sample.command = *command;
    sample.report = kernel.report();
    sample.truth = None;
    kernel.in_positions(sample);
}
