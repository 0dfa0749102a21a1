//! What a machine's file states of errors that the control takes off, drawn: comment lines.
//!
//! ```text
//!   12 µm |           uuu      u  came towards plus      each column: from the least to the largest
//!         |   xxxxxxxx ddd     d  came towards minus     deviation within it
//!    0 µm |xxx                 x  both
//! ```
use store::machine::{
    Axis, COMPENSATION_SHARE, MachineFile, Spindle, StatedDeviations, TakesUpPlay,
};
use sync::Deviation;
use units::AxisKind;

/// Columns and rows of a chart.
const COLUMNS: usize = 72;
const ROWS: usize = 13;
/// Points that are looked at in a column.
const POINTS: usize = 24;

/// The charts and figures of all axes and spindles; empty where nothing is compensated.
pub(crate) fn lines(file: &MachineFile) -> String {
    let axes = file.axes.iter().flatten();
    let mut text: String =
        axes.filter_map(|axis| Some(of_axis(axis, axis.compensation.as_ref()?))).collect();
    text.extend(file.spindles.iter().filter_map(of_spindle));
    let lines = text.lines().map(|line| format!("# {line}").trim_end().to_owned() + "\n");
    lines.collect()
}

fn of_axis(axis: &Axis, stated: &StatedDeviations) -> String {
    let kind = axis.letter.kind();
    let (unit, small, scale) = match kind {
        AxisKind::Linear => ("mm", "µm", 1e3),
        AxisKind::Rotary => ("°", "″", 3600.0),
    };
    let curve = Deviation::new(&stated.table);
    let (from, to) = match kind {
        AxisKind::Linear => (axis.travel.from.value(), axis.travel.to.value()),
        AxisKind::Rotary => (0.0, 360.0),
    };
    let of = |at: f64, flank: f64| curve.at(at, flank).value * scale;
    let mut text = format!(
        "\nCompensation of {}: deviation of the slide from where its encoder puts it, in machine coordinates\n",
        axis.letter.letter()
    );
    text += &chart((from, to), of, small);
    text += &format!(
        "{:>12} {from} {unit}{:>width$}\n",
        "",
        format!("{to} {unit}"),
        width = COLUMNS - 4
    );
    let (at, largest) = curve.largest();
    let (points, waves) = (curve.bounds_of_points(), curve.bounds_of_waves());
    let slope = points.0 + waves.0;
    let of_length = match kind {
        AxisKind::Linear => format!("{:.1} µm a metre", slope * 1e6),
        AxisKind::Rotary => format!("{:.2} ″ a degree", slope * 3600.0),
    };
    text += &format!(
        "largest correction {:.1} {small} at {at:.1} {unit}; largest slope {of_length}, {:.2} % of the speed\n",
        largest * scale,
        slope * 100.0
    );
    let (speed, accel) = (axis.rapid.max(axis.feed_most).value(), stated.reversal.1.value());
    let bend = speed * speed * (points.1 + waves.1);
    text += &format!(
        "at its fastest, {:.0} {unit}/min, it takes {bend:.0} {unit}/s² of acceleration\n",
        speed * 60.0
    );
    let turns = curve.reversal();
    if turns > 0.0 && stated.takes_up != Some(TakesUpPlay::Drive) {
        text += &format!(
            "turning back moves the drive by {:.1} {small} in about {:.0} ms, once the slide has gone back by {:.1} {small}\n",
            turns * scale,
            2e3 * (turns / accel).sqrt() + 2.0,
            stated.turns_after.value() * scale
        );
    }
    if stated.takes_up == Some(TakesUpPlay::Drive) {
        text +=
            &format!("its drive takes up {:.1} {small} of play\n", stated.table.backlash * scale);
    }
    text
}

fn of_spindle(spindle: &Spindle) -> Option<String> {
    const ARCSEC: f64 = 360.0 * 3600.0;
    let curve = Deviation::new(spindle.encoder_errors.as_ref()?);
    let of = |at: f64, flank: f64| curve.at(at / 360.0, flank).value * ARCSEC;
    let (slope, _) = curve.bounds_of_waves();
    let mut text = format!(
        "\nCompensation of the encoder of {}: deviation of the spindle from what it reads\n",
        spindle.name
    );
    text += &chart((0.0, 360.0), of, "″");
    text += &format!("{:>12} 0 °{:>width$}\n", "", "360 °", width = COLUMNS - 3);
    text += &format!(
        "largest correction {:.1} ″; it changes the speed by {:.3} % at most, of {:.0} % that may be\n",
        curve.largest().1 * ARCSEC,
        slope * 100.0,
        COMPENSATION_SHARE * 100.0
    );
    Some(text)
}

/// Both senses over a range.
fn chart((from, to): (f64, f64), of: impl Fn(f64, f64) -> f64, small: &str) -> String {
    let at = |column: usize, point: usize| {
        let share = (column * POINTS + point) as f64 / (COLUMNS * POINTS) as f64;
        from + (to - from) * share
    };
    let range = |column: usize, flank: f64| {
        (0..=POINTS)
            .map(|point| of(at(column, point), flank))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
                (least.min(value), most.max(value))
            })
    };
    let columns: Vec<_> =
        (0..COLUMNS).map(|column| (range(column, 1.0), range(column, 0.0))).collect();
    let (least, most) = columns.iter().fold((0.0_f64, 0.0_f64), |(least, most), (up, down)| {
        (least.min(up.0).min(down.0), most.max(up.1).max(down.1))
    });
    let height = (most - least).max(f64::MIN_POSITIVE);
    let row_of = |value: f64| ((most - value) / height * (ROWS - 1) as f64).round() as usize;
    let zero = row_of(0.0);
    let mut text = String::new();
    for row in 0..ROWS {
        let label = if row == 0 || row == ROWS - 1 || row == zero {
            let value = if row == zero {
                0.0
            } else if row == 0 {
                most
            } else {
                least
            };
            format!("{value:.1} {small}")
        } else {
            String::new()
        };
        let within = |(low, high): (f64, f64)| (row_of(high)..=row_of(low)).contains(&row);
        let marks: String = columns
            .iter()
            .map(|(up, down)| match (within(*up), within(*down)) {
                (true, true) => 'x',
                (true, false) => 'u',
                (false, true) => 'd',
                (false, false) if row == zero => '-',
                (false, false) => ' ',
            })
            .collect();
        text += format!("{label:>12} |{marks}").trim_end();
        text += "\n";
    }
    text
}
