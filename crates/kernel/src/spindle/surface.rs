//! Constant surface speed (G96): the speed by the place of X, n = v/(2π·r), period by period.
use super::{SpindleLoop, Task};
use motion::SurfaceSpeed;
use units::{Length, Spin};

impl SpindleLoop {
    /// Turn by the place of X from now on.
    pub(crate) const fn turn_by_surface(&mut self, surface: SurfaceSpeed) {
        self.surface = Some(surface);
        self.changing_s = 0.0;
    }

    /// X is ordered to this place: the speed that belongs to it, which is reached on the ramps that
    /// were not planned. The operator's share acts on it, and the program's limit on both.
    pub(crate) fn follow_surface(&mut self, x: Length) {
        let Some(surface) = self.surface else { return };
        let spin = surface.at(x).value();
        let limit = surface.limit.abs().value();
        self.programmed = Some(spin);
        self.order = Task::Slew(self.overridden(spin).clamp(-limit, limit));
    }

    /// The speed that a cut needs where it turns by the place of X: the one that its ramps have
    /// reached.
    pub(crate) fn by_surface(&self) -> Option<Spin> {
        self.surface.map(|_| self.ordered.spin)
    }
}
