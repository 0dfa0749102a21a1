//! What a text tells of the control and the machine it was written for.
//!
//! ```text
//!   line            one line as letters and numbers
//!   words           which words give which dialect away, and how much they say
//!   other_dialect   its words belong to another dialect than the one it is read in
//!   other_machine   a printer, a lathe; a text that does not end
//!   whole_units     numbers without a point that make no sense as they are read
//! ```
pub(crate) mod line;
pub(crate) mod other_dialect;
pub(crate) mod other_machine;
pub(crate) mod whole_units;
pub(crate) mod words;
