//! Friction: what keeps a table from moving, and a spindle from turning for ever.
//!
//! ```text
//!   F │ Fs ╮                     table: the LuGre model. Microscopic bristles of stiffness σ₀ bend by z
//!     │ Fc ╰────────╱ σ₂·v       before they slip, so the force is a spring first, Stribeck's curve later:
//!     │
//!     └──────────────► v            dz/dt = v − σ₀·|v|·z / g(v)
//!         vs                        F     = σ₀·z + σ₁·dz/dt + σ₂·v
//!                                   g(v)  = Fc + (Fs − Fc)·exp(−(v/vs)²)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | v, z | sliding speed, bending of the bristles | m/s, m |
//! | σ₀, σ₁, σ₂ | stiffness and damping of the bristles, viscous friction | N/m, N·s/m, N·s/m |
//! | Fc, Fs, vs | Coulomb force, breakaway force, Stribeck speed | N, N, m/s |
//! | h | physics step | s |
//!
//! At rapid traverse the bristles settle within σ₀|v|/g ≈ 10 µs, about one step: too stiff for an
//! explicit rule. The implicit one, z⁺ = (z + h·v) / (1 + h·σ₀|v|/g), is stable at any speed and
//! exact in the steady state, where z = g/σ₀. The exponential is replaced by exp(−u) ≈ (1 + u/4 +
//! u²/32)⁻⁴, whose error never exceeds 0.0091 (0.37 N of 190 N for the Z axis of a tapping centre),
//! and which shares the one division of the step.
//!
//! A spindle's bearing has c₀·tanh(ω/ω₀) + c₁·ω. Here tanh x ≈ x(27 + x²)/(27 + 9x²) up to |x| = 3,
//! then ±1: smooth, monotone, wrong by 0.024 at most.
//!
//! Source: Canudas de Wit, Olsson, Åström, Lischinsky, "A new model for control of systems with
//! friction", IEEE Transactions on Automatic Control 40 (1995) 419–425.
use units::{CoordinateSpeed, Force, Stiffness};

/// Friction of a guideway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lugre {
    /// Stiffness σ₀ of the bristles.
    pub bristle_stiffness: Stiffness,
    /// Damping σ₁ of the bristles, N·s/m.
    pub bristle_damping_n_s_per_m: f64,
    /// Viscous friction σ₂, N·s/m.
    pub viscous_n_s_per_m: f64,
    /// Coulomb force Fc.
    pub coulomb: Force,
    /// Breakaway force Fs.
    pub breakaway: Force,
    /// Stribeck speed vs.
    pub stribeck: CoordinateSpeed,
}

/// A guideway's friction made ready for one step size; SI units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guideway {
    h: f64,
    h_sigma_0: f64,
    sigma_1_per_h: f64,
    /// σ₀ + σ₁/h: what the bristles' new bending weighs in the force.
    bent_weight: f64,
    sigma_2: f64,
    coulomb: f64,
    excess: f64,
    fastest: f64,
    /// ¼/vs² and 1/32 vs⁴.
    square_share: f64,
    fourth_share: f64,
}

/// Beyond this |v|/vs the Stribeck term is below 3·10⁻⁹ of its height, and the polynomial stays
/// small.
const FAR_BEYOND_STRIBECK: f64 = 8.0;

impl Guideway {
    pub(crate) fn new(model: &Lugre, h: f64) -> Self {
        let sigma_0 = model.bristle_stiffness.value() * 1e3;
        let sigma_1_per_h = model.bristle_damping_n_s_per_m / h;
        let stribeck = model.stribeck.value() * 1e-3;
        Self {
            h,
            h_sigma_0: h * sigma_0,
            sigma_1_per_h,
            bent_weight: sigma_0 + sigma_1_per_h,
            sigma_2: model.viscous_n_s_per_m,
            coulomb: model.coulomb.value(),
            excess: (model.breakaway - model.coulomb).value(),
            fastest: FAR_BEYOND_STRIBECK * stribeck,
            square_share: 0.25 / stribeck.powi(2),
            fourth_share: 0.031_25 / stribeck.powi(4),
        }
    }

    /// Advance the bristles `z` (m) by one step at speed `v` (m/s); the force (N) that opposes `v`.
    ///
    /// Every operation waits for the one before it, and four bodies are stepped side by side: what
    /// counts is the length of the chain, not the number of operations. So products are spread out
    /// rather than nested.
    #[inline]
    pub(crate) fn step(&self, z: &mut f64, v: f64) -> f64 {
        let speed = v.abs();
        let near = if speed < self.fastest { speed } else { self.fastest };
        let square = near * near;
        let root = (1.0 + self.square_share * square) + self.fourth_share * (square * square);
        let root_square = root * root;
        let quartic = root_square * root_square;
        // numerator and denominator both times the quartic: one division serves Stribeck and the
        // rule
        let moved = *z + self.h * v;
        let over = moved * self.coulomb * quartic + moved * self.excess;
        let under = (self.coulomb + self.h_sigma_0 * speed) * quartic + self.excess;
        let bent = over / under;
        let rest = self.sigma_2 * v - self.sigma_1_per_h * *z;
        *z = bent;
        self.bent_weight * bent + rest
    }
}

/// Clamp in two instructions. The states it is used on are numbers: commands that are not are
/// refused before.
#[inline]
pub(crate) fn between(x: f64, low: f64, high: f64) -> f64 {
    let x = if x > low { x } else { low };
    if x < high { x } else { high }
}

/// A smooth sign: tanh, nearly.
#[inline]
pub(crate) fn smooth_sign(x: f64) -> f64 {
    let x = between(x, -3.0, 3.0);
    let square = x * x;
    x * (27.0 + square) / (27.0 + 9.0 * square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::z_friction;
    use crate::oracle::friction::{steady_force, stribeck};
    use units::Speed;

    const H: f64 = 25e-6;

    #[test]
    fn at_constant_speed_the_force_settles_on_stribecks_curve() {
        let model = z_friction();
        let guideway = Guideway::new(&model, H);
        for v in [1e-5, 1e-4, 5e-4, 1e-3, 2e-3, 4e-3, 1e-2, 0.1, 0.8, -1e-3, -0.8] {
            let (mut z, mut force) = (0.0, 0.0);
            // 40 bristle lengths of sliding, or 1000 steps where each step slides farther than that
            let steps = (40.0 * 1e-5 / (f64::abs(v) * H)).max(1000.0) as usize;
            for _ in 0..steps {
                force = guideway.step(&mut z, v);
            }
            let exact = steady_force(&model, Speed::mm_per_s(v * 1e3)).value();
            assert!((force - exact).abs() < 0.37, "{v} m/s: {force} N, exact {exact} N");
        }
    }

    #[test]
    fn the_rational_stribeck_curve_stays_within_its_stated_error() {
        let worst = (0..=8000)
            .map(|i| {
                let u = f64::from(i) * 0.01;
                let root = 1.0 + u * (0.25 + u * 0.03125);
                (root.powi(-4) - stribeck(u)).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst < 0.0091, "{worst}");
    }

    #[test]
    fn the_smooth_sign_is_tanh_within_its_stated_error_and_saturates() {
        let mut last = -1.0;
        for i in -500..=500 {
            let x = f64::from(i) * 0.01;
            let y = smooth_sign(x);
            assert!((y - x.tanh()).abs() < 0.024, "{x}: {y}");
            assert!(y >= last, "falls at {x}");
            last = y;
        }
        assert_eq!(smooth_sign(3.0), 1.0);
        assert_eq!(smooth_sign(-1e9), -1.0);
    }

    #[test]
    fn below_breakaway_the_bristles_are_a_spring() {
        let guideway = Guideway::new(&z_friction(), H);
        let (mut z, v) = (0.0, 1e-5);
        let mut force = 0.0;
        for _ in 0..4000 {
            force = guideway.step(&mut z, v); // 1 µm in all
        }
        // σ₀·1 µm = 20 N, less what has begun to slip: z = (g/σ₀)(1 − e^{−σ₀x/g}), plus σ₁·v = 0.2
        // N
        let g = 190.0;
        let exact = g * (1.0 - f64::exp(-20.0 / g)) + 0.2 * f64::exp(-20.0 / g) + 0.006;
        assert!((force - exact).abs() < 0.05, "{force} N, exact {exact} N");
    }

    #[test]
    fn friction_never_gives_energy_over_a_closed_path() {
        let guideway = Guideway::new(&z_friction(), H);
        let mut z = 0.0;
        let mut work = 0.0;
        for i in 0..40_000 {
            let v = 2e-3 * (f64::from(i) * H * 40.0).sin();
            work += guideway.step(&mut z, v) * v * H;
        }
        assert!(work > 0.0, "{work} J");
    }
}
