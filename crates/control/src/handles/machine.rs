//! The machine as the control holds it: here, or in the servo thread.
use crate::real_time::MachineLink;
use crate::{Drives, Refused};
use bus::{EngagedTool, Feedback, Truth};
use servo::Record;
use sim::Fault;
use units::Time;

/// A machine.
pub enum MachineHandle {
    /// In this thread.
    Here(Box<dyn Drives>),
    /// In the servo thread.
    There(Box<MachineLink>),
}

impl From<Box<dyn Drives>> for MachineHandle {
    fn from(machine: Box<dyn Drives>) -> Self {
        Self::Here(machine)
    }
}

impl MachineHandle {
    /// The machine, if it is in this thread.
    pub fn here(&mut self) -> Option<&mut dyn Drives> {
        match self {
            Self::Here(machine) => Some(&mut **machine),
            Self::There(_) => None,
        }
    }

    /// A period of the servo thread is looked at.
    pub(crate) fn see(&mut self, record: &Record) {
        if let Self::There(link) = self {
            link.see(record);
        }
    }

    /// The servo thread is gone, and why.
    pub(crate) fn lose(&mut self, why: &str) {
        if let Self::There(link) = self {
            link.lose(why);
        }
    }

    /// A period has passed of which nothing is heard.
    pub(crate) fn pass(&mut self) {
        if let Self::There(link) = self {
            link.pass();
        }
    }

    /// What it has said last.
    pub fn feedback(&self) -> &Feedback {
        match self {
            Self::Here(machine) => machine.feedback(),
            Self::There(link) => link.feedback(),
        }
    }

    /// What only a simulated one knows.
    pub fn truth(&self) -> Option<&Truth> {
        match self {
            Self::Here(machine) => machine.truth(),
            Self::There(link) => link.truth(),
        }
    }

    /// Its servo period.
    pub fn period(&self) -> Time {
        match self {
            Self::Here(machine) => machine.period(),
            Self::There(link) => link.period(),
        }
    }

    /// [`<dyn Drives>::strike`](Drives).
    pub fn strike(&mut self, fault: Fault) {
        match self {
            Self::Here(machine) => machine.strike(fault),
            Self::There(link) => link.strike(fault),
        }
    }

    /// [`<dyn Drives>::clamp`](Drives); in the servo thread what cannot be ground ends it, with the
    /// reason.
    ///
    /// # Errors
    /// As there, where the machine is in this thread.
    pub fn clamp(&mut self, grinding: sim::Grinding) -> Result<(), Refused> {
        match self {
            Self::Here(machine) => machine.clamp(grinding),
            Self::There(link) => {
                link.clamp(grinding);
                Ok(())
            }
        }
    }

    /// [`Drives::renew_tool`].
    pub fn renew_tool(&mut self, number: u32) {
        match self {
            Self::Here(machine) => machine.renew_tool(number),
            Self::There(link) => link.renew_tool(number),
        }
    }

    /// [`<dyn Drives>::clamp_stock`](Drives).
    pub fn clamp_stock(&mut self, stock: sim::Stock, bar: Option<sim::Bar>) {
        match self {
            Self::Here(machine) => machine.clamp_stock(&stock, bar),
            Self::There(link) => link.clamp_stock(stock, bar),
        }
    }

    /// [`<dyn Drives>::renew_work`](Drives).
    pub fn renew_work(&mut self) {
        match self {
            Self::Here(machine) => machine.renew_work(),
            Self::There(link) => link.renew_work(),
        }
    }

    /// [`<dyn Drives>::repair`](Drives).
    pub fn repair(&mut self, fault: Fault) {
        match self {
            Self::Here(machine) => machine.repair(fault),
            Self::There(link) => link.repair(fault),
        }
    }

    /// [`<dyn Drives>::mend`](Drives).
    pub fn mend(&mut self) {
        match self {
            Self::Here(machine) => machine.mend(),
            Self::There(link) => link.mend(),
        }
    }

    /// [`Drives::engage`].
    pub fn engage(&mut self, engagement: Option<EngagedTool>) {
        match self {
            Self::Here(machine) => machine.engage(engagement),
            Self::There(link) => link.engage(engagement),
        }
    }

    /// The machine has been sent which tool is in its work.
    pub(crate) fn has_engaged(&self) -> bool {
        match self {
            Self::Here(_) => true,
            Self::There(link) => link.has_engaged(),
        }
    }

    /// What a component of HAL keeps of a tool in the work.
    pub(crate) fn retained(&self) -> Option<shm::RetainedState> {
        match self {
            Self::Here(_) => None,
            Self::There(link) => link.retained(),
        }
    }

    /// [`<dyn Drives>::is_abandoned`](Drives), or the servo thread has ended.
    pub fn is_abandoned(&self) -> bool {
        match self {
            Self::Here(machine) => machine.is_abandoned(),
            Self::There(link) => link.lost().is_some(),
        }
    }

    /// [`Drives::lost`].
    pub fn lost(&self) -> Option<String> {
        match self {
            Self::Here(machine) => machine.lost(),
            Self::There(link) => link.lost(),
        }
    }

    /// What is true of the simulated carousel, where there is one in this process.
    pub fn carousel(&self) -> Option<sim::CarouselTruth> {
        match self {
            Self::Here(machine) => machine.simulation()?.machine().carousel(),
            Self::There(_) => None,
        }
    }

    /// [`<dyn Drives>::assumed_holes`](Drives); known when the machine is here again.
    pub fn assumed_holes(&self) -> usize {
        match self {
            Self::Here(machine) => machine.assumed_holes(),
            Self::There(_) => 0,
        }
    }
}
