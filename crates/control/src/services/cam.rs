//! Beside the machine while it grinds cams: takes the samples, looks at each turn that ends,
//! measures, teaches.
//!
//! ```text
//!   samples of a turn ─► fold ─► measured profile ─┬─► G55: phase error, answer ─► table, planner
//!                                                  └─► learning: next table ─► kernel, faded over, settled
//! ```
//!
//! The kernel waits at the end of a turn with everything coupled and turning, so nothing here
//! hurries.
use crate::KernelHandle;
use crate::clock::now;
use crate::job::cams::CamSetup;
use crate::job::options::Compensation;
use bus::Sample;
use canon::{Axis, CamOrder, Op, OpKind};
use motion::{Superpose, Superposed, TableId};
use plan::{Planner, TURN_ENDED, turned};
use std::collections::VecDeque;
use std::time::Duration;
use store::phases::{Measured, Phases, Swung, form_mark};
use sync::{Pair, PhaseError, Repetition, Response, Spectrum, fold, phase_error};
use units::{Angle, Length, Spin};

/// Share of the lift at which the flanks are read.
const FLANK_LEVEL: f64 = 0.5;
/// Turns over which one table fades into the next.
const EXCHANGE: Angle = Angle::rev(0.25);
/// Turns after that until the axis has settled on it.
const SETTLE: Angle = Angle::rev(1.0);
/// A little more than a turn, so that every node is passed.
const A_TURN: Angle = Angle::rev(1.02);
/// Names of the tables that are made here; the planner counts up from 1.
const FIRST_TABLE: u16 = 0xC000;

/// What it does at present.
#[derive(Debug, Default)]
struct Now {
    profile: Option<(u32, Angle)>,
    /// By how much the work is ahead of its even turn, where its speed varies.
    lead: Option<sync::Periodic>,
    compensated: bool,
    sampling: bool,
    turning: Option<Spin>,
    /// Speed of the turns sampled last.
    last_spin: Option<Spin>,
    samples: Vec<Pair>,
    /// Measured profiles, a turn each.
    turns: Vec<Vec<f64>>,
    learning: Option<Repetition>,
    /// Another table has been sent: the machine is settled on it from this angle on.
    settled_at: Option<Angle>,
    order: Option<CamOrder>,
}

/// The host of cam grinding.
pub struct CamHost {
    setup: CamSetup,
    orders: VecDeque<(u32, CamOrder)>,
    /// Orders to compute and keep that have not been done.
    open: usize,
    now: Now,
    next_table: u16,
    /// What was found, for people.
    pub said: Vec<String>,
    changed: bool,
    /// How far the wheel's edge stood back from its axis in the last period: in the end, what it
    /// has lost.
    back: Length,
    /// What looking at turns has cost here, and how many there were.
    cost: (Duration, u32),
}

impl CamHost {
    /// For a session's cams.
    pub fn new(setup: CamSetup) -> Self {
        Self {
            setup,
            orders: VecDeque::new(),
            open: 0,
            now: Now::default(),
            next_table: FIRST_TABLE,
            said: Vec::new(),
            changed: false,
            back: Length::ZERO,
            cost: (Duration::ZERO, 0),
        }
    }

    /// What the program orders.
    pub fn op(&mut self, index: u32, op: &Op) {
        if let OpKind::Cam(order) = op.kind {
            self.open += usize::from(order == CamOrder::StorePhase);
            self.orders.push_back((index, order));
        }
    }

    /// Whether planning of this op must wait for a measurement that comes before it.
    pub fn is_early(&self, op: &Op) -> bool {
        let grinds =
            matches!(op.kind, OpKind::Cam(CamOrder::Grind { .. } | CamOrder::SparkOut { .. }));
        grinds && self.open > 0
    }

    /// One servo period.
    pub fn sample(&mut self, sample: &Sample) {
        while let Some((_, order)) =
            self.orders.front().filter(|(index, _)| *index <= sample.report.op).copied()
        {
            self.orders.pop_front();
            self.begin(order);
        }
        self.back = sample.truth.as_ref().map_or(Length::ZERO, |truth| truth.tool_deflection);
        if self.now.sampling && self.now.turning.is_some() {
            let phase = self.now.profile.map_or(Angle::ZERO, |p| p.1);
            let (half_angle, half_way) = self.setup.half_counts;
            let angle = sample.feedback.spindles[0].angle + half_angle - phase;
            self.now.samples.push(Pair {
                angle: self.now.lead.as_ref().map_or(angle, |lead| even_turn(lead, angle)),
                position: sample.feedback.axes[0].position.of_linear() + half_way,
            });
        }
    }

    fn begin(&mut self, order: CamOrder) {
        let now = &mut self.now;
        now.turning = None;
        match order {
            CamOrder::Select { profile, phase, .. } => {
                *now = Now { profile: Some((profile, phase)), ..Now::default() };
            }
            CamOrder::Deselect => *now = Now::default(),
            CamOrder::Compensate => now.compensated = true,
            CamOrder::ResetSampling => {
                (now.sampling, now.samples, now.turns) = (false, Vec::new(), Vec::new());
            }
            CamOrder::StartSampling => now.sampling = true,
            CamOrder::SparkOut { spin, .. } => {
                (now.turning, now.last_spin) = (Some(spin), Some(spin));
                now.samples.clear();
                now.learning = None;
                let course = now.profile.and_then(|(number, _)| self.setup.course(number, spin));
                let lead = course.and_then(|course| course.lead.as_deref());
                now.lead = lead.and_then(|lead| sync::Periodic::new(lead).ok());
            }
            CamOrder::Grind { .. } | CamOrder::StorePhase => {}
        }
        now.order = Some(order);
    }

    /// The kernel asks: look at the turn that has ended, and let it go on when nothing is to be
    /// waited for.
    pub fn consult(&mut self, kernel: &mut KernelHandle, planner: &mut Planner) {
        if kernel.consulted() != Some(TURN_ENDED) {
            return;
        }
        if let Some(until) = self.now.settled_at {
            let here = self.now.samples.last().map_or(Angle::ZERO, |p| p.angle);
            if !kernel.has_faded() || here < until {
                return;
            }
            self.now.settled_at = None;
            self.now.samples.clear();
            return kernel.answer();
        }
        match self.now.order {
            Some(CamOrder::StorePhase) => {
                self.open = self.open.saturating_sub(1);
                self.store(planner);
                kernel.answer();
            }
            Some(CamOrder::SparkOut { spin, .. }) => {
                let began = now();
                let settles = self.turn_ended(spin, kernel);
                self.cost.0 += now() - began;
                self.cost.1 += 1;
                if !settles {
                    kernel.answer();
                }
            }
            _ => kernel.answer(),
        }
    }

    /// Fold the last turn; whether the machine must settle on another table first.
    fn turn_ended(&mut self, spin: Spin, kernel: &mut KernelHandle) -> bool {
        let Some((number, phase)) = self.now.profile else { return false };
        let Some(profile) = self.setup.library.get(number).cloned() else { return false };
        let Some(ideal) = self.ideal(number, spin) else { return false };
        let Some(measured) = self.last_turn(&ideal) else { return false };
        let taught = self.setup.method == Compensation::Learn && self.now.compensated;
        if !taught {
            self.now.turns.push(measured);
            return false;
        }
        let learning = match self.now.learning.take() {
            Some(learning) => learning,
            None => self.setup.begin(&profile, spin, &ideal),
        };
        let learning = self.now.learning.insert(learning);
        let error = largest(&ideal, &measured);
        self.said.push(format!(
            "learning P{number} at {:.0} rpm, turn {}: largest error by the encoders {:.2} µm",
            spin.in_rpm(),
            learning.turns() + 1,
            error * 1e3
        ));
        self.now.turns = vec![measured.clone()];
        learning.learn(&measured);
        let top = profile.top().value();
        let sent = self.setup.pulsed(learning.table());
        let less_top: Vec<f64> = sent.iter().map(|x| x - top).collect();
        let Ok(table) = kernel::Periodic::new(&turned(&less_top, phase.value())) else {
            return false;
        };
        let id = TableId(self.next_table);
        self.next_table = self.next_table.checked_add(1).unwrap_or(FIRST_TABLE);
        if !kernel.put_table(id, table) {
            return false;
        }
        let order = Superpose {
            on: Superposed::Axis(Axis::X),
            master: 0,
            table: Some(id),
            turns: 1.0,
            over: EXCHANGE,
        };
        if kernel.superpose(&order).is_err() {
            return false;
        }
        let here = self.now.samples.last().map_or(Angle::ZERO, |p| p.angle);
        self.now.settled_at = Some(here + EXCHANGE + SETTLE);
        true
    }

    /// Where the wheel belongs over the even turn of the work.
    fn ideal(&self, number: u32, spin: Spin) -> Option<Vec<f64>> {
        self.setup.course(number, spin).map(|course| course.nodes.clone())
    }

    /// The measured profile of the last turn, with the mean of the ideal one: where X is zero is
    /// not its matter.
    fn last_turn(&mut self, ideal: &[f64]) -> Option<Vec<f64>> {
        let samples = &self.now.samples;
        let end = samples.last()?.angle;
        let first = samples.partition_point(|p| p.angle < end - A_TURN);
        let mut measured = match fold(&samples[first..], ideal.len()) {
            Ok(measured) => measured,
            Err(error) => {
                self.said.push(format!("a turn was not measured: {error}"));
                return None;
            }
        };
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let off = mean(&measured) - mean(ideal);
        for x in &mut measured {
            *x -= off;
        }
        Some(measured)
    }

    /// G55: from the turns that were sampled to the table.
    fn store(&mut self, planner: &mut Planner) {
        let Some((number, _)) = self.now.profile else { return };
        let Some(profile) = self.setup.library.get(number).cloned() else { return };
        let count = self.now.turns.len();
        let spin = match self.now.last_spin {
            Some(spin) if count > 0 => spin,
            _ => return self.said.push(format!("P{number}: no whole turn was sampled")),
        };
        let Some(ideal) = self.ideal(number, spin) else { return };
        let mean: Vec<f64> = (0..ideal.len())
            .map(|i| self.now.turns.iter().map(|turn| turn[i]).sum::<f64>() / count as f64)
            .collect();
        let form = form_mark(&profile.nodes);
        let mut kept = Measured {
            profile: number,
            form: form.clone(),
            rpm: spin.in_rpm(),
            ..Measured::default()
        };
        if let Some(learning) = &self.now.learning {
            // what is measured while compensated is what is left, not the machine's own phase error
            if let Some(before) =
                self.setup.phases.of(number, &form).find(|m| (m.rpm - kept.rpm).abs() < 1e-6)
            {
                kept = before.clone();
            }
            kept.learnt_nm = learning
                .table()
                .iter()
                .zip(&ideal)
                .map(|(sent, d)| ((sent - d) * 1e9).round() * 1e-3)
                .collect();
            kept.learnt_form = form_mark(&ideal);
            kept.response = points(&learning.response());
            self.said.push(format!(
                "P{number} at {:.0} rpm learnt in {} turns: rms {:.3} µm by the encoders, {} harmonics left alone",
                spin.in_rpm(),
                learning.turns(),
                learning.best_rms().in_um(),
                learning.left_alone()
            ));
        } else if self.now.compensated {
            let left = largest(&ideal, &mean);
            return self.said.push(format!(
                "P{number} at {:.0} rpm: largest error with compensation {:.2} µm",
                spin.in_rpm(),
                left * 1e3
            ));
        } else {
            match phase_error(&ideal, &mean, FLANK_LEVEL) {
                Ok(found) => {
                    self.said.push(sentence(number, spin, &found));
                    fill(&mut kept, &found, &ideal, &mean, spin);
                }
                Err(error) => return self.said.push(format!("P{number}: {error}")),
            }
        }
        self.setup.phases.keep(kept);
        self.changed = true;
        *planner.cams() = self.setup.for_planner();
    }

    /// The program is over. The program is over; `allowed`: the planner sent the wheel so much
    /// farther for what it would lose.
    pub fn end(&mut self, allowed: Length) {
        if self.setup.grinds() && self.back > Length::ZERO {
            let (lost, allowed) = (self.back.in_um(), allowed.in_um());
            self.said.push(format!(
                "the wheel has lost {lost:.2} µm of its radius, and was sent {allowed:.2} µm farther for it"
            ));
        }
    }

    /// What was measured, before this run and in it.
    /// What was found of oscillations, which stand in the same table.
    pub fn keep(&mut self, said: Vec<String>, swung: Vec<Swung>) {
        self.said.extend(said);
        self.changed |= !swung.is_empty();
        for one in swung {
            self.setup.phases.keep_swung(one);
        }
    }

    /// The table as it is now.
    pub const fn phases(&self) -> &Phases {
        &self.setup.phases
    }

    /// Mean cost of looking at one turn here.
    pub fn cost(&self) -> Option<Duration> {
        self.cost.0.checked_div(self.cost.1)
    }

    /// Keep what was found on disk.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self) -> Result<(), crate::Refused> {
        if self.changed { self.setup.save() } else { Ok(()) }
    }
}

/// φ of φ + lead(φ) = ψ, by Newton's steps from ψ; the work never turns back, so it is the only
/// one.
fn even_turn(lead: &sync::Periodic, psi: Angle) -> Angle {
    let mut phi = psi.value();
    for _ in 0..8 {
        let at = lead.at(phi);
        let off = phi + at.value - psi.value();
        phi -= off / (1.0 + at.slope);
        if off.abs() < 1e-12 {
            break;
        }
    }
    Angle::rev(phi)
}

fn fill(kept: &mut Measured, found: &PhaseError, ideal: &[f64], measured: &[f64], spin: Spin) {
    kept.phase_error_deg = found.least_squares.shift.in_deg();
    kept.sigma_deg = found.least_squares.sigma.in_deg();
    kept.by_maximum_deg = found.maximum.shift.in_deg();
    kept.by_flanks_deg = found.flanks.shift.in_deg();
    let (sent, came) =
        (Spectrum::of(ideal, sync::HARMONICS), Spectrum::of(measured, sync::HARMONICS));
    // a harmonic is believed where it stands well above the noise of its nodes
    let smallest = 12.0 * found.noise.value() / (ideal.len() as f64).sqrt();
    kept.response = points(&Response::of(&sent, &came, spin, smallest.max(1e-6)));
}

fn points(response: &Response) -> Vec<[f64; 3]> {
    let round = |x: f64| (x * 1e9).round() * 1e-9;
    response.points().map(|(hz, gain, delay)| [round(hz), round(gain), round(delay)]).collect()
}

fn sentence(number: u32, spin: Spin, found: &PhaseError) -> String {
    let of = |e: &sync::Estimate| format!("{:.4}° ± {:.4}°", e.shift.in_deg(), e.sigma.in_deg());
    format!(
        "P{number} at {:.0} rpm: phase error {} by least squares, {} by the flanks, {} by the maxima; noise {:.2} µm",
        spin.in_rpm(),
        of(&found.least_squares),
        of(&found.flanks),
        of(&found.maximum),
        found.noise.in_um()
    )
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
