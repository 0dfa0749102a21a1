//! What real devices do otherwise than the standards have it: handled, or refused by name.
use crate::support::{MOST_STEP, Wire, enable, two_drives, two_drives_expected};
use esc::Quirks;
use ethercat::{Device, DriveMode, Master, Network, PdoEntry, StartError, Storage, Sync};

/// Starts two drives with a quirk, enables them, and returns how it ended.
fn start(quirks: &Quirks, network: &Network) -> Result<(), StartError> {
    let mut wire = Wire::new(two_drives(quirks));
    let storage = Storage::new();
    let mut master = Master::new(&storage, network).unwrap();
    let mut bus = master.start(&mut wire)?;
    enable(&mut bus, &mut wire);
    Ok(())
}

fn refusal(quirks: &Quirks, network: &Network) -> String {
    start(quirks, network).expect_err("it was expected to be refused").to_string()
}

#[test]
fn what_the_master_does_not_need_is_no_trap() {
    let with = |set: fn(&mut Quirks)| {
        let mut quirks = Quirks::default();
        set(&mut quirks);
        quirks
    };
    let harmless = [
        with(|q| q.no_complete_access = true),
        with(|q| q.unpadded_complete_access = true),
        with(|q| q.no_sdo_information = true),
        with(|q| q.no_csv = true),
        with(|q| q.no_cst = true),
        with(|q| q.sync_type_reads_zero = true),
        with(|q| q.sync_period_read_only = true),
        with(|q| q.no_positive_software_limit = true),
        with(|q| q.wrong_sync_manager_types = true),
        with(|q| q.no_cyclic_unit_control = true),
        with(|q| q.one_tx_pdo_of = Some(10)),
        with(|q| q.fixed_assignment = true),
        with(|q| q.emergency_at_start = true),
    ];
    for quirks in harmless {
        assert_eq!(start(&quirks, &two_drives_expected()), Ok(()), "{quirks:?}");
    }
}

/// Without torque, speed and inputs, which the fixed PDOs do not have.
#[test]
fn a_drive_with_fixed_pdos_is_taken_as_it_is() {
    let quirks = Quirks { fixed_mapping: true, fixed_assignment: true, ..Quirks::default() };
    assert_eq!(start(&quirks, &two_drives_expected()), Ok(()));
}

#[test]
fn a_fixed_pdo_without_the_target_is_refused_by_its_object() {
    let quirks = Quirks { fixed_mapping: true, ..Quirks::default() };
    let mut network = two_drives_expected();
    network.devices[1].slots[0].mode = DriveMode::Csv;
    assert!(refusal(&quirks, &network).contains("X: 60FF is in none of its PDOs"));
}

#[test]
fn a_tx_pdo_that_is_too_long_is_refused_by_its_length() {
    let quirks = Quirks { one_tx_pdo_of: Some(4), ..Quirks::default() };
    let text = refusal(&quirks, &two_drives_expected());
    assert!(text.contains("1A00") && text.contains("06040042"), "{text}");
}

#[test]
fn a_torque_that_cannot_be_mapped_is_refused_by_name_and_left_out_on_order() {
    let quirks = Quirks { torque_by_sdo_only: true, ..Quirks::default() };
    let mut network = two_drives_expected();
    let text = refusal(&quirks, &network);
    assert!(
        text.contains("X: 6077:00 cannot be mapped into 1A00 (abort 06040041): leave it out"),
        "{text}"
    );
    for device in &mut network.devices {
        for pdo in &mut device.pdos {
            pdo.entries.retain(|entry| entry.index != 0x6077);
        }
    }
    assert_eq!(start(&quirks, &network), Ok(()));
}

#[test]
fn a_mode_that_a_drive_does_not_have_is_refused() {
    let quirks = Quirks { no_csv: true, ..Quirks::default() };
    let mut network = two_drives_expected();
    network.devices[1].slots[0].mode = DriveMode::Csv;
    assert!(refusal(&quirks, &network).contains("mode csv is not among those of 6502"));
}

#[test]
fn a_drive_that_sends_nothing_is_refused() {
    let quirks = Quirks { rx_pdo_alone: true, ..Quirks::default() };
    assert!(refusal(&quirks, &two_drives_expected()).contains("X: 6041 is in none of its PDOs"));
}

#[test]
fn sync1_is_activated_where_a_drive_needs_it_and_its_refusal_has_a_name_where_not() {
    let quirks = Quirks { sync_activation: 7, ..Quirks::default() };
    let mut network = two_drives_expected();
    let text = refusal(&quirks, &network);
    assert!(text.contains("X: it stays in PRE-OP and gives AL status code 0030"), "{text}");
    for device in &mut network.devices[1..3] {
        device.sync = Sync::Sync01 { after_ns: 500_000 };
    }
    assert_eq!(start(&quirks, &network), Ok(()));
}

/// In the place of an answer, too: it is taken out, and the request sent anew where it can be.
#[test]
fn an_emergency_anywhere_in_the_start_is_survived_or_named() {
    let network = two_drives_expected();
    let whole = {
        let mut wire = Wire::new(two_drives(&Quirks::default()));
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        master.start(&mut wire).map(|_| ()).unwrap();
        wire.frames
    };
    let points = test_support::size::of(16, 3_000);
    let (mut survived, mut named) = (0, 0);
    for point in 0..points {
        let mut wire = Wire::new(two_drives(&Quirks::default()));
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        let at = whole * point / points;
        wire.before = Some(Box::new(move |frame, segment, _| {
            if (at..at + 40).contains(&frame) {
                let emergency = esc::Emergency { code: 0x8120, register: 0x11, data: [0; 5] };
                segment.device_mut(1).unwrap().say(emergency);
            }
        }));
        match master.start(&mut wire).map(|_| ()) {
            Ok(()) => survived += 1,
            Err(StartError::Emergency { name, code: 0x8120, .. }) if name == "X" => named += 1,
            Err(other) => panic!("at frame {at} of {whole}: {other}"),
        }
        wire.before = None;
        // what is left in the mailbox is said first
        let again = (0..3).map(|_| master.start(&mut wire).map(|_| ()));
        assert!(again.into_iter().any(|result| result.is_ok()), "at frame {at}");
    }
    println!("{survived} survived, {named} named");
    assert!(survived > points / 2, "{survived} of {points}");
}

#[test]
fn an_unchanged_source_address_is_named() {
    let mut wire = Wire::new(esc::NetworkSegment::new([esc::drive(&esc::DriveModel {
        quirks: Quirks { source_address_kept: true, ..Quirks::default() },
        ..esc::DriveModel::new(1)
    })]));
    let network = Network::new(vec![Device::csp("X", MOST_STEP)]);
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let error = master.start(&mut wire).map(|_| ()).unwrap_err();
    assert!(matches!(error, StartError::Echoes { .. }), "{error}");
}

#[test]
fn a_drive_without_a_clock_is_refused_where_sync0_is_wanted() {
    let quirks = Quirks { no_clock: true, ..Quirks::default() };
    assert_eq!(
        refusal(&quirks, &two_drives_expected()),
        "X: it has no distributed clock; SYNC0 needs one"
    );
}

#[test]
fn another_device_than_expected_is_refused_with_both_identities() {
    let mut network = two_drives_expected();
    network.devices[2].identity =
        Some(ethercat::DeviceIdentity { vendor: 0x539, product: 0x2200_0301 });
    let text = refusal(&Quirks::default(), &network);
    let expected =
        "device 2, Z: vendor 00000E5C, product 00000402 is there; 00000539, 22000301 is expected";
    assert_eq!(text, expected);
}

#[test]
fn a_device_too_many_or_too_few_is_refused_with_both_counts() {
    let mut network = two_drives_expected();
    network.devices.pop();
    assert_eq!(refusal(&Quirks::default(), &network), "4 devices are on the wire, 3 are expected");
}

#[test]
fn nobody_on_the_wire_is_said_so() {
    let mut wire = Wire::new(esc::NetworkSegment::default());
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let error = master.start(&mut wire).map(|_| ()).unwrap_err();
    assert_eq!(error, StartError::NoAnswer);
}

#[test]
fn an_object_that_a_device_does_not_have_is_refused_by_its_number() {
    let mut network = two_drives_expected();
    network.devices[1].sdos.push(ethercat::Sdo { entry: PdoEntry::of(0x3001, 16), value: 1 });
    assert_eq!(refusal(&Quirks::default(), &network), "X: 3001:00 is refused with abort 06020000");
}

#[test]
fn a_cycle_that_a_drive_cannot_keep_is_refused_by_its_al_status_code() {
    let mut network = two_drives_expected();
    (network.cycle_ns, network.lead_ns) = (62_500, 10_000);
    let text = refusal(&Quirks::default(), &network);
    assert!(text.contains("AL status code 0035"), "{text}");
}

#[test]
fn two_axes_in_one_device_have_their_objects_800_apart() {
    let model = esc::DriveModel { motors: vec![esc::Motor::new(); 2], ..esc::DriveModel::new(9) };
    let mut wire = Wire::new(esc::NetworkSegment::new([esc::drive(&model)]));
    let mut device = Device::csp("XY", MOST_STEP);
    let mut second = device.slots[0];
    second.number = 1;
    device.slots.push(second);
    for pdo in device.pdos.clone() {
        let shifted =
            pdo.entries.iter().map(|entry| PdoEntry { index: entry.index + 0x800, ..*entry });
        device.pdos.push(ethercat::Pdo { index: pdo.index + 0x10, entries: shifted.collect() });
    }
    let network = Network::new(vec![device]);
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap_or_else(|error| panic!("{error}"));
    enable(&mut bus, &mut wire);
    assert_eq!(bus.drives().len(), 2);
}
