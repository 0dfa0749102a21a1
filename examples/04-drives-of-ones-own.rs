//! A kind of machine that Leadscrew does not have: stepper drives that are where they were told to be a period ago, and a
//! spindle on a converter with ramps of its own. One file, and a control leads it like any other machine: `Drives` is the door, and
//! `test_support::drives` holds that whoever stands behind it keeps to what a control relies on.
use bus::{Command, EngagedTool, Feedback, Machine};
use control::drives::{Door, Drives, DrivesChoice, Opened, Opening};
use control::job::ProgramOptions;
use control::operation::{Execution, Request};
use control::{Control, ControlOptions, Refused};
use examples::{Line, draw};
use std::cell::RefCell;
use test_support::drives::{DrivesBench, conforms};
use units::{Angle, Spin, SpinAccel, Time};

/// Ramp of the converter.
const RAMP: SpinAccel = SpinAccel::rev_per_s2(66.7);
/// Pulses of the spindle's encoder in a turn.
const PULSES: f64 = 4096.0;
/// A mill whose drives close their own loops, and whose spindle is told a speed.
const MACHINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../machines/hal/mill.toml");

thread_local! {
    /// Turns of the spindle and Z, mm, period by period: what the plant has done, whatever a control believes.
    static DONE: RefCell<Vec<(f64, f64)>> = const { RefCell::new(Vec::new()) };
}

struct OwnDrives {
    period: Time,
    feedback: Feedback,
    turned: Angle,
    spin: Spin,
}

static DOOR: Door = Door { name: "own", address: None, open };

fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let (period, spindles) = (opening.machine.control.period, opening.machine.spindles.len());
    if spindles != 1 {
        return Err(Refused::because(format!(
            "these drives turn one spindle, and the machine has {spindles}"
        )));
    }
    let feedback = Feedback { tool: Some(0), ..Feedback::default() };
    let drives = OwnDrives { period, feedback, turned: Angle::ZERO, spin: Spin::ZERO };
    Ok(Opened { drives: Box::new(drives), welcome: None })
}

impl Machine for OwnDrives {
    fn period(&self) -> Time {
        self.period
    }

    fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        self.feedback.time += self.period;
        self.feedback.tool = Some(command.tool);
        for (axis, told) in self.feedback.axes.iter_mut().zip(&command.axes) {
            axis.ready = told.enable;
            if told.enable {
                axis.position = told.position + told.speed * self.period;
            }
        }
        let told = &command.spindles[0];
        let wanted = if told.enable { told.spin } else { Spin::ZERO };
        let most = RAMP * self.period;
        self.spin += (wanted - self.spin).max(-most).min(most);
        self.turned += self.spin * self.period;
        let spindle = &mut self.feedback.spindles[0];
        spindle.ready = told.enable;
        spindle.angle = Angle::rev((self.turned.value() * PULSES).floor() / PULSES);
        let z = self.feedback.axes[2].position.of_linear().value();
        DONE.with_borrow_mut(|done| done.push((self.turned.value(), z)));
        &self.feedback
    }
}

/// It is within the control's process, and ends with it.
impl Drives for OwnDrives {
    fn engage(&mut self, _: Option<EngagedTool>) {}

    fn renew_tool(&mut self, _: u32) {}

    fn lost(&self) -> Option<String> {
        None
    }

    fn outlives_control(&self) -> bool {
        false
    }
}

struct Bench;

impl DrivesBench for Bench {
    fn options(&self) -> ControlOptions {
        ControlOptions {
            drives: DrivesChoice::of(&DOOR),
            ..ControlOptions::simulated(ProgramOptions::on(MACHINE))
        }
    }

    fn of_another_machine(&self) -> Option<ControlOptions> {
        None
    }

    fn z_mm(&self) -> f64 {
        DONE.with_borrow(|done| done.last().map_or(f64::NAN, |(_, z)| *z))
    }

    fn outlives_control(&self) -> bool {
        false
    }

    fn without_control(&mut self) {}

    fn vanish(&mut self) -> bool {
        false
    }

    fn delay(&self) -> Time {
        Time::s(2e-3)
    }
}

/// A tap, 10 mm deep, on these drives: the turns of the spindle and Z.
fn tap() -> Result<Vec<(f64, f64)>, Box<dyn std::error::Error>> {
    let mut control = Control::new(Bench.options())?;
    let mut ask = |request: Request, is_done: fn(&Control) -> bool| {
        control.request(&request).map_err(|refusal| refusal.to_string())?;
        while !is_done(&control) {
            control.period();
        }
        Ok::<_, String>(())
    };
    ask(Request::Power(true), |control| control.status().is_ready)?;
    ask(Request::Home(None), Control::is_homed_all)?;
    DONE.with_borrow_mut(Vec::clear);
    let program = "T3 M6\nG91 G0 Z-100\nS1000 M3\nG33.1 Z-10 K1";
    ask(Request::ManualDataInput(program.into()), |control| {
        control.execution() == Execution::ProgramCompleted
    })?;
    let below =
        DONE.with_borrow(|done| done.iter().copied().filter(|(_, z)| *z < -100.1).collect());
    Ok(below)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    conforms(&mut Bench);
    let title = "A tap on drives of one's own: Z is a function of the spindle's turns, in and out";
    let lines = [Line { name: "Z, mm", points: tap()? }];
    draw("04-drives-of-ones-own", title, ["turns of the spindle", "Z, mm"], &lines)?;
    Ok(())
}

#[test]
fn drives_of_ones_own_conform() {
    conforms(&mut Bench);
}
