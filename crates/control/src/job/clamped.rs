//! The one stock of a session: what `--stock` says, else the program's comment, else the machine's
//! file. Planner, judge, simulator and bar all read it from the session's machine.
//!
//! ```text
//!   --stock 'DIA 32 LENGTH 80' ─┐
//!   (STOCK DIA 32 LENGTH 80) ───┼─► [setup.stock] of the session's machine ─► plan, judge, sim, check
//!   [setup.stock] ──────────────┘
//! ```
use super::stock_comments::{Stated, stated};
use crate::Refused;
use diag::{Diagnostic, Span};
use store::machine::MachineFile;
use units::Length;

/// What states the stock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ClampedStock {
    pub(super) stated: Option<Stated>,
    /// It is none that this machine can clamp: why.
    unfit: Option<&'static str>,
    /// A program before has stated it, on the same workpiece.
    is_there: bool,
}

impl ClampedStock {
    /// Of an option and a program's text.
    pub(super) fn of(option: Option<&str>, text: &[u8]) -> Result<Self, Refused> {
        let Some(option) = option else {
            let head = &text[..text.len().min(super::mill_stock::MilledStock::LOOKED_AT)];
            let stated = stated(&String::from_utf8_lossy(head));
            return Ok(Self { stated, ..Self::default() });
        };
        let found = stated(&format!("(STOCK {option})"));
        found.map(|stated| Self { stated: Some(stated), ..Self::default() }).ok_or_else(|| {
            Refused::because(format!(
                "--stock: \"{option}\" is no stock: expected a bar such as 'DIA 32 LENGTH 80', two corners in G54 such as 'X0 Y0 Z-20 X100 Y60 Z0', or a size such as '100X60X20', in mm"
            ))
        })
    }

    /// Clamps it in the machine.
    pub(super) fn clamp(&mut self, machine: &mut MachineFile) {
        let is_lathe = machine.turned_bar().is_some();
        let turns_work = is_lathe || machine.spindles.len() > 1;
        let stock = &mut machine.setup.stock;
        match self.stated {
            Some(Stated::Block(block)) => {
                let [[x, to_x], [y, to_y], _] = block;
                let is_round = x == -to_x && y == x && to_y == to_x;
                if is_lathe && !is_round {
                    self.unfit = Some(
                        "this machine turns a bar about X0 Y0: state it as (STOCK DIA 32 LENGTH 80), or with X and Y from -r to r",
                    );
                    return;
                }
                stock.from = [0, 1, 2].map(|i| Length::mm(block[i][0]));
                stock.to = [0, 1, 2].map(|i| Length::mm(block[i][1]));
                stock.bore = stock.bore.min(stock.to[0] * 2.0 - Length::um(1.0)).max(Length::ZERO);
            }
            Some(Stated::Round { diameter, bore, length }) => {
                if !turns_work {
                    self.unfit = Some(
                        "a round bar is for machines that turn the work: state the block, (STOCK X-16 Y-16 Z-80 X16 Y16 Z0)",
                    );
                    return;
                }
                let radius = Length::mm(diameter / 2.0);
                for axis in 0..2 {
                    (stock.from[axis], stock.to[axis]) = (-radius, radius);
                }
                if let Some(length) = length {
                    stock.from[2] = stock.to[2] - Length::mm(length);
                }
                if is_lathe {
                    stock.bore = Length::mm(bore.unwrap_or(0.0));
                }
            }
            Some(Stated::Size(_)) if is_lathe => {
                self.unfit = Some("this machine turns a bar: state its diameter, (STOCK DIA 32)");
            }
            Some(Stated::Size(_)) | None => {}
        }
    }

    /// It was stated for this program and counts.
    pub(super) const fn is_stated(&self) -> bool {
        self.stated.is_some() && self.unfit.is_none() && !self.is_there
    }

    /// The same, as the next program finds it that states none.
    pub(super) const fn standing(self) -> Self {
        Self { is_there: true, ..self }
    }

    /// That what is stated does not count, and why.
    pub(super) fn remark(&self) -> Option<Diagnostic> {
        let why = self.unfit?;
        let text = "the stock that is stated is none for this machine: that of its file counts";
        Some(Diagnostic::note("A0111", Span::default(), text.to_owned()).with_help(why))
    }
}
