//! Cams: from a lift over an angle to the path of the grinding wheel's centre.
//!
//! ```text
//!            follower                          flat     support function h(φ) = r₀ + s(φ)
//!              │ s(φ)                            p = h·n + h′·t          ρ = h + h″
//!         ╭────┴────╮                          roller   its centre at r(φ) = r₀ + R + s(φ)
//!       ╭─╯  cam  ●  ╰─╮   p(φ) contour          p = r·n − R·N           ρ = ρ(r) − R
//!       │   ┼ C     wheel ◯── X               knife    r(φ) = r₀ + s(φ), R = 0
//!       ╰──╮       ╭──╯
//!          ╰───────╯                           wheel's centre  c = p + W·N   X = |c|, ψ = arg c
//! ```
//!
//! n, t are the radial and the tangential unit vector at φ, N the outward normal of the contour.
//! While the wheel's centre is at X, the work stands so that ψ looks to the wheel: ψ, not φ, is the
//! angle of the C axis. The path is therefore a table X(ψ) of its own for each wheel radius W, and
//! a worn wheel needs a new one.
//!
//! A hollow of the contour (ρ < 0) can be ground only by a wheel with W < |ρ|. A flat follower that
//! asks for h + h″ ≤ 0 would have to be cut away under itself: there is no such cam.
//!
//! Source: R. L. Norton, Cam Design and Manufacturing Handbook, chapters 7 and 14; JPH0622778B2 for
//! the table of X over C.
mod closed;
mod error;
mod lift;
mod path;
mod rhythm;
mod speed;

pub use closed::ClosedForm;
pub use error::{CamError, Problem};
pub use lift::{Cam, Follower, LiftRow, MOST_ROWS};
pub use path::{ContourPoint, WheelPath};
pub use rhythm::Rhythm;
pub use speed::{AxisBounds, Bound, Motion, WorkSpeed};
