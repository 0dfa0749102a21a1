//! The arguments of `leadscrew cam`.
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `leadscrew cam`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CamArgs {
    /// Lift table: a row each angle, `angle,lift` in degrees and millimetres, over a whole turn
    pub(crate) table: Option<PathBuf>,
    /// Instead of a table: a closed form [default: automotive]
    #[arg(long, value_enum, conflicts_with = "table")]
    pub(crate) form: Option<CamFormName>,
    /// Radius of the base circle (eccentric, lobes: mean radius), mm [default without a table: 25]
    #[arg(long, value_name = "MM")]
    pub(crate) base: Option<f64>,
    /// Lift of a closed form, mm
    #[arg(long, value_name = "MM", default_value_t = 8.0)]
    pub(crate) lift: f64,
    /// Half of the angle over which a valve is open; angle of rise and of fall of a polynomial
    #[arg(long, value_name = "DEG", default_value_t = 65.0)]
    pub(crate) half_angle: f64,
    /// Lobes of a lobed cam
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub(crate) lobes: u32,
    /// What runs on the cam
    #[arg(long, value_enum, default_value_t = CamFollower::Flat)]
    pub(crate) follower: CamFollower,
    /// Radius of a roller follower, mm
    #[arg(long, value_name = "MM")]
    pub(crate) roller_radius: Option<f64>,
    /// Radius of the new wheel, mm [default: the machine's]
    #[arg(long, value_name = "MM")]
    pub(crate) wheel_radius: Option<f64>,
    /// What the wheel has lost of its radius, mm [default: the machine's]
    #[arg(long, value_name = "MM")]
    pub(crate) wheel_wear: Option<f64>,
    /// Speed of the work, rev/min
    #[arg(long, value_name = "RPM", default_value_t = 60.0)]
    pub(crate) speed: f64,
    /// Steps of a turn of the wheel's table
    #[arg(long, value_name = "N", default_value_t = 720)]
    pub(crate) nodes: usize,
    /// The machine whose limits count
    #[arg(long, value_name = "NAME|FILE", default_value = "cam-grinder")]
    pub(crate) machine: String,
    /// Number of the profile in the G-code
    #[arg(long, value_name = "P", default_value_t = 1)]
    pub(crate) number: u32,
    /// What is printed
    #[arg(long, value_enum, default_value_t = CamOutput::Text)]
    pub(crate) format: CamOutput,
    /// A page with figures and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// Closed forms.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamFormName {
    /// A circle off its axis by half the lift
    Eccentric,
    /// A harmonic lift over the whole turn
    Harmonic,
    /// Equal lobes
    Lobes,
    /// Rise and fall by 10u³ − 15u⁴ + 6u⁵
    Polynomial,
    /// L·(1 − u²)³ over ± the half angle
    Automotive,
}

/// Followers.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamFollower {
    /// A flat face
    Flat,
    /// A roller
    Roller,
    /// An edge: the lift is the contour's
    Knife,
}

impl From<CamFollower> for store::cams::FollowerKind {
    fn from(follower: CamFollower) -> Self {
        match follower {
            CamFollower::Flat => Self::Flat,
            CamFollower::Roller => Self::Roller,
            CamFollower::Knife => Self::Knife,
        }
    }
}

/// What `leadscrew cam` prints.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamOutput {
    /// Figures and the G-code block
    Text,
    /// CSV: C, X, work speed
    Table,
    /// The G-code block alone
    Gcode,
    /// One JSON object
    Json,
}
