//! Power cuts, kills and stops throughout a tap: a small campaign as a test, the whole of it with
//! `cargo xtask stops`.
use crate::campaign;
use crate::campaign::*;
use crate::common;
use crate::common::TapOrder;
use bus::{DriveReaction, Machine as _};
use sim::Fault;
use sync::recovery::Way;
use units::{Angle, Coordinate, Time};

const LEFT: Work = Work { order: TapOrder { left: true, ..M8.order }, ..M8 };
const REACTIONS: [DriveReaction; 3] =
    [DriveReaction::CoupledStop, DriveReaction::QuickStop, DriveReaction::Coast];

#[test]
fn a_tap_comes_out_along_its_helix_after_a_power_cut_or_a_kill() {
    let mut all = Tally::default();
    for (work, fault) in [(M8, Fault::PowerCut), (LEFT, Fault::Kill)] {
        for reaction in REACTIONS {
            all.absorb(whole(sweep(&work, fault, reaction, 2711, unload(&work))));
        }
    }
    assert!(all.is_good(), "{}", all.remarks());
    assert!(all.cases > 18 && all.recovered > 12, "{}", all.recovered);
}

#[test]
fn drives_and_encoders_that_fail_in_a_tap_leave_it_near_its_helix() {
    // how far off at most, µm: a spindle's drive is followed, an encoder bridged; without the axis'
    // drive the thread alone guides the headstock
    let faults = [
        (Fault::SpindleDrive(0), 20.0),
        (Fault::Slip(Angle::deg(10.0)), 20.0),
        (Fault::Dropout(Time::s(0.02)), 20.0),
        (Fault::Jump(2, Coordinate::new(0.1)), 50.0),
        (Fault::Stuck(2), 300.0),
        (Fault::AxisDrive(2), 400.0),
    ];
    for work in [M8, LEFT] {
        for (fault, most_um) in faults {
            let tally = whole(sweep(&work, fault, DriveReaction::CoupledStop, 3511, unload(&work)));
            assert!(tally.is_good(), "{}", tally.remarks());
            assert!(tally.off_um < most_um, "{fault:?}: {} µm", tally.off_um);
        }
    }
}

#[test]
fn a_tap_of_which_nothing_is_heard_any_more_stands_near_its_helix_and_comes_out() {
    // blind, the plan alone brings both to rest
    for (work, lasts) in [(M8, 0.002), (M8, 0.05), (LEFT, 0.05)] {
        let fault = Fault::FeedbackLost(Time::s(lasts));
        let tally = whole(sweep(&work, fault, DriveReaction::CoupledStop, 997, unload(&work)));
        assert!(tally.is_good(), "{}", tally.remarks());
        assert!(tally.off_um > 0.0 && tally.off_um < 30.0, "{lasts} s: {} µm", tally.off_um);
        assert!(tally.recovered > 5, "{lasts} s: {}", tally.recovered);
    }
    // a frame that is lost in a tap is lived through
    let fault = Fault::FeedbackLost(Time::s(0.0004));
    let tally = whole(sweep(&M8, fault, DriveReaction::CoupledStop, 997, unload(&M8)));
    assert!(tally.cases > 5 && tally.nothing == tally.cases, "{}", tally.remarks());
}

#[test]
fn whatever_fails_in_a_tap_it_comes_out_whole() {
    for (title, tally) in random(30, 0x5eed, |_| {}) {
        assert!(tally.is_good(), "{title}: {}", tally.remarks());
    }
}

#[test]
fn a_stop_with_the_drives_alive_stays_on_the_coupling() {
    let mut bench = Bench::new(&M8, DriveReaction::CoupledStop, 1);
    bench.go_into_tap();
    let mut how = [Stop::Hold, Stop::Abort, Stop::Alarm].into_iter().cycle();
    while bench.is_tapping() {
        let how = how.next().unwrap();
        let time = bench.machine.feedback().time;
        let (off, out) =
            bench.clone().stop(how).unwrap_or_else(|why| panic!("{how:?} at {time}: {why}"));
        assert!(off <= COUPLED_UM && out <= HELIX_UM, "{how:?} at {time}: {off} µm, {out} µm");
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
    let every = asked("STOPS_EVERY_MS", 1) as usize;
    let mut ways = vec![(Fault::PowerCut, DriveReaction::QuickStop, Way::Direct)];
    for fault in [Fault::PowerCut, Fault::Kill] {
        ways.extend(REACTIONS.map(|reaction| (fault, reaction, unload(work))));
    }
    let (mut rows, mut all) = (vec![Tally::head()], Tally::default());
    for (fault, reaction, way) in ways {
        let direct =
            if way == Way::Direct { ", the axis that overran goes back at once" } else { "" };
        let title = format!("{}, {}{direct}", fault.name(), name(reaction));
        for (part, tally) in sweep(work, fault, reaction, 4 * every, way) {
            rows.push(tally.row(&format!("{title}, {}, {hand}", part.name())));
            println!("{}", tally.sum(&format!("{title}, {} ({hand})", part.name())));
            all.absorb(tally);
        }
    }
    rows.push(all.row("all"));
    println!("{}\n{}", rows.join("\n"), all.remarks());
    assert!(all.is_good(), "the table says which");
}

/// A number of the campaign, unless a variable says otherwise.
fn asked(variable: &str, usual: u32) -> u32 {
    std::env::var(variable).ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn two_thousand_cases_at_random() {
    let whole = asked("STOPS_AT_RANDOM", 2000);
    let rows = random(whole, 1, |done| {
        if done % 50 == 0 {
            eprintln!("{done} of {whole} cases at random");
        }
    });
    let mut all = Tally::default();
    let mut said = Tally::head();
    for (title, tally) in rows {
        said += &format!("\n{}", tally.row(&title));
        let fault = title.split(", ").next().unwrap();
        println!("{}", tally.sum(&format!("at random: {fault}")));
        all.absorb(tally);
    }
    println!("{said}\n{}\n{}", all.row("all"), all.remarks());
    assert!(all.is_good(), "the table says which");
}

#[test]
#[ignore = "minutes: cargo xtask stops"]
fn two_thousand_stops_with_the_drives_alive() {
    let (mut worst, mut worst_out, mut cases, mut failed) = (0.0_f64, 0.0_f64, 0_usize, Vec::new());
    let machines = u64::from(asked("STOPS_AT_RANDOM", 2000)) / 4;
    for number in 0..machines {
        let mut dice = Dice(7 ^ (number << 32));
        let work = dice.work();
        let mut bench = Bench::new(&work, DriveReaction::CoupledStop, number);
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
            let at = bench.machine.feedback();
            let (time, z) = (at.time, at.axes[2].position.value());
            let what = format!(
                "case {number}, {} at {} rpm, {how:?} at {time}, z {z:.3}",
                work.size, work.order.rpm
            );
            match bench.clone().stop(how) {
                Ok((off, out)) => {
                    (worst, worst_out) = (worst.max(off), worst_out.max(out));
                    if off > COUPLED_UM || out > HELIX_UM {
                        failed.push(format!("{what}: {off:.1} µm, {out:.1} µm on the way out"));
                    }
                }
                Err(why) => failed.push(format!("{what}: {why}")),
            }
        }
    }
    println!(
        "{cases} stops with the drives alive: in the stop at most {worst:.2} µm off the coupling, on the way out {worst_out:.2} µm"
    );
    let title = "drives alive: hold, abort, alarm at random";
    println!(
        "{}",
        campaign::sum(title, [cases, cases - failed.len(), 0, 0, failed.len()], [worst, worst_out])
    );
    assert!(failed.is_empty(), "{} of them failed:\n{}", failed.len(), failed.join("\n"));
}
