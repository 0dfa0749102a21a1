//! Power cuts in the middle of the start: whatever was done by then, the next start succeeds.
use crate::support::{Random, Wire, two_drives, two_drives_expected};
use esc::{AlState, Quirks};
use ethercat::{Master, Storage};

/// Frames of an undisturbed start.
fn frames_of_a_start() -> u64 {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    master.start(&mut wire).map(|_| ()).unwrap();
    wire.frames
}

#[test]
fn after_a_power_cut_anywhere_in_the_start_the_next_start_succeeds() {
    let cuts = test_support::size::of(60, 10_000);
    let whole = frames_of_a_start();
    let mut random = Random(5);
    let network = two_drives_expected();
    let mut failed = 0;
    for cut in 0..cuts {
        let mut wire = Wire::new(two_drives(&Quirks::default()));
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        let at = random.below(whole);
        // one device, or all of them; for good, or for some frames
        let (device, back) = (random.below(5) as usize, at + 1 + random.below(400));
        wire.before = Some(Box::new(move |frame, segment, now_ns| {
            let targets = if device == 4 { 0..4 } else { device..device + 1 };
            for target in targets {
                if frame == at {
                    segment.power(target, false, now_ns);
                } else if frame == back {
                    segment.power(target, true, now_ns);
                }
            }
        }));
        let first = master.start(&mut wire).map(|_| ());
        failed += u64::from(first.is_err());
        wire.before = None;
        for target in 0..4 {
            wire.segment.power(target, true, wire.now_ns);
        }
        let again = master.start(&mut wire).map(|_| ());
        assert_eq!(
            again,
            Ok(()),
            "cut {cut} of device {device} at frame {at} of {whole}, after {first:?}"
        );
        let in_op = |at| wire.segment.device(at).unwrap().state() == AlState::Op;
        assert!((0..4).all(in_op), "cut {cut}");
    }
    assert!(failed > cuts / 2, "{failed} of {cuts} starts failed");
}
