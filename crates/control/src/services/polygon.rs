//! Beside the machine while a polygon's oscillation is measured in the air (G51.4): takes the
//! samples, compares what came with what was ordered, corrects.
//!
//! ```text
//!   samples of a few turns ─► fold over the work's angle ─► sync::Repetition, harmonic by harmonic
//!       X, Y: place of the tool side   less its mean              │
//!       tool: θ_tool − R·θ_work − phase                           ▼
//!   kernel ◄─ next table, faded over, settled ◄─ within the limits of the actuator
//! ```
//!
//! What is compared is what the encoders say in the air (of a slide less the stretch that the
//! control knows of its screw: its motor goes farther on purpose), with the work's own angle as it
//! really is: gain and phase of each harmonic, and of the tool spindle also the constant lag behind
//! its gear, which would turn all facets a little. The last look measures what will cut. No
//! correction may ask more of an actuator than its limits, or than was ordered.
use crate::KernelHandle;
use crate::polygon::drives::{self, Reversing};
use crate::polygon::{Slide, kept};
use bus::Sample;
use canon::{Harmonic, Op, OpKind, Oscillating, Polygon, SpindleOrder};
use kernel::Periodic;
use motion::{Superpose, Superposed, TableId};
use plan::{OSCILLATION_SEEN, sampled};
use std::collections::VecDeque;
use store::machine::MachineFile;
use store::phases::Swung;
use sync::{Complex, Pair, Repetition, RepetitionOptions, Spectrum, Taught, fold};
use units::{Angle, Length, Spin};

/// Turns over which one table fades into the next.
const EXCHANGE: Angle = Angle::rev(1.0);
/// Turns after that until everything has settled.
const SETTLE: Angle = Angle::rev(2.0);
/// Turns that a look folds.
const LOOK: Angle = Angle::rev(4.0);
/// Names of the tables that are made here; the planner counts up from 1, the cams' from 0xC000.
const FIRST_TABLE: u16 = 0xE000;
/// A follower whose rms error is below this share of a count of its encoder is as good as can be
/// told.
const FLOOR_COUNTS: f64 = 0.05;
/// Steps by which a correction that asks too much is taken back.
const BISECTIONS: u32 = 20;

/// What the program orders.
enum PolygonOrder {
    Work(Spin),
    Gear(Box<Polygon>),
    Measure(u32),
    End,
}

/// One thing that swings, and what is learnt of it.
struct Follower {
    on: Oscillating,
    ordered: Vec<Harmonic>,
    ideal: Vec<f64>,
    /// What the program has it send, and what the kernel sends at present.
    sent: Vec<f64>,
    active: Vec<f64>,
    /// A slide's screw, whose far end no motor's encoder sees.
    through: Option<Slide>,
    /// What a slide's friction may do to it.
    friction: Option<Reversing>,
    learning: Option<Repetition>,
    samples: Vec<Pair>,
    /// Root mean square of the error, before and now.
    errors: Vec<f64>,
}

/// The host of polygon turning.
pub struct PolygonHost {
    machine: MachineFile,
    orders: VecDeque<(u32, PolygonOrder)>,
    work: Spin,
    polygon: Option<Box<Polygon>>,
    followers: Vec<Follower>,
    looks_left: u32,
    settled_at: Option<Angle>,
    next_table: u16,
    /// What was found, for people.
    pub said: Vec<String>,
    /// What was found, to be kept.
    pub kept: Vec<Swung>,
}

impl PolygonHost {
    /// For this machine.
    pub fn new(machine: &MachineFile) -> Self {
        Self {
            machine: machine.clone(),
            orders: VecDeque::new(),
            work: Spin::ZERO,
            polygon: None,
            followers: Vec::new(),
            looks_left: 0,
            settled_at: None,
            next_table: FIRST_TABLE,
            said: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// What the program orders.
    pub fn op(&mut self, index: u32, op: &Op) {
        let order = match &op.kind {
            OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(spin) } => {
                PolygonOrder::Work(*spin)
            }
            OpKind::Polygon(polygon) => PolygonOrder::Gear(Box::new(polygon.clone())),
            OpKind::PolygonMeasure { looks } => PolygonOrder::Measure(*looks),
            OpKind::PolygonEnd => PolygonOrder::End,
            _ => return,
        };
        self.orders.push_back((index, order));
    }

    /// One servo period.
    pub fn sample(&mut self, sample: &Sample, kernel: &KernelHandle) {
        while self.orders.front().is_some_and(|(index, _)| *index <= sample.report.op) {
            let Some((_, order)) = self.orders.pop_front() else { return };
            match order {
                PolygonOrder::Work(spin) => self.work = spin,
                PolygonOrder::Gear(polygon) => self.polygon = Some(polygon),
                PolygonOrder::Measure(looks) => self.begin(looks),
                PolygonOrder::End => (self.polygon, self.looks_left) = (None, 0),
            }
        }
        let Some(polygon) = self.polygon.as_ref().filter(|_| self.looks_left > 0) else { return };
        let angle = sample.feedback.spindles[usize::from(polygon.work)].angle;
        let tool = sample.feedback.spindles[usize::from(polygon.tool)].angle;
        for follower in &mut self.followers {
            let place = match follower.on {
                // the motor goes farther than the tool side by what its screw gives
                Oscillating::Axis(axis) => kernel.tool_side(axis).unwrap_or_default().value(),
                Oscillating::ToolPhase => {
                    (tool - angle * polygon.ratio.value() - polygon.phase).value()
                }
            };
            // the argument of what swings: the share of the gear's period
            let angle = angle / polygon.period();
            follower.samples.push(Pair { angle, position: Length::mm(place) });
        }
    }

    fn begin(&mut self, looks: u32) {
        let Some(polygon) = &self.polygon else { return };
        let wanted = |on| polygon.wanted.iter().find(|o| o.on == on);
        let follower = |o: &canon::Oscillation| {
            let ordered = wanted(o.on).unwrap_or(o).harmonics.clone();
            let sent = sampled(&polygon.by_work(&o.harmonics));
            Follower {
                on: o.on,
                ideal: sampled(&polygon.by_work(&ordered)),
                ordered,
                active: sent.clone(),
                sent,
                through: drives::screw(&self.machine, o, self.repeats(polygon)),
                friction: Reversing::of(&self.machine, o, self.repeats(polygon)),
                learning: None,
                samples: Vec::new(),
                errors: Vec::new(),
            }
        };
        // where X only stands, nothing swings that could be measured
        let swings = |o: &&canon::Oscillation| o.harmonics.iter().any(|h| h.per_turn > 0);
        self.followers = polygon.oscillations.iter().filter(swings).map(follower).collect();
        (self.looks_left, self.settled_at) = (looks, None);
    }

    /// How often a second what swings begins anew.
    fn repeats(&self, polygon: &Polygon) -> Spin {
        self.work / polygon.period()
    }

    /// The kernel asks: look, correct, and let it go on when nothing is to be waited for.
    pub fn consult(&mut self, kernel: &mut KernelHandle) {
        if kernel.consulted() != Some(OSCILLATION_SEEN) {
            return;
        }
        if let Some(until) = self.settled_at {
            let turned = self.followers.first().and_then(|f| f.samples.last()).map(|p| p.angle);
            let there =
                turned.is_none_or(|angle| (angle - until).value() * self.work.value() >= 0.0);
            if !kernel.has_faded() || !there {
                return;
            }
            self.settled_at = None;
            for follower in &mut self.followers {
                follower.samples.clear();
            }
            return kernel.answer();
        }
        if self.looks_left == 0 {
            return kernel.answer();
        }
        self.looks_left -= 1;
        let Some(polygon) = self.polygon.take() else { return kernel.answer() };
        let mut followers = core::mem::take(&mut self.followers);
        let mut changed = false;
        for follower in &mut followers {
            changed |= self.look(follower, &polygon, kernel);
            if self.looks_left == 0 {
                self.keep(follower, &polygon);
            }
        }
        let here = followers.first().and_then(|f| f.samples.last()).map(|p| p.angle);
        if let Some(here) = here.filter(|_| changed) {
            let turns = polygon.period();
            self.settled_at = Some(here + (EXCHANGE + SETTLE) / turns * self.work.value().signum());
        } else {
            kernel.answer();
        }
        (self.followers, self.polygon) = (followers, Some(polygon));
    }

    /// Compare and correct one follower; whether another table was sent.
    fn look(
        &mut self,
        follower: &mut Follower,
        polygon: &Polygon,
        kernel: &mut KernelHandle,
    ) -> bool {
        let measured = match follower.measured(self.repeats(polygon)) {
            Ok(measured) => measured,
            Err(why) => {
                self.said.push(format!("{} was not measured: {why}", kept::name(follower.on)));
                return false;
            }
        };
        let square = |(a, b): (&f64, &f64)| (a - b) * (a - b);
        let sum: f64 = measured.iter().zip(&follower.ideal).map(square).sum();
        follower.errors.push((sum / measured.len() as f64).sqrt());
        let repeats = self.repeats(polygon);
        let learning = follower.learning.get_or_insert_with(|| {
            let highest = follower.ordered.iter().map(|h| h.per_turn).max().unwrap_or(1);
            let options = RepetitionOptions {
                highest_hz: (f64::from(highest) + 0.5) * repeats.abs().value(),
                floor: Length::mm(FLOOR_COUNTS * count(&self.machine, follower.on, polygon)),
            };
            Repetition::resumed(&follower.ideal, repeats, options, &follower.active)
        });
        let taught = learning.learn(&measured);
        // what was measured last is what cuts, unless something measured before was better
        if self.looks_left == 0 && taught == Taught::Updated {
            return false;
        }
        let most = drives::most(&self.machine, follower.on, polygon, self.work);
        let next = within(most, &follower.sent, &learning.table(), repeats);
        if next == follower.active {
            return false;
        }
        let Ok(table) = Periodic::new(&next) else { return false };
        let id = TableId(self.next_table);
        self.next_table = self.next_table.checked_add(1).unwrap_or(FIRST_TABLE);
        let on = match follower.on {
            Oscillating::Axis(axis) => Superposed::Axis(axis),
            Oscillating::ToolPhase => Superposed::Spindle(polygon.tool),
        };
        let turns = polygon.period();
        let order = Superpose { on, master: polygon.work, table: Some(id), turns, over: EXCHANGE };
        let sent = kernel.put_table(id, table) && kernel.superpose(&order).is_ok();
        if sent {
            follower.active = next;
        }
        sent
    }

    /// Say and keep what came of it.
    fn keep(&mut self, follower: &Follower, polygon: &Polygon) {
        let Some(learning) = &follower.learning else { return };
        let highest = follower.ordered.iter().map(|h| h.per_turn).max().unwrap_or(1);
        let spectrum = Spectrum::of(&follower.active, highest as usize);
        let round = |x: f64| (x * 1e9).round() * 1e-9;
        let sent = spectrum.harmonics.iter().enumerate().map(|(m, c)| {
            let twice = if m == 0 { 1.0 } else { 2.0 };
            let (cosine, sine) = (twice * c.re, -twice * c.im);
            let by_work = canon::Harmonic { per_turn: m as u32, cosine, sine };
            let kept = polygon.by_facet(&by_work);
            [m as f64, round(kept.cosine), round(kept.sine)]
        });
        let sent = sent.filter(|[_, cosine, sine]| cosine.abs().max(sine.abs()) > 1e-8).collect();
        let known = learning.response();
        let points = known.points().map(|(hz, gain, delay)| {
            let came = Complex::polar(gain, -delay);
            let m = (hz / self.repeats(polygon).abs().value()).round() as usize;
            let swing = spectrum.harmonics.get(m).map_or(0.0, |c| 2.0 * c.size());
            // what friction may have done is no answer of the loop
            let file = follower.friction.as_ref().and_then(|f| f.explains(hz, came, swing));
            let came = file.unwrap_or(came);
            [round(hz), round(came.size()), round(-came.turn())]
        });
        let response: Vec<[f64; 3]> = points.collect();
        let (on, rpm) = (kept::name(follower.on), self.work.abs().in_rpm());
        let (factor, unit) = match follower.on {
            Oscillating::Axis(_) => (1e3, "µm"),
            Oscillating::ToolPhase => (360.0, "°"),
        };
        let [before, after] =
            [follower.errors.first(), follower.errors.last()].map(|e| e.copied().unwrap_or(0.0));
        let strongest = follower
            .ordered
            .iter()
            .filter(|h| h.per_turn > 0)
            .max_by(|a, b| a.cosine.hypot(a.sine).total_cmp(&b.cosine.hypot(b.sine)));
        let at = strongest.and_then(|h| {
            let hz = f64::from(h.per_turn) * self.repeats(polygon).abs().value();
            Some((hz, learning.response().at(hz)?))
        });
        let answer = at.map_or(String::new(), |(hz, h)| {
            format!("; at {hz:.1} Hz gain {:.4}, {:.2}° late", h.size(), -h.turn() * 360.0)
        });
        self.said.push(format!(
            "{on} at {rpm:.0} rpm, measured in the air {} times{answer}: rms error {:.5} {unit}, now {:.5} {unit}",
            learning.turns(),
            before * factor,
            after * factor
        ));
        self.kept.push(Swung { on, form: kept::mark(&follower.ordered), rpm, sent, response });
    }
}

impl Follower {
    /// The last turns over the work's angle, at the ideal's nodes; `repeats` times a second.
    fn measured(&self, repeats: Spin) -> Result<Vec<f64>, String> {
        let samples = &self.samples;
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err("there are no samples".to_owned());
        };
        let end = last.angle;
        let from = samples.partition_point(|p| (end - p.angle).abs() > LOOK);
        let whole = match self.on {
            Oscillating::Axis(_) => 0.0,
            Oscillating::ToolPhase => first.position.value().round(), // whole turns do not matter
        };
        let mut measured = fold(&samples[from..], self.ideal.len()).map_err(|e| e.to_string())?;
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let off = match self.on {
            // where the axis' base is, is not the oscillation's matter
            Oscillating::Axis(_) => mean(&measured) - mean(&self.ideal),
            Oscillating::ToolPhase => whole,
        };
        for x in &mut measured {
            *x -= off;
        }
        Ok(self.at_the_tool(measured, repeats))
    }

    /// What came at the tool side of what came by the motor less the stretch that the control
    /// believes: the motor is told that stretch, and where it cannot follow it the tool side goes
    /// farther.
    fn at_the_tool(&self, measured: Vec<f64>, repeats: Spin) -> Vec<f64> {
        let Some(slide) = &self.through else { return measured };
        let highest = self.ordered.iter().map(|h| h.per_turn).max().unwrap_or(0) as usize;
        let of = |nodes: &[f64]| Spectrum::of(nodes, highest).harmonics;
        let pairs = of(&measured).into_iter().zip(of(&self.active)).enumerate();
        let change = pairs.map(|(m, (came, sent))| {
            let hz = m as f64 * repeats.abs().value();
            let stretch = slide.stretch(hz) * f64::from(u8::from(m > 0));
            slide.answer(hz) * (came + stretch * sent) - came
        });
        let change = Spectrum { harmonics: change.collect() };
        let values = change.values(measured.len());
        measured.iter().zip(values).map(|(m, c)| m + c).collect()
    }
}

/// Least step that a follower's encoder tells, mm or rev.
fn count(machine: &MachineFile, on: Oscillating, polygon: &Polygon) -> f64 {
    match on {
        Oscillating::Axis(letter) => {
            let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter);
            axis.map_or(0.0, |axis| axis.position_from.resolution().value())
        }
        Oscillating::ToolPhase => {
            let tool = machine.spindles.get(usize::from(polygon.tool));
            tool.map_or(0.0, |tool| 1.0 / f64::from(tool.encoder_counts_per_rev))
        }
    }
}

/// The corrected table, or as much of the correction as the limits allow.
fn within(most: [f64; 3], sent: &[f64], corrected: &[f64], work: Spin) -> Vec<f64> {
    let blend = |share: f64| -> Vec<f64> {
        sent.iter().zip(corrected).map(|(d, u)| d + share * (u - d)).collect()
    };
    let peaks = |nodes: &[f64]| peaks(nodes, work);
    let ordered = peaks(sent);
    let room: [f64; 3] = [0, 1, 2].map(|i| most[i].max(ordered[i]) * (1.0 + 1e-9));
    let fits = |nodes: &[f64]| peaks(nodes).iter().zip(room).all(|(peak, most)| *peak <= most);
    let whole = blend(1.0);
    if fits(&whole) {
        return whole;
    }
    let (mut good, mut bad) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(good, bad);
        if fits(&blend(middle)) { good = middle } else { bad = middle }
    }
    blend(good)
}

/// Largest speed, acceleration and jerk of a table at a speed of its master.
pub fn peaks(nodes: &[f64], work: Spin) -> [f64; 3] {
    let Ok(table) = Periodic::new(nodes) else { return [0.0; 3] };
    let (count, w) = (nodes.len() * 2, work.abs().value());
    let mut peaks = [0.0_f64; 3];
    for i in 0..count {
        let at = table.at(i as f64 / count as f64);
        let now = [at.slope * w, at.bend * w * w, at.jolt * w * w * w];
        for (peak, now) in peaks.iter_mut().zip(now) {
            *peak = peak.max(now.abs());
        }
    }
    peaks
}
