//! What a report tells of a stop and of the way out after it.
use units::{Angle, Length, Time};

/// A point of the (θ, z) plane: spindle angle and place of the axis.
pub type PlanePoint = (Angle, Length);

/// A stop in a thread, and the ways out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadStop {
    /// Program line of the thread.
    pub line: u32,
    /// What stopped it.
    pub cause: String,
    /// When.
    pub time: Time,
    /// A point of the coupling, from which z = place + lead·(θ − angle), and the travel per turn.
    pub coupling: (PlanePoint, Length),
    /// From the fault to rest.
    pub stop: Vec<PlanePoint>,
    /// Largest distance from the coupling in the material from the alarm to rest.
    pub stop_error: Length,
    /// When the tap broke, in the stop or on the way out; `None` also where nothing can know it.
    pub broken: Option<Time>,
    /// The ways back that were tried, the one that was taken first.
    pub ways: Vec<WayBack>,
}

/// One way back.
#[derive(Clone, Debug, PartialEq)]
pub struct WayBack {
    /// What it is called.
    pub name: String,
    /// It was taken; others were tried on a copy of the machine.
    pub taken: bool,
    /// From rest to being out.
    pub track: Vec<PlanePoint>,
    /// Who went back onto the coupling.
    pub mover: String,
    /// Largest distance from the coupling on the way out in the material.
    pub helix_error: Length,
    /// Largest axial force meanwhile, N.
    pub force_n: f64,
    /// Class of the thread afterwards, and the reason if it is not as asked.
    pub class: String,
}

impl ThreadStop {
    /// Distance of a point from the coupling, µm.
    pub(crate) fn off_um(&self, (angle, place): PlanePoint) -> f64 {
        let ((angle0, place0), lead) = self.coupling;
        ((place - place0) - lead * (angle - angle0).value()).in_um()
    }

    /// Distance from the coupling at rest, µm.
    pub fn rest_um(&self) -> f64 {
        self.stop.last().map_or(0.0, |at| self.off_um(*at))
    }

    /// The damage index of a way back: the area between the stop's track and the way back, µm·rev.
    /// With e the distance from the coupling it is |∮ e dθ| along the track and back: nothing,
    /// where the way back retraces the stop.
    pub fn damage_um_rev(&self, way: &WayBack) -> f64 {
        let points = self.stop.iter().chain(&way.track).map(|at| (at.0.value(), self.off_um(*at)));
        let points: Vec<(f64, f64)> = points.collect();
        let area = points.windows(2).map(|w| (w[1].0 - w[0].0) * f64::midpoint(w[0].1, w[1].1));
        // the way out along the coupling adds only what it is off it
        area.sum::<f64>().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(rev: f64, um: f64) -> PlanePoint {
        (Angle::rev(rev), Length::mm(-1.25 * rev) + Length::um(um))
    }

    fn way(track: Vec<PlanePoint>) -> WayBack {
        WayBack {
            name: String::new(),
            taken: true,
            track,
            mover: String::new(),
            helix_error: Length::ZERO,
            force_n: 0.0,
            class: String::new(),
        }
    }

    #[test]
    fn who_goes_back_as_he_came_adds_no_damage_and_who_does_not_adds_the_area_between() {
        let recovery = ThreadStop {
            line: 1,
            cause: String::new(),
            time: Time::ZERO,
            coupling: (at(0.0, 0.0), Length::mm(-1.25)),
            // the spindle overran by one turn: the feed is left 100 µm off, growing evenly
            stop: vec![at(4.0, 0.0), at(5.0, 100.0)],
            stop_error: Length::um(100.0),
            broken: None,
            ways: Vec::new(),
        };
        let same = way(vec![at(4.5, 50.0), at(4.0, 0.0), at(0.0, 0.0)]);
        assert!(recovery.damage_um_rev(&same).abs() < 1e-9);
        // straight down instead: the triangle of one turn and 100 µm
        let other = way(vec![at(5.0, 0.0), at(0.0, 0.0)]);
        assert!((recovery.damage_um_rev(&other) - 50.0).abs() < 1e-9);
        assert!((recovery.rest_um() - 100.0).abs() < 1e-9);
    }
}
