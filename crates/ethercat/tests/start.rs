//! From power on to OP.
use crate::support::{Wire, six_drives, six_drives_expected};
use esc::{AlState, Quirks};
use ethercat::{Master, Storage};

#[test]
fn six_drives_a_coupler_and_inputs_and_outputs_are_in_op_within_two_seconds() {
    let mut wire = Wire::new(six_drives(&Quirks::default()));
    let network = six_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let started = wire.now_ns;
    let bus = master.start(&mut wire);
    let bus = bus.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(bus.expected_counter(), 6 * 3 + 3);
    let took_ms = (wire.now_ns - started) / 1_000_000;
    assert!(took_ms < 2_000, "{took_ms} ms");
    for at in 0..wire.segment.len() {
        assert_eq!(wire.segment.device(at).unwrap().state(), AlState::Op, "device {at}");
    }
}
