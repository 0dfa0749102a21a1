//! Any text: a table of tools in either notation, or findings that a person can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use store::tools::{TableUnit, parse_tbl, parse_toml};

fuzz_target!(|text: &str| {
    for read in [parse_toml(text, 0), parse_tbl(text, 0, TableUnit::Inch)] {
        match read {
            Ok(table) => {
                check(&table.remarks, text);
                for tool in table.library.iter() {
                    assert!(
                        tool.number > 0 && tool.length.is_finite() && tool.diameter.is_finite()
                    );
                }
            }
            Err(found) => check(&found, text),
        }
    }
    let _ = text.parse::<canon::ThreadSize>();
});

/// Findings are bounded, in order, and stand between letters of the text.
fn check(found: &[diag::Diagnostic], text: &str) {
    assert!(found.len() <= store::MOST_FINDINGS + 1);
    assert!(found.windows(2).all(|w| w[0].span.start <= w[1].span.start));
    for d in found {
        let place = d.span.start as usize..d.span.end as usize;
        assert!(text.get(place).is_some(), "{d:?}");
        assert!(!d.message.is_empty());
    }
}
