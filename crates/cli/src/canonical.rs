//! `leadscrew canon`: the operations that a program means, in three notations.
use crate::args::{CanonArgs, CanonFormat};
use crate::pieces;
use crate::render::{self, Source};
use crate::say;
use canon::{
    Await, Axis, CamOrder, Feed, Op, OpKind, Oscillating, Output, PathMode, Polygon, Position,
    ReturnAcceleration, Signal, SpindleOrder,
};
use control::Refused;
use control::job::{Operations, Session, read_program};
use diag::Diagnostic;
use serde_json::{Value, json};
use std::io::{self, BufWriter, Write};
use units::{Time, TurnDirection};

/// Print them; true if the program is not refused.
pub(crate) fn command(args: &CanonArgs) -> Result<bool, Refused> {
    if !args.left.is_asked()
        && let Some(session) = pieces::session(&args.source.options(), &args.program)?
    {
        let name = args.program.display().to_string();
        let show = |findings: &[Diagnostic], text: &[u8]| {
            say::coloured_err(&render::text(findings, &Source::alone(&name, text)));
        };
        let (path, setup) = (&args.program, session.interp_setup());
        return match args.format {
            CanonFormat::Linuxcnc => pieces::listing(path, &session.bare_setup(), show),
            CanonFormat::Text => pieces::operations(path, &setup, line, show),
            CanonFormat::Json => {
                pieces::operations(path, &setup, |op| object(op).to_string(), show)
            }
        };
    }
    let text = read_program(&args.program)?;
    let session = Session::load(&args.source.options(), &args.program, &text)?;
    let out = say::data();
    let (written, findings) = match args.format {
        CanonFormat::Linuxcnc => listing(&session, &text, out),
        CanonFormat::Text => operations(&session, &text, out, line),
        CanonFormat::Json => operations(&session, &text, out, |op| object(op).to_string()),
    };
    say::written(written)?;
    let name = args.program.display().to_string();
    say::coloured_err(&render::text(
        &findings,
        &Source { name: &name, text: &text, drawn: &session.drawn },
    ));
    let good = !findings.iter().any(Diagnostic::is_error);
    if good && args.left.is_asked() {
        let operations = Operations::of(&text, &session.interp_setup());
        crate::left::write(&args.left, operations.left())?;
    }
    Ok(good)
}

/// As rs274 does it: from machine zero, with no offsets unless a parameter file says so, up to the
/// first error.
fn listing(session: &Session, text: &[u8], out: impl Write) -> (io::Result<()>, Vec<Diagnostic>) {
    let setup = session.bare_setup();
    let mut interpreter = interp::Interpreter::new(text, &setup);
    let mut listing = interp::Listing::new(out);
    while interpreter.step(&mut listing) == interp::Progress::More {
        if interpreter.has_errors() || listing.has_failed() {
            break;
        }
    }
    (listing.finish().map(drop), interpreter.diagnostics().to_vec())
}

fn operations(
    session: &Session,
    text: &[u8],
    out: impl Write,
    show: impl Fn(&Op) -> String,
) -> (io::Result<()>, Vec<Diagnostic>) {
    let setup = session.interp_setup();
    let mut ops = interp::Ops::new(text, &setup);
    let mut out = BufWriter::new(out);
    let mut written = Ok(());
    for op in ops.by_ref() {
        written = writeln!(out, "{}", show(&op));
        if written.is_err() {
            break;
        }
    }
    (written.and_then(|()| out.flush()), ops.diagnostics())
}

/// Its operations as objects, with everything that was found; none where it is refused.
pub(crate) fn answer(session: &Session, text: &[u8]) -> (Vec<Value>, Vec<Diagnostic>) {
    let setup = session.interp_setup();
    let mut ops = interp::Ops::new(text, &setup);
    let objects = ops.by_ref().map(|op| object(&op)).collect();
    (objects, ops.diagnostics())
}

/// One line for people.
fn line(op: &Op) -> String {
    let value = object(op);
    let name = value["op"].as_str().unwrap_or_default();
    let rest = value.as_object().into_iter().flatten().filter(|(k, _)| *k != "op" && *k != "line");
    let words: Vec<_> = rest.map(|(key, value)| format!("{key}={}", plain(value))).collect();
    format!("{:>5}  {name:<14} {}", op.span.line, words.join(" "))
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Object(map) => {
            map.iter().map(|(k, v)| format!("{k}{}", plain(v))).collect::<Vec<_>>().join(",")
        }
        Value::Number(number) => {
            let text = format!("{:.4}", number.as_f64().unwrap_or_default());
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        other => other.to_string(),
    }
}

/// One operation as a JSON object; every key carries its unit.
fn object(op: &Op) -> Value {
    let mut value = body(&op.kind);
    value["line"] = json!(op.span.line);
    value
}

fn probe(probe: &canon::Probe) -> Value {
    json!({
        "op": "probe",
        "to_mm": position(&probe.to),
        "feed_mm_per_min": probe.feed.in_mm_per_min(),
        "until": if probe.until_contact { "contact" } else { "end of contact" },
        "required": probe.required,
    })
}

fn body(kind: &OpKind) -> Value {
    match kind {
        OpKind::Rapid { to } => json!({ "op": "rapid", "to_mm": position(to) }),
        OpKind::Line { to, feed: f } => {
            json!({ "op": "line", "to_mm": position(to), "feed": feed(*f) })
        }
        OpKind::Arc { to, arc, feed: f } => json!({
            "op": "arc",
            "to_mm": position(to),
            "plane": format!("{:?}", arc.plane),
            "centre_mm": arc.centre.map(units::Length::value),
            "sweep_deg": arc.sweep.in_deg(),
            "feed": feed(*f),
        }),
        OpKind::Spline { to, spline, feed: f } => json!({
            "op": "spline",
            "to_mm": position(to),
            "control_mm": spline.pieces.iter().flatten().map(|p| p.map(units::Length::value)).collect::<Vec<_>>(),
            "feed": feed(*f),
        }),
        OpKind::Tap(tap) => json!({
            "op": "tap",
            "start_mm": position(&tap.start),
            "bottom_mm": tap.bottom.value(),
            "surface_mm": tap.surface.value(),
            "lead_mm": tap.lead.value(),
            "rpm": tap.spin.in_rpm(),
            "return_rpm": tap.return_spin.in_rpm(),
            "return_acceleration": return_acceleration(tap.return_acceleration),
            "dwell_s": tap.dwell.value(),
            "start_angle_deg": tap.start_angle.map(units::Angle::in_deg),
            "peck_mm": tap.peck.map(units::Length::value),
        }),
        OpKind::Threading(stretch) => json!({
            "op": "threading",
            "to_mm": position(&stretch.to),
            "lead_mm": stretch.lead.value(),
            "lead_growth_mm": stretch.growth.value(),
            "start_angle_deg": stretch.start_angle.in_deg(),
            "axis": stretch.axis.letter().to_string(),
            "surface_mm": stretch.surface.value(),
        }),
        OpKind::Hole(hole) => json!({
            "op": "hole",
            "at_mm": position(&hole.at),
            "bottom_mm": hole.bottom.value(),
            "surface_mm": hole.surface.value(),
        }),
        OpKind::Dwell { time } => json!({ "op": "dwell", "time_s": time.value() }),
        OpKind::Spindle { spindle, order } => spindle_order(*spindle, *order),
        OpKind::Polygon(polygon) => polygon_op(polygon),
        OpKind::Cam(order) => cam_op(order),
        OpKind::PolygonMeasure { looks } => json!({ "op": "polygon-measure", "looks": looks }),
        OpKind::PolygonEnd => json!({ "op": "polygon-end" }),
        OpKind::Hob(hob) => json!({
            "op": "hob",
            "hob": hob.hob,
            "work": hob.work,
            "teeth": hob.teeth,
            "starts": hob.starts,
            "module_mm": hob.module.value(),
            "helix_deg": hob.helix.in_deg(),
        }),
        OpKind::HobEnd => json!({ "op": "hob-end" }),
        OpKind::Coolant { mist, flood } => json!({ "op": "coolant", "mist": mist, "flood": flood }),
        OpKind::SelectTool { number } => json!({ "op": "select-tool", "tool": number }),
        OpKind::ChangeTool { number } => json!({ "op": "change-tool", "tool": number }),
        OpKind::PathMode(mode) => path_mode(*mode),
        OpKind::Overrides { feed, spindle } => {
            json!({ "op": "overrides", "feed": feed, "spindle": spindle })
        }
        OpKind::Pause { optional } => json!({ "op": "pause", "optional": optional }),
        OpKind::Output(output) => output_object(output),
        OpKind::Probe(order) => probe(order),
        OpKind::Input(wait) => json!({
            "op": "input",
            "kind": if wait.digital { "digital" } else { "analogue" },
            "number": wait.number,
            "until": match wait.until {
                Await::Nothing => "read",
                Await::Rise => "rise",
                Await::Fall => "fall",
                Await::On => "on",
                Await::Off => "off",
            },
            "longest_s": wait.longest.value(),
        }),
        OpKind::UserCode(code) => json!({
            "op": "user-code",
            "code": format!("M{}", code.number),
            "name": code.name,
            "p": code.p,
            "q": code.q,
        }),
        OpKind::Message(text) => json!({ "op": "message", "text": text }),
        OpKind::End => json!({ "op": "end" }),
    }
}

fn output_object(output: &Output) -> Value {
    let (kind, value) = match output.signal {
        Signal::Digital { on } => ("digital", json!(on)),
        Signal::Analogue { value } => ("analogue", json!(value)),
    };
    json!({
        "op": "output",
        "kind": kind,
        "number": output.number,
        "value": value,
        "with_motion": output.with_motion,
    })
}

fn feed(feed: Feed) -> Value {
    match feed {
        Feed::PerTime(speed) => json!({ "mm_per_min": speed.in_mm_per_min() }),
        Feed::PerRevolution(lead) => json!({ "mm_per_rev": lead.value() }),
        Feed::Duration(time) => json!({ "duration_s": time.value() }),
    }
}

fn spindle_order(spindle: u8, order: SpindleOrder) -> Value {
    match order {
        SpindleOrder::Stop => json!({ "op": "spindle-stop", "spindle": spindle }),
        SpindleOrder::Turn(spin) => {
            json!({ "op": "spindle", "spindle": spindle, "rpm": spin.in_rpm() })
        }
        SpindleOrder::ConstantSurfaceSpeed { speed, limit } => json!({
            "op": "surface-speed",
            "spindle": spindle,
            "m_per_min": speed.in_mm_per_min() * 1e-3,
            "limit_rpm": limit.map(units::Spin::in_rpm),
        }),
        SpindleOrder::ThrowChips(chips) => json!({
            "op": "throw-chips",
            "spindle": spindle,
            "rpm": chips.throw.in_rpm(),
            "then_rpm": chips.then.in_rpm(),
            "axis": chips.axis.letter().to_string(),
            "from_mm": chips.level.value(),
        }),
        SpindleOrder::Orient { to, longest } => json!({
            "op": "orient",
            "spindle": spindle,
            "angle_deg": to.angle.in_deg(),
            "direction": match to.direction {
                TurnDirection::Shortest => "shortest",
                TurnDirection::Forward => "forward",
                TurnDirection::Backward => "backward",
            },
            "longest_s": longest.map(Time::value),
        }),
    }
}

fn cam_op(order: &CamOrder) -> Value {
    match *order {
        CamOrder::Select { profile, phase, centre, .. } => json!({
            "op": "cam-select", "profile": profile, "phase_deg": phase.in_deg(), "centre_mm": centre.value(),
        }),
        CamOrder::Deselect => json!({ "op": "cam-end" }),
        CamOrder::Compensate => json!({ "op": "cam-compensate" }),
        CamOrder::ResetSampling => json!({ "op": "cam-sampling", "order": "reset" }),
        CamOrder::StartSampling => json!({ "op": "cam-sampling", "order": "start" }),
        CamOrder::StorePhase => json!({ "op": "cam-sampling", "order": "store" }),
        CamOrder::Grind { stock, per_turn, rate, spin } => json!({
            "op": "cam-grind",
            "stock_mm": stock.value(),
            "infeed_mm_per_rev": per_turn.value(),
            "rate_mm_per_rev": rate.value(),
            "rpm": spin.in_rpm(),
        }),
        CamOrder::SparkOut { spin, turns } => {
            json!({ "op": "cam-spark-out", "turns": turns, "rpm": spin.in_rpm() })
        }
    }
}

fn polygon_op(polygon: &Polygon) -> Value {
    let swings = |all: &[canon::Oscillation]| {
        all.iter()
            .map(|oscillation| {
                let on = match oscillation.on {
                    Oscillating::Axis(axis) => axis.letter().to_string(),
                    Oscillating::ToolPhase => "tool-phase".to_owned(),
                };
                let harmonics = oscillation.harmonics.iter();
                let harmonics: Vec<_> = harmonics
                    .map(|h| json!({ "per_turn": h.per_turn, "cosine": h.cosine, "sine": h.sine }))
                    .collect();
                json!({ "on": on, "harmonics": harmonics })
            })
            .collect::<Vec<_>>()
    };
    json!({
        "op": "polygon",
        "work_spindle": polygon.work,
        "tool_spindle": polygon.tool,
        "tool_turns": polygon.ratio.follower,
        "work_turns": polygon.ratio.master,
        "phase_deg": polygon.phase.in_deg(),
        "oscillations": swings(&polygon.oscillations),
        "by_distance": swings(&polygon.by_distance),
        "compensated": polygon.compensated,
    })
}

fn path_mode(mode: PathMode) -> Value {
    match mode {
        PathMode::Exact => json!({ "op": "path-mode", "mode": "exact" }),
        PathMode::ExactStop => json!({ "op": "path-mode", "mode": "exact-stop" }),
        PathMode::Blend { tolerance, merge } => json!({
            "op": "path-mode",
            "mode": "blend",
            "tolerance_mm": tolerance.map(units::Length::value),
            "merge_mm": merge.map(units::Length::value),
        }),
    }
}

/// As the machine is set, a share of that, or in rev/s².
fn return_acceleration(asked: ReturnAcceleration) -> Value {
    match asked {
        ReturnAcceleration::AsSet => Value::Null,
        ReturnAcceleration::Share(share) => json!({ "share": share }),
        ReturnAcceleration::Limit(limit) => json!({ "rev_per_s2": limit.value() }),
    }
}

/// X, Y, Z always; the others where they are not zero.
fn position(at: &Position) -> Value {
    let mut map = serde_json::Map::new();
    for axis in Axis::ALL {
        let value = at.along(axis).value();
        if axis.index() < 3 || value != 0.0 {
            map.insert(axis.letter().to_string(), json!(value));
        }
    }
    Value::Object(map)
}
