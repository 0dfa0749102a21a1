//! What Haas' machining centres have that Fanuc's have not, or in another meaning.
//!
//! | what | Haas | Fanuc |
//! |---|---|---|
//! | `G12`, `G13` with I, K, Q, D, L, Z, F | a round pocket from its centre, in rings, level by level under G91 | – |
//! | `G154 P1` – `P99`, `G110` – `G129` but G112, G113 | work offsets; G110 is G154 P1 | `G54.1 P1` – `P48` |
//! | `M97 P100 L3` | blocks of this program, from N100 to M99, three times | `M98 Q100` |
//! | `G4 P0.5`, P of cycles with a point | seconds | refused |
//! | `G81 Z-5.` without R | feeds from where the tool stands, or from the R of before | refused |
//! | `G91 … G53 Z0` | goes to the machine's zero: G53 is never an increment | ignored |
//! | `G187 P E` | corners to within E | – |
//! | `M19 P90`, `M19 R90.5` | the spindle stops at this angle, degrees | the builder's |
//! | `G103` | look-ahead: no effect | – |
//! | `G47`, `G70` – `G72`, `G77`, `G87`, `G107`, `G112`, `G136`, `G150`, `G35` – `G37` | refused, each by its name | other codes, or none |
//! | `M29` | the builder's | a rigid tap follows |
//! | `E` beside G0 | left out: it makes a rapid move slower | refused |
//! | `#5401` – `#5600`, `#5701` – `#5800` | timers and lives of tools: 0 | – |
//!
//! Lathes speak Fanuc's system A, with cycles in one block (`G71 P Q D U W`, `G76 X Z K D F`), and
//!
//! | what | Haas' lathes | Fanuc's |
//! |---|---|---|
//! | `G81`, `G82`, `G83`, `G84`, `G85`, `G86`, `G89` | along Z | `G83`, `G84`, `G85` |
//! | R of these | a place, as Z | a way from the initial level |
//! | `G84`, `G184` with S | a tap, right-hand and left-hand; the cycle starts the spindle | M3 before it |
//! | `G154`, `G110` – `G129`, `M97`, `G103`, `G187`, G53, seconds, `M19 P` | as on its mills | other words |
//! | `G95`, `G186`, `G195`, `G196`, `G241` – `G249`, `G14`, `G15`, `G105`, `G199` | refused, each by its name | other codes, or none |
//!
//! Source: Haas, lathe operator's manual, "G codes"; mill operator's manual, "G codes" and
//! "M codes".
pub(crate) mod variant;

use crate::{
    codes::set,
    dialect::{
        fanuc::{self, POCKET, kind::Kind},
        rules::{Family, FrontEndKind, Role, Rules},
    },
};

/// Haas' machining centres.
pub(crate) const RULES: Rules = Rules {
    name: "haas",
    people: "Haas' machining centres",
    about: "Haas' machining centres: Fanuc's language, G12, G13, G154, M97, seconds with a point",
    roles: &[
        Role {
            letter: b'P',
            codes: &["M97"],
            what: "the block N of this program with which it begins",
        },
        Role { letter: b'L', codes: &["M97"], what: "how often it is called" },
        Role {
            letter: b'P',
            codes: &["G154"],
            what: "which of the work offsets beyond G59, 1 to 99",
        },
        Role { letter: b'P', codes: &["M19"], what: "where the spindle stops, whole degrees" },
        Role { letter: b'P', codes: &["G187"], what: "1 rough, 2 medium, 3 finish" },
        Role { letter: b'E', codes: &["G187"], what: "how far the path may leave a corner" },
        Role {
            letter: b'P',
            codes: &["G4"],
            what: "wait: seconds with a point, milliseconds without",
        },
        Role {
            letter: b'L',
            codes: &["G12", "G13"],
            what: "how many steps of Z, each with all rings (G91)",
        },
        POCKET[0],
        POCKET[1],
        POCKET[2],
        POCKET[3],
        POCKET[4],
    ],
    front_end: FrontEndKind::Fanuc(Kind::Haas),
    codes: Some(&Kind::Haas),
    evidence: &[Family::Fanuc, Family::FanucMill, Family::Haas],
    idle: set("DEHPQ"),
    last_code_acts: false,
    taps_turn_spindle: true,
    ..fanuc::MILL
};

/// Haas' lathes.
pub(crate) const LATHE: Rules = Rules {
    name: "haas-lathe",
    people: "Haas' lathes",
    about: "Haas' lathes: Fanuc's system A, cycles in one block, taps that start the spindle, G154, M97",
    roles: &LATHE_ROLES,
    front_end: FrontEndKind::Fanuc(Kind::HaasLathe),
    codes: Some(&Kind::HaasLathe),
    evidence: &[Family::Fanuc, Family::FanucLathe, Family::Haas],
    last_code_acts: false,
    taps_turn_spindle: true,
    ..fanuc::LATHE_A
};

/// What letters do beside codes of its lathes.
const LATHE_ROLES: [Role; 8] = [
    Role {
        letter: b'P',
        codes: &["M97"],
        what: "the block N of this program with which it begins",
    },
    Role { letter: b'L', codes: &["M97"], what: "how often it is called" },
    Role { letter: b'P', codes: &["G154"], what: "which of the work offsets beyond G59, 1 to 99" },
    Role { letter: b'P', codes: &["M19"], what: "where the spindle stops, whole degrees" },
    Role {
        letter: b'R',
        codes: &["G81", "G82", "G83", "G84", "G85"],
        what: "the place of the R plane",
    },
    Role { letter: b'D', codes: &["G71", "G72"], what: "how deep a pass is" },
    Role { letter: b'D', codes: &["G76"], what: "how deep the first pass is" },
    Role { letter: b'K', codes: &["G76"], what: "how deep the thread is" },
];
