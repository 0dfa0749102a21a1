//! Variables of a custom macro.
//!
//! ```text
//!   values   variables and expressions: #1, #<…>, [#1 + 2]
//!   system   system variables, from #1000 on: what a macro reads of the control, and what it may set
//!   output   DPRNT and BPRNT: what a macro writes
//! ```
pub(crate) mod output;
pub(crate) mod system;
pub(crate) mod values;

use crate::{front_end::fanuc::state::Fanuc, state::executor::Executor};

/// Everything an expression may read.
pub(crate) struct MacroValues<'a> {
    pub(crate) fanuc: &'a Fanuc,
    pub(crate) executor: &'a Executor,
    /// How many steps of what ROUND rounds to make one.
    pub(crate) per_unit: f64,
}
