//! The stock that a program mills: what its comments state, what the machine's file says, or else
//! as much as the program reaches over, which is said
//! (`stock_comments`).
//!
//! Where only a size is told, the block is assumed to lie as work is set up: along X and Y with its
//! middle, its lower or its upper end at the zero of G54, whichever is nearest to where the mills
//! go; its top at Z0, or its underside where nothing is fed below Z0. That is said, too.
use super::stock_comments::{Extent, Stated, stated};
use crate::job::Session;
use canon::{Op, OpKind, Plane, Position, Tool, ToolKind};
use diag::{Diagnostic, Span};
use units::Length;
use verify::{MillStock, Stock, StockSource};

/// A mill may go so many of its diameters beside the stock, and so much below it, mm: leading in,
/// cutting through.
const BESIDE: f64 = 1.5;
const BELOW: f64 = 2.0;
/// Rounding of a program's numbers, mm.
const ROUNDING: f64 = 1e-6;
/// Pieces of a turn in which the reach of an arc is looked at.
const PIECES: f64 = 64.0;

/// What the program says and where its mills are fed.
pub struct MilledStock {
    stated: Option<Stated>,
    mounted: u32,
    at: Position,
    /// Where tips are fed, and the largest radius of the mills.
    reach: Option<Extent>,
    /// The same of the places that are no higher than the zero of G54: on the way there a tool may
    /// be fed through the air from far away.
    low: Option<Extent>,
    zero_z: f64,
    radius: f64,
    /// The highest place of the tip at which a mill is fed across.
    across: f64,
    first: Span,
}

impl MilledStock {
    /// Bytes of a program, from its beginning, in which comments are looked at.
    pub const LOOKED_AT: usize = 1 << 22;

    /// Of a program, on a machine where this tool is in the spindle.
    pub fn new(source: &[u8], session: &Session) -> Self {
        Self {
            stated: session.stock.stated.or_else(|| stated_by(source)),
            mounted: session.tool(),
            at: session.interp_setup().start,
            reach: None,
            low: None,
            zero_z: session.work_zero().linear[2].value(),
            radius: 0.0,
            across: f64::NEG_INFINITY,
            first: Span::default(),
        }
    }

    /// An operation of the program.
    pub fn see(&mut self, session: &Session, op: &Op) {
        let from = self.at;
        match &op.kind {
            OpKind::ChangeTool { number } => self.mounted = *number,
            OpKind::Rapid { to } => self.at = *to,
            OpKind::Line { to, .. } | OpKind::Arc { to, .. } | OpKind::Spline { to, .. } => {
                self.at = *to;
                let tool = session.tools.get(self.mounted);
                if let Some(tool) = tool.filter(|t| matches!(t.kind, ToolKind::EndMill(_))) {
                    if self.reach.is_none() {
                        self.first = op.span;
                    }
                    self.fed(tool, &from, op);
                }
            }
            _ => {}
        }
    }

    fn fed(&mut self, tool: &Tool, from: &Position, op: &Op) {
        self.radius = self.radius.max(tool.diameter.value() / 2.0);
        let length = tool.worn_length().value();
        let tip = |at: &Position| {
            let [x, y, z] = at.linear.map(Length::value);
            [x, y, z - length]
        };
        let (start, end) = (tip(from), tip(&self.at));
        let mut places = vec![start, end];
        match &op.kind {
            OpKind::Arc { arc, .. } => {
                let (first, second, _) = match arc.plane {
                    Plane::XY => (0, 1, 2),
                    Plane::ZX => (2, 0, 1),
                    Plane::YZ => (1, 2, 0),
                };
                let mut centre = arc.centre.map(Length::value);
                for (centre, axis) in centre.iter_mut().zip([first, second]) {
                    if axis == 2 {
                        *centre -= length;
                    }
                }
                let [a, b] = [start[first] - centre[0], start[second] - centre[1]];
                let pieces = (arc.sweep.value().abs() * PIECES).ceil().clamp(1.0, 4096.0);
                places.extend((1..pieces as u32).map(|k| {
                    let share = f64::from(k) / pieces;
                    let (sin, cos) = (arc.sweep.in_rad() * share).sin_cos();
                    let mut at = [0, 1, 2].map(|i| start[i] + (end[i] - start[i]) * share);
                    at[first] = centre[0] + a * cos - b * sin;
                    at[second] = centre[1] + a * sin + b * cos;
                    at
                }));
            }
            OpKind::Spline { spline, .. } => {
                // a Bézier curve stays within its control points
                let points = spline.pieces.iter().flatten();
                places.extend(points.map(|[x, y]| [x.value(), y.value(), end[2]]));
            }
            _ => {}
        }
        if (end[0] - start[0]).hypot(end[1] - start[1]) > 0.0 {
            self.across = self.across.max(start[2]).max(end[2]);
        }
        for at in places.into_iter().filter(|at| at.iter().all(|value| value.is_finite())) {
            widen(&mut self.reach, at);
            if at[2] <= self.zero_z + ROUNDING {
                widen(&mut self.low, at);
            }
        }
    }

    /// The stock; `None`: nothing is milled, or the work turns.
    pub fn found(&self, session: &Session) -> Option<MillStock> {
        let own = machine_stock(session)?;
        let zero = own.block.zero;
        if let Some(Stated::Block(block)) = self.stated {
            return Some(placed(&block, zero, StockSource::Comment));
        }
        let Some(reach) = self.reach else { return Some(own) };
        match self.stated {
            Some(Stated::Size(size)) => {
                let block = laid(size, &self.low.unwrap_or(reach), zero.map(Length::value));
                return Some(placed(&block, zero, StockSource::Size));
            }
            Some(Stated::Block(_) | Stated::Round { .. }) | None => {}
        }
        if self.fits(&own.block, &reach) {
            return Some(own);
        }
        let origin = zero.map(Length::value);
        let mut block = reach;
        for (ends, zero) in block.iter_mut().zip(origin).take(2) {
            *ends = [ends[0] - self.radius - zero, ends[1] + self.radius - zero];
        }
        let [low, high] = reach[2];
        let top = if low < origin[2] && origin[2] <= high.max(self.across) + BELOW {
            origin[2]
        } else {
            self.across.max(low)
        };
        block[2] = [low - origin[2], top - origin[2]];
        Some(placed(&block, zero, StockSource::Extent))
    }

    /// What the program mills lies in this block, as far as mills may leave one.
    fn fits(&self, block: &Stock, reach: &Extent) -> bool {
        if reach[2][0] >= block.to[2].value() {
            return true; // all in the air over it
        }
        let beside = 2.0 * self.radius * BESIDE;
        let within = |i: usize, by: f64| {
            block.from[i].value() - by <= reach[i][0] && reach[i][1] <= block.to[i].value() + by
        };
        within(0, beside) && within(1, beside) && reach[2][0] >= block.from[2].value() - BELOW
    }

    /// That the stock is assumed, and which.
    pub fn remark(&self, session: &Session) -> Option<Diagnostic> {
        let stock = self.found(session)?;
        let axis = |i: usize| {
            let block = &stock.block;
            let [from, to] = [block.from[i], block.to[i]]
                .map(|at| (at - block.zero[i]).value() / session.unit.in_mm());
            let decimals = if session.unit == canon::LengthUnit::Inch { 3 } else { 2 };
            format!("{} {from:.decimals$} to {to:.decimals$}", ['X', 'Y', 'Z'][i])
        };
        let block =
            format!("{}, {}, {} {} of G54", axis(0), axis(1), axis(2), session.unit.symbol());
        let (code, text) = match stock.source {
            StockSource::MachineFile | StockSource::Comment => return None,
            StockSource::Size => (
                "A0110",
                format!(
                    "a comment tells the size of the stock, and not where it lies: it is assumed to lie at {block}"
                ),
            ),
            StockSource::Extent => (
                "A0109",
                format!(
                    "the stock of the machine's file is not what this program mills: a block as large as its reach is assumed, {block}"
                ),
            ),
        };
        let help = "state it: (STOCK X0 Y0 Z-20 X100 Y60 Z0) in the program, two corners in its unit, or [setup.stock] in the machine's file; what is milled out of an assumed stock is never found good";
        Some(Diagnostic::note(code, self.first, text).with_help(help))
    }

    /// The same of all operations of a program.
    pub fn of(source: &[u8], session: &Session, ops: &[Op]) -> Self {
        let mut milled = Self::new(source, session);
        for op in ops {
            milled.see(session, op);
        }
        milled
    }

    /// The block that comments state, for planners and judges: in machine coordinates.
    pub fn stated_in(source: &[u8], session: &Session) -> Option<Stock> {
        let stated = session.stock.stated.or_else(|| stated_by(source));
        let Some(Stated::Block(block)) = stated else { return None };
        let own = machine_stock(session)?;
        Some(placed(&block, own.block.zero, StockSource::Comment).block)
    }
}

/// The stock of the machine's file; `None`: it is a bar that turns.
pub(super) fn machine_stock(session: &Session) -> Option<MillStock> {
    if session.machine.turned_bar().is_some() {
        return None;
    }
    let (zero, stock) = (session.work_zero().linear, &session.machine.setup.stock);
    let block = Stock {
        from: [0, 1, 2].map(|i| zero[i] + stock.from[i]),
        to: [0, 1, 2].map(|i| zero[i] + stock.to[i]),
        zero,
    };
    Some(MillStock { block, source: StockSource::MachineFile })
}

/// A block in G54, clamped at its zero.
fn placed(block: &Extent, zero: [Length; 3], source: StockSource) -> MillStock {
    let end = |k: usize| [0, 1, 2].map(|i| zero[i] + Length::mm(block[i][k]));
    MillStock { block: Stock { from: end(0), to: end(1), zero }, source }
}

/// An extent that also has this place.
fn widen(extent: &mut Option<Extent>, at: [f64; 3]) {
    let extent = extent.get_or_insert_with(|| at.map(|value| [value, value]));
    for (ends, value) in extent.iter_mut().zip(at) {
        *ends = [ends[0].min(value), ends[1].max(value)];
    }
}

/// A block of this size, mm in G54, that tips reach over, mm in machine coordinates.
fn laid(size: [f64; 3], reach: &Extent, zero: [f64; 3]) -> Extent {
    let across = |i: usize| {
        let middle = f64::midpoint(reach[i][0], reach[i][1]) - zero[i];
        let half = size[i] / 2.0;
        let places = [half, 0.0, -half];
        let off = |at: &f64| (at - middle).abs();
        let at = places.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(half);
        [at - half, at + half]
    };
    let below = reach[2][0] < zero[2] - ROUNDING;
    let z = if below { [-size[2], 0.0] } else { [0.0, size[2]] };
    [across(0), across(1), z]
}

/// What the comments at a program's beginning state.
fn stated_by(source: &[u8]) -> Option<Stated> {
    stated(&String::from_utf8_lossy(&source[..source.len().min(MilledStock::LOOKED_AT)]))
}

#[cfg(test)]
mod tests {
    use super::laid;

    /// The tip goes 5 mm beside the block at each side; the zero of G54 is at X200 Y100 Z50.
    #[test]
    fn a_size_is_laid_where_the_mills_go() {
        let zero = [200.0, 100.0, 50.0];
        let reach = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| [x, y, z];
        let corner =
            laid([100.0, 60.0, 20.0], &reach([195.0, 305.0], [95.0, 165.0], [45.0, 60.0]), zero);
        assert_eq!(corner, [[0.0, 100.0], [0.0, 60.0], [-20.0, 0.0]]);
        let middle =
            laid([100.0, 60.0, 20.0], &reach([145.0, 255.0], [65.0, 135.0], [45.0, 60.0]), zero);
        assert_eq!(middle, [[-50.0, 50.0], [-30.0, 30.0], [-20.0, 0.0]]);
        let rear =
            laid([100.0, 60.0, 20.0], &reach([95.0, 205.0], [35.0, 105.0], [50.0, 75.0]), zero);
        assert_eq!(rear, [[-100.0, 0.0], [-60.0, 0.0], [0.0, 20.0]]);
    }
}
