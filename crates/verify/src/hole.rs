//! A hole, from the tip's path while its op was in force.
//!
//! ```text
//!   surface ──┬───────────┬──    depth: deepest tip
//!             │     D     │      full-diameter depth = depth − point
//!             │           │      point of a drill = D/2 / tan(point angle / 2): 0.30·D at 118°
//!             └─╲       ╱─┘
//!                 ╲   ╱          a spot drill leaves the cone alone: its diameter at the surface
//!                   V            is 2·depth·tan(point angle / 2), at most D
//! ```
use crate::judged::Judged;
use crate::stroke::{Stroke, Visit};
use crate::verdict::Verdict;
use crate::workpiece::Workpiece;
use crate::{Config, Contact};
use bus::Sample;
use canon::{Tool, ToolKind};
use units::{Angle, Length, Time};

/// Holes this near to each other are one.
pub(crate) const SAME_HOLE: Length = Length::mm(0.1);

/// A hole as it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Mean X of the axis while the tool was in the material.
    pub x: Length,
    /// Likewise Y.
    pub y: Length,
    /// Deepest point of the tool's tip below the surface.
    pub depth: Length,
    /// Down to here the hole has its diameter: `depth` less the drill's point.
    pub full_diameter_depth: Length,
    /// `depth` less the programmed depth.
    pub depth_error: Length,
    /// Largest distance from the programmed position while in the material.
    pub position_error: Length,
    /// The tool's diameter; for a spot drill the cone's diameter at the surface.
    pub diameter: Length,
    /// Chips were thrown off the tool after it, on the way to the next hole: seen, not only
    /// ordered.
    pub chip_removal: bool,
}

/// Follows one hole.
#[derive(Clone, Debug)]
pub(crate) struct HoleTrack {
    stroke: Stroke,
    visit: Visit,
}

impl HoleTrack {
    pub(crate) fn new(stroke: Stroke) -> Self {
        Self { stroke, visit: Visit::new() }
    }

    pub(crate) fn sample(&mut self, sample: &Sample) {
        let depth_mm = self.stroke.depth_mm(self.stroke.edge_mm(sample));
        self.visit.sample(&self.stroke, sample, depth_mm);
    }

    /// Measure and judge. `None` for a tool that makes no feature.
    pub(crate) fn finish(
        &self,
        (op, line): (u32, u32),
        tool: (Option<u32>, Option<&Tool>),
        now: Time,
        config: &Config,
        work: &Workpiece,
    ) -> Option<Judged<Hole>> {
        let depth_mm = self.visit.deepest_mm.max(0.0);
        let mut findings = Vec::new();
        let (diameter_mm, point_mm) = match tool.1.map(|t| (&t.kind, t.diameter.value())) {
            Some((ToolKind::Drill { point_angle }, d)) => (d, point_mm(d, *point_angle)),
            Some((ToolKind::SpotDrill { point_angle }, d)) => {
                (d.min(2.0 * depth_mm * half_tangent(*point_angle)), depth_mm)
            }
            Some((ToolKind::EndMill(_), d)) => (d, 0.0),
            Some((ToolKind::Tap(_), d)) => {
                findings.push("a tap was used as a drill".into());
                (d, 0.0)
            }
            Some((
                ToolKind::PolygonCutter(_)
                | ToolKind::Insert(_)
                | ToolKind::Hob(_)
                | ToolKind::Probe(_)
                | ToolKind::Other,
                _,
            )) => {
                return None;
            }
            None => {
                findings.push(match tool.0 {
                    Some(number) => format!("T{number} is not in the tool table"),
                    None => "there was no tool in the spindle".into(),
                });
                (0.0, 0.0)
            }
        };
        findings.extend(self.visit.findings(&self.stroke, config.tolerances.position));
        let depth_error = Length::mm(depth_mm - self.stroke.programmed_mm);
        let allowed = config.tolerances.hole_depth;
        if self.visit.times_s.is_some() && depth_error.abs() > allowed {
            let word = if depth_error > Length::ZERO { "deep" } else { "shallow" };
            findings.push(format!(
                "{:.0} µm too {word}: {depth_mm:.3} mm instead of {:.3} mm, {:.0} µm allowed",
                depth_error.abs().in_um(),
                self.stroke.programmed_mm,
                allowed.in_um()
            ));
        }
        let [x, y] = self.visit.position(&self.stroke);
        let contact = self.contact(tool.1);
        let full_mm = (depth_mm - point_mm).max(0.0);
        // a drill that finds its hole made already meets nothing in it
        if self.visit.times_s.is_some() && !work.was_there(op) {
            findings.extend(contact.unresisted());
        }
        findings.extend(work.neighbours(op));
        let findings = Visit::causes(&self.stroke, findings);
        let hole = Hole {
            x,
            y,
            depth: Length::mm(depth_mm),
            full_diameter_depth: Length::mm(full_mm),
            depth_error,
            position_error: self.visit.position_error(),
            diameter: Length::mm(diameter_mm),
            chip_removal: false, // the judge sees that later
        };
        let [time, duration] = times(&self.visit, now);
        let verdict = Verdict::unless(&findings, self.stroke.not_judged());
        let tool = tool.0;
        Some(Judged { op, line, tool, time, duration, verdict, contact, kind: hole })
    }

    /// The evidence of contact; what an end mill takes is not simulated.
    fn contact(&self, tool: Option<&Tool>) -> Contact {
        let known = self.visit.contact(&self.stroke);
        match tool.map(|tool| &tool.kind) {
            Some(ToolKind::Drill { .. } | ToolKind::SpotDrill { .. }) => known,
            _ => Contact { torque: None, force: None, ..known },
        }
    }
}

/// When the tool entered and how long it stayed.
pub(crate) fn times(visit: &Visit, now: Time) -> [Time; 2] {
    visit.times_s.map_or([now, Time::ZERO], |[first, last]| [Time::s(first), Time::s(last - first)])
}

/// tan(α/2), held away from the flat drill that would have no point and the needle without width.
fn half_tangent(point_angle: Angle) -> f64 {
    (point_angle.in_rad() / 2.0).clamp(0.01, 1.57).tan()
}

/// Length of a drill's point.
fn point_mm(diameter_mm: f64, point_angle: Angle) -> f64 {
    diameter_mm / 2.0 / half_tangent(point_angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_of_a_118_degree_drill_is_three_tenths_of_its_diameter() {
        assert!((point_mm(5.0, Angle::deg(118.0)) - 1.502).abs() < 0.001);
        assert!(point_mm(5.0, Angle::deg(180.0)) < 0.005, "a flat drill has none");
    }
}
