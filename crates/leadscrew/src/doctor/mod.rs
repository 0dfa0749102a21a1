//! Whether this computer can lead a machine: its kernel, rights, cores, clock, network card and
//! HAL, and how late a servo thread begins its periods on it.
//!
//! ```text
//!   /proc, /sys, /usr ─► findings ─┐
//!   a servo thread that leads nothing ─► Latency ─► Effect at the tap ─┴─► Examination
//! ```
mod computer;
mod cores;
mod effect;
mod finding;
mod hal;
mod latency;
mod network;
mod system;

pub use computer::Computer;
pub use effect::Effect;
pub use finding::{ComputerFinding, Health, Topic};
pub use latency::{Latency, LatencyOptions, measure};
pub use system::Rights;

use store::machine::MachineFile;
use units::{Spin, Time};

/// Share of a period that a period may begin late without a remark.
const LATE_SHARE: f64 = 0.25;

/// The machine that the computer is to lead.
#[derive(Clone, Debug)]
pub struct ExaminationOptions {
    /// Servo period of the machine.
    pub period: Time,
    /// Highest speed at which it taps.
    pub tapping_max: Spin,
    /// The network interface of its drives; `None`: they are on none.
    pub interface: Option<String>,
    /// It is led through HAL.
    pub uses_hal: bool,
}

impl ExaminationOptions {
    /// Those of a machine.
    pub fn of(file: &MachineFile) -> Self {
        Self {
            period: file.control.period,
            tapping_max: file.spindles.first().map_or(Spin::ZERO, |spindle| spindle.tapping_max),
            interface: file.ethercat.as_ref().map(|network| network.interface.clone()),
            uses_hal: file.hal.is_some(),
        }
    }
}

/// Result of an examination.
#[derive(Clone, Debug)]
pub struct Examination {
    /// Topic by topic.
    pub findings: Vec<ComputerFinding>,
    /// How late periods begin; `None`: not measured.
    pub latency: Option<Latency>,
    /// What lateness does to a tap.
    pub effect: Effect,
}

impl Examination {
    /// A machine is not to be led from this computer as it is.
    pub fn is_wrong(&self) -> bool {
        self.findings.iter().any(|finding| finding.health == Health::Wrong)
    }
}

/// Looks at the computer; nothing is changed.
pub fn examine(computer: &Computer, rights: Rights, options: &ExaminationOptions) -> Examination {
    let mut findings = vec![system::kernel(computer)];
    findings.extend(system::virtual_machine(computer));
    findings.extend(system::rights(computer, rights));
    findings.push(system::clock(computer));
    findings.extend(cores::cores(computer));
    findings.extend(cores::interrupts(computer));
    findings.push(cores::idle(computer, options.period));
    findings.extend(cores::speed(computer));
    if let Some(interface) = &options.interface {
        findings.extend(network::network(computer, interface, rights));
    }
    findings.extend(hal::hal(computer, rights, options.uses_hal));
    Examination { findings, latency: None, effect: Effect::at(options.tapping_max) }
}

impl Examination {
    /// The same with what was measured.
    #[must_use]
    pub fn with_latency(mut self, latency: Latency) -> Self {
        self.findings.push(judged(&latency, self.effect));
        self.latency = Some(latency);
        self
    }
}

fn judged(latency: &Latency, effect: Effect) -> ComputerFinding {
    let us = |time: Time| time.value() * 1e6;
    let beside = if latency.under_load { ", with every core busy" } else { "" };
    let says = format!(
        "the latest of {} periods of {:.0} µs began {:.0} µs late{beside}, 999 of 1000 within {:.0} µs; a tap of {} mm lead at {:.0} rev/min is then up to {:.1} µm behind its thread",
        latency.periods,
        us(latency.period),
        us(latency.worst),
        us(latency.quantile(0.999)),
        effect.lead.value(),
        effect.speed.in_rpm(),
        effect.behind(latency.worst).in_um(),
    );
    let topic = Topic::Latency;
    if latency.worst > latency.period {
        let missed = format!(
            "{says}. {} began more than a period late: drives went on with the setpoint before",
            latency.missed
        );
        return ComputerFinding::wrong(
            topic,
            missed,
            "what is marked above; if nothing is, a longer period_us in the machine file, or another computer",
        );
    }
    if latency.worst.value() > LATE_SHARE * latency.period.value() {
        return ComputerFinding::improve(topic, says, "what is marked above; then measure again");
    }
    ComputerFinding::good(topic, says)
}
