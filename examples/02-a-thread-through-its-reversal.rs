//! A follower axis is a function of a master angle. The spindle slows, stands, turns back; the axis only ever
//! asks the line where it belongs, so the reversal needs no special case.
use examples::{Line, draw};
use sync::Coupling;
use units::{Angle, Lead, Length};

fn main() -> std::io::Result<()> {
    // M8, 17.6 turns in and out at 1000 rpm: a right-hand thread goes down as the spindle turns clockwise
    let thread = Coupling::line(Lead::mm_per_rev(-1.25), Angle::ZERO, Length::mm(2.0));
    let stroke = plan::rest_to_rest(17.6, 1000.0 / 60.0, 66.7, 2000.0);
    let whole = stroke.duration();
    let turned = |t: f64| {
        if t < whole { stroke.at(t).s } else { 17.6 - stroke.at(t - whole).s }
    };
    let times = || (0..=400).map(|i| 2.0 * whole * f64::from(i) / 400.0);
    let z = times().map(|t| (t, thread.position(Angle::rev(turned(t))).value()));
    let spindle = times().map(|t| (t, turned(t)));
    let lines = [
        Line { name: "z of the tap, mm", points: z.collect() },
        Line { name: "spindle, turns", points: spindle.collect() },
    ];
    let title = "M8 x 1.25 in and out: z = 2 - 1.25·θ, at every instant";
    draw("02-a-thread-through-its-reversal", title, ["time, s", ""], &lines)
}
