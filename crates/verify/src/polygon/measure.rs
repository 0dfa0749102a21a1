//! From passes to a judged polygon.
use super::ordered::{Normals, OrderedPolygon, can_be_judged, rad};
use super::passes::{Pass, PassSetUp, Passes};
use super::section::{Cutters, measure, nose_height, surface};
use super::{Along, Facet, Polygon, Section};
use crate::Config;
use crate::contact::{Contact, shifted, unknown};
use crate::judged::Judged;
use crate::verdict::Verdict;
use bus::{Sample, State};
use canon::{PolygonCutter, Tool, ToolKind};
use core::f64::consts::TAU;
use units::{Angle, Length, Spin, Time};

/// Cross-sections of a part.
const SECTIONS: u32 = 9;

/// How a stop in the cut went, from the first record after it.
#[derive(Clone, Copy, Debug)]
struct Stop {
    /// The tool spindle ahead of its gear, turns.
    off: f64,
    x: f64,
    /// Turns a period of the work.
    pace: f64,
    /// How far X had left when the work fell below half its pace.
    left: Option<f64>,
}

impl Stop {
    fn sentence(&self, stock_left: f64) -> String {
        let off = format!("{:.1}° off its gear", self.off.abs() * 360.0);
        match self.left {
            Some(left) if left >= stock_left => format!(
                "the tool spindle was {off} when the machine stopped in the cut; the tool left the work by {left:.1} mm along X before the spindles stopped"
            ),
            _ => format!(
                "the machine stopped while the cutter was geared to the work, the tool spindle {off}"
            ),
        }
    }
}

/// Follows the cutter.
#[derive(Clone, Debug)]
pub(crate) struct PolygonTrack {
    tool: Option<(u32, PolygonCutter)>,
    passes: Option<Passes>,
    first: Option<(Time, f64)>,
    last: (Time, f64),
    faulted: bool,
    stop: Option<Stop>,
    /// Turns of the work one record ago.
    before: f64,
    gear: (f64, f64),
    place: PassSetUp,
}

impl PolygonTrack {
    pub(crate) fn new(
        ordered: &OrderedPolygon,
        number: Option<u32>,
        tool: Option<&Tool>,
        config: &Config,
    ) -> Self {
        let place = PassSetUp {
            axis: config.work_axis.map(Length::value),
            stock_radius: config.stock_radius.map_or(f64::INFINITY, Length::value),
            stock_top: config.stock.map_or(f64::INFINITY, |stock| stock.top().value()),
            stock_bottom: config.stock.map_or(f64::NEG_INFINITY, |stock| stock.from[2].value()),
            zero: config.stock.map_or_else(
                || {
                    ordered.polygon.zero.linear[2].value()
                        - tool.map_or(0.0, |t| t.worn_length().value())
                },
                |stock| ordered.polygon.own_zero.map_or(stock.zero[2], |own| own.linear[2]).value(),
            ),
            tool_length: tool.map_or(0.0, |t| t.worn_length().value()),
            spindles: [usize::from(ordered.polygon.work), usize::from(ordered.polygon.tool)],
        };
        let cutter = tool.and_then(|tool| match &tool.kind {
            ToolKind::PolygonCutter(cutter) => Some(cutter.clone()),
            _ => None,
        });
        Self {
            passes: cutter.as_ref().map(|cutter| Passes::new(cutter, place)),
            tool: number.zip(cutter),
            first: None,
            last: (Time::ZERO, 0.0),
            faulted: false,
            stop: None,
            before: 0.0,
            gear: (ordered.polygon.ratio.value(), ordered.polygon.phase.value()),
            place,
        }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let now = (sample.feedback.time, sample.spindle(self.place.spindles[0]).value());
        self.first.get_or_insert(now);
        self.last = now;
        self.faulted |= matches!(sample.report.state, State::Faulted);
        let pace = (now.1 - self.before).abs();
        self.before = now.1;
        if self.faulted {
            self.stopping(sample, now.1, pace);
        }
        if let Some(passes) = &mut self.passes {
            passes.sample(sample);
        }
    }

    /// What X and the spindles do after a stop.
    fn stopping(&mut self, sample: &Sample, work: f64, pace: f64) {
        let tool = sample.spindle(self.place.spindles[1]).value();
        let (ratio, phase) = self.gear;
        let off = tool - ratio * work - phase;
        let x = sample.axis(0).value();
        let stop = self.stop.get_or_insert(Stop { off: off - off.round(), x, pace, left: None });
        if stop.left.is_none() && pace < 0.5 * stop.pace {
            stop.left = Some(x - stop.x);
        }
    }

    pub(crate) fn finish(
        self,
        op: u32,
        line: u32,
        ordered: &OrderedPolygon,
        config: &Config,
        now: Time,
    ) -> Judged<Polygon> {
        let (time, turned) = self.first.unwrap_or((now, 0.0));
        let duration = self.last.0 - time;
        let spin = if duration > Time::ZERO {
            Angle::rev((self.last.1 - turned).abs()) / duration
        } else {
            Spin::ZERO
        };
        let number = self.tool.as_ref().map(|(number, _)| *number);
        let mut findings = Vec::new();
        if let Some(stock) = config.stock.as_ref().filter(|_| ordered.polygon.own_zero.is_none()) {
            let [x, y, z] = ordered.polygon.zero.linear;
            let zero = [x, y, z - Length::mm(self.place.tool_length)];
            findings.extend(shifted(zero, stock, config.tolerances.position));
        }
        let known = config.stock_radius.filter(|_| config.stock.is_some());
        let mut contact = Contact { reach: known.map(|_| Length::ZERO), ..Contact::default() };
        let polygon = if let (Some((_, cutter)), Some(passes)) = (self.tool, self.passes) {
            let part = Part { cutter, passes: passes.finish(), place: self.place, ordered };
            contact.reach = known.map(|radius| part.reach(radius));
            part.judge(spin, self.stop, config, &mut findings)
        } else {
            findings.push("no polygon cutter was in the tool spindle".to_owned());
            empty(spin, self.faulted)
        };
        Judged {
            op,
            line,
            tool: number,
            time,
            duration,
            verdict: Verdict::unless(&findings, unknown(config.stock.as_ref())),
            contact,
            kind: polygon,
        }
    }
}

fn empty(spin: Spin, broken_off: bool) -> Polygon {
    Polygon {
        sides: 0,
        across_flats: Length::ZERO,
        across_flats_ordered: Length::ZERO,
        flatness: Length::ZERO,
        tilt: Angle::ZERO,
        corner_angle: Angle::ZERO,
        facet_difference: Length::ZERO,
        lay: Length::ZERO,
        along: Along::default(),
        along_ordered: Along::default(),
        z_from: Length::ZERO,
        z_to: Length::ZERO,
        spin,
        sections: Vec::new(),
        broken_off,
    }
}

/// A part that was cut.
struct Part<'o> {
    cutter: PolygonCutter,
    passes: Vec<Pass>,
    place: PassSetUp,
    ordered: &'o OrderedPolygon,
}

impl Part<'_> {
    fn judge(
        &self,
        spin: Spin,
        stop: Option<Stop>,
        config: &Config,
        findings: &mut Vec<String>,
    ) -> Polygon {
        let mut polygon = empty(spin, stop.is_some());
        let inserts: Vec<f64> = self.cutter.inserts.iter().map(|a| a.value()).collect();
        let normals = self.ordered.normals(&inserts);
        polygon.sides = normals.at_zero.len() as u32;
        if let Some(stop) = stop {
            // a corner stands so much farther out than a flat
            let flat = self.ordered.least_x().map_or(0.0, |x| self.flat(x));
            findings.push(stop.sentence(self.place.stock_radius - flat));
        }
        if !can_be_judged(&normals) {
            findings.push(format!(
                "{} different facets are ordered, and no gear of a few turns is near about which they would wind: that is not judged",
                normals.at_zero.len()
            ));
            return polygon;
        }
        let Some([low, high]) = self.heights() else {
            findings.push("not cut: the cutter never touched the stock".to_owned());
            return polygon;
        };
        (polygon.z_from, polygon.z_to) = (Length::mm(low), Length::mm(high));
        let margin = (0.5 * (high - low)).min(0.5);
        let at = |i: u32| {
            high - margin - (high - low - 2.0 * margin) * f64::from(i) / f64::from(SECTIONS - 1)
        };
        let nose = self.cutter.nose_radius.value();
        for z in (0..SECTIONS).map(at) {
            let facets = self.cutters(&normals, z);
            if let Some(section) = measure(z, &facets, nose, self.place.stock_radius) {
                polygon.sections.push(section);
            } else {
                let below = self.place.stock_top - z;
                findings.push(format!("{below:.1} mm below the face not every facet was cut"));
                break;
            }
        }
        if !polygon.sections.is_empty() {
            self.measure(&mut polygon, &normals);
            let ordered: Vec<f64> =
                polygon.sections.iter().map(|s| self.across_flats_at(s)).collect();
            judge_sizes(&polygon, &ordered, config, findings);
        }
        polygon
    }

    /// Where the stock was cut, tip's machine coordinate: lowest and highest.
    fn heights(&self) -> Option<[f64; 2]> {
        let low = self.passes.iter().map(Pass::z).fold(f64::INFINITY, f64::min);
        let high = self.passes.iter().map(Pass::z).fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = (low.max(self.place.stock_bottom), high.min(self.place.stock_top));
        (low < high).then_some([low, high])
    }

    /// The passes that reached a height, by facet.
    fn cutters(&self, normals: &Normals, z: f64) -> Vec<Cutters<'_>> {
        let nose = self.cutter.nose_radius.value();
        let mut all: Vec<Cutters<'_>> = (0..normals.at_zero.len())
            .map(|_| Cutters { normal_rad: 0.0, passes: Vec::new() })
            .collect();
        let mut nearest: Option<&Pass> = None;
        for pass in &self.passes {
            if nose_height(nose, z - pass.z()).is_none() {
                continue;
            }
            let nearer = |p: &&Pass| (pass.z() - z).abs() < (p.z() - z).abs();
            if nearest.as_ref().is_none_or(nearer) {
                nearest = Some(pass);
            }
            if let Some(facet) = normals.nearest(pass.turn) {
                all[facet].passes.push(pass);
            }
        }
        // facets that wind stand as they do when the tool is at this height
        let turn = nearest.map_or(0.0, |pass| pass.turn);
        for (facet, cutters) in all.iter_mut().enumerate() {
            cutters.normal_rad = rad(normals.of(facet, turn));
        }
        all
    }

    /// Distance of a facet from the axis that is ordered by this machine X: the program's zero is
    /// where the program has the work's axis.
    fn flat(&self, x: f64) -> f64 {
        x - self.ordered.polygon.zero.linear[0].value() - self.cutter.radius.value()
    }

    /// How far the inserts went into the bar; what turning polygons takes is not simulated.
    fn reach(&self, radius: Length) -> Length {
        let least = self.passes.iter().map(Pass::closest_mm).fold(f64::INFINITY, f64::min);
        Length::mm((radius.value() - least).max(0.0))
    }

    /// What was ordered at the height of a section: size across flats.
    fn across_flats_at(&self, section: &Section) -> f64 {
        let above_zero = section.z.value() - self.place.zero;
        let x = self.ordered.x_at(self.ordered.polygon.zero.linear[2].value() + above_zero);
        x.map_or(0.0, |x| 2.0 * self.flat(x))
    }

    fn measure(&self, polygon: &mut Polygon, normals: &Normals) {
        let facets = || polygon.sections.iter().flat_map(|s| &s.facets);
        let flatness = facets().map(|f| f.flatness).fold(Length::ZERO, Length::max);
        let tilt =
            facets().map(|f| f.tilt).max_by(|a, b| a.abs().value().total_cmp(&b.abs().value()));
        let count = polygon.sections.len() as f64;
        let mean =
            |of: &dyn Fn(&Section) -> f64| polygon.sections.iter().map(of).sum::<f64>() / count;
        let across = mean(&across_flats);
        let ordered = mean(&|s| self.across_flats_at(s));
        let corner = mean(&corner_angle);
        let difference = polygon.sections.iter().map(spread).fold(0.0, f64::max);
        let sections = &polygon.sections;
        let (cut, asked) =
            (Along::cut(sections, &across_flats), &|s: &Section| self.across_flats_at(s));
        (polygon.along, polygon.along_ordered) = (cut, Along::ordered(sections, asked));
        polygon.flatness = flatness;
        polygon.tilt = tilt.unwrap_or(Angle::ZERO);
        polygon.across_flats = Length::mm(across);
        polygon.across_flats_ordered = Length::mm(ordered);
        polygon.facet_difference = Length::mm(difference);
        polygon.corner_angle = Angle::rev(corner / TAU);
        polygon.lay = Length::mm(self.lay(normals, polygon));
    }

    /// Peak to valley along Z in the middle of the first facet, over a millimetre in the middle of
    /// the part.
    fn lay(&self, normals: &Normals, polygon: &Polygon) -> f64 {
        let middle = f64::midpoint(polygon.z_from.value(), polygon.z_to.value());
        let span = (polygon.z_to - polygon.z_from).value().min(1.0) / 2.0;
        let nose = self.cutter.nose_radius.value();
        let facets = self.cutters(normals, middle);
        let Some(first) = facets.into_iter().next() else { return 0.0 };
        // each pass alone at its own height: where it stands and how far in
        let marks: Vec<[f64; 2]> = first
            .passes
            .iter()
            .filter_map(|pass| {
                let alone = Cutters { normal_rad: first.normal_rad, passes: vec![*pass] };
                let n = *surface(&alone, pass.z(), nose, &[0.0]).first()?;
                (!n.is_nan()).then(|| [pass.z(), n])
            })
            .collect();
        let ends = marks.iter().map(|m| (m[0] - middle).abs()).fold(0.0, f64::max);
        let span = span.min(0.7 * ends); // the outermost marks have no neighbour beyond them
        let heights = (-1000..=1000).filter_map(|i| {
            let z = middle + span * f64::from(i) / 1000.0;
            let above = marks.iter().filter_map(|m| Some(m[1] + nose_height(nose, z - m[0])?));
            above.min_by(f64::total_cmp)
        });
        let (low, high) = heights
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        (high - low).max(0.0)
    }
}

/// Mean over opposite pairs, which is twice the mean over all; what has no opposite is stated
/// likewise.
fn across_flats(section: &Section) -> f64 {
    let distance = |f: &Facet| f.distance.value();
    2.0 * section.facets.iter().map(distance).sum::<f64>() / section.facets.len() as f64
}

fn spread(section: &Section) -> f64 {
    let all = || section.facets.iter().map(|f| f.distance.value());
    all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
}

/// Inner angle between neighbours, rad: of a regular polygon the mean of all, else of the sharpest.
fn corner_angle(section: &Section) -> f64 {
    let stands = |f: &Facet| f.normal.in_rad() + f.tilt.in_rad();
    let count = section.facets.len();
    let angles = (0..count).map(|k| {
        let turn = stands(&section.facets[(k + 1) % count]) - stands(&section.facets[k]);
        TAU / 2.0 - turn.rem_euclid(TAU)
    });
    let angles: Vec<f64> = angles.collect();
    let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let alike: Vec<f64> = angles.into_iter().filter(|a| a - least < 0.02).collect();
    alike.iter().sum::<f64>() / alike.len() as f64
}

fn judge_sizes(polygon: &Polygon, ordered: &[f64], config: &Config, findings: &mut Vec<String>) {
    let tolerances = &config.tolerances;
    let allowed = tolerances.facet_flatness;
    if polygon.flatness > allowed {
        findings.push(format!(
            "the facets are flat to {:.1} µm only, {:.0} µm allowed",
            polygon.flatness.in_um(),
            allowed.in_um()
        ));
    }
    if polygon.tilt.abs() > tolerances.facet_tilt {
        findings.push(format!(
            "a facet is tilted by {:.3}°, {:.2}° allowed",
            polygon.tilt.in_deg(),
            tolerances.facet_tilt.in_deg()
        ));
    }
    let off = |(section, ordered): (&Section, &f64)| (across_flats(section) - ordered, *ordered);
    let worst = polygon.sections.iter().zip(ordered).map(off);
    let worst = worst.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    if let Some((off, ordered)) =
        worst.filter(|(off, _)| off.abs() > tolerances.across_flats.value())
    {
        findings.push(format!(
            "{:.3} mm across flats instead of {ordered:.3} mm, {:.0} µm allowed",
            ordered + off,
            tolerances.across_flats.in_um()
        ));
    }
}
