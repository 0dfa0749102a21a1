//! A turned thread, as it is told to people and files.
use super::inspection::Inspected;
use super::law::Law;
use super::size::TurnedLimits;
use super::sizes::TurnedSizes;
use crate::gauge::Gauge;
use crate::insert::Side;
use canon::{Axis, Hand};
use units::{Angle, Force, Lead, LeadGrowth, Length, Spin, Torque};

/// A thread that was turned with a single point, in one or more passes.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedThread {
    /// Advance along its axis for each revolution, without sign, where the longest of its blocks
    /// begins.
    pub lead: Lead,
    /// By how much that grows with each revolution of that block; negative where it shrinks.
    pub growth: LeadGrowth,
    /// Turn by turn, where the lead is not the same everywhere; of the last pass.
    pub leads: Vec<LeadOfTurn>,
    /// Where the spindle stood when the last pass was where it begins, as it was cut: in (−½, ½]
    /// turns.
    pub start_angle: Angle,
    /// Which way it winds.
    pub hand: Hand,
    /// The axis along which it runs.
    pub axis: Axis,
    /// Machine coordinate of the tip along `axis` where the material begins.
    pub surface: Length,
    /// Likewise at its end.
    pub end: Length,
    /// Passes that were cut.
    pub passes: u32,
    /// Passes that the program orders.
    pub passes_ordered: u32,
    /// Fastest that the spindle turned in the material.
    pub spin_max: Spin,
    /// Largest distance from the helix in the material, magnitude.
    pub sync_error_max: Length,
    /// Its root mean square.
    pub sync_error_rms: Length,
    /// Error of the lead over the thread's length, signed: positive is longer.
    pub lead_error: Length,
    /// Largest mean distance from the helix of a pass less the smallest.
    pub pass_spread: Length,
    /// Mean distance from the helix of each pass that was cut.
    pub pass_means: Vec<Length>,
    /// Largest distance from the ordered infeed in the deepest pass.
    pub infeed_error: Length,
    /// Of the pass with the largest error, along the thread from the surface on: depth and distance
    /// from the helix.
    pub profile: Vec<[Length; 2]>,
    /// In a bore, not on a shaft.
    pub internal: bool,
    /// Starts: grooves side by side.
    pub starts: u32,
    /// The standard thread that it was taken for, such as "M20x1.5"; `None`: there is none of this
    /// pitch and diameter.
    pub size: Option<String>,
    /// Class asked of it, such as "6g"; empty without a standard size.
    pub class: &'static str,
    /// Diameter of the bar, or of the bore, before the first pass; `None` where the work is no bar.
    pub before: Option<Length>,
    /// The insert, and where its form was taken from.
    pub insert: String,
    /// Share of the ordered length in which the point was in the material, in the pass that cut
    /// most; `None` where it is not known.
    pub contact: Option<f64>,
    /// Deepest that the point was below the bar or bore, radial; negative: it passed it by so much.
    pub groove_depth: Option<Length>,
    /// What was measured of its form; `None` where nothing could be.
    pub sizes: Option<TurnedSizes>,
    /// Limits of its standard size.
    pub limits: Option<TurnedLimits>,
    /// Largest force of the cut, where it can be known.
    pub force_max: Option<Force>,
    /// Largest torque of the cut on the spindle, likewise.
    pub torque_max: Option<Torque>,
    /// Way at its beginning in which the axis came to its speed, and which was left out because
    /// nothing says that the thread begins behind it; zero where a bar does.
    pub run_in: Length,
    /// What was not judged, and why; empty: everything was.
    pub not_judged: String,
    /// Machine Z, and radius before and after, in an axial section.
    pub section: Vec<[Length; 3]>,
}

/// The lead of one turn of a thread, without sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadOfTurn {
    /// Depth below the surface at which it begins.
    pub depth: Length,
    /// As it was ordered.
    pub ordered: Lead,
    /// As it was cut.
    pub cut: Lead,
}

impl TurnedThread {
    /// What is known of the bar, and nothing else yet.
    pub(super) fn of_bar(inspected: Option<&Inspected>, law: Option<&Law<'_>>) -> Self {
        let standard = inspected.and_then(|found| found.standard.as_ref());
        Self {
            lead: Lead::mm_per_rev(0.0),
            growth: LeadGrowth::ZERO,
            leads: Vec::new(),
            start_angle: Angle::ZERO,
            hand: Hand::Right,
            axis: Axis::Z,
            surface: Length::ZERO,
            end: Length::ZERO,
            passes: 0,
            passes_ordered: 0,
            spin_max: Spin::rev_per_s(0.0),
            sync_error_max: Length::ZERO,
            sync_error_rms: Length::ZERO,
            lead_error: Length::ZERO,
            pass_spread: Length::ZERO,
            pass_means: Vec::new(),
            infeed_error: Length::ZERO,
            profile: Vec::new(),
            internal: inspected.is_some_and(|found| found.side == Side::Internal),
            starts: inspected.map_or(1, |found| found.starts),
            size: standard.map(|standard| standard.thread.designation.clone()),
            class: standard.map_or("", |standard| standard.class),
            before: inspected.map(|found| found.before),
            insert: inspected.map_or_else(String::new, |found| found.form.in_words()),
            contact: inspected.map(|found| found.contact.share()),
            groove_depth: inspected
                .map(|found| found.contact.deepest)
                .filter(|depth| depth.is_finite())
                .map(Length::mm),
            sizes: inspected.and_then(|found| found.sizes.clone()),
            limits: standard.map(|standard| standard.limits),
            force_max: None,
            torque_max: None,
            run_in: Length::ZERO,
            not_judged: super::verdict::not_judged(law, inspected).unwrap_or_default(),
            section: inspected.map_or_else(Vec::new, |found| found.section.clone()),
        }
    }

    /// Such as "turned thread 1.500 left", "turned thread 2.000 growing 0.050 a turn".
    pub fn name(&self) -> String {
        let hand = if self.hand == Hand::Left { " left" } else { "" };
        let growth = self.growth.value();
        let changes = match growth {
            0.0 => String::new(),
            _ if growth > 0.0 => format!(" growing {growth:.3} a turn"),
            _ => format!(" shrinking {:.3} a turn", -growth),
        };
        format!("turned thread {:.3}{changes}{hand}", self.lead.value())
    }

    /// For people: "lead 2 mm growing 0.05 mm a turn".
    pub fn lead_in_words(&self) -> String {
        let (lead, growth) = (rounded(self.lead.value()), rounded(self.growth.value()));
        if growth == 0.0 {
            return format!("lead {lead} mm");
        }
        let changes = if growth > 0.0 { "growing" } else { "shrinking" };
        format!("lead {lead} mm {changes} {} mm a turn", growth.abs())
    }

    /// Such as "M20x1.5-6g", "M20x1.5-6g-LH"; empty without a standard size.
    pub fn class_and_size(&self) -> String {
        let hand = if self.hand == Hand::Left { "-LH" } else { "" };
        self.size.as_ref().map_or_else(String::new, |size| format!("{size}-{}{hand}", self.class))
    }

    /// Distances of the pitch diameters from their limits: the virtual one from Go, the simple one
    /// from No-go.
    fn margins(&self) -> Option<[Length; 2]> {
        let (sizes, limits) = (self.sizes.as_ref()?, self.limits.as_ref()?);
        Some(if self.internal {
            [sizes.virtual_pitch - limits.pitch[0], limits.pitch[1] - sizes.pitch[1]]
        } else {
            [limits.pitch[1] - sizes.virtual_pitch, sizes.pitch[0] - limits.pitch[0]]
        })
    }

    /// The smaller one of them; negative is out.
    pub fn pitch_margin(&self) -> Option<Length> {
        self.margins().map(|[go, no_go]| go.min(no_go))
    }

    /// Which gauge leaves it.
    pub fn limiting_gauge(&self) -> Gauge {
        match self.margins() {
            Some([go, no_go]) if no_go < go => Gauge::NoGo,
            _ => Gauge::Go,
        }
    }

    /// The turn whose lead is farthest off.
    pub fn worst_turn(&self) -> Option<&LeadOfTurn> {
        let off = |turn: &LeadOfTurn| (turn.cut - turn.ordered).abs().value();
        self.leads.iter().max_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// From where the material begins to the end.
    pub fn length(&self) -> Length {
        (self.end - self.surface).abs()
    }
}

/// To a hundredth of a micrometre.
fn rounded(mm: f64) -> f64 {
    (mm * 1e5).round() / 1e5
}
