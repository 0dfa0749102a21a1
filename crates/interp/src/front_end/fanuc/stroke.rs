//! G22 and G23: the box of the stored stroke check.
//!
//! `G22 X Y Z I J K`: the largest and the smallest coordinates of the machine; a lathe has X, Z, I
//! and K, diameters along X. G22 alone brings the last box back. Whether its inside or its outside
//! is forbidden is a parameter of the machine.
use crate::{
    StrokeZone,
    fault::{Outcome, refuse},
    front_end::fanuc::state::{Fanuc, Zone},
    state::executor::Executor,
};

impl Zone {
    pub(crate) const fn new(outside: bool) -> Self {
        Self { outside, on: false, sides: None }
    }

    /// The box, between G22 and G23.
    pub(crate) fn in_force(&self) -> Option<StrokeZone> {
        let [from, to] = self.sides.filter(|_| self.on)?;
        Some(StrokeZone { from, to, outside: self.outside })
    }
}

/// G22 (`on`) or G23 of a block; its words are taken away.
pub(crate) fn set_stroke_check(fanuc: &mut Fanuc, ex: &mut Executor, on: bool) -> Outcome {
    let span = ex.words.place.span;
    fanuc.once.stroke_check = true;
    fanuc.zone.on = on;
    if !on {
        return Ok(());
    }
    let mut sides = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    let axes: &[usize] = if fanuc.is_lathe() { &[0, 2] } else { &[0, 1, 2] };
    let mut named = 0;
    for i in axes {
        let letters = [b"IJK"[*i], b"XYZ"[*i]];
        for (side, letter) in letters.into_iter().enumerate() {
            if let Some(value) = ex.words.take(letter) {
                sides[side][*i] = fanuc.radius(*i, value * ex.modes.units.in_mm());
                named += 1;
            }
        }
        let [from, to] = [sides[0][*i], sides[1][*i]];
        if from >= to {
            let [smallest, largest] = letters.map(char::from);
            let text = format!(
                "G22 needs {largest} above {smallest}: the largest and the smallest coordinate of its box"
            );
            return refuse("I1056", span, text);
        }
    }
    if named == 2 * axes.len() {
        fanuc.zone.sides = Some(sides);
    }
    if named > 0 && named < 2 * axes.len() || fanuc.zone.sides.is_none() {
        let letters = if fanuc.is_lathe() { "X, Z, I and K" } else { "X, Y, Z, I, J and K" };
        let text = format!(
            "G22 needs {letters}: the largest and the smallest machine coordinates of its box"
        );
        return refuse("I1056", span, text);
    }
    Ok(())
}
