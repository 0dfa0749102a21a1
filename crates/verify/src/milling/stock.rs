//! The stock that is milled, and where it is known from.
use crate::Stock;

/// Where the stock that is milled is known from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StockSource {
    /// The machine's file.
    MachineFile,
    /// A comment of the program.
    Comment,
    /// The extent of the program: it is assumed, and no more.
    Extent,
}

impl StockSource {
    /// `"machine file"`, `"comment"` or `"extent"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MachineFile => "machine file",
            Self::Comment => "comment",
            Self::Extent => "extent",
        }
    }
}

/// The stock that is milled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MillStock {
    /// The block.
    pub block: Stock,
    /// Where that is known from.
    pub source: StockSource,
}
