//! Numbers with four decimals, exactly as C's `printf("%.4f")` writes them, and ten times as fast.
//!
//! `printf` rounds the exact binary value, ties to even. Here |v|·10⁴ is rounded to a whole number,
//! whose digits are then the answer. That product has a relative error of 2⁻⁵³; so wherever its
//! fraction is nearer to ½ than that error could matter, and for large values, the slow exact way
//! of the standard library is taken instead (it rounds as C does).
//!
//! Eight digits are made at once, side by side in one word:
//!
//! ```text
//!   12 345 678 ──► 1234 │ 5678 ──► 12│34│56│78 ──► 1 2 3 4 5 6 7 8      each step a multiplication
//! ```

/// |v|·10⁴ or |v|·10⁶ below this: its error is below 10⁻³.
const LARGE: f64 = 1e12;
/// What eight digits can hold.
const EIGHT_DIGITS: u32 = 100_000_000;
/// Nearer to a tie than this the exact way is taken.
const NEAR_TIE: f64 = 2e-3;
/// The digit 0 in each byte of a word.
const ZEROS: u64 = 0x3030_3030_3030_3030;
/// A blank in each byte of a word.
const BLANKS: u64 = 0x2020_2020_2020_2020;

/// Write a number with four decimals.
#[inline]
pub(crate) fn push_fixed4(out: &mut Vec<u8>, value: f64) {
    if value.to_bits() == 0 {
        return out.extend_from_slice(b"0.0000");
    }
    let scaled = value.abs() * 1e4;
    if scaled.is_nan() || scaled >= f64::from(EIGHT_DIGITS - 1) {
        return push_fixed(out, value, 4);
    }
    let whole = scaled as u32;
    let fraction = scaled - f64::from(whole);
    if (fraction - 0.5).abs() < NEAR_TIE {
        return exactly(out, value, 4);
    }
    let digits = eight_digits(whole + u32::from(fraction > 0.5));
    // zeros before the number, of the four digits before the point
    let zeros = (digits.trailing_zeros() / 8).min(3);
    let text = digits | ZEROS;
    let mut before = (text & 0xFFFF_FFFF) >> (8 * zeros) | u64::from(b'.') << (32 - 8 * zeros);
    let mut length = 5 - zeros as usize;
    if value.is_sign_negative() {
        before = before << 8 | u64::from(b'-');
        length += 1;
    }
    push_some(out, before, length);
    out.extend_from_slice(&((text >> 32) as u32).to_le_bytes());
}

/// Write a number with so many decimals.
pub(crate) fn push_fixed(out: &mut Vec<u8>, value: f64, decimals: u32) {
    let unit = 10u64.pow(decimals);
    let scaled = value.abs() * unit as f64;
    if scaled.is_nan() || scaled >= LARGE {
        return exactly(out, value, decimals);
    }
    let whole = scaled as u64;
    let fraction = scaled - whole as f64;
    if (fraction - 0.5).abs() < NEAR_TIE {
        return exactly(out, value, decimals);
    }
    let digits = whole + u64::from(fraction > 0.5);
    if value.is_sign_negative() {
        out.push(b'-');
    }
    push_whole(out, digits / unit);
    out.push(b'.');
    let after = eight_digits((digits % unit) as u32) | ZEROS;
    out.extend_from_slice(&after.to_le_bytes()[8 - decimals as usize..]);
}

#[cold]
fn exactly(out: &mut Vec<u8>, value: f64, decimals: u32) {
    out.extend_from_slice(format!("{value:.0$}", decimals as usize).as_bytes());
}

/// The digits of a number below 10⁸, one a byte, the first in the lowest.
fn eight_digits(number: u32) -> u64 {
    let (high, low) = (number / 10_000, number % 10_000);
    let fours = u64::from(high) | u64::from(low) << 32;
    // x·10486 / 2²⁰ is x/100 for all of four digits, x·103 / 2¹⁰ is x/10 for all of two
    let hundreds = (fours * 10_486) >> 20 & 0x0000_007F_0000_007F;
    let pairs = (fours - 100 * hundreds) << 16 | hundreds;
    let tens = (pairs * 103) >> 10 & 0x000F_000F_000F_000F;
    (pairs - 10 * tens) << 8 | tens
}

/// Write the first bytes of a word.
#[inline]
fn push_some(out: &mut Vec<u8>, word: u64, count: usize) {
    let end = out.len() + count;
    out.extend_from_slice(&word.to_le_bytes());
    out.truncate(end);
}

/// Write a whole number.
pub(crate) fn push_whole(out: &mut Vec<u8>, value: u64) {
    match u32::try_from(value) {
        Ok(digit @ 0..10) => out.push(b'0' + digit as u8),
        Ok(number @ 0..EIGHT_DIGITS) => {
            let digits = eight_digits(number);
            let zeros = digits.trailing_zeros() / 8;
            push_some(out, (digits | ZEROS) >> (8 * zeros), 8 - zeros as usize);
        }
        _ => out.extend_from_slice(value.to_string().as_bytes()),
    }
}

/// Write a whole number, with blanks before it up to five places.
#[inline]
pub(crate) fn push_right(out: &mut Vec<u8>, value: u64) {
    let Ok(number @ 1..EIGHT_DIGITS) = u32::try_from(value) else {
        return out.extend_from_slice(format!("{value:>5}").as_bytes());
    };
    let digits = eight_digits(number);
    let zeros = digits.trailing_zeros() / 8;
    let text = digits | BLANKS | (ZEROS ^ BLANKS) << (8 * zeros);
    let skip = zeros.min(3);
    push_some(out, text >> (8 * skip), 8 - skip as usize);
}

/// Write a whole number, with blanks after it up to six places.
#[inline]
pub(crate) fn push_left(out: &mut Vec<u8>, number: u32) {
    if number >= EIGHT_DIGITS {
        return push_whole(out, u64::from(number));
    }
    let digits = eight_digits(number);
    let zeros = (digits.trailing_zeros() / 8).min(7);
    let text = (digits | ZEROS) >> (8 * zeros);
    let blanks = if zeros == 0 { 0 } else { BLANKS << (64 - 8 * zeros) };
    push_some(out, text | blanks, 8 - zeros.min(2) as usize);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fixed4(value: f64) -> String {
        let mut out = Vec::new();
        push_fixed4(&mut out, value);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn it_writes_what_printf_writes() {
        // Right-hand sides: C's printf("%.4f").
        for (value, text) in [
            (0.0, "0.0000"),
            (-0.0, "-0.0000"),
            (-0.00001, "-0.0000"),
            (1.5, "1.5000"),
            (-12.34567, "-12.3457"),
            (0.00005, "0.0001"), // 5.00000000000000023960868011929E-5
            (0.00015, "0.0001"), // 1.49999999999999993474E-4
            (2.5e-5, "0.0000"),
            (0.03125, "0.0312"),           // a true tie: to even
            (0.09375, "0.0938"),           // a true tie: to even
            (99_999.999_95, "99999.9999"), // 99999.99994999999762512743
        ] {
            assert_eq!(fixed4(value), text, "{value}");
        }
        assert_eq!(fixed4(1e30), "1000000000000000019884624838656.0000");
    }

    #[test]
    fn whole_numbers_are_aligned() {
        let numbers =
            [0, 7, 42, 12_345, 123_456, 7_654_321, 99_999_999, 100_000_000, 4_294_967_295];
        for value in numbers {
            let mut out = Vec::new();
            push_right(&mut out, value);
            out.push(b'|');
            push_left(&mut out, value as u32);
            out.push(b'|');
            push_whole(&mut out, value);
            assert_eq!(String::from_utf8(out).unwrap(), format!("{value:>5}|{value:<6}|{value}"));
        }
    }

    proptest! {
        #[test]
        fn it_agrees_with_the_exact_way(value in prop_oneof![-1e9..1e9f64, -10.0..10.0, proptest::num::f64::NORMAL]) {
            prop_assert_eq!(fixed4(value), format!("{value:.4}"));
            let mut six = Vec::new();
            push_fixed(&mut six, value, 6);
            prop_assert_eq!(String::from_utf8(six).unwrap(), format!("{value:.6}"));
        }

        #[test]
        fn it_agrees_near_ties(ten_thousandths in -1_000_000_000i64..1_000_000_000, ulps in -3i64..3) {
            let tie = (ten_thousandths as f64 + 0.5) / 1e4;
            let value = f64::from_bits(tie.to_bits().wrapping_add_signed(ulps));
            prop_assert_eq!(fixed4(value), format!("{value:.4}"));
        }
    }
}
