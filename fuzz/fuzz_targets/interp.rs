//! Any bytes: interpreting ends, without a panic, with bounded findings whose spans lie inside the
//! program; every operation goes to a finite place; the listing takes everything that is said.
#![no_main]

use canon::OpKind;
use interp::{Dialect, Interpreter, Limits, Listing, Ops, Setup};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|program: &[u8]| {
    let limits = Limits { blocks: 5_000, ..Limits::default() };
    for dialect in Dialect::ALL {
        try_in(program, &Setup { dialect, limits, ..Setup::default() });
    }
});

fn try_in(program: &[u8], setup: &Setup) {
    for op in Ops::new(program, setup).take(100_000) {
        if let OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } = op.kind {
            assert!(to.linear.iter().chain(&to.parallel).all(|l| l.is_finite()));
            assert!(to.rotary.iter().all(|a| a.is_finite()));
        }
    }
    let findings = interp::check(program, setup);
    assert!(findings.len() <= 1_500);
    for finding in &findings {
        assert!(
            finding.span.start <= finding.span.end && finding.span.end as usize <= program.len(),
            "{finding:?}"
        );
    }
    let mut listing = Listing::new(std::io::sink());
    Interpreter::new(program, setup).run(&mut listing);
    assert!(listing.finish().is_ok());
}
