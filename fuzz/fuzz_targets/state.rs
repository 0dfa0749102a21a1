//! Any bytes: a file of a control's state, or a sentence; what was read, written and read again is
//! the same.
#![no_main]
use canon::ToolLibrary;
use libfuzzer_sys::fuzz_target;
use store::parameters::Parameters;
use store::state::seal::{self, Datum};
use store::state::{Homing, LastProgram, Origin, Settings, WorkpieceRecord};

fuzz_target!(|bytes: &[u8]| {
    check::<Parameters>(bytes);
    check::<ToolLibrary>(bytes);
    check::<Homing>(bytes);
    check::<LastProgram>(bytes);
    check::<Settings>(bytes);
    check::<WorkpieceRecord>(bytes);
});

fn check<D: Datum + PartialEq + std::fmt::Debug>(bytes: &[u8]) {
    // a checksum that a fuzzer will not guess: also with the right one, and as a file that was
    // edited
    let text = String::from_utf8_lossy(bytes);
    let edited = format!("# leadscrew {} {}, edited\n{text}", D::KIND, D::VERSION);
    let origin = Origin { machine: "lathe".to_owned(), ..Origin::default() };
    for bytes in [bytes, seal::sealed::<D>(&origin, &text).as_bytes(), edited.as_bytes()] {
        match seal::open::<D>(bytes) {
            Ok(read) => {
                let again = seal::sealed::<D>(&origin, &read.value.body());
                let again = seal::open::<D>(again.as_bytes()).expect("what was written is read");
                // a file may state a value by another unit, which is rounded once
                assert_eq!(again.value.body(), read.value.body());
            }
            Err(why) => assert!(why.to_string().len() > 10),
        }
    }
}
