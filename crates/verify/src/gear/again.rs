//! Gears on one workpiece: teeth that are hobbed again are the same teeth where hob, helix and
//! phase are; otherwise the later ones cut the earlier ones over.
//!
//! ```text
//!   roughed, finished: same phase        another phase, teeth or helix
//!     ╲    ╱╲    ╱                         ╲  ╱╲╳ ╱╲╱
//!      ╲  ╱  ╲  ╱   one feature             ╲╱  ╲╱      both are destroyed
//! ```
use super::crossed::Teeth;
use super::track::Pass;
use super::{Generator, wrapped};
use core::f64::consts::PI;

/// Gears that are remembered.
const MOST: usize = 64;
/// Teeth that are hobbed again may stand so far beside the first ones along the pitch circle, mm,
/// besides what a deeper cut takes away.
const BESIDE_MM: f64 = 0.02;

/// A gear as it was cut.
#[derive(Clone, Debug)]
pub(super) struct CutGear {
    /// `None`: a program before has hobbed it, whose operations are not numbered any more.
    pub(super) op: Option<u32>,
    pub(super) line: u32,
    pub(super) tool: Option<u32>,
    pub(super) rack: Generator,
    pub(super) passes: Vec<Pass>,
    pub(super) teeth: Teeth,
}

impl CutGear {
    /// Such as "a gear of 40 teeth, module 2, helix 20°".
    fn name(&self) -> String {
        let rack = &self.rack;
        format!(
            "a gear of {} teeth, module {}, helix {:.1}°",
            rack.teeth,
            canon::number(rack.module),
            rack.helix_deg
        )
    }

    fn heights(&self) -> [f64; 2] {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        self.passes.iter().fold(ends, |[low, high], p| [low.min(p.z), high.max(p.z)])
    }

    fn overlaps(&self, other: &Self) -> bool {
        let ([a, b], [c, d]) = (self.heights(), other.heights());
        a < d && c < b
    }

    /// Mean place of the teeth, turns, and mean distance of the axes, mm.
    fn stands(&self) -> (f64, f64) {
        let origin = self.passes.first().map_or(0.0, |pass| pass.flank);
        let count = self.passes.len().max(1) as f64;
        let off = self.passes.iter().map(|pass| wrapped(pass.flank - origin)).sum::<f64>() / count;
        let distance = self.passes.iter().map(|pass| pass.distance).sum::<f64>() / count;
        (origin + off, distance)
    }
}

/// What a gear does to those that were cut before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Earlier {
    /// First ops of features that are part of the new one.
    pub(crate) absorbed: Vec<u32>,
    /// First ops of features that are destroyed, and how.
    pub(crate) destroyed: Vec<(u32, String)>,
    /// What is wrong with the new gear for that reason.
    pub(super) findings: Vec<String>,
    /// Why it cannot be judged for that reason.
    pub(super) unknown: Option<String>,
}

/// The gears of one workpiece.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cuts {
    pub(super) cuts: Vec<CutGear>,
}

impl Cuts {
    /// A gear has been cut: gives it back with what was cut of the same teeth before.
    pub(super) fn add(&mut self, mut new: CutGear) -> (CutGear, Earlier) {
        let mut earlier = Earlier::default();
        let mut kept = Vec::new();
        for old in std::mem::take(&mut self.cuts) {
            if !old.overlaps(&new) {
                kept.push(old);
                continue;
            }
            if old.rack.has_teeth_of(&new.rack) && old.tool != new.tool {
                earlier.unknown = Some(format!(
                    "another hob cut these teeth in line {}, and where its threads stand is not known",
                    old.line
                ));
            }
            if let Some(passes) = merged(&old, &new) {
                earlier.absorbed.extend(old.op);
                new.passes.splice(0..0, passes);
                new.teeth = Teeth::of(&new.rack, &new.passes, new.teeth.width()).after(&old.teeth);
            } else {
                let name = new.name();
                earlier.destroyed.extend(old.op.map(|op| (op, format!("{name} is cut over it"))));
                earlier.findings.push(format!("cut over {} of line {}", old.name(), old.line));
                kept.push(old);
            }
        }
        kept.push(new.clone());
        if kept.len() > MOST {
            kept.remove(0);
        }
        self.cuts = kept;
        (new, earlier)
    }
}

/// The passes of a gear as those of a later one that goes on with its teeth; `None`: it has others.
fn merged(old: &CutGear, new: &CutGear) -> Option<Vec<Pass>> {
    if !old.rack.has_teeth_of(&new.rack) {
        return None;
    }
    let teeth = f64::from(new.rack.teeth);
    let ((old_turns, old_distance), (turns, distance)) = (old.stands(), new.stands());
    let whole = ((old_turns - turns) * teeth).round();
    let beside = wrapped(old_turns - turns - whole / teeth) * PI * new.rack.pitch_diameter;
    let room = (old_distance - distance).abs() * new.rack.transverse_rad.tan();
    if beside.abs() > room + BESIDE_MM {
        return None;
    }
    // tooth n of the old gear is tooth n − k of the new one
    let k = new.rack.sense * whole;
    let renumbered = old.passes.iter().map(|pass| Pass {
        tooth: (pass.tooth as f64 - k).rem_euclid(teeth) as usize,
        flank: pass.flank - whole / teeth,
        ..*pass
    });
    Some(renumbered.collect())
}
