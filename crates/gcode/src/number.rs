//! Numbers: an optional sign, digits, at most one decimal point, at least one digit; no exponent.
//!
//! Nearly every byte of a large program belongs to a number, so the common ones are read by hand.
//! A decimal of at most 15 digits, f of them after the point, is `m / 10^f` with both m and 10^f
//! exactly representable (m < 2^53, f <= 15 < 23); IEEE division rounds once, so the quotient is
//! the nearest `f64`: the same as a full decimal conversion gives. Anything else (more digits,
//! blanks inside) goes to the standard library.
//!
//! Up to eight digits are read at once, as the bytes of one word:
//!
//! ```text
//!   "12.375 Y…"   12.375␣Y  ──► 12375␣Y… ──► 00012375   ──► 12·10³ + 375    (pairs, fours, eights:
//!                 whole = 2      digits = 5   aligned         / 10^(5 − 2)     three multiplications)
//! ```
//!
//! Source: W. Clinger, "How to read floating point numbers accurately", PLDI 1990, section 3.

use crate::problem::Problem;

/// The digit 0 in each byte of a word.
const ZEROS: u64 = 0x3030_3030_3030_3030;

const POWERS_OF_TEN: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number at `from` and where it ends, if it is an ordinary one. `text` may go on after its
/// line.
#[inline]
pub(crate) fn fast(text: &[u8], from: usize) -> Option<(f64, usize)> {
    let sign = *text.get(from)?;
    let at = from + usize::from(matches!(sign, b'-' | b'+'));
    let Some((first, [ninth, tenth, ..])) = text.get(at..)?.split_first_chunk::<8>() else {
        return by_digits(text, from);
    };
    let word = u64::from_le_bytes(*first);
    let whole = leading_digits(word);
    let (mut digits, mut count, mut length, mut after) = (word, whole, whole, *ninth);
    if whole < 64 && (word >> whole) as u8 == b'.' {
        let before = (1 << whole) - 1;
        digits = word & before | (word >> 8 | u64::from(*ninth) << 56) & !before;
        count = leading_digits(digits);
        (length, after) = (count + 8, *tenth);
    }
    if count == 0 || count == 64 && matches!(after, b'0'..=b'9' | b'.') {
        return by_digits(text, from);
    }
    let end = at + length as usize / 8;
    if goes_on(text, end) {
        return None;
    }
    let decimals = (count - whole) as usize / 8;
    let value = f64::from(eight_digits(digits, count)) / POWERS_OF_TEN[decimals & 15];
    Some((if sign == b'-' { -value } else { value }, end))
}

/// How many of a word's bytes, the first in the text being the lowest, are digits before the first
/// that is none: in bits.
fn leading_digits(word: u64) -> u32 {
    let differs = word ^ ZEROS;
    // a sum that carries changes only bytes after the first that is no digit
    let other = (differs.wrapping_add(0x7676_7676_7676_7676) | differs) & 0x8080_8080_8080_8080;
    other.trailing_zeros() & !7
}

/// The value of a word's first digits; `count` of their bits, which is not zero.
fn eight_digits(word: u64, count: u32) -> u32 {
    const PAIRS: u64 = 0x0000_00FF_0000_00FF;
    let digits = (word ^ ZEROS) << (64 - count);
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let high = (pairs & PAIRS).wrapping_mul(100 + (1_000_000 << 32));
    let low = (pairs >> 16 & PAIRS).wrapping_mul(1 + (10_000 << 32));
    (high.wrapping_add(low) >> 32) as u32
}

/// Whether digits follow after blanks, or a second point: a blank does not end a number, `1 .5`
/// is 1.5.
fn goes_on(text: &[u8], end: usize) -> bool {
    let mut next = end;
    loop {
        match text.get(next) {
            Some(b' ' | b'\t') => next += 1,
            Some(b'0'..=b'9' | b'.') => return true,
            _ => return false,
        }
    }
}

/// The same digit by digit, up to fifteen.
#[cold]
fn by_digits(text: &[u8], from: usize) -> Option<(f64, usize)> {
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
    if whole + fraction == 0 || whole + fraction > 15 || goes_on(text, at) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn eight_at_once_are_what_one_after_the_other_is(
            text in "[+-]?[0-9]{0,10}\\.?[0-9]{0,10}[ .]{0,2}[0-9Y]?[\u{80}-\u{ff}]?"
        ) {
            let mut long = text.clone().into_bytes();
            long.extend_from_slice(b"\n0123456789");
            prop_assert_eq!(fast(&long, 0), by_digits(&long, 0));
            prop_assert_eq!(fast(text.as_bytes(), 0), by_digits(text.as_bytes(), 0));
        }
    }
}
