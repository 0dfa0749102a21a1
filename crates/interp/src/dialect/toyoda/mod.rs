//! Toyoda's grinders: the shared language with the words of cam grinding.
//!
//! ```text
//!   G51 P1234 [R30]    G151     follow profile 1234, turned by 30° on the shaft; P0 ends it
//!   G52, G53, G55      G152 …   forget samples, take samples, compute and keep the phase error
//!   G50                G150     compensate what is sent
//!   G01 X F R S, G04   G154     in cam mode: grind, spark out
//! ```
//!
//! Source: JPH0622778B2, figures 8 and 9.
use crate::dialect::{
    linuxcnc,
    rules::{Family, OwnCode, Rules},
};

/// Where they differ from the shared language.
pub(crate) const RULES: Rules = Rules {
    name: "toyoda",
    people: "Toyoda's grinders",
    about: "The cam grinding words of Toyoda's grinders: G50 to G53, G55, and G01 and G04 in cam mode",
    own_codes: &[
        OwnCode { written: 50, code: 1500, beside: 0 },
        OwnCode { written: 51, code: 1510, beside: 0 },
        OwnCode { written: 52, code: 1520, beside: 0 },
        OwnCode { written: 53, code: 1530, beside: 0 },
        OwnCode { written: 55, code: 1550, beside: 0 },
    ],
    evidence: &[Family::Toyoda],
    taps_keep_dwell: false,
    restates_modes: true,
    grinds_by_feed: true,
    ..linuxcnc::RULES
};
