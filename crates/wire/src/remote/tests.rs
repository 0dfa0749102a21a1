//! Both ends, in one process.
#![allow(clippy::unwrap_used)] // a test may panic
use super::*;
use crate::{LONGEST, VERSION};
use bus::{AXES, Machine, SPINDLES};
use proptest::prelude::*;
use std::collections::VecDeque;
use units::{
    Angle, Coordinate, CoordinateSpeed, Force, Lead, Length, Orientation, Spin, Torque,
    TurnDirection,
};

/// A stream whose other end was written beforehand.
#[derive(Debug, Default)]
struct Script {
    comes: VecDeque<u8>,
    sent: Vec<u8>,
}

impl Read for Script {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.comes.read(buffer)
    }
}

impl Write for Script {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.sent.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn script(messages: &[Message]) -> Script {
    let mut script = Script::default();
    let mut frame = Vec::new();
    for (sequence, message) in (0..).zip(messages) {
        encode(message, sequence, &mut frame);
        script.comes.extend(&frame);
    }
    script
}

fn observed(time: f64) -> Observed {
    let mut observed = Observed::default();
    observed.feedback.time = Time::s(time);
    observed.feedback.axes[2] = bus::AxisFeedback {
        position: Coordinate::new(-151.25),
        motor: Some(Coordinate::new(-151.2)),
        ready: true,
        home_switch: true,
        limit_switches: [false, true],
        index: Some(Coordinate::new(-152.0)),
        force: Some(Force::n(-812.5)),
        fault_code: 0x2310,
    };
    observed.feedback.probe = true;
    observed.feedback.probe_age = Some(Time::s(0.000_1));
    observed.feedback.inputs.switch(63, true);
    observed.feedback.inputs.analogue[15] = -2.5;
    observed.feedback.spindles[0] = bus::SpindleFeedback {
        angle: Angle::rev(12.5),
        index: Some(Angle::rev(12.0)),
        ready: true,
        saturated: true,
        oriented: true,
        orient_fault: -3,
        torque: Some(Torque::n_m(7.25)),
        fault_code: 0x8611,
    };
    observed.feedback.tool = Some(11);
    let mut truth = Truth::default();
    truth.axes[2] = Coordinate::new(-151.249);
    truth.spins[0] = Spin::rpm(1000.0);
    truth.tool_broken = true;
    truth.broken_by = Some(bus::ToolBreak::Stress {
        torque: units::Torque::n_m(9.8),
        force: Force::n(120.0),
        most_torque: units::Torque::n_m(9.2),
        most_force: Force::n(17_000.0),
    });
    observed.truth = Some(truth);
    observed
}

fn command() -> Command {
    let mut command = Command { tool: 11, flood: true, ..Command::default() };
    command.axes[8] = bus::AxisCommand {
        enable: true,
        position: Coordinate::new(1.5),
        speed: CoordinateSpeed::new(-20.0),
        force: Force::n(-1e9),
    };
    command.spindles[1] = bus::SpindleCommand {
        enable: false,
        angle: Angle::rev(-3.25),
        spin: Spin::rpm(-1000.0),
        torque: Torque::n_m(4.5),
        orient: Some(Orientation { angle: Angle::deg(90.0), direction: TurnDirection::Backward }),
        locked: true,
    };
    command.outputs.switch(3, true);
    command.outputs.analogue[0] = 0.75;
    command.coupled = Some(bus::Coupled {
        axis: 2,
        spindle: 0,
        angle: Angle::rev(7.0),
        place: Length::mm(-5.0),
        lead: Lead::mm_per_rev(-1.25),
    });
    command
}

const ENGAGEMENT: EngagedTool = EngagedTool {
    number: 8,
    tool: 11,
    touches: true,
    sync_error: Length::mm(0.004),
    may_be_broken: true,
};

fn welcome() -> Welcome {
    Welcome {
        machine: "tapping-center".into(),
        serial: 7,
        epoch: u64::MAX,
        period: Time::s(250e-6),
        real_time: true,
        turns_lost: [true, false],
        stop: bus::RunDownKind::QuickStop,
        evidence: bus::EngagementEvidence {
            last: 8,
            in_work: Some(ENGAGEMENT),
            sense: bus::SpindleSense::Negative,
        },
        observed: observed(1.0),
    }
}

fn hello() -> Hello {
    Hello { name: "test".into(), machine: "tapping-center".into() }
}

fn every_message() -> Vec<Message> {
    vec![
        Message::Hello(hello()),
        Message::Welcome(welcome()),
        Message::Refused("no".into()),
        Message::Command(command(), None),
        Message::Command(command(), Some(ENGAGEMENT)),
        Message::Observed(observed(2.0)),
        Message::Observed(Observed::default()),
        Message::Order(Order::PowerCut),
        Message::Order(Order::ToolIsFree),
        Message::Told("{}".into()),
    ]
}

#[test]
fn what_is_sent_is_taken() {
    let mut port = Port::new(script(&every_message()));
    for message in every_message() {
        assert_eq!(port.take().unwrap(), message);
    }
    assert!(matches!(port.take(), Err(Error::Gone(_))));
}

/// A stream that hands out so many bytes at a time, and says between two of them that nothing has
/// come.
struct Dripping {
    script: Script,
    at_once: usize,
    reads: usize,
    dry: bool,
}

impl Dripping {
    fn new(at_once: usize, dry: bool) -> Self {
        Self { script: script(&every_message()), at_once, reads: 0, dry }
    }
}

impl Read for Dripping {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reads += 1;
        if self.dry && self.reads % 2 == 1 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        let longest = buffer.len().min(self.at_once);
        self.script.read(&mut buffer[..longest])
    }
}

impl Write for Dripping {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_frame_is_taken_whole_in_whatever_pieces_it_comes() {
    for at_once in [1, 2, 8, 9, 10, 100, 1000, usize::MAX] {
        let mut port = Port::new(Dripping::new(at_once, false));
        for message in every_message() {
            assert_eq!(port.take().unwrap(), message, "{at_once} bytes at a time");
        }
        assert!(matches!(port.take(), Err(Error::Gone(_))));
    }
}

#[test]
fn long_frames_that_come_faster_than_they_are_taken_stay_whole() {
    let long: Vec<_> =
        (0..40).map(|i| Message::Told(i.to_string().repeat(4000 - 90 * i))).collect();
    for at_once in [1000, 7000, usize::MAX] {
        let stream = Dripping { script: script(&long), at_once, reads: 0, dry: false };
        let mut port = Port::new(stream);
        for message in &long {
            assert_eq!(port.take().unwrap(), *message, "{at_once} bytes at a time");
        }
    }
}

/// A servo period costs a call of the system for what is sent, and one for what comes.
#[test]
fn a_frame_that_has_come_is_taken_by_one_read() {
    for message in every_message() {
        let script = script(std::slice::from_ref(&message));
        let mut port = Port::new(Dripping { script, at_once: usize::MAX, reads: 0, dry: false });
        assert_eq!(port.take().unwrap(), message);
        assert_eq!(port.stream().reads, 1, "{message:?}");
    }
}

#[test]
fn what_has_not_come_whole_is_not_waited_for_and_what_has_come_of_it_is_not_lost() {
    for at_once in [30, 200, usize::MAX] {
        let mut port = Port::new(Dripping::new(at_once, true));
        let mut came = Vec::new();
        let ended = loop {
            match port.take_soon() {
                Ok(message) => came.extend(message),
                Err(why) => break why,
            }
        };
        assert_eq!(came, every_message(), "{at_once} bytes at a time");
        assert!(matches!(ended, Error::Gone(_)));
    }
}

#[test]
fn a_tool_in_the_work_that_cannot_be_is_no_message() {
    let wrong = [
        EngagedTool { number: 0, ..ENGAGEMENT },
        EngagedTool { sync_error: Length::mm(f64::NAN), ..ENGAGEMENT },
        EngagedTool { sync_error: Length::mm(-1.0), ..ENGAGEMENT },
    ];
    let mut frame = Vec::new();
    for engagement in wrong {
        encode(&Message::Command(command(), Some(engagement)), 3, &mut frame);
        assert!(matches!(decode(&frame), Err(Error::Senseless)), "{engagement:?}");
    }
}

#[test]
fn each_command_says_which_tool_is_in_the_work() {
    let mut remote = Remote::connect(
        script(&[
            Message::Welcome(welcome()),
            Message::Observed(observed(1.0)),
            Message::Observed(observed(1.0)),
        ]),
        hello(),
    )
    .unwrap();
    remote.engage(Some(ENGAGEMENT));
    remote.exchange(&command());
    remote.engage(None);
    remote.exchange(&command());
    let mut sent = Port::new(Script {
        comes: remote.port.stream().sent.iter().copied().collect(),
        ..Script::default()
    });
    assert_eq!(sent.take().unwrap(), Message::Hello(hello()));
    assert_eq!(sent.take().unwrap(), Message::Command(command(), Some(ENGAGEMENT)));
    assert_eq!(sent.take().unwrap(), Message::Command(command(), None));
}

#[test]
fn every_bit_that_flips_on_the_way_is_found() {
    let mut frame = Vec::new();
    for message in every_message() {
        encode(&message, 3, &mut frame);
        for bit in 0..frame.len() * 8 {
            frame[bit / 8] ^= 1 << (bit % 8);
            assert!(decode(&frame).is_err(), "{}: bit {bit}", message.name());
            frame[bit / 8] ^= 1 << (bit % 8);
        }
        for end in 0..frame.len() {
            assert!(decode(&frame[..end]).is_err(), "{}: cut at {end}", message.name());
        }
    }
}

#[test]
fn a_frame_too_many_or_too_few_ends_the_connection() {
    let mut script = Script::default();
    let mut frame = Vec::new();
    for sequence in [0, 2] {
        encode(&Message::Order(Order::Status), sequence, &mut frame);
        script.comes.extend(&frame);
    }
    let mut port = Port::new(script);
    port.take().unwrap();
    assert_eq!(port.take().unwrap_err().to_string(), "frame 2 came, and 1 was expected");
}

#[test]
fn another_version_and_a_length_beyond_bounds_are_named() {
    let mut frame = Vec::new();
    encode(&Message::Order(Order::Status), 0, &mut frame);
    frame[2] = VERSION + 1;
    let speaks = format!("speaks layout {VERSION}");
    assert!(decode(&frame).unwrap_err().to_string().contains(&speaks));
    frame[2] = VERSION;
    frame[7..9].copy_from_slice(&(LONGEST as u16 + 1).to_le_bytes());
    assert!(matches!(decode(&frame), Err(Error::TooLong(_))));
}

#[test]
fn a_machine_that_vanishes_has_no_ready_drive_and_time_goes_on() {
    let answers = [Message::Welcome(welcome()), Message::Observed(observed(1.000_25))];
    let mut simulator = Remote::connect(script(&answers), hello()).unwrap();
    assert_eq!(*simulator.feedback(), observed(1.0).feedback);
    assert_eq!(*simulator.exchange(&command()), observed(1.000_25).feedback);
    assert!(simulator.lost().is_none());
    let after = simulator.exchange(&command());
    assert!(!after.axes[2].ready && !after.spindles[0].ready);
    assert_eq!(after.axes[2].position, Coordinate::new(-151.25));
    assert!(after.time > Time::s(1.000_25) && simulator.lost().is_some());
}

#[test]
fn a_refusal_is_handed_on() {
    let no = [Message::Refused("the machine simulator is a lathe".into())];
    let refused = Remote::connect(script(&no), hello()).unwrap_err();
    assert_eq!(refused.to_string(), "the machine simulator is a lathe");
}

#[test]
fn a_command_that_no_drive_can_obey_is_no_command() {
    let read = |command: Command| {
        let mut frame = Vec::new();
        encode(&Message::Command(command, None), 0, &mut frame);
        decode(&frame).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(read(command()), Ok(()));
    let spoil: [fn(&mut Command, f64); 10] = [
        |c, wrong| c.axes[8].position = Coordinate::new(wrong),
        |c, wrong| c.axes[8].speed = CoordinateSpeed::new(wrong),
        |c, wrong| c.axes[8].force = Force::n(wrong),
        |c, wrong| c.spindles[1].angle = Angle::rev(wrong),
        |c, wrong| c.spindles[1].spin = Spin::rev_per_s(wrong),
        |c, wrong| c.spindles[1].torque = Torque::n_m(wrong),
        |c, wrong| c.spindles[1].orient = Some(Orientation::shortest(Angle::rev(wrong))),
        |c, wrong| c.outputs.analogue[0] = wrong,
        |c, wrong| c.coupled.as_mut().unwrap().place = Length::mm(wrong),
        |c, wrong| c.coupled.as_mut().unwrap().lead = Lead::mm_per_rev(wrong),
    ];
    for spoil in spoil {
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut command = command();
            spoil(&mut command, wrong);
            assert!(read(command).unwrap_err().contains("says what cannot be"));
        }
    }
    for (axis, spindle) in [(9, 0), (255, 0), (2, 2), (2, 255)] {
        let mut command = command();
        command.coupled = command.coupled.map(|c| bus::Coupled { axis, spindle, ..c });
        assert!(read(command).is_err(), "axis {axis}, spindle {spindle}");
    }
}

proptest! {
    #[test]
    fn any_bytes_are_a_frame_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(decode(&bytes).is_err());
    }

    #[test]
    fn any_payload_is_a_message_or_refused(payload in proptest::collection::vec(any::<u8>(), 0..300)) {
        let mut frame = b"LS".to_vec();
        frame.push(VERSION);
        frame.extend(0u32.to_le_bytes());
        frame.extend((payload.len() as u16).to_le_bytes());
        frame.extend(&payload);
        frame.extend(crc32fast::hash(&frame).to_le_bytes());
        match decode(&frame) {
            Ok((message, 0)) => {
                let mut again = Vec::new();
                encode(&message, 0, &mut again);
                prop_assert!(again.len() <= frame.len(), "{message:?}");
            }
            Ok(_) => prop_assert!(false, "another number"),
            Err(why) => prop_assert!(matches!(why, Error::Senseless), "{why}"),
        }
    }

    #[test]
    fn numbers_pass_unchanged(angle in any::<f64>(), place in any::<f64>(), tool in any::<u32>()) {
        let mut said = observed(0.0);
        said.feedback.spindles[SPINDLES - 1].angle = Angle::rev(angle);
        said.feedback.axes[AXES - 1].position = Coordinate::new(place);
        said.feedback.tool = Some(tool);
        let mut frame = Vec::new();
        encode(&Message::Observed(said), 9, &mut frame);
        let (Message::Observed(read), 9) = decode(&frame).unwrap() else { panic!("another message") };
        let bits = |o: &Observed| (o.feedback.spindles[SPINDLES - 1].angle.value().to_bits(), o.feedback.axes[AXES - 1].position.value().to_bits());
        prop_assert_eq!(bits(&read), bits(&said));
        prop_assert_eq!(read.feedback.tool, Some(tool));
    }
}
