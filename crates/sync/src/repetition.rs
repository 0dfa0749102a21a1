//! Learning over revolutions: what a turn missed is sent in advance with the next one, harmonic by
//! harmonic.
//!
//! ```text
//!   turn 0      U = D               M measured          H_k = M_k / U_k            what the machine does to a sine
//!   turn j      U_k ← U_k + γ·γ_k·(D_k − M_k)/H_k       γ = 1 first, then 0.7; γ_k = 1
//!
//!   guard of a harmonic: it got worse ──► its best command again, γ_k halved; three times ──► left alone
//!   guard of the turn, floor, end: those of all learning by repetition ([`crate::iteration`])
//! ```
//!
//! With H known to within ε the error of a harmonic shrinks by |1 − γ(1 + ε)| a turn. A law that
//! only leads (γ·E sent earlier by a time) diverges where the phase of H is off by more than a
//! quarter turn, which on a real cam is a dozen harmonics; so a harmonic whose H is not known is
//! not learnt: one that the command excites too little gets its H from its neighbours, one beyond
//! all that are excited from what is assumed of the drive's loops, if anything is, else it stays as
//! it is. Friction is what speaks there: a round eccentric excites two harmonics, its reversals err
//! in sixty.
//!
//! Source: the compensation of JPH0622778B2, from one shift to all harmonics.
use crate::compensate::{MOST_BOOST, Response};
use crate::iteration::{Basis, IterationProgress, STRIKES, Taught, Terms};
use crate::measure::noise_of;
use crate::spectrum::{Complex, Spectrum};
use alloc::vec::Vec;
use units::{Length, Spin};

/// γ after the first turn.
const GAIN: f64 = 0.7;
/// A harmonic of the command must be so many times the noise to tell H.
const HEARD: f64 = 12.0;
/// An error of a harmonic below so many times its noise teaches nothing.
const SPEAKS: f64 = 1.5;
/// A turn is worse than the best one beyond this share …
const WORSE: f64 = 1.15;
/// Turns without gain that end it.
const IDLE_TURNS: u8 = 3;

/// How far learning may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepetitionOptions {
    /// Highest frequency that is learnt, Hz: where the drive still answers.
    pub highest_hz: f64,
    /// What the sensors cannot tell: an rms error below this is good enough.
    pub floor: Length,
}

/// One harmonic's state.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Harmonic {
    answer: Option<Complex>,
    /// The answer is what is assumed, not what was measured.
    assumed: bool,
    gain: f64,
    command: Complex,
    best: Complex,
    best_error: f64,
    strikes: u8,
}

/// What is learnt of one profile at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Repetition {
    ideal: Vec<f64>,
    wanted: Spectrum,
    spin: Spin,
    options: RepetitionOptions,
    harmonics: Vec<Harmonic>,
    best: Vec<Complex>,
    turns: u32,
    progress: IterationProgress,
    assumed: Response,
}

/// A turn that has come, in harmonics: the basis of a motion that goes round.
struct Turn<'a> {
    harmonics: &'a mut [Harmonic],
    best: &'a mut [Complex],
    wanted: &'a Spectrum,
    answer: &'a Spectrum,
    /// Noise of one harmonic.
    quiet: f64,
}

impl Repetition {
    /// For an ideal profile, given by nodes, at a speed. `known`: an answer measured before, to
    /// begin with.
    pub fn new(
        ideal: &[f64],
        spin: Spin,
        options: RepetitionOptions,
        known: Option<&Response>,
    ) -> Self {
        let highest = options.highest_hz / spin.abs().value().max(1e-9);
        let wanted = Spectrum::of(ideal, highest.clamp(1.0, 4096.0) as usize);
        let sent =
            known.map_or_else(|| wanted.clone(), |known| known.precompensated(&wanted, spin));
        let harmonic = |command: &Complex| Harmonic {
            answer: None,
            assumed: false,
            gain: 1.0,
            command: *command,
            best: *command,
            best_error: f64::INFINITY,
            strikes: 0,
        };
        Self {
            ideal: ideal.to_vec(),
            harmonics: sent.harmonics.iter().map(harmonic).collect(),
            best: sent.harmonics,
            wanted,
            spin,
            options,
            turns: 0,
            progress: IterationProgress::new(1.0),
            assumed: Response::default(),
        }
    }

    /// The same, with an answer that is assumed where none can be measured.
    #[must_use]
    pub fn assuming(self, assumed: Response) -> Self {
        Self { assumed, ..self }
    }

    /// The same, beginning with a table that was sent before.
    pub fn resumed(ideal: &[f64], spin: Spin, options: RepetitionOptions, sent: &[f64]) -> Self {
        let mut new = Self::new(ideal, spin, options, None);
        let sent = Spectrum::of(sent, new.harmonics.len() - 1).harmonics;
        for (harmonic, sent) in new.harmonics.iter_mut().zip(&sent) {
            (harmonic.command, harmonic.best) = (*sent, *sent);
        }
        new.best = sent;
        new
    }

    /// The table to send, as nodes. What is beyond the highest harmonic is sent as it is.
    pub fn table(&self) -> Vec<f64> {
        let change = |(h, d): (&Harmonic, &Complex)| h.command - *d;
        let changes = self.harmonics.iter().zip(&self.wanted.harmonics).map(change).collect();
        let change = Spectrum { harmonics: changes }.values(self.ideal.len());
        self.ideal.iter().zip(&change).map(|(d, c)| d + c).collect()
    }

    /// Root mean square of the error of the best turn so far; infinite before the first.
    pub fn best_rms(&self) -> Length {
        Length::mm(self.progress.best.unwrap_or(f64::INFINITY))
    }

    /// Turns that were measured.
    pub const fn turns(&self) -> u32 {
        self.turns
    }

    /// Harmonics that are left alone because they got worse.
    pub fn left_alone(&self) -> usize {
        self.harmonics.iter().filter(|h| h.strikes >= STRIKES).count()
    }

    /// What the machine makes of each frequency, as far as it is known: to begin with at another
    /// speed.
    pub fn response(&self) -> Response {
        let heard = self.harmonics.iter().enumerate().skip(1).filter(|(_, h)| !h.assumed);
        let known = heard.filter_map(|(k, h)| Some((k, h.answer?)));
        let hz = |k: usize| k as f64 * self.spin.abs().value();
        Response::from_points(known.map(|(k, h)| (hz(k), h.size(), -h.turn())))
    }

    /// Learn from the profile that the table gave, measured at the same nodes.
    pub fn learn(&mut self, measured: &[f64]) -> Taught {
        if self.progress.is_over()
            || measured.len() != self.ideal.len()
            || measured.iter().any(|x| !x.is_finite())
        {
            return Taught::Finished;
        }
        let errors: Vec<f64> = self.ideal.iter().zip(measured).map(|(d, m)| d - m).collect();
        let noise = noise_of(&errors);
        let n = errors.len() as f64;
        let rms = libm::sqrt(errors.iter().map(|e| e * e).sum::<f64>() / n);
        let quiet = noise / libm::sqrt(n); // of one harmonic
        let answer = Spectrum::of(measured, self.harmonics.len() - 1);
        self.turns += 1;
        self.identify(&answer, quiet);
        let terms = Terms {
            worse: WORSE,
            noise,
            floor: self.options.floor.value(),
            idle: Some(IDLE_TURNS),
        };
        let mut turn = Turn {
            harmonics: &mut self.harmonics,
            best: &mut self.best,
            wanted: &self.wanted,
            answer: &answer,
            quiet,
        };
        let taught = self.progress.learn(&mut turn, rms, &terms);
        if taught == Taught::Updated {
            self.progress.gain = self.progress.gain.min(GAIN);
        }
        taught
    }

    /// H of each harmonic that is heard for the first time; between them by interpolation.
    fn identify(&mut self, answer: &Spectrum, quiet: f64) {
        let command = Spectrum { harmonics: self.harmonics.iter().map(|h| h.command).collect() };
        let response = Response::of(&command, answer, self.spin, HEARD * quiet + 1e-9);
        let unknown = self.harmonics.iter_mut().enumerate().filter(|(_, h)| h.answer.is_none());
        for (k, harmonic) in unknown {
            let hz = k as f64 * self.spin.abs().value();
            let known = if k == 0 { Some(Complex::ONE) } else { response.at(hz) };
            harmonic.assumed = known.is_none();
            let answer = known.or_else(|| self.assumed.at(hz));
            harmonic.answer = answer.filter(|h| h.size() > 1.0 / MOST_BOOST);
        }
    }
}

impl Basis for Turn<'_> {
    fn keep(&mut self) {
        for (best, harmonic) in self.best.iter_mut().zip(self.harmonics.iter()) {
            *best = harmonic.command;
        }
    }

    fn bring_back(&mut self) {
        for (harmonic, best) in self.harmonics.iter_mut().zip(self.best.iter()) {
            harmonic.command = *best;
        }
    }

    fn correct(&mut self, gain: f64) {
        let pairs = self.wanted.harmonics.iter().zip(&self.answer.harmonics);
        for ((wanted, came), harmonic) in pairs.zip(self.harmonics.iter_mut()) {
            harmonic.correct(*wanted, *came, self.quiet, gain);
        }
    }
}

impl Harmonic {
    fn correct(&mut self, wanted: Complex, came: Complex, quiet: f64, gain: f64) {
        let Some(h) = self.answer else { return };
        let error = wanted - came;
        let size = error.size();
        if size < self.best_error {
            (self.best, self.best_error) = (self.command, size);
        } else if size > 1.5 * self.best_error + 3.0 * quiet {
            self.strikes = self.strikes.saturating_add(1);
            self.command = self.best;
            self.gain /= 2.0;
            return;
        }
        if self.strikes >= STRIKES || size < SPEAKS * quiet {
            return;
        }
        let most = MOST_BOOST * (wanted.size() + 0.02);
        let next = self.command + error / h * (self.gain * gain);
        if next.size() <= most {
            self.command = next;
        }
    }
}

/// Nothing is learnt yet of a profile that is not there.
impl Default for RepetitionOptions {
    fn default() -> Self {
        Self { highest_hz: 100.0, floor: Length::ZERO }
    }
}

#[cfg(test)]
#[path = "repetition_tests.rs"]
mod tests;
