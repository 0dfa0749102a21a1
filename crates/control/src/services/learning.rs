//! What repeated taps have learnt, between the kernel and its file.
//!
//! ```text
//!   FILE ─► store::learning ─► kernel ─ a run ─► kernel ─► store::learning ─► FILE   (only if the program ended)
//! ```
use crate::Refused;
use std::path::{Path, PathBuf};
use store::learning::{LearningRecord as Filed, LearningRecords, mark};
use store::machine::MachineFile;
use sync::{CELLS, Learning, LearningRecord, StrokeKey};
use units::{Angle, Lead, Length, Spin, Time};

/// Gain and bandwidth where the machine's file does not state them: half the usual resonance of a screw.
const USUAL: Learning = Learning { gain: 0.7, bandwidth_hz: 70.0 };

/// Learning, switched on.
pub struct Memory {
    path: PathBuf,
    machine: String,
    mark: u32,
    /// What the file had.
    pub records: Vec<LearningRecord>,
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
        let filed = LearningRecords::load(&path, &machine.name, mark)?.unwrap_or_default();
        let records = filed.list.iter().map(unpacked).collect();
        Ok(Some(Self { path, machine: machine.name.clone(), mark, records }))
    }

    /// Write what is known now.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, records: &[LearningRecord]) -> Result<(), Refused> {
        let list = records.iter().filter(|record| record.strokes > 0).map(packed).collect();
        let records = LearningRecords { machine: self.machine.clone(), mark: self.mark, list };
        Ok(records.save(&self.path)?)
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
pub fn text(records: &[LearningRecord]) -> String {
    let mut said = String::new();
    for record in records.iter().filter(|record| record.strokes > 0) {
        let um = |score: Option<Length>| score.map_or(f64::NAN, Length::in_um);
        let end = if record.progress.is_over() { ", frozen" } else { "" };
        if record.early != Angle::ZERO {
            said += &format!(
                "learning: T{} at {:.0} rpm, {} strokes: the spindle is turned back {:+.2} turns earlier than its file makes one think; \
                 bottom missed by {:.1} µm in the first, {:.1} µm in the best\n",
                record.key.tool,
                record.key.spin.abs().in_rpm(),
                record.strokes,
                record.early.value(),
                um(record.first),
                um(record.best()),
            );
            continue;
        }
        said += &format!(
            "learning: T{} at {:.0} rpm, {} strokes: rms by the encoders {:.2} µm in the first, {:.2} µm in the best{end}\n",
            record.key.tool,
            record.key.spin.abs().in_rpm(),
            record.strokes,
            um(record.first),
            um(record.best()),
        );
    }
    said
}

fn unpacked(filed: &Filed) -> LearningRecord {
    let [lead, spin, back, turns, into, out] = filed.stroke;
    let key = StrokeKey {
        tool: filed.tool,
        lead: Lead::mm_per_rev(lead),
        spin: Spin::rev_per_s(spin),
        return_spin: Spin::rev_per_s(back),
        turns: Angle::rev(turns),
        times: (Time::s(into), Time::s(out)),
    };
    let mut record = LearningRecord::new(key, filed.gain);
    let [first, best] = filed.scores;
    (record.strokes, record.first) = (filed.strokes, Some(Length::mm(first)));
    (record.progress.best, record.progress.strikes) = (Some(best), filed.strikes);
    record.early = Angle::rev(filed.early);
    for (channel, cells) in [(&mut record.feed, &filed.feed), (&mut record.spindle, &filed.spindle)]
    {
        for (slot, value) in channel.best.iter_mut().zip(cells) {
            *slot = *value;
        }
        channel.cells = channel.best;
    }
    record
}

/// The best correction is what is kept: it has proved itself.
fn packed(record: &LearningRecord) -> Filed {
    let key = &record.key;
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
        strokes: record.strokes,
        gain: record.progress.gain,
        strikes: record.progress.strikes,
        scores: [mm(record.first), mm(record.best())],
        early: record.early.value(),
        feed: cells(&record.feed.best),
        spindle: cells(&record.spindle.best),
    }
}
