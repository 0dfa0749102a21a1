//! Programs, offsets, tools and alarms.
use super::values::Shown;
use crate::page_words::on_page;
use canon::{AtLimit, Tool, ToolKind, ToolLife};
use control::operation::hosted::WorkOffset;
use control::operation::{Alarm, LoadedProgram, PathKind};
use serde::Serialize;
use std::collections::BTreeMap;
use units::{Length, Time};

/// An alarm.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct AlarmBody {
    /// Number in the alarm list.
    pub number: u16,
    /// What has happened.
    pub text: String,
    /// What to do.
    pub remedy: String,
    /// The program that was under way.
    pub program: Option<String>,
    /// Its line; 0 is none.
    pub line: u32,
    /// Machine time.
    pub time_s: f64,
    /// A reset has cleared it.
    pub is_cleared: bool,
}

impl AlarmBody {
    /// Of an alarm of the control.
    pub(crate) fn of(alarm: &Alarm, shown: Shown<'_>) -> Self {
        Self {
            number: alarm.number,
            text: on_page(&alarm.text),
            remedy: on_page(&alarm.remedy),
            program: alarm.program.as_deref().map(shown),
            line: alarm.line,
            time_s: alarm.time.value(),
            is_cleared: alarm.is_cleared,
        }
    }
}

/// A work offset.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct OffsetBody {
    /// As a program writes it.
    pub work_offset: String,
    /// It is in force.
    pub is_active: bool,
    /// Its zero in machine coordinates by axis, mm or degrees.
    pub axes: BTreeMap<String, f64>,
}

impl OffsetBody {
    /// Of a work offset of the control.
    pub(crate) fn of(offset: &WorkOffset, active: &str) -> Self {
        let axes = offset.zeros.iter().map(|(axis, at)| (axis.letter().to_string(), at.value()));
        Self {
            work_offset: offset.name.clone(),
            is_active: offset.name == active,
            axes: axes.collect(),
        }
    }
}

/// A tool, as the control believes it to be.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct ToolBody {
    /// T number.
    pub number: u32,
    /// For people.
    pub description: String,
    /// `drill`, `spot drill`, `end mill`, `tap`, `polygon cutter`, `hob`, `insert`, `probe`,
    /// `other`.
    pub kind: &'static str,
    /// From the gauge line to the tip, without wear.
    pub length_mm: f64,
    /// Cutting diameter, without wear.
    pub diameter_mm: f64,
    /// Wear of the length, which is added.
    pub wear_length_mm: f64,
    /// Wear of the radius, which is added.
    pub wear_radius_mm: f64,
    /// How much it has cut, and may.
    pub life: ToolLifeBody,
}

/// How much a tool has cut, and how much it may; what has no limit is only counted.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct ToolLifeBody {
    /// Holes drilled or tapped; other cuts between two tool changes are one together.
    pub uses: u32,
    /// At most.
    pub most_uses: Option<u32>,
    /// Time in cutting moves, s.
    pub time_s: f64,
    /// At most, s.
    pub most_time_s: Option<f64>,
    /// Length of cutting moves, mm.
    pub cut_mm: f64,
    /// At most, mm.
    pub most_cut_mm: Option<f64>,
    /// It broke, and no one has said that a new one is in its place.
    pub is_broken: bool,
    /// The limit that is reached, in words.
    pub reached: Option<String>,
    /// A program that takes it at its limit is refused; else it is said.
    pub is_refused_at_limit: bool,
}

impl ToolLifeBody {
    fn of(life: &ToolLife) -> Self {
        let ToolLife { used, limit, at_limit, .. } = life;
        Self {
            uses: used.uses,
            most_uses: limit.uses,
            time_s: used.time.value(),
            most_time_s: limit.time.map(Time::value),
            cut_mm: used.length.value(),
            most_cut_mm: limit.length.map(Length::value),
            is_broken: life.is_broken,
            reached: life.reached(),
            is_refused_at_limit: *at_limit == AtLimit::Refuse,
        }
    }
}

impl ToolBody {
    /// Of a tool.
    pub(crate) fn of(tool: &Tool) -> Self {
        Self {
            number: tool.number,
            description: tool.description.clone(),
            kind: match tool.kind {
                ToolKind::Drill { .. } => "drill",
                ToolKind::SpotDrill { .. } => "spot drill",
                ToolKind::EndMill(_) => "end mill",
                ToolKind::Tap(_) => "tap",
                ToolKind::PolygonCutter(_) => "polygon cutter",
                ToolKind::Insert(_) => "insert",
                ToolKind::Hob(_) => "hob",
                ToolKind::Probe(_) => "probe",
                ToolKind::Other => "other",
            },
            length_mm: tool.length.value(),
            diameter_mm: tool.diameter.value(),
            wear_length_mm: tool.wear.length.value(),
            wear_radius_mm: tool.wear.radius.value(),
            life: ToolLifeBody::of(&tool.life),
        }
    }
}

/// A piece of the tool's way.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct SegmentBody {
    /// The program's line.
    pub line: u32,
    /// `rapid`, `feed`, `tap`, `thread`, `probe`.
    pub kind: &'static str,
    /// Places of the tip: X, Y, Z, mm.
    pub points: Vec<[f64; 3]>,
}

/// A hole of the program.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct HoleBody {
    /// The program's line.
    pub line: u32,
    /// `hole`, `tap`.
    pub kind: &'static str,
    /// Over it, at the R plane, mm.
    pub at: [f64; 3],
    /// Its programmed depth along Z, mm.
    pub bottom: f64,
}

/// The program that is loaded.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct ProgramBody {
    /// Its path below the folder of programs.
    pub name: String,
    /// Its text.
    pub text: String,
    /// The way of the tool's tip, in the work offset in force when it was loaded.
    pub segments: Vec<SegmentBody>,
    /// What is drilled and tapped.
    pub holes: Vec<HoleBody>,
    /// The way goes on after these segments.
    pub is_shortened: bool,
}

impl ProgramBody {
    /// Of a program of the control.
    pub(crate) fn of(program: &LoadedProgram, shown: Shown<'_>) -> Self {
        // a thousandth of a millimetre is more than a screen shows
        let place = |point: [f64; 3]| point.map(|value| (value * 1e4).round() / 1e4);
        let segments = program.path.segments.iter().map(|segment| SegmentBody {
            line: segment.line,
            kind: match segment.kind {
                PathKind::Rapid => "rapid",
                PathKind::Feed => "feed",
                PathKind::Tap => "tap",
                PathKind::Thread => "thread",
                PathKind::Probe => "probe",
            },
            points: segment.points.iter().copied().map(place).collect(),
        });
        let holes = program.path.holes.iter().map(|hole| HoleBody {
            line: hole.line,
            kind: if hole.is_tap { "tap" } else { "hole" },
            at: place(hole.at),
            bottom: hole.bottom,
        });
        Self {
            name: shown(&program.name),
            text: String::from_utf8_lossy(&program.text).into_owned(),
            segments: segments.collect(),
            holes: holes.collect(),
            is_shortened: program.path.is_shortened,
        }
    }
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct SavedBody {
    /// Below the folder, with `/`.
    pub path: String,
    /// Its size.
    #[ts(type = "number")]
    pub bytes: u64,
    /// Which version of the program it is: its `ETag`, without the quotes.
    pub version: String,
}
