//! One servo period of a kernel, in whichever process it runs: the one place that calls its tick,
//! which `xtask/tests/layout.rs` holds.
use bus::{Command, Feedback, Sample};
use kernel::Kernel;

/// What the kernel has answered in a period.
#[derive(Clone, Copy, Debug)]
pub struct PeriodAnswer {
    /// What observers see: positions.
    pub sample: Sample,
    /// What the machine is told: what its encoders count.
    pub command: Command,
}

/// What the kernel commands after what the machine has said.
#[inline]
pub fn answer(kernel: &mut Kernel, feedback: &Feedback) -> PeriodAnswer {
    let command = kernel.tick(feedback);
    let feedback = *feedback;
    let mut sample = Sample { feedback, command, report: kernel.report(), ..Sample::default() };
    kernel.in_positions(&mut sample);
    PeriodAnswer { sample, command }
}
