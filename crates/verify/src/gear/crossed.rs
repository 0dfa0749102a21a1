//! What other tools do to teeth: a mill, a drill or whatever else is in the spindle cuts them from
//! their upper face down to its edge.
use super::Generator;
use super::again::{CutGear, Cuts};
use super::track::Pass;
use crate::Config;
use crate::milling::Cutter;
use crate::stroke::{axis_mm, edge_of};
use crate::undone::{Undone, of_before};
use crate::workpiece::ToolCut;
use bus::Sample;
use canon::ToolKind;
use units::Length;

/// A tool whose form is not known is so wide at least, mm.
const LEAST_RADIUS_MM: f64 = 0.1;
/// Where the drawing asks no width, this share of the face may be taken.
const LOST_SHARE: f64 = 0.1;
/// The face may be narrower by this, mm: the tolerance of its width.
const LOST_MM: f64 = 0.1;

/// The body of a gear's teeth, and what other tools have taken off it since.
#[derive(Clone, Copy, Debug)]
pub(super) struct Teeth {
    /// Radii of roots and tips, mm.
    ring: [f64; 2],
    /// Coordinates of their lower and upper face, mm.
    face: [f64; 2],
    /// Width of the face that the drawing asks.
    width: Option<Length>,
    /// Coordinate down to which they are gone.
    level_mm: f64,
    /// The line since which the face is too narrow, and whether that was said.
    spoilt: Option<(u32, bool)>,
}

impl Teeth {
    pub(super) fn of(rack: &Generator, passes: &[Pass], width: Option<Length>) -> Self {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let face = passes.iter().fold(ends, |[low, high], p| [low.min(p.z), high.max(p.z)]);
        let least = passes.iter().map(|pass| pass.distance).fold(f64::INFINITY, f64::min);
        let tip = rack.blank_radius.unwrap_or(rack.pitch_diameter / 2.0 + rack.module);
        let ring = [(least - rack.radius).clamp(0.0, tip), tip];
        Self { ring, face, width, level_mm: face[1], spoilt: None }
    }

    pub(super) const fn width(&self) -> Option<Length> {
        self.width
    }

    /// What was taken off the same teeth before they were hobbed again is off.
    pub(super) const fn after(self, old: &Self) -> Self {
        Self { level_mm: self.level_mm.min(old.level_mm), ..self }
    }

    /// What is left of the face, if that is not enough.
    pub(super) fn too_narrow(&self) -> Option<String> {
        let [low, high] = self.face;
        let (whole, left) = (high - low, (self.level_mm - low).max(0.0));
        let asked = self.width.map_or(whole * (1.0 - LOST_SHARE), Length::value);
        (self.level_mm < high && left < asked - LOST_MM)
            .then(|| format!("its teeth are left over {left:.2} of {whole:.2} mm"))
    }

    fn cut(&mut self, cut: &ToolCut, axis: [f64; 2], line: u32) {
        if let Some(level) = cut.ring_level(axis, self.ring)
            && level < self.level_mm
        {
            self.level_mm = level;
            if self.spoilt.is_none() && self.too_narrow().is_some() {
                self.spoilt = Some((line, false));
            }
        }
    }
}

impl Cuts {
    /// As a program finds them whose operations are numbered anew.
    pub(crate) fn at_rest(mut self) -> Self {
        self.cuts.iter_mut().for_each(|gear| gear.op = gear.op.map(of_before));
        self
    }

    /// A sample in which no gear is hobbed.
    pub(crate) fn sample(&mut self, sample: &Sample, config: &Config) {
        if self.cuts.is_empty() {
            return;
        }
        let tool = sample.feedback.tool.and_then(|number| config.mill(number));
        let Some(tool) = tool.filter(|t| !matches!(t.kind, ToolKind::Hob(_) | ToolKind::Probe(_)))
        else {
            return;
        };
        let radius = (tool.diameter.value() / 2.0).max(LEAST_RADIUS_MM);
        let cut = ToolCut {
            at: [0, 1].map(|axis| axis_mm(sample, axis)),
            tip_mm: edge_of(sample, 2) - tool.worn_length().value(),
            cutter: Cutter::of(tool).unwrap_or(Cutter::flat(radius)),
        };
        let (axis, line) = (config.work_axis.map(Length::value), sample.report.line);
        self.cuts.iter_mut().for_each(|gear| gear.teeth.cut(&cut, axis, line));
    }

    /// Nothing is left to say of them.
    pub(crate) fn is_settled(&self) -> bool {
        self.cuts.iter().all(|gear| gear.teeth.spoilt.is_none_or(|(_, said)| said))
    }

    /// What other tools have done to them since.
    pub(crate) fn settle(&mut self) -> Vec<Undone> {
        let said = |gear: &mut CutGear| {
            let (line, said) = gear.teeth.spoilt.as_mut().filter(|(_, said)| !said)?;
            *said = true;
            let line = *line;
            Some(Undone { op: gear.op?, line, how: gear.teeth.too_narrow()?, is_known: true })
        };
        self.cuts.iter_mut().filter_map(said).collect()
    }
}
