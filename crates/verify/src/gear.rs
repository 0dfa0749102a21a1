//! A hobbed gear: what the hob in the spindle generated, from recorded motion.
//!
//! ```text
//!   record ─► track     a pass each time the hob has turned by one of its threads
//!             again     those of a gear that is hobbed again belong to it; other teeth destroy it
//!             measure   the deepest passes: pitch, helix, profile (ISO 1328-1)
//!             size      span, balls, root and tip against the drawing, by the real distance of the axes
//! ```
//!
//! The hob is the one in the spindle, as the tool table has it: module, threads, hand, diameter,
//! addendum, pressure angle. What is judged is the generating motion and the size; the hob's own
//! form and its run-out are not, and the marks of its feed are given and not judged. Angles count
//! as arcs on the pitch circle, d = m·z/cos β.
use crate::Config;
use crate::contact::{Contact, shifted, unknown};
use crate::judged::Judged;
use crate::verdict::Verdict;
use bus::Sample;
use canon::{Hob, HobTool, Tool, ToolKind};
use core::f64::consts::PI;
use units::{Angle, Length, Spin, Time};

mod again;
mod crossed;
mod measure;
mod size;
mod tooth;
mod track;

pub(crate) use again::{Cuts, Earlier};
pub use size::ToothSize;

use again::CutGear;
use crossed::Teeth;
use size::Rack;
use track::{Pass, PassTrack};

/// The grade that is asked where the drawing asks none.
const GRADE_ASKED: u8 = 7;
/// Passes that each tooth needs so that its helix and pitch can be measured.
const LEAST_PASSES: usize = 3;
/// A hob may move so far along its own axis while it cuts, mm.
const ALONG_Y_MM: f64 = 0.02;
/// The toothed face may be shorter than asked by this, mm, besides a tooth's share of the feed.
const SHORT_MM: f64 = 0.1;

/// A gear as it was hobbed.
#[derive(Clone, Debug, PartialEq)]
pub struct Gear {
    /// Teeth that were ordered.
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
    /// Total deviation of the worst profile, along the normal of the flank.
    pub profile_deviation: Length,
    /// Slope of that profile.
    pub profile_slope: Length,
    /// What is left of it beside the slope.
    pub profile_form: Length,
    /// Depth of the marks that the feed along the face leaves on the flanks.
    pub feed_mark: Length,
    /// Grade of ISO 1328-1 that all four are within; `None`: beyond the coarsest.
    pub grade: Option<u8>,
    /// What the grade asked allows of single pitch, total pitch, helix slope and profile.
    pub allowed: [Length; 4],
    /// Machine coordinate of the hob where the face begins.
    pub z_from: Length,
    /// Where it ends.
    pub z_to: Length,
    /// Size of the teeth; `None`: the hob is not known, or cut nothing.
    pub size: Option<ToothSize>,
    /// Spin of the work, mean over the cut.
    pub spin: Spin,
    /// Deviation of each tooth's place at the middle of the face.
    pub places: Vec<Length>,
}

impl Gear {
    /// Such as "gear 40 × 2".
    pub fn name(&self) -> String {
        format!("gear {} × {}", self.teeth, canon::number(self.module.value()))
    }

    /// How much deeper than asked the hob stood where it was worst; negative: not deep enough.
    pub fn depth_error(&self) -> Option<Length> {
        self.size.map(|size| size.distance_asked - size.distance)
    }
}

/// The rack that generates the teeth, and the blank.
#[derive(Clone, Copy, Debug)]
struct Generator {
    /// Of hob and work.
    spindles: [usize; 2],
    /// Of the hob, 1 or −1 where the work turns against it.
    threads: f64,
    sense: f64,
    teeth: u32,
    module: f64,
    helix_deg: f64,
    /// Turns a mm of height, from the helix angle alone.
    twist: f64,
    pitch_diameter: f64,
    transverse_rad: f64,
    tool_length: f64,
    /// From the hob's axis to its crest, mm.
    radius: f64,
    blank_radius: Option<f64>,
    /// Lower and upper face of the blank.
    faces: Option<[f64; 2]>,
}

impl Generator {
    fn new(hob: &Hob, tool: Option<&Tool>, config: &Config) -> Self {
        let tooth = size::asked(hob);
        let blank = Blank::of(config);
        let worn = |tool: &Tool| tool.diameter / 2.0 + tool.wear.radius;
        Self {
            spindles: [usize::from(hob.hob), usize::from(hob.work)],
            threads: f64::from(hob.starts.unsigned_abs()),
            sense: f64::from(hob.starts.signum()),
            teeth: hob.teeth,
            module: tooth.module_mm,
            helix_deg: hob.helix.in_deg(),
            twist: tooth.helix_rad.sin() / (PI * tooth.module_mm * tooth.teeth),
            pitch_diameter: tooth.reference_diameter(),
            transverse_rad: (tooth.pressure_rad.tan() / tooth.helix_rad.cos()).atan(),
            tool_length: tool.map_or(0.0, |t| t.worn_length().value()),
            radius: tool.map_or(0.0, |t| worn(t).value()),
            blank_radius: blank.radius,
            faces: blank.faces,
        }
    }

    /// The hob reaches into the blank at this distance of the axes.
    fn reaches(&self, distance: f64) -> bool {
        self.blank_radius.is_none_or(|radius| distance - self.radius < radius)
    }

    /// Between the faces of the blank.
    fn is_within(&self, z: f64) -> bool {
        self.faces.is_none_or(|[low, high]| (low..=high).contains(&z))
    }

    /// Teeth, module and helix are the same.
    fn has_teeth_of(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
        self.teeth == other.teeth
            && same(self.module, other.module)
            && same(self.twist, other.twist)
            && same(self.sense, other.sense)
    }
}

/// Turns within half a turn of zero.
fn wrapped(turns: f64) -> f64 {
    turns - turns.round()
}

/// The round blank: that of the program's comment, else that of the set-up.
struct Blank {
    radius: Option<f64>,
    faces: Option<[f64; 2]>,
}

impl Blank {
    fn of(config: &Config) -> Self {
        if let Some(block) = config.gear_blank {
            let half = (block.to[0] - block.from[0]).value() / 2.0;
            let faces = Some([block.from[2].value(), block.to[2].value()]);
            return Self { radius: Some(half), faces };
        }
        let radius = config.stock_radius.filter(|_| config.stock.is_some()).map(Length::value);
        let faces = config.stock.map(|stock| [stock.from[2].value(), stock.to[2].value()]);
        Self { radius, faces }
    }
}

/// What the program ordered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrderedGear {
    pub(crate) hob: Hob,
}

/// Follows hob and work.
#[derive(Clone, Debug)]
pub(crate) struct GearTrack {
    rack: Generator,
    /// What is in the spindle; `None`: the table does not describe it as a hob.
    hob: Option<HobTool>,
    number: Option<u32>,
    axis: [f64; 2],
    track: PassTrack,
}

impl GearTrack {
    pub(crate) fn new(
        ordered: &OrderedGear,
        (number, tool): (Option<u32>, Option<&Tool>),
        config: &Config,
    ) -> Self {
        let rack = Generator::new(&ordered.hob, tool, config);
        let hob = tool.and_then(|tool| match tool.kind {
            ToolKind::Hob(hob) => Some(hob),
            _ => None,
        });
        let axis = config.work_axis.map(Length::value);
        Self { rack, hob, number, axis, track: PassTrack::new(rack) }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        self.track.sample(sample, self.axis[0]);
    }

    pub(crate) fn finish(
        mut self,
        (op, line, tool): (u32, u32, Option<u32>),
        ordered: &OrderedGear,
        (config, cuts): (&Config, &mut Cuts),
        now: Time,
    ) -> (Judged<Gear>, Earlier) {
        let (hob, tool) = (&ordered.hob, self.number.or(tool));
        let contact = self.contact();
        let mut findings = Vec::new();
        if self.track.faulted {
            findings.push("the machine stopped while the work was geared to the hob".to_owned());
        }
        if let Some(stock) = config.stock.as_ref().filter(|_| hob.own_zero.is_none()) {
            let [x, y, z] = hob.zero.linear;
            let zero = [x, y, z - Length::mm(self.rack.tool_length)];
            findings.extend(shifted(zero, stock, config.tolerances.position));
        }
        let passes = std::mem::take(&mut self.track.passes);
        let (time, duration, spin) = duration(&passes, now);
        let mut gear = empty(hob, spin);
        let mut not_judged = unknown(config.stock.as_ref());
        let mut earlier = Earlier::default();
        if passes.is_empty() {
            findings.push("not cut: the hob never touched the blank".to_owned());
        } else {
            let teeth = Teeth::of(&self.rack, &passes, hob.asked.width);
            let new = CutGear { op: Some(op), line, tool, rack: self.rack, passes, teeth };
            let cut;
            (cut, earlier) = cuts.add(new);
            findings.append(&mut earlier.findings);
            findings.extend(cut.teeth.too_narrow());
            not_judged = not_judged.or(earlier.unknown.take());
            let unknown = self.judge(&mut gear, hob, &cut.passes, config, &mut findings);
            not_judged = not_judged.or(unknown);
        }
        let verdict = Verdict::unless(&findings, not_judged);
        (Judged { op, line, tool, time, duration, verdict, contact, kind: gear }, earlier)
    }

    /// Measures the teeth; gives why they cannot be judged.
    fn judge(
        &self,
        gear: &mut Gear,
        hob: &Hob,
        passes: &[Pass],
        config: &Config,
        findings: &mut Vec<String>,
    ) -> Option<String> {
        let passes = measure::deepest(passes, self.rack.radius);
        let beside = measure::beside(&passes, &self.rack);
        let backwards = self.track.turned[1] > self.track.turned[0];
        let mut not_judged = None;
        let mut generates = true;
        if let Some(tool) = self.hob {
            let rack = Rack { tool, radius_mm: self.rack.radius };
            let wrong = rack.differs(hob, backwards);
            generates = tool.signed_starts() == i64::from(hob.starts);
            findings.extend(wrong);
            if generates {
                let blank = (self.rack.blank_radius, beside);
                gear.size = rack.size(hob, &passes, blank, &config.tolerances, findings);
            }
            findings.extend(self.along_its_axis(&rack, hob, &mut not_judged));
        } else {
            let number = self.number.map_or("the tool".to_owned(), |number| format!("T{number}"));
            not_judged = Some(format!(
                "{number} is not described as a hob: how thick the teeth are is not known without its module, diameter and threads (kind = \"hob\" in the tool table)"
            ));
        }
        if !generates {
            return not_judged;
        }
        let fewest = measure::fewest(&passes, hob.teeth);
        if fewest < LEAST_PASSES {
            return not_judged.or(Some(format!(
                "{fewest} pass(es) at full depth of the tooth that has fewest, {LEAST_PASSES} are needed to measure pitch and helix: feed less a turn of the work"
            )));
        }
        measure::measure(
            gear,
            &self.rack,
            &passes,
            hob.asked.grade.unwrap_or(GRADE_ASKED),
            findings,
        );
        let feed = feed_of_a_turn(&passes);
        gear.feed_mark = Length::mm(self.feed_mark(feed));
        findings.extend(width(gear, hob, feed));
        not_judged
    }

    /// Depth of the marks that a feed leaves: the hob's circle cuts a hollow along the tooth,
    /// δ = (f/cos β)²·sin α / (4·D) (Hoffmeister; DIN 3960 has the angles).
    fn feed_mark(&self, feed: f64) -> f64 {
        let angle = self.hob.map_or(hob_angle(), |hob| hob.pressure_angle.in_rad());
        let along = feed / self.rack.helix_deg.to_radians().cos();
        if self.rack.radius > 0.0 {
            along * along * angle.sin() / (8.0 * self.rack.radius)
        } else {
            0.0
        }
    }

    fn along_its_axis(
        &self,
        rack: &Rack,
        hob: &Hob,
        not_judged: &mut Option<String>,
    ) -> Option<String> {
        let [low, high] = self.track.y?;
        if high - low > ALONG_Y_MM {
            not_judged.get_or_insert_with(|| {
                format!(
                    "the hob moved {:.3} mm along Y while it cut: what a hob that is shifted along its axis generates is not judged",
                    high - low
                )
            });
        }
        let off = [low, high].map(|y| y - self.axis[1]);
        let most = if off[0].abs() > off[1].abs() { off[0] } else { off[1] };
        rack.reaches_over(hob, most).err()
    }

    /// How far the hob's teeth went into the blank; what hobbing takes is not simulated.
    fn contact(&self) -> Contact {
        let reach = |radius: f64| {
            let least = self.track.passes.iter().map(|p| p.distance).fold(f64::INFINITY, f64::min);
            Length::mm((radius - (least - self.rack.radius)).max(0.0))
        };
        Contact { reach: self.rack.blank_radius.map(reach), ..Contact::default() }
    }
}

const fn hob_angle() -> f64 {
    canon::GearAsked::PRESSURE_ANGLE.in_rad()
}

/// From when, for how long and how fast the work turned in the cut.
fn duration(passes: &[Pass], now: Time) -> (Time, Time, Spin) {
    let Some((first, last)) = passes.first().zip(passes.last()) else {
        return (now, Time::ZERO, Spin::ZERO);
    };
    let duration = last.time - first.time;
    let turned = Angle::rev((last.work - first.work).abs());
    let spin = if duration > Time::ZERO { turned / duration } else { Spin::ZERO };
    (first.time, duration, spin)
}

/// Feed along the face a turn of the work, mean over the passes.
fn feed_of_a_turn(passes: &[Pass]) -> f64 {
    let (way, turns) = passes.windows(2).fold((0.0, 0.0), |(way, turns), pair| {
        (way + (pair[1].z - pair[0].z).abs(), turns + (pair[1].work - pair[0].work).abs())
    });
    if turns > 0.0 { way / turns } else { 0.0 }
}

/// The face that the drawing asks for is toothed.
fn width(gear: &Gear, hob: &Hob, feed: f64) -> Option<String> {
    let found = (gear.z_to - gear.z_from).value();
    let asked = hob.asked.width.map_or(0.0, Length::value);
    let least = if asked > 0.0 { asked } else { hob.module.value() };
    let short = found < least - SHORT_MM - feed / f64::from(hob.teeth);
    let what = if asked > 0.0 {
        format!("{asked:.3} asked")
    } else {
        "less than a module: the hob was not fed along the face".to_owned()
    };
    short.then(|| format!("the toothed face is {found:.3} mm wide, {what}"))
}

const fn empty(hob: &Hob, spin: Spin) -> Gear {
    Gear {
        teeth: hob.teeth,
        module: hob.module,
        helix: hob.helix,
        lead: None,
        lead_ordered: None,
        pitch_deviation: Length::ZERO,
        pitch_total: Length::ZERO,
        helix_deviation: Length::ZERO,
        profile_deviation: Length::ZERO,
        profile_slope: Length::ZERO,
        profile_form: Length::ZERO,
        feed_mark: Length::ZERO,
        grade: None,
        allowed: [Length::ZERO; 4],
        z_from: Length::ZERO,
        z_to: Length::ZERO,
        size: None,
        spin,
        places: Vec::new(),
    }
}
