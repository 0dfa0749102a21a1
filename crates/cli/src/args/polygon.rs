//! The arguments of `leadscrew polygon`.
use super::Format;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew polygon`.
#[derive(Args, Debug, Clone)]
pub(crate) struct PolygonArgs {
    /// Sides of a regular polygon
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000), conflicts_with_all = ["insert_angles", "inserts"])]
    pub(crate) sides: u32,
    /// Where the inserts stand in the cutter, degrees: rhombi and other forms
    #[arg(long, value_name = "DEG,…", value_delimiter = ',')]
    pub(crate) insert_angles: Vec<f64>,
    /// Equally spaced inserts in the cutter [default: as the sides need]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) inserts: Option<u32>,
    /// Size across flats, mm
    #[arg(long, value_name = "MM")]
    pub(crate) across_flats: f64,
    /// From the tool spindle's axis to the inserts' tips, mm
    #[arg(long, value_name = "MM", default_value_t = 50.0)]
    pub(crate) tip_radius: f64,
    /// Turns of the work and of the tool
    #[arg(long, value_name = "WORK:TOOL", default_value = "1:2", allow_hyphen_values = true)]
    pub(crate) ratio: String,
    /// Diameter of the bar, mm [default: the machine's stock]
    #[arg(long, value_name = "MM")]
    pub(crate) stock: Option<f64>,
    /// Speed of the work, rev/min
    #[arg(long, value_name = "RPM", default_value_t = 500.0)]
    pub(crate) speed: f64,
    /// Flatness wanted, µm: says how fast it can be had
    #[arg(long, value_name = "UM")]
    pub(crate) flatness: Option<f64>,
    /// What may swing
    #[arg(long, value_enum, default_value_t = ActuatorChoice::Auto)]
    pub(crate) actuator: ActuatorChoice,
    /// Harmonics of each oscillation [default: 4, and as many as it takes where a limit binds]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=32))]
    pub(crate) harmonics: Option<u32>,
    /// Table that G51.4 has written: what the loops really make of an oscillation is taken into
    /// account
    #[arg(long, value_name = "FILE")]
    pub(crate) phase_table: Option<PathBuf>,
    /// Cut it on the simulated machine, from 100 to 1000 rpm, as computed and with an air cut's
    /// measurement compensated
    #[arg(long)]
    pub(crate) simulate: bool,
    /// Length of the polygon, mm
    #[arg(long, value_name = "MM", default_value_t = 20.0)]
    pub(crate) length: f64,
    /// Feed along Z, mm per turn of the work
    #[arg(long, value_name = "MM", default_value_t = 0.1)]
    pub(crate) feed: f64,
    /// Number of the cutter in the tool table [default: the one that the form needs, else a number
    /// that is free]
    #[arg(long, value_name = "N")]
    pub(crate) tool: Option<u32>,
    /// The tool table [default: the embedded one]
    #[arg(long, value_name = "FILE")]
    pub(crate) tools: Option<PathBuf>,
    /// Inside a bore instead of outside
    #[arg(long)]
    pub(crate) internal: bool,
    /// The machine: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "polygon-lathe")]
    pub(crate) machine: String,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// A page with table and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// What may swing.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ActuatorChoice {
    /// Whatever is flattest
    Auto,
    /// The line of centres
    X,
    /// Across it
    Y,
    /// Both slides
    Xy,
    /// The line of centres and the tool spindle's phase
    XPhase,
    /// Both slides and the phase
    All,
    /// The tool spindle's phase
    Phase,
}

impl From<ActuatorChoice> for canon::Actuator {
    fn from(choice: ActuatorChoice) -> Self {
        match choice {
            ActuatorChoice::Auto => Self::Any,
            ActuatorChoice::Phase => Self::ToolPhase,
            ActuatorChoice::X => Self::CentreLine,
            ActuatorChoice::Y => Self::Across,
            ActuatorChoice::Xy => Self::Both,
            ActuatorChoice::XPhase => Self::CentreLineAndPhase,
            ActuatorChoice::All => Self::All,
        }
    }
}
