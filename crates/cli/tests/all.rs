//! What people do with `leadscrew`, and what they are told: one test program, so that it is linked
//! once.
#![allow(clippy::expect_used, clippy::needless_pass_by_value, clippy::unwrap_used, dead_code)] // tests may panic, and what they share is not used by each

mod common;
#[path = "common/editor.rs"]
mod editor;
#[path = "common/simulator.rs"]
mod simulator;

mod bad_input;
mod begun;
mod cams;
mod certificate;
mod codes;
mod compare;
mod console;
mod documented;
mod estimates;
mod exclusive;
mod fanuc;
mod guessed;
mod hobbing;
mod inputs;
mod judged_alike;
mod killed;
mod left_behind;
mod linuxcnc_import;
mod lsp;
mod lsp_writing;
mod milled_alike;
mod moving;
mod paces;
mod polygon;
mod polygon_claims;
mod polygon_refused;
mod preflight;
mod programs;
mod random_taps;
mod recovery;
mod rotary;
mod served;
mod shifted;
mod siblings;
mod spec;
mod spec_pictures;
mod standing;
mod supervised;
mod surface_speed;
mod tapping;
mod terminal;
mod trace;
mod version;
mod ways_out;
