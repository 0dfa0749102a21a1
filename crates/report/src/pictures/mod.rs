//! The report's pictures: one file each. A picture takes what was recorded and judged, and gives a
//! figure: a heading, a drawing with axis titles and units, and a caption that says what to look
//! for.

mod chip_removal;
mod figure;
mod floating;
mod gear;
mod hole_by_hole;
mod hole_map;
mod milled;
mod pace;
mod phase_plane;
mod polygon;
mod recovery_plane;
mod spindle_over_time;
mod sync_error;
mod time_shares;
mod timeline;
mod tool_path;
mod torque_plane;

pub(crate) use chip_removal::chip_removal;
pub(crate) use figure::{ThreadView, figure};
pub(crate) use floating::floating;
pub(crate) use gear::gear;
pub(crate) use hole_by_hole::hole_by_hole;
pub(crate) use hole_map::hole_map;
pub(crate) use milled::milled;
pub(crate) use pace::pace;
pub(crate) use phase_plane::phase_plane;
pub(crate) use polygon::polygon;
pub(crate) use recovery_plane::recovery_plane;
pub(crate) use spindle_over_time::spindle_over_time;
pub(crate) use sync_error::{sync_error, tolerance_share};
pub(crate) use time_shares::time_shares;
pub(crate) use timeline::timeline;
pub(crate) use tool_path::tool_path;
pub(crate) use torque_plane::torque_plane;
