//! Rings in shared memory, through two mappings of it, as two processes have them.
#![allow(clippy::unwrap_used)] // a test may panic
use proptest::prelude::*;
use shm::{Damaged, Mapping, Place, RingReader, RingWriter};
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

const PLACE: Place = Place { at: 4, slots: 4, words: 3 };
const WORDS: usize = PLACE.at + PLACE.size();

fn name(of: &str) -> String {
    format!("/leadscrew-test-{of}-{}", std::process::id())
}

fn two(of: &str) -> (Arc<Mapping>, Arc<Mapping>) {
    let name = name(of);
    let made = Mapping::create(&name, WORDS).unwrap();
    let found = Mapping::open(&name, WORDS).unwrap().unwrap();
    (Arc::new(made), Arc::new(found))
}

#[test]
fn memory_is_one_users_and_of_one_size_and_goes_with_its_maker() {
    let name = name("once");
    assert!(Mapping::open(&name, WORDS).is_err());
    let made = Mapping::create(&name, WORDS).unwrap();
    assert!(Mapping::open(&name, WORDS + 1).unwrap().is_none());
    let user = Mapping::open(&name, WORDS).unwrap().unwrap();
    assert_eq!(Mapping::open(&name, WORDS).unwrap_err(), rustix::io::Errno::WOULDBLOCK);
    made.words()[3].store(7, Relaxed);
    assert_eq!(user.words()[3].load(Relaxed), 7);
    drop(user);
    assert!(Mapping::open(&name, WORDS).unwrap().is_some());
    let again = Mapping::create(&name, WORDS).unwrap();
    again.words()[3].store(9, Relaxed);
    assert_eq!(made.words()[3].load(Relaxed), 7, "what had the name before goes on without it");
    drop((made, again));
    assert!(Mapping::open(&name, WORDS).is_err());
}

#[test]
fn a_reader_begins_after_what_another_one_has_left() {
    let (made, found) = two("left");
    let mut writer = RingWriter::new(&found, PLACE);
    assert!(writer.push(1, b"old"));
    let mut reader = RingReader::new(&made, PLACE);
    let mut bytes = [0; 24];
    assert_eq!(reader.take(&mut bytes), Ok(None));
    let mut next = RingWriter::new(&found, PLACE);
    assert!(next.push(2, b"new"));
    assert_eq!(reader.take(&mut bytes), Ok(Some((2, &b"new"[..]))));
}

#[test]
fn counts_and_lengths_that_cannot_be_are_damage_and_the_reader_goes_on_after_them() {
    let (made, found) = two("damage");
    let (mut writer, mut reader) = (RingWriter::new(&found, PLACE), RingReader::new(&made, PLACE));
    let mut bytes = [0; 24];
    found.words()[PLACE.at].store(1000, Relaxed);
    assert_eq!((reader.waiting(), reader.take(&mut bytes)), (1, Err(Damaged)));
    assert_eq!(reader.take(&mut bytes), Ok(None));
    found.words()[PLACE.at].store(1001, Relaxed);
    let slot = PLACE.at + 16 + 1000 % PLACE.slots * (1 + PLACE.words);
    found.words()[slot].store(25, Relaxed); // a length beyond the slot
    assert_eq!(reader.take(&mut bytes), Err(Damaged));
    // a reader that claims to have taken more than there is: no room, until it says what can be
    made.words()[PLACE.at + 8].store(5, Relaxed);
    assert!(writer.is_full() && !writer.push(1, b"x"));
}

proptest! {
    /// The ring is a queue of at most as many messages as it has slots.
    #[test]
    fn a_ring_is_a_queue(actions in proptest::collection::vec((any::<bool>(), any::<u32>(), 0..30_usize), 0..200)) {
        let (made, found) = two("queue");
        let (mut writer, mut reader) = (RingWriter::new(&made, PLACE), RingReader::new(&found, PLACE));
        let mut queue: VecDeque<(u32, Vec<u8>)> = VecDeque::new();
        for (n, (push, session, length)) in actions.into_iter().enumerate() {
            if push {
                let bytes = vec![n as u8; length];
                let fits = queue.len() < PLACE.slots && length <= PLACE.longest();
                prop_assert_eq!(writer.push(session, &bytes), fits);
                if fits {
                    queue.push_back((session, bytes));
                }
            } else {
                let mut bytes = [0; 24];
                let taken = reader.take(&mut bytes).unwrap();
                let expected = queue.pop_front();
                prop_assert_eq!(taken, expected.as_ref().map(|(session, bytes)| (*session, &bytes[..])));
            }
            prop_assert_eq!((writer.waiting(), reader.waiting()), (queue.len(), queue.len()));
        }
    }

    /// Whatever the other side writes anywhere at any time: taking answers, and what it answers is
    /// no longer than asked for.
    #[test]
    fn memory_that_is_written_at_random_is_read_without_harm(words in proptest::collection::vec((0..WORDS, any::<u64>()), 0..60)) {
        let (made, found) = two("random");
        let (mut writer, mut reader) = (RingWriter::new(&made, PLACE), RingReader::new(&made, PLACE));
        for (at, value) in words {
            found.words()[at].store(value, Relaxed);
            let _ = writer.push(value as u32, &value.to_le_bytes());
            let mut bytes = [0; 24];
            if let Ok(Some((_, bytes))) = reader.take(&mut bytes) {
                prop_assert!(bytes.len() <= PLACE.longest());
            }
            prop_assert!(reader.waiting() <= PLACE.slots && writer.waiting() <= PLACE.slots);
        }
    }
}

#[test]
fn a_control_that_asks_for_a_session_is_no_sign_of_life_of_the_one_before_it() {
    const ALIVE: usize = 24; // of the layout: session in the upper half, a count in the lower one
    let name = format!("test-alive-{}", std::process::id());
    let made = shm::make(&name, 7, 1, None).unwrap();
    // a file in memory: as large as the component has made it
    let path = shm::memory_name(&name);
    let words = std::fs::metadata(format!("/dev/shm{path}")).unwrap().len() as usize / 8;
    let control = Mapping::open(&path, words).unwrap().unwrap();
    let mut side = shm::ServoSide::new(&made, 1);
    let mut after = |session: u64, count: u64, now_ns: i64| {
        control.words()[ALIVE].store(session << 32 | count, Relaxed);
        side.silence(now_ns, 1_000_000)
    };
    assert_eq!(after(1, 1, 1_000), 0);
    assert_eq!(after(1, 2, 2_000), 0, "it is alive");
    assert_eq!(after(2, 3, 3_000), 1_000, "it has been killed, and another one asks");
    assert_eq!(after(2, 4, 9_000), 7_000);
}

#[test]
fn a_computer_that_stood_still_makes_no_control_silent() {
    const PERIOD: i64 = 1_000_000;
    let name = format!("test-still-{}", std::process::id());
    let made = shm::make(&name, 7, 1, None).unwrap();
    let mut side = shm::ServoSide::new(&made, 1);
    let mut look = |now_ns: i64| side.silence(now_ns, PERIOD as u64);
    assert_eq!(look(PERIOD), 0);
    // nothing has run for three seconds; then the periods that were missed run at once
    assert_eq!(look(3_000 * PERIOD), 2 * PERIOD);
    assert!((0..100).all(|k| look(3_000 * PERIOD + k * 1_000) < 3 * PERIOD));
    // a control that is gone is silent for as long as the servo thread looks
    let begun = 3_001 * PERIOD;
    let found = (1..=50).map(|k| look(begun + k * PERIOD)).last();
    assert!(found.is_some_and(|ns| (50 * PERIOD..54 * PERIOD).contains(&ns)), "{found:?}");
}
