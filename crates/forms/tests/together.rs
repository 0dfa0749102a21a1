//! Slides and the tool's phase that swing together: the optimum of all of them at once.
use crate::fine;
use forms::polygon::{
    Actuator, Detail, Drive, Effort, Form, Limits, Problem, Solution, insert_phases,
};
use units::{Length, Spin};

fn form(inserts: u32, turns: [i32; 2]) -> Form {
    Form {
        inserts: insert_phases(inserts),
        turns,
        across_flats: Length::mm(17.0),
        tip_radius: Length::mm(50.0),
        stock_radius: Length::mm(25.0),
    }
}

/// A slide with its acceleration and jerk, mm and s.
fn slide(actuator: Actuator, acceleration: f64, jerk: f64) -> Drive {
    let limits = Limits { travel: 40.0, speed: 200.0, acceleration, jerk, effort: None };
    Drive { actuator, limits, response: Vec::new() }
}

fn x() -> Drive {
    slide(Actuator::CentreLine, 7200.0, 450e3)
}

/// A tool spindle of 0.003 kg·m² and 17 N·m whose torque rises within 6 ms, rev and s.
fn phase() -> Drive {
    let inertia = 0.003 * core::f64::consts::TAU;
    let effort = Effort { per_acceleration: inertia, per_speed: 0.003, constant: 0.2, most: 17.0 };
    let limits = Limits {
        travel: 0.25,
        speed: 80.0,
        acceleration: f64::INFINITY,
        jerk: 20.0 / 0.006 / inertia,
        effort: Some(effort),
    };
    Drive { actuator: Actuator::ToolPhase, limits, response: Vec::new() }
}

fn solve(form: &Form, rpm: f64, drives: Vec<Drive>) -> Solution {
    Problem { form, spin: Spin::rpm(rpm), drives, harmonics: 4 }.solve_well(Detail::Full).unwrap()
}

#[test]
fn what_swings_far_comes_out_as_the_linear_problem_promises() {
    // a triangle at 1:3: the phase swings by more than 20°, where sines are no straight lines
    let triangle = form(1, [3, 1]);
    for rpm in [10.0, 100.0, 300.0] {
        let y = slide(Actuator::Across, 3600.0, 270e3);
        let alone = solve(&triangle, rpm, vec![phase()]).flatness.in_um();
        let two = solve(&triangle, rpm, vec![x(), phase()]).flatness.in_um();
        let three = solve(&triangle, rpm, vec![x(), y, phase()]).flatness.in_um();
        println!("{rpm} rpm: phase {alone:.3} µm, with X {two:.3} µm, with X and Y {three:.3} µm");
        assert!(two <= alone * 1.02 + 0.2 && three <= two * 1.02 + 0.2, "{alone} {two} {three}");
    }
}

/// Everything at a limit: within 2 % of the fine optimum, not better than it, and no peak beyond
/// its limit.
#[track_caller]
fn near_the_fine_optimum(rpm: f64, drives: &[Drive]) -> f64 {
    let hexagon = form(3, [2, 1]);
    let fine = fine::optimum_um(&hexagon, rpm, drives);
    let found = solve(&hexagon, rpm, drives.to_vec());
    let flat = found.flatness.in_um();
    println!("{rpm} rpm: {flat:.4} µm, fine optimum {fine:.4} µm, {:?}", found.binding);
    assert!(found.binding.is_some(), "nothing binds");
    assert!(flat < 1.02 * fine && flat > 0.995 * fine, "{flat} {fine}");
    for (drive, [travel, speed, acceleration, jerk, effort]) in drives.iter().zip(&found.peaks) {
        let l = &drive.limits;
        assert!(*travel <= l.travel && *speed <= l.speed, "{:?}", found.peaks);
        assert!(*acceleration <= l.acceleration && *jerk <= l.jerk, "{:?}", found.peaks);
        assert!(l.effort.is_none_or(|e| *effort <= e.most), "{:?}", found.peaks);
    }
    flat
}

#[test]
fn the_phase_alone_is_within_two_percent_of_a_fine_optimum() {
    near_the_fine_optimum(900.0, &[phase()]);
}

#[test]
fn x_and_the_phase_together_are_within_two_percent_of_a_fine_optimum_and_flatter_than_the_phase() {
    for rpm in [800.0, 1000.0] {
        let alone = near_the_fine_optimum(rpm, &[phase()]);
        let both = near_the_fine_optimum(rpm, &[x(), phase()]);
        assert!(both < alone - 0.05, "{both} {alone}");
    }
}

#[test]
fn all_three_are_within_two_percent_of_a_fine_optimum() {
    let y = slide(Actuator::Across, 3600.0, 270e3);
    near_the_fine_optimum(900.0, &[x(), y, phase()]);
}
