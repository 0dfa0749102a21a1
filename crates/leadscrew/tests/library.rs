//! What a caller of the library relies on.
use leadscrew::{Ending, Program, RunOptions};
use std::path::PathBuf;

const MACHINE: &str = "tapping-center";

fn shipped(name: &str) -> Program {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../programs");
    Program::open(folder.join(name)).unwrap()
}

/// One M6 hole, drilled and tapped, in the middle of the stock.
fn one_hole(feed: u32) -> Program {
    let text = format!(
        "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS3000 M3\nG0 X0 Y0 Z20\nG99 G81 X0 Y0 Z-20 R5 F300\nG80\nT3 M6\nG43 H3\n\
         S1000 M3\nG0 X0 Y0 Z20\nG99 G84 X0 Y0 Z-15 R5 F{feed}\nG80\nG0 Z50\nM2\n"
    );
    Program::of("one hole", text)
}

#[test]
fn a_sound_program_is_checked_timed_and_run_and_comes_out_good() {
    let mut job = one_hole(1000).on(MACHINE).unwrap();
    assert!(job.check().iter().all(|finding| !finding.is_error()), "{:#?}", job.check());
    let planned = job.time().unwrap().total().value();
    let finished = job.run(&RunOptions::default()).unwrap();
    assert_eq!(finished.ending(), Ending::Good);
    assert_eq!(finished.features().len(), 2);
    let took = finished.outcome.cycle_time.value();
    assert!((took / planned - 1.0).abs() < 0.1, "planned {planned} s, took {took} s");
}

#[test]
fn a_feed_that_is_not_lead_times_speed_is_refused_in_a_check_and_in_a_run() {
    let mut job = one_hole(1100).on(MACHINE).unwrap();
    let errors: Vec<_> = job.check().iter().filter(|f| f.is_error()).cloned().collect();
    assert!(!errors.is_empty());
    let Err(refused) = job.run(&RunOptions::default()) else { panic!("it ran") };
    assert!(refused.sentence().contains(&errors[0].message), "{}", refused.sentence());
}

#[test]
fn options_that_change_the_machine_are_planned_anew_after_a_check() {
    let mut job = one_hole(1000).on(MACHINE).unwrap();
    job.check();
    let softer = RunOptions { material: Some("AlSi".into()), ..RunOptions::default() };
    let finished = job.run(&softer).unwrap();
    assert_eq!(finished.certificate().material, "AlSi");
    let harder = one_hole(1000).on(MACHINE).unwrap().run(&RunOptions::default()).unwrap();
    let torque = |f: &leadscrew::Finished| f.features()[1].contact.torque.unwrap().value();
    assert!(torque(&finished) < 0.6 * torque(&harder), "1300 N/mm² against 3900");
}

#[test]
fn the_same_seed_gives_the_same_certificate_and_another_one_another_work() {
    let certificate = |seed| {
        let options = RunOptions { seed: Some(seed), ..RunOptions::default() };
        let finished = one_hole(1000).on(MACHINE).unwrap().run(&options).unwrap();
        finished.certificate().to_json()
    };
    assert_eq!(certificate(7), certificate(7));
    assert_ne!(certificate(7), certificate(8));
}

#[test]
fn the_report_of_a_shipped_program_is_one_page_with_its_name() {
    let mut finished =
        shipped("plate-12xM6.ngc").on(MACHINE).unwrap().run(&RunOptions::default()).unwrap();
    let page = finished.report();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
    assert!(page.contains("plate-12xM6.ngc"));
}

#[test]
fn an_unknown_machine_is_refused_with_those_that_there_are() {
    let Err(refused) = one_hole(1000).on("no-such-machine") else { panic!("it is known") };
    assert!(refused.sentence().contains("tapping-center"), "{}", refused.sentence());
}
