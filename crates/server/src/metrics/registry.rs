//! The metrics: their names, units and labels, and what they are made of.
//!
//! Counters and histograms are made of events, so that nothing is missed between two requests;
//! gauges of the latest picture. No label has values without a limit.
use super::adding::{Adding, BinEnds, Binned, Labels, Level, raise};
use super::process;
use super::publishing::PublishMetrics;
use crate::mqtt::PublishStatus;
use control::RealTimeFigures;
use control::operation::hosted::Journaled;
use control::operation::{EmergencyStop, Event, Execution, Mode, Status};
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::{Registry, Unit};
use std::collections::BTreeSet;
use std::sync::atomic::AtomicU64;
use store::machine::MachineFile;
use verify::{Feature, FeatureKind, Verdict};

/// Programs that are told apart by name; later ones are `other`.
const MOST_PROGRAMS: usize = 50;
/// Longest name of a program, characters.
const LONGEST_NAME: usize = 100;
/// Upper ends of the bins of sync errors, m: 0.1 µm to 100 µm.
const SYNC_ERRORS: [f64; 10] = [1e-7, 2e-7, 5e-7, 1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4];
/// Upper ends of the bins of cycle times, s.
const CYCLE_TIMES: [f64; 12] =
    [5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0, 3600.0, 7200.0];

const GOOD: &str = "good";
const FAILED: &str = "failed";
const NOT_JUDGED: &str = "not_judged";
const COMPLETED: &str = "completed";
const GIVEN_UP: &str = "given_up";

/// How the control is.
struct StateMetrics {
    execution: Family<Labels, Gauge>,
    mode: Family<Labels, Gauge>,
    emergency_stop: Gauge,
    ready: Gauge,
    alarms: Gauge,
}

impl StateMetrics {
    fn added(add: &mut Adding<'_>) -> Self {
        let (states, gauge) = (Family::default, Gauge::default);
        Self {
            execution: add.one("execution", "1 of what the program does", states()),
            mode: add.one("mode", "1 of who leads the axes", states()),
            emergency_stop: add.one(
                "emergency_stop_triggered",
                "1: the emergency stop is triggered",
                gauge(),
            ),
            ready: add.one(
                "ready",
                "1: the drives are up, and nothing has stopped the machine",
                gauge(),
            ),
            alarms: add.one("alarms_active", "Alarms that no reset has cleared", gauge()),
        }
    }

    fn set(&self, status: &Status) {
        let is_so = |gauge: &Gauge, is_so: bool| {
            gauge.set(i64::from(is_so)); // what it was before does not matter
        };
        for state in Execution::ALL.map(Execution::name) {
            is_so(&self.execution.get_or_create(&label("state", state)), state == status.execution);
        }
        for mode in Mode::ALL.map(Mode::name) {
            is_so(&self.mode.get_or_create(&label("mode", mode)), mode == status.mode);
        }
        is_so(&self.emergency_stop, status.emergency_stop == EmergencyStop::Triggered.name());
        is_so(&self.ready, status.is_ready);
        self.alarms.set(status.alarms.len().cast_signed() as i64);
    }
}

/// What moves.
struct MotionMetrics {
    planner_lead: Level,
    path_speed: Level,
    feed_override: Level,
    spindle_speed: Family<Labels, Level>,
    spindle_load: Family<Labels, Level>,
    spindle_thermal: Family<Labels, Level>,
    axis_load: Family<Labels, Level>,
    axis_thermal: Family<Labels, Level>,
}

impl MotionMetrics {
    fn added(add: &mut Adding<'_>) -> Self {
        let other = |unit: &str| Unit::Other(unit.into());
        Self {
            planner_lead: add.level(
                ("planner_lead", Unit::Seconds),
                "How long what is planned, and waits to be executed, will take",
            ),
            path_speed: add.level(
                ("path_speed", other("meters_per_second")),
                "Speed of the path of X, Y and Z as it is ordered",
            ),
            feed_override: add.level(("feed_override", Unit::Ratios), "Of the programmed feed"),
            spindle_speed: add.of(
                ("spindle_speed", other("hertz")),
                "Speed by its encoder, positive is M3",
                Family::default(),
            ),
            spindle_load: add.of(
                ("spindle_load", Unit::Ratios),
                "Torque measured, or else ordered, of what the drive can hold for ever at this speed",
                Family::default(),
            ),
            spindle_thermal: add.of(
                ("spindle_thermal_load", Unit::Ratios),
                "How warm the drive is by its load, of what it bears for ever",
                Family::default(),
            ),
            axis_load: add.of(
                ("axis_load", Unit::Ratios),
                "Force or torque measured, of what the drive can hold for ever",
                Family::default(),
            ),
            axis_thermal: add.of(
                ("axis_thermal_load", Unit::Ratios),
                "How warm the drive is by its load, of what it bears for ever",
                Family::default(),
            ),
        }
    }

    fn set(&self, status: &Status) {
        self.planner_lead.set(status.program.as_ref().map_or(0.0, |program| program.ahead_s));
        self.path_speed.set(status.path_mm_per_min / 60e3);
        self.feed_override.set(status.overrides.feed_percent / 100.0);
        for (number, spindle) in status.spindles.iter().enumerate() {
            let of = label("spindle", &number.to_string());
            self.spindle_speed.get_or_create(&of).set(spindle.measured_rpm / 60.0);
            set_percent(&self.spindle_load, &of, spindle.load_percent);
            set_percent(&self.spindle_thermal, &of, spindle.thermal_percent);
        }
        for axis in &status.axes {
            let of = label("axis", &axis.letter.to_string());
            set_percent(&self.axis_load, &of, axis.load_percent);
            set_percent(&self.axis_thermal, &of, axis.thermal_percent);
        }
    }
}

/// Sets a ratio that is stated in percent; one that is not known is left out.
fn set_percent(of_all: &Family<Labels, Level>, of: &Labels, percent: Option<f64>) {
    if let Some(percent) = percent {
        of_all.get_or_create(of).set(percent / 100.0);
    }
}

/// What was done.
struct WorkMetrics {
    alarms: Family<Labels, Counter>,
    features: Family<Labels, Counter>,
    programs: Family<Labels, Counter>,
    sync_error: Binned,
    cycle_time: Binned,
}

impl WorkMetrics {
    fn added(add: &mut Adding<'_>) -> Self {
        let counters = Family::default;
        let work = Self {
            alarms: add.one("alarms", "Alarms, by number in the list of alarms", counters()),
            features: add.one("features", "Features that were cut, by verdict", counters()),
            programs: add.one("programs", "Programs that are over, by how they ended", counters()),
            sync_error: add.bins(
                ("sync_error_max", Unit::Meters),
                "Largest distance of each thread from its coupling, as it was judged",
                BinEnds(&SYNC_ERRORS),
            ),
            cycle_time: add.bins(
                ("cycle_time", Unit::Seconds),
                "From the start of a program to its end, holds included, machine time",
                BinEnds(&CYCLE_TIMES),
            ),
        };
        // a series that is there from the beginning shows its first increase
        for kind in FeatureKind::NAMES {
            for verdict in [GOOD, FAILED, NOT_JUDGED] {
                let _ = work.features.get_or_create(&feature_labels(kind, verdict));
            }
        }
        for kind in FeatureKind::SYNCHRONISED {
            let _ = work.sync_error.get_or_create(&label("kind", kind));
        }
        for end in [COMPLETED, GIVEN_UP] {
            let _ = work.programs.get_or_create(&label("end", end));
        }
        work
    }

    fn feature(&self, feature: &Feature) {
        let verdict = match feature.verdict {
            Verdict::Pass => GOOD,
            Verdict::Fail { .. } => FAILED,
            Verdict::NotJudged { .. } => NOT_JUDGED,
        };
        let kind = feature.kind_name();
        self.features.get_or_create(&feature_labels(kind, verdict)).inc();
        if let Some(error) = feature.sync_error_max() {
            self.sync_error.get_or_create(&label("kind", kind)).observe(error.value() / 1e3);
        }
    }
}

/// A servo thread of its own.
struct ServoThreadMetrics {
    tick_median: Level,
    tick_p999: Level,
    tick_worst: Level,
    worst_lateness: Level,
    periods: Counter,
    late: Counter,
    unobserved: Counter,
    clock_resets: Counter,
}

impl ServoThreadMetrics {
    fn added(add: &mut Adding<'_>) -> Self {
        let s = || Unit::Seconds;
        Self {
            tick_median: add.level(("servo_tick_median", s()), "Median of the kernel's tick"),
            tick_p999: add.level(("servo_tick_p999", s()), "99.9 of 100 ticks are shorter"),
            tick_worst: add.level(("servo_tick_worst", s()), "The longest tick"),
            worst_lateness: add
                .level(("servo_lateness_worst", s()), "The latest period, after it was due"),
            periods: add.counter("servo_periods", "Servo periods"),
            late: add.counter("servo_periods_late", "Periods begun a whole period late or later"),
            unobserved: add.counter("servo_periods_unobserved", "Periods that nothing has judged"),
            clock_resets: add.counter("servo_clock_resets", "So late that the clock was set anew"),
        }
    }

    fn set(&self, figures: &RealTimeFigures) {
        self.tick_median.set(figures.tick_median_us / 1e6);
        self.tick_p999.set(figures.tick_p999_us / 1e6);
        self.tick_worst.set(figures.tick_worst_us / 1e6);
        self.worst_lateness.set(figures.worst_late_us / 1e6);
        raise(&self.periods, figures.periods);
        raise(&self.late, figures.late);
        raise(&self.unobserved, figures.unobserved);
        raise(&self.clock_resets, figures.set_anew);
    }
}

/// All of them.
pub(super) struct ControlMetrics {
    registry: Registry,
    states: StateMetrics,
    motion: MotionMetrics,
    work: WorkMetrics,
    /// Where real time keeps the time.
    servo: Option<ServoThreadMetrics>,
    /// Where observations are published to a broker.
    publishing: Option<PublishMetrics>,
    memory: Gauge,
    processor: Counter<f64, AtomicU64>,
    is_automatic: bool,
    /// The program that is under way: since when, machine time in s, and its name.
    begun: Option<(f64, String)>,
    /// Programs that are told apart.
    names: BTreeSet<String>,
}

impl ControlMetrics {
    /// Of a machine.
    pub(super) fn of(machine: &MachineFile, status: &Status, is_published: bool) -> Self {
        let mut registry = Registry::default();
        let add = &mut Adding(&mut registry);
        // named as all programs name them
        let memory = ("process_resident_memory", Unit::Bytes);
        let memory = add.of(memory, "Memory in use", Gauge::default());
        let processor = ("process_cpu", Unit::Seconds);
        let processor = add.of(processor, "Processor time used", Counter::default());
        let add = &mut Adding(registry.sub_registry_with_prefix("leadscrew"));
        let machine = ("machine", machine.name.clone());
        let about = vec![("version", env!("CARGO_PKG_VERSION").to_owned()), machine];
        add.0.register("build", "Version, and the machine that is led", Info::new(about));
        Self {
            states: StateMetrics::added(add),
            motion: MotionMetrics::added(add),
            work: WorkMetrics::added(add),
            servo: status.real_time.is_some().then(|| ServoThreadMetrics::added(add)),
            publishing: is_published.then(|| PublishMetrics::added(add)),
            registry,
            memory,
            processor,
            is_automatic: status.mode == Mode::Automatic.name(),
            begun: None,
            names: BTreeSet::new(),
        }
    }

    /// Something has happened; the program's name, if one is under way or loaded.
    pub(super) fn count(&mut self, event: &Journaled, program: &str) {
        match &*event.event {
            Event::Execution(execution) => self.execution(*execution, event.time.value(), program),
            Event::Mode(mode) => self.is_automatic = *mode == Mode::Automatic,
            Event::Alarm(alarm) => {
                let of = label("number", &alarm.number.to_string());
                self.work.alarms.get_or_create(&of).inc();
            }
            Event::Feature(feature) => self.work.feature(feature),
            Event::Notice(_) | Event::DrivesReady => {}
        }
    }

    fn execution(&mut self, execution: Execution, time_s: f64, program: &str) {
        if execution.is_under_way() {
            if self.begun.is_none() && self.is_automatic {
                self.begun = Some((time_s, self.name(program)));
            }
            return;
        }
        let Some((since_s, name)) = self.begun.take() else { return };
        let end = match execution {
            Execution::ProgramCompleted => {
                let times = self.work.cycle_time.get_or_create(&label("program", &name));
                times.observe(time_s - since_s);
                COMPLETED
            }
            _ => GIVEN_UP,
        };
        self.work.programs.get_or_create(&label("end", end)).inc();
    }

    fn name(&mut self, program: &str) -> String {
        let name: String = program.chars().take(LONGEST_NAME).collect();
        if self.names.contains(&name) || self.names.len() < MOST_PROGRAMS {
            self.names.insert(name.clone());
            return name;
        }
        "other".into()
    }

    /// How it is now, as text in `OpenMetrics`.
    pub(super) fn text(&self, status: &Status, published: Option<&PublishStatus>) -> String {
        self.states.set(status);
        self.motion.set(status);
        if let (Some(servo), Some(figures)) = (&self.servo, &status.real_time) {
            servo.set(figures);
        }
        if let (Some(publishing), Some(status)) = (&self.publishing, published) {
            publishing.set(status);
        }
        if let Some(bytes) = process::resident_bytes() {
            self.memory.set(bytes.cast_signed());
        }
        if let Some(seconds) = process::processor_s() {
            self.processor.inc_by((seconds - self.processor.get()).max(0.0));
        }
        let mut text = String::new();
        match encode(&mut text, &self.registry) {
            Ok(()) => text,
            Err(std::fmt::Error) => String::new(), // a String takes whatever is written
        }
    }
}

fn feature_labels(kind: &str, verdict: &str) -> Labels {
    vec![("kind", kind.to_owned()), ("verdict", verdict.to_owned())]
}

fn label(name: &'static str, value: &str) -> Labels {
    vec![(name, value.to_owned())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use units::Time;

    fn metrics() -> ControlMetrics {
        let mut registry = Registry::default();
        let add = &mut Adding(&mut registry);
        ControlMetrics {
            states: StateMetrics::added(add),
            motion: MotionMetrics::added(add),
            work: WorkMetrics::added(add),
            servo: None,
            publishing: None,
            registry,
            memory: Gauge::default(),
            processor: Counter::default(),
            is_automatic: false,
            begun: None,
            names: BTreeSet::new(),
        }
    }

    fn happens(metrics: &mut ControlMetrics, at_s: f64, event: Event, program: &str) {
        let event = Journaled { id: 1, time: Time::s(at_s), event: Arc::new(event) };
        metrics.count(&event, program);
    }

    fn text(metrics: &ControlMetrics) -> String {
        let mut text = String::new();
        encode(&mut text, &metrics.registry).expect("a String takes it");
        text
    }

    #[test]
    fn a_hold_belongs_to_the_cycle_and_typed_text_is_no_program() {
        let mut metrics = metrics();
        happens(&mut metrics, 1.0, Event::Execution(Execution::Active), "MDI");
        happens(&mut metrics, 2.0, Event::Execution(Execution::ProgramCompleted), "MDI");
        happens(&mut metrics, 3.0, Event::Mode(Mode::Automatic), "a.ngc");
        for (at_s, execution) in [
            (10.0, Execution::Active),
            (12.0, Execution::FeedHold),
            (20.0, Execution::Active),
            (31.0, Execution::ProgramCompleted),
            (40.0, Execution::Active),
            (41.0, Execution::Stopped),
            (42.0, Execution::Ready),
        ] {
            happens(&mut metrics, at_s, Event::Execution(execution), "a.ngc");
        }
        let text = text(&metrics);
        assert!(text.contains("cycle_time_seconds_sum{program=\"a.ngc\"} 21.0\n"), "{text}");
        assert!(text.contains("programs_total{end=\"completed\"} 1\n"), "{text}");
        assert!(text.contains("programs_total{end=\"given_up\"} 1\n"), "{text}");
        assert!(!text.contains("MDI"), "{text}");
    }

    #[test]
    fn many_programs_make_no_endless_list() {
        let mut metrics = metrics();
        metrics.is_automatic = true;
        for number in 0..3 * MOST_PROGRAMS {
            let name = format!("{number}{}", "x".repeat(2 * LONGEST_NAME));
            for execution in [Execution::Active, Execution::ProgramCompleted] {
                happens(&mut metrics, number as f64, Event::Execution(execution), &name);
            }
        }
        let text = text(&metrics);
        assert_eq!(text.matches("cycle_time_seconds_count").count(), MOST_PROGRAMS + 1);
        let others =
            format!("cycle_time_seconds_count{{program=\"other\"}} {}\n", 2 * MOST_PROGRAMS);
        assert!(text.contains(&others), "{text}");
        assert!(text.lines().all(|line| line.len() < 200), "{text}");
    }
}
