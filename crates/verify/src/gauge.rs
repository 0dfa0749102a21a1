//! The gauges: from the groove that was cut to a class.
//!
//! ```text
//!     Go:    D2v ≥ D2          the full-form plug screws in; lead error jams it as if the thread
//!                              were narrower: D2v = D2s − √3·|ΔPn| − fα
//!     No-go: D2s ≤ D2 + TD2    the plug that touches two flanks only must not enter:
//!                              D2s = D2_tap + √3·w
//!     minor: D1 ≤ bore ≤ D1 + TD1
//!
//!          w/2 ←│ │→ w/2      both flanks of a groove move apart by w along the axis; at 30° to the
//!        ──╲             ╱──  perpendicular they move out by w/2·cot 30°, twice (both sides of the
//!           ╲___________╱     diameter): ΔD2 = w·cot 30° = √3·w
//! ```
//!
//! Sources: ISO 965-1 (limits), ISO 1502 (what each gauge checks), ASME B1.1 (the diameter
//! equivalent of a lead error, cot 30°·δp = 1.732·δp).
use crate::class::ThreadClass;
use crate::tolerance::Limits;
use canon::ThreadSize;
use units::Length;

/// Gauges resolve no less than this; closer to a limit is on it.
const RESOLUTION: Length = Length::um(0.01);

/// Which gauge leaves the least margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// The full-form plug that must screw in: the thread is nearly too tight.
    Go,
    /// The plug that must not: the thread is nearly too wide.
    NoGo,
}

impl Gauge {
    /// `"Go"` or `"No-go"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Go => "Go",
            Self::NoGo => "No-go",
        }
    }
}

/// A thread as it was cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutThread {
    /// D2 of the tap: what an error-free cut leaves.
    pub tap_pitch_diameter: Length,
    /// w: axial widening of the widest groove place.
    pub widening: Length,
    /// |ΔPn|: largest cumulative pitch error over the engagement length.
    pub lead_error: Length,
    /// fα: what the flank angle's error takes.
    pub flank_angle_allowance: Length,
    /// Diameter of the bore.
    pub minor_diameter: Length,
}

/// What the gauges say of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauged {
    /// D2s.
    pub pitch_diameter: Length,
    /// D2v.
    pub virtual_pitch_diameter: Length,
    /// D2v − D2.
    pub go_margin: Length,
    /// D2 + TD2 − D2s.
    pub no_go_margin: Length,
    /// Distance of the bore from the nearer of its limits.
    pub minor_margin: Length,
    /// The limits gauged against.
    pub limits: Limits,
}

impl Gauged {
    /// Gauge a thread against a class.
    pub fn new(size: &ThreadSize, class: ThreadClass, cut: &CutThread) -> Self {
        let limits = Limits::of(size, class);
        let pitch_diameter = cut.tap_pitch_diameter + cut.widening * 3.0_f64.sqrt();
        let virtual_pitch_diameter =
            pitch_diameter - cut.lead_error.abs() * 3.0_f64.sqrt() - cut.flank_angle_allowance;
        let over = cut.minor_diameter - limits.minor_diameter;
        Self {
            pitch_diameter,
            virtual_pitch_diameter,
            go_margin: virtual_pitch_diameter - limits.pitch_diameter,
            no_go_margin: limits.pitch_diameter + limits.pitch_tolerance - pitch_diameter,
            minor_margin: over.min(limits.minor_tolerance - over),
            limits,
        }
    }

    /// The finest class of the size's family whose gauges all agree.
    pub fn finest_class(size: &ThreadSize, cut: &CutThread) -> Option<ThreadClass> {
        let mut classes = ThreadClass::of(size.family).iter().copied();
        classes.find(|class| Self::new(size, *class, cut).passes())
    }

    /// The smaller of the pitch diameter's margins, and which gauge leaves it.
    pub fn margin(&self) -> (Length, Gauge) {
        if self.go_margin < self.no_go_margin {
            (self.go_margin, Gauge::Go)
        } else {
            (self.no_go_margin, Gauge::NoGo)
        }
    }

    /// Go enters.
    pub fn go(&self) -> bool {
        self.go_margin >= -RESOLUTION
    }

    /// No-go does not.
    pub fn no_go(&self) -> bool {
        self.no_go_margin >= -RESOLUTION
    }

    /// The bore is within its limits.
    pub fn minor(&self) -> bool {
        self.minor_margin >= -RESOLUTION
    }

    /// All gauges agree.
    pub fn passes(&self) -> bool {
        self.go() && self.no_go() && self.minor()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn m6(oversize_um: f64, widening_um: f64, lead_error_um: f64) -> (ThreadSize, CutThread) {
        let size: ThreadSize = "M6".parse().unwrap();
        let cut = CutThread {
            tap_pitch_diameter: Length::mm(5.350) + Length::um(oversize_um),
            widening: Length::um(widening_um),
            lead_error: Length::um(lead_error_um),
            flank_angle_allowance: Length::ZERO,
            minor_diameter: Length::mm(5.0),
        };
        (size, cut)
    }

    #[test]
    fn a_widening_of_ten_micrometres_opens_the_pitch_diameter_by_seventeen() {
        let (size, cut) = m6(0.0, 10.0, 0.0);
        let gauged = Gauged::new(&size, ThreadClass::H6, &cut);
        assert!((gauged.pitch_diameter.in_um() - 5367.32).abs() < 0.01);
        assert!((gauged.no_go_margin.in_um() - (150.0 - 17.32)).abs() < 0.01);
    }

    #[test]
    fn the_class_falls_step_by_step_as_the_groove_widens() {
        // limits of M6x1: TD2 = 95, 118, 150, 190 µm; √3·w beside them
        let classes = [(54.0, "4H"), (56.0, "5H"), (70.0, "6H"), (100.0, "7H")];
        for (widening_um, class) in classes {
            let (size, cut) = m6(0.0, widening_um, 0.0);
            assert_eq!(Gauged::finest_class(&size, &cut).unwrap().name(), class, "{widening_um}");
        }
        let (size, cut) = m6(0.0, 110.0, 0.0);
        assert_eq!(Gauged::finest_class(&size, &cut), None);
    }

    #[test]
    fn a_lead_error_takes_the_go_gauges_room_away() {
        let (size, cut) = m6(30.0, 0.0, 20.0);
        let gauged = Gauged::new(&size, ThreadClass::H6, &cut);
        assert!((gauged.go_margin.in_um() - (30.0 - 34.64)).abs() < 0.01);
        assert!(!gauged.go() && gauged.no_go());
        assert_eq!(Gauged::finest_class(&size, &cut), None, "no class makes up for it");
    }

    #[test]
    fn a_bore_outside_its_limits_fails_however_good_the_flanks_are() {
        let (size, mut cut) = m6(30.0, 0.0, 0.0);
        cut.minor_diameter = Length::mm(5.2);
        let gauged = Gauged::new(&size, ThreadClass::H6, &cut);
        assert!((gauged.minor_margin.in_um() - (4917.0 + 236.0 - 5200.0)).abs() < 1e-6);
        assert!(!gauged.passes());
    }

    proptest! {
        #[test]
        fn a_wider_groove_never_has_a_smaller_pitch_diameter_nor_a_finer_class(
            oversize in 0.0..60.0, w in 0.0..200.0, more in 0.0..50.0, lead in 0.0..20.0,
        ) {
            let (size, narrow) = m6(oversize, w + lead, lead);
            let (_, wide) = m6(oversize, w + lead + more, lead);
            let at = |cut| Gauged::new(&size, ThreadClass::H6, cut).pitch_diameter;
            prop_assert!(at(&wide) >= at(&narrow));
            let rank = |cut| {
                let class = Gauged::finest_class(&size, cut);
                ThreadClass::of(size.family).iter().position(|c| Some(*c) == class).unwrap_or(9)
            };
            prop_assert!(rank(&wide) >= rank(&narrow));
        }
    }
}
