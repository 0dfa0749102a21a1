//! How a mill is in the material, over a short way: depth, width, angle, chip.
//!
//! ```text
//!            ← D →            across the way, in bins: what each has removed        width   Σ of the bins that cut
//!          ╭───────╮                                                                angle   Σ (φ(b) − φ(a)) over them,
//!      way │   ▲   │  ae      ▁▁▁▁▁▁████                                                    φ(y) = acos(−2y/D)
//!          │   │   │──┤       │ air  │ cut │
//!          ╰───────╯
//! ```
//!
//! Closed forms that this meets: a slot has width D and 180°; a shoulder of width ae has acos(1 −
//! 2·ae/D).
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | D, z | diameter, teeth | mm, 1 |
//! | n, f | speed of the spindle, feed | rev/s, mm/s |
//! | ap, ae, φ | axial depth, radial width, angle of engagement | mm, mm, rad |
//! | fz = f/(n·z) | feed a tooth | mm |
//! | h = fz·sin φ, below 90° | largest thickness of the chip (chip thinning); fz from 90° on | mm |
use super::field::Cell;
use units::Time;

/// A bin cuts from this share of depth · width · way on.
const LEAST_SHARE: f64 = 0.03;

/// Cells within the cutter's radius that say nothing.
const RIM: f64 = 1.5;

/// What was removed over a way.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    radius: f64,
    cell: f64,
    /// Removed by bin across the way, mm³.
    bins: Vec<f64>,
    /// Volume that was removed, mm³.
    volume: f64,
    /// Way across the tool, and all of it, mm.
    across: f64,
    way: f64,
    /// How deep the tip was below the material that it met, mm; the outermost [`RIM`] cells do not
    /// count: whether a wall stands there is within the error of the grid.
    deepest: f64,
    time: f64,
    turns: f64,
}

/// A mill in the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToolEngagement {
    /// ap, mm.
    pub(crate) depth: f64,
    /// ae, mm; `None`: it goes along its axis.
    pub(crate) width: Option<f64>,
    /// φ, rad.
    pub(crate) angle: Option<f64>,
    /// mm³/s.
    pub(crate) removal: f64,
    /// Speed of the spindle, rev/s; positive: forwards.
    pub(crate) spin: f64,
    /// Feed per turn, mm; `None`: the spindle stands.
    pub(crate) per_turn: Option<f64>,
}

impl Window {
    pub(crate) fn new(radius: f64, cell: f64) -> Self {
        let bins = ((2.0 * radius / cell).floor() as usize).clamp(4, 256);
        Self {
            radius,
            cell,
            bins: vec![0.0; bins],
            volume: 0.0,
            across: 0.0,
            way: 0.0,
            deepest: 0.0,
            time: 0.0,
            turns: 0.0,
        }
    }

    pub(crate) const fn way(&self) -> f64 {
        self.way
    }

    /// The tool has gone this way (X, Y, Z) in this time, while its spindle turned.
    pub(crate) fn went(&mut self, way: [f64; 3], time: Time, turns: f64) {
        self.across += way[0].hypot(way[1]);
        self.way += way[0].hypot(way[1]).hypot(way[2]);
        self.time += time.value();
        self.turns += turns;
    }

    /// A cell was cut while the tool went in this direction.
    pub(crate) fn cut(&mut self, cell: Cell, direction: [f64; 2]) {
        let volume = cell.removed * self.cell * self.cell;
        self.volume += volume;
        let y = cell.at[1] * direction[0] - cell.at[0] * direction[1];
        if y.abs() <= self.radius - RIM * self.cell {
            self.deepest = self.deepest.max(cell.below);
        }
        // the cell's width, shared out between the bins that it lies over
        let bin = 2.0 * self.radius / self.bins.len() as f64;
        let half = self.cell / 2.0;
        let [low, high] = [y - half, y + half].map(|y| (y + self.radius) / bin);
        let last = self.bins.len() - 1;
        let place = |at: f64| (at.floor().max(0.0) as usize).min(last);
        for k in place(low)..=place(high) {
            let (from, to) = (
                if k == 0 { low } else { k as f64 },
                if k == last { high } else { k as f64 + 1.0 },
            );
            let share = (high.min(to) - low.max(from)).max(0.0) / (high - low);
            self.bins[k] += volume * share;
        }
    }

    /// What it was, and begin anew; `None`: nothing was cut that the grid can tell.
    pub(crate) fn take(&mut self) -> Option<ToolEngagement> {
        let fresh = Self::new(self.radius, self.cell);
        let Self { bins, volume, across, way, deepest, time, turns, radius, .. } =
            std::mem::replace(self, fresh);
        if deepest <= 0.0 || time <= 0.0 || way <= 0.0 {
            return None;
        }
        let bin = 2.0 * radius / bins.len() as f64;
        let least = LEAST_SHARE * deepest * bin * across;
        let mut width = 0.0;
        let mut angle = 0.0;
        let phi = |y: f64| (-y / radius).clamp(-1.0, 1.0).acos();
        for (k, removed) in bins.iter().enumerate() {
            if *removed > least {
                let from = k as f64 * bin - radius;
                width += bin;
                angle += phi(from + bin) - phi(from);
            }
        }
        // steeper than 1 in 4 it goes along its axis
        let plunges = across < 0.25 * way;
        let is_still = turns.abs() < 1e-3 * (1.0 + time);
        Some(ToolEngagement {
            depth: deepest,
            width: (!plunges && width > 0.0).then_some(width),
            angle: (!plunges && width > 0.0).then_some(angle),
            removal: volume / time,
            spin: turns / time,
            per_turn: (!is_still).then(|| way / turns.abs()),
        })
    }
}

impl ToolEngagement {
    /// fz and h of a mill with so many teeth, mm.
    pub(crate) fn chip(&self, teeth: u32) -> Option<(f64, f64)> {
        let per_tooth = self.per_turn? / f64::from(teeth);
        let thinned = match self.angle {
            Some(angle) if angle < std::f64::consts::FRAC_PI_2 => per_tooth * angle.sin(),
            _ => per_tooth,
        };
        Some((per_tooth, thinned))
    }

    /// Largest tangential force of a mill with so many teeth, N: each tooth in the cut at its
    /// largest chip, over the whole depth. `kc`: N/mm².
    pub(crate) fn force(&self, teeth: u32, kc: f64) -> Option<f64> {
        let (_, chip) = self.chip(teeth)?;
        let spacing = std::f64::consts::TAU / f64::from(teeth);
        let cutting = (self.angle? / spacing).ceil().max(1.0);
        Some(kc * self.depth * chip * cutting)
    }
}

/// Deflection of a cantilever by a force at its tip, mm: F·L³/(3·E·I), I = π·d⁴/64 with d = 0.8·D
/// for the flutes.
pub(crate) fn deflection(force: f64, length: f64, diameter: f64, modulus: f64) -> f64 {
    let stiff = 0.8 * diameter;
    let inertia = std::f64::consts::PI * stiff.powi(4) / 64.0;
    force * length.powi(3) / (3.0 * modulus * inertia)
}
