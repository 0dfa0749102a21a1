//! A tap in a holder that gives: feed, tap and spindle over time.
use super::figure::figure;
use crate::record::Recorder;
use crate::svg::{Chart, Range, Stroke, fixed};
use units::Length;

/// The first such tap of a run; nothing if there was none.
pub(crate) fn floating(recorder: &Recorder) -> String {
    let Some((tap, moments)) = recorder.floating.seen() else { return String::new() };
    let begin = moments[0].time;
    let measure = recorder.measure();
    let unit = measure.symbol();
    let over = |of: fn(&crate::record::Moment) -> f64| -> Vec<(f64, f64)> {
        moments.iter().map(|moment| (moment.time - begin, of(moment))).collect()
    };
    let height = |(time, z): (f64, f64)| (time, measure.number(Length::mm(z)));
    let [feed, tip] = [over(|m| m.feed), over(|m| m.tip)]
        .map(|line| line.into_iter().map(height).collect::<Vec<_>>());
    let rpm = over(|m| m.rpm);
    let bottom = measure.number(tap.bottom - tap.surface);
    let deepest = tip.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let description = format!(
        "The tap comes to {} {unit} below the surface; {} {unit} were asked for.",
        fixed(-deepest, measure.decimals()),
        fixed(-bottom, measure.decimals())
    );
    let time = || Range::of("time from the start of the tap / s", feed.iter().map(|p| p.0));
    let heights = feed.iter().chain(&tip).map(|p| p.1).chain([0.0, bottom]);
    let y = Range::of(&format!("z over the surface / {unit}"), heights).padded(0.08);
    let mut chart = Chart::new("Height of feed and tap over time", &description, time(), y, 280.0);
    chart.level(Stroke::Capability, 0.0, "surface");
    chart.level(Stroke::Ideal, bottom, "depth asked for");
    chart.line(Stroke::Main, &feed, Some("where the feed holds it"));
    chart.line(Stroke::Out, &tip, Some("the tap's tip"));
    let mut drawing = chart.finish("floating-z");
    let y = Range::of("spindle speed / rpm", rpm.iter().map(|p| p.1).chain([0.0])).padded(0.1);
    let mut chart =
        Chart::new("Speed of its spindle", "Spindle speed over time.", time(), y, 190.0);
    chart.zero(false);
    chart.line(Stroke::Main, &rpm, None);
    drawing += &chart.finish("floating-n");
    let caption = "The tap leaves the feed where its holder gives. With a clutch holder the feed stands early, the tap pulls itself in \
        until the splines part and stands at its depth while the spindle coasts and turns back; with tension and compression it \
        goes on as long as the spindle turns. Out of the work its spring brings it home, and the lines meet: not before.";
    figure("The first tap in its holder", &drawing, caption)
}
