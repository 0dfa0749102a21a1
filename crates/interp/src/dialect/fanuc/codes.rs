//! Fanuc's G and M codes, and which shared code each of them is.
use crate::{
    codes::{BORE_UPWARDS, FINE_BORE, LENGTH_BACK},
    dialect::fanuc::kind::Kind,
};

pub(crate) use crate::dialect::fanuc::meaning::Meaning;

/// What G means, in tenths.
pub(crate) fn meaning(kind: Kind, tenths: u16) -> Meaning {
    use Meaning::{
        Back, Box, Check, Cylinder, ExactBlock, Face, Longer, Mapping, Multiple, NotYet, Off,
        Shared, Skip, Smoothing, StrokeCheck, Thread, Unknown,
    };
    let own = (kind.variant().own)(tenths);
    if let Some(own) = own {
        return own;
    }
    let Some(code) = kind.common(tenths) else { return Unknown };
    if kind.is_lathe() {
        match code {
            340 | 700 | 710 | 720 | 730 | 740 | 750 | 760 => return Multiple(code),
            770 | 780 | 790 => return Box(code),
            830 | 840 | 850 => return Shared(code),
            870 | 880 | 890 => return NotYet("drilling and tapping cycle along X"),
            810 | 820 | 860 => return Unknown,
            160 => return NotYet("polar coordinates"),
            510 | 511 => return NotYet("scaling and mirroring"),
            680 => return NotYet("double turret mirroring"),
            _ => {}
        }
    } else if matches!(code, 150 | 160 | 500 | 501 | 510 | 511 | 680 | 690) {
        return Mapping(code);
    }
    match code {
        0 | 10 | 20 | 30 | 40 | 100 | 170 | 180 | 190 | 200 | 210 | 280 | 300 => Shared(code),
        400 | 410 | 420 | 430 | 490 | 520 | 530 | 540 | 550 | 560 | 570 | 580 | 590 => Shared(code),
        640 | 730 | 740 | 890 | 900 | 910 | 920 | 930 | 940 | 950 | 960 | 970 | 980 | 990 => {
            Shared(code)
        }
        800 | 810 | 820 | 830 | 840 | 850 | 860 => Shared(code),
        842 | 843 if kind.is_mill() => Shared(code),
        541 => Shared(541),
        610 => Shared(611),
        330 => Thread,
        50 | 51 | 80 => Smoothing,
        90 => ExactBlock,
        290 => Back,
        310 => Skip,
        440 if kind.is_mill() => Shared(LENGTH_BACK),
        220 | 230 => StrokeCheck(code == 220),
        270 => Check,
        450 if kind.is_mill() => Longer(1),
        460 if kind.is_mill() => Longer(-1),
        470 if kind.is_mill() => Longer(2),
        480 if kind.is_mill() => Longer(-2),
        110 | 150 | 250 | 500 | 501 | 670 | 690 => Off,
        22 | 23 | 32 | 33 => NotYet("involute and exponential interpolation"),
        24 | 34 => NotYet("arc in space"),
        52 | 62 => NotYet("NURBS interpolation"),
        71 | 1070 => Cylinder,
        121 | 1120 => Face(true),
        131 | 1130 => Face(false),
        106 => NotYet("tool withdrawal"),
        260 => NotYet("spindle speed fluctuation detection"),
        350 | 360 => NotYet("circular threading"),
        370..=372 => NotYet("automatic tool length measurement"),
        412..=415 | 422 | 424 | 425 => NotYet("three-dimensional cutter compensation"),
        431 | 434 | 435 | 437 => NotYet("tool centre point control"),
        531 | 536 | 682 | 683 | 684 => NotYet("tilted working plane"),
        542 | 544 => NotYet("rotary table dynamic fixture offset"),
        661 => NotYet("macro modal call for each block"),
        721 | 722 => NotYet("figure copy"),
        814 | 804 | 815 | 805 => NotYet("electronic gear box"),
        502 | 2500 => Shared(502),
        512 | 2510 => Shared(512),
        513 => Shared(513),
        514 => Shared(514),
        600 => NotYet("positioning from one side"),
        620 | 630 => NotYet("corner override and tapping mode"),
        760 => Shared(FINE_BORE),
        870 => Shared(BORE_UPWARDS),
        880 => Shared(880),
        _ => Unknown,
    }
}

/// A multiple cycle's name.
const fn multiple(tenths: u16) -> &'static str {
    match tenths {
        340 => "thread of growing lead",
        700 => "finishing cycle",
        710 => "roughing cycle along Z",
        720 => "roughing cycle along X",
        730 => "pattern repeating cycle",
        740 => "pecking cycle along Z",
        750 => "pecking and grooving cycle along X",
        _ => "multiple threading cycle",
    }
}

/// What a code of machining centres does to the coordinates.
const fn mapping(tenths: u16) -> &'static str {
    match tenths {
        150 => "end of polar coordinates",
        160 => "polar coordinates",
        500 => "end of scaling",
        501 => "end of mirroring",
        510 => "scaling",
        511 => "mirroring",
        680 => "coordinate rotation",
        _ => "end of coordinate rotation",
    }
}

/// M codes that are the same in the shared language. M29 announces a rigid tap on Fanuc's controls
/// alone.
pub(crate) const fn is_shared_m(kind: Kind, number: u16) -> bool {
    match number {
        29 => kind.variant().has_m29,
        _ => matches!(number, 0..=9 | 19 | 30 | 48 | 49 | 60),
    }
}

/// A G code of a Fanuc machine, for people: what it is in the shared language, or its name and
/// whether it is executed.
pub(crate) fn told(kind: Kind, tenths: u16) -> Option<(Option<u16>, &'static str, bool)> {
    match meaning(kind, tenths) {
        _ if tenths == 650 => Some((None, "macro call", true)),
        _ if tenths == 660 => Some((None, "macro call after each block that moves", true)),
        _ if tenths == 670 => Some((None, "end of the last modal macro", true)),
        Meaning::Shared(541) => Some((None, "more work offsets", true)),
        Meaning::Shared(code) => Some((Some(code), "", true)),
        Meaning::Thread => Some((None, "thread cutting", true)),
        Meaning::Box(770) => Some((None, "turning cycle", true)),
        Meaning::Box(780) => Some((None, "threading cycle", true)),
        Meaning::Box(_) => Some((None, "facing cycle", true)),
        Meaning::Multiple(code) => Some((None, multiple(code), true)),
        Meaning::Mapping(code) => Some((None, mapping(code), true)),
        Meaning::Off => Some((None, "the end of what Leadscrew does not begin: no effect", true)),
        Meaning::Smoothing => Some((None, "look-ahead and smoothing: always on", true)),
        Meaning::Check => {
            Some((None, "rapid move, and are the axes at the reference point?", true))
        }
        Meaning::Cylinder => Some((None, "ways round a cylinder, unrolled", true)),
        Meaning::Face(true) => Some((None, "ways on a face, by X and C", true)),
        Meaning::Face(false) => Some((None, "end of the ways on a face", true)),
        Meaning::StrokeCheck(true) => {
            Some((None, "stored stroke check: a box no axis may enter", true))
        }
        Meaning::StrokeCheck(false) => Some((None, "end of the stored stroke check", true)),
        Meaning::Longer(1) => Some((None, "this way is longer by the offset D", true)),
        Meaning::Longer(-1) => Some((None, "this way is shorter by the offset D", true)),
        Meaning::Longer(2) => Some((None, "this way is longer by twice the offset D", true)),
        Meaning::Longer(_) => Some((None, "this way is shorter by twice the offset D", true)),
        Meaning::Circle(true) => Some((None, "a circle from its centre, clockwise", true)),
        Meaning::Circle(false) => Some((None, "a circle from its centre, counter-clockwise", true)),
        Meaning::WorkOffset(_) => Some((None, "more work offsets", true)),
        Meaning::Smoothness => Some((None, "how corners are taken", true)),
        Meaning::ExactBlock => Some((None, "exact stop for one block", true)),
        Meaning::Back => Some((None, "return from the reference point", true)),
        Meaning::Skip => Some((None, "skip: a feed to the end, where the signal comes", true)),
        Meaning::NotYet(name) => Some((None, name, false)),
        Meaning::Unknown => None,
    }
}

/// What works in the place of a code that is not executed.
pub(crate) const fn instead(tenths: u16) -> &'static str {
    match tenths {
        470 => {
            "the control's own letters are not known here: let the CAM post the strokes of the text, in G0, G1, G2 and G3"
        }
        434 | 435 => "G43 H_ takes the tool's length along Z",
        620 | 630 => "write G64, or G61 for exact stops",
        661 => "G66 calls the macro after each block that moves, G65 once",
        682 => "G68 turns the coordinates in their plane",
        870 | 880 | 890 => "G83, G84 and G85 drill, tap and bore along Z",
        721 | 722 => "M98 P_ repeats a subprogram, G68 turns it",
        _ => "",
    }
}

/// Whether a code that is Fanuc's own stays in force after its block.
pub(crate) fn stays(kind: Kind, tenths: u16) -> bool {
    if tenths == 660 {
        return true;
    }
    matches!(
        meaning(kind, tenths),
        Meaning::StrokeCheck(_)
            | Meaning::Cylinder
            | Meaning::Face(_)
            | Meaning::Mapping(160 | 510 | 511 | 680)
            | Meaning::Box(_)
            | Meaning::Thread
            | Meaning::WorkOffset(_)
            | Meaning::Smoothness
    )
}

/// Whether this M code is the one of the shared language.
pub(crate) const fn has_m(kind: Kind, number: u16) -> bool {
    is_shared_m(kind, number)
        || matches!(number, 98 | 99)
        || number == 97 && kind.variant().calls_by_m97
}
