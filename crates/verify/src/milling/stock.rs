//! The stock that is milled, and where it is known from.
use crate::Stock;

/// Where the stock that is milled is known from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StockSource {
    /// The machine's file.
    MachineFile,
    /// A comment of the program.
    Comment,
    /// A comment of the program tells its size; where it lies is assumed.
    Size,
    /// The extent of the program: it is assumed, and no more.
    Extent,
}

impl StockSource {
    /// `"machine file"`, `"comment"`, `"size"` or `"extent"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MachineFile => "machine file",
            Self::Comment => "comment",
            Self::Size => "size",
            Self::Extent => "extent",
        }
    }

    /// Whether the material may not be there, or more of it.
    pub const fn is_assumed(self) -> bool {
        matches!(self, Self::Size | Self::Extent)
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
