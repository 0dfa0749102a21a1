//! The machine: what a page must know of it.
use super::RequestNeeds;
use serde::Serialize;
use store::machine::MachineFile;

/// An axis.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct MachineAxis {
    /// Its letter.
    pub letter: char,
    /// `linear`, `rotary`.
    pub kind: &'static str,
    /// `mm`, `deg`.
    pub unit: &'static str,
    /// Machine coordinate of one end of its travel.
    pub travel_from: f64,
    /// Machine coordinate of the other.
    pub travel_to: f64,
    /// Fastest: units per minute.
    pub rapid_per_min: f64,
    /// Speed of increments, and the fastest as long as it is not homed: units per minute.
    pub approach_per_min: f64,
}

/// A spindle.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct MachineSpindle {
    /// Its name.
    pub name: String,
    /// Fastest.
    pub max_rpm: f64,
}

/// What an override may be turned to.
#[derive(Clone, Copy, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct OverrideRange {
    /// Least.
    pub least_percent: f64,
    /// Most.
    pub most_percent: f64,
}

/// What the overrides may be turned to.
#[derive(Clone, Copy, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct OverrideRanges {
    /// Of the feed.
    pub feed: OverrideRange,
    /// Of rapids.
    pub rapid: OverrideRange,
    /// Of the spindle's speed.
    pub spindle: OverrideRange,
}

/// A block of material, in coordinates of G54.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct StockBody {
    /// What it is made of.
    pub material: String,
    /// Corner at the negative ends, mm.
    pub from: [f64; 3],
    /// Corner at the positive ends, mm; its Z is the surface.
    pub to: [f64; 3],
    /// Diameter of a bore along Z through its middle, mm; 0: it is solid.
    pub bore_mm: f64,
}

/// The machine.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct MachineBody {
    /// Its name.
    pub name: String,
    /// What it is.
    pub description: String,
    /// Its first spindle turns the work, a bar.
    pub is_lathe: bool,
    /// Servo period.
    pub period_s: f64,
    /// Its axes, X first.
    pub axes: Vec<MachineAxis>,
    /// Its spindles, the main one first.
    pub spindles: Vec<MachineSpindle>,
    /// What its overrides may be turned to.
    pub overrides: OverrideRanges,
    /// The workpiece as it is clamped.
    pub stock: Option<StockBody>,
    /// Names of the signals that a scope shows.
    pub signals: Vec<String>,
    /// What each request needs.
    pub requests: Vec<RequestNeeds>,
}

impl MachineBody {
    /// Of a machine's file.
    pub(crate) fn of(machine: &MachineFile, signals: &[String]) -> Self {
        let axis = |axis: &store::machine::Axis| {
            let kind = axis.letter.kind();
            MachineAxis {
                letter: axis.letter.letter(),
                kind: kind.name(),
                unit: kind.unit_name(),
                travel_from: axis.travel.from.value(),
                travel_to: axis.travel.to.value(),
                rapid_per_min: axis.rapid.in_per_min(),
                approach_per_min: axis.approach.speed.in_per_min(),
            }
        };
        let spindle = |spindle: &store::machine::Spindle| MachineSpindle {
            name: spindle.name.clone(),
            max_rpm: spindle.max.in_rpm(),
        };
        let range = |least: f64, most: f64| OverrideRange {
            least_percent: least * 100.0,
            most_percent: most * 100.0,
        };
        let overrides = &machine.control.overrides;
        let stock = &machine.setup.stock;
        let corner = |corner: [units::Length; 3]| corner.map(units::Length::value);
        Self {
            name: machine.name.clone(),
            description: machine.description.clone(),
            is_lathe: machine.is_lathe,
            period_s: machine.control.period.value(),
            axes: machine.axes.iter().flatten().map(axis).collect(),
            spindles: machine.spindles.iter().map(spindle).collect(),
            overrides: OverrideRanges {
                feed: range(0.0, overrides.feed_most_share),
                rapid: range(0.0, 1.0),
                spindle: range(overrides.spindle_least_share, overrides.spindle_most_share),
            },
            stock: Some(StockBody {
                material: stock.material.name().to_owned(),
                from: corner(stock.from),
                to: corner(stock.to),
                bore_mm: stock.bore.value(),
            }),
            signals: signals.to_vec(),
            requests: RequestNeeds::all(),
        }
    }
}
