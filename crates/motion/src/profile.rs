//! A path parameter as a function of time, in pieces of constant jerk.
//!
//! ```text
//!   s(t) = s₀ + v₀·t + ½·a₀·t² + ⅙·j·t³      within each piece, t from the piece's start
//! ```
//!
//! | symbol | meaning | unit for a move | unit for a spindle |
//! |---|---|---|---|
//! | s | path parameter | mm | rev |
//! | v, a, j | its rates | mm/s, mm/s², mm/s³ | rev/s, rev/s², rev/s³ |
//! | t | time | s | s |
//!
//! The same phases run along a joined path ([`crate::Follow`]). How they are made is the planner's;
//! here is what the kernel evaluates each period.

/// Most pieces a profile may have: a spindle's run-up on a power curve needs the most.
pub const MAX_PHASES: usize = 64;

/// A stretch of constant jerk, along a path or of a spindle's speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Phase {
    /// How long it lasts, s.
    pub duration: f64,
    /// Path parameter at its start.
    pub s: f64,
    /// Speed at its start.
    pub v: f64,
    /// Acceleration at its start.
    pub a: f64,
    /// Jerk all along.
    pub j: f64,
}

impl Phase {
    /// State at a time after its start, s.
    pub fn at(&self, t: f64) -> Instant {
        Instant {
            s: self.s + t * (self.v + t * (self.a / 2.0 + t * self.j / 6.0)),
            v: self.v + t * (self.a + t * self.j / 2.0),
            a: self.a + t * self.j,
        }
    }

    /// State at its end.
    pub fn end(&self) -> Instant {
        self.at(self.duration)
    }
}

/// State at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Instant {
    /// Path parameter.
    pub s: f64,
    /// Its speed.
    pub v: f64,
    /// Its acceleration.
    pub a: f64,
}

/// Pieces in a row, of fixed capacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    pieces: [Phase; MAX_PHASES],
    count: usize,
    duration: f64,
    end: Instant,
    is_cut: bool,
}

impl Profile {
    /// Nothing yet: stays at 0.
    pub const EMPTY: Self = Self {
        pieces: [Phase { duration: 0.0, s: 0.0, v: 0.0, a: 0.0, j: 0.0 }; MAX_PHASES],
        count: 0,
        duration: 0.0,
        end: Instant { s: 0.0, v: 0.0, a: 0.0 },
        is_cut: false,
    };

    /// Append a piece; `false`, and nothing appended, when the profile is full.
    #[must_use]
    pub fn push(&mut self, piece: Phase) -> bool {
        if self.count == MAX_PHASES {
            return false;
        }
        self.pieces[self.count] = piece;
        self.count += 1;
        self.duration += piece.duration;
        self.end = piece.end();
        true
    }

    /// State the end exactly: what rounding left of it in the last piece is not handed on.
    #[must_use]
    pub fn ending_at(mut self, end: Instant) -> Self {
        self.end = end;
        self
    }

    /// As one that was cut, or not: as it was when it was made data.
    #[cfg(feature = "serde")]
    pub(crate) const fn marked_cut(mut self, is_cut: bool) -> Self {
        self.is_cut = is_cut;
        self
    }

    /// The pieces, in order.
    pub fn pieces(&self) -> &[Phase] {
        &self.pieces[..self.count]
    }

    /// How long it lasts, s.
    pub const fn duration(&self) -> f64 {
        self.duration
    }

    /// State at a time from its start, s: the first state before it, the last after it.
    pub fn at(&self, time: f64) -> Instant {
        if time >= self.duration {
            return self.end;
        }
        let mut t = time.max(0.0);
        for piece in self.pieces() {
            if t < piece.duration {
                return piece.at(t);
            }
            t -= piece.duration;
        }
        self.end
    }

    /// State at the end.
    pub const fn end(&self) -> Instant {
        self.end
    }

    /// It ends at this time, in the motion that it has there; whether that is within it.
    #[must_use]
    pub fn cut(&mut self, time: f64) -> bool {
        if !(time > 0.0 && time < self.duration) {
            return false;
        }
        let mut left = time;
        for (index, piece) in self.pieces[..self.count].iter_mut().enumerate() {
            if left <= piece.duration {
                piece.duration = left;
                (self.count, self.duration, self.end) = (index + 1, time, piece.end());
                self.is_cut = true;
                return true;
            }
            left -= piece.duration;
        }
        false // its pieces are as long as it
    }

    /// It was cut, and ends in motion.
    pub const fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Largest speed in it.
    pub fn peak(&self) -> f64 {
        self.pieces().iter().map(|p| p.v.abs()).fold(self.end.v.abs(), f64::max)
    }
}
