//! The verdict: a sign, a word, a sentence.
use super::features::by_badness;
use crate::Run;
use crate::svg::{Tag, escape};
use verify::{Feature, Verdict};

/// What the run came to.
struct Outcome {
    class: &'static str,
    sign: &'static str,
    word: String,
    sentence: String,
}

/// How many are bad, and how many nobody could judge.
fn bad_features(features: &[Feature], bad: usize) -> String {
    let open = features.iter().filter(|f| matches!(f.verdict, Verdict::NotJudged { .. })).count();
    let (all, failed) = (features.len(), bad - open);
    let are = |count: usize| if count == 1 { "is" } else { "are" };
    match (failed, open) {
        (_, 0) => format!("{failed} of {all} features {} out of tolerance.", are(failed)),
        (0, _) => format!("{open} of {all} features {} not judged.", are(open)),
        _ => format!(
            "{failed} of {all} features {} out of tolerance, {open} {} not judged.",
            are(failed),
            are(open)
        ),
    }
}

fn outcome(run: &Run, features: &[Feature]) -> Outcome {
    let unjudged =
        features.iter().filter(|f| matches!(f.verdict, verify::Verdict::NotJudged { .. })).count();
    let bad = features.iter().filter(|f| !f.verdict.is_pass()).count() - unjudged;
    let all = features.len();
    let fail =
        |word: String, sentence: String| Outcome { class: "fail", sign: "✗", word, sentence };
    let judged = match (all, bad) {
        (0, _) => "No hole or thread was cut.".to_owned(),
        (_, 0) if unjudged > 0 => {
            format!("{unjudged} of {all} features could not be judged; nothing is known to be wrong.")
        }
        (1, 0) => "The one feature that was cut is within tolerance.".to_owned(),
        (_, 0) => format!("All {all} features that were cut are within tolerance."),
        _ => bad_features(features, bad),
    };
    if let Some(alarm) = run.alarms.first() {
        let place = if alarm.line > 0 { format!(" in line {}", alarm.line) } else { String::new() };
        return fail(
            "STOPPED BY AN ALARM".into(),
            format!("Alarm {}{place}: {} {judged}", alarm.number, alarm.text),
        );
    }
    if !run.ended {
        return fail(
            "DID NOT END".into(),
            format!("The program did not come to its end. {judged}"),
        );
    }
    if bad > 0 {
        let worst = by_badness(run, features).first().map(|&(index, _)| &features[index]);
        let why = worst
            .and_then(|f| f.verdict.reason().map(|r| format!(" Worst: line {}, {r}.", f.line)));
        let failed = features.iter().any(|f| matches!(f.verdict, Verdict::Fail { .. }));
        let word = if failed { "OUT OF TOLERANCE" } else { "NOT JUDGED" };
        return fail(word.into(), judged + &why.unwrap_or_default());
    }
    if unjudged > 0 {
        let why = features.iter().find_map(|f| match &f.verdict {
            verify::Verdict::NotJudged { reason } => Some(format!(" Line {}: {reason}.", f.line)),
            _ => None,
        });
        let sentence = judged + &why.unwrap_or_default();
        return Outcome { class: "none", sign: "○", word: "NOT JUDGED".into(), sentence };
    }
    if all == 0 {
        let sentence =
            "The program ran to its end; it made no hole or thread that could be judged.".into();
        return Outcome { class: "none", sign: "○", word: "NOTHING TO JUDGE".into(), sentence };
    }
    let sentence = format!("{judged} The program ran to its end without an alarm.");
    Outcome { class: "pass", sign: "✓", word: "GOOD".into(), sentence }
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
