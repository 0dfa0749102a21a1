//! Drills of the inch series: numbers 1 to 80 and letters A to Z.
//!
//! Source: ASME B94.11M, "Twist Drills", the table of number and letter sizes.

/// Diameters of the drills number 1 to 80, thousandths of an inch by ten.
const NUMBERS: [u16; 80] = [
    2280, 2210, 2130, 2090, 2055, 2040, 2010, 1990, 1960, 1935, 1910, 1890, 1850, 1820, 1800, 1770,
    1730, 1695, 1660, 1610, 1590, 1570, 1540, 1520, 1495, 1470, 1440, 1405, 1360, 1285, 1200, 1160,
    1130, 1110, 1100, 1065, 1040, 1015, 995, 980, 960, 935, 890, 860, 820, 810, 785, 760, 730, 700,
    670, 635, 595, 550, 520, 465, 430, 420, 410, 400, 390, 380, 370, 360, 350, 330, 320, 310, 292,
    280, 260, 250, 240, 225, 210, 200, 180, 160, 145, 135,
];
/// Diameters of the drills A to Z, in the same unit.
const LETTERS: [u16; 26] = [
    2340, 2380, 2420, 2460, 2500, 2570, 2610, 2660, 2720, 2770, 2810, 2900, 2950, 3020, 3160, 3230,
    3320, 3390, 3480, 3580, 3680, 3770, 3860, 3970, 4040, 4130,
];

/// Finds the size of a drill among lower-case words, inches: `#7 drill`, `no. 7 drill`,
/// `letter f drill`, `f drill`.
pub(super) fn of_words(words: &[String]) -> Option<f64> {
    let drill = words.iter().position(|word| matches!(word.as_str(), "drill" | "reamer"))?;
    let number = |text: &str| {
        let number = text.parse::<usize>().ok()?.checked_sub(1)?;
        NUMBERS.get(number).copied()
    };
    let letter = |text: &str| match *text.as_bytes() {
        [letter @ b'a'..=b'z'] => Some(LETTERS[usize::from(letter - b'a')]),
        _ => None,
    };
    let named = words.windows(2).find_map(|pair| match pair[0].trim_end_matches('.') {
        "#" | "no" | "num" | "number" | "wire" => number(&pair[1]),
        "letter" | "ltr" | "let" => letter(&pair[1]),
        _ => None,
    });
    let signed = || words.iter().find_map(|word| number(word.strip_prefix('#')?));
    let alone = || letter(words.get(drill.checked_sub(1)?)?);
    named.or_else(signed).or_else(alone).map(|size| f64::from(size) / 10_000.0)
}
