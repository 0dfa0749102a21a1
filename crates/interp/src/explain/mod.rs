//! Every finding about a program: its code, what it means, a program that causes it and one that
//! does not.
//!
//! `leadscrew explain` says what stands here, SARIF takes its rules from it, and a test runs every
//! program of it: the wrong one must give the code, the right one must not. A code that
//! is used and not in the list fails that test.
pub(crate) mod cam;
pub(crate) mod catalogue;
pub(crate) mod cycles;
pub(crate) mod elsewhere;
pub(crate) mod fanuc;
pub(crate) mod finding;
pub(crate) mod flow;
pub(crate) mod machine;
pub(crate) mod page;
pub(crate) mod text;
pub(crate) mod tools;
pub(crate) mod turning;
pub(crate) mod words;

use crate::{
    dialect::Dialect,
    setup::{Leaves, Limits, Setup},
};
pub use finding::Finding;

use canon::{Flute, Holder, TapTool, Tool, ToolKind, ToolLibrary};
use units::{Lead, Length, Speed, Stiffness};

/// All of them, by rising code.
pub fn findings() -> impl Iterator<Item = &'static Finding> {
    let all = [
        text::ROWS,
        words::ROWS,
        flow::ROWS,
        cycles::ROWS,
        turning::ROWS,
        tools::ROWS,
        machine::ROWS,
        fanuc::ROWS,
        cam::ROWS,
    ];
    all.into_iter().flatten()
}

/// The one with this code.
pub fn explain(code: &str) -> Option<&'static Finding> {
    findings().find(|finding| finding.code == code)
}

/// What the programs of the list meet: T1 is an end mill of 10 mm, T2 a tap M6; loops end after
/// 20,000 blocks.
pub fn example_setup(dialect: Dialect) -> Setup {
    let tool = |number, length, diameter, kind| Tool {
        number,
        pocket: number,
        length: Length::mm(length),
        diameter: Length::mm(diameter),
        kind,
        description: format!("tool {number} of the examples"),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    let tap = TapTool {
        designation: "M6".into(),
        lead: Lead::mm_per_rev(1.0),
        chamfer_pitches: 3.0,
        thread_length: Length::mm(20.0),
        flute: Flute::SpiralFlute,
        oversize: Length::ZERO,
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    };
    Setup {
        dialect,
        tools: ToolLibrary::new([
            tool(1, 100.0, 10.0, ToolKind::EndMill(canon::Mill::default())),
            tool(2, 120.0, 6.0, ToolKind::Tap(tap)),
        ]),
        leaves: Leaves {
            unknown_codes: dialect == Dialect::Grbl,
            feed: (dialect == Dialect::Grbl).then_some(Speed::mm_per_min(500.0)),
            end: false,
        },
        limits: Limits { blocks: 20_000, names: 100, ..Limits::default() },
        ..Setup::default()
    }
}
