//! The stock that a program mills: what its comments state, what the machine's file says, or else
//! as much as the program reaches over, which is said.
//!
//! | comment | read as |
//! |---|---|
//! | `(STOCK X0 Y0 Z-20 X100 Y60 Z0)` | two corners |
//! | `(STOCK/BLOCK, 100, 60, 20, 0, 0, 20)` | size, and where the program's zero lies above the lower corner (`CutViewer`) |
//! | `(stockMin: 0, 0, -20)` and `(stockMax: 100, 60, 0)` | the corners (a post that writes both) |
//!
//! Numbers are in the program's unit and count from G54 as it is when the program begins. A size
//! without a place (`STOCK DX 4IN DY 2IN DZ 1IN`) is not read: where it lies is not said.
use super::described::{comments, unit_of};
use crate::job::Session;
use canon::{Op, OpKind, Plane, Position, Tool, ToolKind};
use diag::{Diagnostic, Span};
use units::Length;
use verify::{MillStock, Stock, StockSource};

/// A mill may go so many of its diameters beside the stock, and so much below it, mm: leading in,
/// cutting through.
const BESIDE: f64 = 1.5;
const BELOW: f64 = 2.0;
/// No stock is larger, mm.
const LARGEST: f64 = 100_000.0;
/// Pieces of a turn in which the reach of an arc is looked at.
const PIECES: f64 = 64.0;

/// A box, mm: ends along X, Y and Z.
type Extent = [[f64; 2]; 3];

/// What the program says and where its mills are fed.
pub struct MilledStock {
    stated: Option<Extent>,
    mounted: u32,
    at: Position,
    /// Where tips are fed, and the largest radius of the mills.
    reach: Option<Extent>,
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
            stated: stated(source),
            mounted: session.tool(),
            at: session.interp_setup().start,
            reach: None,
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
            let reach = self.reach.get_or_insert_with(|| at.map(|value| [value, value]));
            for (ends, value) in reach.iter_mut().zip(at) {
                *ends = [ends[0].min(value), ends[1].max(value)];
            }
        }
    }

    /// The stock; `None`: nothing is milled, or the work turns.
    pub fn found(&self, session: &Session) -> Option<MillStock> {
        let own = machine_stock(session)?;
        let Some(reach) = self.reach else { return Some(own) };
        let zero = own.block.zero;
        if let Some(block) = self.stated {
            return Some(placed(&block, zero, StockSource::Comment));
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
        if stock.source != StockSource::Extent {
            return None;
        }
        let axis = |i: usize| {
            let block = &stock.block;
            let [from, to] = [block.from[i], block.to[i]].map(|at| (at - block.zero[i]).value());
            format!("{} {from:.2} to {to:.2}", ['X', 'Y', 'Z'][i])
        };
        let text = format!(
            "the stock of the machine's file is not what this program mills: a block as large as its reach is assumed, {}, {}, {} mm of G54",
            axis(0),
            axis(1),
            axis(2)
        );
        let help = "state it: (STOCK X0 Y0 Z-20 X100 Y60 Z0) in the program, two corners in its unit, or [setup.stock] in the machine's file; what is milled out of an assumed stock is never found good";
        Some(Diagnostic::note("A0109", self.first, text).with_help(help))
    }

    /// The same of all operations of a program.
    pub fn of(source: &[u8], session: &Session, ops: &[Op]) -> Self {
        let mut milled = Self::new(source, session);
        for op in ops {
            milled.see(session, op);
        }
        milled
    }

    /// What comments state, for a planner: in machine coordinates.
    pub(super) fn stated_in(source: &[u8], session: &Session) -> Option<Stock> {
        let block = stated(source)?;
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

/// The block that comments state, mm in G54.
fn stated(source: &[u8]) -> Option<Extent> {
    let text = String::from_utf8_lossy(&source[..source.len().min(MilledStock::LOOKED_AT)]);
    let unit = unit_of(&text);
    let (mut least, mut most) = (None, None);
    for comment in comments(&text) {
        let upper = comment.trim().to_ascii_uppercase();
        if let Some(rest) = upper.strip_prefix("STOCK/BLOCK") {
            if let [sx, sy, sz, ox, oy, oz] = numbers(rest)[..] {
                return block([-ox, -oy, -oz], [sx - ox, sy - oy, sz - oz], unit);
            }
        } else if let Some(rest) = upper.strip_prefix("STOCKMIN:") {
            least = <[f64; 3]>::try_from(numbers(rest)).ok();
        } else if let Some(rest) = upper.strip_prefix("STOCKMAX:") {
            most = <[f64; 3]>::try_from(numbers(rest)).ok();
        } else if let Some(rest) = upper.strip_prefix("STOCK ")
            && let Some([a, b]) = corners(rest)
        {
            return block(a, b, unit);
        }
    }
    block(least?, most?, unit)
}

/// A box between two corners; `None`: it has no volume, or none that fits a machine.
fn block(a: [f64; 3], b: [f64; 3], unit: f64) -> Option<Extent> {
    let ends = [0, 1, 2].map(|i| [a[i].min(b[i]) * unit, a[i].max(b[i]) * unit]);
    let fine = |[from, to]: [f64; 2]| to > from && from.abs() < LARGEST && to.abs() < LARGEST;
    ends.into_iter().all(fine).then_some(ends)
}

/// Numbers between commas.
fn numbers(text: &str) -> Vec<f64> {
    let words = text.split([',', ' ']).filter(|word| !word.is_empty());
    words.map_while(|word| word.parse().ok().filter(|v: &f64| v.is_finite())).collect()
}

/// X, Y and Z twice over.
fn corners(text: &str) -> Option<[[f64; 3]; 2]> {
    let mut found = [Vec::new(), Vec::new(), Vec::new()];
    for word in text.split_whitespace() {
        let axis = "XYZ".find(word.chars().next()?)?;
        found[axis].push(word[1..].parse().ok().filter(|v: &f64| v.is_finite())?);
    }
    let [xs, ys, zs] = found;
    let ([x, a], [y, b], [z, c]) = (&xs[..], &ys[..], &zs[..]) else { return None };
    Some([[*x, *y, *z], [*a, *b, *c]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_state_the_stock() {
        let plate = Some([[0.0, 100.0], [-5.0, 60.0], [-20.0, 0.0]]);
        for text in [
            "(STOCK X0 Y-5 Z-20 X100 Y60 Z0)\nG0 X0",
            "%\n(T1 D=6. flat end mill)\n(stock x100 y60 z0 x0 y-5 z-20)",
            "(STOCK/BLOCK, 100, 65, 20, 0, 5, 20)",
            "; STOCK/BLOCK,100.0,65.0,20.0,0.0,5.0,20.0",
            "(stockMin: 0.00, -5.00, -20.00)\n(stockMax: 100.00, 60.00, 0.00)",
        ] {
            assert_eq!(stated(text.as_bytes()), plate, "{text}");
        }
        let inch = stated(b"G20\n(STOCK X0 Y0 Z-1 X4 Y2 Z0)");
        assert_eq!(inch, Some([[0.0, 101.6], [0.0, 50.8], [-25.4, 0.0]]));
    }

    #[test]
    fn what_states_no_place_is_no_stock() {
        for text in [
            "(STOCK 6061AL DX 3.5IN DY 2.0IN DZ 1.0IN)",
            "(STOCK = 3.6 X 2. X 1.)",
            "(STOCK/BLOCK, 100, 60, 20)",
            "(STOCK X0 Y0 Z0 X0 Y60 Z20)",
            "(STOCK X0 Y0 Z0)",
            "(STOCK DIAMETER)",
            "(stockMin: 0, 0, 0)",
            "(STOCK/BLOCK, 1e300, 1e300, 1e300, 0, 0, 0)",
            "(STOCK ü)",
        ] {
            assert_eq!(stated(text.as_bytes()), None, "{text}");
        }
    }
}
