//! Any bytes in the two generations' files are a record or refused; what was read, written and read
//! again is the same.
#![no_main]
use libfuzzer_sys::fuzz_target;
use std::io;
use store::sync_record::{
    SyncRecord,
    slots::{Disk, Slots},
};

/// The two generations' files.
struct Two<'a>([Option<&'a [u8]>; 2]);

impl Disk for Two<'_> {
    fn write(&mut self, _: &str, _: &[u8]) -> io::Result<()> {
        Ok(())
    }
    fn rename(&mut self, _: &str, _: &str) -> io::Result<()> {
        Ok(())
    }
    fn sync_names(&mut self) -> io::Result<()> {
        Ok(())
    }
    fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        Ok(self.0[usize::from(name.ends_with('b'))].map(<[u8]>::to_vec))
    }
}

fuzz_target!(|bytes: &[u8]| {
    // a checksum that a fuzzer will not guess: put the right one behind
    let mut whole = bytes.to_vec();
    if whole.len() >= 18 {
        let length = (whole.len() + 4) as u32;
        whole[6..10].copy_from_slice(&length.to_le_bytes());
        whole.extend(crc32fast::hash(&whole).to_le_bytes());
    }
    for bytes in [bytes, &whole] {
        match SyncRecord::decode(bytes) {
            Ok((record, generation)) => {
                let again = record.encode(generation);
                assert_eq!(SyncRecord::decode(&again), Ok((record.clone(), generation)));
                let (a, b) = (record.encode(1), record.encode(2));
                let disk = Two([Some(&a), Some(&b)]);
                assert!(Slots::open(disk, &record.identity).is_ok_and(|(_, k)| k.record.is_some()));
            }
            Err(why) => assert!(why.to_string().len() > 20),
        }
    }
    let half = bytes.split_at(bytes.len() / 2);
    let unheard =
        store::sync_record::Identity { machine: String::new(), serial: 0, epoch: 0 };
    let _ = Slots::open(Two([Some(half.0), Some(half.1)]), &unheard);
});
