//! A turned polygon: the cross-section that the inserts left, from recorded motion.
//!
//! Both spindles and the slides are recorded once a period. Between two records a cubic through
//! four of them says where everything was, and with it where each insert's tip was *in the
//! workpiece*:
//!
//! ```text
//!   in the machine   tip = (X, Y) + r·(cos ψ, sin ψ)      ψ = ½ + θ_tool + δ   (turns; insert at zero points to −X)
//!   in the work      turned back by θ_work about its axis          ───┐ facet k, normal ν_k
//!                                                               pass ╌│╌╌ n(s)   s along the facet
//!   what is left at height z and place s of a facet:                  │
//!       h(s) = min over passes of  n(s) + nose(z − z_pass)         ───┘
//!   nose(Δ) = ρ − √(ρ² − Δ²): the insert's nose, which leaves the lay of the feed, f²/8ρ
//! ```
//!
//! Facets end where they meet their neighbours. Flatness is the least distance of two parallel
//! lines that hold the facet's profile between them; tilt is the angle between those lines and the
//! facet that was ordered; the facet's distance from the work's axis is that of the middle between
//! them. Sizes are judged by ISO 2768-1 f, flatness by ISO 2768-2 H.
//!
//! What was ordered is known from the gearing alone: insert δ faces the work when R·θ + phase + δ
//! is whole, and cuts the facet whose normal stands at −θ in the work.
mod along;
mod measure;
mod ordered;
mod passes;
mod section;
mod zone;

pub use along::Along;
pub(crate) use measure::PolygonTrack;
pub(crate) use ordered::OrderedPolygon;

use units::{Angle, Length, Spin};

/// A polygon as it was turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// How many facets were ordered.
    pub sides: u32,
    /// Distance of opposite facets, mean over all and over Z; of an odd number of sides twice the
    /// facets' distance from the axis.
    pub across_flats: Length,
    /// The same as programmed: twice the tip's closest distance from the work's axis, mean over Z.
    pub across_flats_ordered: Length,
    /// Of the worst facet at the worst height, minimum zone.
    pub flatness: Length,
    /// Of the worst facet against the facet ordered, signed.
    pub tilt: Angle,
    /// Between neighbouring facets: the mean of those of the smallest kind.
    pub corner_angle: Angle,
    /// Largest distance of a facet from the axis less the smallest.
    pub facet_difference: Length,
    /// Height of the marks that the feed leaves along Z, peak to valley.
    pub lay: Length,
    /// How it changes along Z, as cut.
    pub along: Along,
    /// The same as programmed.
    pub along_ordered: Along,
    /// Machine coordinate of the tip where the polygon begins.
    pub z_from: Length,
    /// Machine coordinate of the tip where it ends.
    pub z_to: Length,
    /// Of the work, mean over the cut.
    pub spin: Spin,
    /// Cross-sections, from `z_to` to `z_from`.
    pub sections: Vec<Section>,
    /// The synchronism was lost, or the machine stopped, while the cutter was in the work.
    pub broken_off: bool,
}

/// A cross-section.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Machine coordinate of the tip.
    pub z: Length,
    /// In the order of their normals' angles.
    pub facets: Vec<Facet>,
}

/// A facet in a cross-section.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Angle of its ordered normal in the work.
    pub normal: Angle,
    /// Of the minimum zone's middle from the work's axis.
    pub distance: Length,
    /// Minimum zone.
    pub flatness: Length,
    /// Against the ordered normal.
    pub tilt: Angle,
    /// Along the facet (from the foot of the ordered normal), and how far out the surface is there.
    pub profile: Vec<[Length; 2]>,
}

impl Polygon {
    /// Such as "hexagon 17.000" or "9 sides 30.000".
    pub fn name(&self) -> String {
        let regular = 180.0 - 360.0 / f64::from(self.sides.max(1));
        let uneven = self.sides > 2
            && !self.sections.is_empty()
            && (self.corner_angle.in_deg() - regular).abs() > 1.0;
        let form = match self.sides {
            0 => return "polygon, not cut".to_owned(),
            4 if uneven => "rhombus",
            n if uneven => {
                return format!("{n} uneven sides {:.3}", self.across_flats_ordered.value());
            }
            2 => "two flats",
            3 => "triangle",
            4 => "square",
            5 => "pentagon",
            6 => "hexagon",
            8 => "octagon",
            n => return format!("{n} sides {:.3}", self.across_flats_ordered.value()),
        };
        format!("{form} {:.3}", self.across_flats_ordered.value())
    }
}

impl Section {
    /// The outline in the work's frame, counter-clockwise.
    pub fn outline(&self) -> Vec<[Length; 2]> {
        let of = |facet: &Facet| {
            let (sine, cosine) = facet.normal.in_rad().sin_cos();
            let turn =
                move |[s, n]: &[Length; 2]| [*n * cosine - *s * sine, *n * sine + *s * cosine];
            facet.profile.iter().map(turn).collect::<Vec<_>>()
        };
        self.facets.iter().flat_map(of).collect()
    }
}
