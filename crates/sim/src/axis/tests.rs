//! An axis against closed forms: drive, screw, friction, limit.
use super::*;
use crate::fixtures::z_axis;
use crate::oracle::{free_mode, ramp_up};
use bus::AxisCommand;

const H: f64 = 25e-6;

fn axis(model: &AxisModel) -> Axis {
    Axis::new(model, model, (H, 10.0 * H), false)
}

fn on(force: f64) -> AxisCommand {
    AxisCommand { enable: true, force: Force::n(force), ..Default::default() }
}

fn without_friction(mut model: AxisModel) -> AxisModel {
    model.friction.coulomb = Force::n(1e-9);
    model.friction.breakaway = Force::n(1e-9);
    model.friction.viscous_n_s_per_m = 0.0;
    model.friction.bristle_damping_n_s_per_m = 0.0;
    model
}

#[test]
fn the_z_axis_rings_at_its_natural_frequency_of_124_hz() {
    let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
    let mode = free_mode(&model);
    let mut axis = axis(&model);
    axis.obey(&on(0.0));
    axis.table.x += 10e-6;
    // zero crossings of the stretch, each found by interpolation, over one second less decay
    let (mut crossings, mut last) = (Vec::new(), axis.motor.x - axis.table.x);
    for i in 1..2_000 {
        axis.step();
        let now = axis.motor.x - axis.table.x;
        if last * now < 0.0 {
            crossings.push(H * (f64::from(i) - now / (now - last)));
        }
        last = now;
    }
    let half_periods = (crossings.len() - 1) as f64;
    let hz = half_periods / 2.0 / (crossings[crossings.len() - 1] - crossings[0]);
    assert!((mode.natural_hz - 124.0).abs() < 0.5, "{} Hz", mode.natural_hz);
    assert!((hz - mode.damped_hz).abs() < 1e-3 * mode.damped_hz, "{hz} Hz, {mode:?}");
}

#[test]
fn the_ringing_decays_at_its_damping_ratio() {
    let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
    let mode = free_mode(&model);
    let mut axis = axis(&model);
    axis.obey(&on(0.0));
    axis.table.x += 10e-6;
    let (mut peaks, mut last, mut rising) = (Vec::new(), 0.0, false);
    for _ in 0..4_000 {
        axis.step();
        let now = axis.motor.x - axis.table.x;
        if rising && now < last {
            peaks.push(last);
        }
        rising = now > last;
        last = now;
    }
    let decrement = (peaks[0] / peaks[3]).ln() / 3.0;
    let ratio = decrement / f64::hypot(decrement, TAU);
    assert!((ratio - mode.damping_ratio).abs() < 0.005 * mode.damping_ratio + 2e-4, "{ratio}");
}

#[test]
fn constant_force_gives_the_parabola_of_the_whole_mass() {
    let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
    let mut axis = axis(&model);
    axis.obey(&on(10_000.0));
    for _ in 0..4000 {
        axis.step();
    }
    let (mm, mt) = (model.motor_mass().value(), model.table.value());
    let centre = (mm * axis.motor.x + mt * axis.table.x) / (mm + mt);
    let exact = ramp_up(10_000.0 / (mm + mt), 0.1);
    assert!((centre - exact).abs() < 1e-9 * exact, "{centre} m, exact {exact} m");
}

#[test]
fn a_hard_stop_holds_an_axis_that_is_driven_into_it_with_all_its_force() {
    let mut model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
    let stop = Stiffness::n_per_mm(80_000.0);
    model.travel.stops = Some((Coordinate::new(-400.0), Coordinate::new(10.0), stop));
    let mut axis = axis(&model);
    let force = model.peak_force().value();
    let (mut fastest, mut farthest) = (0.0_f64, 0.0_f64);
    for _ in 0..40_000 {
        axis.obey(&on(force));
        axis.step();
        fastest = fastest.max(axis.motor.v);
        farthest = farthest.max(axis.table_mm());
    }
    // undamped, the whole mass m at speed v and under force F goes F/k + √((F/k)² + m·v²/k) deep
    // into a spring k; the screw is another spring behind it, so that half the mass's way is its
    // own
    let (mass, k) = (model.table.value() + model.motor_mass().value(), 8e7);
    let static_mm = force / k * 1e3;
    let deepest = static_mm + (force / k).hypot(fastest * (mass / k).sqrt()) * 1e3;
    assert!(farthest - 10.0 < deepest, "{farthest} mm, stop at 10, {deepest} mm at most");
    let rests = axis.table_mm() - 10.0;
    assert!((rests - static_mm).abs() < 0.01 * static_mm, "{rests} mm, exact {static_mm} mm");
}

#[test]
fn on_reversal_the_table_stays_behind_by_the_play() {
    let model = AxisModel { backlash: Coordinate::new(3e-3), ..z_axis() };
    let mut axis = axis(&model);
    axis.obey(&on(0.0));
    // the motor is led by hand, slowly; the table follows with friction only
    let lead_to = |axis: &mut Axis, target: f64| {
        while (axis.motor.x - target).abs() > 1e-9 {
            axis.motor.v = 0.5e-3 * (target - axis.motor.x).signum();
            axis.motor_rate = 0.0;
            axis.step();
        }
        for _ in 0..20_000 {
            axis.motor.v = 0.0;
            axis.step();
        }
        axis.motor.x - axis.table.x
    };
    let forth = lead_to(&mut axis, 100e-6);
    let back = lead_to(&mut axis, 0.0);
    // the play, plus twice the screw's stretch under friction that stays in the bristles at rest
    let stretch = 2.0 * 190.0 / 80e6;
    let lost = forth - back;
    assert!(lost > 3e-6 && lost < 3e-6 + stretch, "{lost} m");
}

#[test]
fn the_table_breaks_away_at_the_breakaway_force() {
    let model = z_axis();
    let mut axis = axis(&model);
    axis.obey(&on(0.0));
    axis.motor_rate = 0.0; // the screw held fast is out of the way: push the table freely
    axis.stiffness = 0.0;
    axis.damping = 0.0;
    let mut push = 0.0;
    while axis.table.v < 1e-3 {
        push += 50.0 * H; // 50 N/s
        axis.push(push);
        axis.step();
        assert!(push < 1000.0, "never broke away");
    }
    let exact = model.friction.breakaway.value();
    assert!((push - exact).abs() < 0.03 * exact, "{push} N, exact {exact} N");
}

#[test]
fn a_bare_vertical_axis_without_its_drive_falls_and_a_brake_holds_it() {
    let bare = AxisModel { weight_share: 1.0, brake: false, ..z_axis() };
    let mut falling = axis(&bare);
    let mut held = axis(&AxisModel { brake: true, ..bare });
    for _ in 0..8000 {
        falling.step();
        held.step();
    }
    assert!(falling.table.x < -5e-3, "{}", falling.table.x);
    assert!(held.table.x.abs() < 1e-9, "{}", held.table.x); // the screw carries it from the start
}

#[test]
fn a_brake_does_not_clamp_an_axis_that_turns_about_and_catches_one_that_falls() {
    let model = AxisModel { weight_share: 1.0, brake: true, ..z_axis() };
    let mut up = axis(&model);
    up.obey(&AxisCommand { enable: true, ..AxisCommand::default() });
    (up.motor.v, up.table.v) = (0.02, 0.02);
    up.obey(&AxisCommand::default());
    let (mut highest, mut caught) = (0.0_f64, None);
    for i in 0..20_000 {
        up.step();
        highest = highest.max(up.table_mm());
        caught = caught.or(up.clamped.then_some((i, up.table_mm())));
    }
    let (when, place) = caught.expect("it falls, and is caught");
    assert!(f64::from(when) * H > 0.02, "not while it rises: {when}");
    // 20 mm/s downwards at 1.1 m/s² of weight less friction on all that moves: about 0.2 mm below
    // its highest
    assert!((0.05..0.5).contains(&(highest - place)), "{highest} mm, caught at {place} mm");
}

#[test]
fn work_in_is_energy_stored_and_heat() {
    let model = z_axis();
    let mut axis = axis(&model);
    let h = H;
    let (mm, mt) = (model.motor_mass().value(), model.table.value());
    let (mut work, mut damped, mut rubbed) = (0.0, 0.0, 0.0);
    for i in 0..8000 {
        axis.obey(&on(8000.0 * (f64::from(i) * h * 60.0).sin()));
        let (before, bent) = (axis.clone(), axis.bristles);
        axis.step();
        let vm = f64::midpoint(before.motor.v, axis.motor.v);
        let vt = f64::midpoint(before.table.v, axis.table.v);
        work += axis.reference * vm * h;
        damped += axis.damping * (before.motor.v - before.table.v) * (vm - vt) * h;
        let mut z = bent;
        rubbed += before.guideway.step(&mut z, before.table.v) * vt * h;
    }
    let stretch = axis.motor.x - axis.table.x;
    let beyond = stretch - stretch.clamp(-axis.half_play, axis.half_play);
    let kinetic = 0.5 * (mm * axis.motor.v.powi(2) + mt * axis.table.v.powi(2));
    let stored = kinetic + axis.stiffness * beyond.powi(2) / 2.0;
    let balance = work - damped - rubbed - stored;
    assert!(rubbed > 1.0 && damped > 0.0, "{rubbed} J, {damped} J");
    assert!(balance.abs() < 1e-3 * (work.abs() + stored), "{balance} J of {work} J, {stored} J");
}

#[test]
fn the_drive_gives_no_more_than_its_peak() {
    let mut axis = axis(&z_axis());
    axis.obey(&on(1e9));
    axis.step();
    let peak = 60.0 * TAU / 0.016;
    assert!((axis.drive_force().value() - peak).abs() < 1e-6, "{}", axis.drive_force());
    axis.obey(&on(f64::NAN));
    axis.step();
    assert_eq!(axis.drive_force(), Force::ZERO);
}
