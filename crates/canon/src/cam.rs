//! Cam grinding: the wheel follows the work's angle by a profile, cuts in by so much a turn, and
//! sparks out.
//!
//! ```text
//!   X │ retreat ─╮                                        ╭─ retreat      X = centre + D(θ − phase) + offset
//!     │          ╰╮ stock                                 │
//!     │           ╰──╲  infeed F a turn                   │              offset: what is left to take off
//!     │               ╲────── spark-out, P turns ─────────╯
//!     └──────────────────────────────────────────────────────► turns of the work
//! ```
//!
//! Source: JPH0622778B2: `G51 P`, `G52`, `G53`, `G55`, `G50`, `G01 X F R S`, `G04 S P`.
use alloc::vec::Vec;
use units::{Angle, Lead, Length, Spin};

/// What a program orders while it grinds a cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CamOrder {
    /// From here on the wheel follows this profile.
    Select {
        /// Its number.
        profile: u32,
        /// Angle of the work at which the profile begins: where this cam stands on its shaft.
        phase: Angle,
        /// X of the work's axis, machine coordinate: where the program has it.
        centre: Length,
        /// Z of the program's zero, machine coordinate of the axis.
        zero: Length,
    },
    /// The wheel goes back and follows nothing any more.
    Deselect,
    /// What is sent is compensated from here on, by what was measured.
    Compensate,
    /// Forget the samples taken so far.
    ResetSampling,
    /// Take samples of both encoders during the spark-out turns that follow.
    StartSampling,
    /// Compute the phase error from the samples and keep it for this profile and speed.
    StorePhase,
    /// Grind.
    Grind {
        /// How much is taken off, measured along X on the radius.
        stock: Length,
        /// Infeed for each turn of the work.
        per_turn: Length,
        /// How fast that infeed is made; a rate above it rests for what is left of the turn.
        rate: Lead,
        /// Speed of the work.
        spin: Spin,
    },
    /// Turn on without infeed: spark out after grinding, else an idle turn in the air where the
    /// wheel stands.
    SparkOut {
        /// Speed of the work.
        spin: Spin,
        /// How many turns.
        turns: u32,
    },
}

/// Where a wheel's centre belongs over one turn of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct CamProfile {
    /// Its number in programs.
    pub number: u32,
    /// What it is called.
    pub name: alloc::string::String,
    /// Distance of the wheel's centre from the work's axis at equal steps of the work's angle, mm.
    pub nodes: Vec<f64>,
    /// Radius of the wheel that they are for.
    pub wheel: Length,
    /// Largest first, second and third derivative of that distance: mm a revolution, its square,
    /// its cube. At a speed of n rev/s the axis needs so many times n, n², n³.
    pub steepest: [f64; 3],
}

impl CamProfile {
    /// The largest distance: farther out the wheel touches nothing.
    pub fn top(&self) -> Length {
        Length::mm(self.nodes.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }
}

/// The profiles that programs may call.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CamLibrary {
    profiles: Vec<CamProfile>,
}

impl CamLibrary {
    /// Of these; of two with one number the later counts.
    pub fn new(profiles: impl IntoIterator<Item = CamProfile>) -> Self {
        let mut library = Self::default();
        for profile in profiles {
            library.profiles.retain(|known| known.number != profile.number);
            library.profiles.push(profile);
        }
        library
    }

    /// The profile with this number.
    pub fn get(&self, number: u32) -> Option<&CamProfile> {
        self.profiles.iter().find(|profile| profile.number == number)
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &CamProfile> {
        self.profiles.iter()
    }
}
