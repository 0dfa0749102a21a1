//! What repeated taps have learnt, between the kernel and its file.
//!
//! ```text
//!   FILE ─► store::learning ─► kernel ─ a run ─► kernel ─► store::learning ─► FILE   (only if the program ended)
//! ```
use crate::Refused;
use std::path::{Path, PathBuf};
use store::learning::{BandRecord, LearningRecord as Filed, LearningRecords, mark, rounded};
use store::machine::MachineFile;
use sync::supervision::band::{BandKey, StrokeBand, Trend};
use sync::supervision::depth::BINS;
use sync::supervision::own::OwnTorque;
use sync::{CELLS, Learning, LearningRecord, StrokeKey};
use units::{Angle, Lead, Length, Spin, Time};

/// Gain and bandwidth where the machine's file does not state them: half the usual resonance of a
/// screw.
const USUAL: Learning = Learning { gain: 0.7, bandwidth_hz: 70.0 };

/// Nanometres in a millimetre.
const NANO: f64 = 1e-6;
/// Billionths.
const BILLIONTH: f64 = 1e-9;

/// Learning, switched on.
pub struct Memory {
    path: PathBuf,
    machine: String,
    mark: u32,
    /// What the file had.
    pub records: Vec<LearningRecord>,
    /// What good holes were like, as the file had it.
    pub bands: Vec<StrokeBand>,
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
        let bands = filed.bands.iter().map(unpacked_band).collect();
        Ok(Some(Self { path, machine: machine.name.clone(), mark, records, bands }))
    }

    /// Write what is known now.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, records: &[LearningRecord], bands: &[StrokeBand]) -> Result<(), Refused> {
        let list = records.iter().filter(|record| record.strokes > 0).map(packed).collect();
        let bands = bands.iter().filter(|band| band.holes > 0).map(packed_band).collect();
        Ok(LearningRecords::new(&self.machine, self.mark, list).with(bands).save(&self.path)?)
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
    let key = StrokeKey {
        tool: filed.tool,
        lead: Lead::mm_per_rev(filed.lead_mm_per_rev),
        spin: Spin::rev_per_s(filed.spin_rev_per_s),
        return_spin: Spin::rev_per_s(filed.return_spin_rev_per_s),
        turns: Angle::rev(filed.turns_rev),
        times: (Time::s(filed.time_in_s), Time::s(filed.time_out_s)),
    };
    let mut record = LearningRecord::new(key, filed.gain);
    (record.strokes, record.first) = (filed.strokes, Some(Length::mm(filed.first_mm)));
    (record.progress.best, record.progress.strikes) = (Some(filed.best_mm), filed.strikes);
    record.early = Angle::rev(filed.early_rev);
    for (channel, cells, unit) in [
        (&mut record.feed, &filed.feed_nm, NANO),
        (&mut record.spindle, &filed.spindle_1e9_rev, BILLIONTH),
    ] {
        for (slot, value) in channel.best.iter_mut().zip(cells) {
            *slot = *value * unit;
        }
        channel.cells = channel.best;
    }
    record
}

/// The best correction is what is kept: it has proved itself.
fn packed(record: &LearningRecord) -> Filed {
    let key = &record.key;
    let cells = |cells: &[f64; CELLS], unit: f64| {
        let used = cells.iter().rposition(|u| *u != 0.0).map_or(0, |last| last + 1);
        cells[..used].iter().map(|value| rounded(value / unit)).collect()
    };
    let mm = |score: Option<Length>| score.map_or(0.0, Length::value);
    Filed {
        tool: key.tool,
        lead_mm_per_rev: key.lead.value(),
        spin_rev_per_s: key.spin.value(),
        return_spin_rev_per_s: key.return_spin.value(),
        turns_rev: key.turns.value(),
        time_in_s: key.times.0.value(),
        time_out_s: key.times.1.value(),
        strokes: record.strokes,
        gain: record.progress.gain,
        strikes: record.progress.strikes,
        first_mm: mm(record.first),
        best_mm: mm(record.best()),
        early_rev: record.early.value(),
        feed_nm: cells(&record.feed.best, NANO),
        spindle_1e9_rev: cells(&record.spindle.best, BILLIONTH),
    }
}

fn unpacked_band(filed: &BandRecord) -> StrokeBand {
    let bins = |list: &[f64]| {
        let mut bins = [0.0; BINS];
        bins.iter_mut().zip(list).for_each(|(bin, value)| *bin = *value);
        bins
    };
    StrokeBand {
        key: BandKey {
            tool: filed.tool,
            lead: Lead::mm_per_rev(filed.lead_mm_per_rev),
            spin: Spin::rev_per_s(filed.spin_rev_per_s),
            return_spin: Spin::rev_per_s(filed.return_spin_rev_per_s),
            run_in: Length::mm(filed.run_in_mm),
            depth: Length::mm(filed.depth_mm),
        },
        holes: filed.holes,
        mean: [bins(&filed.mean_in_n_m), bins(&filed.mean_out_n_m)],
        squares: [bins(&filed.squares_in), bins(&filed.squares_out)],
        level: filed.level,
        trend: Trend { holes: filed.trend_holes, sums: filed.trend_sums },
        own: OwnTorque { squares: filed.own_squares, products: filed.own_products },
    }
}

fn packed_band(band: &StrokeBand) -> BandRecord {
    let key = &band.key;
    let bins = |list: &[f64; BINS]| list.iter().copied().map(rounded_torque).collect();
    BandRecord {
        tool: key.tool,
        lead_mm_per_rev: key.lead.value(),
        spin_rev_per_s: key.spin.value(),
        return_spin_rev_per_s: key.return_spin.value(),
        run_in_mm: key.run_in.value(),
        depth_mm: key.depth.value(),
        holes: band.holes,
        level: band.level,
        mean_in_n_m: bins(&band.mean[0]),
        mean_out_n_m: bins(&band.mean[1]),
        squares_in: bins(&band.squares[0]),
        squares_out: bins(&band.squares[1]),
        trend_holes: band.trend.holes,
        trend_sums: band.trend.sums,
        own_squares: band.own.squares,
        own_products: band.own.products,
    }
}

/// A micronewton metre is far below any reading.
fn rounded_torque(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
