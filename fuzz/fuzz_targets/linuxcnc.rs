//! Any INI and HAL files: a machine file that loads or is refused by its reader, or remarks that
//! say why there is none.
#![no_main]

use libfuzzer_sys::fuzz_target;
use store::linuxcnc::{Hal, Ini, RemarkKind, import};

fuzz_target!(|text: &str| {
    // the second half is the HAL file; what either includes is the other
    let (ini_text, hal_text) = text.split_once('\u{1}').unwrap_or((text, ""));
    let ini = Ini::read("a.ini", ini_text, &mut |_| Ok(hal_text.chars().take(256).collect()));
    let mut hal = Hal::default();
    hal.read("a.hal", hal_text, &ini, &mut |_| Ok(ini_text.chars().take(256).collect()));
    let (made, remarks) = import(&ini, &hal);
    let wrong = remarks.iter().any(|remark| remark.kind == RemarkKind::Wrong);
    assert!(made.is_some() != wrong);
    if let Some(made) = made {
        // it is one of our files: the reader may find a value out of bounds, and never a key or a
        // notation that it does not know
        if let Err(found) = store::machine::parse(&made, 0) {
            for d in found {
                assert!(!matches!(d.code, "S0401" | "S0402" | "S0403"), "{d:?}\n{made}");
            }
        }
    }
});
