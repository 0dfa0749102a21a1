//! Cams on one work: what is ground off stays off, whoever has ground it.
//!
//! ```text
//!   X of the wheel's edge over the work's angle
//!      ╲   ╭──╮  first cam, as ground             the work is what both leave: the lower of both at each angle
//!       ╲─╱────╲──╮                                deeper than a cam's own profile: that cam is spoilt
//!              second
//! ```
use super::{CamTrack, GroundCam, STEPS, Seen};
use crate::feature::Feature;
use crate::judged::Judged;
use crate::undone::{Undone, of_before};
use bus::Sample;
use units::Length;

/// Cams that are remembered.
const MOST: usize = 64;
/// Cams that stand nearer to one another along the work are at one place, mm.
const SAME_PLACE_MM: f64 = 0.01;

/// A cam as it stands on the work.
#[derive(Clone, Debug)]
pub(super) struct CutCam {
    /// `None`: a program before has ground it, whose operations are not numbered any more.
    pub(super) op: Option<u32>,
    pub(super) line: u32,
    pub(super) name: String,
    /// Where the wheel stood along the work, mm.
    pub(super) z: f64,
    /// X of the wheel's edge at each step of the work's turn: as asked, and where it came nearest.
    pub(super) asked: Vec<f64>,
    pub(super) nearest: Vec<f64>,
    pub(super) spoilt: Option<Spoilt>,
}

/// What a wheel that was no grinding of a cam has taken off one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spoilt {
    line: u32,
    deepest_mm: f64,
    at_turn: f64,
    is_said: bool,
}

/// The cams of one work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cams {
    all: Vec<CutCam>,
}

impl CutCam {
    /// Both are the same form at the same place.
    fn is_same(&self, asked: &[f64], allowed: f64) -> bool {
        self.asked.iter().zip(asked).all(|(a, b)| (a - b).abs() < allowed)
    }

    /// How far a surface lies below the form asked where it does most, and at which turn.
    fn below(&self, surface: &[f64]) -> (f64, f64) {
        let off = self.asked.iter().zip(surface).map(|(asked, x)| asked - x).enumerate();
        let worst = off.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        (worst.1, worst.0 as f64 / STEPS as f64)
    }
}

/// Such as "3.210 mm are gone at 45°".
fn gone(depth: f64, turn: f64) -> String {
    format!("{depth:.3} mm are gone at {:.0}° of the work", turn * 360.0)
}

impl Cams {
    /// As a program finds them whose operations are numbered anew.
    pub(crate) fn at_rest(mut self) -> Self {
        self.all.iter_mut().for_each(|cam| cam.op = cam.op.map(of_before));
        self
    }

    fn at(&self, z: f64, width: f64) -> impl Iterator<Item = &CutCam> {
        self.all.iter().filter(move |cam| (cam.z - z).abs() < width.max(SAME_PLACE_MM))
    }

    /// The same cam was ground there before: what is left of it is the nearest that both came.
    pub(super) fn go_on(
        &self,
        track: &mut CamTrack,
        asked: &[f64],
        (width, allowed): (f64, f64),
    ) -> bool {
        let mut goes_on = false;
        for cam in self.at(track.z, width).filter(|cam| cam.is_same(asked, allowed)) {
            let shift = track.shift();
            for (k, nearest) in track.nearest.iter_mut().enumerate() {
                *nearest = nearest.min(cam.nearest[(k + shift) % STEPS]);
            }
            goes_on = true;
        }
        goes_on
    }

    /// Adds one that is judged now: what was ground there before changes its verdict, and it
    /// changes those of the features before it.
    pub(super) fn add(
        &mut self,
        found: &mut Judged<GroundCam>,
        new: CutCam,
        features: &mut [Feature],
        (width, allowed): (f64, f64),
    ) -> Vec<Undone> {
        let mut undone = Vec::new();
        self.all.retain_mut(|old| {
            if (old.z - new.z).abs() >= width.max(SAME_PLACE_MM) {
                return true;
            }
            let first = features.iter_mut().rfind(|feature| Some(feature.op) == old.op);
            if old.is_same(&new.asked, allowed) {
                if let Some(first) = first.filter(|_| found.verdict.is_pass()) {
                    first.verdict = found.verdict.clone();
                }
                return false;
            }
            let (deeper, turn) = new.below(&old.nearest);
            if deeper > allowed {
                let gone = gone(deeper, turn);
                found.fails(format!(
                    "line {} has ground {} there before: {gone}",
                    old.line, old.name
                ));
            }
            let (was, _) = old.below(&old.nearest);
            let (deeper, turn) = old.below(&new.nearest);
            for (nearest, by) in old.nearest.iter_mut().zip(&new.nearest) {
                *nearest = nearest.min(*by);
            }
            if deeper > allowed.max(was) {
                let how = format!("{} was ground over it: {}", new.name, gone(deeper, turn));
                match first {
                    Some(first) => first.destroyed(new.line, &how),
                    None => {
                        undone.extend(old.op.map(|op| Undone {
                            op,
                            line: new.line,
                            how,
                            is_known: true,
                        }));
                    }
                }
            }
            true
        });
        if self.all.len() == MOST {
            self.all.remove(0);
        }
        self.all.push(new);
        undone
    }

    /// A sample in which no cam is ground.
    pub(crate) fn sample(&mut self, sample: &Sample, width: Option<Length>, allowed: Length) {
        if self.all.is_empty() {
            return;
        }
        let seen = Seen::of(sample, 0.0);
        let (z, width) = (sample.axis(2).value(), width.map_or(0.0, Length::value));
        let place = seen.turn.rem_euclid(1.0) * STEPS as f64;
        let (step, share) = (place as usize, place.fract());
        for cam in &mut self.all {
            if (cam.z - z).abs() >= width.max(SAME_PLACE_MM) {
                continue;
            }
            let between = |of: &[f64]| {
                let (a, b) = (of[step % STEPS], of[(step + 1) % STEPS]);
                a + share * (b - a)
            };
            let deeper = between(&cam.asked) - seen.edge;
            let is_new = between(&cam.nearest) - seen.edge > allowed.value() / 2.0;
            if !(deeper > allowed.value() && is_new) {
                continue;
            }
            let (line, at_turn) = (sample.report.line, seen.turn.rem_euclid(1.0));
            let spoilt =
                cam.spoilt.get_or_insert(Spoilt { line, deepest_mm: 0.0, at_turn, is_said: false });
            if deeper > spoilt.deepest_mm {
                (spoilt.deepest_mm, spoilt.at_turn) = (deeper, at_turn);
            }
            for k in [step, step + 1] {
                let nearest = &mut cam.nearest[k % STEPS];
                *nearest = nearest.min(seen.edge);
            }
        }
    }

    /// Nothing is left to say of them.
    pub(crate) fn is_settled(&self) -> bool {
        self.all.iter().all(|cam| cam.spoilt.is_none_or(|spoilt| spoilt.is_said))
    }

    /// What the wheel has done to them since.
    pub(crate) fn settle(&mut self) -> Vec<Undone> {
        let said = |cam: &mut CutCam| {
            let spoilt = cam.spoilt.as_mut().filter(|spoilt| !spoilt.is_said)?;
            spoilt.is_said = true;
            let how =
                format!("the wheel went into it: {}", gone(spoilt.deepest_mm, spoilt.at_turn));
            Some(Undone { op: cam.op?, line: spoilt.line, how, is_known: true })
        };
        self.all.iter_mut().filter_map(said).collect()
    }
}
