//! Arguments that several commands take: where programs, machines and tools come from, and how
//! answers are printed.
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Where programs, machines, tools and parameters come from.
#[derive(Args, Debug, Clone)]
pub(crate) struct ProgramArgs {
    /// The machine: a name from `leadscrew machine list`, or a file
    /// [default: one that fits the program's words, else tapping-center]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) machine: Option<String>,
    /// Tool table: TOML, or LinuxCNC's .tbl [default: tools.toml or tool.tbl beside the program,
    /// else the embedded one]
    #[arg(long, value_name = "FILE")]
    pub(crate) tools: Option<PathBuf>,
    /// Unit of the lengths in a .tbl, which does not state it (a TOML table does)
    #[arg(long, value_enum, default_value_t = ToolUnit::Mm)]
    pub(crate) tool_unit: ToolUnit,
    /// Parameter file (.var) with work offsets [default: the machine's set-up]
    #[arg(long, value_name = "FILE")]
    pub(crate) parameters: Option<PathBuf>,
    /// What stands on the inputs of a simulated machine, besides what the machine's file says:
    /// lines such as `digital_3 = on at 2 s, off at 5 s` or
    /// `digital_1 = follows output 1 after 0.3 s`
    #[arg(long, value_name = "FILE")]
    pub(crate) inputs: Option<PathBuf>,
    /// What to do with tools that the table lacks [default: refuse; where no machine is named, as
    /// the program's words choose]
    #[arg(long, value_enum)]
    pub(crate) missing_tools: Option<MissingTools>,
    /// Holes that the program taps and does not drill are there, as the comment (PRE-DRILLED) says
    #[arg(long)]
    pub(crate) pre_drilled: bool,
    /// The stock, in place of the program's comment (STOCK …) and of the machine's file: a bar such
    /// as 'DIA 32 LENGTH 80', two corners in G54 such as 'X0 Y0 Z-20 X100 Y60 Z0', or a size; mm
    #[arg(long, value_name = "STOCK", allow_hyphen_values = true)]
    pub(crate) stock: Option<String>,
    /// How taps are driven that no clutch holder holds [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) tapping: Option<Tapping>,
    /// What to do with a dwell (P) that a clutch holder does not work with
    #[arg(long, value_enum, default_value_t = ClutchDwell::Refuse)]
    pub(crate) clutch_dwell: ClutchDwell,
    /// How programs are read [default: as the machine's file says; where no machine is named, as
    /// the program's words say]
    #[arg(long, value_enum)]
    pub(crate) dialect: Option<DialectChoice>,
    /// What a number without a decimal point counts in Fanuc's dialects
    /// [default: as the machine's file says, else increments]
    #[arg(long, value_enum)]
    pub(crate) decimal_point: Option<DecimalPoint>,
    /// What is accepted of programs for other machines, as in --accept unknown-m-codes,no-end; the
    /// machine's file may say it under [control.programs]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT")]
    pub(crate) accept: Vec<Accept>,
    /// Leave out blocks that begin with `/` of these levels (1 is `/` alone), as in --block-skip
    /// 1,2
    #[arg(long, value_delimiter = ',', value_name = "LEVEL", value_parser = clap::value_parser!(u8).range(1..=9))]
    pub(crate) block_skip: Vec<u8>,
    /// Folder in which subprogram files are looked for, besides the program's own and those of the
    /// machine's file; may be given more than once
    #[arg(long, value_name = "DIR")]
    pub(crate) subprograms: Vec<PathBuf>,
    /// Cam library (TOML) [default: cams.toml beside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) cams: Option<PathBuf>,
    /// Table of measured phase errors: read if it is there, written when a program has measured
    #[arg(long, value_name = "FILE")]
    pub(crate) phase_table: Option<PathBuf>,
    /// How a cam is compensated after G50 (G150)
    #[arg(long, value_enum, default_value_t = Compensation::Shift)]
    pub(crate) compensation: Compensation,
    /// Which estimate of the phase error is compensated
    #[arg(long, value_enum, default_value_t = Estimator::LeastSquares)]
    pub(crate) estimator: Estimator,
    /// How the work turns while a cam is ground [default: as the cam library says]
    #[arg(long, value_enum)]
    pub(crate) work_speed: Option<WorkSpeedChoice>,
    /// Feed-forward of the axes, in a program that grinds cams of X alone, which follows the work
    /// (spindles keep theirs): `off` shows the lag of their loops
    #[arg(long, value_enum)]
    pub(crate) feed_forward: Option<Switch>,
    /// How hard taps are driven [default: the machine's]
    #[arg(long, value_enum, value_name = "PRESET")]
    pub(crate) tapping_preset: Option<TappingPreset>,
}

/// Unit of the lengths in a tool table.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ToolUnit {
    /// Millimetres
    Mm,
    /// Inches
    Inch,
}

/// What to do with tools that the table lacks.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MissingTools {
    /// Refuse the program and list them
    Refuse,
    /// Assume a tool of no length that cuts nothing judged, and say so
    StandIn,
}

/// How taps are driven.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tapping {
    /// The feed follows the spindle, in and out
    Synchronised,
    /// Feed and spindle only run at their speeds; a tension/compression holder takes the difference
    Floating,
}

/// What to do with a dwell that a clutch holder does not work with.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClutchDwell {
    /// Refuse the program and say which dwell works
    Refuse,
    /// Say so, and do it: to see what becomes of the thread
    Warn,
}

/// How programs are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DialectChoice(pub(crate) interp::Dialect);

impl ValueEnum for DialectChoice {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [DialectChoice; interp::Dialect::ALL.len()] = {
            let mut all = [DialectChoice(interp::Dialect::LinuxCnc); interp::Dialect::ALL.len()];
            let mut i = 0;
            while i < all.len() {
                all[i] = DialectChoice(interp::Dialect::ALL[i]);
                i += 1;
            }
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(clap::builder::PossibleValue::new(self.0.name()).help(self.0.about()))
    }
}

/// What is accepted of programs for other machines.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Accept {
    /// M codes that neither the dialect nor the machine's file knows: they have no effect, with a
    /// remark for each
    UnknownMCodes,
    /// A program without M2 or M30: it ends where its text does
    NoEnd,
}

/// What a number without a decimal point counts in Fanuc's dialects.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DecimalPoint {
    /// Least input increments: X10 is 0.010 mm
    Increments,
    /// Whole units, as on a pocket calculator: X10 is 10 mm
    Calculator,
}

/// How a cam is compensated.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compensation {
    /// Not at all
    Off,
    /// By the measured phase error in whole addresses of the table
    Address,
    /// By the measured phase error as it is
    Shift,
    /// By the measured phase error with the wrong sign: what a mistake looks like
    Wrong,
    /// By gain and phase of every harmonic that was measured
    Harmonics,
    /// By harmonics, and by what sampled turns with compensation on have taught
    Learn,
}

/// How a phase error is estimated.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Estimator {
    /// The shift that makes the contour error least
    LeastSquares,
    /// The mean shift of both flanks at half the lift
    Flanks,
    /// The shift of the maximum
    Maximum,
}

/// How the work turns while a cam is ground.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WorkSpeedChoice {
    /// At the programmed speed
    Constant,
    /// Slower where the contact runs fast along the contour: as even a removal as the axes allow, S
    /// is the mean
    Even,
}

/// On or off.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Switch {
    /// As the machine's file says
    On,
    /// None
    Off,
}

/// How hard taps are driven; the machine's file says what each means.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TappingPreset {
    /// Half the dynamics: for weak work, long tools and first parts
    Gentle,
    /// What the spindle is planned with otherwise
    Standard,
    /// A little of the control's reserve is spent
    Fast,
    /// Nearly all of it: only where the material is known
    Max,
}

/// How a summary is printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// For people
    Text,
    /// For programs: the certificate
    Json,
}
