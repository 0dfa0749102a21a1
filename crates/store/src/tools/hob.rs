//! What tables and comments say of a hob.
use super::table::optional_length;
use super::write::{degrees, number};
use crate::keys::Keys;
use canon::{Hand, HobTool};
use units::{Angle, Length, MM_PER_INCH};

/// Module, mm.
const MODULE_MM: std::ops::RangeInclusive<f64> = 0.05..=100.0;
/// Most starts of a hob.
const MOST_STARTS: u32 = 20;
/// Of the rack of ISO 53, profile A, in modules.
const ADDENDUM: f64 = 1.25;
const TIP_RADIUS: f64 = 0.38;
const PRESSURE_ANGLE_DEG: f64 = 20.0;

/// A hob of which no more is stated than its module.
fn usual(module: Length) -> HobTool {
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

/// Reads a table in TOML.
pub(super) fn read(keys: &mut Keys<'_>) -> HobTool {
    let hob = usual(read_module(keys));
    let hands = [("right", Hand::Right), ("left", Hand::Left)];
    let senses = [("M3", false), ("M4", true)];
    let stated = |keys: &mut Keys<'_>, names, most: f64| optional_length(keys, names, 0.0..=most);
    let m = hob.module.value();
    let pressure = keys.optional("pressure_angle_deg", 5.0..=45.0);
    HobTool {
        starts: keys.optional_whole("starts", 1..=MOST_STARTS).unwrap_or(hob.starts),
        hand: keys.optional_choice("hand", &hands).unwrap_or(hob.hand),
        pressure_angle: pressure.map_or(hob.pressure_angle, Angle::deg),
        addendum: stated(keys, ["addendum_mm", "addendum_in"], 3.0 * m).unwrap_or(hob.addendum),
        tip_radius: stated(keys, ["tip_radius_mm", "tip_radius_in"], m).unwrap_or(hob.tip_radius),
        length: stated(keys, ["hob_length_mm", "hob_length_in"], 2000.0),
        cuts_backwards: keys.optional_choice("cuts_with", &senses).unwrap_or(false),
        ..hob
    }
}

fn read_module(keys: &mut Keys<'_>) -> Length {
    const PITCH: &str = "diametral_pitch";
    if !keys.has(PITCH) {
        return Length::mm(keys.number("module_mm", MODULE_MM));
    }
    if keys.has("module_mm") {
        keys.conflict(PITCH, "`module_mm` states it too: expected one of them");
        keys.optional("module_mm", MODULE_MM);
    }
    let pitch = keys.number(PITCH, MM_PER_INCH / MODULE_MM.end()..=MM_PER_INCH / MODULE_MM.start());
    Length::mm(MM_PER_INCH / pitch)
}

/// Keys and values of a hob as a table has them.
pub(super) fn written(hob: &HobTool) -> Vec<(&'static str, String)> {
    let mm = |length: Length| number(length.value());
    let hand = if hob.hand == Hand::Left { "\"left\"" } else { "\"right\"" };
    let mut keys = vec![
        ("module_mm", mm(hob.module)),
        ("starts", hob.starts.to_string()),
        ("hand", hand.to_owned()),
        ("pressure_angle_deg", degrees(hob.pressure_angle)),
        ("addendum_mm", mm(hob.addendum)),
        ("tip_radius_mm", mm(hob.tip_radius)),
    ];
    keys.extend(hob.length.map(|length| ("hob_length_mm", mm(length))));
    if hob.cuts_backwards {
        keys.push(("cuts_with", "\"M4\"".to_owned()));
    }
    keys
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
