//! What a mill has done: its largest engagement and where, its rapids through the stock.
use super::stock::StockSource;
use crate::Stock;
use canon::{MillForm, MillLimits, WrittenPlace};
use units::{Angle, Force, Length, Spin};

/// A place in the program and in the work offset G54.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MillingPlace {
    /// Program line.
    pub line: u32,
    /// Of the tool's tip.
    pub at: [Length; 3],
    /// The same as the program writes it.
    pub written: WrittenPlace,
}

/// The largest of something, and where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest<T> {
    /// How large.
    pub value: T,
    /// Where.
    pub place: MillingPlace,
}

/// A rapid that went through what was left of the stock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidCut {
    /// Height of what stood in its way.
    pub depth: Length,
    /// Where that was largest.
    pub place: MillingPlace,
}

/// The stock as a mill has left it, from above.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// The block, and its zero.
    pub block: Stock,
    /// How deep it is gone, mm, in rows from small Y to large.
    pub depths: Vec<Vec<f64>>,
}

/// What a mill has done, from when it came into the spindle until it was taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Milled {
    /// Diameter of the mill.
    pub diameter: Length,
    /// Its form, if that is known.
    pub form: Option<MillForm>,
    /// What the tool table says that it may have.
    pub limits: MillLimits,
    /// What it removed, mm³, to the grid's error.
    pub removed_mm3: f64,
    /// Where its stock is known from; `None`: none is known.
    pub source: Option<StockSource>,
    /// Side of a cell of the grid.
    pub cell: Option<Length>,
    /// Memory of the grid, bytes.
    pub grid_bytes: usize,
    /// Axial depth ap.
    pub depth: Option<Largest<Length>>,
    /// Radial width ae.
    pub width: Option<Largest<Length>>,
    /// Angle of engagement.
    pub angle: Option<Largest<Angle>>,
    /// Removal rate, mm³/s.
    pub removal_mm3_per_s: Option<Largest<f64>>,
    /// Feed a tooth; `None` where its teeth are not known.
    pub feed_per_tooth: Option<Largest<Length>>,
    /// Thickness of the chip, thinned below 90° of engagement.
    pub chip: Option<Largest<Length>>,
    /// Tangential force, estimated; `None` where teeth or material are not known.
    pub force: Option<Largest<Force>>,
    /// Deflection of the tip by it; `None` where the body or its length is not known.
    pub deflection: Option<Largest<Length>>,
    /// Fastest speed of the spindle in the cut (magnitude).
    pub spin_max: Spin,
    /// Rapids through the stock, the first ones.
    pub rapids: Vec<RapidCut>,
    /// All of them.
    pub rapid_count: usize,
    /// The stock afterwards.
    pub map: Option<Box<HeightMap>>,
}

impl Milled {
    /// By no mill, out of the stock that is configured.
    pub(super) fn nothing(config: &crate::Config) -> Self {
        Self {
            diameter: Length::ZERO,
            form: None,
            limits: MillLimits::default(),
            removed_mm3: 0.0,
            source: config.mill_stock.map(|stock| stock.source),
            cell: None,
            grid_bytes: 0,
            depth: None,
            width: None,
            angle: None,
            removal_mm3_per_s: None,
            feed_per_tooth: None,
            chip: None,
            force: None,
            deflection: None,
            spin_max: Spin::ZERO,
            rapids: Vec::new(),
            rapid_count: 0,
            map: None,
        }
    }

    /// Such as "ball mill".
    pub fn form_name(&self) -> &'static str {
        match self.form {
            Some(MillForm::Ball) => "ball mill",
            Some(MillForm::Cylindrical { corner }) if corner > Length::ZERO => "bull-nose mill",
            Some(MillForm::Cylindrical { .. }) => "flat mill",
            Some(MillForm::Conical { .. }) => "conical mill",
            None => "mill",
        }
    }
}
