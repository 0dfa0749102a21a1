//! A plant that is not what its control was told: what play, stretch and errors of encoders cost
//! then, by closed forms.
use crate::common;
use crate::common::{control, line, machine, run};
use canon::Position;
use units::{Angle, Coordinate, Length};

/// Where X really is against its setpoint while it goes 6 mm forth and back at 20 mm/s: mean over
/// the middle of either way, µm.
fn forth_and_back(machine: &sim::Config, control: &kernel::Config) -> [f64; 2] {
    let (near, far) = (Position::xyz(1.0, 0.0, 0.0), Position::xyz(7.0, 0.0, 0.0));
    let origin = Position::default();
    let steps =
        [line(origin, near, 20.0, true), line(near, far, 20.0, true), line(far, near, 20.0, true)];
    let seen = run(machine, control, &steps);
    assert_eq!(seen.kernel.faults(), []);
    let mean = |op: u32| {
        let within = seen.samples.windows(2).filter(|w| {
            let at = w[0].command.axes[0].position.value();
            w[0].report.op == op && (3.0..5.0).contains(&at)
        });
        let errors: Vec<f64> = within
            .map(|w| {
                (w[1].truth.unwrap().axes[0] - w[1].command.axes[0].position).of_linear().in_um()
            })
            .collect();
        assert!(errors.len() > 100, "op {op}: {}", errors.len());
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    [mean(1), mean(2)]
}

/// The machine whose X has this play, and a control that believes in another one.
fn with_play(real_um: f64, believed_um: f64) -> (sim::Config, kernel::Config) {
    let mut machine = machine(1);
    machine.axes[0].1.backlash = Coordinate::linear(Length::um(believed_um));
    let told = control(&machine);
    machine.axes[0].1.backlash = Coordinate::linear(Length::um(real_um));
    (machine, told)
}

#[test]
fn play_costs_what_it_is_off_from_what_the_control_compensates() {
    let lost = |real, believed| {
        let (machine, told) = with_play(real, believed);
        let [forth, back] = forth_and_back(&machine, &told);
        // forth the table stays behind, back it stays ahead: the difference is what is lost at a
        // reversal
        back - forth
    };
    let compensated = lost(30.0, 30.0);
    assert!(compensated.abs() < 1.0, "{compensated} µm");
    for (real, believed) in [(36.0, 30.0), (24.0, 30.0), (30.0, 25.0), (30.0, 0.0)] {
        let found = lost(real, believed) - compensated;
        let exact = real - believed;
        assert!((found - exact).abs() < 0.5, "{real} for {believed}: {found} µm, exactly {exact}");
    }
}

#[test]
fn over_seeds_thirty_micrometres_of_play_cost_up_to_six() {
    let (exact, told) = with_play(30.0, 30.0);
    let [forth, back] = forth_and_back(&exact, &told);
    let (compensated, mut most) = (back - forth, 0.0_f64);
    for seed in 1..=6 {
        let (mut machine, told) = with_play(30.0, 30.0);
        machine.seed = seed;
        machine.axes[0].1.scatter.backlash = units::Spread::uniform(0.2);
        let real = machine.plant().0[0].1.backlash.of_linear().in_um();
        let [forth, back] = forth_and_back(&machine, &told);
        let lost = back - forth - compensated;
        assert!((lost - (real - 30.0)).abs() < 0.5, "seed {seed}: {lost} µm, play {real} µm");
        most = most.max(lost.abs());
    }
    assert!(most > 2.0, "{most} µm: six seeds and none that costs anything");
}

#[test]
fn a_scale_that_is_off_makes_the_part_so_much_larger_and_the_control_does_not_see_it() {
    let mut machine = machine(1);
    machine.axes[0].1.encoder = common::scale(Coordinate::linear(Length::um(0.05)));
    let told = control(&machine);
    let exact = forth_and_back(&machine, &told);
    machine.axes[0].1.errors.scale = Some(500e-6);
    let off = forth_and_back(&machine, &told);
    for (exact, off) in exact.into_iter().zip(off) {
        // at 4 mm from the zero of the error: 500 ppm are 2 µm
        assert!((off - exact - 2.0).abs() < 0.1, "{exact} µm, {off} µm");
    }
}

#[test]
fn an_eccentric_encoder_moves_the_table_once_per_revolution_of_its_screw() {
    let mut machine = machine(1);
    let told = control(&machine);
    let exact = forth_and_back(&machine, &told);
    // a reading that is too large by e·sin(2πx/16 mm): at 4 mm, a quarter of a revolution, the
    // table is short by e
    let amplitude = Angle::rev(5e-3 / 16.0);
    machine.axes[0].1.errors.eccentricity = Some((amplitude, Angle::ZERO));
    let off = forth_and_back(&machine, &told);
    for (exact, off) in exact.into_iter().zip(off) {
        // mean of the sine from 3 to 5 mm
        assert!((off - exact + 5.0 * 0.975).abs() < 0.2, "{exact} µm, {off} µm");
    }
}
