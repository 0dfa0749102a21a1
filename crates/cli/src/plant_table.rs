//! What the control believes of a machine beside what the simulated one may be, or for a seed is: a
//! table of comment lines.
use crate::tables::table;
use canon::ToolLibrary;
use control::config;
use sim::AxisModel;
use store::machine::{MachineFile, RAD_PER_M};
use units::{Angle, AxisKind, Coordinate, Distribution, Per, Spread};

/// One row: of what, what, as believed, its range, as drawn.
type ScatterRow = [String; 5];

/// What lies around a number, to either side.
struct Around {
    what: &'static str,
    unit: &'static str,
    believed: f64,
    /// In the value's unit.
    scatter: Spread,
    drawn: f64,
}

impl Around {
    fn row(&self, of: &str) -> ScatterRow {
        let Self { what, unit, believed, scatter, drawn } = *self;
        let by = scatter.by;
        let (low, high) = (tidy(believed - by), tidy(believed + by));
        let range = match scatter.distribution {
            _ if by == 0.0 => "as believed".to_owned(),
            Distribution::Normal => format!("{} {unit}, 1σ {}", tidy(believed), tidy(by)),
            Distribution::Uniform => format!("{low} to {high} {unit}"),
            Distribution::Triangular => format!("{low} to {high} {unit}, triangular"),
        } + of_what(&scatter);
        let believed = format!("{} {unit}", tidy(believed));
        [of.to_owned(), what.to_owned(), believed, range, format!("{} {unit}", tidy(drawn))]
    }
}

/// From what to what it varies, where that is not from machine to machine.
fn of_what(scatter: &Spread) -> &'static str {
    match scatter.per {
        _ if scatter.by == 0.0 => "",
        Per::Machine => "",
        Per::Part => ", each part",
        Per::Hole => ", each hole",
    }
}

/// The same about nothing: to either side.
fn either_side(scatter: &Spread, scale: f64, unit: &str) -> String {
    let by = tidy(scatter.by * scale);
    let range = match scatter.distribution {
        Distribution::Normal => format!("1σ {by} {unit}"),
        Distribution::Uniform => format!("±{by} {unit}"),
        Distribution::Triangular => format!("±{by} {unit}, triangular"),
    };
    range + of_what(scatter)
}

/// A share of what the value is.
fn share(scatter: &Spread, believed: f64) -> Spread {
    Spread { by: scatter.by * believed, ..*scatter }
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
pub(crate) fn lines(file: &MachineFile, seed: Option<u64>, part: u32) -> String {
    let tools = ToolLibrary::default();
    let zero = file.setup.g54;
    let drawn_by = seed.unwrap_or(u64::from(file.simulation.seed));
    let material = file.setup.stock.material;
    let config = config::simulator_of_part(file, &tools, material, (drawn_by, part), &zero);
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
                scatter: share(&believed.scatter.friction, friction),
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
            &in_unit(&believed.scatter.eccentricity, 360.0 * 3600.0),
            arcsec(drawn.encoder.eccentricity),
        ));
    }
    measured_rows(file, drawn_by, &mut rows);
    cut_rows(file, &config, &mut rows);
    let as_drawn = match part {
        1 => format!("seed {drawn_by}"),
        part => format!("seed {drawn_by}, part {part}"),
    };
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

/// In another unit.
fn in_unit(scatter: &Spread, scale: f64) -> Spread {
    Spread { by: scatter.by * scale, ..*scatter }
}

/// Torque constants of the drives that measure what they give.
fn measured_rows(file: &MachineFile, seed: u64, rows: &mut Vec<ScatterRow>) {
    let measured = config::measured_torques(file, seed);
    let axes = canon::Axis::ALL.iter().map(|axis| axis.letter().to_string()).zip(measured.axes);
    let spindles = file.spindles.iter().map(|spindle| spindle.name.clone());
    for (of, sensor) in axes.chain(spindles.zip(measured.spindles)) {
        if let Some(sensor) = sensor {
            let what = Around {
                what: "torque constant",
                unit: "%",
                believed: 100.0,
                scatter: share(&file.scatter.torque_constant, 100.0),
                drawn: 100.0 * (1.0 + sensor.constant_error),
            };
            rows.push(what.row(&of));
        }
    }
}

/// What is cut, with what, and how it is clamped.
fn cut_rows(file: &MachineFile, config: &sim::Config, rows: &mut Vec<ScatterRow>) {
    let force = file.setup.stock.material.cutting_force_n_per_mm2;
    let mut material = |of: &str, what, by: &Spread, drawn: String| {
        let (unit, scatter) = ("N/mm²", share(by, force));
        let mut row = Around { what, unit, believed: force, scatter, drawn: 0.0 }.row(of);
        row[4] = drawn;
        rows.push(row);
    };
    let strength = format!("{} N/mm²", tidy(force * config.strength()));
    material("material", "cutting force", &config.material, strength);
    if config.scatter.by > 0.0 {
        let drawn = "by its own draw".to_owned();
        material("cut", "about that of the material", &config.scatter, drawn);
    }
    let declared = &file.scatter;
    let all = [
        ("drills and taps", "diameter", declared.tool_diameter, 1e3, "µm"),
        ("taps", "lead", declared.tool_lead, 25e3, "µm in 25 mm"),
        ("work", "clamped off in X, Y, Z", declared.alignment, 1e3, "µm"),
    ];
    for (of, what, spread, scale, unit) in all.into_iter().filter(|row| row.2.by > 0.0) {
        let range = either_side(&spread, scale, unit);
        let drawn =
            if of == "work" { clamped_off(file, config) } else { "each its own".to_owned() };
        rows.push([of.to_owned(), what.to_owned(), "none".to_owned(), range, drawn]);
    }
}

/// How far the work is from where the set-up has it.
fn clamped_off(file: &MachineFile, config: &sim::Config) -> String {
    let off = config::alignment(file, config.seed, config.part);
    let um = off.map(|length| tidy(length.in_um()));
    format!("{} µm", um.join(", "))
}

/// What happens once per revolution: an amplitude, drawn or stated.
fn once(
    of: &str,
    what: &'static str,
    unit: &str,
    stated: Option<f64>,
    most: &Spread,
    drawn: f64,
) -> ScatterRow {
    let range = stated.map_or_else(
        || {
            let by = tidy(most.by);
            let range = match most.distribution {
                Distribution::Normal => format!("Rayleigh, σ {by} {unit}"),
                Distribution::Uniform => format!("up to {by} {unit}"),
                Distribution::Triangular => format!("up to {by} {unit}, triangular"),
            };
            range + of_what(most)
        },
        |stated| format!("stated: {} {unit}", tidy(stated)),
    );
    [of.to_owned(), what.to_owned(), "none".to_owned(), range, format!("{} {unit}", tidy(drawn))]
}

fn axis_rows(
    of: &str,
    believed: &AxisModel,
    drawn: &AxisModel,
    (rotary, screw): (bool, bool),
    rows: &mut Vec<ScatterRow>,
) {
    let scatter = believed.scatter;
    let (length, force, stiffness) = if rotary {
        (("arcsec", 3600.0), ("N·m", 1.0 / RAD_PER_M), ("N·m/rad", 1e3 / RAD_PER_M / RAD_PER_M))
    } else {
        (("µm", 1e3), ("N", 1.0), ("N/µm", 1e-3))
    };
    let around = |what, (unit, scale): (&'static str, f64), by: Spread, believed, drawn: f64| {
        let believed: f64 = believed * scale;
        let scatter = share(&by, believed);
        Around { what, unit, believed, scatter, drawn: drawn * scale }.row(of)
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
    let grows = |what: &str, stated: Option<f64>, by: Spread, drawn: Option<f64>| {
        let um_per_m = |rate: f64| tidy(rate * 1e6);
        let range = stated.map_or_else(
            || either_side(&by, 1e6, "µm per m"),
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
        let most = in_unit(&scatter.wobble, scale);
        let what =
            if rotary { "gear, once per motor revolution" } else { "screw, once per revolution" };
        rows.push(once(of, what, unit, None, &most, of_screw));
        let at_table = |angle: Angle| angle.value() * believed.screw_lead.value() * scale;
        let disk = errors.eccentricity.unwrap_or_default().0;
        rows.push(once(
            of,
            "motor encoder, once per revolution",
            unit,
            stated.eccentricity.map(|(angle, _)| at_table(angle)),
            &in_unit(&scatter.eccentricity, believed.screw_lead.value() * scale),
            at_table(disk),
        ));
    }
    if let (Some(stated), Some(drawn)) = (believed.growth, drawn.growth) {
        let stated_um = stated.warm * 1e6;
        let mut row = Around {
            what: "screw, growth when warm",
            unit: "µm per m",
            believed: stated_um,
            scatter: share(&scatter.growth, stated_um),
            drawn: drawn.warm * 1e6,
        }
        .row(of);
        // it is of the simulated machine alone
        "none".clone_into(&mut row[2]);
        rows.push(row);
    }
    if by_scale && !rotary {
        rows.push(grows("scale", stated.scale, scatter.scale_error, errors.scale));
    }
}
