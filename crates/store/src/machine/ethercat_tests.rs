//! What machine files say of drives on a network, and what is refused.
use crate::machine::{self, MachineFile};

const MILL: &str = include_str!("../../../../machines/ethercat/mill.toml");

fn read(text: &str) -> Result<MachineFile, String> {
    machine::parse(text, 0).map_err(|found| {
        found.iter().map(|f| format!("{}\n", f.message)).collect::<Vec<_>>().concat()
    })
}

/// What is said of the mill with one text in the place of another.
fn refused(from: &str, to: &str) -> String {
    assert!(MILL.contains(from), "{from}");
    read(&MILL.replacen(from, to, 1)).map(|file| file.name).unwrap_err()
}

#[test]
fn the_mill_that_is_shipped_has_a_drive_for_each_axis_and_its_spindle() {
    let file = read(MILL).unwrap_or_else(|why| panic!("{why}"));
    let (axes, spindles) = file.drive_slots();
    assert_eq!(axes.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(spindles.len(), 1);
}

#[test]
fn what_a_network_cannot_be_is_refused_with_what_would_work() {
    let cases = [
        ("cycle_us = 250", "cycle_us = 500", "expected 250, a frame a servo period"),
        ("lead_us = 60", "lead_us = 300", "expected less than the cycle of 250 µs"),
        ("device = \"X\"", "device = \"Q\"", "axis X: there is no device \"Q\": expected one of"),
        ("device = \"X\"", "device = \"IO\"", "device \"IO\" is no drive"),
        ("device = \"Y\"", "device = \"X\"", "axis Y and axis X are both slot 0 of device \"X\""),
        ("name = \"Y\"\nprofile", "name = \"X\"\nprofile", "two devices are named \"X\""),
        ("mode = \"csp\"", "mode = \"csv\"", "axis X is commanded positions"),
        ("gear = \"1/1\"", "gear = \"1:1\"", "such as 3/2"),
        ("home = \"60FD.2\"", "home = \"60FE.2\"", "expected 60FD.0 to 60FD.31"),
        ("home = \"60FD.2\", ", "", "axis X is homed by its switch, which is not read"),
        ("kind = \"position\"", "kind = \"torque\"", "is told a torque"),
        ("position_from = \"scale\"", "position_from = \"motor\"", "closes the position loop"),
        ("method = \"switch\"", "method = \"index\"", "index marks and forces are not exchanged"),
        ("inputs_from = 0", "inputs_frm = 0", "did you mean `inputs_from`?"),
    ];
    for (from, to, expected) in cases {
        let said = refused(from, to);
        assert!(said.contains(expected), "{from} -> {to}: {said}");
    }
}

#[test]
fn a_network_without_a_drive_and_a_drive_without_a_network_are_refused() {
    let network = "[ethercat]\ninterface = \"eth1\"\ncycle_us = 250\nlead_us = 60\nsilent_after_ms = 500\n[[ethercat.devices]]\nname = \"X\"\nprofile = \"cia402\"\n";
    let on = |more: &str| {
        read(&format!("extends = \"tapping-center\"\nname = \"x\"\n{more}"))
            .map(|f| f.name)
            .unwrap_err()
    };
    let said = on(network);
    for of in ["axis X", "axis Y", "axis Z", "spindle \"spindle\""] {
        assert!(said.contains(&format!("{of} has no drive on the network")), "{said}");
    }
    let drive = "[axes.x.ethercat]\ndevice = \"X\"\nmode = \"csp\"\ncounts_per_rev = 1000\n";
    assert!(on(drive).contains("expected [ethercat]"), "{}", on(drive));
}
