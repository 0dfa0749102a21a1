//! Any bytes are a frame or refused; a frame read and written again is the same frame.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = wire::decode(bytes);
    // the fuzzer will guess neither magic nor checksum: a payload inside of a right frame
    let Ok(length) = u16::try_from(bytes.len()) else { return };
    let mut frame = b"LS".to_vec();
    frame.push(wire::VERSION);
    frame.extend(7u32.to_le_bytes());
    frame.extend(length.to_le_bytes());
    frame.extend(bytes);
    frame.extend(crc32fast::hash(&frame).to_le_bytes());
    let Ok((message, sequence)) = wire::decode(&frame) else { return };
    let mut again = Vec::new();
    wire::encode(&message, sequence, &mut again);
    let mut twice = Vec::new();
    let Ok((read, _)) = wire::decode(&again) else { panic!("what was written is not read") };
    wire::encode(&read, sequence, &mut twice);
    assert_eq!(again, twice);
});
