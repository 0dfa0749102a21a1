//! The `leadscrew` program.
fn main() {}
