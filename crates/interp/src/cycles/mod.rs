//! Cycles: one block that makes many moves. A cycle is a file.
//!
//! ```text
//!   holes/         drilling, tapping and boring, in their common course
//!   thread_cycle   G76: a thread in several passes
//!   turning        G70, G71, G72: roughing and finishing along a profile, which `record` takes down
//!   polygon        polygon turning
//!   hobbing        the work geared to the hob's spindle
//!   gear_comment   what the drawing asks of that gear
//!   cam            cam grinding
//! ```
//!
//! Each file has the words of its cycle, and the operation that is made of them.
pub(crate) mod cam;
pub(crate) mod gear_comment;
pub(crate) mod hobbing;
pub(crate) mod holes;
pub(crate) mod polygon;
pub(crate) mod record;
pub(crate) mod thread_cycle;
pub(crate) mod turning;
