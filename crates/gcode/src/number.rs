//! Numbers: an optional sign, digits, at most one decimal point, at least one digit; no exponent.
//!
//! Nearly every byte of a large program belongs to a number, so the common ones are read by hand.
//! A decimal of at most 15 digits, f of them after the point, is `m / 10^f` with both m and 10^f
//! exactly representable (m < 2^53, f <= 15 < 23); IEEE division rounds once, so the quotient is
//! the nearest `f64`: the same as a full decimal conversion gives. Anything else (more digits,
//! blanks inside) goes to the standard library.
//!
//! Source: W. Clinger, "How to read floating point numbers accurately", PLDI 1990, section 3.

use crate::problem::Problem;

const POWERS_OF_TEN: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number at `from` and where it ends, if it is an ordinary one.
pub(crate) fn fast(text: &[u8], from: usize) -> Option<(f64, usize)> {
    let byte = |at: usize| text.get(at).copied().unwrap_or(0);
    let mut at = from;
    let negative = byte(at) == b'-';
    if negative || byte(at) == b'+' {
        at += 1;
    }
    let mut mantissa = 0u64;
    let digits = |at: &mut usize, mantissa: &mut u64| {
        let start = *at;
        loop {
            let digit = byte(*at).wrapping_sub(b'0');
            if digit > 9 {
                return *at - start;
            }
            *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            *at += 1;
        }
    };
    let whole = digits(&mut at, &mut mantissa);
    let mut fraction = 0;
    if byte(at) == b'.' {
        at += 1;
        fraction = digits(&mut at, &mut mantissa);
    }
    if whole + fraction == 0 || whole + fraction > 15 {
        return None;
    }
    // a blank does not end a number: `1 .5` is 1.5
    let mut next = at;
    while matches!(byte(next), b' ' | b'\t') {
        next += 1;
    }
    if matches!(byte(next), b'0'..=b'9' | b'.') {
        return None;
    }
    let value = mantissa as f64 / POWERS_OF_TEN[fraction];
    Some((if negative { -value } else { value }, at))
}

/// Any number at `from`, and where the attempt ends.
pub(crate) fn slow(text: &[u8], from: usize) -> (Result<f64, Problem>, usize) {
    let mut digits = String::new();
    let mut end = from;
    for (at, &byte) in text.iter().enumerate().skip(from) {
        match byte {
            b'0'..=b'9' | b'.' => digits.push(byte as char),
            b'+' | b'-' if digits.is_empty() => digits.push(byte as char),
            b' ' | b'\t' => continue,
            _ => break,
        }
        end = at + 1;
    }
    let value = match digits.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Problem::NumberTooLarge),
        Err(_) => Err(Problem::BadNumber),
    };
    (value, end)
}
