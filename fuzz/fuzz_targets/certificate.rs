//! Any text is a certificate or refused; what was read, written and read again is the same.
#![no_main]
use libfuzzer_sys::fuzz_target;
use store::certificate::Certificate;

fuzz_target!(|text: &str| {
    if let Ok(certificate) = Certificate::parse(text) {
        let written = certificate.to_json();
        assert!(Certificate::parse(&written) == Ok(certificate), "{written}");
    }
});
