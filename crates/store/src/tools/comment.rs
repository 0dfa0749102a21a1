//! What the comment of a `.tbl` line says the tool is, where it says so without ambiguity.
//!
//! | comment has | read as |
//! |---|---|
//! | "tap", not before "drill", and one thread: "M6 tap", "tap 1/4-20 UNC", "M8x1.25-LH tap" | tap, [usual](super::usual_tap) but for "spiral point", "straight", "plug" (4.5 pitches), "left" |
//! | "spot", "centre drill", "center drill" | spot drill, 90° unless "… deg" is stated |
//! | "drill", also "tap drill" | drill, 118° unless "… deg" is stated |
//! | "mill", "endmill" | end mill |
//! | "polygon" and "… inserts" | polygon cutter whose diameter is that of its tips, nose radius 0.8 |
//! | "hob" with "module" or "dp" and its number, and "single start" or "2 starts" | hob, right-handed unless "left"; its diameter is D |
//! | "threading" or "thread" with "insert", "tool" or "bar" | threading insert, 60° unless "… deg" is stated, with the point of the thread's standard unless D says it (twice the nose radius); "full profile 0.92 mm" cuts the crest so far above its point |
//! | "turning" with "insert" or "tool" | turning insert, 80° unless stated, nose radius half of D or 0.4 |
//! | "probe" | touch probe, as good as ideal: its pretravel is calibrated |
//! | none of these, or several, or "chuck" | other |
use super::usual_tap;
use canon::{Flute, Hand, Insert, InsertEdges, PolygonCutter, ThreadSize, ToolKind, TouchProbe};
use units::{Angle, Length};

/// A tool as its comment names it.
#[derive(Debug, PartialEq)]
pub struct ToolComment {
    /// What it is.
    pub kind: ToolKind,
    /// The thread's nominal diameter, or the one number followed by "mm".
    pub diameter: Option<Length>,
}

/// What a comment such as "6 mm end mill" says a tool is.
pub fn named(comment: &str) -> ToolComment {
    let Understood { kind, diameter, .. } = understand(comment);
    ToolComment { kind, diameter }
}

/// What a comment says.
#[derive(Debug, PartialEq)]
pub(super) struct Understood {
    pub(super) kind: ToolKind,
    /// The thread's nominal diameter, or the one number followed by "mm".
    pub(super) diameter: Option<Length>,
    /// It speaks of a tap and does not say of which thread.
    pub(super) thread_missing: bool,
}

pub(super) fn understand(comment: &str) -> Understood {
    let lower = comment.to_lowercase();
    let words = lower
        .split(|c: char| c.is_whitespace() || ",()".contains(c))
        .filter(|w| !w.is_empty())
        .collect::<Vec<_>>();
    let has = |wanted: &[&str]| words.iter().any(|w| wanted.contains(w));
    let followed = |first: &str, second: &str| words.windows(2).any(|w| w == [first, second]);

    let mut understood =
        Understood { kind: ToolKind::Other, diameter: millimetres(&words), thread_missing: false };
    if has(&["chuck", "mill-drill", "drill-mill"]) {
        return understood;
    }
    if has(&["probe"]) {
        let ideal = TouchProbe { pretravel: Length::ZERO, lobing: Length::ZERO };
        understood.kind = ToolKind::Probe(ideal);
        return understood;
    }
    if has(&["polygon"])
        && let Some(inserts) = inserts(&words)
    {
        understood.kind = ToolKind::PolygonCutter(PolygonCutter {
            radius: Length::ZERO, // the table's D says it
            inserts: (0..inserts).map(|n| Angle::rev(f64::from(n) / f64::from(inserts))).collect(),
            nose_radius: Length::mm(0.8),
        });
        return understood;
    }
    if has(&["hob"])
        && let Some(hob) = super::hob::of_words(&words)
    {
        understood.kind = ToolKind::Hob(hob);
        return understood;
    }
    let thread = has(&["threading"]) || has(&["thread"]) && has(&["insert", "tool", "bar"]);
    if thread && !has(&["tap", "drill", "mill", "endmill", "end-mill", "thread-mill", "forming"]) {
        understood.kind = ToolKind::Insert(Insert::threading(
            Angle::deg(degrees(&words).unwrap_or(60.0)),
            None,
            // "full profile 0.92 mm": from the point to the edge that cuts the crest
            followed("full", "profile").then(|| millimetres(&words)).flatten(),
        ));
        return understood;
    }
    if has(&["turning"]) && has(&["insert", "tool"]) {
        const NOSE: Length = Length::mm(0.4);
        let angle = Angle::deg(degrees(&words).unwrap_or(80.0));
        let approach = Insert::APPROACH.min(Angle::deg(175.0) - angle);
        let edges = InsertEdges::Corner { approach, length: Insert::EDGE };
        understood.kind = ToolKind::Insert(Insert { edges, ..Insert::turning(angle, NOSE) });
        return understood;
    }
    if has(&["grooving", "parting"])
        && has(&["insert", "tool"])
        && let Some(width) = millimetres(&words)
    {
        understood.kind = ToolKind::Insert(Insert::grooving(width));
        return understood;
    }
    let tap_drill = followed("tap", "drill") || has(&["tap-drill"]);
    let tap = has(&["tap"]) && !tap_drill;
    let spot = has(&["spot", "spot-drill", "spotdrill"])
        || followed("center", "drill")
        || followed("centre", "drill");
    let drill = (has(&["drill"]) || tap_drill) && !spot;
    let mill = has(&["mill", "endmill", "end-mill"]);
    let degrees = |usual| Angle::deg(degrees(&words).unwrap_or(usual));
    understood.kind = match (tap, spot, drill, mill) {
        (true, false, false, false) => {
            let tap = tap_of(&words);
            understood.thread_missing = tap.is_none();
            tap.map_or(ToolKind::Other, |(tap, nominal)| {
                understood.diameter = Some(nominal);
                tap
            })
        }
        (false, true, false, false) => ToolKind::SpotDrill { point_angle: degrees(90.0) },
        (false, false, true, false) => ToolKind::Drill { point_angle: degrees(118.0) },
        (false, false, false, true) => ToolKind::EndMill(super::mill::of_words(&words, 1.0)),
        _ => ToolKind::Other,
    };
    understood
}

/// Whether a comment names a diameter in inches that is this number: `1/4 end mill` and 0.25,
/// `1/4-20 tap` and 0.25.
pub(super) fn is_in_inches(comment: &str, number: f64) -> bool {
    const ALIKE: f64 = 0.003;
    let lower = comment.to_lowercase();
    if number <= 0.0 || lower.contains("mm") {
        return false;
    }
    let words = lower.split(|c: char| c.is_whitespace() || ",()".contains(c));
    words.map(|word| word.trim_end_matches(['"', '\u{201d}'])).any(|word| {
        let size = word.split_once('-').map_or(word, |(size, _)| size);
        let inches = match size.split_once('/') {
            Some((above, below)) => above.parse::<f64>().ok().zip(below.parse::<f64>().ok()),
            // a bare number is of inches where it has no whole part: .201 drill
            None => {
                size.starts_with(['.', '0']).then(|| size.parse().ok()).flatten().map(|n| (n, 1.0))
            }
        };
        inches.is_some_and(|(above, below): (f64, f64)| (above / below - number).abs() < ALIKE)
    })
}

/// The number before "inserts".
fn inserts(words: &[&str]) -> Option<u32> {
    let pair = words.windows(2).find(|w| matches!(w[1], "insert" | "inserts"))?;
    pair[0].parse().ok().filter(|count| (1..=64).contains(count))
}

/// The tap, if exactly one thread is named.
fn tap_of(words: &[&str]) -> Option<(ToolKind, Length)> {
    let pairs = words.windows(2).map(|w| w.join(" "));
    let singles = words.iter().map(|w| (*w).to_owned());
    let mut threads =
        pairs.chain(singles).filter_map(|t| t.parse::<ThreadSize>().ok()).collect::<Vec<_>>();
    threads.dedup_by(|a, b| a.nominal == b.nominal && a.pitch == b.pitch);
    let [thread] = threads.as_mut_slice() else { return None };
    let has = |wanted: &[&str]| words.iter().any(|w| wanted.contains(w));
    if has(&["left", "left-hand", "lh"]) {
        thread.hand = Hand::Left;
    }
    let mut tap = usual_tap(thread);
    if has(&["point", "spiral-point", "gun"]) {
        tap.flute = Flute::SpiralPoint;
    } else if has(&["straight"]) {
        tap.flute = Flute::Straight;
    }
    if has(&["plug"]) {
        tap.chamfer_pitches = 4.5;
    }
    Some((ToolKind::Tap(tap), thread.nominal))
}

/// "140 deg", "140deg", "140°".
fn degrees(words: &[&str]) -> Option<f64> {
    number_before(words, &["deg", "degree", "degrees", "°"]).filter(|d| (10.0..=180.0).contains(d))
}

/// "5 mm", "5mm", if it comes once.
fn millimetres(words: &[&str]) -> Option<Length> {
    number_before(words, &["mm"]).filter(|d| (0.001..=10_000.0).contains(d)).map(Length::mm)
}

fn number_before(words: &[&str], units: &[&str]) -> Option<f64> {
    let joined = words.iter().filter_map(|w| units.iter().find_map(|u| w.strip_suffix(u)));
    let apart = words.windows(2).filter(|w| units.contains(&w[1])).map(|w| w[0]);
    let mut numbers = joined.chain(apart).filter_map(|n| n.parse::<f64>().ok());
    let first = numbers.next()?;
    numbers.next().is_none().then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(comment: &str) -> String {
        match understand(comment).kind {
            ToolKind::Drill { point_angle } => format!("drill {}", point_angle.in_deg().round()),
            ToolKind::SpotDrill { point_angle } => format!("spot {}", point_angle.in_deg().round()),
            ToolKind::EndMill(_) => "mill".into(),
            ToolKind::Tap(tap) => format!("tap {} {}", tap.designation, tap.lead.value()),
            ToolKind::PolygonCutter(_) => "polygon cutter".into(),
            ToolKind::Insert(insert) => format!("insert {}", insert.angle.in_deg().round()),
            ToolKind::Probe(_) => "probe".into(),
            ToolKind::Hob(hob) => format!("hob {} {}", hob.module.value(), hob.signed_starts()),
            ToolKind::Other => "other".into(),
        }
    }

    #[test]
    fn comments_of_real_tables_are_understood() {
        assert_eq!(kind("1/8 end mill"), "mill");
        assert_eq!(kind("#7 tap drill"), "drill 118");
        assert_eq!(kind("5mm tap drill"), "drill 118");
        assert_eq!(kind("spot drill 10 mm 90 deg"), "spot 90");
        assert_eq!(kind("drill 5.0, 140°"), "drill 140");
        assert_eq!(kind("M6 tap"), "tap M6x1 1");
        assert_eq!(kind("M6x1 tap"), "tap M6x1 1");
        assert_eq!(kind("1/4-20 UNC tap"), "tap 1/4-20 UNC 1.27");
        assert_eq!(kind("M8x1.25-LH tap"), "tap M8x1.25 -1.25");
        assert_eq!(kind("left-hand tap M8"), "tap M8x1.25 -1.25");
        assert_eq!(kind("threading insert 60 degrees external"), "insert 60");
        assert_eq!(kind("thread tool 55 deg"), "insert 55");
        assert_eq!(kind("thread mill M8"), "mill");
        assert_eq!(kind("hob, module 2, single start, right hand"), "hob 2 1");
        assert_eq!(kind("hob dp 12.7 2 starts left hand"), "hob 2 -2");
        assert_eq!(kind("hob 2 starts"), "other");
    }

    #[test]
    fn what_is_ambiguous_stays_other() {
        for comment in [
            "",
            "90 deg 3/8 mill-drill",
            "big albrecht drill chuck .25 drill",
            "tap",
            "M6 M8 tap",
            "M6",
            "V engraving tool",
        ] {
            assert_eq!(kind(comment), "other", "{comment}");
        }
        assert!(understand("tap for the lid").thread_missing);
    }

    #[test]
    fn a_diameter_that_is_its_comments_in_inches_is_known() {
        for (comment, number) in [
            ("1/4 end mill", 0.25),
            ("1/4-20 UNC tap", 0.25),
            (".201 drill", 0.201),
            ("drill 3/8\"", 0.375),
        ] {
            assert!(is_in_inches(comment, number), "{comment}");
        }
        for (comment, number) in
            [("1/4 end mill", 6.35), ("M6 tap", 6.0), ("0.5 mm drill", 0.5), ("drill 2.5", 2.5)]
        {
            assert!(!is_in_inches(comment, number), "{comment}");
        }
    }

    #[test]
    fn a_diameter_in_millimetres_is_taken_from_the_comment() {
        assert_eq!(understand("5mm drill").diameter, Some(Length::mm(5.0)));
        assert_eq!(understand("16 mm mill").diameter, Some(Length::mm(16.0)));
        assert_eq!(understand("drill 5mm or 6mm").diameter, None);
    }
}
