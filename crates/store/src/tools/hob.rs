//! What comments say of a hob, and what stands in for what a table does not state.
use canon::{Hand, HobTool};
use units::{Angle, Length, MM_PER_INCH};

/// Module, mm.
pub(super) const MODULE_MM: std::ops::RangeInclusive<f64> = 0.05..=100.0;
/// Most starts of a hob.
pub(super) const MOST_STARTS: u32 = 20;
/// Of the rack of ISO 53, profile A, in modules.
const ADDENDUM: f64 = 1.25;
const TIP_RADIUS: f64 = 0.38;
const PRESSURE_ANGLE_DEG: f64 = 20.0;

/// A hob of which no more is stated than its module.
pub(super) fn usual(module: Length) -> HobTool {
    HobTool {
        module,
        starts: 1,
        hand: Hand::Right,
        pressure_angle: Angle::deg(PRESSURE_ANGLE_DEG),
        addendum: module * ADDENDUM,
        tip_radius: module * TIP_RADIUS,
        length: None,
        cuts_backwards: false,
    }
}

/// Reads the words of a comment: "hob module 2 single start right hand"; `None`: it states no
/// module.
pub(super) fn of_words(words: &[&str]) -> Option<HobTool> {
    let behind = |names: &[&str]| {
        let at = words.windows(2).find(|pair| names.contains(&pair[0]))?;
        at[1].parse::<f64>().ok().filter(|value| *value > 0.0)
    };
    let module = behind(&["module", "m"]).or_else(|| behind(&["dp"]).map(|dp| MM_PER_INCH / dp))?;
    let mut hob = usual(Length::mm(Some(module).filter(|m| MODULE_MM.contains(m))?));
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(word));
    if has(&["left", "left-hand", "lh"]) {
        hob.hand = Hand::Left;
    }
    let counted = words.windows(2).find(|pair| matches!(pair[1], "start" | "starts"))?;
    hob.starts = match counted[0] {
        "single" => 1,
        "double" => 2,
        "triple" => 3,
        count => count.parse().ok().filter(|count| (1..=MOST_STARTS).contains(count))?,
    };
    Some(hob)
}
