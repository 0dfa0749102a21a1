//! Tool changes by a sequence, stopped at any instant: no collision, no tool lost, always a way on.
//!
//! ```text
//!   seed ─► magazine, tool called ─► hold │ stop │ reset │ emergency stop │ power cut │ kill │ mishap, at a random instant
//!        ─► mended, powered ─► go on │ undo │ step by step, perhaps stopped once more ─► at rest
//!   held to: 0 collisions and 0 dropped tools in the plant; the control's table is the plant's truth
//! ```
use bus::{Command, EngagedTool, Feedback, Machine, Truth};
use control::drives::{Door, DrivesChoice, Opened, Opening, Simulation, simulated};
use control::job::ProgramOptions;
use control::operation::{Request, SequenceOrder};
use control::{Control, ControlOptions, Drives, Refused, config};
use sim::{CarouselMishap, CarouselTruth, Fault, Faulty};
use std::cell::RefCell;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use store::state::{ChangerRecord, MachineIdentity, StateFolder};
use test_support::Dice;
use test_support::size;
use units::Time;

const MACHINE: &str = "umbrella-mill";

/// A machine that goes on when its control ends.
#[derive(Clone)]
struct Lasting(Arc<Mutex<Simulation>>);

impl Lasting {
    fn lock(&self) -> MutexGuard<'_, Simulation> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn truth(&self) -> CarouselTruth {
        self.lock().machine().carousel().unwrap()
    }

    /// Without a control, and without power.
    fn left_alone(&self, seconds: f64) {
        let mut machine = self.lock();
        let tool = machine.feedback().tool.unwrap_or(0);
        let periods = (seconds / machine.period().value()) as usize;
        for _ in 0..periods {
            machine.exchange(&Command { tool, ..Command::default() });
        }
    }
}

struct Shared {
    machine: Lasting,
    period: Time,
    feedback: Feedback,
    truth: Option<Truth>,
}

impl Machine for Shared {
    fn period(&self) -> Time {
        self.period
    }

    fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        let mut machine = self.machine.lock();
        self.feedback = *machine.exchange(command);
        self.truth = machine.truth().copied();
        drop(machine);
        &self.feedback
    }

    fn truth(&self) -> Option<&Truth> {
        self.truth.as_ref()
    }
}

impl Drives for Shared {
    fn engage(&mut self, _: Option<EngagedTool>) {}

    fn renew_tool(&mut self, _: u32) {}

    fn lost(&self) -> Option<String> {
        None
    }

    fn outlives_control(&self) -> bool {
        true
    }
}

thread_local! {
    static MACHINE_HERE: RefCell<Option<Lasting>> = const { RefCell::new(None) };
}

#[allow(clippy::unnecessary_wraps)] // as a door opens
fn open(opening: &Opening<'_>) -> Result<Opened, Refused> {
    let Opening { machine, tools, material, seed, zero, .. } = *opening;
    let lasting = MACHINE_HERE.with_borrow_mut(|here| {
        here.get_or_insert_with(|| {
            let config = config::simulator(machine, tools, material, seed, zero);
            let alone = config::left_alone(machine, &config);
            let simulated = simulated::build(machine, config).unwrap();
            Lasting(Arc::new(Mutex::new(Faulty::new(simulated, &[], seed).left_alone(alone))))
        })
        .clone()
    });
    let (period, feedback) = {
        let machine = lasting.lock();
        (machine.period(), *machine.feedback())
    };
    let drives = Box::new(Shared { machine: lasting, period, feedback, truth: None });
    Ok(Opened { drives, welcome: None })
}

const DOOR: Door = Door { name: "lasting", address: None, open };
static LASTING: Door = DOOR;

/// A control, its state folder and the machine that outlives it.
struct Bench {
    folder: tempfile::TempDir,
    control: Option<Control>,
    machine: Lasting,
}

fn options(folder: &Path) -> ControlOptions {
    ControlOptions {
        state: Some(folder.to_owned()),
        drives: DrivesChoice::of(&LASTING),
        ..ControlOptions::simulated(ProgramOptions::on(MACHINE))
    }
}

impl Bench {
    /// With these tools in the pockets, and this tool of them in the spindle.
    fn new(mounted: u32) -> Self {
        MACHINE_HERE.with_borrow_mut(|here| *here = None);
        let folder = tempfile::tempdir().unwrap();
        let mut first = Control::new(options(folder.path())).unwrap();
        let machine = MACHINE_HERE.with_borrow(|here| here.clone().unwrap());
        power(&mut first);
        first.request(&Request::Home(None)).unwrap();
        (0..20).for_each(|_| first.period());
        assert!(first.is_homed_all());
        let magazine = first.magazine_status().unwrap();
        drop(first);
        let mut pockets = magazine.pockets;
        let home = pockets.iter().position(|tool| *tool == mounted && mounted != 0);
        if let Some(home) = home {
            pockets[home] = 0;
        }
        let home = home.map_or(0, |home| home as u32 + 1);
        machine.lock().machine_mut().load_carousel(&pockets, mounted, Some(1));
        let file = store::machine::find(MACHINE).unwrap();
        let (mut state, ..) =
            StateFolder::open(folder.path(), &MachineIdentity::of(&file)).unwrap();
        let record = ChangerRecord { pockets, spindle: mounted, home, at: 1, half_way: None };
        state.save_changer(&record).unwrap();
        drop(state);
        let mut bench = Self { folder, control: None, machine };
        bench.switch_on();
        bench
    }

    fn switch_on(&mut self) {
        let mut control =
            Control::new(options(self.folder.path())).unwrap_or_else(|e| panic!("{e}"));
        power(&mut control);
        self.control = Some(control);
    }

    fn control(&mut self) -> &mut Control {
        self.control.as_mut().unwrap()
    }

    fn pass(&mut self, seconds: f64) {
        let control = self.control();
        let end = control.now() + Time::s(seconds);
        while control.now() < end {
            control.period();
        }
    }

    /// Until nothing is under way, or an alarm has stopped it.
    fn until_over(&mut self) {
        let control = self.control();
        let end = control.now() + Time::s(60.0);
        while control.status().program.is_some() || !control.is_at_standstill() {
            (0..40).for_each(|_| control.period());
            assert!(control.now() < end, "it does not end: {:#?}", control.status());
        }
    }

    /// What a stop has left is cleared, and the drives are on.
    fn make_ready(&mut self) {
        let control = self.control();
        let _ = control.request(&Request::Reset);
        (0..2000).for_each(|_| control.period());
        power(control);
    }

    fn order(&mut self, order: SequenceOrder) -> Result<(), String> {
        let made = self.control().request(&Request::Sequence(order));
        made.map(drop).map_err(|why| why.to_string())
    }

    fn half_way(&mut self) -> bool {
        self.control().sequence_status().is_some_and(|now| now.is_half_way)
    }

    /// What must be so at the end.
    fn check(&mut self, seed: &str) {
        let truth = self.machine.truth();
        assert_eq!((truth.collisions, truth.dropped.len()), (0, 0), "{seed}: {truth:#?}");
        let table = self.control().magazine_status().unwrap();
        assert_eq!((&table.pockets, table.spindle), (&truth.pockets, truth.spindle), "{seed}");
        assert!(!truth.is_in_the_way, "{seed}");
        if table.at.is_some() {
            assert_eq!(table.at, truth.at, "{seed}");
        }
    }
}

fn power(control: &mut Control) {
    let end = control.now() + Time::s(5.0);
    control.request(&Request::Power(true)).unwrap_or_else(|why| panic!("{why}"));
    while !control.status().is_ready {
        control.period();
        assert!(control.now() < end, "{:#?}", control.status());
    }
    (0..4).for_each(|_| control.period());
}

/// What comes between.
#[derive(Clone, Copy, Debug)]
enum Blow {
    Nothing,
    Hold,
    Stop,
    EmergencyStop,
    PowerCut,
    Kill,
    Mishap(CarouselMishap),
}

const BLOWS: [Blow; 14] = [
    Blow::Nothing,
    Blow::Hold,
    Blow::Stop,
    Blow::Stop,
    Blow::EmergencyStop,
    Blow::PowerCut,
    Blow::PowerCut,
    Blow::Kill,
    Blow::Mishap(CarouselMishap::SwingStuck),
    Blow::Mishap(CarouselMishap::DrawbarStuck),
    Blow::Mishap(CarouselMishap::AirLost),
    Blow::Mishap(CarouselMishap::SensorDead(0)),
    Blow::Mishap(CarouselMishap::SensorDead(3)),
    Blow::Mishap(CarouselMishap::SensorDead(4)),
];

/// A tool change or a way on is under way: after so long this comes, and everything ends.
fn strike(bench: &mut Bench, blow: Blow, after: f64) {
    bench.pass(after);
    match blow {
        Blow::Nothing => {}
        Blow::Hold => {
            if bench.control().request(&Request::FeedHold).is_ok() {
                bench.pass(0.4);
                let _ = bench.control().request(&Request::Resume);
            }
        }
        Blow::Stop => drop(bench.control().request(&Request::Stop)),
        Blow::EmergencyStop => {
            bench.machine.lock().strike(Fault::EmergencyStop);
            bench.pass(0.8);
            bench.machine.lock().repair(Fault::EmergencyStop);
            bench.pass(0.1);
        }
        Blow::PowerCut | Blow::Kill => {
            bench.control = None;
            bench.machine.left_alone(if matches!(blow, Blow::Kill) { 0.05 } else { 2.0 });
            bench.switch_on();
        }
        Blow::Mishap(mishap) => bench.machine.lock().machine_mut().fail_carousel(Some(mishap)),
    }
    bench.until_over();
    bench.machine.lock().machine_mut().fail_carousel(None);
    bench.make_ready();
}

/// The operator leads it on, with a further blow now and then, until it is at rest; ways tried.
fn lead_on(bench: &mut Bench, dice: &mut Dice, seed: &str) -> u32 {
    const MOST: u32 = 60;
    let mut ways = 0;
    let mut blows = 2;
    while bench.half_way() {
        ways += 1;
        assert!(ways < MOST, "{seed}: no way on: {:#?}", bench.control().sequence_status());
        let order = *dice.one_of(&[
            SequenceOrder::GoOn,
            SequenceOrder::GoOn,
            SequenceOrder::Undo,
            SequenceOrder::Step,
            SequenceOrder::StepBack,
        ]);
        // no start while it is half way
        let refused = bench.control().request(&Request::ManualDataInput("G0 Z0".into()));
        assert!(refused.unwrap_err().to_string().contains("half way"), "{seed}");
        bench.order(order).unwrap_or_else(|why| panic!("{seed}: {order:?}: {why}"));
        if blows > 0 && dice.chance(0.3) {
            blows -= 1;
            strike(bench, *dice.one_of(&BLOWS), dice.between(0.0, 2.0));
        } else {
            bench.until_over();
            bench.make_ready();
        }
        let truth = bench.machine.truth();
        assert_eq!(truth.collisions, 0, "{seed}: {order:?}: {:?}", truth.described);
    }
    ways
}

#[test]
fn a_tool_change_that_is_stopped_anywhere_collides_with_nothing_and_loses_no_tool() {
    let cases = size::of(20, 1000);
    let (mut half_way, mut ways) = (0, 0);
    for case in 0..cases {
        let mut dice = Dice(0x5EC0 + case as u64);
        let (from, to) = ((dice.draw() % 6) as u32, (dice.draw() % 7) as u32);
        let blow = *dice.one_of(&BLOWS);
        let after = dice.between(0.0, 3.8);
        let seed = format!("case {case}: T{from} to T{to}, {blow:?} after {after:.4} s");
        let mut bench = Bench::new(from);
        let text = format!("T{to} M6");
        bench.control().request(&Request::ManualDataInput(text)).unwrap();
        strike(&mut bench, blow, after);
        half_way += u32::from(bench.half_way());
        ways += lead_on(&mut bench, &mut dice, &seed);
        bench.check(&seed);
        if case % 100 == 99 {
            println!("{} changes, {half_way} left half way, {ways} ways on", case + 1);
        }
        // a program goes on from here
        let next = (dice.draw() % 7) as u32;
        if dice.chance(0.2) {
            let text = format!("T{next} M6");
            bench.control().request(&Request::ManualDataInput(text)).unwrap();
            bench.until_over();
            bench.check(&seed);
            assert_eq!(bench.machine.truth().spindle, next, "{seed}");
        }
    }
    println!(
        "{cases} changes, {half_way} left half way, {ways} ways on, 0 collisions, 0 tools lost"
    );
}
