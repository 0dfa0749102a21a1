//! The machine simulator itself: the simulated machine, what its encoders keep, and its drives when
//! they are alone.
use super::SimulatorOptions;
use super::command_monitor::CommandMonitor;
use super::retained::Retained;
use bus::{Command, DriveReaction, EngagedTool, Feedback, Machine, RunDownKind, SPINDLES, Truth};
use control::Refused;
use control::config;
use control::job::Session;
use sim::{Bus, RunDown, SimulatedMachine};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::Path;
use units::{Angle, Length, SpinAccel, Time};
use wire::{Observed, Welcome};

/// The simulated machine, what its encoders and its retentive bits keep, and its drives when they
/// are alone.
pub struct SimulatorProcess {
    config: sim::Config,
    machine: SimulatedMachine,
    name: String,
    serial: u64,
    epoch: u64,
    reactions: [DriveReaction; 2],
    bus: Option<Bus>,
    /// Delay and deceleration of a spindle's drive that makes its own ramps, as set in it.
    own_ramps: Option<(Time, SpinAccel)>,
    keeps_turns: [bool; SPINDLES],
    /// Turns that an encoder no longer counts.
    forgotten: [f64; SPINDLES],
    turns_lost: [bool; SPINDLES],
    stop: RunDownKind,
    retained: Retained,
    monitor: CommandMonitor,
    last: Command,
    /// The latest first.
    cuts: Vec<Time>,
    sessions: u64,
    /// Changes with each control, and when the mains fail.
    session: u64,
    /// Since the session began: of the axis from the helix while tied to the spindle; of the force
    /// on the tap.
    off_helix: Length,
    force_n: f64,
    pub(super) real_time: bool,
    pub(super) watchdog: Time,
}

/// Why the drives are alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Alone {
    /// The control has fallen silent.
    Link,
    /// The mains have failed.
    Power,
}

impl SimulatorProcess {
    /// As the options have it, at rest.
    ///
    /// # Errors
    /// Machine, tools or material cannot be read, or no machine can be as the file says.
    pub fn new(options: &SimulatorOptions) -> Result<Self, Refused> {
        let session = Session::load(&options.source, Path::new("-"), b"")?;
        let file = &session.machine;
        let material = crate::material(options.material.as_deref(), file.setup.stock.material)?;
        let seed = options.seed.unwrap_or(u64::from(file.simulation.seed));
        let zero = session.work_zero();
        let config = config::simulator(file, &session.tools, material, seed, &zero);
        let machine = control::drives::simulated::build(file, config.clone())?;
        let mut keeps_turns = [true; SPINDLES];
        for (keeps, spindle) in keeps_turns.iter_mut().zip(&file.spindles) {
            *keeps = spindle.encoder_keeps_turns && !options.single_turn;
        }
        let mut cuts = options.power_cuts.clone();
        cuts.sort_by(|a, b| b.value().total_cmp(&a.value()));
        let drives = &file.drives;
        Ok(Self {
            name: file.name.clone(),
            serial: options.serial,
            // a new machine simulator has new encoders: nothing that was written of others holds
            // for them
            epoch: options.epoch.unwrap_or_else(|| RandomState::new().build_hasher().finish()),
            reactions: [
                options.on_link_loss.unwrap_or(drives.on_link_loss),
                options.on_power_loss.unwrap_or(drives.on_power_loss),
            ],
            bus: drives.bus.map(|bus| Bus {
                farad: bus.capacitance_f,
                volt: bus.voltage_v,
                trip_volt: bus.trip_v,
            }),
            own_ramps: file
                .spindles
                .first()
                .and_then(|spindle| spindle.own_ramps)
                .map(|own| (own.delay, own.deceleration)),
            keeps_turns,
            forgotten: [0.0; SPINDLES],
            turns_lost: [false; SPINDLES],
            stop: RunDownKind::None,
            retained: Retained::default(),
            monitor: CommandMonitor::new(file),
            last: Command::default(),
            cuts,
            sessions: 0,
            session: 0,
            off_helix: Length::ZERO,
            force_n: 0.0,
            real_time: options.real_time,
            watchdog: drives.watchdog,
            config,
            machine,
        })
    }

    /// What it says when a control connects.
    pub(super) fn welcome(&mut self) -> Welcome {
        self.sessions += 1;
        self.session += 1;
        (self.off_helix, self.force_n) = (Length::ZERO, 0.0);
        self.retained.begin_session();
        self.monitor.begin_session();
        Welcome {
            machine: self.name.clone(),
            serial: self.serial,
            epoch: self.epoch,
            period: self.config.period,
            real_time: self.real_time,
            turns_lost: self.turns_lost,
            stop: self.stop,
            evidence: self.retained.evidence(),
            observed: self.answer(),
        }
    }

    /// Which session it is; it is over for a control that has begun another one.
    pub(super) const fn session(&self) -> u64 {
        self.session
    }

    /// Its name.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// For people: which it is.
    pub(super) fn who(&self) -> String {
        format!("{} number {:x}, encoders of epoch {:016x}", self.name, self.serial, self.epoch)
    }

    pub(super) fn period(&self) -> Time {
        self.config.period
    }

    /// What encoders and the world say now.
    pub(super) fn observed(&self) -> Observed {
        let mut feedback = *self.machine.feedback();
        let mut truth = self.machine.truth().copied();
        self.forget(&mut feedback, truth.as_mut());
        Observed { feedback, truth }
    }

    /// A control says which tool it has in the work, with a command that it sends.
    ///
    /// # Errors
    /// Another tool is in the work than it says: it may move nothing.
    pub(super) fn hear(&mut self, said: Option<EngagedTool>) -> Result<(), String> {
        if self.retained.hear(said)? {
            self.stop = RunDownKind::None;
        }
        Ok(())
    }

    /// A new tool of this number is in the place of the old one.
    pub(super) fn renew_tool(&mut self, number: u32) {
        self.machine.renew_tool(number);
    }

    /// The operator has seen that no tool is in the work.
    pub(super) const fn tool_is_free(&mut self) {
        self.retained.tool_is_free();
    }

    /// What the control is told, which its next command answers.
    pub(super) fn answer(&mut self) -> Observed {
        let observed = self.observed();
        self.monitor.tell(observed.feedback.time);
        observed
    }

    /// Obey for a period; `false`: the mains have failed instead.
    ///
    /// # Errors
    /// The drives obey no such command.
    pub(super) fn obey(&mut self, command: &Command) -> Result<bool, String> {
        let now = self.machine.feedback().time;
        if self.cuts.pop_if(|at| *at <= now).is_some() {
            return Ok(false);
        }
        self.monitor.check(command, self.machine.feedback())?;
        self.last = *command;
        let before = *self.machine.feedback();
        let after = self.machine.exchange(command);
        if let Some(coupled) = command.coupled {
            let turned =
                |feedback: &Feedback| feedback.spindles[usize::from(coupled.spindle)].angle;
            self.retained.turned((turned(after) - turned(&before)) / self.config.period);
        }
        self.feel();
        if let Some(off) = self.machine.off_helix().filter(|_| command.coupled.is_some()) {
            self.off_helix = self.off_helix.max(off.abs());
        }
        Ok(true)
    }

    /// Remember the largest force on the tap.
    fn feel(&mut self) {
        if let Some(truth) = self.machine.truth() {
            self.force_n = self.force_n.max(truth.cutting_force.value().abs());
        }
    }

    /// The drives are alone: until everything stands. What an encoder does not keep without power
    /// is gone then. Drives that had not been enabled do nothing: a control that only looked leaves
    /// no trace.
    pub(super) fn leave_alone(&mut self, why: Alone) {
        let enabled = self.last.axes.iter().any(|axis| axis.enable)
            || self.last.spindles.iter().any(|spindle| spindle.enable);
        if enabled {
            self.run_down(why);
        }
        if why == Alone::Power {
            self.session += 1;
            self.lose_turns();
        }
    }

    fn run_down(&mut self, why: Alone) {
        let bus = self.bus.filter(|_| why == Alone::Power);
        let reaction = self.reactions[usize::from(why == Alone::Power)];
        let began = self.observed().feedback;
        let mut drives = RunDown::new(&self.config, reaction, bus, &self.last, &began);
        if let Some((delay, decel)) = self.own_ramps {
            drives = drives.on_own_ramps(delay, decel);
        }
        while !drives.is_over() {
            let now = self.observed().feedback;
            if now.time - began.time > RunDown::LONGEST {
                break;
            }
            let command = drives.command(&now);
            self.machine.exchange(&command);
            self.feel();
        }
        let stop = match reaction {
            _ if drives.has_tripped() => RunDownKind::Coasted,
            DriveReaction::Off => RunDownKind::Coasted,
            DriveReaction::Coast if self.last.coupled.is_none() => RunDownKind::Coasted,
            DriveReaction::QuickStop => RunDownKind::QuickStop,
            // tied to nothing, they have stopped apart
            DriveReaction::CoupledStop if self.last.coupled.is_none() => RunDownKind::QuickStop,
            DriveReaction::Coast | DriveReaction::CoupledStop => RunDownKind::Coupled,
        };
        self.stop =
            if self.retained.evidence().in_work.is_some() { self.stop.max(stop) } else { stop };
        self.last = Command { tool: self.last.tool, ..Command::default() };
    }

    fn lose_turns(&mut self) {
        let feedback = self.machine.feedback();
        for index in 0..self.config.spindles.len().min(SPINDLES) {
            if !self.keeps_turns[index] {
                self.forgotten[index] = feedback.spindles[index].angle.value().floor();
                self.turns_lost[index] = true;
            }
        }
    }

    /// Count turns as the encoders do.
    fn forget(&self, feedback: &mut Feedback, truth: Option<&mut Truth>) {
        for (spindle, turns) in feedback.spindles.iter_mut().zip(self.forgotten) {
            spindle.angle -= Angle::rev(turns);
            spindle.index = spindle.index.map(|index| index - Angle::rev(turns));
        }
        if let Some(truth) = truth {
            for (angle, turns) in truth.spindles.iter_mut().zip(self.forgotten) {
                *angle -= Angle::rev(turns);
            }
        }
    }

    /// How it is, as JSON.
    pub(super) fn status(&self) -> String {
        let observed = self.observed();
        let truth = observed.truth.unwrap_or_default();
        let threads = self.machine.holes().iter().filter_map(|hole| {
            let thread = hole.thread?;
            Some(serde_json::json!({
                "x_mm": hole.x.value(),
                "y_mm": hole.y.value(),
                "depth_mm": thread.tip_depth.value(),
                "lead_mm": thread.lead.value(),
            }))
        });
        serde_json::json!({
            "machine": self.name,
            "serial": self.serial,
            "epoch": format!("{:016x}", self.epoch),
            "time_s": observed.feedback.time.value(),
            "sessions": self.sessions,
            "tool": observed.feedback.tool,
            "tool_broken": truth.tool_broken,
            "tap_in_thread": self.machine.off_helix().is_some(),
            "off_helix_um": self.machine.off_helix().map(Length::in_um),
            "off_helix_while_coupled_max_um": self.off_helix.in_um(),
            "axial_force_n": truth.cutting_force.value(),
            "axial_force_max_n": self.force_n,
            "z_mm": truth.axes[2].value(),
            "spindle_rev": truth.spindles[0].value(),
            "spindle_rpm": truth.spins[0].in_rpm(),
            "tool_in_work": self.retained.evidence().in_work.map(|engagement| engagement.tool),
            "engagements": self.retained.evidence().last,
            "turns_lost": self.turns_lost[0],
            "stop": match self.stop {
                RunDownKind::None => "none",
                RunDownKind::Coasted => "coasted",
                RunDownKind::QuickStop => "quick-stop",
                RunDownKind::Coupled => "coupled-stop",
            },
            "threads": threads.take(50).collect::<Vec<_>>(),
        })
        .to_string()
    }
}
