//! Where the time went: one bar for the run, one for each tool, all on one scale.
use super::figure::figure;
use crate::Run;
use crate::record::{Recorder, Shares, Turning};
use crate::svg::{Tag, escape, fixed};
use bus::State;
use units::Time;

/// What a stretch of a bar means, the states it sums up, turns of the work that are waited for, its
/// class.
type TimeShare = (&'static str, &'static [State], Option<Turning>, &'static str);

const KINDS: [TimeShare; 10] = [
    ("rapid", &[State::Rapid], None, "s0"),
    ("cutting feed", &[State::Feed], None, "s1"),
    ("tapping", &[State::TapIn, State::TapBottom, State::TapOut], None, "s2"),
    ("grinding, with spark-out", &[], Some(Turning::Grinding), "s8"),
    ("turns of the work in the air, to measure", &[], Some(Turning::InTheAir), "s9"),
    ("tool change", &[State::ToolChange], None, "s3"),
    (
        "coupling, waiting for the spindle",
        &[State::SpindleWait, State::Couple, State::Measure],
        None,
        "s4",
    ),
    ("waiting for position", &[State::Settle], None, "s5"),
    ("dwell, operator, idle", &[State::Dwell, State::Paused, State::Held, State::Idle], None, "s6"),
    ("stopped by a fault, recovering", &[State::Faulted, State::Recovering], None, "s7"),
];

/// Less than this, s, is not worth a word.
const LEAST: f64 = 0.005;
/// Tools that get a bar.
const MOST_BARS: usize = 16;
const WIDTH: f64 = 480.0;
const ROW: f64 = 44.0;
/// Characters of a tool's name that stand above a bar, on a narrow screen too; the table of tools
/// has it whole.
const NAME: usize = 48;

fn seconds(shares: &Shares, states: &[State], turning: Option<Turning>) -> f64 {
    let turned = turning.map_or(0.0, |kind| shares.turning(kind).value());
    turned + states.iter().map(|&state| shares.of(state).value()).sum::<f64>()
}

/// The bars, or nothing if no time has passed.
pub(crate) fn time_shares(run: &Run, recorder: &Recorder) -> String {
    let whole = recorder.shares.run.total();
    if whole <= Time::ZERO {
        return String::new();
    }
    let mut rows = vec![("whole run".to_owned(), &recorder.shares.run)];
    let tools = recorder.shares.tools.iter().take(MOST_BARS);
    rows.extend(
        tools
            .filter(|(_, s)| s.total() > Time::ZERO)
            .map(|(number, shares)| (run.tool(*number), shares)),
    );
    let bars: String =
        rows.iter().enumerate().map(|(row, (name, s))| bar(row, name, s, whole)).collect();
    let head = Tag::new("title").with("id", "time-t").text("Time shares")
        + &Tag::new("desc").with("id", "time-d").text(&in_words(&recorder.shares.run));
    let svg =
        Tag::new("svg").class("chart").with("role", "img").with("aria-labelledby", "time-t time-d");
    let height = ROW * rows.len() as f64 + 6.0;
    let svg = svg.with("viewBox", &format!("0 0 {WIDTH} {height:.0}")).around(&(head + &bars));
    let caption = "Seconds per kind of work, for the run and while each tool was in the spindle, in the order of the legend. \
        Waiting is what a better program or machine would save; a tool change counts for the tool that leaves.";
    figure("Where the time went", &(svg + &legend(&recorder.shares.run)), caption)
}

fn bar(row: usize, name: &str, shares: &Shares, whole: Time) -> String {
    let top = ROW * row as f64;
    let total = shares.total();
    let label = format!("{}: {} s", shortened(name), fixed(total.value(), 2));
    let mut out = Tag::new("text").at("x", 0.0).at("y", top + 15.0).text(&label);
    let mut left = 0.0;
    for (what, states, turning, class) in KINDS {
        let spent = seconds(shares, states, turning);
        let width = spent / whole.value() * WIDTH;
        if width < 0.05 {
            continue;
        }
        let title = Tag::new("title").text(&format!("{what}: {} s", fixed(spent, 2)));
        let rect =
            Tag::new("rect").class(&format!("{class} seam")).at("x", left).at("y", top + 21.0);
        out += &rect.at("width", width).at("height", 17.0).around(&title);
        left += width;
    }
    out
}

/// A name as far as there is room for it.
fn shortened(name: &str) -> String {
    if name.chars().count() <= NAME {
        return name.to_owned();
    }
    let start: String = name.chars().take(NAME - 1).collect();
    let words = start.rsplit_once(' ').map_or(start.as_str(), |(words, _)| words);
    format!("{} …", words.trim_end_matches(','))
}

fn legend(shares: &Shares) -> String {
    let mut list = String::from("<ul class=\"legend\">");
    for (what, states, turning, class) in KINDS {
        let spent = seconds(shares, states, turning);
        if spent < LEAST {
            continue;
        }
        let percent = fixed(spent / shares.total().value() * 100.0, 1);
        let sign = format!(
            "<svg viewBox=\"0 0 26 12\" aria-hidden=\"true\"><path class=\"{class}\" d=\"M4 0H22V12H4Z\"/></svg>"
        );
        let words = escape(&format!("{what} {} s ({percent} %)", fixed(spent, 2)));
        list += &Tag::new("li").around(&(sign + &words));
    }
    list + "</ul>"
}

fn in_words(shares: &Shares) -> String {
    let parts = KINDS
        .iter()
        .map(|(what, states, turning, _)| (what, seconds(shares, states, *turning)))
        .filter(|(_, s)| *s >= LEAST);
    let parts: Vec<_> = parts.map(|(what, s)| format!("{what} {} s", fixed(s, 2))).collect();
    format!("Of {} s: {}.", fixed(shares.total().value(), 2), parts.join(", "))
}
