//! Taps that cannot come out right, refused before anything moves.
//!
//! ```text
//!   start ──┬─ R plane      in question: S against the spindle and lead·S against the feed axis,
//!           │               depth against the tap's flutes and against the drilled hole,
//!   surface ┼──┐ ┌──        hand and lead against the tap's own,
//!           │  │ │          the drill's diameter against the thread's core:
//!   bottom ─┴──│ │          D₁ = D − 1.0825·P … D₁ + TD1(6H)
//!              └─┘
//! ```
//!
//! The stroke is synchronised from rest to rest, so any run-in is long enough; none is asked for.
//!
//! Thread core: ISO 724 (basic dimensions); its tolerance TD1 of grade 6 by the table of ISO 965-1,
//! else by formula: 230·P^0.7 µm, or 433·P − 190·P^1.22 up to 0.8 mm.
use crate::chip::tap_strength;
use crate::findings::number;
use crate::holes::Drilled;
use crate::left_alone::{overrun, survives};
use crate::limits::{AxisLimits, Coasts, OwnRamps, SpindleLimits};
use crate::stroke::tapping_torque;
use crate::words::{
    Rounding, WHICH_UNIT, WrittenFrame, advice, advised, bare_length, feed, instead, is_other_unit,
    length, modal,
};
use alloc::{format, string::String, vec, vec::Vec};
use canon::{Holder, Tap, TapTool, Tool};
use diag::{Diagnostic, RemedyWord, Span};
use units::{Lead, Length, Spin, Torque};

/// Share by which the leads of program and tap may differ in a clutch holder, which gives.
const CLUTCH_LEAD_TOLERANCE: f64 = 0.01;
/// Likewise in any other: as good as nothing, or the tap ends beyond its bottom. A lead that a post
/// has rounded has become the tap's own by then.
const LEAD_TOLERANCE: f64 = 1e-4;
/// A hole is deeper than its thread by the chamfer of a tap, 2 to 3 pitches (form C of DIN 2197).
const BEYOND_PITCHES: f64 = 3.0;
/// Rounding of a program's numbers, mm.
const ROUNDING: f64 = 1e-6;
/// Share of the torque that breaks a tap, which it is taken to bear.
const BEARS_SHARE: f64 = 0.7;
/// Height of the thread's core above its axis: D − D₁ = 1.0825·P (ISO 724).
const CORE: f64 = 1.082_531_754_730_548_3;

/// One tap and all that it is measured against.
pub(crate) struct TapCheck<'a> {
    pub(crate) tap: &'a Tap,
    pub(crate) span: Span,
    pub(crate) tool: &'a Tool,
    pub(crate) tap_tool: &'a TapTool,
    pub(crate) axis: &'a AxisLimits,
    pub(crate) spindle: &'a SpindleLimits,
    pub(crate) hole: Option<Drilled>,
    pub(crate) own_ramps: Option<OwnRamps>,
    /// How the program writes it.
    pub(crate) frame: &'a WrittenFrame,
    pub(crate) coasts: Coasts,
}

impl TapCheck<'_> {
    /// Everything that is wrong with it.
    pub(crate) fn findings(&self, cut: Torque) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        all.extend(self.hand_or_lead());
        all.extend(self.speed(cut));
        all.extend(self.flutes());
        all.extend(self.left_alone(cut));
        if let Some(hole) = &self.hole {
            all.extend(self.hole_depth(hole));
            all.extend(self.stopping_margin(hole));
            all.extend(self.hole_diameter(hole));
        }
        all
    }

    /// Depth of the programmed bottom below the surface.
    fn depth(&self) -> Length {
        (self.tap.surface - self.tap.bottom).abs()
    }

    /// How to say a depth in the program's words, as far as they are known.
    fn word(&self, depth: f64) -> String {
        let letter = self.tap.axis.letter();
        let start = self.tap.start.along(self.tap.axis).of_linear();
        if self.tap.surface == start {
            format!("{} below the start of the tap", self.length(depth))
        } else {
            let sign = if self.tap.bottom < self.tap.surface { -1.0 } else { 1.0 };
            let way = self.tap.surface.value() + sign * depth - start.value();
            if self.frame.increment(self.tap.axis, way).is_some() {
                // a cycle's depth counts from its R plane there
                let frame = WrittenFrame { from: self.tap.start, ..*self.frame };
                return advice(&frame, self.tap.axis, start.value() + way, Rounding::Nearest);
            }
            format!("{letter}{}", bare_length(self.frame, sign * depth))
        }
    }

    /// The word of a bottom that is so deep.
    fn deep(&self, depth: f64) -> Vec<RemedyWord> {
        let Tap { axis, bottom, surface, .. } = *self.tap;
        let (sign, rounding) =
            if bottom < surface { (-1.0, Rounding::Up) } else { (1.0, Rounding::Down) };
        let machine = surface.value() + sign * depth;
        let works = advised(self.frame, axis, machine, rounding);
        vec![instead(works, advised(self.frame, axis, bottom.value(), Rounding::Nearest))]
    }

    /// A length in the program's unit.
    fn length(&self, mm: f64) -> String {
        length(self.frame, mm)
    }

    fn hand_or_lead(&self) -> Option<Diagnostic> {
        let (programmed, own) = (self.tap.lead.value(), self.tap_tool.lead.value());
        let name = &self.tap_tool.designation;
        if programmed * own < 0.0 {
            let (hand, instead) = if own < 0.0 {
                ("left", "G74, or M4 before G33.1")
            } else {
                ("right", "G84, or M3 before G33.1")
            };
            let text = format!(
                "expected a tap of the other hand: T{} {name} is {hand}-hand",
                self.tool.number
            );
            return Some(
                Diagnostic::error("M0327", self.span, text).with_help(format!("use {instead}")),
            );
        }
        let off = (programmed.abs() - own.abs()).abs();
        let tolerance = match self.tap_tool.holder {
            Holder::Clutch { .. } => CLUTCH_LEAD_TOLERANCE,
            Holder::Rigid { .. }
            | Holder::SoftSynchro { .. }
            | Holder::TensionCompression { .. } => LEAD_TOLERANCE,
        };
        (off > tolerance * own.abs()).then(|| {
            let rpm = self.tap.spin.in_rpm();
            let bare = |mm: f64| bare_length(self.frame, mm);
            let text = format!(
                "expected the tap's lead of {} per revolution ({name}), found {}: F{} with G94 and S{}, \
                 F{} with G95, K{} with G33.1",
                self.length(own.abs()),
                bare(programmed.abs()),
                bare(own.abs() * rpm),
                number(rpm),
                bare(own.abs()),
                bare(own.abs()),
            );
            let words = [('F', bare(own.abs() * rpm), "G94"), ('F', bare(own.abs()), "G95"), ('K', bare(own.abs()), "G33.1")];
            let finding = Diagnostic::error("M0326", self.span, text).with_remedy(modal(words));
            if is_other_unit(programmed, own) { finding.with_help(WHICH_UNIT) } else { finding }
        })
    }

    fn speed(&self, cut: Torque) -> Option<Diagnostic> {
        let lead = self.tap.lead.abs();
        let reachable = self.spindle.reachable(cut);
        if reachable == Spin::ZERO {
            return Some(self.too_heavy(cut));
        }
        let bounds = [
            (self.axis.feed_speed.of_linear() / lead, "M0320"),
            (self.spindle.tapping_max, "M0321"),
            (reachable, "M0331"),
        ];
        let (highest, code) = bounds.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        let spin = self.tap.spin;
        (spin.value() > highest.value() * (1.0 + ROUNDING)).then(|| {
            let why = match code {
                "M0320" => format!(
                    "{} feeds at {} at most, and {} per revolution need {}",
                    self.tap.axis.letter(),
                    feed(self.frame, self.axis.feed_speed.of_linear().in_mm_per_min()),
                    self.length(lead.value()),
                    bare_length(self.frame, (lead * spin).in_mm_per_min()),
                ),
                "M0321" => format!("the spindle taps at {} rpm at most", number(highest.in_rpm())),
                _ => format!(
                    "against {} N·m of cut the spindle does not reach it",
                    number(cut.value())
                ),
            };
            let works = whole_rpm(highest);
            let text = format!(
                "S{} is too fast for this tap: {why}; S{} works (with G94: F{})",
                number(spin.in_rpm()),
                number(works),
                bare_length(self.frame, works * lead.value()),
            );
            let feed = bare_length(self.frame, works * lead.value());
            let words = modal([('S', number(works), ""), ('F', feed, "G94")]);
            Diagnostic::error(code, self.span, text).with_remedy(words)
        })
    }

    fn too_heavy(&self, cut: Torque) -> Diagnostic {
        let own = self.spindle.peak_torque * self.spindle.margin - self.spindle.friction;
        let text = format!(
            "{} needs {} N·m here, and the spindle has {} N·m for cutting",
            self.tap_tool.designation,
            number(cut.value()),
            number(own.value()),
        );
        let help =
            "drill a wider hole within the tolerance, or take a smaller tap or a stronger spindle";
        Diagnostic::error("M0331", self.span, text).with_help(help)
    }

    fn flutes(&self) -> Option<Diagnostic> {
        let (depth, flutes) = (self.depth().value(), self.tap_tool.thread_length.value());
        (depth > flutes + ROUNDING).then(|| {
            let text = format!(
                "T{} {} can cut {} deep before its flutes end, found {}: {} is the deepest that works",
                self.tool.number,
                self.tap_tool.designation,
                self.length(flutes),
                self.length(depth),
                self.word(flutes),
            );
            Diagnostic::error("M0322", self.span, text).with_remedy(self.deep(flutes))
        })
    }

    fn hole_depth(&self, hole: &Drilled) -> Option<Diagnostic> {
        let tip = self.tap.bottom - self.tool.worn_length();
        let too_deep = (hole.full_bottom - tip).value();
        (too_deep > ROUNDING).then(|| {
            let depth = self.depth().value();
            let full = depth - too_deep;
            let point = hole.point.value();
            let text = if full > 0.0 {
                format!(
                    "the tap goes {} deep, but the hole has its full diameter only down to {}: {} is the deepest \
                     that works",
                    self.length(depth),
                    self.length(full),
                    self.word(floor_um(full)),
                )
            } else {
                format!(
                    "the tap goes {} deep, but the hole has its full diameter nowhere: drill it {} deep, of which \
                     {} is the drill's point",
                    self.length(depth),
                    self.length(depth + point),
                    self.length(point),
                )
            };
            let label = format!(
                "drilled {} deep here, of which {} is the drill's point",
                self.length(full + point),
                self.length(point),
            );
            let mut finding = Diagnostic::error("M0323", self.span, text);
            if full > 0.0 {
                finding = finding.with_remedy(self.deep(floor_um(full)));
            }
            finding.with_label(hole.span, label)
        })
    }

    /// A spindle that cannot be stopped at an angle misses its turning point by some of its
    /// stopping angle: a blind hole must have as much below the tap.
    fn stopping_margin(&self, hole: &Drilled) -> Option<Diagnostic> {
        let own = self.own_ramps?;
        let lead = self.tap.lead.abs();
        let stroke = (self.tap.bottom - self.tap.start.along(self.tap.axis).of_linear()).abs();
        let miss = |spin: Spin| own.miss(spin, stroke / lead, lead).value();
        let needed = ceil_um(miss(self.tap.spin));
        let margin = (self.tap.bottom - self.tool.worn_length() - hole.full_bottom).value();
        if margin < -ROUNDING || margin >= needed - ROUNDING {
            return None; // hole_depth() has refused it, or there is room
        }
        let text = format!(
            "S{} may turn back up to {} too deep, and the hole has {} below the tap: {} works, or a hole {} \
             deeper{}",
            number(self.tap.spin.in_rpm()),
            self.length(needed),
            self.length(floor_um(margin)),
            self.word(floor_um(self.depth().value() - (needed - margin))),
            self.length(ceil_um(needed - margin)),
            slower_that_works(self.tap.spin, |spin| miss(spin) <= margin),
        );
        let help = "this spindle's drive is only told a speed: [spindles.drive] says how well its stopping angle is \
                    known (uncertainty_percent) and repeats (repeats_ms, repeats_percent)";
        Some(
            Diagnostic::error("M0336", self.span, text)
                .with_help(help)
                .with_label(hole.span, "drilled here"),
        )
    }

    /// How much deeper than programmed the hole has its full diameter, where this program has
    /// drilled it.
    fn hole_has(&self) -> Option<Length> {
        self.hole.map(|hole| self.tap.bottom - self.tool.worn_length() - hole.full_bottom)
    }

    /// How much deeper than programmed the tap's thread reaches.
    fn flutes_reach(&self) -> Length {
        self.tap_tool.thread_length - self.depth()
    }

    /// How much deeper than programmed there is room for the tap: what its hole has, or by
    /// convention [`BEYOND_PITCHES`] where that is not known, as far as its flutes reach.
    pub(crate) fn room(&self) -> Length {
        let unknown = Length::mm(BEYOND_PITCHES * self.tap_tool.lead.abs().value());
        self.hole_has().unwrap_or(unknown).min(self.flutes_reach()).max(Length::ZERO)
    }

    /// A spindle that coasts when the control dies or the mains fail, deeper than there is room
    /// for.
    fn left_alone(&self, cut: Torque) -> Option<Diagnostic> {
        let Coasts { on_link_loss, on_power_loss } = self.coasts;
        let (when, key) = match (on_link_loss, on_power_loss) {
            (true, true) => ("control dies or the mains fail", "on_link_loss and on_power_loss"),
            (true, false) => ("control dies", "on_link_loss"),
            (false, true) => ("mains fail", "on_power_loss"),
            (false, false) => return None,
        };
        let (lead, spin) = (self.tap.lead, self.tap.spin);
        let deeper = overrun(self.spindle, cut, lead, spin).value();
        let flutes = self.flutes_reach();
        let (room, what) = match self.hole_has() {
            Some(below) if below < flutes => (below.value(), "the hole has"),
            _ => (flutes.value(), "its flutes reach"),
        };
        if room < 0.0 || deeper <= room {
            return None; // too deep as programmed, which is refused, or deep enough for anything
        }
        let slow = survives(self.spindle, cut, lead, Length::mm(room), spin);
        let works = match slow.in_rpm() {
            rpm if rpm >= 10.0 => format!("S{} survives that", number(rpm)),
            _ => "no speed survives that".into(),
        };
        let text = format!(
            "if the {when} in this tap its spindle coasts: from S{} it goes up to {} deeper than programmed, {what} {} more, and the \
             tap breaks; {works}",
            number(spin.in_rpm()),
            self.length(libm::ceil(deeper * 10.0) / 10.0),
            self.length(floor_um(room)),
        );
        // how long a drive's own ramp is is not known well enough to ramp the axis by it
        let brakes = if self.own_ramps.is_some() {
            "\"coupled-stop\""
        } else {
            "\"coupled-stop\" or \"quick-stop\""
        };
        let help = format!("[drives] {key} = {brakes} brakes instead, at every speed");
        Some(Diagnostic::warning("M0338", self.span, text).with_help(help))
    }

    fn hole_diameter(&self, hole: &Drilled) -> Option<Diagnostic> {
        let (nominal, pitch) = (self.tool.diameter.value(), self.tap_tool.lead.abs().value());
        let core = core_range(nominal, pitch);
        let drilled = hole.diameter.value();
        if drilled >= core.0 - ROUNDING && drilled <= core.1 + ROUNDING {
            return None;
        }
        let text = format!(
            "expected a hole of {} to {} for {}, found {}",
            bare_length(self.frame, core.0),
            self.length(core.1),
            self.tap_tool.designation,
            self.length(drilled),
        );
        let finding = if drilled >= nominal {
            Diagnostic::error("M0325", self.span, text)
                .with_help("no thread is left to cut in this hole")
        } else if drilled > core.1 {
            Diagnostic::warning("M0325", self.span, text)
                .with_help("the thread will be too shallow for 6H")
        } else if drilled < tap_core(nominal, pitch) {
            Diagnostic::error("M0325", self.span, text)
                .with_help("the tap's own core does not go into this hole")
        } else {
            Diagnostic::warning("M0325", self.span, text)
                .with_help("the tap cuts too much and may break")
        };
        Some(finding.with_label(hole.span, "drilled here"))
    }
}

/// Core of a tap: d3 = d − 1.226869·P (ISO 724, the root of the external thread).
fn tap_core(nominal_mm: f64, pitch_mm: f64) -> f64 {
    nominal_mm - 1.226_869 * pitch_mm
}

/// Tolerance TD1 of the core, 6H, by pitch: µm by mm (ISO 965-1, table 3).
const CORE_TOLERANCES: [(f64, f64); 9] = [
    (0.5, 140.0),
    (0.7, 180.0),
    (0.8, 200.0),
    (1.0, 236.0),
    (1.25, 265.0),
    (1.5, 300.0),
    (1.75, 335.0),
    (2.0, 375.0),
    (2.5, 450.0),
];

/// Smallest and largest core of a 6H internal thread, mm.
fn core_range(nominal: f64, pitch: f64) -> (f64, f64) {
    let listed = CORE_TOLERANCES.iter().find(|(p, _)| (p - pitch).abs() < 1e-3);
    let tolerance = listed.map_or_else(|| core_tolerance(pitch), |(_, um)| *um);
    let core = nominal - CORE * pitch;
    (core, core + tolerance * 1e-3)
}

/// TD1 of grade 6 by formula, µm: for pitches that the table lacks, such as those in inches.
fn core_tolerance(pitch: f64) -> f64 {
    if pitch <= 0.8 {
        433.0 * pitch - 190.0 * libm::pow(pitch, 1.22)
    } else {
        230.0 * libm::pow(pitch, 0.7)
    }
}

/// Torque of a tap in its hole, or in a hole of nominal diameter less pitch if it is not known.
pub(crate) fn cutting_torque(
    tool: &Tool,
    tap: &TapTool,
    hole: Option<Length>,
    pressure: f64,
) -> Torque {
    let pitch: Lead = tap.lead.abs();
    let drilled = hole.unwrap_or(tool.diameter - Length::mm(pitch.value()));
    tapping_torque(tool.diameter, drilled, tap.flute, pressure)
}

/// Torque from which on a tap is taken out of its hole: stated, or a share of what breaks it.
pub(crate) fn torque_limit(tool: &Tool, tap: &TapTool) -> Torque {
    tap.max_torque.unwrap_or_else(|| tap_strength(tool.diameter) * BEARS_SHARE)
}

/// The highest speed below this one, in tens of rpm, that works; nothing where none does.
fn slower_that_works(spin: Spin, works: impl Fn(Spin) -> bool) -> String {
    let tens = libm::floor(spin.in_rpm() / 10.0) as u32;
    let slower = (1..tens).rev().map(|ten| f64::from(ten) * 10.0);
    let found = slower.into_iter().find(|rpm| works(Spin::rpm(*rpm)));
    found.map_or_else(String::new, |rpm| format!(", or S{}", number(rpm)))
}

/// A speed that still works, in whole rpm.
pub(crate) fn whole_rpm(spin: Spin) -> f64 {
    // a bound such as 6000 rpm may have become 5999.999… on its way through rev/s
    libm::floor(spin.in_rpm() + 1e-6)
}

/// A depth that still works, rounded down to whole micrometres.
fn floor_um(depth: f64) -> f64 {
    libm::floor(depth * 1e3 + 1e-6) / 1e3
}

/// A depth that is needed, rounded up to whole micrometres.
fn ceil_um(depth: f64) -> f64 {
    libm::ceil(depth * 1e3 - 1e-6) / 1e3
}
