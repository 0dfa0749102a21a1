//! What a letter does beside a code: `P` is seconds to G4 and turns to G2.
//!
//! Source: LinuxCNC 2.9 manual, "G codes" and "M codes"; Fanuc, operator's manual of series 30i.
use gcode::Grammar;
use interp::Dialect;

/// The drilling, tapping and boring cycles.
fn is_cycle(code: &str) -> bool {
    matches!(
        code,
        "G73" | "G74" | "G81" | "G82" | "G83" | "G84" | "G85" | "G86" | "G87" | "G88" | "G89"
    )
}

/// What the word says to the code (such as `G83`), in a few words.
pub(crate) fn role(dialect: Dialect, letter: u8, code: &str) -> Option<&'static str> {
    let own = dialect.role(letter, code);
    own.or_else(|| match (dialect.grammar(), dialect.has_turret()) {
        (Grammar::Fanuc, false) => fanuc(letter, code, is_cycle(code) || code == "G76"),
        // the numbers of G70 to G76 in two lines are not those of the shared cycles
        (Grammar::Fanuc, true) if code.starts_with("G7") => shared(letter, ""),
        (Grammar::Fanuc, true) => fanuc(letter, code, false),
        (Grammar::Rs274 | Grammar::Grbl, _) => shared(letter, code),
    })
}

fn fanuc(letter: u8, code: &str, cycle: bool) -> Option<&'static str> {
    Some(match (letter, code) {
        (b'c', _) => "chamfer where this way meets the next",
        (b'r', _) => "radius of the corner where this way meets the next",
        (b'P', "M98" | "M198" | "G65" | "G66") => {
            "number of the program; of M98 with more than four digits, how often before it"
        }
        (b'L', "M98" | "M198" | "G65" | "G66") => "how often it is called",
        (b'Q', "M98" | "M198") => "the block N with which it begins",
        (b'P', "M99") => "the block N where the caller goes on",
        (b'A'..=b'Z', "G65" | "G66") => argument(letter)?,
        (b'P', "G4") => "milliseconds to wait",
        (b'X' | b'U', "G4") => "seconds to wait",
        (b'Q', "G76" | "G87") => "how far the tool moves aside before it comes out",
        (b'Z', "G87") => "where the bore ends, above R",
        (b'R', "G87") => "where the bore begins, at its lower end",
        (b'P', _) if cycle => "wait at the bottom, milliseconds",
        (b'K' | b'L', _) if cycle => "how many holes in a row",
        (b'Z', "G76") => "bottom of the hole",
        (b'R', "G76") => "level to which the tool goes fast, and from which it feeds",
        (b'D', "G45" | "G46" | "G47" | "G48") => "offset whose radius makes the way longer",
        (b'X' | b'Y' | b'Z', "G22") => "largest coordinate of the box, of the machine",
        (b'I' | b'J' | b'K', "G22") => {
            "smallest coordinate of the box along X, Y, Z, of the machine"
        }
        (b'X' | b'Y' | b'Z', "G51" | "G68") => "the centre along this axis",
        (b'X' | b'Y' | b'Z', "G51.1") => "where the mirror stands on this axis",
        (b'P', "G51") => "factor in thousandths",
        (b'I' | b'J' | b'K', "G51") => "factor along X, Y, Z in thousandths, negative to mirror",
        (b'R', "G68") => "angle in degrees, counter-clockwise",
        (b'L', "G10") => "which table: 2 and 20 work offsets, 10 to 13 tools",
        (_, "G76" | "G87") => return shared(letter, ""),
        _ => return shared(letter, code),
    })
}

/// The variable that an argument of a macro becomes; I, J and K may be given again.
fn argument(letter: u8) -> Option<&'static str> {
    const VARIABLES: [(u8, &str); 21] = [
        (b'A', "argument #1"),
        (b'B', "argument #2"),
        (b'C', "argument #3"),
        (b'I', "argument #4; given again #7, #10, …"),
        (b'J', "argument #5; given again #8, #11, …"),
        (b'K', "argument #6; given again #9, #12, …"),
        (b'D', "argument #7"),
        (b'E', "argument #8"),
        (b'F', "argument #9"),
        (b'H', "argument #11"),
        (b'M', "argument #13"),
        (b'Q', "argument #17"),
        (b'R', "argument #18"),
        (b'S', "argument #19"),
        (b'T', "argument #20"),
        (b'U', "argument #21"),
        (b'V', "argument #22"),
        (b'W', "argument #23"),
        (b'X', "argument #24"),
        (b'Y', "argument #25"),
        (b'Z', "argument #26"),
    ];
    VARIABLES.iter().find(|(known, _)| *known == letter).map(|(_, text)| *text)
}

fn shared(letter: u8, code: &str) -> Option<&'static str> {
    let cycle = is_cycle(code);
    let arc = matches!(code, "G2" | "G3");
    Some(match (letter, code) {
        (b'F', "G34") => "lead where the thread begins: travel in one revolution of the spindle",
        (b'F', _) => {
            "feed: units per minute (G94), per revolution (G95), or moves per minute (G93)"
        }
        (b'S', "G96") => "surface speed: metres (feet, in inches) per minute",
        (b'S', _) => {
            "spindle speed: revolutions per minute, or the surface speed with G96 in force"
        }
        (b'T', _) => "tool that the next M6 brings",
        (b'N', _) => "number of the block, for people",
        (b'Z', _) if cycle => "bottom of the hole",
        (b'R', _) if cycle => "level to which the tool goes fast, and from which it feeds",
        (b'Q', "G73" | "G83") => "depth of one peck",
        (b'P', _) if cycle => "wait at the bottom, seconds",
        (b'L', _) if cycle => "how many holes in a row",
        (b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C' | b'U' | b'V' | b'W', "G92") => {
            "what the axis's place shall be called from now on"
        }
        (b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C' | b'U' | b'V' | b'W', "G10") => {
            "value of the offset"
        }
        (b'X' | b'Y' | b'Z' | b'U' | b'V' | b'W', _) => "where to along this axis",
        (b'A' | b'B' | b'C', _) => "where to about this axis, degrees",
        (b'I' | b'J' | b'K', _) if arc => "centre of the arc, from its start (G91.1) along X, Y, Z",
        (b'R', _) if arc => "radius; negative for the arc of more than half a turn",
        (b'P', _) if arc => "turns",
        (b'K', "G33" | "G33.1") => "lead: travel in one revolution of the spindle",
        (b'K', "G34") => "by how much the lead grows in each revolution",
        (b'Q', "G34") => "where in its turn the spindle stands when the thread begins",
        (b'I', "G33.1") => "how many times faster the tap comes out",
        (b'P', "G76") => "lead of the thread",
        (b'I', "G76") => "from the drive line to the thread's crest",
        (b'J', "G76") => "depth of the first cut",
        (b'K', "G76") => "full depth of the thread",
        (b'R', "G76") => "degression of the depth",
        (b'Q', "G76") => "angle of the compound slide",
        (b'H', "G76") => "spring passes",
        (b'E', "G76") => "length of the taper",
        (b'L', "G76") => "which ends are tapered",
        (b'P', "G4") => "seconds to wait",
        (b'L', "G10") => "which table: 2 work offset, 20 work offset by position",
        (b'P', "G10") => "which offset: 1 to 9 for G54 to G59.3, 0 for the one in force",
        (b'R', "G10") => "rotation of the offset about Z, degrees",
        (b'P', "G64") => "farthest that the path may stray from the programmed one",
        (b'Q', "G64") => "tolerance within which short moves are taken as one",
        (b'D', "G96") => "highest spindle speed, revolutions per minute",
        (b'R', "M19") => "angle, degrees",
        (b'P', "M19") => "0 the shortest way, 1 clockwise, 2 counter-clockwise",
        (b'Q', "M19") => "longest wait, seconds",
        (b'Q', "M61") => "number of the tool that is in the spindle",
        (b'P', "M98") => "number of the subprogram",
        (b'L', "M98") => "how often",
        (b'P', "M50" | "M51" | "M52" | "M53") => "0 off, otherwise on",
        (b'H', _) => "tool whose length is taken",
        (b'@', _) => "distance from the origin",
        (b'^', _) => "angle about the origin, degrees",
        (b'$', _) => "which spindle",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_says_what_its_dialect_means() {
        let of = |dialect, letter, code| role(dialect, letter, code).unwrap_or("");
        assert_eq!(of(Dialect::LinuxCnc, b'Q', "G76"), "angle of the compound slide");
        assert!(of(Dialect::Fanuc, b'Q', "G76").contains("aside"));
        assert_eq!(of(Dialect::FanucLatheA, b'Q', "G76"), "");
        assert_eq!(of(Dialect::LinuxCnc, b'P', "G4"), "seconds to wait");
        assert_eq!(of(Dialect::Fanuc, b'P', "G4"), "milliseconds to wait");
        assert_eq!(of(Dialect::Brother, b'K', "G81"), of(Dialect::Fanuc, b'K', "G81"));
    }
}
