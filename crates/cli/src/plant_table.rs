//! What the control believes of a machine beside what the simulated one may be, or for a seed is: a table of comment lines.
use crate::tables::table;
use canon::ToolLibrary;
use control::config;
use sim::AxisModel;
use store::machine::MachineFile;
use units::{Angle, AxisKind, Coordinate};

/// Radians of the 1000° that stand for a metre on a rotary axis.
const RAD_PER_M: f64 = 1000.0 * std::f64::consts::PI / 180.0;

/// One row: of what, what, as believed, its range, as drawn.
type Row = [String; 5];

/// What lies around a number, to either side.
struct Around {
    what: &'static str,
    unit: &'static str,
    believed: f64,
    by: f64,
    drawn: f64,
}

impl Around {
    fn row(&self, of: &str) -> Row {
        let Self { what, unit, believed, by, drawn } = *self;
        let range = if by == 0.0 {
            "as believed".to_owned()
        } else {
            format!("{} to {} {unit}", tidy(believed - by), tidy(believed + by))
        };
        let believed = format!("{} {unit}", tidy(believed));
        [of.to_owned(), what.to_owned(), believed, range, format!("{} {unit}", tidy(drawn))]
    }
}

/// Four digits.
fn tidy(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// The lines, each beginning with `#`, so that the file stays a machine file.
pub(crate) fn lines(file: &MachineFile, seed: Option<u64>) -> String {
    let tools = ToolLibrary::default();
    let zero = file.setup.g54;
    let drawn_by = seed.unwrap_or(u64::from(file.simulation.seed));
    let config = config::simulator(file, &tools, file.setup.stock.material, drawn_by, &zero);
    let (axes, spindles) = config.plant();
    let mut rows = Vec::new();
    for ((index, believed), (_, drawn)) in config.axes.iter().zip(&axes) {
        let letter = canon::Axis::ALL[*index];
        let (rotary, of) = (letter.kind() == AxisKind::Rotary, letter.letter().to_string());
        let screw = file.axes[*index].as_ref().is_some_and(|axis| {
            matches!(axis.drive.motor, store::machine::Motor::BallScrew { .. })
        });
        axis_rows(&of, believed, drawn, (rotary, screw), &mut rows);
    }
    for ((believed, drawn), spindle) in config.spindles.iter().zip(&spindles).zip(&file.spindles) {
        let friction = believed.coulomb.value();
        rows.push(
            Around {
                what: "friction",
                unit: "N·m",
                believed: friction,
                by: friction * believed.scatter.friction,
                drawn: drawn.coulomb.value(),
            }
            .row(&spindle.name),
        );
        let arcsec = |angle: Angle| angle.in_deg() * 3600.0;
        let stated = believed.encoder.eccentricity;
        rows.push(once(
            &spindle.name,
            "encoder, once per revolution",
            "arcsec",
            (stated != Angle::ZERO).then_some(arcsec(stated)),
            arcsec(believed.scatter.eccentricity),
            arcsec(drawn.encoder.eccentricity),
        ));
    }
    let as_drawn = format!("seed {drawn_by}");
    let mut shown = table(["of", "what", "control believes", "may be", &as_drawn]);
    for row in rows {
        shown.add_row(row);
    }
    let mut text = String::from(
        "\n# What the control believes, what the simulated machine may be, and what the seed makes of it. No control is told.\n# Errors of position are zero at the work offset: the work is touched off with this machine.\n#\n",
    );
    for line in shown.to_string().lines() {
        text += format!("# {line}").trim_end();
        text += "\n";
    }
    text
}

/// What happens once per revolution: an amplitude, drawn or stated.
fn once(
    of: &str,
    what: &'static str,
    unit: &str,
    stated: Option<f64>,
    most: f64,
    drawn: f64,
) -> Row {
    let range = stated.map_or_else(
        || format!("up to {} {unit}", tidy(most)),
        |stated| format!("stated: {} {unit}", tidy(stated)),
    );
    [of.to_owned(), what.to_owned(), "none".to_owned(), range, format!("{} {unit}", tidy(drawn))]
}

fn axis_rows(
    of: &str,
    believed: &AxisModel,
    drawn: &AxisModel,
    (rotary, screw): (bool, bool),
    rows: &mut Vec<Row>,
) {
    let scatter = believed.scatter;
    let (length, force, stiffness) = if rotary {
        (("arcsec", 3600.0), ("N·m", 1.0 / RAD_PER_M), ("N·m/rad", 1e3 / RAD_PER_M / RAD_PER_M))
    } else {
        (("µm", 1e3), ("N", 1.0), ("N/µm", 1e-3))
    };
    let around = |what, (unit, scale): (&'static str, f64), share, believed: f64, drawn: f64| {
        let believed = believed * scale;
        Around { what, unit, believed, by: believed * share, drawn: drawn * scale }.row(of)
    };
    if believed.backlash > Coordinate::ZERO {
        let play = (believed.backlash.value(), drawn.backlash.value());
        rows.push(around("play", length, scatter.backlash, play.0, play.1));
    }
    let springs = (believed.stiffness.value(), drawn.stiffness.value());
    rows.push(around("stiffness", stiffness, scatter.stiffness, springs.0, springs.1));
    let rubs = (believed.friction.coulomb.value(), drawn.friction.coulomb.value());
    rows.push(around("friction", force, scatter.friction, rubs.0, rubs.1));
    let (stated, errors) = (believed.errors, drawn.errors);
    let grows = |what: &str, stated: Option<f64>, by: f64, drawn: Option<f64>| {
        let um_per_m = |rate: f64| tidy(rate * 1e6);
        let range = stated.map_or_else(
            || format!("±{} µm per m", um_per_m(by)),
            |rate| format!("stated: {} ppm", um_per_m(rate)),
        );
        let drawn = format!("{} µm per m", um_per_m(drawn.unwrap_or(0.0)));
        [of.to_owned(), what.to_owned(), "none".to_owned(), range, drawn]
    };
    let by_scale = matches!(believed.encoder, sim::AxisEncoder::Scale { .. });
    if screw && !rotary {
        let wrong = (stated.lead, scatter.lead_error, errors.lead);
        rows.push(grows("screw, lead error", wrong.0, wrong.1, wrong.2));
    }
    if screw {
        let (unit, scale) = length;
        let of_screw = errors.wobble.unwrap_or_default().0.value() * scale;
        let most = scatter.wobble.value() * scale;
        let what =
            if rotary { "gear, once per motor revolution" } else { "screw, once per revolution" };
        rows.push(once(of, what, unit, None, most, of_screw));
        let at_table = |angle: Angle| angle.value() * believed.screw_lead.value() * scale;
        let disk = errors.eccentricity.unwrap_or_default().0;
        rows.push(once(
            of,
            "motor encoder, once per revolution",
            unit,
            stated.eccentricity.map(|(angle, _)| at_table(angle)),
            at_table(scatter.eccentricity),
            at_table(disk),
        ));
    }
    if by_scale && !rotary {
        rows.push(grows("scale", stated.scale, scatter.scale_error, errors.scale));
    }
}
