//! The tools beside the one that cuts: a turret carries them along, and a long one meets chuck,
//! bar or tailstock before the tool that the program thinks of.
//!
//! ```text
//!   X ↑      ● turret's axis         the tool in station p stands on a circle of radius R about it;
//!            │ R                     k stations farther it stands R (1 − cos φ) farther out and
//!       ╭────┼────╮                  R sin φ aside, φ = 2π k / stations, with its own length along Z
//!      ╱ φ   │     ╲
//!   next    tool    last             r = √((x + R (1 − cos φ))² + (R sin φ)²)
//!     ·······●······· work's axis
//! ```
//!
//! A station is the tool's pocket in the table. Turning tools are as long as their points stand
//! out; round ones reach from their tip to the turret.
use super::{Job, Planner, Point, SCRAPES, Sweep, places, solid};
use crate::bodies::Turret;
use crate::findings::Cause;
use crate::words::{Rounding, advice, length, place};
use alloc::{format, string::String, vec::Vec};
use canon::{Axis, Tool, ToolKind};
use diag::Diagnostic;
use motion::Path;

/// How far a tool keeps off what holds the work, mm.
const CLEAR: f64 = 2.0;

/// A tool beside the one that cuts.
#[derive(Clone, Debug)]
struct Neighbour {
    name: String,
    station: u32,
    /// From the gauge line to its tip, mm.
    long: f64,
    /// Of its shank, mm.
    radius: f64,
    /// Farther out, and aside, than the tool that cuts, mm.
    off: [f64; 2],
}

/// How a neighbour meets what holds the work, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clash {
    depth: f64,
    /// Of the tip of the tool that cuts.
    at: Point,
    name: &'static str,
    /// Clear along Z, of the neighbour's tip; `None`: across alone.
    clear: Option<f64>,
    /// The radius that it keeps off.
    wide: f64,
}

fn neighbours(tools: &canon::ToolLibrary, tool: &Tool, turret: Turret) -> Vec<Neighbour> {
    let stations = f64::from(turret.stations);
    let is_one = |other: &&Tool| {
        other.number != tool.number
            && !other.stand_in
            && (1..=turret.stations).contains(&other.pocket)
            && other.pocket != tool.pocket
    };
    let neighbour = |other: &Tool| {
        let apart = f64::from(other.pocket) - f64::from(tool.pocket);
        let angle = core::f64::consts::TAU * apart / stations;
        let wide = match &other.kind {
            ToolKind::Insert(_) => 0.0,
            _ => other.body.shank.map_or(0.0, units::Length::value).max(other.diameter.value()),
        };
        let radius = turret.radius.value();
        Neighbour {
            name: other.name(),
            station: other.pocket,
            long: other.worn_length().value(),
            radius: wide / 2.0,
            off: [radius * (1.0 - libm::cos(angle)), radius * libm::sin(angle)],
        }
    };
    tools.iter().filter(is_one).map(neighbour).collect()
}

impl Neighbour {
    /// Its distance from the work's axis, where the tip of the tool that cuts is at this place. The
    /// turret stands on the side of X+.
    fn off_axis(&self, at: Point, [cx, cy]: [f64; 2]) -> f64 {
        let [out, aside] = self.off;
        let r = libm::hypot(at[0] - cx + out, at[1] - cy + aside);
        (r - self.radius).max(0.0)
    }
}

impl Planner {
    /// The turret's other tools against chuck, bar and tailstock.
    pub(in crate::planner) fn sweep_turret(&mut self, job: &Job, path: &Path, run: Sweep) {
        let Some(contact) = self.contact.as_ref().filter(|_| self.turns_work) else { return };
        let Some(turret) = contact.bodies.turret else { return };
        let Some(tool) = self.tools.get(self.tool).filter(|tool| tool.pocket > 0) else { return };
        let (stock, bodies) = (contact.stock, contact.bodies);
        let axis = [0, 1].map(|i| f64::midpoint(stock.from[i].value(), stock.to[i].value()));
        let (long, across) = (tool.worn_length().value(), self.frame.tool.linear[0].value());
        let mut worst: Option<(Clash, Neighbour)> = None;
        for neighbour in neighbours(&self.tools, tool, turret) {
            let mut before: Option<Point> = None;
            let mut meet = |at: Point| {
                let r = neighbour.off_axis(at, axis);
                let gauge = at[2] + long;
                let tip = gauge - neighbour.long;
                let mut known = |name, wide: f64, along: f64, clear| {
                    let depth = (wide - r).min(along);
                    if depth > SCRAPES && worst.as_ref().is_none_or(|(w, _)| depth > w.depth) {
                        worst = Some((Clash { depth, at, name, clear, wide }, neighbour.clone()));
                    }
                };
                if let Some(chuck) = bodies.chuck {
                    let face = chuck.to.value();
                    known("chuck", chuck.radius.value(), face - tip, Some(face));
                }
                if let Some(centre) = bodies.tailstock {
                    let along = gauge.min(centre.to.value()) - tip.max(centre.from.value());
                    known("tailstock", centre.radius.value(), along, None);
                }
                if let Some(outline) = &contact.outline {
                    let front = outline.front_beside([axis[0] + r + SCRAPES, axis[1]], 0.0);
                    let wide = (stock.to[0] - stock.from[0]).value() / 2.0;
                    known("bar", wide, front - tip, Some(front));
                }
            };
            places(path, long, |[x, y, z]| {
                let to = [x - across, y, z];
                match before.replace(to) {
                    Some(from) => solid::between(from, to).for_each(&mut meet),
                    None => meet(to),
                }
            });
        }
        if let Some((met, neighbour)) = worst {
            self.say_neighbour(job, run, (&met, &neighbour), [axis[0] + across, across, long]);
        }
    }

    fn say_neighbour(
        &mut self,
        job: &Job,
        run: Sweep,
        (met, neighbour): (&Clash, &Neighbour),
        [axis, across, long]: [f64; 3],
    ) {
        let Some((contact, tool)) = self.contact.as_ref().zip(self.tools.get(self.tool)) else {
            return;
        };
        let frame = &self.frame;
        let how = if run == Sweep::Rapid { "rapid" } else { "feed" };
        let works = if let Some(end) = met.clear {
            let clear = end + CLEAR + neighbour.long;
            advice(frame, Axis::Z, clear, Rounding::Up)
        } else {
            let [out, aside] = neighbour.off;
            let wide = met.wide + CLEAR + neighbour.radius;
            let x = libm::sqrt((wide * wide - aside * aside).max(0.0)) - out;
            advice(frame, Axis::X, axis + x, Rounding::Up)
        };
        let said = [
            format!(
                "the {how} of {} takes {}, in station {} of the turret, {} into the {} at {} and {}",
                tool.name(),
                neighbour.name,
                neighbour.station,
                length(frame, met.depth),
                met.name,
                place(frame, Axis::X, met.at[0] + across),
                place(frame, Axis::Z, met.at[2] + long),
            ),
            format!(": {works} or more is clear of it, or a station farther away"),
        ];
        let sure = Self::sure(contact.doubtful);
        let which = [contact.mounted, sure as u32, 8 + neighbour.station];
        self.findings.merge(Cause { code: "M0360", which }, met.depth, || {
            let help = "[setup.turret] in the machine's file says how far apart its stations are, the tool table in which one a tool is (pocket) and how long it is";
            let mut finding = Diagnostic::error("M0360", job.span, "").with_help(help);
            finding.severity = sure;
            (finding, said)
        });
    }
}
