//! How far a tap goes on when its spindle is left to coast: the control has died, or the mains have
//! failed.
//!
//! ```text
//!   ω │────────╮ lost here, where braking would have begun
//!     │        │╲ ─ ─ ─ ─ ─ ─ ─ ─ ─ ╮   left alone: friction and cut alone brake, θc
//!     │        │ ╲ planned: θb       ╲
//!     └────────┴──┴───────────────────┴──► θ           overrun H·(θc − θb), deeper than programmed
//! ```
//!
//! J·ω·dω/dθ = −(c₀ + c₁·ω), from ω to rest, is θc = J/c₁·(ω − c₀/c₁·ln(1 + c₁·ω/c₀)); the planned
//! stroke brakes within θb = J·ω²/(2·M), M the share of the peak torque that strokes are planned
//! with. θc − θb grows with ω, so the worst moment of a stroke is the one at which its braking
//! begins.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | J, M | inertia of the spindle, torque that brakes a planned stroke | kg·m², N·m |
//! | c₀, c₁ | friction of the spindle at 80 % of what its file has, and 70 % of the torque of the cut | N·m, N·m·s/rad |
//! | H | lead | mm |
//!
//! A spindle turns more easily than its file has it by up to a fifth, and a cut takes less than the
//! formula by up to 30 %.
use crate::limits::SpindleLimits;
use core::f64::consts::TAU;
use units::{Angle, Lead, Length, Spin, Torque};

/// Shares of the file's friction and of the formula's cutting torque that certainly brake.
const FRICTION: f64 = 0.8;
const CUT: f64 = 0.7;

/// Revolutions that a spindle coasts from a speed while it taps.
pub fn coasts(spindle: &SpindleLimits, cut: Torque, from: Spin) -> Angle {
    let (j, omega) = (spindle.inertia.value(), from.in_rad_per_s().abs());
    let c0 = (FRICTION * spindle.friction.value() + CUT * cut.value()).max(1e-9);
    let c1 = FRICTION * spindle.viscous_n_m_s_per_rad;
    let x = c1 * omega / c0;
    // ln(1 + x) as its series where the difference would be lost
    let rad = if x < 1e-4 {
        j * omega * omega / (2.0 * c0) * (1.0 - 2.0 * x / 3.0)
    } else {
        j / c1 * (omega - c0 / c1 * libm::log1p(x))
    };
    Angle::rev(rad / TAU)
}

/// How much deeper than programmed a tap goes at most whose spindle is left to coast.
pub fn overrun(spindle: &SpindleLimits, cut: Torque, lead: Lead, spin: Spin) -> Length {
    let omega = spin.in_rad_per_s();
    let brakes = spindle.inertia.value() * omega * omega
        / (2.0 * spindle.margin * spindle.peak_torque.value())
        / TAU;
    let beyond = coasts(spindle, cut, spin).value() - brakes;
    Length::mm(lead.value().abs() * beyond.max(0.0))
}

/// The highest speed up to this one, in tens of rpm, at which a tap goes no deeper than by this.
pub fn survives(
    spindle: &SpindleLimits,
    cut: Torque,
    lead: Lead,
    room: Length,
    most: Spin,
) -> Spin {
    let stays = |tens: u32| overrun(spindle, cut, lead, Spin::rpm(f64::from(tens) * 10.0)) <= room;
    let (mut works, mut fails) = (0, libm::floor(most.in_rpm() / 10.0) as u32 + 1);
    while fails - works > 1 {
        let middle = u32::midpoint(works, fails);
        if stays(middle) { works = middle } else { fails = middle }
    }
    Spin::rpm(f64::from(works) * 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::{Inertia, Power, Time};

    /// The spindle of `tapping-center`.
    const SPINDLE: SpindleLimits = SpindleLimits {
        inertia: Inertia::kg_m2(0.010),
        peak_torque: Torque::n_m(42.0),
        continuous_torque: Torque::n_m(20.0),
        thermal_time: Time::s(60.0),
        peak_power: Power::w(15_000.0),
        friction: Torque::n_m(0.3),
        viscous_n_m_s_per_rad: 0.0012,
        max_speed: Spin::rpm(10_000.0),
        tapping_max: Spin::rpm(6000.0),
        margin: 0.85,
        torque_rise: Time::s(0.006),
    };
    const M6: Torque = Torque::n_m(1.73);

    #[test]
    fn a_spindle_coasts_as_its_equation_of_motion_integrates() {
        for (rpm, cut, viscous) in
            [(3000.0, 1.73, 0.0012), (6000.0, 0.0, 0.0012), (800.0, 4.0, 0.0), (1.0, 1.73, 0.0012)]
        {
            let spindle = SpindleLimits { viscous_n_m_s_per_rad: viscous, ..SPINDLE };
            let (c0, c1) = (0.8 * 0.3 + 0.7 * cut, 0.8 * viscous);
            let (mut omega, mut theta, start) = (rpm * TAU / 60.0, 0.0, rpm * TAU / 60.0);
            let steps = 100_000;
            for _ in 0..steps {
                // dθ = J·ω·dω/(c₀ + c₁·ω), by the middle of each step of ω
                let middle: f64 = omega - start / f64::from(steps) / 2.0;
                theta += 0.010 * middle / (c0 + c1 * middle) * start / f64::from(steps);
                omega -= start / f64::from(steps);
            }
            let found = coasts(&spindle, Torque::n_m(cut), Spin::rpm(rpm)).value() * TAU;
            assert!((found / theta - 1.0).abs() < 1e-4, "{rpm} rpm: {found}, {theta} rad");
        }
    }

    #[test]
    fn an_m6_tap_at_3000_rpm_goes_45_mm_too_deep_and_survives_with_5_mm_below_it_up_to_950_rpm() {
        // c₀ = 0.24 + 1.211 = 1.451 N·m, c₁ = 0.00096: θc = 299.1 rad; θb = 493.5/35.7 = 13.8
        // rad; 285.3 rad are 45.4 turns
        let deep = overrun(&SPINDLE, M6, Lead::mm_per_rev(1.0), Spin::rpm(3000.0));
        assert!((deep.value() - 45.4).abs() < 0.1, "{deep:?}");
        let most = SPINDLE.tapping_max;
        let slow = survives(&SPINDLE, M6, Lead::mm_per_rev(1.0), Length::mm(5.0), most);
        assert!((slow.in_rpm() - 950.0).abs() < 11.0, "{} rpm", slow.in_rpm());
        assert!(overrun(&SPINDLE, M6, Lead::mm_per_rev(1.0), slow) <= Length::mm(5.0));
        let faster = slow + Spin::rpm(10.0);
        assert!(overrun(&SPINDLE, M6, Lead::mm_per_rev(1.0), faster) > Length::mm(5.0));
    }

    #[test]
    fn without_room_no_speed_survives_and_with_enough_every_one_does() {
        let at = |room| survives(&SPINDLE, M6, Lead::mm_per_rev(1.0), room, SPINDLE.tapping_max);
        assert_eq!(at(Length::ZERO), Spin::ZERO);
        assert!((at(Length::mm(1e3)).in_rpm() - 6000.0).abs() < 1e-9);
    }
}
