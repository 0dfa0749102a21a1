//! Pitch, helix and profile of the teeth, from the passes that made them, by ISO 1328-1:2013.
//!
//! ```text
//!     φ │      ╱ slope 1/lead            pitch deviation     φ of neighbouring teeth at one height, less 1/z
//!       │    ╱                           total               largest less smallest of all teeth at that height
//!       │  ╱  tooth k                    helix deviation     slope of a tooth over the face, less the ordered
//!       └────────── height
//! ```
//!
//! Tolerances, 5.3, µm: `f_pT` = (0.001 d + 0.4 m + 5)·√2^(A−5), `F_pT` = (0.002 d + 0.55 √d + 0.7
//! m + 12)·√2^(A−5), `f_HβT` = (0.05 √d + 0.35 √b + 4)·√2^(A−5), `f_HαT` = (0.001 d + 0.4 m +
//! 4)·√2^(A−5), `f_fαT` = (0.55 m + 5)·√2^(A−5), `F_αT` = √(`f_HαT`² + `f_fαT`²).
use super::track::Pass;
use super::{Gear, Generator};
use core::f64::consts::PI;
use units::Length;

/// Sections along the face at which the pitch is measured.
const SECTIONS: usize = 5;
/// The coarsest grade there is.
const COARSEST: u8 = 11;
/// A pass that another one exceeds by no more than this still counts, mm.
const AT_DEPTH_MM: f64 = 0.02;
/// Height beside it in which a pass is compared with others, mm.
const REACH_MM: f64 = 4.0;
/// Height of a section of which the deepest pass stands for all, mm.
const BIN_MM: f64 = 0.5;

/// The passes that leave the teeth as they are: those at whose height no other one goes deeper. The
/// hob is round: Δz beside its height it reaches R − √(R² − Δz²) less deep.
pub(super) fn deepest(passes: &[Pass], radius_mm: f64) -> Vec<Pass> {
    let bin = |z: f64| (z / BIN_MM).floor() as i64;
    let mut least = std::collections::BTreeMap::<i64, [f64; 2]>::new();
    for pass in passes {
        let at = least.entry(bin(pass.z)).or_insert([pass.distance, pass.z]);
        if pass.distance < at[0] {
            *at = [pass.distance, pass.z];
        }
    }
    let radius = radius_mm.max(REACH_MM * 2.0);
    let cut_away = |pass: &Pass| {
        let near = least.range(bin(pass.z - REACH_MM)..=bin(pass.z + REACH_MM));
        near.into_iter().any(|(_, [distance, z])| {
            let beside = (z - pass.z).abs().min(radius);
            let shallower = radius - (radius * radius - beside * beside).sqrt();
            distance + shallower < pass.distance - AT_DEPTH_MM
        })
    };
    passes.iter().filter(|pass| !cut_away(pass)).copied().collect()
}

/// Passes of the tooth that has fewest.
pub(super) fn fewest(passes: &[Pass], teeth: u32) -> usize {
    let mut count = vec![0_usize; teeth as usize];
    for pass in passes {
        if let Some(of) = count.get_mut(pass.tooth) {
            *of += 1;
        }
    }
    count.into_iter().min().unwrap_or(0)
}

/// How far passes of one tooth at one height stand from one another, mm along the pitch circle: the
/// teeth are thinner by it.
pub(super) fn beside(passes: &[Pass], rack: &Generator) -> f64 {
    let mut first = std::collections::BTreeMap::<(usize, i64), [f64; 3]>::new();
    for pass in passes {
        let key = (pass.tooth, (pass.z / BIN_MM).floor() as i64);
        let [origin, low, high] = first.entry(key).or_insert([pass.flank, 0.0, 0.0]);
        let off = pass.flank - *origin;
        let off = off - off.round();
        (*low, *high) = (low.min(off), high.max(off));
    }
    let most = first.values().map(|[_, low, high]| high - low).fold(0.0, f64::max);
    most * PI * rack.pitch_diameter
}

/// Measures pitch, helix and profile; says what exceeds the grade asked.
pub(super) fn measure(
    gear: &mut Gear,
    rack: &Generator,
    passes: &[Pass],
    grade_asked: u8,
    findings: &mut Vec<String>,
) {
    let (m, d) = (gear.module.value(), rack.pitch_diameter);
    let low = passes.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let high = passes.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let face = high - low;
    (gear.z_from, gear.z_to) = (Length::mm(low), Length::mm(high));
    // beside the ordered helix, wrapped about its first pass: µm on the pitch circle
    let um = PI * d * 1e3;
    let origin = passes.first().map_or(0.0, |pass| pass.flank);
    let off = |p: &Pass| {
        let turns = p.flank - origin;
        (turns - turns.round()) * um
    };
    let teeth = gear.teeth as usize;
    let mut by_tooth = vec![Vec::new(); teeth];
    for pass in passes {
        by_tooth[pass.tooth].push([pass.z, off(pass)]);
    }
    let slopes: Vec<f64> = by_tooth.iter().map(|points| slope(points)).collect();
    let helix = slopes.iter().map(|s| (s * face).abs()).fold(0.0, f64::max);
    let (mut single, mut total) = (0.0_f64, 0.0_f64);
    for section in 0..SECTIONS {
        let at = low + face * (section as f64 + 0.5) / SECTIONS as f64;
        let places: Vec<f64> = by_tooth.iter().map(|points| place(points, at)).collect();
        for k in 0..teeth {
            single = single.max((places[(k + 1) % teeth] - places[k]).abs());
        }
        let [least, most] = [f64::min, f64::max].map(|of| places.iter().copied().reduce(of));
        total = total.max(most.unwrap_or(0.0) - least.unwrap_or(0.0));
        if section == SECTIONS / 2 {
            gear.places = places.iter().map(|um| Length::um(*um)).collect();
        }
    }
    let profile = passes
        .iter()
        .map(|p| p.profile)
        .fold([0.0; 3], |worst, found| if found[0] > worst[0] { found } else { worst });
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let cut = rack.twist + mean / um;
    let lead = |per_mm: f64| (per_mm.abs() > 1e-9).then(|| Length::mm(1.0 / per_mm));
    if rack.twist != 0.0 {
        (gear.lead, gear.lead_ordered) = (lead(cut), lead(rack.twist));
    }
    gear.pitch_deviation = Length::um(single);
    gear.pitch_total = Length::um(total);
    gear.helix_deviation = Length::um(helix);
    [gear.profile_deviation, gear.profile_slope, gear.profile_form] = profile.map(Length::um);
    let found = [single, total, helix, profile[0]];
    let within = |grade: u8| {
        tolerances(d, m, face, grade).iter().zip(found).all(|(most, found)| found <= *most)
    };
    gear.grade = (1..=COARSEST).find(|grade| within(*grade));
    let asked = tolerances(d, m, face, grade_asked);
    gear.allowed = asked.map(Length::um);
    let names = ["single pitch", "total pitch", "helix slope", "profile"];
    for ((name, found), most) in names.into_iter().zip(found).zip(asked) {
        if found > most {
            findings.push(format!(
                "{name} deviation {found:.1} µm, grade {grade_asked} allows {most:.1} µm"
            ));
        }
    }
}

/// Single pitch, total pitch, helix slope, total profile: µm, for mm.
fn tolerances(d: f64, m: f64, face: f64, grade: u8) -> [f64; 4] {
    let step = core::f64::consts::SQRT_2.powi(i32::from(grade) - 5);
    let profile_slope = 0.001 * d + 0.4 * m + 4.0;
    let profile_form = 0.55 * m + 5.0;
    [
        (0.001 * d + 0.4 * m + 5.0) * step,
        (0.002 * d + 0.55 * d.sqrt() + 0.7 * m + 12.0) * step,
        (0.05 * d.sqrt() + 0.35 * face.sqrt() + 4.0) * step,
        profile_slope.hypot(profile_form) * step,
    ]
}

/// Slope of the least-squares line.
fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let top: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let bottom: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    if bottom > 0.0 { top / bottom } else { 0.0 }
}

/// Where a tooth stands at a height, between the passes below and above it.
fn place(points: &[[f64; 2]], at: f64) -> f64 {
    let nearest = |above: bool| {
        let side = points.iter().filter(|p| (p[0] >= at) == above);
        side.min_by(|a, b| (a[0] - at).abs().total_cmp(&(b[0] - at).abs()))
    };
    match (nearest(false), nearest(true)) {
        (Some(a), Some(b)) if b[0] > a[0] => a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0]),
        (Some(one), _) | (None, Some(one)) => one[1],
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_those_of_the_standards_table() {
        // ISO 1328-1, grade 5, d = 50, m = 2, b = 20: by hand
        let [single, total, helix, profile] = tolerances(50.0, 2.0, 20.0, 5);
        assert!((single - 5.85).abs() < 1e-9);
        assert!((total - 17.389).abs() < 1e-3, "{total}");
        assert!((helix - 5.9188).abs() < 1e-3, "{helix}");
        assert!((profile - 7.7931).abs() < 1e-3, "{profile}");
        // two grades coarser: twice as wide
        assert!((tolerances(50.0, 2.0, 20.0, 7)[0] - 2.0 * single).abs() < 1e-9);
    }
}
