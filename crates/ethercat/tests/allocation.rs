//! No memory is taken.
