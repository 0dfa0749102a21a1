//! A tool library as TOML, each value so that it reads back as it was.
//!
//! ```text
//!   canon::ToolLibrary ──to_toml──► [[tool]] … ──parse_controls_toml──► the same library
//! ```
//!
//! Derived units (degrees, µm) are written as the number whose conversion gives the value again,
//! bit for bit.
use super::mill;
use canon::{
    AtLimit, Flute, Hand, HobTool, Holder, Insert, InsertEdges, InsertPoint, PolygonCutter,
    TapTool, Tool, ToolKind, ToolLibrary, ToolLife,
};
use std::fmt::Write;
use units::{Angle, Length, Stiffness};

/// The text of a library; that of an empty one is empty.
pub fn to_toml(library: &ToolLibrary) -> String {
    let mut text = String::new();
    for tool in library.iter() {
        write_tool(&mut text, tool);
    }
    text
}

/// A line `key = value`.
fn line(text: &mut String, key: &str, value: &str) {
    // writing to a String cannot fail
    let _ = writeln!(text, "{key} = {value}");
}

fn mm(text: &mut String, key: &str, value: Length) {
    line(text, key, &number(value.value()));
}

pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

fn quoted(value: &str) -> String {
    toml::Value::String(value.to_owned()).to_string()
}

/// The number that reads back as `wanted`: the conversion's own answer, or one of its nearest
/// neighbours.
pub(super) fn exact(shown: f64, wanted: f64, read: impl Fn(f64) -> f64) -> String {
    let up = [shown.next_up(), shown.next_up().next_up()];
    let down = [shown.next_down(), shown.next_down().next_down()];
    let tenth_digits = format!("{shown:.12}").parse().unwrap_or(shown);
    let candidates = [tenth_digits, shown].into_iter().chain(up).chain(down);
    number(candidates.into_iter().find(|tried| read(*tried) == wanted).unwrap_or(shown))
}

pub(super) fn degrees(angle: Angle) -> String {
    exact(angle.in_deg(), angle.value(), |deg| Angle::deg(deg).value())
}

fn write_tool(text: &mut String, tool: &Tool) {
    text.push_str("[[tool]]\n");
    line(text, "number", &tool.number.to_string());
    line(text, "pocket", &tool.pocket.to_string());
    if !tool.description.is_empty() {
        line(text, "description", &quoted(&tool.description));
    }
    mm(text, "length_mm", tool.length);
    mm(text, "diameter_mm", tool.diameter);
    for (key, worn) in [("wear_length_mm", tool.wear.length), ("wear_radius_mm", tool.wear.radius)]
    {
        if worn != Length::ZERO {
            mm(text, key, worn);
        }
    }
    if tool.life != ToolLife::default() {
        line(text, "life", &life(&tool.life));
    }
    write_kind(text, &tool.kind);
    text.push('\n');
}

fn life(life: &ToolLife) -> String {
    let (used, limit) = (&life.used, &life.limit);
    let mut parts = vec![
        format!("uses = {}", used.uses),
        format!("time_s = {}", number(used.time.value())),
        format!("cut_mm = {}", number(used.length.value())),
    ];
    parts.extend(limit.uses.map(|most| format!("limit_uses = {most}")));
    parts.extend(limit.time.map(|most| format!("limit_time_s = {}", number(most.value()))));
    parts.extend(limit.length.map(|most| format!("limit_cut_mm = {}", number(most.value()))));
    let at_limit = match life.at_limit {
        AtLimit::Remark => "remark",
        AtLimit::Refuse => "refuse",
    };
    parts.push(format!("at_limit = \"{at_limit}\""));
    parts.extend(life.is_broken.then(|| "broken = true".to_owned()));
    format!("{{ {} }}", parts.join(", "))
}

fn write_kind(text: &mut String, kind: &ToolKind) {
    let mut kind_of = |name: &str| line(text, "kind", &quoted(name));
    match kind {
        ToolKind::Drill { point_angle } => {
            kind_of("drill");
            line(text, "point_angle_deg", &degrees(*point_angle));
        }
        ToolKind::SpotDrill { point_angle } => {
            kind_of("spot-drill");
            line(text, "point_angle_deg", &degrees(*point_angle));
        }
        ToolKind::EndMill(mill) => {
            kind_of("end-mill");
            for (key, value) in mill::written(mill) {
                line(text, key, &value);
            }
        }
        ToolKind::Other => kind_of("other"),
        ToolKind::Tap(tap) => {
            kind_of("tap");
            write_tap(text, tap);
        }
        ToolKind::PolygonCutter(cutter) => {
            kind_of("polygon-cutter");
            write_cutter(text, cutter);
        }
        ToolKind::Hob(hob) => {
            kind_of("hob");
            write_hob(text, hob);
        }
        ToolKind::Insert(insert) => write_insert(text, insert),
        ToolKind::Probe(probe) => {
            kind_of("probe");
            for (key, value) in [("pretravel_um", probe.pretravel), ("lobing_um", probe.lobing)] {
                line(text, key, &micrometres(value));
            }
        }
    }
}

fn micrometres(length: Length) -> String {
    exact(length.in_um(), length.value(), |um| Length::um(um).value())
}

fn write_tap(text: &mut String, tap: &TapTool) {
    let hand = if tap.lead.value() < 0.0 { "-LH" } else { "" };
    line(text, "thread", &quoted(&format!("{}{hand}", tap.designation)));
    line(text, "chamfer_pitches", &number(tap.chamfer_pitches));
    mm(text, "thread_length_mm", tap.thread_length);
    let flute = match tap.flute {
        Flute::SpiralFlute => "spiral-flute",
        Flute::SpiralPoint => "spiral-point",
        Flute::Straight => "straight",
    };
    line(text, "flute", &quoted(flute));
    line(text, "oversize_um", &micrometres(tap.oversize));
    if let Some(most) = tap.max_torque {
        line(text, "max_torque_n_m", &number(most.value()));
    }
    line(text, "holder", &holder(tap.holder));
}

fn holder(holder: Holder) -> String {
    let with = |kind: &str, stiffness: Stiffness, rest: String| {
        let stiffness = number(stiffness.value());
        format!("{{ kind = \"{kind}\", stiffness_n_per_mm = {stiffness}{rest} }}")
    };
    let travel = |travel: Length| format!(", travel_mm = {}", number(travel.value()));
    match holder {
        Holder::Rigid { stiffness } => with("rigid", stiffness, String::new()),
        Holder::SoftSynchro { stiffness, travel: by } => {
            with("soft-synchro", stiffness, travel(by))
        }
        Holder::TensionCompression { stiffness, travel: by } => {
            with("tension-compression", stiffness, travel(by))
        }
        Holder::Clutch { spline_length, pawl_backlash, stiffness, compression } => {
            let rest = format!(
                ", spline_length_mm = {}, pawl_backlash_rev = {}, compression_mm = {}",
                number(spline_length.value()),
                number(pawl_backlash.value()),
                number(compression.value())
            );
            with("clutch", stiffness, rest)
        }
    }
}

fn write_cutter(text: &mut String, cutter: &PolygonCutter) {
    mm(text, "tip_radius_mm", cutter.radius);
    let count = u32::try_from(cutter.inserts.len()).unwrap_or(u32::MAX);
    let equal = (0..count).map(|n| Angle::rev(f64::from(n) / f64::from(count)));
    if equal.eq(cutter.inserts.iter().copied()) {
        line(text, "inserts", &count.to_string());
    } else {
        let angles: Vec<_> = cutter.inserts.iter().map(|angle| degrees(*angle)).collect();
        line(text, "insert_angles_deg", &format!("[{}]", angles.join(", ")));
    }
    mm(text, "nose_radius_mm", cutter.nose_radius);
}

fn write_hob(text: &mut String, hob: &HobTool) {
    mm(text, "module_mm", hob.module);
    line(text, "starts", &hob.starts.to_string());
    line(text, "hand", &quoted(if hob.hand == Hand::Left { "left" } else { "right" }));
    line(text, "pressure_angle_deg", &degrees(hob.pressure_angle));
    mm(text, "addendum_mm", hob.addendum);
    mm(text, "tip_radius_mm", hob.tip_radius);
    if let Some(length) = hob.length {
        mm(text, "hob_length_mm", length);
    }
    if hob.cuts_backwards {
        line(text, "cuts_with", &quoted("M4"));
    }
}

fn write_insert(text: &mut String, insert: &Insert) {
    match insert.edges {
        InsertEdges::Corner { approach, length } => {
            line(text, "kind", &quoted("turning-insert"));
            line(text, "point_angle_deg", &degrees(insert.angle));
            if let Some(InsertPoint::Nose(radius)) = insert.point {
                mm(text, "nose_radius_mm", radius);
            }
            line(text, "approach_angle_deg", &degrees(approach));
            mm(text, "edge_mm", length);
        }
        InsertEdges::Square => {
            line(text, "kind", &quoted("grooving-insert"));
            if let Some(InsertPoint::Flat(width)) = insert.point {
                mm(text, "width_mm", width);
            }
        }
        InsertEdges::Profile => {
            line(text, "kind", &quoted("threading-insert"));
            line(text, "flank_angle_deg", &degrees(insert.angle));
            match insert.point {
                Some(InsertPoint::Nose(radius)) => mm(text, "nose_radius_mm", radius),
                Some(InsertPoint::Flat(width)) => mm(text, "flat_mm", width),
                None => {}
            }
            if let Some(height) = insert.crest_height {
                mm(text, "crest_height_mm", height);
            }
        }
    }
    if let Some(orientation) = insert.orientation {
        line(text, "orientation", &orientation.number().to_string());
    }
}
