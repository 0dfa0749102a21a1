//! A cross-section at one height: profiles of facets, from the passes that reached there.
use super::passes::Pass;
use super::zone::{Zone, minimum_zone};
use super::{Facet, Section};
use units::{Angle, Length};

/// Places along a facet.
const PLACES: usize = 121;
/// A pass leaves nothing where its nose is this far above the surface, mm: others were deeper.
const NOSE_REACH: f64 = 0.05;

/// A facet in its own coordinates, mm.
struct Raw {
    normal: f64,
    /// Height of the surface at equally spaced places from −half to +half; `NaN` where nothing cut.
    heights: Vec<f64>,
    half: f64,
}

impl Raw {
    fn place(&self, index: usize) -> f64 {
        self.half * (2.0 * index as f64 / (PLACES - 1) as f64 - 1.0)
    }

    /// Profile from one place to another, both included by interpolation.
    fn between(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let inside = (0..PLACES)
            .map(|i| [self.place(i), self.heights[i]])
            .filter(|p| p[0] > from + 1e-9 && p[0] < to - 1e-9 && !p[1].is_nan());
        let end = |s: f64| self.at(s).map(|n| [s, n]);
        end(from).into_iter().chain(inside).chain(end(to)).collect()
    }

    fn at(&self, s: f64) -> Option<f64> {
        let x = f64::midpoint(s / self.half, 1.0) * (PLACES - 1) as f64;
        let i = (x.floor().max(0.0) as usize).min(PLACES - 2);
        let n = self.heights[i] + (x - i as f64) * (self.heights[i + 1] - self.heights[i]);
        (!n.is_nan() && (-1e-6..=(PLACES - 1) as f64 + 1e-6).contains(&x)).then_some(n)
    }
}

/// A height is cut by these passes, nearest in z first, of the facet with this normal.
pub(super) struct Cutters<'p> {
    pub(super) normal_rad: f64,
    pub(super) passes: Vec<&'p Pass>,
}

/// How high a nose of radius `nose` stands over the point it leaves, at a distance; `None` out of
/// reach.
pub(super) fn nose_height(nose: f64, distance: f64) -> Option<f64> {
    if nose <= 0.0 {
        return (distance.abs() < 0.5).then_some(0.0); // no nose stated: as if the edge were parallel to Z
    }
    let inside = nose * nose - distance * distance;
    (inside > 0.0).then(|| nose - inside.sqrt()).filter(|h| *h < NOSE_REACH)
}

/// The surface at one place of a facet: height, or `NaN` if nothing cut there.
pub(super) fn surface(cutters: &Cutters<'_>, z: f64, nose: f64, places: &[f64]) -> Vec<f64> {
    let mut heights = vec![f64::NAN; places.len()];
    let (sine, cosine) = cutters.normal_rad.sin_cos();
    for pass in &cutters.passes {
        let Some(above) = nose_height(nose, z - pass.z()) else { continue };
        let turned = |p: &[f64; 2]| [p[1] * cosine - p[0] * sine, p[0] * cosine + p[1] * sine];
        for pair in pass.points.windows(2) {
            let (a, b) = (turned(&pair[0]), turned(&pair[1]));
            let (low, high) = if a[0] < b[0] { (a, b) } else { (b, a) };
            let from = places.partition_point(|s| *s < low[0]);
            for (place, height) in places[from..].iter().zip(&mut heights[from..]) {
                if *place > high[0] {
                    break;
                }
                let part = (place - low[0]) / (high[0] - low[0]).max(1e-12);
                let n = low[1] + part * (high[1] - low[1]) + above;
                if height.is_nan() || n < *height {
                    *height = n;
                }
            }
        }
    }
    heights
}

/// Measure a height. Facets in the order of their normals; `None` if one of them was not cut.
pub(super) fn measure(
    z: f64,
    facets: &[Cutters<'_>],
    nose: f64,
    stock_radius: f64,
) -> Option<Section> {
    let raws: Vec<Raw> = facets
        .iter()
        .map(|cutters| {
            let half = stock_radius;
            let places: Vec<f64> =
                (0..PLACES).map(|i| half * (2.0 * i as f64 / (PLACES - 1) as f64 - 1.0)).collect();
            let rough = surface(cutters, z, nose, &places);
            Raw { normal: cutters.normal_rad, heights: rough, half }
        })
        .collect();
    // first where they end, roughly; then finely between those ends
    let rough: Vec<Zone> = raws.iter().map(middle_zone).collect::<Option<_>>()?;
    let mut measured = Vec::new();
    for (k, cutters) in facets.iter().enumerate() {
        let ends = corners(&raws, &rough, k, stock_radius)?;
        let half = ends[0].abs().max(ends[1].abs()) * 1.02;
        let places: Vec<f64> =
            (0..PLACES).map(|i| half * (2.0 * i as f64 / (PLACES - 1) as f64 - 1.0)).collect();
        let raw =
            Raw { normal: cutters.normal_rad, heights: surface(cutters, z, nose, &places), half };
        measured.push((raw, ends));
    }
    let facets = measured.iter().map(|(raw, ends)| facet(raw, *ends)).collect::<Option<_>>()?;
    Some(Section { z: Length::mm(z), facets })
}

/// The line through the middle of a rough profile.
fn middle_zone(raw: &Raw) -> Option<Zone> {
    let known: Vec<[f64; 2]> =
        (0..PLACES).map(|i| [raw.place(i), raw.heights[i]]).filter(|p| !p[1].is_nan()).collect();
    let lowest = known.iter().min_by(|a, b| a[1].total_cmp(&b[1]))?;
    Some(Zone { middle: lowest[1], slope: 0.0, width: 0.0 })
}

/// Where a facet meets its neighbours: first where their middle lines meet, then where the profiles
/// do.
fn corners(raws: &[Raw], zones: &[Zone], k: usize, stock_radius: f64) -> Option<[f64; 2]> {
    let count = raws.len();
    let meet = |other: usize, side: f64| {
        let turn = {
            let turn = (raws[other].normal - raws[k].normal).rem_euclid(core::f64::consts::TAU);
            if side > 0.0 { turn } else { turn - core::f64::consts::TAU }
        };
        if turn.sin().abs() < 1e-6 || turn.abs() > core::f64::consts::PI {
            // opposite: they meet nowhere, so the stock's circle is the end
            let n = zones[k].middle;
            return side * (stock_radius * stock_radius - n * n).max(0.0).sqrt();
        }
        let (n, m) = (zones[k].middle, zones[other].middle);
        let s = (m - n * turn.cos()) / turn.sin();
        let limit = (stock_radius * stock_radius - n * n).max(0.0).sqrt();
        refine(&raws[k], &raws[other], turn, s).clamp(-limit, limit)
    };
    let ends = [meet((k + count - 1) % count, -1.0), meet((k + 1) % count, 1.0)];
    (ends[0] < ends[1]).then_some(ends)
}

/// Newton's step by secants from where the lines meet: at s the neighbour's surface is at the same
/// point.
fn refine(own: &Raw, other: &Raw, turn: f64, start: f64) -> f64 {
    let mut s = start;
    for _ in 0..8 {
        let Some(n) = own.at(s) else { return start };
        // this point in the neighbour's coordinates
        let (s2, n2) = (s * turn.cos() - n * turn.sin(), n * turn.cos() + s * turn.sin());
        let Some(there) = other.at(s2) else { return start };
        let over = n2 - there;
        s -= over / turn.sin();
        if over.abs() < 1e-7 {
            break;
        }
    }
    s
}

fn facet(raw: &Raw, [from, to]: [f64; 2]) -> Option<Facet> {
    let profile = raw.between(from, to);
    let span = profile.last()?[0] - profile.first()?[0];
    if span < 0.9 * (to - from) {
        return None; // part of it was never cut
    }
    let zone = minimum_zone(&profile)?;
    let inclined = zone.slope.atan();
    Some(Facet {
        normal: Angle::rev(raw.normal / core::f64::consts::TAU),
        // the foot of the perpendicular from the axis on the zone's middle line
        distance: Length::mm(zone.middle * inclined.cos()),
        flatness: Length::mm(zone.width * inclined.cos()),
        // a profile that rises with s has turned its normal backwards
        tilt: Angle::rev(-inclined / core::f64::consts::TAU),
        profile: profile.into_iter().map(|p| p.map(Length::mm)).collect(),
    })
}
