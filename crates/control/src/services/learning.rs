//! What repeated taps have learnt, between the kernel and its file.
//!
//! ```text
//!   FILE ─► store::learning ─► kernel ─ a run ─► kernel ─► store::learning ─► FILE   (only if the program ended)
//! ```
use crate::Refused;
use std::path::{Path, PathBuf};
use store::learning::{Lesson as Filed, Lessons, mark};
use store::machine::MachineFile;
use sync::{CELLS, Learning, Lesson, StrokeKey};
use units::{Angle, Lead, Length, Spin, Time};

/// Gain and bandwidth where the machine's file does not state them: half the usual resonance of a screw.
const USUAL: Learning = Learning { gain: 0.7, bandwidth_hz: 70.0 };

/// Learning, switched on.
pub struct Memory {
    path: PathBuf,
    machine: String,
    mark: u32,
    /// What the file had.
    pub lessons: Vec<Lesson>,
}

impl Memory {
    /// As the command line says, else as the machine's file says; `None`: off.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn load(asked: Option<&Path>, machine: &MachineFile) -> Result<Option<Self>, Refused> {
        let of_machine = machine.control.learning.as_ref().and_then(|l| l.file.as_deref());
        let path = match asked.or(of_machine.map(Path::new)) {
            None => return Ok(None),
            Some(path) if path == Path::new("off") => return Ok(None),
            Some(path) => path.to_owned(),
        };
        let parts = (&machine.control, &machine.axes, &machine.spindles, &machine.tapping);
        let mark = mark(&format!("{parts:?}"));
        let filed = Lessons::load(&path, &machine.name, mark)?.unwrap_or_default();
        let lessons = filed.list.iter().map(unpacked).collect();
        Ok(Some(Self { path, machine: machine.name.clone(), mark, lessons }))
    }

    /// Write what is known now.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, lessons: &[Lesson]) -> Result<(), Refused> {
        let list = lessons.iter().filter(|lesson| lesson.strokes > 0).map(packed).collect();
        let lessons = Lessons { machine: self.machine.clone(), mark: self.mark, list };
        Ok(lessons.save(&self.path)?)
    }
}

/// How this machine learns.
pub fn how(machine: &MachineFile) -> Learning {
    machine
        .control
        .learning
        .as_ref()
        .map_or(USUAL, |l| Learning { gain: l.gain, bandwidth_hz: l.bandwidth_hz })
}

/// What was learnt, a line for each kind of stroke.
pub fn text(lessons: &[Lesson]) -> String {
    let mut said = String::new();
    for lesson in lessons.iter().filter(|lesson| lesson.strokes > 0) {
        let um = |score: Option<Length>| score.map_or(f64::NAN, Length::in_um);
        let end = if lesson.progress.is_over() { ", frozen" } else { "" };
        if lesson.early != Angle::ZERO {
            said += &format!(
                "learning: T{} at {:.0} rpm, {} strokes: the spindle is turned back {:+.2} turns earlier than its file makes one think; \
                 bottom missed by {:.1} µm in the first, {:.1} µm in the best\n",
                lesson.key.tool,
                lesson.key.spin.abs().in_rpm(),
                lesson.strokes,
                lesson.early.value(),
                um(lesson.first),
                um(lesson.best()),
            );
            continue;
        }
        said += &format!(
            "learning: T{} at {:.0} rpm, {} strokes: rms by the encoders {:.2} µm in the first, {:.2} µm in the best{end}\n",
            lesson.key.tool,
            lesson.key.spin.abs().in_rpm(),
            lesson.strokes,
            um(lesson.first),
            um(lesson.best()),
        );
    }
    said
}

fn unpacked(filed: &Filed) -> Lesson {
    let [lead, spin, back, turns, into, out] = filed.stroke;
    let key = StrokeKey {
        tool: filed.tool,
        lead: Lead::mm_per_rev(lead),
        spin: Spin::rev_per_s(spin),
        return_spin: Spin::rev_per_s(back),
        turns: Angle::rev(turns),
        times: (Time::s(into), Time::s(out)),
    };
    let mut lesson = Lesson::new(key, filed.gain);
    let [first, best] = filed.scores;
    (lesson.strokes, lesson.first) = (filed.strokes, Some(Length::mm(first)));
    (lesson.progress.best, lesson.progress.strikes) = (Some(best), filed.strikes);
    lesson.early = Angle::rev(filed.early);
    for (channel, cells) in [(&mut lesson.feed, &filed.feed), (&mut lesson.spindle, &filed.spindle)]
    {
        for (slot, value) in channel.best.iter_mut().zip(cells) {
            *slot = *value;
        }
        channel.cells = channel.best;
    }
    lesson
}

/// The best correction is what is kept: it has proved itself.
fn packed(lesson: &Lesson) -> Filed {
    let key = &lesson.key;
    let cells = |cells: &[f64; CELLS]| {
        let used = cells.iter().rposition(|u| *u != 0.0).map_or(0, |last| last + 1);
        cells[..used].to_vec()
    };
    let mm = |score: Option<Length>| score.map_or(0.0, Length::value);
    Filed {
        tool: key.tool,
        stroke: [
            key.lead.value(),
            key.spin.value(),
            key.return_spin.value(),
            key.turns.value(),
            key.times.0.value(),
            key.times.1.value(),
        ],
        strokes: lesson.strokes,
        gain: lesson.progress.gain,
        strikes: lesson.progress.strikes,
        scores: [mm(lesson.first), mm(lesson.best())],
        early: lesson.early.value(),
        feed: cells(&lesson.feed.best),
        spindle: cells(&lesson.spindle.best),
    }
}
