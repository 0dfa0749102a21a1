//! What the seeds make of a machine, against what its file allows.
use super::*;
use store::machine::{EMBEDDED, find};

/// Largest of what seeds 1 to 40 make of a machine, each as a share of what its file allows.
#[derive(Debug, Default)]
struct Farthest {
    most: Vec<(String, f64)>,
}

impl Farthest {
    fn note(&mut self, what: String, found: f64, allowed: f64) {
        assert!(found.abs() <= allowed * (1.0 + 1e-9), "{what}: {found} of {allowed}");
        if allowed == 0.0 {
            return;
        }
        let share = found.abs() / allowed;
        match self.most.iter_mut().find(|(name, _)| *name == what) {
            Some((_, most)) => *most = most.max(share),
            None => self.most.push((what, share)),
        }
    }

    fn look(&mut self, name: &str, believed: &sim::Config) {
        let (axes, spindles) = believed.plant();
        for ((index, file), (_, real)) in believed.axes.iter().zip(&axes) {
            let letter = canon::Axis::ALL[*index].letter();
            let mut note = |what, found, allowed| {
                self.note(format!("{name} {letter} {what}"), found, allowed);
            };
            let off = |real: f64, file: f64| if file == 0.0 { 0.0 } else { real / file - 1.0 };
            let (scatter, errors) = (file.scatter, real.errors);
            if file.backlash > Coordinate::ZERO {
                let play = off(real.backlash.value(), file.backlash.value());
                note("play", play, scatter.backlash.most());
            }
            let stiffness = off(real.stiffness.value(), file.stiffness.value());
            note("stiffness", stiffness, scatter.stiffness.most());
            let friction = off(real.friction.coulomb.value(), file.friction.coulomb.value());
            note("friction", friction, scatter.friction.most());
            note("lead", errors.lead.unwrap_or(0.0), scatter.lead_error.most());
            let (wobble, _) = errors.wobble.unwrap_or_default();
            note("wobble", wobble.value(), scatter.wobble.most());
            let (disk, _) = errors.eccentricity.unwrap_or_default();
            note("encoder", disk.value(), scatter.eccentricity.most());
            note("scale", errors.scale.unwrap_or(0.0), scatter.scale_error.most());
        }
        for (index, (file, real)) in believed.spindles.iter().zip(&spindles).enumerate() {
            let mut note = |what, found, allowed| {
                self.note(format!("{name} S{index} {what}"), found, allowed);
            };
            let friction = real.coulomb.value() / file.coulomb.value() - 1.0;
            note("friction", friction, file.scatter.friction.most());
            let disk = real.encoder.eccentricity.value();
            note("encoder", disk, file.scatter.eccentricity.most());
        }
    }
}

fn believed(name: &str, seed: u64) -> sim::Config {
    let file = find(name).expect("an embedded machine");
    let zero = file.setup.g54;
    simulator(&file, &ToolLibrary::default(), file.setup.stock.material, seed, &zero)
}

#[test]
fn no_embedded_machine_is_what_its_control_believes() {
    for name in EMBEDDED {
        let mut spread = Farthest::default();
        for seed in 1..=40 {
            spread.look(name, &believed(name, seed));
        }
        let kinds = ["play", "stiffness", "friction", "encoder"];
        for kind in kinds {
            assert!(spread.most.iter().any(|(what, _)| what.ends_with(kind)), "{name}: {kind}");
        }
        for (what, share) in &spread.most {
            assert!(*share > 0.8, "{what}: 40 seeds come to {share:.2} of what may be at most");
        }
    }
}

#[test]
fn a_screw_has_an_error_of_its_lead_and_a_linear_motor_one_of_its_scale() {
    let config = believed("cam-grinder", 1);
    let of = |axis: usize| {
        config.axes.iter().find(|(index, _)| *index == axis).expect("it is there").1.scatter
    };
    assert!(of(0).lead_error.by == 0.0 && of(0).wobble.by == 0.0 && of(0).scale_error.by > 0.0);
    assert!(of(2).lead_error.by > 0.0 && of(2).wobble.by > 0.0);
}

#[test]
fn a_stated_error_is_in_the_plant_and_not_in_what_the_control_is_told() {
    let text = "extends = \"tapping-center\"\nname = \"off\"\n[axes.x.errors]\nscale_error_ppm = 50\n\
                encoder_eccentricity_um = 5\n[[spindles]]\n[spindles.errors]\nencoder_eccentricity_um = 8\n";
    let file = store::machine::parse(text, 0).expect("it is in order");
    let zero = file.setup.g54;
    let material = file.setup.stock.material;
    let config = simulator(&file, &ToolLibrary::default(), material, 9, &zero);
    let (axes, spindles) = config.plant();
    let lead = axes[0].1.errors.lead.expect("it is stated");
    assert!((lead - 50e-6).abs() < 1e-12, "{lead}");
    let (disk, _) = axes[0].1.errors.eccentricity.expect("it is stated");
    // 5 µm of a graduation of 40 mm: 2·5/40,000 rad, on a screw of 16 mm 0.64 µm
    assert!((disk.value() * 16_000.0 - 4.0 / std::f64::consts::TAU).abs() < 1e-9, "{disk}");
    assert!((spindles[0].encoder.eccentricity.in_deg() * 3600.0 - 55.0).abs() < 0.1);
    let told = super::super::control(&file, None, false);
    let usual = super::super::control(&find("tapping-center").expect("it is there"), None, false);
    assert_eq!(format!("{:?}", told.axes), format!("{:?}", usual.axes));
}
