//! Registers, FMMUs, sync managers, EEPROM, and what the working counter says.
use crate::support::{Bench, OUT, frame};
use esc::{
    AlState, DatagramCommand, DriveModel, Quirks, coupler, datagrams, digital_io, drive, encoder,
};

fn position(register: u16, at: u16) -> u32 {
    u32::from(register) << 16 | u32::from(at.wrapping_neg())
}

fn three() -> Bench {
    Bench::new([coupler(0), drive(&DriveModel::new(1)), digital_io()])
}

#[test]
fn working_counters_are_those_of_the_standard() {
    // ETG.1000.4, table 15: read 1, write 1, both 3; a broadcast once a device
    let station = |register: u16, at: u32| u32::from(register) << 16 | (0x1001 + at);
    let cases = [
        (DatagramCommand::Nop, 0, 0),
        (DatagramCommand::Aprd, position(0x0010, 1), 1),
        (DatagramCommand::Apwr, position(0x0F80, 2), 1),
        (DatagramCommand::Aprw, position(0x0F80, 0), 3),
        (DatagramCommand::Fprd, station(0x0130, 2), 1),
        (DatagramCommand::Fpwr, station(0x0F80, 0), 1),
        (DatagramCommand::Fprw, station(0x0F80, 1), 3),
        (DatagramCommand::Brd, 0, 3),
        (DatagramCommand::Bwr, u32::from(0x0F80_u16) << 16, 3),
        (DatagramCommand::Brw, u32::from(0x0F80_u16) << 16, 9),
        (DatagramCommand::Armw, position(0x0F80, 1), 3),
        (DatagramCommand::Frmw, station(0x0F80, 1), 3),
        // nobody there, nothing there, not to be written
        (DatagramCommand::Fprd, 0x0130_2000, 0),
        (DatagramCommand::Aprd, position(0x0130, 3), 0),
        (DatagramCommand::Fprd, station(0x3000, 0), 0),
        (DatagramCommand::Fpwr, station(0x0130, 0), 0),
        (DatagramCommand::Lrd, 0, 0),
    ];
    for (command, address, expected) in cases {
        let found = three().send(command, address, &[0, 0]).1;
        assert_eq!(found, expected, "{command:?} {address:08X}");
    }
}

#[test]
fn positions_count_up_from_device_to_device() {
    let mut bench = three();
    let mut sent = frame(&[(DatagramCommand::Brd, 5, vec![0; 2])]);
    bench.segment.pass(&mut sent, bench.now_ns + 1);
    let mut seen = 0;
    datagrams(&mut sent, |d| seen = d.device());
    assert_eq!(seen, 8);
}

#[test]
fn a_read_multiple_write_takes_the_value_of_the_one_to_all_others() {
    let mut bench = three();
    bench.write_to(1, 0x0F80, &[7, 8]);
    let (data, counter) =
        bench.send(DatagramCommand::Frmw, u32::from(0x0F80_u16) << 16 | 0x1002, &[1, 1]);
    assert_eq!((data, counter), (vec![7, 8], 3));
    // the device before the one that is read has what the master sent
    assert_eq!(bench.read_of(0, 0x0F80, 2).0, [1, 1]);
    assert_eq!(bench.read_of(2, 0x0F80, 2).0, [7, 8]);
}

#[test]
fn an_exchange_writes_what_came_and_returns_what_was() {
    let mut bench = three();
    bench.write(0x0F80, &[1, 2]);
    let (data, counter) =
        bench.send(DatagramCommand::Fprw, u32::from(0x0F80_u16) << 16 | 0x1001, &[3, 4]);
    assert_eq!((data, counter), (vec![1, 2], 3));
    assert_eq!(bench.read(0x0F80, 2).0, [3, 4]);
}

#[test]
fn the_first_device_marks_the_source_address() {
    let mut bench = three();
    let mut sent = frame(&[(DatagramCommand::Nop, 0, vec![0])]);
    let before = sent[6];
    bench.segment.pass(&mut sent, bench.now_ns + 1);
    assert_eq!(sent[6], before | 0x02);
}

#[test]
fn the_ports_show_where_the_wire_ends() {
    let mut bench = three();
    assert_eq!(bench.read_of(1, 0x0110, 2).0, 0x5A33_u16.to_le_bytes());
    assert_eq!(bench.read_of(2, 0x0110, 2).0, 0x5613_u16.to_le_bytes());
    bench.segment.power(2, false, bench.now_ns);
    bench.wait_us(1);
    assert_eq!(bench.read_of(1, 0x0110, 2).0, 0x5613_u16.to_le_bytes());
    assert_eq!(bench.read_of(2, 0x0110, 2).1, 0);
}

/// Outputs of the terminal begin at bit 3 of byte 10, inputs at bit 5 of byte 20.
#[test]
fn bits_are_mapped_across_bytes() {
    let mut bench = Bench::new([digital_io()]);
    let fmmu = |logical: u32, bits: [u8; 2], physical: u16, kind: u8| {
        let mut registers = [0; 16];
        registers[..4].copy_from_slice(&logical.to_le_bytes());
        registers[4] = 2;
        registers[6..8].copy_from_slice(&bits);
        registers[8..10].copy_from_slice(&physical.to_le_bytes());
        (registers[11], registers[12]) = (kind, 1);
        registers
    };
    bench.sync_manager(0, 0x0F00, 1, 0x44);
    bench.sync_manager(1, 0x1000, 1, 0x00);
    bench.write(0x0600, &fmmu(0x1_000A, [3, 2], 0x0F00, 2));
    bench.write(0x0610, &fmmu(0x1_0014, [5, 4], 0x1000, 1));
    for state in [2, 4] {
        assert_eq!(bench.request(state), (state, 0));
    }
    bench.segment.device_mut(0).unwrap().set_digital_inputs(0b1011_0110);
    let mut image = [0; 32];
    image[10] = 0b1010_1000;
    image[11] = 0b0000_0011;
    bench.write(0x0120, &[8, 0]);
    bench.send(DatagramCommand::Lrw, 0x1_0000, &image);
    bench.wait_us(3_000);
    let (data, counter) = bench.send(DatagramCommand::Lrw, 0x1_0000, &image);
    assert_eq!(counter, 3);
    assert_eq!(bench.segment.device(0).unwrap().state(), AlState::Op);
    assert_eq!(bench.segment.device(0).unwrap().digital_outputs(), 0b0111_0101);
    assert_eq!(data[20] >> 5, 0b110);
    assert_eq!(data[21] & 0x1F, 0b1_0110);
    assert_eq!(bench.send(DatagramCommand::Lrd, 0x1_0014, &[0; 2]).1, 1);
    assert_eq!(bench.send(DatagramCommand::Lwr, 0x1_000A, &[0; 2]).1, 1);
    assert_eq!(bench.send(DatagramCommand::Lrw, 0x2_0000, &[0; 2]).1, 0);
}

#[test]
fn a_full_mailbox_takes_nothing_and_an_empty_one_gives_nothing() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.bring_to(AlState::PreOp);
    assert_eq!(bench.read(0x1080, 0x80).1, 0, "empty");
    let mail = [&[10, 0, 0, 0, 0, 0x13, 0, 0x20, 0x40, 0, 0x10, 0][..], &[0; 116]].concat();
    assert_eq!(bench.write(OUT, &mail), 1);
    assert_eq!(bench.read(0x0805, 1).0[0] & 8, 8);
    assert_eq!(bench.write(OUT, &mail), 0, "full");
    bench.wait_us(200);
    assert_eq!((bench.read(0x0805, 1).0[0] & 8, bench.read(0x080D, 1).0[0] & 8), (0, 8));
    assert_eq!(bench.read(0x1080, 0x7F).1, 1, "not to its last byte");
    assert_eq!(bench.read(0x080D, 1).0[0] & 8, 8);
    assert_eq!(bench.read(0x10FF, 1).1, 1);
    assert_eq!(bench.read(0x080D, 1).0[0] & 8, 0);
}

#[test]
fn mail_that_got_lost_on_its_way_back_is_given_once_more_on_request() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.bring_to(AlState::PreOp);
    let first = bench.upload(0x1000, 0).unwrap();
    assert_eq!(bench.read(0x080D, 1).0[0] & 8, 0);
    bench.write(0x080E, &[3]);
    assert_eq!(bench.read(0x080F, 1).0, [2], "acknowledged");
    let (mail, counter) = bench.read(0x1080, 0x80);
    assert_eq!((counter, &mail[12..16]), (1, &first[..]));
}

#[test]
fn a_buffer_of_outputs_counts_when_its_last_byte_is_written() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.bring_to(AlState::Op);
    bench.outputs(6, 0);
    bench.wait_us(1_000);
    assert_eq!(bench.write(0x1100, &[7, 0, 0]), 1);
    bench.wait_us(1_000);
    let status = |bench: &mut Bench| bench.read(0x1700, 6).0[0];
    assert_eq!(status(&mut bench) & 0x6F, 0x21, "ready to switch on");
    assert_eq!(bench.write(0x1103, &[0, 0, 0]), 1);
    bench.outputs(7, 0);
    assert_eq!(status(&mut bench) & 0x6F, 0x23, "switched on");
    assert_eq!(bench.write(0x1102, &[0]), 0, "not from its first byte");
    assert_eq!(bench.write(0x1700, &[0; 6]), 0, "inputs are not written");
}

#[test]
fn the_eeprom_says_who_a_device_is() {
    let mut bench = Bench::new([encoder(1024, Quirks::default())]);
    let mut word = |at: u16| {
        let [low, high] = at.to_le_bytes();
        assert_eq!(bench.write(0x0502, &[0, 1, low, high, 0, 0]), 1);
        assert_eq!(bench.read(0x0502, 2).0[1] & 0x80, 0, "not busy");
        bench.read(0x0508, 8).0
    };
    assert_eq!(word(0x0008), [0x5C, 0x0E, 0, 0, 0x01, 0x51, 0, 0]);
    // mailboxes: out 1000 of 80, in 1080 of 80, CoE
    assert_eq!(word(0x0018), [0, 0x10, 0x80, 0, 0x80, 0x10, 0x80, 0]);
    assert_eq!(word(0x001C)[..2], [4, 0]);
    // the first category: strings
    assert_eq!(word(0x0040)[..2], [10, 0]);
    assert_eq!(word(0xF000), [0xFF; 8]);
}

#[test]
fn the_eeprom_belongs_to_whom_the_register_says() {
    let mut bench = Bench::new([encoder(1024, Quirks::default())]);
    bench.write(0x0500, &[1]);
    bench.write(0x0502, &[0, 1, 8, 0, 0, 0]);
    assert_eq!(bench.read(0x0502, 2).0[1] & 0x20, 0x20, "command error");
}

#[test]
fn an_alias_is_an_address_once_it_is_turned_on() {
    let mut bench = Bench::new([encoder(1024, Quirks::default())]);
    // word 4 of the EEPROM is the alias; it is read at power on
    bench.write(0x0508, &[0x34, 0x12]);
    bench.write(0x0502, &[1, 2, 4, 0, 0, 0]);
    assert_eq!(bench.send(DatagramCommand::Fprd, 0x0130_1234, &[0]).1, 0);
    assert_eq!(bench.read(0x0012, 2).0, [0, 0]);
}

#[test]
fn sync_managers_and_start_times_are_kept_while_they_are_in_use() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.mailboxes();
    bench.write(0x0800, &[0, 0x18]);
    assert_eq!(bench.read(0x0800, 2).0, [0, 0x10]);
    bench.write(0x09A0, &[1, 0, 0, 0]);
    bench.write(0x0981, &[3]);
    assert_eq!(bench.write(0x09A0, &[2, 0, 0, 0]), 0);
    assert_eq!(bench.read(0x09A0, 1).0, [1]);
}
