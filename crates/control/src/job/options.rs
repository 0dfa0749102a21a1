//! What a program is loaded with, as plain values: which machine, which tools, how it is read. The
//! command line makes it from its arguments; anything else that runs a program (a design helper, a
//! test) writes it down.
use crate::config::machine_file::MachineSource;
use std::path::PathBuf;
use store::machine::Preset;
use store::tools::TableUnit;

/// Where programs, machines, tools and parameters come from.
#[allow(clippy::struct_excessive_bools, reason = "each is an option of its own")]
#[derive(Debug, Clone)]
pub struct ProgramOptions {
    /// The machine: name of a built-in model, or a file.
    pub machine: MachineSource,
    /// No machine is named: dialect, machine and tools are chosen by the program's own words
    /// ([`choice`](super::choice)) where they are not named.
    pub chooses: bool,
    /// The machine that is simulated, where it is another one than the control believes; `None` is
    /// the same.
    pub plant: Option<MachineSource>,
    /// Tool table; `None` is `tools.toml` or `tool.tbl` beside the program, else the built-in one.
    pub tools: Option<PathBuf>,
    /// The built-in table is none of this program's: its tools are what its comments say, and
    /// stand-ins.
    pub without_table: bool,
    /// The tool table is the one that would be used without a choice, and what it lacks is refused.
    pub keeps_table: bool,
    /// Unit of the lengths in a `.tbl`, which does not state it.
    pub tool_unit: TableUnit,
    /// Parameter file with work offsets; `None` is the machine's set-up.
    pub parameters: Option<PathBuf>,
    /// File with what stands on the inputs of a simulated machine, besides what the machine's file
    /// says.
    pub inputs: Option<PathBuf>,
    /// What to do with tools that the table lacks.
    pub missing_tools: interp::MissingTools,
    /// Holes that the program taps and does not drill are there.
    pub pre_drilled: bool,
    /// The stock, as a comment `(STOCK …)` has it, in mm; `None`: as the program's comment says,
    /// else the machine's file.
    pub stock: Option<String>,
    /// How taps are driven that no clutch holder holds; `None` is as the machine's file says.
    pub tapping: Option<plan::TapMethod>,
    /// What to do with a dwell that a clutch holder does not work with.
    pub clutch_dwell: plan::DwellCheck,
    /// How programs are read; `None` is as the machine's file says.
    pub dialect: Option<interp::Dialect>,
    /// What a number without a decimal point counts in Fanuc's dialects; `None` is as the machine's
    /// file says.
    pub decimal_point: Option<DecimalPoint>,
    /// What a program may leave to the machine, besides what the machine's file lets it.
    pub leaves: interp::Leaves,
    /// Levels of `/` whose blocks are left out, 1 to 9.
    pub block_skip: Vec<u8>,
    /// Folders in which subprogram files are looked for, besides the program's own and the machine
    /// file's.
    pub subprograms: Vec<PathBuf>,
    /// Cam library; `None` is `cams.toml` beside the program.
    pub cams: Option<PathBuf>,
    /// Table of measured phase errors.
    pub phase_table: Option<PathBuf>,
    /// How a cam is compensated.
    pub compensation: Compensation,
    /// Which estimate of the phase error is compensated.
    pub estimator: Estimator,
    /// How the work turns while a cam is ground; `None` is as the cam library says.
    pub work_speed: Option<store::cams::WorkSpeed>,
    /// Without the axes' feed-forward, in a program that grinds cams without that of X alone: shows
    /// the lag of their loops.
    pub without_feed_forward: bool,
    /// How hard taps are driven; `None` is as the machine's file says.
    pub tapping_preset: Option<Preset>,
}

impl ProgramOptions {
    /// For a machine, all else as it is where nothing is said.
    pub fn on(machine: impl Into<MachineSource>) -> Self {
        Self {
            machine: machine.into(),
            chooses: false,
            plant: None,
            tools: None,
            without_table: false,
            keeps_table: false,
            tool_unit: TableUnit::Millimetre,
            parameters: None,
            inputs: None,
            missing_tools: interp::MissingTools::Refuse,
            pre_drilled: false,
            stock: None,
            tapping: None,
            clutch_dwell: plan::DwellCheck::Refuse,
            dialect: None,
            decimal_point: None,
            leaves: interp::Leaves::default(),
            block_skip: Vec::new(),
            subprograms: Vec::new(),
            cams: None,
            phase_table: None,
            compensation: Compensation::Shift,
            estimator: Estimator::LeastSquares,
            work_speed: None,
            without_feed_forward: false,
            tapping_preset: None,
        }
    }
}

impl From<&str> for ProgramOptions {
    fn from(machine: &str) -> Self {
        Self::on(machine)
    }
}

/// What a number without a decimal point counts in Fanuc's dialects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalPoint {
    /// Least input increments: X10 is 0.010 mm.
    Increments,
    /// Whole units, as on a pocket calculator: X10 is 10 mm.
    Calculator,
}

/// How a cam is compensated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compensation {
    /// Not at all.
    Off,
    /// By the measured phase error in whole addresses of the table.
    Address,
    /// By the measured phase error as it is.
    Shift,
    /// By the measured phase error with the wrong sign: what a mistake looks like.
    Wrong,
    /// By gain and phase of every harmonic that was measured.
    Harmonics,
    /// By harmonics, and by what sampled turns with compensation on have taught.
    Learn,
}

/// How a phase error is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// The shift that makes the contour error least.
    LeastSquares,
    /// The mean shift of both flanks at half the lift.
    Flanks,
    /// The shift of the maximum.
    Maximum,
}
