//! Numbers of words as whole numbers and as codes.

/// A code's number in tenths, if it has one decimal at most.
pub(crate) fn tenths(value: f64) -> Option<u16> {
    let scaled = value * 10.0;
    let tenths = (scaled + 0.5) as u16;
    let near = (scaled - f64::from(tenths)).abs() < 1e-3;
    (near && tenths <= 20_000).then_some(tenths)
}

/// The whole number that a value is, as near as LinuxCNC asks (0.0001).
pub(crate) fn near_whole(value: f64) -> Option<i64> {
    let whole = value.round();
    ((value - whole).abs() < 1e-4 && whole.abs() < 1e15).then_some(whole as i64)
}
