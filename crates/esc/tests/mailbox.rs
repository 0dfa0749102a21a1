//! Service data objects, SDO information, emergencies.
use crate::support::Bench;
use esc::{Abort, AlState, DriveModel, Emergency, Quirks, drive};
use proptest::prelude::*;

fn pre_op(quirks: Quirks) -> Bench {
    let mut bench = Bench::new([drive(&DriveModel { quirks, ..DriveModel::new(7) })]);
    bench.bring_to(AlState::PreOp);
    bench
}

fn refused<T>(abort: Abort) -> Result<T, u32> {
    Err(abort as u32)
}

#[test]
fn values_are_read_expedited_normal_and_in_segments() {
    let mut bench = pre_op(Quirks::default());
    assert_eq!(bench.upload(0x1000, 0), Ok(vec![0x92, 0x01, 0x02, 0x00]));
    assert_eq!(bench.upload(0x1018, 0), Ok(vec![4]));
    assert_eq!(bench.upload(0x1018, 4), Ok(vec![7, 0, 0, 0]));
    assert_eq!(bench.upload(0x1008, 0), Ok(b"Drive".to_vec()));
    let identity = bench.upload_with(0x50, 0x1018, 1).unwrap();
    assert_eq!((identity.len(), &identity[12..]), (16, &[7, 0, 0, 0][..]));
}

/// SOEM reads and writes assignments by complete access, and takes the first 16 bits as the count.
#[test]
fn the_count_of_a_complete_access_has_16_bits_and_a_quirk_has_8() {
    let mut bench = pre_op(Quirks::default());
    assert_eq!(bench.upload_with(0x50, 0x1C12, 0), Ok(vec![1, 0, 0x00, 0x16]));
    let mut bench = pre_op(Quirks { unpadded_complete_access: true, ..Quirks::default() });
    assert_eq!(bench.upload_with(0x50, 0x1C12, 0), Ok(vec![1, 0x00, 0x16]));
    let mut bench = pre_op(Quirks { no_complete_access: true, ..Quirks::default() });
    assert_eq!(bench.upload_with(0x50, 0x1C12, 0), refused(Abort::Unsupported));
}

#[test]
fn long_values_cross_in_segments_both_ways() {
    let mut bench = pre_op(Quirks::default());
    // sixteen entries, 66 bytes with the count: more than a small mailbox has
    let entries: Vec<u8> = (0..8).flat_map(|_| 0x6040_0010_u32.to_le_bytes()).collect();
    let data = [&[8, 0][..], &entries[..]].concat();
    assert_eq!(bench.download_with(0x31, 0x1600, 0, &data), Ok(()));
    assert_eq!(bench.upload(0x1600, 0), Ok(vec![8]));
    assert_eq!(bench.upload_with(0x50, 0x1600, 0), Ok(data));
    assert_eq!(bench.download_with(0x31, 0x1600, 0, &[0; 300]), refused(Abort::TooLong));
    assert_eq!(bench.upload(0x1600, 0), Ok(vec![8]), "as it was");
}

#[test]
fn what_cannot_be_is_refused_with_its_code() {
    let mut bench = pre_op(Quirks::default());
    assert_eq!(bench.upload(0x2000, 0), refused(Abort::NoObject));
    assert_eq!(bench.upload(0x1018, 9), refused(Abort::NoSubindex));
    assert_eq!(bench.download(0x1000, 0, &[0; 4]), refused(Abort::ReadOnly));
    assert_eq!(bench.download(0x6060, 0, &[0; 2]), refused(Abort::TooLong));
    assert_eq!(bench.download(0x6065, 0, &[0; 2]), refused(Abort::TooShort));
    assert_eq!(bench.download(0x6060, 0, &[1]), refused(Abort::Range));
    assert_eq!(bench.download(0x1600, 1, &[0; 4]), refused(Abort::SubindexZeroFirst));
    assert_eq!(bench.download(0x1600, 0, &[0]), Ok(()));
    assert_eq!(
        bench.download(0x1600, 1, &0x6041_0010_u32.to_le_bytes()),
        refused(Abort::NotMappable)
    );
    assert_eq!(
        bench.download(0x1600, 1, &0x6040_0020_u32.to_le_bytes()),
        refused(Abort::NotMappable)
    );
    assert_eq!(bench.download(0x1600, 1, &0x7777_0010_u32.to_le_bytes()), refused(Abort::NoObject));
    assert_eq!(bench.sdo(&[0xA0, 0, 0, 0, 0, 0, 0, 0])[4..], (Abort::Command as u32).to_le_bytes());
    assert_eq!(bench.sdo(&[0x60, 0, 0, 0, 0, 0, 0, 0])[4..], (Abort::Command as u32).to_le_bytes());
}

#[test]
fn mappings_are_written_in_pre_op_alone() {
    let mut bench = Bench::new([drive(&DriveModel::new(1))]);
    bench.bring_to(AlState::SafeOp);
    assert_eq!(bench.download(0x1C12, 0, &[0]), refused(Abort::State));
}

#[test]
fn quirks_refuse_what_they_are_for() {
    let with = |set: fn(&mut Quirks)| {
        let mut quirks = Quirks::default();
        set(&mut quirks);
        pre_op(quirks)
    };
    assert_eq!(
        with(|q| q.fixed_mapping = true).download(0x1600, 0, &[0]),
        refused(Abort::ReadOnly)
    );
    assert_eq!(
        with(|q| q.fixed_assignment = true).download(0x1C12, 0, &[0]),
        refused(Abort::ReadOnly)
    );
    assert_eq!(with(|q| q.rx_pdo_alone = true).upload(0x1C13, 0), Ok(vec![0]));
    assert_eq!(with(|q| q.no_csv = true).download(0x6060, 0, &[9]), refused(Abort::Range));
    assert_eq!(with(|q| q.no_cst = true).download(0x6060, 0, &[10]), refused(Abort::Range));
    assert_eq!(with(|q| q.no_csv = true).upload(0x6502, 0), Ok(0x2A2_u32.to_le_bytes().to_vec()));
    assert_eq!(with(|q| q.wrong_sync_manager_types = true).upload(0x1C00, 3), Ok(vec![4]));
    let mut limited = with(|q| q.no_positive_software_limit = true);
    assert_eq!(limited.upload(0x607D, 2), refused(Abort::NoSubindex));
    let mut fixed = with(|q| q.sync_period_read_only = true);
    assert_eq!(fixed.download(0x1C32, 2, &[0; 4]), refused(Abort::ReadOnly));
    let mut zero = with(|q| q.sync_type_reads_zero = true);
    assert_eq!(zero.download(0x1C32, 1, &[2, 0]), Ok(()));
    assert_eq!(zero.upload(0x1C32, 1), Ok(vec![0, 0]));
    let mut torque = with(|q| q.torque_by_sdo_only = true);
    assert_eq!(torque.download(0x1A00, 0, &[0]), Ok(()));
    let mapped = torque.download(0x1A00, 1, &0x6077_0010_u32.to_le_bytes());
    assert_eq!(mapped, refused(Abort::NotMappable));
    assert_eq!(torque.upload(0x6077, 0), Ok(vec![0, 0]), "16 bits");
}

/// Lists, objects and entries, as a master's tool for the dictionary asks for them.
#[test]
fn the_dictionary_describes_itself() {
    let motors = vec![esc::Motor::new(); 4];
    let mut bench = Bench::new([drive(&DriveModel { motors, ..DriveModel::new(1) })]);
    bench.bring_to(AlState::PreOp);
    let ask = |bench: &mut Bench, request: &[u8]| {
        let mut answers = vec![bench.mail(3, &[&[0, 0x80], request].concat()).unwrap()];
        while u16::from_le_bytes([answers.last().unwrap()[4], answers.last().unwrap()[5]]) > 0 {
            answers.push(bench.answer().unwrap());
        }
        let data = answers.iter().flat_map(|answer| answer[6..].to_vec());
        (answers[0][2] & 0x7F, answers.len(), data.collect::<Vec<u8>>())
    };
    let (operation, mails, list) = ask(&mut bench, &[1, 0, 0, 0, 1, 0]);
    let count = bench.segment.device(0).unwrap().dictionary().objects().len();
    assert_eq!((operation, list.len()), (2, 2 + 2 * count));
    assert!(mails > 1, "in fragments");
    assert_eq!(list[2..4], 0x1000_u16.to_le_bytes());
    let (operation, _, object) = ask(&mut bench, &[3, 0, 0, 0, 0x40, 0x60]);
    assert_eq!((operation, &object[..6]), (4, &[0x40, 0x60, 6, 0, 0, 7][..]));
    assert_eq!(&object[6..], b"Control word");
    let (operation, _, entry) = ask(&mut bench, &[5, 0, 0, 0, 0x41, 0x60, 0, 0]);
    // UNSIGNED16, 16 bits, read in all states, TxPDO
    assert_eq!((operation, &entry[..10]), (6, &[0x41, 0x60, 0, 0, 6, 0, 16, 0, 0x87, 0][..]));
    let (operation, _, error) = ask(&mut bench, &[3, 0, 0, 0, 0, 0x20]);
    assert_eq!((operation, error), (7, (Abort::NoObject as u32).to_le_bytes().to_vec()));
    let mut bench = pre_op(Quirks { no_sdo_information: true, ..Quirks::default() });
    assert_eq!(bench.mail(3, &[0, 0x80, 1, 0, 0, 0, 1, 0]).unwrap()[..4], [1, 0, 2, 0]);
}

#[test]
fn mail_of_another_kind_is_answered_by_an_error() {
    let mut bench = pre_op(Quirks::default());
    assert_eq!(bench.mail(4, &[1, 2, 3]), Some(vec![1, 0, 2, 0]), "file access: not supported");
    assert_eq!(bench.mail(3, &[1]), Some(vec![1, 0, 4, 0]), "no CoE header");
}

#[test]
fn an_emergency_comes_unasked_and_answers_wait_behind_it() {
    let mut bench = pre_op(Quirks::default());
    let emergency = Emergency { code: 0x7500, register: 0x11, data: [1, 2, 3, 4, 5] };
    bench.segment.device_mut(0).unwrap().say(emergency);
    assert_eq!(bench.answer(), Some(vec![0, 0x10, 0x00, 0x75, 0x11, 1, 2, 3, 4, 5]));
    // nobody reads: what is said is bounded
    for _ in 0..1_000 {
        bench.segment.device_mut(0).unwrap().say(emergency);
    }
    let mails = std::iter::from_fn(|| bench.answer()).count();
    assert_eq!(mails, 65, "64 waiting and one in the mailbox");
}

#[test]
fn a_segment_with_the_wrong_toggle_ends_the_transfer() {
    let mut bench = pre_op(Quirks::default());
    let size = 200_u32.to_le_bytes();
    let mut request = vec![0x31, 0x00, 0x16, 0, size[0], size[1], size[2], size[3]];
    request.resize(8 + 112, 0);
    assert_eq!(bench.sdo(&request)[0], 0x60);
    let mut segment = vec![0x10];
    segment.resize(50, 0);
    assert_eq!(bench.sdo(&segment)[4..], (Abort::Toggle as u32).to_le_bytes());
    assert_eq!(bench.sdo(&segment)[4..], (Abort::Command as u32).to_le_bytes(), "it has ended");
}

proptest! {
    #[test]
    fn no_mail_makes_a_device_panic_or_go_silent(
        kind in prop_oneof![3 => Just(3_u8), 1 => 0_u8..16],
        service in prop_oneof![4 => Just(0x20_u8), 2 => Just(0x80_u8), 1 => any::<u8>()],
        bodies in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..118), 1..6),
        objects in proptest::collection::vec(prop_oneof![
            Just(0x1600_u16), Just(0x1A00), Just(0x1C12), Just(0x1C13), Just(0x1018), Just(0x6040), any::<u16>()
        ], 6),
    ) {
        let mut bench = pre_op(Quirks::default());
        for (mut body, object) in bodies.into_iter().zip(objects) {
            if let Some(place) = body.get_mut(1..3) {
                place.copy_from_slice(&object.to_le_bytes());
            }
            bench.mail(kind, &[&[0, service][..], &body].concat());
            while bench.answer().is_some() {}
        }
        prop_assert_eq!(bench.upload(0x1000, 0), Ok(vec![0x92, 0x01, 0x02, 0x00]));
    }
}
