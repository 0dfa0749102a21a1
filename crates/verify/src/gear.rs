//! A hobbed gear: what the hob generated, from recorded motion.
//!
//! Each time the hob has turned by one of its threads, a tooth stands right. Where the work stood
//! at that instant says where that tooth's flank is in the work, at the height at which the hob
//! stood:
//!
//! ```text
//!   n = |s|·θ_hob whole:   tooth n mod z,  flank at   φ = ±n/z − θ_work   turns, at the hob's height
//!
//!     φ │      ╱ slope 1/lead            pitch deviation     φ of neighbouring teeth at one height, less 1/z
//!       │    ╱                           total               largest less smallest of all teeth at that height
//!       │  ╱  tooth k                    helix deviation     slope of a tooth over the face, less the ordered
//!       └────────── height
//! ```
//!
//! Angles count as arcs on the pitch circle, d = m·z/cos β. What is judged is the generating
//! motion: the hob's own form, its run-out and the feed marks of its edges are not. Grades and
//! tolerances by ISO 1328-1:2013, 5.3: `f_pT` = (0.001 d + 0.4 m + 5)·√2^(A−5), `F_pT` = (0.002
//! d + 0.55 √d + 0.7 m + 12)·√2^(A−5), `f_HβT` = (0.05 √d + 0.35 √b + 4)·√2^(A−5), µm.
use crate::Config;
use crate::contact::{Contact, shifted, unknown};
use crate::judged::Judged;
use crate::verdict::Verdict;
use bus::{Sample, State};
use canon::{Hob, OpKind, Tool};
use core::f64::consts::PI;
use units::{Angle, Length, Spin, Time};

/// Sections along the face at which the pitch is measured.
const SECTIONS: usize = 5;
/// The grade that is asked.
const GRADE_ASKED: u8 = 7;
/// The coarsest grade there is.
const COARSEST: u8 = 11;
/// The hob cuts to depth where it is within this of its least distance.
const AT_DEPTH_MM: f64 = 0.02;
/// Of the basic rack (ISO 53).
const PRESSURE_ANGLE: Angle = Angle::deg(20.0);
/// Passes that are kept.
const MOST_PASSES: usize = 1 << 20;

/// A gear as it was hobbed.
#[derive(Clone, Debug, PartialEq)]
pub struct Gear {
    /// Teeth that were generated.
    pub teeth: u32,
    /// Module in the normal section.
    pub module: Length,
    /// Helix angle ordered; positive: right hand.
    pub helix: Angle,
    /// Travel along Z in which a tooth winds once around, as cut; `None` of straight teeth.
    pub lead: Option<Length>,
    /// The same, as ordered.
    pub lead_ordered: Option<Length>,
    /// Largest step between neighbouring teeth less the mean one.
    pub pitch_deviation: Length,
    /// Largest deviation of a tooth's place less the smallest, at one height.
    pub pitch_total: Length,
    /// Largest deviation of a tooth's slope over the face from the ordered one.
    pub helix_deviation: Length,
    /// Grade of ISO 1328-1 that all three are within; `None`: beyond the coarsest.
    pub grade: Option<u8>,
    /// What the grade asked allows of single pitch, total pitch and helix slope.
    pub allowed: [Length; 3],
    /// Machine coordinate of the hob where the face begins.
    pub z_from: Length,
    /// Where it ends.
    pub z_to: Length,
    /// How much deeper than ordered the hob stood where it was worst; negative: not deep enough.
    pub depth_error: Length,
    /// Of the work, mean over the cut.
    pub spin: Spin,
    /// Deviation of each tooth's place at the middle of the face.
    pub places: Vec<Length>,
}

impl Gear {
    /// Such as "gear 40 × 2".
    pub fn name(&self) -> String {
        format!("gear {} × {}", self.teeth, self.module.value())
    }
}

/// What the program ordered.
#[derive(Clone, Debug)]
pub(crate) struct OrderedGear {
    pub(crate) hob: Hob,
    /// Least distance of the axes, machine coordinate.
    pub(crate) least_x: Option<Length>,
}

impl OrderedGear {
    /// An operation while it is geared: how close does the hob come?
    pub(crate) fn see(&mut self, kind: &OpKind) {
        if let OpKind::Line { to, .. } | OpKind::Arc { to, .. } | OpKind::Spline { to, .. } = kind {
            let x = to.linear[0];
            self.least_x = Some(self.least_x.map_or(x, |least| least.min(x)));
        }
    }
}

/// A tooth that has just been generated.
#[derive(Clone, Copy, Debug)]
struct Pass {
    tooth: usize,
    x: f64,
    z: f64,
    time: Time,
    work: f64,
    /// Turns, with the whole turns taken off.
    flank: f64,
}

/// Follows hob and work.
#[derive(Clone, Debug)]
pub(crate) struct GearTrack {
    hob: Hob,
    tool_length: f64,
    /// Of the hob, mm.
    radius: f64,
    /// Angles of hob and work and the hob's height, one period ago.
    before: Option<[f64; 3]>,
    passes: Vec<Pass>,
    faulted: bool,
}

impl GearTrack {
    pub(crate) fn new(ordered: &OrderedGear, tool: Option<&Tool>) -> Self {
        Self {
            hob: ordered.hob,
            tool_length: tool.map_or(0.0, |t| t.worn_length().value()),
            radius: tool.map_or(0.0, |t| t.diameter.value() / 2.0),
            before: None,
            passes: Vec::new(),
            faulted: false,
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        self.faulted |= matches!(sample.report.state, State::Faulted);
        let x = sample.axis(0).value();
        let z = sample.axis(2).value() - self.tool_length;
        let hob = sample.spindle(usize::from(self.hob.hob)).value();
        let work = sample.spindle(usize::from(self.hob.work)).value();
        let now = [hob, work, z];
        if let Some(before) = self.before.replace(now).filter(|_| !self.faulted) {
            self.between(before, now, x, sample.feedback.time);
        }
    }

    /// Teeth that were generated between two records.
    fn between(&mut self, before: [f64; 3], now: [f64; 3], x: f64, time: Time) {
        let threads = f64::from(self.hob.starts.unsigned_abs());
        let sense = f64::from(self.hob.starts.signum());
        let teeth = f64::from(self.hob.teeth);
        let (a, b) = (before[0] * threads, now[0] * threads);
        let mut n = a.min(b).ceil();
        while n < a.max(b) && self.passes.len() < MOST_PASSES {
            let part = (n - a) / (b - a);
            let at = |i: usize| before[i] + part * (now[i] - before[i]);
            let flank = sense * (n / teeth).fract() - at(1).fract();
            let tooth = n.rem_euclid(teeth) as usize;
            let flank = flank - flank.round();
            self.passes.push(Pass { tooth, x, z: at(2), time, work: at(1), flank });
            n += 1.0;
        }
    }

    pub(crate) fn finish(
        self,
        (op, line, tool): (u32, u32, Option<u32>),
        ordered: &OrderedGear,
        config: &Config,
        now: Time,
    ) -> Judged<Gear> {
        let contact = self.contact(config);
        let passes = self.of_the_face(ordered, config);
        let ends = passes.as_ref().and_then(|all| all.first().zip(all.last()));
        let (time, duration, spin) = ends.map_or((now, Time::ZERO, Spin::ZERO), |(a, b)| {
            let duration = b.time - a.time;
            (a.time, duration, Angle::rev((b.work - a.work).abs()) / duration)
        });
        let mut findings = Vec::new();
        if self.faulted {
            findings.push("the machine stopped while the work was geared to the hob".to_owned());
        }
        if let Some(stock) = config.stock.as_ref().filter(|_| self.hob.own_zero.is_none()) {
            let [x, y, z] = self.hob.zero.linear;
            let zero = [x, y, z - Length::mm(self.tool_length)];
            findings.extend(shifted(zero, stock, config.tolerances.position));
        }
        let mut gear = self.empty(spin);
        if let Some(passes) = passes {
            measure(&mut gear, &self.hob, &passes, &mut findings);
            self.depth(&mut gear, &passes, ordered, config, &mut findings);
        } else if contact.reach.is_some_and(|reach| reach <= Length::ZERO) {
            findings.push("not cut: the hob never touched the blank".to_owned());
        } else {
            findings.push("the hob never cut the stock to its depth".to_owned());
        }
        Judged {
            op,
            line,
            tool,
            time,
            duration,
            verdict: Verdict::unless(&findings, unknown(config.stock.as_ref())),
            contact,
            kind: gear,
        }
    }

    const fn empty(&self, spin: Spin) -> Gear {
        Gear {
            teeth: self.hob.teeth,
            module: self.hob.module,
            helix: self.hob.helix,
            lead: None,
            lead_ordered: None,
            pitch_deviation: Length::ZERO,
            pitch_total: Length::ZERO,
            helix_deviation: Length::ZERO,
            grade: None,
            allowed: [Length::ZERO; 3],
            z_from: Length::ZERO,
            z_to: Length::ZERO,
            depth_error: Length::ZERO,
            spin,
            places: Vec::new(),
        }
    }

    /// How far the hob's teeth went into the blank; what hobbing takes is not simulated.
    fn contact(&self, config: &Config) -> Contact {
        let reach = |radius: Length| {
            let axis = config.work_axis[0].value();
            let edges = self.passes.iter().filter(|p| within(config, p.z)).map(|p| p.x - axis);
            let least = edges.fold(f64::INFINITY, f64::min) - self.radius;
            Length::mm((radius.value() - least).max(0.0))
        };
        let known = config.stock_radius.filter(|_| config.stock.is_some());
        Contact { reach: known.map(reach), ..Contact::default() }
    }

    /// How deep the teeth are, against the distance of the axes that was ordered: each tooth is
    /// thinner by 2·Δ·tan 20°.
    fn depth(
        &self,
        gear: &mut Gear,
        passes: &[Pass],
        ordered: &OrderedGear,
        config: &Config,
        findings: &mut Vec<String>,
    ) {
        let Some(least_x) = ordered.least_x else { return };
        let asked = (least_x - self.hob.zero.linear[0]).value();
        let axis = config.work_axis[0].value();
        let too_deep = passes.iter().map(|p| asked - (p.x - axis));
        let worst = too_deep.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        gear.depth_error = Length::mm(worst);
        let thinner = 2.0 * worst * PRESSURE_ANGLE.in_rad().tan();
        let allowed = config.tolerances.tooth_thickness.value();
        if thinner.abs() > allowed {
            let (word, than) =
                if worst > 0.0 { ("deep", "thinner") } else { ("shallow", "thicker") };
            findings.push(format!(
                "the teeth are cut {:.3} mm too {word}: {:.0} µm {than} than ordered, {:.0} µm allowed",
                worst.abs(),
                thinner.abs() * 1e3,
                allowed * 1e3
            ));
        }
    }

    /// The passes within the stock, if there are enough of each tooth.
    fn of_the_face(&self, ordered: &OrderedGear, config: &Config) -> Option<Vec<Pass>> {
        let deep = ordered.least_x?.value() + AT_DEPTH_MM;
        let cuts = |p: &&Pass| within(config, p.z) && p.x <= deep;
        let inside: Vec<Pass> = self.passes.iter().filter(cuts).copied().collect();
        let teeth = self.hob.teeth as usize;
        let each = |tooth: usize| inside.iter().filter(|p| p.tooth == tooth).count() >= 3;
        (inside.len() >= 3 * teeth && (0..teeth).all(each)).then_some(inside)
    }
}

/// Between the faces of the stock.
fn within(config: &Config, z: f64) -> bool {
    config.stock.is_none_or(|stock| (stock.from[2].value()..=stock.to[2].value()).contains(&z))
}

/// Everything about the gear that the passes say.
fn measure(gear: &mut Gear, hob: &Hob, passes: &[Pass], findings: &mut Vec<String>) {
    let teeth = hob.teeth as usize;
    let (m, z) = (hob.module.value(), f64::from(hob.teeth));
    let d = m * z / hob.helix.in_rad().cos();
    // turns a mm of height, from the helix angle alone
    let twist = hob.helix.in_rad().sin() / (PI * m * z);
    let low = passes.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let high = passes.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let face = high - low;
    (gear.z_from, gear.z_to) = (Length::mm(low), Length::mm(high));
    // what is left beside the ordered helix, wrapped about its first pass: µm on the pitch circle
    let um = PI * d * 1e3;
    let left = |p: &Pass| p.flank - twist * (p.z - low);
    let origin = passes.first().map_or(0.0, left);
    let off = |p: &Pass| {
        let turns = left(p) - origin;
        (turns - turns.round()) * um
    };
    let by_tooth: Vec<Vec<[f64; 2]>> = (0..teeth)
        .map(|k| passes.iter().filter(|p| p.tooth == k).map(|p| [p.z, off(p)]).collect())
        .collect();
    let slopes: Vec<f64> = by_tooth.iter().map(|points| slope(points)).collect();
    let helix = slopes.iter().map(|s| (s * face).abs()).fold(0.0, f64::max);
    let (mut single, mut total) = (0.0_f64, 0.0_f64);
    for section in 0..SECTIONS {
        let at = low + face * (section as f64 + 0.5) / SECTIONS as f64;
        let places: Vec<f64> = by_tooth.iter().map(|points| place(points, at)).collect();
        for k in 0..teeth {
            single = single.max((places[(k + 1) % teeth] - places[k]).abs());
        }
        let [least, most] = [f64::min, f64::max].map(|of| places.iter().copied().reduce(of));
        total = total.max(most.unwrap_or(0.0) - least.unwrap_or(0.0));
        if section == SECTIONS / 2 {
            gear.places = places.iter().map(|um| Length::um(*um)).collect();
        }
    }
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let cut = twist + mean / um;
    let lead = |per_mm: f64| (per_mm.abs() > 1e-9).then(|| Length::mm(1.0 / per_mm));
    if twist != 0.0 {
        (gear.lead, gear.lead_ordered) = (lead(cut), lead(twist));
    }
    gear.pitch_deviation = Length::um(single);
    gear.pitch_total = Length::um(total);
    gear.helix_deviation = Length::um(helix);
    let found = [single, total, helix];
    let within = |grade: u8| {
        tolerances(d, m, face, grade).iter().zip(found).all(|(most, found)| found <= *most)
    };
    gear.grade = (1..=COARSEST).find(|grade| within(*grade));
    let asked = tolerances(d, m, face, GRADE_ASKED);
    gear.allowed = asked.map(Length::um);
    for ((name, found), most) in
        ["single pitch", "total pitch", "helix slope"].into_iter().zip(found).zip(asked)
    {
        if found > most {
            findings.push(format!(
                "{name} deviation {found:.1} µm, grade {GRADE_ASKED} allows {most:.1} µm"
            ));
        }
    }
}

/// Single pitch, total pitch, helix slope: µm, for mm.
fn tolerances(d: f64, m: f64, face: f64, grade: u8) -> [f64; 3] {
    let step = core::f64::consts::SQRT_2.powi(i32::from(grade) - 5);
    [
        (0.001 * d + 0.4 * m + 5.0) * step,
        (0.002 * d + 0.55 * d.sqrt() + 0.7 * m + 12.0) * step,
        (0.05 * d.sqrt() + 0.35 * face.sqrt() + 4.0) * step,
    ]
}

/// Of the least-squares line.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let top: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let bottom: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    if bottom > 0.0 { top / bottom } else { 0.0 }
}

/// Where a tooth stands at a height, between the passes below and above it.
fn place(points: &[[f64; 2]], at: f64) -> f64 {
    let nearest = |above: bool| {
        let side = points.iter().filter(|p| (p[0] >= at) == above);
        side.min_by(|a, b| (a[0] - at).abs().total_cmp(&(b[0] - at).abs()))
    };
    match (nearest(false), nearest(true)) {
        (Some(a), Some(b)) if b[0] > a[0] => a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0]),
        (Some(one), _) | (None, Some(one)) => one[1],
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_those_of_the_standards_table() {
        // ISO 1328-1, grade 5, d = 50, m = 2, b = 20: by hand
        let [single, total, helix] = tolerances(50.0, 2.0, 20.0, 5);
        assert!((single - 5.85).abs() < 1e-9);
        assert!((total - 17.389).abs() < 1e-3, "{total}");
        assert!((helix - 5.9188).abs() < 1e-3, "{helix}");
        // two grades coarser: twice as wide
        assert!((tolerances(50.0, 2.0, 20.0, 7)[0] - 2.0 * single).abs() < 1e-9);
    }
}
