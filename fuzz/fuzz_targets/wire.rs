//! Any bytes are a frame or refused; a frame read and written again is the same frame.
#![no_main]
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = wire::decode(bytes);
    // the fuzzer will guess neither magic nor checksum: a kind and a payload inside of a right frame
    let Some((kind, payload)) = bytes.split_first() else { return };
    let Ok(length) = u16::try_from(payload.len()) else { return };
    let mut frame = b"LS".to_vec();
    frame.extend([wire::VERSION, *kind]);
    frame.extend(7u32.to_le_bytes());
    frame.extend(length.to_le_bytes());
    frame.extend(payload);
    frame.extend(crc32fast::hash(&frame).to_le_bytes());
    let Ok((message, sequence)) = wire::decode(&frame) else { return };
    let mut again = Vec::new();
    wire::encode(&message, sequence, &mut again);
    let mut twice = Vec::new();
    let Ok((read, _)) = wire::decode(&again) else { panic!("what was written is not read") };
    wire::encode(&read, sequence, &mut twice);
    assert_eq!(again, twice);
});
