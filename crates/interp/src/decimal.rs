//! Numbers with four decimals, exactly as C's `printf("%.4f")` writes them, and several times as fast.
//!
//! `printf` rounds the exact binary value, ties to even. Here |v|·10⁴ is rounded to a whole number,
//! whose digits are then the answer. That product has a relative error of 2⁻⁵³; so wherever its
//! fraction is nearer to ½ than that error could matter, and for large values, the slow exact way of
//! the standard library is taken instead (it rounds as C does).

/// Above this the exact way is taken: |v|·10⁴ < 10¹², its error is below 10⁻³.
const LARGE: f64 = 1e8;
/// Nearer to a tie than this the exact way is taken.
const NEAR_TIE: f64 = 2e-3;

/// Two digits each of 00 to 99.
static PAIRS: [u8; 200] = pairs();

const fn pairs() -> [u8; 200] {
    let (mut table, mut i) = ([0; 200], 0);
    while i < 100 {
        table[2 * i] = b'0' + (i / 10) as u8;
        table[2 * i + 1] = b'0' + (i % 10) as u8;
        i += 1;
    }
    table
}

/// Write a number with four decimals.
#[inline]
pub(crate) fn push_fixed4(out: &mut Vec<u8>, value: f64) {
    let scaled = value.abs() * 1e4;
    if scaled.is_nan() || scaled >= LARGE * 1e4 {
        return exactly(out, value);
    }
    let whole = scaled as u64;
    let fraction = scaled - whole as f64;
    if (fraction - 0.5).abs() < NEAR_TIE {
        return exactly(out, value);
    }
    let digits = whole + u64::from(fraction > 0.5);
    let (integer, decimals) = (digits / 10_000, (digits % 10_000) as usize);
    // Sign, at most 8 digits, point, 4 digits.
    let mut text = [0u8; 16];
    let (high, low) = (2 * (decimals / 100), 2 * (decimals % 100));
    text[12] = PAIRS[high];
    text[13] = PAIRS[high + 1];
    text[14] = PAIRS[low];
    text[15] = PAIRS[low + 1];
    text[11] = b'.';
    let mut at = write_digits(&mut text, 11, integer);
    if value.is_sign_negative() {
        at -= 1;
        text[at] = b'-';
    }
    out.extend_from_slice(&text[at..]);
}

#[cold]
fn exactly(out: &mut Vec<u8>, value: f64) {
    out.extend_from_slice(format!("{value:.4}").as_bytes());
}

/// Write a whole number in front of place `end`; where it begins.
#[inline]
fn write_digits(text: &mut [u8], end: usize, mut value: u64) -> usize {
    let mut at = end;
    while value >= 10 {
        let pair = 2 * (value % 100) as usize;
        text[at - 1] = PAIRS[pair + 1];
        text[at - 2] = PAIRS[pair];
        at -= 2;
        value /= 100;
    }
    if value > 0 || at == end {
        at -= 1;
        text[at] = b'0' + value as u8;
    }
    at
}

/// Write a whole number, right-aligned in `width` places.
#[inline]
pub(crate) fn push_aligned(out: &mut Vec<u8>, value: u64, width: usize) {
    let mut text = [b' '; 24];
    let at = write_digits(&mut text, 24, value);
    out.extend_from_slice(&text[at.min(24 - width)..]);
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
        let mut out = Vec::new();
        for value in [0, 7, 42, 12_345, 123_456] {
            push_aligned(&mut out, value, 5);
            out.push(b'|');
        }
        assert_eq!(String::from_utf8(out).unwrap(), "    0|    7|   42|12345|123456|");
    }

    proptest! {
        #[test]
        fn it_agrees_with_the_exact_way(value in prop_oneof![-1e9..1e9f64, -10.0..10.0, proptest::num::f64::NORMAL]) {
            prop_assert_eq!(fixed4(value), format!("{value:.4}"));
        }

        #[test]
        fn it_agrees_near_ties(ten_thousandths in -1_000_000_000i64..1_000_000_000, ulps in -3i64..3) {
            let tie = (ten_thousandths as f64 + 0.5) / 1e4;
            let value = f64::from_bits(tie.to_bits().wrapping_add_signed(ulps));
            prop_assert_eq!(fixed4(value), format!("{value:.4}"));
        }
    }
}
