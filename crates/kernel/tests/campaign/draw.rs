//! Which cases: at every instant of a tap, and at random.
use super::bench::{Bench, Case};
use super::fate::Tally;
use super::work::{FLUTES_MM, M8, RIGID, Work, unload};
use crate::common::{PERIOD, TapOrder};
use bus::{DriveReaction, Machine as _};
use core::f64::consts::PI;
use sim::Fault;
use std::collections::BTreeMap;
use sync::recovery::Way;
use units::{Angle, Coordinate, Length, Stiffness, Time};

/// Where in its stroke a tap was struck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    In,
    Bottom,
    Out,
}

impl Part {
    pub const fn name(self) -> &'static str {
        match self {
            Self::In => "in",
            Self::Bottom => "at the bottom",
            Self::Out => "out",
        }
    }
}

/// A stop at every so many periods of a tap.
pub fn sweep(
    work: &Work,
    fault: Fault,
    reaction: DriveReaction,
    every: usize,
    way: Way,
) -> BTreeMap<Part, Tally> {
    let (mut bench, mut parts) = (Bench::new(work, reaction, 1), BTreeMap::new());
    bench.go_into_tap();
    while bench.is_tapping() {
        let (time, part) = (bench.machine.feedback().time, bench.part());
        let fate = bench.clone().strike(&Case { fault, way });
        let tally: &mut Tally = parts.entry(part).or_default();
        tally.add(
            &fate,
            &format!("{}, {}, {} at {time}", fault.name(), name(reaction), part.name()),
        );
        for _ in 0..every {
            bench.tick();
        }
    }
    parts
}

/// The same of the whole stroke.
pub fn whole(parts: BTreeMap<Part, Tally>) -> Tally {
    let mut whole = Tally::default();
    for tally in parts.into_values() {
        whole.absorb(tally);
    }
    whole
}

/// Sizes that are drawn: name, diameter, pitch.
const SIZES: [(&str, f64, f64); 9] = [
    ("M3x0.5", 3.0, 0.5),
    ("M4x0.7", 4.0, 0.7),
    ("M5x0.8", 5.0, 0.8),
    ("M6x1", 6.0, 1.0),
    ("M8x1.25", 8.0, 1.25),
    ("M10x1.5", 10.0, 1.5),
    ("M12x1.75", 12.0, 1.75),
    ("M14x2", 14.0, 2.0),
    ("M16x2", 16.0, 2.0),
];

/// Chance with a seed: `SplitMix64` (Steele, Lea, Flood 2014).
pub struct Dice(pub u64);

impl Dice {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }

    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// Size, hand, speed, depth and holder at random.
    pub fn work(&mut self) -> Work {
        let (size, diameter_mm, lead_mm) = self.one_of(&SIZES);
        let depth = (diameter_mm * self.between(0.8, 2.0)).max(4.0 * lead_mm);
        let soft =
            sim::Holder { stiffness: Stiffness::n_per_mm(500.0), travel: Some(Length::mm(0.5)) };
        Work {
            size,
            diameter_mm,
            holder: if self.unit() < 0.7 { RIGID } else { soft },
            order: TapOrder {
                lead_mm,
                rpm: self.between(200.0, (9000.0 / diameter_mm).min(3000.0)).round(),
                to_mm: -102.0 - depth,
                room_mm: FLUTES_MM - depth,
                dwell_s: 0.0,
                left: self.unit() < 0.3,
                cut_n_m: cut_n_m(diameter_mm, lead_mm),
                ..M8.order
            },
        }
    }

    /// One of all that can happen, with its measure at random: either sign, small and large alike.
    pub fn fault(&mut self) -> Fault {
        let sign = if self.unit() < 0.5 { -1.0 } else { 1.0 };
        match (self.unit() * 14.0) as u32 {
            0 => Fault::PowerCut,
            1 => Fault::Kill,
            2 => Fault::EmergencyStop,
            3 => Fault::AxisDrive(2),
            4 => Fault::SpindleDrive(0),
            5 => Fault::LostIndex,
            6 => Fault::Slip(Angle::deg(sign * 0.1 * 3600.0_f64.powf(self.unit()))),
            7 => Fault::Dropout(Time::s(0.25e-3 * 400.0_f64.powf(self.unit()))),
            8 => Fault::Stuck(2),
            9 => {
                Fault::Jump(2, Coordinate::linear(Length::um(sign * 1000.0_f64.powf(self.unit()))))
            }
            10 => Fault::Late,
            11 => Fault::Missed,
            12 => Fault::FeedbackLost(Time::s(0.25e-3 * 400.0_f64.powf(self.unit()))),
            _ => Fault::TorqueLoss(0, self.unit()),
        }
    }
}

/// Torque of a tap in C45, by the tap makers' formula, with a spiral flute and 5 % of scatter: what
/// a planner reckons with.
fn cut_n_m(diameter: f64, pitch: f64) -> f64 {
    let (kc, flute, wall) = (3900.0, 1.15, pitch);
    let bored = diameter - pitch;
    1.05 * (PI / 6.0).tan() * kc * flute * wall * wall * (diameter + 2.0 * bored) / 24_000.0
}

/// What the drives do when they are alone, for people.
pub const fn name(reaction: DriveReaction) -> &'static str {
    match reaction {
        DriveReaction::Off => "outputs off",
        DriveReaction::Coast => "coasting",
        DriveReaction::QuickStop => "quick stop",
        DriveReaction::CoupledStop => "coupled stop",
    }
}

/// Cases at random, `count` from a seed: a row for each fault, and for what the drives do by
/// themselves in it.
pub fn random(count: u32, seed: u64, mut told: impl FnMut(u32)) -> BTreeMap<String, Tally> {
    let mut rows: BTreeMap<String, Tally> = BTreeMap::new();
    for number in 0..count {
        let mut dice = Dice(seed ^ (u64::from(number) << 32));
        let (work, fault) = (dice.work(), dice.fault());
        let reaction = dice.one_of(&[
            DriveReaction::CoupledStop,
            DriveReaction::QuickStop,
            DriveReaction::Coast,
        ]);
        let way = if dice.unit() < 0.5 { Way::Direct } else { unload(&work) };
        let mut bench = Bench::new(&work, reaction, u64::from(number));
        bench.go_into_tap();
        // somewhere between the beginning and the end of it, by its planned time
        let plan = work.order.plan();
        let whole = plan.inward.duration() + plan.outward.duration() + work.order.dwell_s;
        let ticks = (dice.unit() * whole / PERIOD.value()) as usize;
        for _ in 0..ticks {
            bench.tick();
        }
        let what = format!(
            "case {number}: {} {} {} at {} rpm, {fault:?} {reaction:?} at {}, z {:.3}, {way:?}",
            work.size,
            if work.order.left { "left" } else { "right" },
            if work.holder.travel.is_none() { "rigid" } else { "soft" },
            work.order.rpm,
            bench.machine.feedback().time,
            bench.machine.feedback().axes[2].position.value(),
        );
        let row = rows.entry(format!("{}, {}", fault.name(), name(reaction))).or_default();
        row.add(&bench.strike(&Case { fault, way }), &what);
        told(number + 1);
    }
    rows
}
