//! What Fanuc's codes mean, for people: in the shared language, or in the front end's own.
use crate::{
    codes::g_code,
    dialect::{
        fanuc::{
            codes::{has_m, stays, told},
            kind::Kind,
        },
        rules::{FrontEndCodes, Meaning},
    },
};

impl FrontEndCodes for Kind {
    fn meaning(&self, letter: u8, tenths: u16) -> Option<Meaning> {
        if (letter, tenths) == (b'M', 1980) {
            let (name, group) = ("call a program in a file of its own", "stop");
            return Some(Meaning::Own {
                name,
                group,
                modal: false,
                letters: "PQL",
                executed: true,
            });
        }
        if (letter, tenths) == (b'M', 970) && self.variant().calls_by_m97 {
            let (name, group) = ("call from a block N of this program on, up to its M99", "stop");
            return Some(Meaning::Own { name, group, modal: false, letters: "PL", executed: true });
        }
        if letter != b'G' {
            let there = tenths.is_multiple_of(10) && has_m(*self, tenths / 10);
            return there.then_some(Meaning::Shared(tenths));
        }
        let (shared, name, executed) = told(*self, tenths)?;
        if let Some(code) = shared.filter(|code| g_code(*code).is_some()) {
            return Some(Meaning::Shared(code));
        }
        let (group, letters, modal) = ("Fanuc's own", "", stays(*self, tenths));
        Some(Meaning::Own { name, group, modal, letters, executed })
    }
}
