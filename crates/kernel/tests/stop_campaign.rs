//! Power cuts, kills and stops throughout a tap: a small campaign as a test, the whole of it with `cargo xtask stops`.
#[allow(unreachable_pub)] // as in every module that tests share
mod campaign;
mod common;
use bus::Machine as _;
use campaign::*;
use common::TapOrder;
use sim::{Fault, Reaction};
use sync::recovery::Way;

const LEFT: Work = Work { order: TapOrder { left: true, ..M8.order }, ..M8 };
const ALL: [Fault; 3] = [Fault::PowerCut, Fault::Kill, Fault::EmergencyStop];
const REACTIONS: [(Reaction, &str); 3] = [
    (Reaction::CoupledStop, "coupled stop"),
    (Reaction::QuickStop, "quick stop"),
    (Reaction::Coast, "coasting"),
];

#[test]
fn a_tap_comes_out_along_its_helix_after_a_power_cut_or_a_kill() {
    let mut all = Tally::default();
    for (work, fault) in [(M8, Fault::PowerCut), (LEFT, Fault::Kill)] {
        for (reaction, name) in REACTIONS {
            let tally = sweep(&work, fault, reaction, 2711, unload(&work));
            println!("{}", tally.row(name));
            tally.check();
            all.cases += tally.cases;
        }
    }
    assert!(all.cases > 18, "{}", all.cases);
}

#[test]
fn a_stop_with_the_drives_alive_stays_on_the_coupling() {
    let mut bench = Bench::new(&M8, Reaction::CoupledStop, 1);
    bench.go_into_tap();
    let mut how = [Stop::Hold, Stop::Abort, Stop::Alarm].into_iter().cycle();
    while bench.is_tapping() {
        let how = how.next().unwrap();
        let time = bench.machine.feedback().time;
        let off = bench.clone().stop(how).unwrap_or_else(|why| panic!("{how:?} at {time}: {why}"));
        assert!(off <= COUPLED_UM, "{how:?} at {time}: {off} µm");
        for _ in 0..997 {
            bench.tick();
        }
    }
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn every_millisecond_right_hand() {
    every_millisecond(&M8, "right hand");
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn every_millisecond_left_hand() {
    every_millisecond(&LEFT, "left hand");
}

fn every_millisecond(work: &Work, hand: &str) {
    println!("{}", Tally::head());
    for fault in [Fault::PowerCut, Fault::Kill] {
        for (reaction, name) in REACTIONS {
            // every millisecond on the machine as it is; every 10 ms on lesser drives
            let every = if reaction == Reaction::CoupledStop { 1 } else { 10 };
            let tally = sweep(work, fault, reaction, 4 * every, unload(work));
            println!("{}", tally.row(&format!("{} each {every} ms, {hand}, {name}", fault.name())));
            tally.check();
        }
    }
    let tally = sweep(work, Fault::PowerCut, Reaction::QuickStop, 40, Way::Direct);
    println!("{}", tally.row(&format!("power-cut each 10 ms, {hand}, the document's way")));
}

/// As many as is usual, unless `STOPS` says otherwise.
fn count(usual: u32) -> u32 {
    std::env::var("STOPS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn two_thousand_cases_at_random() {
    println!("{}", Tally::head());
    let mut good = true;
    for (seed, (reaction, name)) in REACTIONS.into_iter().enumerate() {
        let tally = random(count(667), 1 + seed as u64, reaction, &ALL);
        println!("{}", tally.row(&format!("random, {name}")));
        if let Some(why) = &tally.first_failure {
            println!("  first failure: {why}");
        }
        good &= tally.recovered == tally.cases;
    }
    assert!(good, "the table says which");
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn two_thousand_stops_with_the_drives_alive() {
    let (mut worst, mut cases, mut failed) = (0.0_f64, 0, Vec::new());
    for number in 0..500_u64 {
        let mut dice = Dice(7 ^ (number << 32));
        let work = dice.work();
        let mut bench = Bench::new(&work, Reaction::CoupledStop, number);
        bench.go_into_tap();
        let plan = work.order.plan();
        let whole = plan.inward.duration() + plan.outward.duration();
        for _ in 0..4 {
            for _ in 0..(dice.unit() * whole / 4.0 / common::PERIOD.value()) as usize {
                bench.tick();
            }
            if !bench.is_tapping() {
                break;
            }
            let how = dice.one_of(&[Stop::Hold, Stop::Abort, Stop::Alarm]);
            cases += 1;
            match bench.clone().stop(how) {
                Ok(off) => worst = worst.max(off),
                Err(why) => failed.push(format!("case {number}, {} {how:?}: {why}", work.size)),
            }
        }
    }
    println!(
        "{cases} stops with the drives alive: at most {worst:.2} µm off the coupling, {} failed {failed:?}",
        failed.len()
    );
}
