//! A small writer of SVG: what a technical drawing on a page needs, and nothing else.
//!
//! ```text
//!   data (mm, µm, s) ── Scale ──► picture units ── path_data ──► "M12 40.5 13 41…"
//!                         │
//!                       ticks at 1-2-5 · 10ⁿ
//! ```
//!
//! The pictures stand inside an HTML page and take colours, dashes and fonts from its style sheet
//! by *class*, so that light, dark and print are decided in one place. Coordinates are rounded to a
//! tenth of a picture unit, and a value that is no number breaks a line instead of spoiling it.

mod chart;
mod path;
mod range;
mod stroke;
mod text;
mod ticks;

pub(crate) use chart::{Chart, Linked, Mark};
pub(crate) use path::{path_data, thinned};
pub(crate) use range::Range;
pub(crate) use stroke::Stroke;
pub(crate) use text::{Tag, coordinate, escape, fixed};
pub(crate) use ticks::{plain, powers, ticks};
