//! How thick and how high the teeth are: what the real distance of the axes makes of the hob in the
//! spindle, against the drawing.
//!
//! ```text
//!   distance a = X of the axes           x = (a − (r_hob − h_a0) − d/2) / m     root: d_f = 2·(a − r_hob)
//!     work  ├──── d/2 ────┤─ x·m ─┤── r_hob − h_a0 ──┤  hob                     tip: as the blank is
//! ```
use super::tooth::Tooth;
use super::track::Pass;
use crate::Tolerances;
use canon::{Hob, HobTool};
use core::f64::consts::PI;
use units::Length;

/// Share by which module and pressure angle of hob and gear may differ: rounding of a diametral
/// pitch.
const SAME: f64 = 1e-4;

/// Size of the teeth where it is farthest from what is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothSize {
    /// Distance of the axes there.
    pub distance: Length,
    /// Distance of the axes at which they have the size that is asked.
    pub distance_asked: Length,
    /// Coefficient of the profile shift.
    pub shift: f64,
    /// Teeth that the span is taken over.
    pub spanned: u32,
    /// Base tangent length over `spanned` teeth, `W_k`.
    pub span: Length,
    /// `W_k` of the drawing's nominal tooth.
    pub span_asked: Length,
    /// Least and greatest span allowed.
    pub span_allowed: [Length; 2],
    /// Diameter of the measuring balls.
    pub ball: Length,
    /// Dimension over two balls; `None`: they do not touch the flanks.
    pub over_balls: Option<Length>,
    /// Dimension over two balls without allowances.
    pub over_balls_asked: Option<Length>,
    /// Diameter of the root circle.
    pub root_diameter: Length,
    /// Diameter over the tips: that of the blank, which is not hobbed; `None`: not known.
    pub tip_diameter: Option<Length>,
    /// Diameter over the tips that is asked.
    pub tip_diameter_asked: Length,
}

/// The tooth that the drawing asks for.
pub(super) fn asked(hob: &Hob) -> Tooth {
    Tooth {
        teeth: f64::from(hob.teeth),
        module_mm: hob.module.value(),
        pressure_rad: hob.asked.pressure_angle().in_rad(),
        helix_rad: hob.helix.in_rad(),
        shift: hob.asked.shift,
    }
}

/// The hob in the spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rack {
    pub(super) tool: HobTool,
    pub(super) radius_mm: f64,
}

impl Rack {
    /// The tooth that it generates at this distance of the axes.
    fn tooth(&self, hob: &Hob, distance_mm: f64) -> Tooth {
        let unshifted = Tooth {
            module_mm: self.tool.module.value(),
            pressure_rad: self.tool.pressure_angle.in_rad(),
            shift: 0.0,
            ..asked(hob)
        };
        let datum = self.radius_mm - self.tool.addendum.value();
        let beyond = distance_mm - datum - unshifted.reference_diameter() / 2.0;
        unshifted.shifted(beyond / unshifted.module_mm)
    }

    /// Distance of the axes for a tooth.
    fn distance(&self, tooth: &Tooth) -> f64 {
        let datum = self.radius_mm - self.tool.addendum.value();
        datum + tooth.reference_diameter() / 2.0 + tooth.shift * tooth.module_mm
    }

    /// Half of its length that generates teeth, mm: the path of contact as the rack sees it, and
    /// the tooth that stands at its end.
    fn generating_half(&self, hob: &Hob) -> f64 {
        let module = self.tool.module.value();
        let high = self.tool.addendum.value().max(module * (1.0 + hob.asked.shift.abs()));
        high / self.tool.pressure_angle.in_rad().tan() + PI * module / 2.0
    }

    /// The hob reaches over the teeth, which stand this far from its middle along its axis.
    pub(super) fn reaches_over(&self, hob: &Hob, beside_mm: f64) -> Result<(), String> {
        let Some(length) = self.tool.length.map(Length::value) else { return Ok(()) };
        let least = 2.0 * (beside_mm.abs() + self.generating_half(hob));
        if least <= length {
            return Ok(());
        }
        Err(format!(
            "the hob of {length:.1} mm does not reach over the teeth: {least:.1} mm generate them where it stood, {:.1} mm beside its middle",
            beside_mm.abs()
        ))
    }

    /// What the hob has that the gear has not: one sentence each.
    pub(super) fn differs(&self, hob: &Hob, turned_backwards: bool) -> Vec<String> {
        let mut wrong = Vec::new();
        let (tool, gear) = (&self.tool, asked(hob));
        let [module, angle] = [tool.module.value(), tool.pressure_angle.in_rad()];
        let off = |found: f64, asked: f64| (found / asked - 1.0).abs() > SAME;
        if off(module, gear.module_mm) || off(angle, gear.pressure_rad) {
            let base = |module: f64, angle: f64| PI * module * angle.cos();
            wrong.push(format!(
                "the hob has module {} and {:.1}°, the gear module {} and {:.1}°: base pitch {:.3} mm, {:.3} mm asked",
                rounded(module),
                angle.to_degrees(),
                rounded(gear.module_mm),
                gear.pressure_rad.to_degrees(),
                base(module, angle),
                base(gear.module_mm, gear.pressure_rad)
            ));
        }
        let sense = if turned_backwards == tool.cuts_backwards { 1 } else { -1 };
        let (starts, ordered) = (tool.signed_starts(), i64::from(hob.starts));
        if starts != ordered && ordered != 0 {
            let generated = f64::from(hob.teeth) * starts as f64 / ordered as f64;
            let hand = if starts < 0 { "left" } else { "right" };
            let what = if starts.signum() == ordered.signum() {
                format!("{} teeth are generated, {} asked", rounded(generated), hob.teeth)
            } else {
                "the work turned against its threads, and no teeth are generated".to_owned()
            };
            wrong.push(format!(
                "the hob has {} {hand}-hand start(s), and L{ordered} was ordered: {what}; L{starts} works",
                starts.abs()
            ));
        }
        if sense < 0 {
            let (found, works) = if turned_backwards { ("M4", "M3") } else { ("M3", "M4") };
            wrong.push(format!(
                "the hob turned with the backs of its teeth ahead ({found}): {works} works"
            ));
        }
        wrong
    }

    /// Sizes of the teeth of these passes, and what is wrong with them. `beside_mm`: two passes of
    /// a tooth stood so far from one another along the pitch circle.
    pub(super) fn size(
        &self,
        hob: &Hob,
        passes: &[Pass],
        (blank_radius, beside_mm): (Option<f64>, f64),
        tolerances: &Tolerances,
        findings: &mut Vec<String>,
    ) -> Option<ToothSize> {
        let wanted = asked(hob);
        let k = wanted.spanned();
        let nominal = wanted.span(k);
        let normal = wanted.helix_rad.cos() * wanted.pressure_rad.cos();
        let usual = tolerances.tooth_thickness.value() * wanted.pressure_rad.cos();
        let [most, least] =
            hob.asked.span.map_or([usual, -usual], |allowances| allowances.map(Length::value));
        let allowed = [nominal + least, nominal + most];
        let span = |pass: &Pass| self.tooth(hob, pass.distance).span(k) - beside_mm * normal;
        let beyond = |pass: &Pass| (allowed[0] - span(pass)).max(span(pass) - allowed[1]);
        let worst = passes.iter().max_by(|a, b| beyond(a).total_cmp(&beyond(b)))?;
        let (tooth, found) = (self.tooth(hob, worst.distance), span(worst));
        let needed = self.distance(&wanted.shifted(
            // the middle of what is allowed
            wanted.shift + (most + least) / (4.0 * wanted.module_mm * wanted.pressure_rad.sin()),
        ));
        if beyond(worst) > 0.0 {
            let thin = found < allowed[0];
            let (than, word) = if thin { ("thin", "deep") } else { ("thick", "shallow") };
            let over = 1e3 * (found - nominal).abs() / wanted.pressure_rad.cos();
            findings.push(format!(
                "the teeth are {over:.0} µm too {than}: span over {k} teeth {found:.3} mm, {:.3} to {:.3} allowed; \
                 the axes stood {:.3} mm apart, {:.3} mm too {word}: {needed:.3} works",
                allowed[0],
                allowed[1],
                worst.distance,
                (needed - worst.distance).abs(),
            ));
        }
        let over_balls = |tooth: &Tooth| tooth.over_balls(wanted.ball()).map(Length::mm);
        let size = ToothSize {
            distance: Length::mm(worst.distance),
            distance_asked: Length::mm(needed),
            shift: tooth.shift,
            spanned: k,
            span: Length::mm(found),
            span_asked: Length::mm(nominal),
            span_allowed: allowed.map(Length::mm),
            ball: Length::mm(wanted.ball()),
            over_balls: over_balls(&tooth),
            over_balls_asked: over_balls(&wanted),
            root_diameter: Length::mm(2.0 * (worst.distance - self.radius_mm)),
            tip_diameter: blank_radius.map(|radius| Length::mm(2.0 * radius)),
            tip_diameter_asked: tip_asked(hob),
        };
        findings.extend(size.tip(tolerances));
        Some(size)
    }
}

/// Diameter over the tips: a module over the shifted reference circle unless the drawing says.
fn tip_asked(hob: &Hob) -> Length {
    let tooth = asked(hob);
    let usual = tooth.reference_diameter() + 2.0 * tooth.module_mm * (1.0 + tooth.shift);
    hob.asked.tip_diameter.unwrap_or(Length::mm(usual))
}

impl ToothSize {
    /// How far the span is within what is allowed; below zero: outside.
    pub fn span_left(&self) -> Length {
        (self.span - self.span_allowed[0]).min(self.span_allowed[1] - self.span)
    }

    fn tip(&self, tolerances: &Tolerances) -> Option<String> {
        let (found, asked) = (self.tip_diameter?.value(), self.tip_diameter_asked.value());
        let most = tolerances.tip_diameter.value();
        ((found - asked).abs() > most).then(|| {
            format!(
                "tip diameter {found:.3} mm as the blank has it, {asked:.3} asked, {most:.2} off allowed: turn the blank to it, and state it, (STOCK X… Y… Z… X… Y… Z…)"
            )
        })
    }
}

/// A number for people.
fn rounded(value: f64) -> String {
    canon::number(value)
}
