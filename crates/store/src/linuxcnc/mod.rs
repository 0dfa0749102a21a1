//! A LinuxCNC configuration as a machine file: INI and HAL files in, one of our files and a list of
//! remarks out.
//!
//! ```text
//!   mill.ini ─► ini ──┐                        ┌─► text of the machine file, or none
//!                     ├─► machine, axes, spindles ─► remarks: taken, guessed, missing, rewire, not read, safety, wrong
//!   *.hal ────► hal ──┘                        └   (each with its key, and where it comes from)
//! ```
//!
//! Everything is said at once, and of each key and each pin of LinuxCNC's own components there is a
//! line. One remark that is *wrong* and there is no file; what is *guessed*
//! or *missing* stands in the file with the value that was put in its place. Lengths are in mm from
//! here on, whatever the configuration counts in.
//!
//! LinuxCNC's rules, from its documentation of INI files and homing: names are in capitals; the
//! first of several equal keys counts; a remark is a line of its own; an axis obeys the tightest of
//! its own limits, its joints' and `[TRAJ]`'s.
mod axes;
mod compensation;
mod files;
mod hal;
mod homing;
mod ini;
mod keys_left;
mod machine;
#[cfg(test)]
mod nothing_lost;
mod pins;
mod rewire;
mod spindles;
#[cfg(test)]
mod tests;
mod writer;

pub use files::{Import, read};
pub use hal::Hal;
pub use ini::{CitedLine, Ini};
pub use machine::import;
pub use pins::{Fate, fate};
pub use writer::{Remark, RemarkKind};
