//! Polygon turning: flats cut by a rotating cutter beside a rotating workpiece.
//!
//! Work spindle and tool spindle have parallel axes at the distance l and turn in the same sense;
//! the tool turns R times while the work turns once. Seen from the workpiece, each insert's tip
//! (radius r) runs
//!
//! ```text
//!   tip(φ) = (l+dx)·(cos φ, −sin φ) + dy·(sin φ, cos φ) − r·(cos((R−1)φ+δ+ε), sin((R−1)φ+δ+ε))
//!
//!              y │   facet                    φ    work spindle's angle
//!          ______│______ ← tip passes         δ    insert's angle in the cutter
//!         ╱      │      ╲                     dx   oscillation along the line of centres (X)
//!        ╱       │   l   ╲                    dy   oscillation across it (Y)
//!       │        ●────────┼──────────◎        ε    oscillation of the tool spindle's phase
//!        ╲      work     ╱          tool
//! ```
//!
//! An insert stands innermost when R·φ + δ is a whole turn: there it cuts the middle of a facet,
//! whose normal lies at −φ in the work. N inserts give N·R facets in one turn of the work if that
//! is whole. For R = 2 the path is an ellipse with half-axes l−r and l+r: a facet that bulges.
//! Oscillations take the bulge away.
//!
//! Source: seed 004 (JP7525593B2); its "2π/n" means 2πn/N, and its first disclosure swings X where
//! it says Z.
mod cut;
mod drive;
mod fine;
mod form;
mod kinematics;
mod lp;
mod optimise;
mod profile;
mod series;

pub use cut::Cut;
pub use drive::{Drive, Effort, Limits};
pub use form::{Facet, Form, Refusal};
pub use kinematics::{Cutter, Swing, Tip, insert_phases};
pub use optimise::{Detail, Problem, Solution};
pub use profile::Profile;
pub use series::{Actuator, Series, Swings, Term};
