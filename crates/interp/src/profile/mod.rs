//! Lathe cycles that cut a profile: roughing in passes, finishing along it.
//!
//! ```text
//!    v                                start ●
//!    ▲     ┌───────────────pass────────────╱      level, level − I, level − 2·I, …
//!    │   exit                        entry╱
//!    │     │   ┌──────pass──────────◄────╱        each pass ends at the profile, comes away from it by R
//!    │     └───┐                        ╱         along and outwards, and goes back over what it has cut
//!    │         └──┐ pocket ┌────┐      ╱
//!    │            └────────┘    └─────● begin
//!    └──────────────────────────────────► −u
//! ```
//!
//! `u` is the way the passes go, `v` points out of the work: Z and X for turning (G71), X and Z for
//! facing (G72), each with the sign that makes the profile run along u and the start lie above it
//! ([`Facing`](shape::Facing)). What comes in is a [`Profile`](shape::Profile) of lines and arcs; a
//! [`parallel`](parallel::parallel) one leaves material; [`rough`](roughing::rough) walks it and
//! says the strokes. Of the language these files know nothing; [`turning`](crate::cycles::turning)
//! and [`record`](crate::cycles::record) do.
//!
//! Source: LinuxCNC 2.9 manual, "G70", "G71 G72"; order of the strokes measured on its stand-alone
//! interpreter.
pub(crate) mod corner;
pub(crate) mod parallel;
pub(crate) mod recording;
pub(crate) mod roughing;
pub(crate) mod shape;
