//! Any bytes in the memory that a control shares with the HAL component: the servo thread's side
//! takes what can be meant and no more, comes to an end each time, and believes nothing of a
//! control once it has found damage.
#![no_main]

use libfuzzer_sys::fuzz_target;
use servo::{Rings, check_request, check_step};
use shm::{Made, ServoSide, SetUps};
use std::fs::{File, OpenOptions};
use std::os::unix::fs::FileExt;
use std::sync::OnceLock;

/// The memory of this process, and the same as a file.
fn memory() -> &'static (Made, File) {
    static MEMORY: OnceLock<(Made, File)> = OnceLock::new();
    MEMORY.get_or_init(|| {
        let name = format!("fuzz-{}", std::process::id());
        let made = shm::make(&name, 0x1ff, 2, None).unwrap();
        let path = format!("/dev/shm{}", shm::memory_name(&name));
        let file = OpenOptions::new().read(true).write(true).open(&path).unwrap();
        std::fs::remove_file(path).unwrap(); // the process ends without dropping it
        (made, file)
    })
}

/// Words before the rings' slots; of a ring: its writer's count, its reader's count, its slots.
const WORD: u64 = 8;

fuzz_target!(|data: &[u8]| {
    let (made, file) = memory();
    let size = file.metadata().unwrap().len();
    let mut side = ServoSide::new(made, 1);
    let mut set_ups = SetUps::new(made);
    side.begin();
    // pieces: where, then how many bytes, then these
    let mut left = data;
    while let [a, b, c, count, rest @ ..] = left {
        let at = u64::from(u32::from_le_bytes([*a, *b, *c, 0])) * WORD % size;
        let (bytes, rest) = rest.split_at(rest.len().min(usize::from(*count)));
        let bytes = &bytes[..bytes.len().min((size - at) as usize)];
        file.write_all_at(bytes, at).unwrap();
        left = rest;
        read(&mut side, &mut set_ups);
    }
    side.end();
});

fn read(side: &mut ServoSide, set_ups: &mut SetUps) {
    /// More messages than all rings hold.
    const MOST: usize = 4096;
    let before = side.is_damaged();
    let mut count = 0;
    while let Some(request) = side.next_request() {
        assert!(!before && check_request(&request).is_ok());
        count += 1;
        assert!(count < MOST);
    }
    while let Some(step) = side.next_step() {
        assert!(!before && check_step(&step).is_ok());
        count += 1;
        assert!(count < MOST);
    }
    while let Some((_, asked)) = set_ups.take() {
        if let Ok(set_up) = asked {
            set_up.config.problems(|_| {});
        }
        count += 1;
        assert!(count < MOST);
    }
    assert!(side.silence(1, 1) <= 2);
    assert!(!before || side.is_damaged());
    let _ = (side.is_ended(), side.steps_waiting());
}
