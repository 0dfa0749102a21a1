//! The record is right or refused, at whatever byte the writer was killed.
use super::slots::{Disk, Kept, Slots, StateFolder};
use super::stroke::tests::geared;
use super::*;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::io;
use units::{Angle, Lead, LeadGrowth, Spin, Stiffness};

fn identity() -> Identity {
    Identity { machine: "tapping-center".into(), serial: 0x51, epoch: 0xe1 }
}

fn record(hole: u32, stage: Stage) -> SyncRecord {
    SyncRecord {
        identity: identity(),
        engagement: 7,
        place: Place {
            program: "programs/plate-12xM6.ngc".into(),
            checksum: 0x1234_5678,
            op: 40 + hole,
            line: 20 + hole,
            hole,
            command: vec!["programs/plate-12xM6.ngc".into(), "-q".into()],
        },
        stage,
        stroke: Stroke {
            cut: Cut::Tap,
            retreat: None,
            axis: 2,
            spindle: 0,
            tool: 11,
            diameter: Length::mm(8.0),
            theta0: Angle::rev(37.0),
            z0: Length::mm(-147.0),
            lead: Lead::mm_per_rev(-1.25),
            growth: LeadGrowth::mm_per_rev2(-0.05),
            start: Length::mm(-147.0),
            bottom: Length::mm(-172.0),
            surface: Length::mm(-152.0),
            spin: Spin::rpm(1000.0),
            stiffness: Stiffness::n_per_mm(20_000.0),
            travel: Length::mm(0.5),
            thread_length: Length::mm(30.0),
            geared: None,
        },
    }
}

/// A disk in memory that dies after so many bytes and steps. What was not put on it may or may not
/// be there after.
#[derive(Clone, Debug, Default)]
struct DyingDisk {
    /// What a reader sees while the machine lives.
    seen: BTreeMap<String, Vec<u8>>,
    /// What is on the platter for certain.
    safe: BTreeMap<String, Vec<u8>>,
    left: usize,
}

impl DyingDisk {
    fn step(&mut self) -> io::Result<()> {
        self.left = self.left.checked_sub(1).ok_or_else(|| io::Error::other("killed"))?;
        Ok(())
    }

    /// After the restart: of what was not safe, by `luck`, nothing, all, or a part padded with
    /// zeros.
    fn survivor(&self, luck: u64) -> Self {
        let mut files = self.safe.clone();
        for (at, (name, bytes)) in (0u64..).zip(&self.seen) {
            if self.safe.get(name) == Some(bytes) {
                continue;
            }
            let whole = std::path::Path::new(name).extension().is_none_or(|end| end != "new");
            match luck.rotate_right((at * 8) as u32) % 4 {
                0 => {}
                1 => drop(files.insert(name.clone(), bytes.clone())),
                // a generation's file holds what was synced before the rename: the old bytes or the
                // new ones
                _ if whole => drop(files.insert(name.clone(), bytes.clone())),
                _ => {
                    let cut = (luck % (bytes.len() as u64 + 1)) as usize;
                    let mut part = bytes[..cut].to_vec();
                    part.resize(bytes.len(), 0);
                    files.insert(name.clone(), part);
                }
            }
        }
        Self { seen: files.clone(), safe: files, left: usize::MAX }
    }
}

impl Disk for &mut DyingDisk {
    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.step()?;
        self.seen.insert(name.into(), Vec::new());
        for byte in bytes {
            self.step()?;
            if let Some(file) = self.seen.get_mut(name) {
                file.push(*byte);
            }
        }
        self.step()?;
        self.safe.insert(name.into(), bytes.to_vec());
        Ok(())
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        self.step()?;
        if let Some(bytes) = self.seen.remove(from) {
            self.seen.insert(to.into(), bytes);
        }
        Ok(())
    }

    fn sync_names(&mut self) -> io::Result<()> {
        self.step()?;
        self.safe = self.seen.clone();
        Ok(())
    }

    fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        Ok(self.seen.get(name).cloned())
    }
}

fn kept(disk: &mut DyingDisk) -> Result<Kept, Untrusted> {
    Slots::open(disk, &identity()).map(|(_, kept)| kept)
}

/// The stages of a program's life: in, turned, out, hole after hole; out of the last one the tap is
/// taken by a recovery.
fn life() -> Vec<SyncRecord> {
    let out = |hole| if hole < 3 { Stage::Out } else { Stage::Recovered };
    let stages = |hole| [Stage::Inward, Stage::Outward, out(hole)];
    (1..=3).flat_map(|hole| stages(hole).map(|stage| record(hole, stage))).collect()
}

#[test]
fn after_a_kill_at_any_of_ten_thousand_bytes_the_record_is_the_old_one_or_the_new_one() {
    let life = life();
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut killed = 0;
    for _ in 0..10_000 {
        // xorshift, for luck and for the instant
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let mut disk = DyingDisk { left: (random % 1920) as usize, ..DyingDisk::default() };
        let mut acknowledged = 0;
        if let Ok((mut slots, _)) = Slots::open(&mut disk, &identity()) {
            acknowledged = life.iter().take_while(|record| slots.write(record).is_ok()).count();
        }
        killed += usize::from(acknowledged < life.len());
        let found = kept(&mut disk.survivor(random >> 8)).unwrap();
        assert_eq!(found.beside, None);
        let old = acknowledged.checked_sub(1).map(|at| &life[at]);
        let new = life.get(acknowledged);
        let found = found.record.as_ref();
        assert!(
            found == old || (found == new && found.is_some()),
            "{acknowledged} acknowledged: {found:?}"
        );
    }
    assert!(killed > 9_000, "only {killed} were killed");
}

#[test]
fn what_was_acknowledged_is_never_forgotten() {
    // the same, from the tap's side: acknowledged inward means that a restart knows of it
    for left in 0..700 {
        let mut disk = DyingDisk { left, ..DyingDisk::default() };
        let (mut slots, _) = Slots::open(&mut disk, &identity()).unwrap();
        let acknowledged = slots.write(&record(1, Stage::Inward)).is_ok();
        let found = kept(&mut disk.survivor(0)).unwrap().record;
        assert!(!acknowledged || found == Some(record(1, Stage::Inward)), "{left} steps");
    }
}

/// A disk on which hole 1 was tapped and hole 2 begun: generations 1 to 4.
fn used() -> DyingDisk {
    let mut disk = DyingDisk { left: usize::MAX, ..DyingDisk::default() };
    let (mut slots, _) = Slots::open(&mut disk, &identity()).unwrap();
    for record in &life()[..4] {
        slots.write(record).unwrap();
    }
    disk
}

const A: &str = "sync-record.a";
const B: &str = "sync-record.b";

fn sentence(disk: &mut DyingDisk) -> String {
    kept(disk).unwrap_err().to_string()
}

#[track_caller]
fn damaged(name: &str, damage: impl Fn(&mut Vec<u8>)) -> Result<Kept, Untrusted> {
    let mut disk = used();
    damage(disk.seen.get_mut(name).unwrap());
    kept(&mut disk)
}

#[test]
fn the_newer_generation_counts() {
    let found = kept(&mut used()).unwrap();
    assert_eq!(found, Kept { record: Some(record(2, Stage::Inward)), beside: None });
}

#[test]
fn a_folder_that_was_never_used_says_nothing_is_in_the_work() {
    let found = kept(&mut DyingDisk::default()).unwrap();
    assert_eq!(found, Kept { record: None, beside: None });
}

#[test]
fn damage_to_the_newer_generation_is_refused_with_its_own_sentence() {
    // generation 4 says that a tap is in hole 2, generation 3 that hole 1 is done
    let said = |damage: &dyn Fn(&mut Vec<u8>)| damaged(B, damage).unwrap_err().to_string();
    let torn = said(&|bytes| bytes.truncate(100));
    assert!(torn.ends_with("the sync record is torn: 100 bytes are there of 206"), "{torn}");
    let empty = said(&Vec::clear);
    assert!(empty.ends_with("0 bytes are there of 22"), "{empty}");
    let longer = said(&|bytes| bytes.push(0));
    assert!(longer.ends_with("207 are there, and it ends after 206"), "{longer}");
    let flipped = said(&|bytes| bytes[120] ^= 0x10);
    assert!(flipped.ends_with("its checksum does not fit"), "{flipped}");
    let foreign = said(&|bytes| *bytes = b"%PDF-1.7".to_vec());
    assert!(foreign.contains("foreign"), "{foreign}");
    let newer = said(&|bytes| bytes[4] = 9);
    assert!(newer.contains("layout 9"), "{newer}");
    let all = [torn, longer, flipped, foreign, newer];
    for (at, one) in all.iter().enumerate() {
        assert!(all[..at].iter().all(|other| other != one), "said twice: {one}");
    }
}

#[test]
fn damage_to_the_older_generation_does_not_matter() {
    let found = damaged(A, |bytes| bytes[60] ^= 1).unwrap();
    assert_eq!(found.record, Some(record(2, Stage::Inward)));
    assert_eq!(found.beside, Some(Untrusted::Changed));
}

#[test]
fn every_single_bit_that_flips_in_the_newer_generation_is_found() {
    let bits = used().seen[B].len() * 8;
    for bit in 0..bits {
        assert!(damaged(B, |bytes| bytes[bit / 8] ^= 1 << (bit % 8)).is_err(), "bit {bit}");
    }
}

#[test]
fn swapped_generations_are_refused() {
    let mut disk = used();
    let (a, b) = (disk.seen[A].clone(), disk.seen[B].clone());
    disk.seen.extend([(A.to_owned(), b), (B.to_owned(), a)]);
    assert!(sentence(&mut disk).contains("have been swapped"));
    let mut disk = used();
    let b = disk.seen[B].clone();
    disk.seen.insert(A.into(), b);
    assert!(sentence(&mut disk).contains("have been swapped"));
}

#[test]
fn a_generation_from_another_time_is_refused() {
    let mut disk = used();
    disk.seen.insert(A.into(), record(1, Stage::Out).encode(1));
    assert_eq!(
        sentence(&mut disk),
        "the generations of the sync record do not belong together: number 1 beside number 4, so one is from another time"
    );
}

#[test]
fn a_missing_generation_is_refused_where_it_may_have_been_the_newer() {
    let mut disk = used();
    disk.seen.remove(B);
    assert!(sentence(&mut disk).contains("is missing"));
    let mut disk = used();
    disk.seen.remove(A);
    assert_eq!(kept(&mut disk).unwrap().beside, Some(Untrusted::Missing));
}

#[test]
fn another_machines_record_and_one_of_an_old_epoch_are_refused() {
    let other = Identity { serial: 0x52, ..identity() };
    let said = Slots::open(&mut used(), &other).unwrap_err().to_string();
    assert_eq!(
        said,
        "the sync record belongs to another machine: to tapping-center number 51, and this is tapping-center number 52"
    );
    let lathe = Identity { machine: "polygon-lathe".into(), ..identity() };
    assert!(Slots::open(&mut used(), &lathe).unwrap_err().to_string().contains("another machine"));
    let homed = Identity { epoch: 0xe2, ..identity() };
    let said = Slots::open(&mut used(), &homed).unwrap_err().to_string();
    assert!(said.contains("stale") && said.contains("00000000000000e1"), "{said}");
}

#[test]
fn a_record_that_says_out_does_not_depend_on_the_epoch() {
    let mut disk = used();
    Slots::open(&mut disk, &identity()).unwrap().0.write(&record(2, Stage::Out)).unwrap();
    let homed = Identity { epoch: 0xe2, ..identity() };
    assert!(Slots::open(&mut disk, &homed).is_ok());
}

#[test]
fn numbers_that_no_tap_can_have_are_refused_though_the_checksum_fits() {
    type Change = fn(&mut Stroke);
    let changes: [(&str, Change); 10] = [
        ("axis", |s| s.axis = 200),
        ("length", |s| s.bottom = Length::mm(f64::NAN)),
        ("length", |s| s.thread_length = Length::mm(f64::INFINITY)),
        ("angle", |s| s.theta0 = Angle::rev(f64::INFINITY)),
        ("lead", |s| s.lead = Lead::ZERO),
        ("lead", |s| {
            (s.cut, s.retreat) = (Cut::Polygon, Some(RETREAT));
            s.lead = Lead::mm_per_rev(f64::NAN);
        }),
        ("lead that grows", |s| s.growth = LeadGrowth::mm_per_rev2(f64::NAN)),
        ("stroke", |s| s.bottom = s.start),
        ("way off the work", |s| s.retreat = Some(RETREAT)),
        ("way off the work", |s| s.cut = Cut::Polygon),
    ];
    for (word, change) in changes {
        let mut senseless = record(1, Stage::Inward);
        change(&mut senseless.stroke);
        let said = SyncRecord::decode(&senseless.encode(1)).unwrap_err().to_string();
        assert!(said.contains("what cannot be") && said.contains(word), "{said}");
    }
}

const RETREAT: Retreat = Retreat { axis: 0, clear: Length::mm(-139.0), outward: true };

#[test]
fn a_tool_that_is_not_screwed_to_the_work_is_recorded_with_its_way_off_it() {
    for (cut, outward) in
        [(Cut::Thread, false), (Cut::Cam, true), (Cut::Polygon, true), (Cut::Gear, true)]
    {
        let mut written = record(0, Stage::Inward);
        let retreat = Retreat { outward, ..RETREAT };
        (written.stroke.cut, written.stroke.retreat) = (cut, Some(retreat));
        if cut != Cut::Thread {
            (written.stroke.lead, written.stroke.bottom) = (Lead::ZERO, written.stroke.start);
        }
        assert_eq!(SyncRecord::decode(&written.encode(7)), Ok((written, 7)));
        let inside = retreat.inside(Length::mm(-140.0));
        assert_eq!(inside, Length::mm(if outward { 1.0 } else { -1.0 }));
    }
}

#[test]
fn a_gear_and_a_command_are_read_as_they_were_written() {
    let mut written = record(1, Stage::Inward);
    written.stroke.geared =
        Some(Geared { swing: vec![(4, 0.01, -0.5), (8, 0.0, 0.002)], ..geared() });
    written.place.command = ["my part.ngc", "", "--cams", "Nocken Ä.toml"].map(String::from).into();
    let bytes = written.encode(3);
    assert_eq!(SyncRecord::decode(&bytes), Ok((written.clone(), 3)));
    for (word, change) in [
        ("gear", (|g| g.master_turns = 0) as fn(&mut Geared)),
        ("gear", |g| g.follower = 77),
        ("gear", |g| g.phase = Angle::rev(f64::NAN)),
        ("gear", |g| g.swing_turns = 0.0),
        ("gear", |g| g.swing[0].1 = f64::INFINITY),
        ("gear", |g| g.axis = Some((2, Lead::ZERO))),
    ] {
        let mut senseless = written.clone();
        senseless.stroke.geared.as_mut().into_iter().for_each(change);
        let said = SyncRecord::decode(&senseless.encode(1)).unwrap_err().to_string();
        assert!(said.contains("what cannot be") && said.contains(word), "{said}");
    }
}

#[test]
fn a_command_that_is_too_long_is_left_out_and_the_record_stays_readable() {
    let mut written = record(1, Stage::Inward);
    for words in [vec!["x".to_owned(); 65], vec!["y".repeat(1000); 4], vec!["z".repeat(1024)]] {
        written.place.command = words;
        written.stroke.geared =
            Some(Geared { swing: vec![(1, 0.1, 0.2); Geared::MOST_TERMS], ..geared() });
        written.place.program = "p".repeat(2000);
        let (read, _) = SyncRecord::decode(&written.encode(1)).unwrap();
        assert_eq!((read.place.command.len(), read.place.program.len()), (0, 1023));
    }
}

#[test]
fn what_no_writer_of_this_version_writes_is_refused_though_the_checksum_fits() {
    let mut written = record(1, Stage::Inward);
    written.place.program = "p".repeat(1000);
    let bytes = written.encode(1);
    let name = [&[0xe8, 0x07][..], &[b'p'; 1000]].concat();
    let at = bytes.windows(name.len()).position(|window| window == name).unwrap();
    let forged = |name: &[u8]| {
        let mut forged = [&bytes[..at], name, &bytes[at + 1002..bytes.len() - TAIL]].concat();
        let length = (forged.len() + TAIL) as u32;
        forged[6..10].copy_from_slice(&length.to_le_bytes());
        forged.extend(crc32fast::hash(&forged).to_le_bytes());
        SyncRecord::decode(&forged)
    };
    assert_eq!(forged(&name), Ok((written, 1)));
    let longer = [&[0xff, 0x08][..], &[b'p'; 1151]].concat();
    let length_of_three_bytes = [&[0xe8, 0x87, 0x00][..], &[b'p'; 1000]].concat();
    for name in [longer, length_of_three_bytes] {
        let said = forged(&name).unwrap_err().to_string();
        assert!(said.contains("not as this version would write it"), "{said}");
    }
}

#[test]
fn a_discarded_record_leaves_two_generations_that_say_out() {
    let mut disk = used();
    disk.seen.get_mut(B).unwrap().truncate(50);
    assert!(kept(&mut disk).is_err());
    Slots::discard(&mut disk, &record(2, Stage::Out)).unwrap();
    let found = kept(&mut disk).unwrap();
    assert_eq!(found, Kept { record: Some(record(2, Stage::Out)), beside: None });
}

/// A disk that refuses.
struct Refusing(io::ErrorKind);

impl Disk for Refusing {
    fn write(&mut self, _: &str, _: &[u8]) -> io::Result<()> {
        Err(self.0.into())
    }
    fn rename(&mut self, _: &str, _: &str) -> io::Result<()> {
        Err(self.0.into())
    }
    fn sync_names(&mut self) -> io::Result<()> {
        Err(self.0.into())
    }
    fn read(&self, _: &str) -> io::Result<Option<Vec<u8>>> {
        Ok(None)
    }
}

#[test]
fn a_full_and_a_read_only_disk_do_not_acknowledge() {
    for kind in [io::ErrorKind::StorageFull, io::ErrorKind::ReadOnlyFilesystem] {
        let (mut slots, _) = Slots::open(Refusing(kind), &identity()).unwrap();
        let refused = slots.write(&record(1, Stage::Inward)).unwrap_err();
        assert_eq!((refused.kind(), slots.generation()), (kind, 0));
    }
}

#[test]
fn a_real_folder_keeps_the_record_and_lets_one_control_in() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("state/machine");
    let folder = StateFolder::open(&path).unwrap();
    let second = StateFolder::open(&path).unwrap_err().to_string();
    let process = std::process::id();
    let end = format!("another Leadscrew, process {process}, is controlling this machine");
    assert!(second.ends_with(&end), "{second}");
    let (mut slots, _) = Slots::open(folder, &identity()).unwrap();
    slots.write(&record(7, Stage::Inward)).unwrap();
    slots.write(&record(7, Stage::Outward)).unwrap();
    drop(slots);
    let (_, kept) = Slots::open(StateFolder::open(&path).unwrap(), &identity()).unwrap();
    assert_eq!(kept.record, Some(record(7, Stage::Outward)));
}

#[test]
#[cfg(target_os = "linux")]
fn a_real_full_disk_and_a_pipe_are_named() {
    let home = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/full", home.path().join("sync-record.new")).unwrap();
    let folder = StateFolder::open(home.path()).unwrap();
    let (mut slots, _) = Slots::open(folder, &identity()).unwrap();
    let refused = slots.write(&record(1, Stage::Inward)).unwrap_err();
    assert_eq!(refused.kind(), io::ErrorKind::StorageFull);
    // nor does a pipe keep the thread that writes
    let new = home.path().join("sync-record.new");
    std::fs::remove_file(&new).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(new).status().unwrap().success());
    let refused = slots.write(&record(1, Stage::Inward)).unwrap_err().to_string();
    assert!(refused.contains("named pipe"), "{refused}");
}

proptest! {
    #[test]
    fn any_bytes_are_a_record_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(SyncRecord::decode(&bytes).is_err());
    }

    #[test]
    fn what_is_written_is_read(theta in -1e6..1e6f64, hole in 0u32..1000, generation in 1u64..u64::MAX, name in ".{0,80}") {
        let mut written = record(hole, Stage::Outward);
        written.stroke.theta0 = Angle::rev(theta);
        written.place.program = name;
        prop_assert_eq!(SyncRecord::decode(&written.encode(generation)), Ok((written, generation)));
    }
}
