//! The table in TOML.
use super::{LONGEST, MOST_TOOLS, hob, mill, usual_oversize, without_doubles};
use crate::{
    keys::{self, Keys},
    machine::n_per_um,
};
use canon::{
    AtLimit, Body, Flute, Hand, HobTool, Holder, Insert, InsertEdges, InsertOrientation,
    InsertPoint, PolygonCutter, TapTool, ThreadSize, Tool, ToolKind, ToolLibrary, ToolLife,
    ToolLimit, ToolUse, ToolWear, TouchProbe,
};
use diag::{Diagnostic, Span};
use std::ops::RangeInclusive;
use units::{Angle, Length, MM_PER_INCH, Stiffness, Time, Torque};

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Drill,
    SpotDrill,
    EndMill,
    Tap,
    PolygonCutter,
    Hob,
    ThreadingInsert,
    TurningInsert,
    GroovingInsert,
    Probe,
    Other,
}

/// What a table may say.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// A shop's: real tools have a length and a diameter.
    Shop,
    /// A control's: what it was told counts, such as the negative lengths of tools that are touched
    /// off on the work.
    Control,
}

/// Kinds, as a table writes them.
pub(super) const KINDS: [(&str, Kind); 11] = [
    ("drill", Kind::Drill),
    ("spot-drill", Kind::SpotDrill),
    ("end-mill", Kind::EndMill),
    ("tap", Kind::Tap),
    ("polygon-cutter", Kind::PolygonCutter),
    ("hob", Kind::Hob),
    ("threading-insert", Kind::ThreadingInsert),
    ("turning-insert", Kind::TurningInsert),
    ("grooving-insert", Kind::GroovingInsert),
    ("probe", Kind::Probe),
    ("other", Kind::Other),
];

/// The keys that are asked for of a tool of this kind.
pub(super) fn asked_keys(kind: &str) -> Vec<crate::AskedKey> {
    let text = format!("[[tool]]\nkind = \"{kind}\"\n");
    keys::asked(&text, "", &|_| None, |k| {
        k.sections("tool", MOST_TOOLS, |k| read_tool(k, Origin::Shop))
    })
}

pub(super) fn parse(text: &str, file: u16, origin: Origin) -> Result<ToolLibrary, Vec<Diagnostic>> {
    let read = |k: &mut Keys<'_>| k.sections("tool", MOST_TOOLS, |k| read_tool(k, origin));
    let tools = keys::read(text, file, read)?;
    without_doubles(tools, "S0406")
}

fn read_tool(keys: &mut Keys<'_>, origin: Origin) -> (Tool, Span) {
    let number = keys.whole("number", 1..=u32::MAX);
    let (kind, nominal) = match keys.choice("kind", &KINDS) {
        Kind::Drill => (ToolKind::Drill { point_angle: point_angle(keys, 118.0) }, None),
        Kind::SpotDrill => (ToolKind::SpotDrill { point_angle: point_angle(keys, 90.0) }, None),
        Kind::EndMill => (ToolKind::EndMill(mill::read(keys)), None),
        Kind::Tap => {
            let thread = read_thread(keys);
            (ToolKind::Tap(read_tap(&thread, keys)), Some(thread.nominal))
        }
        Kind::PolygonCutter => {
            let cutter = read_polygon_cutter(keys);
            let diameter = cutter.radius * 2.0;
            (ToolKind::PolygonCutter(cutter), Some(diameter))
        }
        Kind::Hob => (ToolKind::Hob(read_hob(keys)), None),
        Kind::ThreadingInsert => (ToolKind::Insert(read_threading_insert(keys)), None),
        Kind::TurningInsert => (ToolKind::Insert(read_turning_insert(keys)), None),
        Kind::GroovingInsert => (ToolKind::Insert(read_grooving_insert(keys)), None),
        Kind::Probe => (ToolKind::Probe(read_probe(keys)), None),
        Kind::Other => (ToolKind::Other, None),
    };
    let tool = Tool {
        number,
        pocket: keys.optional_whole("pocket", 0..=u32::MAX).unwrap_or(number),
        length: length(keys, ["length_mm", "length_in"], {
            let shortest = if origin == Origin::Shop { 0.0 } else { -LONGEST.value() };
            shortest..=LONGEST.value()
        }),
        diameter: match &kind {
            ToolKind::Insert(insert) if origin == Origin::Shop => insert.nose_diameter(),
            _ => read_diameter(nominal, keys, origin),
        },
        wear: read_wear(keys),
        life: keys.optional_section("life", read_life).unwrap_or_default(),
        body: read_body(keys, &kind),
        kind,
        description: keys.optional_text("description").unwrap_or_default(),
        stand_in: false,
    };
    (tool, keys.span_of("number"))
}

fn read_probe(keys: &mut Keys<'_>) -> TouchProbe {
    let pretravel = Length::um(keys.optional("pretravel_um", 0.0..=1000.0).unwrap_or(0.0));
    let lobing = Length::um(keys.optional("lobing_um", 0.0..=1000.0).unwrap_or(0.0));
    if lobing > pretravel {
        let most = pretravel.in_um();
        keys.conflict("lobing_um", format!("`lobing_um` is more than the pretravel of {most} µm"));
    }
    TouchProbe { pretravel, lobing }
}

/// What use has added to the geometry; nothing unless stated.
fn read_wear(keys: &mut Keys<'_>) -> ToolWear {
    const MOST: f64 = 100.0;
    let mut wear = |names| optional_length(keys, names, -MOST..=MOST).unwrap_or(Length::ZERO);
    ToolWear {
        length: wear(["wear_length_mm", "wear_length_in"]),
        radius: wear(["wear_radius_mm", "wear_radius_in"]),
    }
}

/// How much it was used, how much it may be, what happens then.
fn read_life(keys: &mut Keys<'_>) -> ToolLife {
    const LONGEST_S: f64 = 1e9;
    const LONGEST_MM: f64 = 1e12;
    let used = ToolUse {
        uses: keys.optional_whole("uses", 0..=u32::MAX).unwrap_or(0),
        time: Time::s(keys.optional("time_s", 0.0..=LONGEST_S).unwrap_or(0.0)),
        length: Length::mm(keys.optional("cut_mm", 0.0..=LONGEST_MM).unwrap_or(0.0)),
    };
    let limit = ToolLimit {
        uses: keys.optional_whole("limit_uses", 1..=u32::MAX),
        time: keys.optional("limit_time_s", 0.001..=LONGEST_S).map(Time::s),
        length: keys.optional("limit_cut_mm", 0.001..=LONGEST_MM).map(Length::mm),
    };
    let names = [("remark", AtLimit::Remark), ("refuse", AtLimit::Refuse)];
    let at_limit = keys.optional_choice("at_limit", &names).unwrap_or_default();
    let is_broken = keys.has("broken") && keys.flag("broken");
    ToolLife { used, limit, at_limit, is_broken }
}

/// Whatever is stated of what stands behind the edges.
fn read_body(keys: &mut Keys<'_>, kind: &ToolKind) -> Body {
    let mut stated = |names| optional_length(keys, names, 0.1..=LONGEST.value());
    let shank = stated(["shank_diameter_mm", "shank_diameter_in"]);
    let stick_out = stated(["stick_out_mm", "stick_out_in"]);
    let holder = stated(["holder_diameter_mm", "holder_diameter_in"]);
    let has_flutes =
        matches!(kind, ToolKind::Drill { .. } | ToolKind::SpotDrill { .. } | ToolKind::EndMill(_));
    let flutes = if has_flutes { stated(["flute_length_mm", "flute_length_in"]) } else { None };
    let depth_without_pecks = if matches!(kind, ToolKind::Drill { .. }) {
        stated(["depth_without_pecks_mm", "depth_without_pecks_in"])
    } else {
        None
    };
    if let (Some(flutes), Some(out)) = (flutes, stick_out)
        && flutes > out
    {
        let most = out.value();
        let message = format!("the flutes end within the holder: expected {most} mm at most");
        keys.conflict("flute_length_mm", message);
    }
    Body { flutes, shank, stick_out, holder, depth_without_pecks }
}

/// A length that is stated in millimetres, or in inches.
fn length(keys: &mut Keys<'_>, names: [&'static str; 2], bounds: RangeInclusive<f64>) -> Length {
    if keys.has(names[1]) {
        return optional_length(keys, names, bounds).unwrap_or(Length::ZERO); // what is none is refused there
    }
    Length::mm(keys.number(names[0], bounds))
}

pub(super) fn optional_length(
    keys: &mut Keys<'_>,
    [in_mm, in_inches]: [&'static str; 2],
    bounds: RangeInclusive<f64>,
) -> Option<Length> {
    if !keys.has(in_inches) {
        return keys.optional(in_mm, bounds).map(Length::mm);
    }
    if keys.has(in_mm) {
        keys.conflict(in_inches, format!("`{in_mm}` states it too: expected one of them"));
        keys.optional(in_mm, bounds.clone());
    }
    let inches = bounds.start() / MM_PER_INCH..=bounds.end() / MM_PER_INCH;
    keys.optional(in_inches, inches).map(|value| Length::mm(value * MM_PER_INCH))
}

/// 60° unless stated; a point that is not stated is the one that the thread's standard has.
fn read_threading_insert(keys: &mut Keys<'_>) -> Insert {
    let angle = Angle::deg(keys.optional("flank_angle_deg", 10.0..=120.0).unwrap_or(60.0));
    let nose = keys.optional("nose_radius_mm", 0.0..=10.0);
    let flat = keys.optional("flat_mm", 0.0..=10.0);
    if nose.is_some() && flat.is_some() {
        keys.conflict(
            "flat_mm",
            "the insert's point is stated twice: expected one of `nose_radius_mm` and `flat_mm`",
        );
    }
    let crest_height = keys.optional("crest_height_mm", 0.01..=50.0).map(Length::mm);
    let nose = nose.map(|radius| InsertPoint::Nose(Length::mm(radius)));
    let flat = flat.map(|width| InsertPoint::Flat(Length::mm(width)));
    let orientation = read_orientation(keys);
    Insert { orientation, ..Insert::threading(angle, nose.or(flat), crest_height) }
}

/// 80° between its edges, a nose of 0.4 mm and an approach of 95° unless stated.
fn read_turning_insert(keys: &mut Keys<'_>) -> Insert {
    let angle = Angle::deg(keys.optional("point_angle_deg", 10.0..=120.0).unwrap_or(80.0));
    let nose = keys.optional("nose_radius_mm", 0.0..=100.0).unwrap_or(0.4);
    let approach = keys.optional("approach_angle_deg", 30.0..=120.0).map(Angle::deg);
    let approach = approach.unwrap_or(Insert::APPROACH.min(Angle::deg(175.0) - angle));
    if approach + angle > Angle::deg(179.0) {
        let most = 179.0 - angle.in_deg();
        keys.conflict(
            "approach_angle_deg",
            format!("no trailing edge is left behind the point: expected {most:.0} or less"),
        );
    }
    let length = keys.optional("edge_mm", 0.1..=100.0).map_or(Insert::EDGE, Length::mm);
    let edges = InsertEdges::Corner { approach, length };
    let orientation = read_orientation(keys);
    Insert { edges, orientation, ..Insert::turning(angle, Length::mm(nose)) }
}

/// Its width is stated; the point is its corner towards the chuck unless stated.
fn read_grooving_insert(keys: &mut Keys<'_>) -> Insert {
    let width = length(keys, ["width_mm", "width_in"], 0.1..=50.0);
    Insert { orientation: read_orientation(keys), ..Insert::grooving(width) }
}

fn read_orientation(keys: &mut Keys<'_>) -> Option<InsertOrientation> {
    let number = keys.optional_whole("orientation", 1..=9)?;
    InsertOrientation::new(u8::try_from(number).ok()?)
}

fn point_angle(keys: &mut Keys<'_>, usual_deg: f64) -> Angle {
    Angle::deg(keys.optional("point_angle_deg", 10.0..=180.0).unwrap_or(usual_deg))
}

/// Inserts by their number, or by the angles at which they stand.
fn read_polygon_cutter(keys: &mut Keys<'_>) -> PolygonCutter {
    const MOST_INSERTS: u32 = 64;
    let radius = length(keys, ["tip_radius_mm", "tip_radius_in"], 0.1..=LONGEST.value());
    let angles = keys.optional_numbers("insert_angles_deg", 0.0..=359.999);
    let inserts = if let Some(angles) = angles {
        if keys.has("inserts") {
            keys.conflict("inserts", "the inserts are stated twice: expected one of them");
            keys.optional_whole("inserts", 1..=MOST_INSERTS);
        }
        let rising = angles.windows(2).all(|pair| pair[0] < pair[1]);
        if angles.first() != Some(&0.0) || !rising || angles.len() > MOST_INSERTS as usize {
            keys.conflict(
                "insert_angles_deg",
                format!("expected at most {MOST_INSERTS} rising angles, the first of them 0"),
            );
        }
        angles.into_iter().map(Angle::deg).collect()
    } else {
        let count = keys.whole("inserts", 1..=MOST_INSERTS);
        (0..count).map(|n| Angle::rev(f64::from(n) / f64::from(count))).collect()
    };
    let nose_radius = optional_length(keys, ["nose_radius_mm", "nose_radius_in"], 0.0..=100.0)
        .unwrap_or(Length::mm(0.8));
    PolygonCutter { radius, inserts, nose_radius }
}

fn read_hob(keys: &mut Keys<'_>) -> HobTool {
    let hob = hob::usual(read_module(keys));
    let hands = [("right", Hand::Right), ("left", Hand::Left)];
    let senses = [("M3", false), ("M4", true)];
    let stated = |keys: &mut Keys<'_>, names, most: f64| optional_length(keys, names, 0.0..=most);
    let m = hob.module.value();
    let pressure = keys.optional("pressure_angle_deg", 5.0..=45.0);
    HobTool {
        starts: keys.optional_whole("starts", 1..=hob::MOST_STARTS).unwrap_or(hob.starts),
        hand: keys.optional_choice("hand", &hands).unwrap_or(hob.hand),
        pressure_angle: pressure.map_or(hob.pressure_angle, Angle::deg),
        addendum: stated(keys, ["addendum_mm", "addendum_in"], 3.0 * m).unwrap_or(hob.addendum),
        tip_radius: stated(keys, ["tip_radius_mm", "tip_radius_in"], m).unwrap_or(hob.tip_radius),
        length: stated(keys, ["hob_length_mm", "hob_length_in"], 2000.0),
        cuts_backwards: keys.optional_choice("cuts_with", &senses).unwrap_or(false),
        ..hob
    }
}

fn read_module(keys: &mut Keys<'_>) -> Length {
    const PITCH: &str = "diametral_pitch";
    let (least, most) = (*hob::MODULE_MM.start(), *hob::MODULE_MM.end());
    if !keys.has(PITCH) {
        return Length::mm(keys.number("module_mm", hob::MODULE_MM));
    }
    if keys.has("module_mm") {
        keys.conflict(PITCH, "`module_mm` states it too: expected one of them");
        keys.optional("module_mm", hob::MODULE_MM);
    }
    Length::mm(MM_PER_INCH / keys.number(PITCH, MM_PER_INCH / most..=MM_PER_INCH / least))
}

/// A tap's diameter may be left out; stated, it must be its thread's.
fn read_diameter(nominal: Option<Length>, keys: &mut Keys<'_>, origin: Origin) -> Length {
    const ALIKE: f64 = 0.05;
    const KEYS: [&str; 2] = ["diameter_mm", "diameter_in"];
    if origin == Origin::Control {
        return length(keys, KEYS, 0.0..=LONGEST.value());
    }
    let bounds = 0.001..=LONGEST.value();
    let Some(nominal) = nominal else { return length(keys, KEYS, bounds) };
    let Some(stated) = optional_length(keys, KEYS, bounds) else { return nominal };
    if (stated - nominal).abs() > nominal * ALIKE {
        keys.conflict(
            "diameter_mm",
            format!("`diameter_mm` is not the tool's: expected {}", nominal.value()),
        );
    }
    stated
}

fn read_thread(keys: &mut Keys<'_>) -> ThreadSize {
    let text = keys.text("thread");
    text.parse().unwrap_or_else(|_| {
        if keys.has("thread") {
            keys.unknown_name(
                "thread",
                format!(
                    "\"{text}\" is no thread: expected one such as \"M6x1\", \"1/4-20 UNC\", \"#10-32\", \"M8x1.25-LH\""
                ),
            );
        }
        ThreadSize::metric(Length::mm(6.0), Length::mm(1.0), Hand::Right) // refused above
    })
}

fn read_tap(thread: &ThreadSize, keys: &mut Keys<'_>) -> TapTool {
    let flutes = [
        ("spiral-flute", Flute::SpiralFlute),
        ("spiral-point", Flute::SpiralPoint),
        ("straight", Flute::Straight),
    ];
    let oversize = keys.optional("oversize_um", -100.0..=1000.0).map(Length::um);
    TapTool {
        designation: thread.designation.clone(),
        lead: thread.lead(),
        chamfer_pitches: keys.number("chamfer_pitches", 0.0..=20.0),
        thread_length: length(
            keys,
            ["thread_length_mm", "thread_length_in"],
            0.1..=LONGEST.value(),
        ),
        flute: keys.choice("flute", &flutes),
        oversize: oversize.unwrap_or_else(|| usual_oversize(thread)),
        holder: keys.section("holder", read_holder),
        max_torque: keys.optional("max_torque_n_m", 0.01..=10_000.0).map(Torque::n_m),
    }
}

fn read_holder(keys: &mut Keys<'_>) -> Holder {
    #[derive(Clone, Copy)]
    enum Kind {
        Rigid,
        SoftSynchro,
        TensionCompression,
        Clutch,
    }
    let kinds = [
        ("rigid", Kind::Rigid),
        ("soft-synchro", Kind::SoftSynchro),
        ("tension-compression", Kind::TensionCompression),
        ("clutch", Kind::Clutch),
    ];
    let kind = keys.choice("kind", &kinds);
    let stiffness = read_stiffness(keys);
    let mut travel = || Length::mm(keys.number("travel_mm", 0.001..=100.0));
    match kind {
        Kind::Rigid => Holder::Rigid { stiffness },
        Kind::SoftSynchro => Holder::SoftSynchro { stiffness, travel: travel() },
        Kind::TensionCompression => Holder::TensionCompression { stiffness, travel: travel() },
        Kind::Clutch => Holder::Clutch {
            spline_length: Length::mm(keys.number("spline_length_mm", 0.1..=50.0)),
            pawl_backlash: Angle::rev(keys.optional("pawl_backlash_rev", 0.0..=1.0).unwrap_or(0.0)),
            stiffness,
            compression: Length::mm(keys.optional("compression_mm", 0.0..=50.0).unwrap_or(0.0)),
        },
    }
}

/// In N/µm, or in N/mm as springs state it.
fn read_stiffness(keys: &mut Keys<'_>) -> Stiffness {
    let soft = keys.optional("stiffness_n_per_mm", 0.1..=1e6).map(Stiffness::n_per_mm);
    match soft {
        Some(stated) if !keys.has("stiffness_n_per_um") => stated,
        Some(stated) => {
            keys.conflict("stiffness_n_per_mm", "stiffness is stated twice: expected one of them");
            keys.optional("stiffness_n_per_um", 1e-4..=1e3);
            stated
        }
        None => n_per_um(keys.number("stiffness_n_per_um", 1e-4..=1e3)),
    }
}
