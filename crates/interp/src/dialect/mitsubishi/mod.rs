//! What Mitsubishi's machining centres have that Fanuc's have not, or in another meaning.
//!
//! | what | Mitsubishi | Fanuc |
//! |---|---|---|
//! | `G12`, `G13` with I, D, F | one circle from its centre and back; D is a must | – |
//! | `M98 P1001 H20 L3` | O1001 from its block N20 on, three times; without P in this program | `M98 P1001 Q20` |
//! | `G84 … ,R1` | a rigid tap; `,R0` is refused | `M29` before it |
//! | `G91 G53 X5.` | moves by 5 mm | ignored |
//! | `G61.1`, `G120.1`, `G121` | accuracy and speed of paths: continuous, as always here | – |
//! | `G34` – `G36`, `G37.1` | holes in patterns: refused by name | – |
//! | `G113` – `G115`, `G114.1` … | spindles in step: refused by name | – |
//! | `#400` – `#499`, `#900000` – `#907399` | common variables | do not exist |
//! | `M29` | the builder's | a rigid tap follows |
//!
//! Source: Mitsubishi Electric, programming manual of M700V and M70V, machining centre system.
pub(crate) mod variant;

use crate::dialect::{
    fanuc::{self, POCKET, kind::Kind},
    rules::{Family, FrontEndKind, Role, Rules},
};

/// Mitsubishi's machining centres.
pub(crate) const RULES: Rules = Rules {
    name: "mitsubishi",
    people: "Mitsubishi's machining centres",
    about: "Mitsubishi's machining centres: Fanuc's language, G12, G13, M98 with H, `,R1` of taps",
    roles: &[
        Role { letter: b'H', codes: &["M98"], what: "the block N with which it begins" },
        POCKET[0],
        POCKET[1],
        POCKET[2],
        POCKET[3],
        POCKET[4],
    ],
    front_end: FrontEndKind::Fanuc(Kind::Mitsubishi),
    codes: Some(&Kind::Mitsubishi),
    evidence: &[Family::Fanuc, Family::FanucMill, Family::Mitsubishi],
    ..fanuc::MILL
};
