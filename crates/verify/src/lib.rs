//! The judge of the workpiece: from *recorded* motion, what was cut.
//!
//! The kernel says what it wanted and its monitor says what the encoders saw; neither decides
//! whether a thread is good. This crate knows only what crossed the wire ([`bus::Sample`]) and what
//! was asked ([`canon::Op`]), follows the tool's edges through the material, and measures the
//! result as an inspector would: depth, position, gauges.
//!
//! ```text
//!   canon::Op ────► which hole, where, how deep ─┐
//!                                                ├─► Judge ─► Feature { Hole | Thread | …, Verdict }
//!   bus::Sample ──► where the edges really were ─┘    │ ▲
//!                                                     ▼ │ destroyed in line N, cut again
//!                                     what is there: block, bar, polygons, gears
//! ```
//!
//! A verdict is about the part that comes off the machine: what is there is remembered
//! (`workpiece` of a block, `bar` and `turned::places` of a bar, `standing_polygons`,
//! `gear::again`), and a later cut takes a verdict back (`taken_back`).
mod bar;
mod cam;
mod chips;
mod class;
mod coming_down;
mod config;
mod contact;
mod feature;
mod gauge;
mod gear;
mod groove;
mod hole;
mod idle;
mod insert;
mod inspection;
mod judge;
mod judged;
mod looking_on;
mod milling;
mod polygon;
mod standing_polygons;
mod stroke;
mod summary;
mod taken_back;
mod tapped;
mod thread;
mod tolerance;
mod trend;
mod turned;
mod undone;
mod verdict;
mod watch;
mod workpiece;

pub use bar::Bar;
pub use cam::GroundCam;
pub use canon::{Family, Hand, ThreadSize};
pub use class::{ThreadClass, UnknownClass};
pub use config::{Config, Tolerances};
pub use contact::{Contact, Stock};
pub use feature::{Feature, FeatureKind};
pub use gauge::{CutThread, Gauge, Gauged};
pub use gear::{Gear, ToothSize};
pub use hole::Hole;
pub use idle::IdleTurns;
pub use judge::{Judge, Work};
pub use judged::Judged;
pub use milling::{HeightMap, Largest, MillStock, Milled, MillingPlace, RapidCut, StockSource};
pub use polygon::{Along, Facet, Polygon, Section};
pub use summary::{Count, Criterion, Headroom, Summary};
pub use tapped::{KnownHole, ProfilePoint, Thread};
pub use tolerance::Limits;
pub use trend::TorqueTrend;
pub use turned::{LeadOfTurn, TurnedLimits, TurnedSizes, TurnedThread};
pub use undone::Undone;
pub use verdict::Verdict;
pub use watch::{ACROSS_MM, AGAINST_MM, BEYOND_MM, Breach, Watch};
