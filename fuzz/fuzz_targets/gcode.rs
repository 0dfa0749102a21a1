//! Any bytes: reading ends, without a panic, with bounded findings; and every block that was read
//! without a mistake, printed and read again, says the same.
#![no_main]

use gcode::{Block, MAX_DIAGNOSTICS, MAX_LINE_BYTES, Parser};
use libfuzzer_sys::fuzz_target;

#[path = "../../crates/gcode/tests/common/mod.rs"]
mod common;

fuzz_target!(|program: &[u8]| {
    let (mut parser, mut block, mut again) = (Parser::new(program, 0), Block::new(), Block::new());
    while parser.next(&mut block) {
        if block.faulty {
            continue;
        }
        let printed = block.to_string();
        if printed.len() > MAX_LINE_BYTES {
            continue; // a number of few digits may print as many
        }
        let mut second = Parser::new(printed.as_bytes(), 0);
        if second.next(&mut again) {
            assert_eq!(common::content(&block), common::content(&again), "{printed:?}");
            assert_eq!(printed, again.to_string());
        }
        let found = second.take_diagnostics();
        assert!(found.is_empty(), "{printed:?}: {found:?}");
    }
    let found = parser.take_diagnostics();
    assert!(found.len() <= MAX_DIAGNOSTICS + 1);
    for d in found {
        assert!(d.span.start <= d.span.end && d.span.end as usize <= program.len());
    }
    let mut parser = Parser::new(program, 0);
    while parser.next_o_word(&mut block) {
        assert!(block.o.is_some());
    }
});
