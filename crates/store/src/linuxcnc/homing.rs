//! Homing from `[JOINT_N]`.
//!
//! | `HOME_SEARCH_VEL` | `HOME_LATCH_VEL` | `HOME_USE_INDEX` | LinuxCNC homes | here |
//! |---|---|---|---|---|
//! | 0 | 0 | | where it stands | `given` |
//! | 0 | not 0 | yes | to the next index mark | `given`, the mark is missing |
//! | not 0 | not 0 | no | to the switch's edge | `switch` |
//! | not 0 | not 0 | yes | to the mark behind the switch | `switch-and-index` |
//!
//! Where `HOME_LATCH_VEL` has the other sign than `HOME_SEARCH_VEL` it looks for the edge, and for
//! the mark, off the switch: `edge = "off"`. `HOME_ABSOLUTE_ENCODER` is `absolute`. `HOME_OFFSET`
//! is where switch or mark stand, `HOME` where the axis goes afterwards.
use super::axes::{AxisOf, Written};
use super::ini::{Entry, Ini};
use super::writer::{Cited, MachineWriter, RemarkKind, plain};

/// From the travel to limit switches and hard stops, where nothing is said.
const BEYOND: (f64, f64) = (3.0, 6.0);

/// From one index mark to the next, where nothing is said, mm or degrees.
const MARKS: f64 = 10.0;

/// Farthest that an axis goes back from its switch.
const MOST_BACK: f64 = 1000.0;

/// `[axes.x.homing]`; `order` is its number among all, 1 first.
pub(super) fn write(
    w: &mut MachineWriter,
    ini: &Ini,
    axis: &AxisOf,
    written: &Written,
    order: Option<u32>,
) {
    let key = axis.key();
    w.section(&format!("[{key}.homing]"), &format!("{key}.homing"));
    let mut read = |key: &str| axis.of_joint(w, ini, key);
    let absolute = read("HOME_ABSOLUTE_ENCODER").filter(|found| found.value != 0.0);
    let (search, latch) = (read("HOME_SEARCH_VEL"), read("HOME_LATCH_VEL"));
    let offset = read("HOME_OFFSET").map(|found| found.map(|v| v * axis.scale));
    let home = read("HOME").map(|found| found.map(|v| v * axis.scale));
    let index =
        axis.joints.first().and_then(|joint| ini.get(&format!("JOINT_{joint}"), "HOME_USE_INDEX"));
    let mut index = index.filter(|entry| entry.is_yes());
    let unit = if axis.is_rotary() { "deg" } else { "mm" };
    let moves = |found: &Option<Cited>| found.as_ref().is_some_and(|found| found.value != 0.0);
    if let Some(absolute) = absolute {
        w.taken("method", "\"absolute\"", &absolute.from);
        order_of(w, order);
        let at =
            offset.map_or((0.0, "no HOME_OFFSET".to_owned()), |found| (-found.value, found.from));
        w.taken(&format!("reference_{unit}"), &plain(at.0), &at.1);
    } else if moves(&search) && moves(&latch) {
        let (Some(search), Some(latch)) = (search, latch) else { return };
        let mark = index.take().map(Entry::cited);
        let switch = Switch { axis, written, search, latch, offset, home, mark, unit };
        if switch.is_reached() {
            match &switch.mark {
                Some(from) => w.taken("method", "\"switch-and-index\"", from),
                None => w.taken("method", "\"switch\"", &switch.search.from),
            }
            order_of(w, order);
            switch.write(w);
        } else {
            let why = format!(
                "the switch stands at {} {unit}, outside the travel, and the axis comes to it from there: HOME_OFFSET and HOME_SEARCH_VEL contradict each other",
                plain(switch.at())
            );
            w.missing("method", "\"given\"", &why);
            order_of(w, order);
        }
    } else {
        let why = search.map_or("no HOME_SEARCH_VEL".to_owned(), |found| found.from);
        w.taken("method", "\"given\"", &format!("{why}: the operator says where the axis is"));
        order_of(w, order);
    }
    if let Some(index) = index {
        let text = format!(
            "{}: a mark without a switch does not tell where the axis is, unless its travel has no other",
            index.cited()
        );
        w.say(RemarkKind::Missing, "method", &text);
    }
}

fn order_of(w: &mut MachineWriter, order: Option<u32>) {
    match order {
        Some(order) => w.taken("order", &order.to_string(), "HOME_SEQUENCE, counted from 1"),
        None => w.guessed("order", "9", "no HOME_SEQUENCE: after all others"),
    }
}

/// What homing to a switch takes.
struct Switch<'a> {
    axis: &'a AxisOf,
    written: &'a Written,
    search: Cited,
    latch: Cited,
    offset: Option<Cited>,
    home: Option<Cited>,
    /// Where the file asks for the index mark.
    mark: Option<String>,
    unit: &'static str,
}

impl Switch<'_> {
    /// Where it is.
    fn at(&self) -> f64 {
        self.offset.as_ref().map_or(0.0, |found| found.value)
    }

    /// Going back from it leads into the travel.
    fn is_reached(&self) -> bool {
        let (least, most) = self.written.travel;
        if self.search.value > 0.0 { self.at() >= least } else { self.at() <= most }
    }

    fn write(&self, w: &mut MachineWriter) {
        let unit = self.unit;
        let positive = self.search.value > 0.0;
        let sense = if positive { 1.0 } else { -1.0 };
        w.taken("direction", if positive { "\"+\"" } else { "\"-\"" }, &self.search.from);
        let off = self.search.value * self.latch.value < 0.0;
        w.taken("edge", if off { "\"off\"" } else { "\"onto\"" }, &self.latch.from);
        self.speeds(w);
        let at = self.at();
        let from = self.offset.as_ref().map_or("no HOME_OFFSET", |found| &found.from);
        w.taken(&format!("reference_{unit}"), &plain(at), from);
        if self.mark.is_some() {
            self.marks(w, at - if off { -sense } else { sense } * MARKS / 2.0);
        }
        let home = self.home.as_ref().map_or(0.0, |found| found.value);
        let back = (at - home) * sense;
        let (least, most) = self.written.travel;
        let within = back <= MOST_BACK && (least..=most).contains(&(at - sense * back.max(0.0)));
        let key = format!("pull_off_{unit}");
        let named = self.home.as_ref().map_or("no HOME: 0", |found| &found.from);
        if back >= 0.0 && within {
            w.taken(&key, &plain(back), &format!("{named}: {} before the switch", plain(back)));
        } else {
            let needed = if positive { at - most } else { least - at }.max(0.0);
            let why = format!(
                "{named} is not within {MOST_BACK} {unit} back from the switch, and only there the axis goes"
            );
            w.guessed(&key, &plain(needed), &why);
        }
    }

    /// What a configuration of LinuxCNC does not say of marks.
    fn marks(&self, w: &mut MachineWriter, switch: f64) {
        let unit = self.unit;
        let every =
            "from one index mark to the next: the screw's lead where the motor's encoder has it";
        w.missing(&format!("index_every_{unit}"), &plain(MARKS), every);
        let edge = "where the switch's edge stands, half of that from the mark: alarm 504 says where it is not";
        w.missing(&format!("switch_{unit}"), &plain(switch), edge);
    }

    /// The search must end between limit switch and hard stop, and where those stand is not known.
    fn speeds(&self, w: &mut MachineWriter) {
        let per_min = if self.axis.is_rotary() { "deg_per_min" } else { "mm_per_min" };
        let stops = 0.99 * (2.0 * self.written.approach.1 * (BEYOND.1 - BEYOND.0)).sqrt();
        let fast = (self.search.value * self.axis.scale).abs();
        let slow = (self.latch.value * self.axis.scale).abs();
        let (key, from) = (format!("fast_{per_min}"), &self.search.from);
        let most = stops.min(self.written.approach.0);
        if fast <= most {
            w.taken(&key, &plain(fast * 60.0), from);
        } else {
            let why = format!(
                "{from} says {}: from that the axis does not stop within {} {} of the limit switch, and where the hard stop is, is not known",
                plain(fast * 60.0),
                BEYOND.1 - BEYOND.0,
                self.unit
            );
            w.guessed(&key, &plain((most * 60.0).floor().max(1.0)), &why);
        }
        let most_slow = fast.min(most);
        let (key, from) = (format!("slow_{per_min}"), &self.latch.from);
        if slow <= most_slow {
            w.taken(&key, &plain(slow * 60.0), from);
        } else {
            let why = format!("{from} is faster than the search");
            w.guessed(&key, &plain((most_slow * 60.0).floor().max(1.0)), &why);
        }
    }
}
