//! Drives on an EtherCAT network, emulated and in virtual time: a control leads the machine behind
//! them through the servo process.
mod bench;
mod faults;
mod taps;
mod wire;

use bench::OnWire;
use test_support::drives::{DrivesBench, conforms};

#[test]
fn drives_on_a_network_conform() {
    let mut bench = OnWire::start();
    assert_eq!(bench.shared.in_op.load(std::sync::atomic::Ordering::Relaxed), 7);
    conforms(&mut bench);
    bench.vanish();
}
