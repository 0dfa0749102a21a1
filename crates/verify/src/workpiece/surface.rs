//! Where the material begins under a tool: at the stock's top, or below what was milled or bored
//! away there.
//!
//! ```text
//!   top ──┐  ┌──────┐  ┌──    a drill     highest of the mill's grid on a circle just outside of all
//!         │  │ pocket   │                 that was bored there
//!   floor ┴──┘   or     └──   a tap       deepest of a circle between its bore and its
//!            counterbore                  nominal diameter, or of one at its nominal diameter where
//!                                         that is open to a side
//! ```
//!
//! A bore wider than the drill or the thread is air, too.
//!
//! A grid is as fine as the smallest mill so far: a circle nearer than a cell to a bore would be
//! taken for air.
use super::places::NOISE_MM;
use super::{Bore, MOUTH_PITCHES, Workpiece};
use crate::milling::Milling;
use std::f64::consts::TAU;

/// Places that are looked at on a circle.
const PLACES: usize = 40;
/// Cells that a circle keeps away from a bore: half the diagonal of a cell, and a little.
const CELLS_APART: f64 = 0.75;
/// Part of a circle that a drill meets first.
const SHARE_MET: f64 = 0.15;
/// Part of a thread's circle that must be there: all but one place ...
const SHARE_THERE: f64 = 0.975;
/// ... or half of it, where a cell is larger than this share of the thread's radius.
const COARSE: f64 = 0.2;

/// Where the material begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Surface {
    /// Coordinate of the tip.
    pub(crate) top_mm: f64,
    /// How far that is below the stock's top.
    pub(crate) lowered_mm: f64,
    /// The line of the bore that has taken it away; `None`: it was milled.
    pub(crate) line: Option<u32>,
}

/// What comes down on it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Under {
    /// A drill or mill of this radius, mm.
    Drill { radius: f64 },
    /// A tap: its ring, its pitch, and the coordinate that its tip is ordered to reach.
    Tap { ring: [f64; 2], pitch_mm: f64, bottom_mm: f64 },
}

impl Workpiece {
    /// Where the material begins under a tool at this place.
    pub(crate) fn surface(
        &self,
        top_mm: f64,
        at: [f64; 2],
        under: Under,
        milling: &Milling,
    ) -> Surface {
        let here = || self.bores().filter(|bore| bore.is_about(at));
        let cell = CELLS_APART * milling.cell();
        let (radius, share) = match under {
            Under::Drill { radius } => {
                let widest = here().map(Bore::radius).fold(radius, f64::max);
                (widest + cell + NOISE_MM, SHARE_MET)
            }
            Under::Tap { ring: [inner, outer], .. } => {
                let is_coarse = milling.cell() > COARSE * outer;
                let share = if is_coarse { 0.5 } else { SHARE_THERE };
                (f64::midpoint(inner, outer).max(inner + cell), share)
            }
        };
        let mut milled = milling.top_around(at, radius, share).filter(|milled| *milled < top_mm);
        if let Under::Tap { ring: [_, outer], pitch_mm, .. } = under
            && let Some(side) = milling.top_around(at, (outer - cell).max(radius), share)
            && side < milled.unwrap_or(top_mm) - MOUTH_PITCHES * pitch_mm
        {
            milled = Some(side); // its roots are in the air
        }
        let mut surface = Surface { top_mm: milled.unwrap_or(top_mm), lowered_mm: 0.0, line: None };
        if let Under::Tap { ring: [inner, outer], pitch_mm, bottom_mm } = under {
            for bore in here().filter(|bore| bore.radius() > inner + NOISE_MM) {
                let is_wide = bore.radius() >= outer - NOISE_MM;
                let width = (bore.radius().min(outer) - 2.0 * NOISE_MM).max(0.0);
                let Some(level) = bore.cut.level(width) else { continue };
                let is_mouth = surface.top_mm - level <= MOUTH_PITCHES * pitch_mm;
                // a bore that is too wide all the way down is measured as the thread's own
                let is_own = !is_wide && bore.bottom_mm <= bottom_mm;
                if !is_mouth && !is_own {
                    (surface.top_mm, surface.line) = (level, Some(bore.line));
                }
            }
        }
        if let Under::Drill { radius } = under {
            let wider = here().filter(|bore| !bore.is_spot && bore.radius() > radius + NOISE_MM);
            let levels = wider.filter_map(|bore| bore.cut.level(radius).zip(Some(bore.line)));
            for (level, line) in levels {
                if level < surface.top_mm {
                    (surface.top_mm, surface.line) = (level, Some(line));
                }
            }
        }
        surface.lowered_mm = (top_mm - surface.top_mm).max(0.0);
        surface
    }
}

impl Milling {
    /// Coordinate down to which a share of a circle is milled away, at least; `None`: nothing was
    /// milled.
    pub(crate) fn top_around(&self, at: [f64; 2], radius: f64, share: f64) -> Option<f64> {
        let mut tops = self.tops_around(at, radius)?;
        tops.sort_by(|a, b| b.total_cmp(a));
        let last = tops.len().checked_sub(1)?;
        tops.get((share * last as f64).round() as usize).copied()
    }

    /// Coordinates of the material on a circle, where the block is.
    fn tops_around(&self, at: [f64; 2], radius: f64) -> Option<Vec<f64>> {
        let field = self.field()?;
        let top = field.stock().top().value();
        let tops = (0..PLACES).filter_map(|k| {
            let (sin, cos) = (TAU * k as f64 / PLACES as f64).sin_cos();
            let depth = field.depth([at[0] + radius * cos, at[1] + radius * sin])?;
            depth.is_finite().then_some(top - depth)
        });
        Some(tops.collect())
    }

    /// Radius of the bore that was milled down to a coordinate, as far as a radius, and how far it
    /// may be off; `None`: its middle is not away.
    pub(crate) fn bored(&self, at: [f64; 2], most: f64, bottom_mm: f64) -> Option<[f64; 2]> {
        let is_away = |radius: f64| {
            let tops = self.tops_around(at, radius);
            tops.is_some_and(|tops| !tops.is_empty() && tops.iter().all(|top| *top <= bottom_mm))
        };
        let step = (self.cell() / 4.0).max(NOISE_MM);
        let steps = (most / step).ceil().min(1e4) as u32;
        let open = (0..=steps).map_while(|k| Some(f64::from(k) * step).filter(|r| is_away(*r)));
        Some([open.last()?, self.cell()])
    }
}
