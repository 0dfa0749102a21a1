//! Modes of operation of an emulated drive, against closed forms.
use crate::support::Bench;
use esc::{AlState, DriveModel, DriveState, Quirks, drive, encoder};
use units::Spin;

/// A drive in PRE-OP that is controlled by SDO, a millisecond at a time.
struct Drive(Bench);

impl Drive {
    fn enabled(mode: u8) -> Self {
        let mut bench = Bench::new([drive(&DriveModel::new(1))]);
        bench.bring_to(AlState::PreOp);
        let mut this = Self(bench);
        this.write(0x6060, 0, i64::from(mode), 1);
        for control in [6, 7, 15] {
            this.write(0x6040, 0, control, 2);
            this.ms(3);
        }
        assert_eq!(this.state(), DriveState::OperationEnabled);
        assert_eq!(this.read(0x6061, 0), i64::from(mode));
        this
    }

    fn write(&mut self, index: u16, sub: u8, value: i64, bytes: usize) {
        assert_eq!(self.0.download(index, sub, &value.to_le_bytes()[..bytes]), Ok(()));
    }

    fn read(&mut self, index: u16, sub: u8) -> i64 {
        self.0.segment.device(0).unwrap().dictionary().number(index, sub).unwrap()
    }

    fn state(&self) -> DriveState {
        self.0.segment.device(0).unwrap().drive_state(0).unwrap()
    }

    fn ms(&mut self, ms: u64) {
        for _ in 0..ms {
            self.0.wait_us(1_000);
        }
    }
}

#[test]
fn csv_turns_at_the_speed_that_is_ordered() {
    let mut drive = Drive::enabled(9);
    drive.write(0x60FF, 0, 131_072, 4);
    drive.ms(2);
    assert_eq!(drive.read(0x606C, 0), 131_072);
    let before = drive.read(0x6064, 0);
    drive.ms(500);
    // a turn a second, for half a second and the frames between
    let turned = drive.read(0x6064, 0) - before;
    assert!((65_536..=66_900).contains(&turned), "{turned}");
}

/// ω = M·t/(2π·J): 127 mN·m on 2e-4 kg·m² for 50 ms.
#[test]
fn cst_accelerates_by_its_torque() {
    let mut drive = Drive::enabled(10);
    drive.write(0x6071, 0, 100, 2);
    drive.ms(50);
    let per_s = drive.read(0x606C, 0) as f64 / 131_072.0;
    let expected = 0.127 / (std::f64::consts::TAU * 2e-4) * 0.05;
    assert!((per_s - expected).abs() < expected * 0.05, "{per_s}, expected {expected}");
    assert_eq!(drive.read(0x6077, 0), 100);
}

#[test]
fn a_frequency_converter_goes_along_its_ramps() {
    let mut drive = Drive::enabled(2);
    drive.write(0x6048, 1, 2_000, 4);
    drive.write(0x6042, 0, 1_000, 2);
    drive.ms(250);
    let rpm = drive.read(0x6044, 0);
    assert!((500..=520).contains(&rpm), "half way after a quarter of a second: {rpm}");
    drive.ms(300);
    assert_eq!(drive.read(0x6044, 0), 1_000);
    assert_eq!(drive.read(0x6041, 0) >> 10 & 1, 1, "reached");
}

#[test]
fn a_target_that_is_far_away_is_a_following_error() {
    let mut drive = Drive::enabled(8);
    drive.write(0x607A, 0, 131_072 * 20, 4);
    drive.ms(20);
    assert_eq!((drive.state(), drive.read(0x603F, 0)), (DriveState::Fault, 0x8611));
    // and it is said in the mailbox
    assert_eq!(drive.0.answer().map(|mail| mail[2..4].to_vec()), Some(vec![0x11, 0x86]));
}

#[test]
fn homing_finds_switches_index_marks_and_this_place() {
    // method, position of the zero in turns of the motor
    let cases =
        [(17, -5.0), (18, 5.0), (1, -5.0), (2, 5.0), (33, -1.0), (34, 1.0), (35, 0.3), (37, 0.3)];
    for (method, zero) in cases {
        let mut drive = Drive::enabled(6);
        let device = drive.0.segment.device_mut(0).unwrap();
        device.motor_mut(0).unwrap().angle = units::Angle::rev(0.3);
        drive.write(0x6098, 0, method, 1);
        drive.write(0x607C, 0, 1_000, 4);
        drive.write(0x6040, 0, 0x1F, 2);
        drive.ms(3_000);
        assert_eq!(drive.read(0x6041, 0) >> 12 & 3, 1, "method {method}: attained, no error");
        let turned = drive.0.segment.device(0).unwrap().motor(0).unwrap().angle.value();
        let position = drive.read(0x6064, 0) as f64;
        let found = turned - (position - 1_000.0) / 131_072.0;
        // a millisecond at a turn a second; to the index mark exactly
        let most = if matches!(method, 17 | 18) { 0.005 } else { 1e-4 };
        let expected = match method {
            // off the switch, to the mark next to it
            1 | 2 => found.round(),
            33 | 34 => {
                if method == 33 {
                    0.0
                } else {
                    1.0
                }
            }
            _ => zero,
        };
        assert!((found - expected).abs() <= most, "method {method}: {found}, expected {expected}");
    }
}

#[test]
fn a_touch_probe_keeps_the_position_of_its_edge() {
    let mut drive = Drive::enabled(9);
    drive.write(0x60FF, 0, 131_072, 4);
    drive.write(0x60B8, 0, 0x0011, 2);
    drive.ms(100);
    drive.0.segment.device_mut(0).unwrap().set_probe(0, true);
    let before = drive.read(0x6064, 0);
    drive.ms(200);
    let kept = drive.read(0x60BA, 0);
    assert_eq!(drive.read(0x60B9, 0), 3);
    assert!((before..before + 400).contains(&kept), "{before} {kept}");
    assert_eq!(drive.read(0x60FD, 0) >> 16 & 1, 1);
    // by the index mark, at whole turns
    drive.write(0x60B8, 0, 0x0015, 2);
    drive.ms(1_100);
    assert_eq!(drive.read(0x60BA, 0) % 131_072, 0);
}

#[test]
fn a_quick_stop_brakes_and_ends_without_torque() {
    let mut drive = Drive::enabled(9);
    drive.write(0x60FF, 0, 131_072 * 40, 4);
    drive.ms(10);
    drive.write(0x6085, 0, 131_072 * 400, 4);
    drive.write(0x6040, 0, 2, 2);
    drive.ms(10);
    assert_eq!(drive.state(), DriveState::QuickStopActive);
    drive.ms(120);
    assert_eq!(drive.state(), DriveState::SwitchOnDisabled);
    let spin = drive.0.segment.device(0).unwrap().motor(0).unwrap().spin;
    assert_eq!(spin, Spin::ZERO);
}

#[test]
fn a_drive_that_loses_its_frames_does_what_6007_says() {
    for (option, expected) in [
        (0, DriveState::OperationEnabled),
        (1, DriveState::Fault),
        (2, DriveState::SwitchOnDisabled),
        (3, DriveState::SwitchOnDisabled),
    ] {
        let mut bench = Bench::new([drive(&DriveModel::new(1))]);
        bench.bring_to(AlState::PreOp);
        bench.download(0x6007, 0, &[option, 0]).unwrap();
        bench.download(0x6060, 0, &[8]).unwrap();
        bench.bring_to(AlState::Op);
        for control in [6, 7, 15, 15] {
            bench.outputs(control, 0);
            bench.wait_us(1_000);
        }
        let state = |bench: &Bench| bench.segment.device(0).unwrap().drive_state(0).unwrap();
        assert_eq!(state(&bench), DriveState::OperationEnabled);
        for _ in 0..200 {
            bench.wait_us(1_000);
        }
        assert_eq!(state(&bench), expected, "6007 = {option}");
    }
}

#[test]
fn an_encoder_counts_and_latches_its_index() {
    let mut bench = Bench::new([encoder(4_096, Quirks::default())]);
    bench.bring_to(AlState::PreOp);
    bench.download(0x7010, 1, &[1, 0]).unwrap();
    bench.segment.device_mut(0).unwrap().set_shaft(Spin::rev_per_s(10.0));
    for _ in 0..250 {
        bench.wait_us(1_000);
    }
    let dictionary = bench.segment.device(0).unwrap().dictionary();
    let count = dictionary.number(0x6010, 0x11).unwrap();
    assert!((10_200..10_600).contains(&count), "two and a half turns: {count}");
    assert_eq!(dictionary.number(0x6010, 1), Some(1));
    assert_eq!(dictionary.number(0x6010, 0x12), Some(4_096), "the first mark");
}
