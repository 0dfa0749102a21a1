//! The tools that were in the spindle: what the setter must have mounted for this report to hold.
use crate::pictures::figure;
use crate::record::Recorder;
use crate::svg::{Tag, fixed};
use crate::{Measure, Run};
use units::{Length, Time};

/// The table, or nothing if no tool was used.
pub(super) fn tools(run: &Run, recorder: &Recorder) -> String {
    let used = recorder.shares.tools.iter().filter(|(number, _)| *number != 0);
    let rows: String = used
        .map(|(number, shares)| row(run, recorder.measure(), *number, shares.total()))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let measure = recorder.measure();
    let units = [("length", measure.symbol()), ("⌀", measure.symbol()), ("in spindle", "s")];
    let heads: String = units
        .map(|(name, unit)| {
            Tag::new("th").around(&(name.to_owned() + &Tag::new("small").text(unit)))
        })
        .concat();
    let first = Tag::new("th").class("l").text("tool");
    let head = Tag::new("thead").around(&Tag::new("tr").around(&(first + &heads)));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    let caption = "Lengths from the gauge line to the tip, as the tool table has them. What is cut here is cut with these.";
    figure("Tools", &scroll, caption)
}

fn row(run: &Run, measure: Measure, number: u32, time: Time) -> String {
    let tool = run.tools.get(number);
    let assumed =
        if tool.is_some_and(|t| t.stand_in) { " (assumed: the table lacks it)" } else { "" };
    let size =
        |of: fn(&canon::Tool) -> Length| tool.map_or("–".into(), |t| measure.length(of(t)));
    let condition = tool.map_or(String::new(), |tool| condition(tool, measure));
    let name = Tag::new("td").class("l wide").text(&(run.tool(number) + assumed + &condition));
    let cells = [size(canon::Tool::worn_length), size(|t| t.diameter), fixed(time.value(), 2)];
    let cells: String = cells.iter().map(|cell| Tag::new("td").text(cell)).collect();
    Tag::new("tr").around(&(name + &cells))
}

/// Wear and life, where the tool table states them.
fn condition(tool: &canon::Tool, measure: Measure) -> String {
    let mut said = String::new();
    for (name, worn) in [("length", tool.wear.length), ("radius", tool.wear.radius)] {
        if worn != Length::ZERO {
            said += &format!(", wear of {name} {} {}", measure.length(worn), measure.symbol());
        }
    }
    if let Some(most) = tool.life.limit.uses {
        said += &format!(", {} of {most} uses before", tool.life.used.uses);
    }
    if let Some(most) = tool.life.limit.time {
        let used = tool.life.used.time.value();
        said += &format!(", {used:.0} of {:.0} s of cutting before", most.value());
    }
    if let Some(most) = tool.life.limit.length {
        let used = measure.length(tool.life.used.length);
        let symbol = measure.symbol();
        said += &format!(", {used} of {} {symbol} cut before", measure.length(most));
    }
    said
}
