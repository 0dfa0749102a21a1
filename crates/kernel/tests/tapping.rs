//! Rigid taps on the simulated tapping centre, judged by the machine's truth.
mod common;
use common::*;
use kernel::EventKind;

#[test]
fn an_m6_at_6000_rpm_stays_within_3_um_of_its_helix_and_meets_its_depth() {
    let machine = machine(1);
    let seen = run(&machine, &control(&machine), &tapping(&M6));
    assert_eq!(seen.kernel.faults(), []);
    let errors = seen.sync_errors_um(&M6);
    assert!(errors.len() > 3000, "{} periods in the material", errors.len());
    assert!(largest(&errors) < 3.0, "{} µm", largest(&errors));
    let depth_error_um = (M6.to_mm - seen.deepest_mm()) * 1e3;
    assert!(depth_error_um.abs() < 3.0, "{depth_error_um} µm beyond the bottom");
}

#[test]
fn a_ramp_steeper_than_the_power_curve_saturates_and_the_error_grows_several_times() {
    let machine = machine(1);
    let planned = run(&machine, &control(&machine), &tapping(&M6));
    let order = TapOrder { ramp_s: Some(0.22), ..M6 };
    let forced = run(&machine, &control(&machine), &tapping(&order));
    let (small, large) =
        (largest(&planned.sync_errors_um(&M6)), largest(&forced.sync_errors_um(&order)));
    assert!(large > 5.0 * small && large > 20.0, "{small} µm, forced {large} µm");
    let ended = forced.events.iter().find_map(|e| match e.kind {
        EventKind::TapEnded(figures) => Some(figures),
        _ => None,
    });
    assert!(ended.expect("the tap ended").saturated);
}
