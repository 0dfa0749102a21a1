//! Learning by repetition: what one run of a motion missed is given to the next one in advance,
//! whatever the motion.
//!
//! ```text
//!             ┌────────────── run k: u_k sent, e_k = wanted − measured, score s_k ◄─────────────┐
//!             ▼                                                                                  │
//!   s_k much worse than the best ──► u of the best run again, γ halved; [`STRIKES`] times ──► finished
//!   s_k at the floor, or nothing gained for long ───────────────────────────────────────────► finished, u of the best
//!   else ──► u_k+1 = Q·(u_k + γ·L·e_k) ─────────────────────────────────────────────────────────► next run
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | u, e | correction and error, in the coordinates of a *basis* |
//! | γ | gain of learning |
//! | L, Q | learning filter and robustness filter of the basis |
//!
//! The basis is the parameter, and all that differs ([`Basis`]): a motion that goes round has
//! harmonics, each with the answer 1/L that was heard of it ([`crate::Repetition`]: cams, a
//! polygon's oscillation); a motion that goes in and out has splines over its time, L = 1 and Q a
//! low-pass without phase ([`crate::LearningRecord`]: repeated taps). What decides whether a run
//! taught something, what is kept, and when it ends, is here.
//!
//! With T from what is sent to what comes, the error shrinks where |Q·(1 − γ·L·T)| < 1 (Bristow,
//! Tharayil, Alleyne: A survey of iterative learning control, IEEE Control Systems 26(3), 2006,
//! eq. 18). T is not known well enough to be sure; hence the guard: what is kept is the best run
//! that was *measured*, and the very first one was without correction, so that what is kept is
//! never worse than not learning by more than the scores' own noise.

/// Runs that made it worse, after which it ends.
pub const STRIKES: u8 = 3;

/// The coordinates in which corrections are learnt.
pub trait Basis {
    /// What is sent is the best so far: keep it.
    fn keep(&mut self);
    /// Send again what was kept.
    fn bring_back(&mut self);
    /// Add what the last run missed, by γ.
    fn correct(&mut self, gain: f64);
}

/// When a run is worse, and when it is enough. Scores are rms errors, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// A score is worse beyond this multiple of the best one …
    pub worse: f64,
    /// … and this, which it may differ by from run to run.
    pub noise: f64,
    /// A score as good as can be told.
    pub floor: f64,
    /// So many runs without gain end it; `None`: it never ends for that.
    pub idle: Option<u8>,
}

/// A run that gains less than this share gains nothing.
const GAINS: f64 = 0.98;

/// What a run taught.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taught {
    /// What is sent has changed.
    Updated,
    /// It got worse: the best so far is sent again.
    RolledBack,
    /// Nothing more to gain: the best stays.
    Finished,
}

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterationProgress {
    /// γ at present.
    pub gain: f64,
    /// Best score so far.
    pub best: Option<f64>,
    /// Runs that made it worse.
    pub strikes: u8,
    idle: u8,
    over: bool,
}

impl IterationProgress {
    /// Nothing learnt yet.
    pub const fn new(gain: f64) -> Self {
        Self { gain, best: None, strikes: 0, idle: 0, over: false }
    }

    /// No further learning.
    pub const fn is_over(&self) -> bool {
        self.over || self.strikes >= STRIKES
    }

    /// A run is over, with a score: learn from it.
    pub fn learn(&mut self, basis: &mut impl Basis, score: f64, terms: &Terms) -> Taught {
        if self.is_over() {
            return Taught::Finished;
        }
        let best = self.best.unwrap_or(f64::INFINITY);
        if score > best * terms.worse + terms.noise {
            basis.bring_back();
            (self.gain, self.strikes) = (self.gain / 2.0, self.strikes + 1);
            return if self.is_over() { Taught::Finished } else { Taught::RolledBack };
        }
        self.idle = if score < best * GAINS { 0 } else { self.idle.saturating_add(1) };
        if score <= best {
            self.best = Some(score);
            basis.keep();
        }
        let enough = terms.idle.is_some_and(|most| self.idle >= most);
        if score <= terms.floor || enough {
            self.over = true;
            basis.bring_back();
            return Taught::Finished;
        }
        basis.correct(self.gain);
        Taught::Updated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One number to be met by a plant that multiplies.
    struct Number {
        sent: f64,
        kept: f64,
        answer: f64,
    }

    impl Number {
        fn error(&self) -> f64 {
            1.0 - self.answer * self.sent
        }
    }

    impl Basis for Number {
        fn keep(&mut self) {
            self.kept = self.sent;
        }
        fn bring_back(&mut self) {
            self.sent = self.kept;
        }
        fn correct(&mut self, gain: f64) {
            self.sent += gain * self.error();
        }
    }

    const TERMS: Terms = Terms { worse: 1.2, noise: 1e-6, floor: 1e-4, idle: Some(3) };

    /// Scores of so many runs, and what the last one taught.
    fn runs(
        answer: f64,
        gain: f64,
        count: usize,
    ) -> (std::vec::Vec<f64>, Taught, IterationProgress) {
        let mut number = Number { sent: 0.0, kept: 0.0, answer };
        let mut progress = IterationProgress::new(gain);
        let mut taught = Taught::Updated;
        let scores = (0..count).map(|_| {
            let score = number.error().abs();
            taught = progress.learn(&mut number, score, &TERMS);
            score
        });
        (scores.collect(), taught, progress)
    }

    #[test]
    fn an_error_shrinks_by_one_less_the_gain_and_ends_at_the_floor() {
        let (scores, taught, _) = runs(1.0, 0.7, 12);
        assert!(scores[..8].windows(2).all(|s| (s[1] / s[0] - 0.3).abs() < 1e-9), "{scores:?}");
        assert_eq!(taught, Taught::Finished);
        // 0.3^8 is the first below 1e-4
        assert!(scores[8] < 1e-4 && scores[8..].iter().all(|s| s == &scores[8]), "{scores:?}");
    }

    #[test]
    fn a_gain_that_diverges_is_halved_until_it_converges() {
        // |1 − 3| = 2, |1 − 1.5| = ½
        let (scores, _, progress) = runs(1.0, 3.0, 6);
        assert_eq!(progress.gain, 1.5);
        assert!(scores[5] < 0.26, "{scores:?}");
    }

    #[test]
    fn what_answers_the_wrong_way_ends_as_it_began() {
        let (scores, taught, progress) = runs(-1.0, 0.7, 9);
        assert!(progress.strikes >= 2 && taught == Taught::Finished, "{progress:?}");
        assert_eq!(scores[8], scores[0]);
    }

    #[test]
    fn runs_that_gain_nothing_end_it_with_the_best() {
        let (scores, taught, _) = runs(0.0, 0.7, 5);
        assert_eq!(taught, Taught::Finished);
        assert!(scores.iter().all(|s| *s == 1.0));
    }
}
