//! How a polygon changes along Z: taper and twist, from its cross-sections.
use super::Section;
use units::{Angle, Length};

/// How a polygon changes with each millimetre towards positive Z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Along {
    /// A taper.
    pub across_flats: Length,
    /// A twist.
    pub turn: Angle,
}

impl Along {
    /// As cut, with the size of each section.
    pub(super) fn cut(sections: &[Section], size: &dyn Fn(&Section) -> f64) -> Self {
        let tilt = |s: &Section| {
            s.facets.iter().map(|f| f.tilt.value()).sum::<f64>() / s.facets.len().max(1) as f64
        };
        let turn: Vec<f64> =
            stands(sections).iter().zip(sections).map(|(turn, s)| turn + tilt(s)).collect();
        Self::of(sections, size, &turn)
    }

    /// As ordered.
    pub(super) fn ordered(sections: &[Section], size: &dyn Fn(&Section) -> f64) -> Self {
        Self::of(sections, size, &stands(sections))
    }

    fn of(sections: &[Section], size: &dyn Fn(&Section) -> f64, turns: &[f64]) -> Self {
        let sizes: Vec<f64> = sections.iter().map(size).collect();
        Self {
            across_flats: Length::mm(slope(sections, &sizes)),
            turn: Angle::rev(slope(sections, turns)),
        }
    }
}

/// Where the first facet was ordered to stand in each section, turns, without jumps.
fn stands(sections: &[Section]) -> Vec<f64> {
    let mut before = 0.0;
    let turn = |section: &Section| {
        let now = section.facets.first().map_or(0.0, |f| f.normal.value());
        let off = now - before;
        before += off - f64::round(off);
        before
    };
    sections.iter().map(turn).collect()
}

/// Slope over Z of a figure of each section, by least squares; zero of one section.
fn slope(sections: &[Section], figures: &[f64]) -> f64 {
    let count = sections.len() as f64;
    let mean_z = sections.iter().map(|s| s.z.value()).sum::<f64>() / count;
    let mean = figures.iter().sum::<f64>() / count;
    let (mut top, mut bottom) = (0.0, 0.0);
    for (section, figure) in sections.iter().zip(figures) {
        let z = section.z.value() - mean_z;
        (top, bottom) = (top + z * (figure - mean), bottom + z * z);
    }
    if bottom > 0.0 { top / bottom } else { 0.0 }
}
