//! The two sizes of a random or swept test: one for a change, in seconds, and one for a night.
//!
//! `LEADSCREW_TESTS=full cargo test` runs a night's size; `tools/nightly` does so for all of them.
use std::fmt::Display;

/// Returns `quick`, or `full` if `LEADSCREW_TESTS` is `full`, and prints which of the two it is.
///
/// # Panics
/// If `LEADSCREW_TESTS` has another value.
pub fn of<T: Display>(quick: T, full: T) -> T {
    if is_full() {
        eprintln!("size {full}, a night's; without LEADSCREW_TESTS=full it is {quick}");
        full
    } else {
        eprintln!("size {quick}, a change's; with LEADSCREW_TESTS=full it is {full}");
        quick
    }
}

/// Returns the first `quick` of a list, or all of it if `LEADSCREW_TESTS` is `full`, and prints how
/// many these are.
///
/// # Panics
/// If `LEADSCREW_TESTS` has another value.
pub fn first_of<T>(quick: usize, all: &[T]) -> &[T] {
    &all[..of(quick.min(all.len()), all.len())]
}

/// Returns whether a night's size is asked for.
///
/// # Panics
/// If `LEADSCREW_TESTS` has another value than `full`.
pub fn is_full() -> bool {
    match std::env::var_os("LEADSCREW_TESTS") {
        None => false,
        Some(size) if size == "full" => true,
        Some(size) => panic!(
            "LEADSCREW_TESTS is {}: `full` is a night's size, and without it a change's is run",
            size.display()
        ),
    }
}
