//! One part written for the three code systems of Fanuc's lathes, block by block from the manual's
//! list: the operations are the same.
//!
//! | what | A | B | C |
//! |---|---|---|---|
//! | turning, threading, facing | G90 G92 G94 | G77 G78 G79 | G20 G21 G24 |
//! | thread | G32 | G33 | G33 |
//! | finish, rough, peck, thread in passes | G70 G71 G74 G76 | G70 G71 G74 G76 | G72 G73 G76 G78 |
//! | inches, millimetres | G20 G21 | G20 G21 | G70 G71 |
//! | position, highest speed | G50 | G92 | G92 |
//! | per minute, per revolution | G98 G99 | G94 G95 | G94 G95 |
//! | increments | U W | G91 X Z | G91 X Z |
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "G code list".
use canon::OpKind;
use interp::{Dialect, Ops, Setup};
use proptest::prelude::*;
use test_support::size;

/// A piece of a part, in the program's unit; X as a diameter.
#[derive(Clone, Debug)]
enum Piece {
    Rapid(f64, f64),
    By(f64, f64),
    FedBy(f64, f64),
    Line(f64, f64),
    Quarter(f64),
    Turning(f64, f64),
    Threading(f64, f64),
    Facing(f64, f64),
    Thread(f64),
    GrowingThread(f64),
    ThreadInPasses(f64),
    Rough(f64),
    Peck(f64),
    Drilled(f64),
    PerMinute(f64),
    SurfaceSpeed(f64),
    Revolutions(Option<f64>),
    Here(f64, f64),
}

fn piece() -> impl Strategy<Value = Piece> {
    let x = || 5.0..40.0_f64;
    let z = || -40.0..5.0_f64;
    let by = || -4.0..4.0_f64;
    prop_oneof![
        (x(), z()).prop_map(|(x, z)| Piece::Rapid(x, z)),
        (by(), by()).prop_map(|(x, z)| Piece::By(x, z)),
        (by(), by()).prop_map(|(x, z)| Piece::FedBy(x, z)),
        (x(), z()).prop_map(|(x, z)| Piece::Line(x, z)),
        (0.5..5.0_f64).prop_map(Piece::Quarter),
        (x(), z()).prop_map(|(x, z)| Piece::Turning(x, z)),
        (x(), z()).prop_map(|(x, z)| Piece::Threading(x, z)),
        (x(), z()).prop_map(|(x, z)| Piece::Facing(x, z)),
        (-40.0..-20.0_f64).prop_map(Piece::Thread),
        (-40.0..-20.0_f64).prop_map(Piece::GrowingThread),
        (-40.0..-20.0_f64).prop_map(Piece::ThreadInPasses),
        (8.0..16.0_f64).prop_map(Piece::Rough),
        (-40.0..-20.0_f64).prop_map(Piece::Peck),
        (-30.0..-5.0_f64).prop_map(Piece::Drilled),
        (20.0..200.0_f64).prop_map(Piece::PerMinute),
        (20.0..200.0_f64).prop_map(Piece::SurfaceSpeed),
        prop::option::of(200.0..900.0_f64).prop_map(Piece::Revolutions),
        (x(), z()).prop_map(|(x, z)| Piece::Here(x, z)),
    ]
}

/// A code system: what stands in its column of the list.
struct System {
    dialect: Dialect,
    /// Cycles of four moves: turning, threading, facing.
    boxes: [u32; 3],
    thread: u32,
    /// Finish, rough, peck, thread in passes.
    multiple: [u32; 4],
    /// Inches, millimetres.
    units: [u32; 2],
    position: u32,
    /// Per minute, per revolution.
    feed: [u32; 2],
    has_increments: bool,
}

const SYSTEMS: [System; 3] = [
    System {
        dialect: Dialect::FanucLatheA,
        boxes: [90, 92, 94],
        thread: 32,
        multiple: [70, 71, 74, 76],
        units: [20, 21],
        position: 50,
        feed: [98, 99],
        has_increments: false,
    },
    System {
        dialect: Dialect::FanucLatheB,
        boxes: [77, 78, 79],
        thread: 33,
        multiple: [70, 71, 74, 76],
        units: [20, 21],
        position: 92,
        feed: [94, 95],
        has_increments: true,
    },
    System {
        dialect: Dialect::FanucLatheC,
        boxes: [20, 21, 24],
        thread: 33,
        multiple: [72, 73, 76, 78],
        units: [70, 71],
        position: 92,
        feed: [94, 95],
        has_increments: true,
    },
];

impl System {
    /// A piece is one line in each system, so that operations come from the same lines.
    fn written(&self, piece: &Piece, number: usize) -> String {
        let [turning, threading, facing] = self.boxes;
        let [finish, rough, peck, passes] = self.multiple;
        let [per_minute, per_revolution] = self.feed;
        let (position, thread) = (self.position, self.thread);
        let increments = |code: u32, x: f64, z: f64| {
            if self.has_increments {
                format!("G91 G{code} X{x:.3} Z{z:.3}\nG90")
            } else {
                format!("G{code} U{x:.3} W{z:.3}\n")
            }
        };
        // each begins where the cycles of lathes begin: off the work
        let away = "G0 X44. Z8.\n";
        match *piece {
            Piece::Rapid(x, z) => format!("G0 X{x:.3} Z{z:.3}"),
            Piece::By(x, z) => increments(0, x, z),
            Piece::FedBy(x, z) => increments(1, x, z),
            Piece::Line(x, z) => format!("G1 X{x:.3} Z{z:.3}"),
            Piece::Quarter(r) => {
                format!("G0 X20. Z-5.\nG3 X{:.3} Z{:.3} R{r:.3}", 20.0 + 2.0 * r, -5.0 - r)
            }
            Piece::Turning(x, z) => format!("{away}G{turning} X{x:.3} Z{z:.3}\nG0 X45."),
            Piece::Threading(x, z) => {
                format!("G97 S400\n{away}G{threading} X{x:.3} Z{z:.3} F1.5\nG0 X45.")
            }
            Piece::Facing(x, z) => format!("{away}G{facing} X{x:.3} Z{z:.3}\nG0 X45."),
            Piece::Thread(z) => format!("G97 S400\n{away}G{thread} Z{z:.3} F1.5\nG0 X46."),
            Piece::GrowingThread(z) => format!("G97 S400\n{away}G34 Z{z:.3} F1.5 K0.01\nG0 X46."),
            Piece::ThreadInPasses(z) => format!(
                "G97 S400\n{away}G{passes} P010060 Q100 R0.05\nG{passes} X18.16 Z{z:.3} P920 Q300 F1.5\nG0 X46."
            ),
            Piece::Rough(x) => {
                let [n, m] = [10 * number + 1000, 10 * number + 1005];
                format!(
                    "{away}G{rough} U2. R0.5\nG{rough} P{n} Q{m} U0.4 W0.1\nN{n} G0 X{x:.3}\nG1 Z-10.\nN{m} X42.\nG{finish} P{n} Q{m}\nG0 X46."
                )
            }
            Piece::Peck(z) => format!("{away}G0 X0\nG{peck} R1.\nG{peck} Z{z:.3} Q4000\nG0 X46."),
            Piece::Drilled(z) => format!("{away}G0 X0\nG83 Z{z:.3} R-3. F0.1\nG80\nG0 X46."),
            Piece::PerMinute(f) => {
                format!("G{per_minute} G1 X30. Z-3. F{f:.1}\nG{per_revolution} F0.2")
            }
            Piece::SurfaceSpeed(s) => format!("G{position} S2000\nG96 S{s:.0}"),
            Piece::Revolutions(Some(s)) => format!("G97 S{s:.0}"),
            Piece::Revolutions(None) => "G97".to_owned(),
            Piece::Here(x, z) => format!("G{position} X{x:.3} Z{z:.3}"),
        }
    }

    /// Line and operation of each, and what was found.
    fn operations(&self, pieces: &[Piece], inch: bool) -> (Vec<(u32, OpKind)>, Vec<String>) {
        let (unit, per_revolution) = (self.units[usize::from(!inch)], self.feed[1]);
        let mut text = format!("O1\nG{unit} G18 G{per_revolution} G97 S500 M3\nG0 X44. Z8. F0.2\n");
        for (number, piece) in pieces.iter().enumerate() {
            text += &format!("{}\n", self.written(piece, number));
        }
        text += "M30\n";
        let setup = Setup { dialect: self.dialect, ..Setup::default() };
        let mut ops = Ops::new(text.as_bytes(), &setup);
        let all: Vec<_> = ops.by_ref().map(|op| (op.span.line, op.kind)).collect();
        let found = ops.diagnostics();
        let found = found.iter().map(|d| format!("{} line {}", d.code, d.span.line));
        (all, found.collect())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(size::of(200, 2000)) })]

    #[test]
    fn a_part_written_in_the_codes_of_a_b_and_c_gives_the_same_operations(
        pieces in prop::collection::vec(piece(), 1..12),
        inch in any::<bool>(),
    ) {
        let [a, b, c] = SYSTEMS.map(|system| system.operations(&pieces, inch));
        prop_assert!(a.0.len() > 2, "{:?}", a.1);
        prop_assert_eq!(&a.1, &b.1, "{:?}", pieces);
        prop_assert_eq!(&a.1, &c.1, "{:?}", pieces);
        prop_assert_eq!(&a.0, &b.0, "{:?}", pieces);
        prop_assert_eq!(&a.0, &c.0, "{:?}", pieces);
    }
}

/// Most of what is drawn must be understood, or the property says little.
#[test]
fn each_piece_alone_is_understood_in_each_system() {
    let all = [
        Piece::Rapid(20.0, -3.0),
        Piece::By(1.0, -2.0),
        Piece::FedBy(1.0, -2.0),
        Piece::Line(20.0, -3.0),
        Piece::Quarter(2.0),
        Piece::Turning(20.0, -20.0),
        Piece::Threading(20.0, -20.0),
        Piece::Facing(5.0, -2.0),
        Piece::Thread(-30.0),
        Piece::GrowingThread(-30.0),
        Piece::ThreadInPasses(-30.0),
        Piece::Rough(10.0),
        Piece::Peck(-30.0),
        Piece::Drilled(-20.0),
        Piece::PerMinute(50.0),
        Piece::SurfaceSpeed(100.0),
        Piece::Revolutions(None),
        Piece::Here(20.0, 3.0),
    ];
    for piece in all {
        for system in &SYSTEMS {
            let (ops, found) = system.operations(std::slice::from_ref(&piece), false);
            assert!(found.is_empty(), "{piece:?} in {:?}: {found:?}", system.dialect);
            assert!(ops.len() > 2, "{piece:?} in {:?}: {ops:?}", system.dialect);
        }
    }
}
