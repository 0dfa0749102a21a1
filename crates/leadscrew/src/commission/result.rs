//! What commissioning found: values with their intervals, and what they mean.
use super::least_squares::Estimate;
use super::motion::{AxisSignals, Window};
use report::CommissionPicture;
use store::machine::Axis;

/// A value that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredValue {
    /// Key of the machine's file; empty: it follows from others.
    pub key: String,
    /// What it is.
    pub name: String,
    /// Its unit; empty: a number.
    pub unit: &'static str,
    /// The value with half its 95 % interval.
    pub value: Estimate,
    /// What the file says; `None`: nothing.
    pub old: Option<f64>,
    /// What the difference means at the tool, µm.
    pub effect_um: Option<f64>,
    /// How that is computed.
    pub effect_of: &'static str,
    /// By what it was measured.
    pub by: &'static str,
}

impl MeasuredValue {
    pub(crate) fn with(self, um: f64, of: &'static str) -> Self {
        Self { effect_um: Some(um), effect_of: of, ..self }
    }

    /// Difference from the file's value, as a share of it.
    pub fn difference(&self) -> Option<f64> {
        self.old.filter(|old| *old != 0.0).map(|old| self.value.value / old - 1.0)
    }
}

/// How far and how hard an axis was moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisExcursion {
    /// Its letter.
    pub letter: char,
    /// Where it was, mm.
    pub from_mm: f64,
    /// Where it was, mm.
    pub to_mm: f64,
    /// Where it may be, mm.
    pub window: Window,
    /// Largest force that was asked for, as a share of the drive's peak.
    pub force_share: f64,
    /// Largest following error, µm.
    pub following_um: f64,
}

impl AxisExcursion {
    pub(crate) fn of(letter: char, heard: &AxisSignals, axis: &Axis, window: Window) -> Self {
        let all = |values: &[f64], least: f64, pick: fn(f64, f64) -> f64| {
            values.iter().copied().fold(least, pick)
        };
        let asked = heard.asked_n.iter().map(|force| force.abs()).fold(0.0, f64::max);
        let off = heard.setpoint_mm.iter().zip(&heard.position_mm).map(|(a, b)| (a - b).abs());
        Self {
            letter,
            from_mm: all(&heard.position_mm, f64::MAX, f64::min),
            to_mm: all(&heard.position_mm, f64::MIN, f64::max),
            window,
            force_share: asked / axis.drive.peak_force().value(),
            following_um: off.fold(0.0, f64::max) * 1e3,
        }
    }
}

/// What a step found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepResult {
    /// Its name.
    pub step: &'static str,
    /// Values.
    pub findings: Vec<MeasuredValue>,
    /// What could not be judged, and why.
    pub not_judged: Vec<String>,
    /// Alarms that ended a part of it.
    pub alarms: Vec<String>,
    /// How far and how hard was moved.
    pub moved: Vec<AxisExcursion>,
    /// What is drawn.
    pub pictures: Vec<CommissionPicture>,
    /// Machine time, s.
    pub lasts_s: f64,
}

impl StepResult {
    /// True where nothing was left unjudged and no alarm ended a part.
    pub fn is_whole(&self) -> bool {
        self.not_judged.is_empty() && self.alarms.is_empty()
    }

    pub(crate) fn new(step: &'static str) -> Self {
        Self { step, ..Self::default() }
    }
}
