//! The verdict: a sign, a word, a sentence.
use super::features::by_badness;
use crate::svg::{Tag, escape};
use crate::{Run, Standing};
use verify::Feature;

/// What the run came to.
struct Outcome {
    class: &'static str,
    sign: &'static str,
    word: String,
    sentence: String,
}

fn outcome(run: &Run, features: &[Feature]) -> Outcome {
    let all = features.len();
    let fail =
        |word: String, sentence: String| Outcome { class: "fail", sign: "✗", word, sentence };
    let counts = Standing::counts(features);
    let judged = match (all, &counts) {
        (0, _) => "Nothing was cut that could be judged.".to_owned(),
        (1, None) => "The one feature that was cut is within tolerance.".to_owned(),
        (_, None) => format!("All {all} features that were cut are within tolerance."),
        (1, Some(_)) => format!("The one feature is {}.", one(Standing::of(&features[0]))),
        (_, Some(counts)) => format!("Of {all} features: {counts}."),
    };
    if let Some(alarm) = run.alarms.first() {
        let out = if run.stops.is_empty() { "" } else { ", THE TAP IS OUT" };
        let place = if alarm.line > 0 { format!(" in line {}", alarm.line) } else { String::new() };
        return fail(
            format!("STOPPED BY AN ALARM{out}"),
            format!("Alarm {}{place}: {} {judged}", alarm.number, alarm.text),
        );
    }
    if !run.ended {
        let word = if run.stops.is_empty() { "STOPPED" } else { "STOPPED, THE TAP IS OUT" };
        return fail(word.into(), format!("The program did not come to its end. {judged}"));
    }
    if counts.is_some() {
        let worst = by_badness(run, features).first().map(|&(index, _)| &features[index]);
        let first = if all == 1 { "Line" } else { "Worst: line" };
        let why =
            worst.and_then(|f| f.verdict.reason().map(|r| format!(" {first} {}, {r}.", f.line)));
        let sentence = judged + &why.unwrap_or_default();
        return match worst.map_or(Standing::Bad, Standing::of) {
            Standing::NotJudged => {
                Outcome { class: "unjudged", sign: "?", word: "NOT JUDGED".into(), sentence }
            }
            Standing::NotCut => fail("FAIL: NOT CUT".into(), sentence),
            Standing::Bad | Standing::Good => fail("FAIL: OUT OF TOLERANCE".into(), sentence),
        };
    }
    if all == 0 {
        let sentence = "The program ran to its end; it made nothing that could be judged.".into();
        return Outcome { class: "none", sign: "○", word: "NOTHING TO JUDGE".into(), sentence };
    }
    let mut sentence = format!("{judged} The program ran to its end without an alarm.");
    let assumed = features.iter().filter(|feature| feature.has_assumed_hole()).count();
    let word = if assumed > 0 {
        sentence += &format!(
            " It drills nothing: the holes of {assumed} threads are taken to be drilled before. \
             --pre-drilled or a comment (PRE-DRILLED) states that they are."
        );
        "IF THE HOLES ARE THERE, PASS"
    } else {
        "PASS"
    };
    Outcome { class: "pass", sign: "✓", word: word.into(), sentence }
}

/// How the only feature stands.
const fn one(standing: Standing) -> &'static str {
    match standing {
        Standing::Bad => "out of tolerance",
        Standing::NotCut => "not cut",
        Standing::NotJudged => "not judged",
        Standing::Good => "within tolerance",
    }
}

/// The page's head: program and machine, then the verdict.
pub(super) fn verdict(run: &Run, features: &[Feature]) -> String {
    let Outcome { class, sign, word, sentence } = outcome(run, features);
    let sign =
        Tag::new("div").class(&format!("sign {class}")).with("aria-hidden", "true").text(sign);
    let word = Tag::new("div").class(&format!("word {class}")).text(&word);
    let words = Tag::new("div").around(&(word + &Tag::new("p").text(&sentence)));
    let facts = format!(
        "{} · {} · dialect {} · seed {}",
        escape(&run.machine),
        escape(&run.material),
        escape(&run.dialect),
        run.seed
    );
    Tag::new("h1").text(&run.program)
        + &Tag::new("p").class("facts").around(&facts)
        + &Tag::new("div")
            .class(&format!("verdict {class}"))
            .with("role", "status")
            .around(&(sign + &words))
}
