//! A shop with two tools, and what programs come to in it.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part
use canon::{Holder, Op, OpKind, TapTool, Tool, ToolKind, ToolLibrary};
use interp::{Ops, Setup};
use units::{Lead, Length, Stiffness};

pub fn tool(number: u32, length: f64, kind: ToolKind) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::mm(length),
        diameter: Length::mm(6.0),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

pub fn m6() -> ToolKind {
    ToolKind::Tap(TapTool {
        designation: "M6x1".into(),
        lead: Lead::mm_per_rev(1.0),
        chamfer_pitches: 2.5,
        thread_length: Length::mm(20.0),
        flute: canon::Flute::SpiralFlute,
        oversize: Length::um(20.0),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    })
}

pub fn shop() -> Setup {
    let tools = ToolLibrary::new([
        tool(1, 80.0, ToolKind::EndMill(canon::Mill::default())),
        tool(2, 100.0, m6()),
    ]);
    Setup { tools, ..Setup::default() }
}

/// The operations of a program that must be free of errors.
#[track_caller]
pub fn ops_of(setup: &Setup, program: &str) -> Vec<Op> {
    let program = format!("{program}\nM2\n");
    let mut ops = Ops::new(program.as_bytes(), setup);
    let all: Vec<Op> = ops.by_ref().collect();
    assert!(!ops.has_errors(), "{:?}", ops.diagnostics());
    all
}

/// The ends of all rapids and lines, X Y Z in mm.
pub fn ends(ops: &[Op]) -> Vec<[f64; 3]> {
    let end = |op: &Op| match &op.kind {
        OpKind::Rapid { to } | OpKind::Line { to, .. } | OpKind::Arc { to, .. } => {
            Some(to.linear.map(Length::value))
        }
        _ => None,
    };
    ops.iter().filter_map(end).collect()
}

#[track_caller]
pub fn near(found: &[[f64; 3]], wanted: &[[f64; 3]]) {
    let close = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9);
    assert!(
        found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| close(a, b)),
        "{found:?}"
    );
}

#[track_caller]
pub fn the_tap(ops: &[Op]) -> canon::Tap {
    let mut taps =
        ops.iter().filter_map(|op| if let OpKind::Tap(tap) = op.kind { Some(tap) } else { None });
    let tap = taps.next().expect("a tap");
    assert!(taps.next().is_none(), "one tap only");
    tap
}

#[track_caller]
pub fn refused(setup: &Setup, program: &str, code: &str) -> diag::Diagnostic {
    let found = interp::check(format!("{program}\nM2\n").as_bytes(), setup);
    let fault = found.iter().find(|d| d.code == code);
    fault.unwrap_or_else(|| panic!("expected {code}, found {found:?}")).clone()
}
