//! What to tell first: how many are good, and which one is nearest to its limit.
//!
//! ```text
//!   headroom = what is left of a tolerance / the tolerance
//!
//!      1 ──┬── nothing used        0.4: 40 % left          0 ── at the limit        < 0: out
//! ```
//!
//! A feature has as many headrooms as tolerances; its own is the least of them. Of gauges, the
//! tolerance is TD2, so 0.4 means the same for an M3 and an M20.
use crate::config::Tolerances;
use crate::feature::{Feature, FeatureKind};
use crate::gauge::Gauge;
use crate::hole::Hole;
use crate::tapped::Thread;
use crate::verdict::Verdict;
use units::Length;

/// How many, and how many of them good.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Within every tolerance.
    pub passed: usize,
    /// Out of at least one.
    pub failed: usize,
    /// Not measured: neither.
    pub not_judged: usize,
}

impl Count {
    /// All of them.
    pub const fn total(self) -> usize {
        self.passed + self.failed + self.not_judged
    }

    const fn add(&mut self, verdict: &Verdict) {
        match verdict {
            Verdict::Pass => self.passed += 1,
            Verdict::Fail { .. } => self.failed += 1,
            Verdict::NotJudged { .. } => self.not_judged += 1,
        }
    }
}

/// Which tolerance is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Criterion {
    /// Depth of the tip.
    Depth,
    /// Place across the tool.
    Position,
    /// Pitch diameter by one of the gauges.
    PitchDiameter(Gauge),
    /// The bore's diameter.
    MinorDiameter,
    /// Sync error in the material.
    SyncError,
    /// Flatness of facets.
    Flatness,
    /// Distance of opposite facets.
    AcrossFlats,
    /// Contour of a cam.
    Contour,
    /// Something that has no measure: broken, never cut, wrong tool.
    Whole,
    /// Of a gear's teeth, single or total.
    Pitch,
    /// Slope of a gear's teeth.
    Helix,
    /// Profile of a gear's teeth.
    Profile,
    /// Span over a gear's teeth.
    Span,
    /// Thickness of a mill's chip.
    Chip,
    /// Deflection of a mill's tip.
    Deflection,
}

impl Criterion {
    /// Its name in a sentence.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Position => "position",
            Self::PitchDiameter(Gauge::Go) => "Go gauge",
            Self::PitchDiameter(Gauge::NoGo) => "No-go gauge",
            Self::MinorDiameter => "minor diameter",
            Self::SyncError => "sync error",
            Self::Flatness => "flatness",
            Self::AcrossFlats => "across flats",
            Self::Contour => "contour",
            Self::Pitch => "pitch",
            Self::Helix => "helix slope",
            Self::Profile => "profile",
            Self::Span => "span over teeth",
            Self::Chip => "chip thickness",
            Self::Deflection => "deflection",
            Self::Whole => "the whole feature",
        }
    }
}

/// What is left of one tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headroom {
    /// Of which.
    pub of: Criterion,
    /// Length left; negative is out.
    pub left: Length,
    /// The tolerance.
    pub tolerance: Length,
}

impl Headroom {
    /// Left over tolerance; where nothing is allowed, anything left is enough and anything missing
    /// is not.
    pub fn share(&self) -> f64 {
        if self.tolerance > Length::ZERO {
            self.left / self.tolerance
        } else if self.left < Length::ZERO {
            f64::NEG_INFINITY
        } else {
            1.0
        }
    }
}

impl Feature {
    /// What is left of the tolerance that is nearest to its limit.
    pub fn headroom(&self, tolerances: &Tolerances) -> Headroom {
        let measured = match &self.kind {
            FeatureKind::Hole(hole) => of_hole(hole, tolerances),
            FeatureKind::Thread(thread) => of_thread(thread, tolerances),
            FeatureKind::Polygon(polygon) => of_polygon(polygon, tolerances),
            FeatureKind::Cam(cam) => of_cam(cam, tolerances),
            FeatureKind::Turned(thread) => of_turned(thread, tolerances),
            FeatureKind::Gear(gear) => of_gear(gear),
            FeatureKind::Milled(milled) => of_milled(milled),
        };
        let least = measured.into_iter().min_by(|a, b| a.share().total_cmp(&b.share()));
        // a feature that failed for what has no measure must not look good by its measures
        let whole =
            Headroom { of: Criterion::Whole, left: -Length::um(1.0), tolerance: Length::ZERO };
        let measured = least.filter(|_| self.is_there());
        measured.filter(|least| self.verdict.is_pass() || least.share() < 0.0).unwrap_or(whole)
    }
}

fn of_cam(cam: &crate::GroundCam, tolerances: &Tolerances) -> Vec<Headroom> {
    let tolerance = tolerances.cam_contour;
    vec![Headroom { of: Criterion::Contour, left: tolerance - cam.contour_error_max, tolerance }]
}

/// Against the grade that is asked; nothing if it could not be measured.
fn of_gear(gear: &crate::Gear) -> Vec<Headroom> {
    let found = [
        (Criterion::Pitch, gear.pitch_deviation),
        (Criterion::Pitch, gear.pitch_total),
        (Criterion::Helix, gear.helix_deviation),
        (Criterion::Profile, gear.profile_deviation),
    ];
    let span = gear.size.map(|size| Headroom {
        of: Criterion::Span,
        left: size.span_left(),
        tolerance: (size.span_allowed[1] - size.span_allowed[0]) / 2.0,
    });
    let all = found.into_iter().zip(gear.allowed).filter(|(_, most)| *most > Length::ZERO);
    all.map(|((of, found), tolerance)| Headroom { of, left: tolerance - found, tolerance })
        .chain(span)
        .collect()
}

/// Against the limits that the tool table states.
fn of_milled(milled: &crate::Milled) -> Vec<Headroom> {
    let of = |of, found: Option<crate::Largest<Length>>, most: Option<Length>| {
        let (found, tolerance) = found.zip(most)?;
        Some(Headroom { of, left: tolerance - found.value, tolerance })
    };
    let limits = milled.limits;
    [
        of(Criterion::Chip, milled.chip, limits.chip),
        of(Criterion::Depth, milled.depth, limits.depth),
        of(Criterion::Deflection, milled.deflection, limits.deflection),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn of_turned(thread: &crate::TurnedThread, tolerances: &Tolerances) -> Vec<Headroom> {
    let tolerance = tolerances.turned_thread;
    let off = thread.sync_error_max.max(thread.pass_spread).max(thread.lead_error.abs());
    let mut all = vec![Headroom { of: Criterion::SyncError, left: tolerance - off, tolerance }];
    if let (Some(left), Some(limits)) = (thread.pitch_margin(), &thread.limits) {
        let tolerance = limits.pitch[1] - limits.pitch[0];
        all.push(Headroom {
            of: Criterion::PitchDiameter(thread.limiting_gauge()),
            left,
            tolerance,
        });
    }
    all
}

fn position_left(position_error: Length, tolerances: &Tolerances) -> Headroom {
    Headroom {
        of: Criterion::Position,
        left: tolerances.position - position_error,
        tolerance: tolerances.position,
    }
}

fn of_hole(hole: &Hole, tolerances: &Tolerances) -> Vec<Headroom> {
    let tolerance = tolerances.hole_depth;
    let left = tolerance - hole.depth_error.abs();
    let depth = Headroom { of: Criterion::Depth, left, tolerance };
    vec![depth, position_left(hole.position_error, tolerances)]
}

fn of_thread(thread: &Thread, tolerances: &Tolerances) -> Vec<Headroom> {
    let depth_tolerance = if thread.depth_error > Length::ZERO {
        tolerances.thread_overrun.min(tolerances.thread_depth)
    } else {
        tolerances.thread_depth
    };
    let pitch_diameter = |gauge, left| Headroom {
        of: Criterion::PitchDiameter(gauge),
        left,
        tolerance: thread.pitch_diameter_tolerance,
    };
    let mut all = vec![
        pitch_diameter(Gauge::Go, thread.go_margin),
        pitch_diameter(Gauge::NoGo, thread.no_go_margin),
        position_left(thread.position_error, tolerances),
        Headroom {
            of: Criterion::Depth,
            left: depth_tolerance - thread.depth_error.abs(),
            tolerance: depth_tolerance,
        },
    ];
    if let Some(tolerance) = tolerances.sync_error {
        let left = tolerance - thread.sync_error_max;
        all.push(Headroom { of: Criterion::SyncError, left, tolerance });
    }
    if thread.minor_margin < Length::ZERO {
        let tolerance = thread.pitch_diameter_tolerance;
        all.push(Headroom { of: Criterion::MinorDiameter, left: thread.minor_margin, tolerance });
    }
    all
}

fn of_polygon(polygon: &crate::Polygon, tolerances: &Tolerances) -> Vec<Headroom> {
    if polygon.sections.is_empty() {
        return Vec::new(); // nothing could be measured
    }
    let off = (polygon.across_flats - polygon.across_flats_ordered).abs();
    vec![
        Headroom {
            of: Criterion::Flatness,
            left: tolerances.facet_flatness - polygon.flatness,
            tolerance: tolerances.facet_flatness,
        },
        Headroom {
            of: Criterion::AcrossFlats,
            left: tolerances.across_flats - off,
            tolerance: tolerances.across_flats,
        },
    ]
}

/// A workpiece in a few numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Holes.
    pub holes: Count,
    /// Threads.
    pub threads: Count,
    /// Polygons.
    pub polygons: Count,
    /// Cams.
    pub cams: Count,
    /// Gears.
    pub gears: Count,
    /// Uses of mills.
    pub millings: Count,
    /// Index of the feature with the least headroom, and what is left of which tolerance.
    pub worst: Option<(usize, Headroom)>,
    /// Index of the thread with the largest sync error in the material, and that error.
    pub sync_error_max: Option<(usize, Length)>,
    /// Index of the thread with the largest depth error (magnitude), and that error, signed.
    pub depth_error_max: Option<(usize, Length)>,
}

impl Summary {
    /// Of these features, judged by these tolerances.
    pub fn of(features: &[Feature], tolerances: &Tolerances) -> Self {
        let mut summary = Self::default();
        for (index, feature) in features.iter().enumerate() {
            let headroom = feature.headroom(tolerances);
            if summary.worst.is_none_or(|(_, worst)| headroom.share() < worst.share()) {
                summary.worst = Some((index, headroom));
            }
            let verdict = &feature.verdict;
            match &feature.kind {
                FeatureKind::Hole(_) => summary.holes.add(verdict),
                FeatureKind::Polygon(_) => summary.polygons.add(verdict),
                FeatureKind::Cam(_) => summary.cams.add(verdict),
                FeatureKind::Turned(_) => summary.threads.add(verdict),
                FeatureKind::Gear(_) => summary.gears.add(verdict),
                FeatureKind::Milled(_) => summary.millings.add(verdict),
                FeatureKind::Thread(thread) => {
                    summary.threads.add(verdict);
                    let (sync, depth) = (thread.sync_error_max, thread.depth_error);
                    if summary.sync_error_max.is_none_or(|(_, most)| sync > most) {
                        summary.sync_error_max = Some((index, sync));
                    }
                    if summary.depth_error_max.is_none_or(|(_, most)| depth.abs() > most.abs()) {
                        summary.depth_error_max = Some((index, depth));
                    }
                }
            }
        }
        summary
    }

    /// Every feature is good.
    pub fn passes(&self) -> bool {
        let all = [self.holes, self.threads, self.polygons, self.cams, self.gears, self.millings];
        all.iter().all(|count| count.failed + count.not_judged == 0)
    }
}
