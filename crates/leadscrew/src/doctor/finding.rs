//! What was found, topic by topic.
use std::borrow::Cow;

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// The operating system's kernel.
    Kernel,
    /// The computer is a virtual machine.
    VirtualMachine,
    /// Scheduling that a program may ask for.
    Rights,
    /// Memory that may be locked.
    Memory,
    /// The clock that the kernel reads.
    Clock,
    /// Cores set apart.
    Cores,
    /// Interrupts on the servo thread's core.
    Interrupts,
    /// States in which an idle core sleeps.
    Idle,
    /// Clock speed of the cores.
    Speed,
    /// The network card of EtherCAT drives.
    Network,
    /// LinuxCNC's HAL.
    Hal,
    /// Lateness as it was measured.
    Latency,
}

impl Topic {
    /// Its name, as it is shown.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kernel => "kernel",
            Self::VirtualMachine => "virtual machine",
            Self::Rights => "rights",
            Self::Memory => "memory",
            Self::Clock => "clock",
            Self::Cores => "cores",
            Self::Interrupts => "interrupts",
            Self::Idle => "idle states",
            Self::Speed => "clock speed",
            Self::Network => "network card",
            Self::Hal => "HAL",
            Self::Latency => "latency",
        }
    }
}

/// How well it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// As it should be.
    Good,
    /// Worth knowing, nothing to change.
    Note,
    /// Something to change.
    Improve,
    /// A machine is not to be led like this.
    Wrong,
    /// The computer does not say.
    Unknown,
}

impl Health {
    /// Its name in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Note => "note",
            Self::Improve => "improve",
            Self::Wrong => "wrong",
            Self::Unknown => "unknown",
        }
    }
}

/// One thing that was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComputerFinding {
    /// What it is about.
    pub topic: Topic,
    /// How well it is.
    pub health: Health,
    /// In a sentence.
    pub says: Cow<'static, str>,
    /// What to change, with the command.
    pub remedy: Option<Cow<'static, str>>,
}

impl ComputerFinding {
    pub(super) fn good(topic: Topic, says: impl Into<Cow<'static, str>>) -> Self {
        Self { topic, health: Health::Good, says: says.into(), remedy: None }
    }

    pub(super) fn unknown(topic: Topic, says: impl Into<Cow<'static, str>>) -> Self {
        Self { topic, health: Health::Unknown, says: says.into(), remedy: None }
    }

    pub(super) fn improve(
        topic: Topic,
        says: impl Into<Cow<'static, str>>,
        remedy: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { topic, health: Health::Improve, says: says.into(), remedy: Some(remedy.into()) }
    }

    pub(super) fn wrong(
        topic: Topic,
        says: impl Into<Cow<'static, str>>,
        remedy: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { topic, health: Health::Wrong, says: says.into(), remedy: Some(remedy.into()) }
    }

    pub(super) fn note(topic: Topic, says: impl Into<Cow<'static, str>>) -> Self {
        Self { topic, health: Health::Note, says: says.into(), remedy: None }
    }
}
