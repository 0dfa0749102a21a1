//! Any text: parameters that survive being written, or findings that a person can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use store::parameters::Parameters;

fuzz_target!(|text: &str| match Parameters::parse(text, 0) {
    Ok(parameters) => {
        let again = Parameters::parse(&parameters.to_text(), 0);
        assert_eq!(again.as_ref(), Ok(&parameters));
    }
    Err(found) => check(&found, text),
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
