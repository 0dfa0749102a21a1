//! What programs mean: one test program, so that it is linked once.
#![allow(clippy::unwrap_used, dead_code)] // tests may panic, and what they share is not used by each

mod shop;

mod borders;
mod brother;
mod by_word;
mod cam;
mod chip_removal;
mod compensation;
mod diagnostics;
mod endless;
mod fanuc;
mod fanuc_behaviours;
mod fanuc_checks;
mod fanuc_corners;
mod fanuc_macro;
mod fanuc_mapping;
mod fanuc_surfaces;
mod fanuc_turning;
mod floor;
mod grbl;
mod lathe_systems;
mod one_fault;
mod one_mistake;
mod operations;
mod other_dialect;
mod outputs;
mod parity;
mod properties;
mod steering;
mod taps;
