//! Milling against closed forms: slots, shoulders, balls, cones, ramps, arcs; rapids; what is not
//! known.
#![allow(clippy::unwrap_used)] // helpers of tests fail as tests do
mod empty;
mod properties;

use super::*;
use crate::verdict::Verdict;
use crate::workpiece::Workpiece;
use canon::{CutterMaterial, Mill, MillForm, MillLimits, OpKind, Position, ToolLibrary};
use std::f64::consts::PI;
use units::{Angle, Coordinate};

const LENGTH_MM: f64 = 80.0;
/// Of the simulated servo period, s.
const PERIOD: f64 = 1e-3;

fn tool(number: u32, diameter: f64, form: Option<MillForm>) -> Tool {
    let mill = Mill { form, teeth: Some(2), ..Mill::default() };
    Tool {
        number,
        pocket: number,
        length: Length::mm(LENGTH_MM),
        diameter: Length::mm(diameter),
        kind: ToolKind::EndMill(mill),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

/// A block of 100 × 60 × 20 whose top is the zero, clamped at a place of the machine.
fn config(tool: Tool, zero: [f64; 3]) -> Config {
    let at = |of: [f64; 3]| [0, 1, 2].map(|i| Length::mm(zero[i] + of[i]));
    let block =
        Stock { from: at([0.0, 0.0, -20.0]), to: at([100.0, 60.0, 0.0]), zero: at([0.0; 3]) };
    Config {
        mill_stock: Some(MillStock { block, source: StockSource::MachineFile }),
        ..Config::new(ToolLibrary::new([tool]))
    }
}

/// A mill that is moved from place to place.
struct Mover {
    milling: Milling,
    config: Config,
    zero: [f64; 3],
    sample: Sample,
    at: [f64; 3],
    /// rev/s.
    spin: f64,
    features: Vec<Judged<Milled>>,
}

impl Mover {
    fn at(config: Config, zero: [f64; 3], from: [f64; 3]) -> Self {
        let number = config.tools.iter().next().unwrap().number;
        let mut sample = Sample::default();
        sample.feedback.tool = Some(number);
        let mut milling = Milling::default();
        let [x, y, z] = zero;
        let g54 = ProgramFrame {
            work_offset: 1,
            origin: Position::xyz(x, y, z),
            tool: Position::xyz(0.0, 0.0, LENGTH_MM),
            ..ProgramFrame::default()
        };
        milling.frame(0, g54);
        Self { milling, config, zero, sample, at: from, spin: 100.0, features: Vec::new() }
    }

    fn new(form: MillForm, diameter: f64, from: [f64; 3]) -> Self {
        Self::at(config(tool(1, diameter, Some(form)), [0.0; 3]), [0.0; 3], from)
    }

    fn look(&mut self) {
        let tip = [0, 1, 2].map(|i| self.zero[i] + self.at[i]);
        for (i, at) in [tip[0], tip[1], tip[2] + LENGTH_MM].into_iter().enumerate() {
            self.sample.feedback.axes[i].position = Coordinate::new(at);
        }
        self.sample.feedback.time += Time::s(PERIOD);
        self.sample.feedback.spindles[0].angle += Angle::rev(self.spin * PERIOD);
        self.features.extend(self.milling.sample(
            &self.sample,
            &self.config,
            &Workpiece::default(),
        ));
    }

    /// Along a curve of a parameter from 0 to 1 and of this length.
    fn along(&mut self, state: State, speed: f64, length: f64, curve: impl Fn(f64) -> [f64; 3]) {
        self.sample.report.state = state;
        self.sample.report.op += 1;
        self.sample.report.line += 1;
        let steps = (length / (speed * PERIOD)).ceil().max(1.0);
        for k in 1..=steps as u32 {
            self.at = curve(f64::from(k) / steps);
            self.look();
        }
    }

    fn line(&mut self, state: State, speed: f64, to: [f64; 3]) {
        let from = self.at;
        self.along(state, speed, distance(from, to), |share| {
            [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * share)
        });
    }

    fn feed(&mut self, to: [f64; 3]) {
        self.line(State::Feed, 20.0, to);
    }

    fn rapid(&mut self, to: [f64; 3]) {
        self.line(State::Rapid, 200.0, to);
    }

    fn finish(mut self) -> Option<Judged<Milled>> {
        self.milling.close(&self.config)
    }

    fn milled(self) -> Milled {
        milled(&self.finish().unwrap()).clone()
    }
}

const fn milled(feature: &Judged<Milled>) -> &Milled {
    &feature.kind
}

fn degrees(of: Option<Largest<Angle>>) -> f64 {
    of.unwrap().value.in_deg()
}

fn mm(of: Option<Largest<Length>>) -> f64 {
    of.unwrap().value.value()
}

/// Right across the block, from side to side, so deep; along X at this Y.
fn slot(form: MillForm, diameter: f64, depth: f64, y: f64) -> Mover {
    let mut mover = Mover::new(form, diameter, [-20.0, y, 5.0]);
    mover.rapid([-20.0, y, -depth]);
    mover.feed([120.0, y, -depth]);
    mover
}

#[test]
fn a_slot_has_the_width_of_its_mill_and_half_a_turn_of_engagement() {
    let (d, a) = (10.0, 3.0);
    let found = slot(MillForm::FLAT, d, a, 30.0).milled();
    let cell = found.cell.unwrap().value();
    assert_eq!(cell, d / 40.0);
    assert!((degrees(found.angle) - 180.0).abs() < 0.1, "{:?}", found.angle);
    assert!((mm(found.width) - d).abs() < 1e-9);
    assert!((mm(found.depth) - a).abs() < 1e-4);
    // walls may stand half a cell off, on each side
    assert!((found.removed_mm3 - 100.0 * d * a).abs() < 100.0 * cell * a, "{}", found.removed_mm3);
    // 20 mm/s, 100 rev/s, 2 teeth
    assert!((mm(found.feed_per_tooth) - 0.1).abs() < 1e-6);
    assert!((mm(found.chip) - 0.1).abs() < 1e-6);
    let removal = found.removal_mm3_per_s.unwrap().value;
    assert!((removal / (20.0 * d * a) - 1.0).abs() < 0.1, "{removal}");
    assert!(found.rapids.is_empty());
}

#[test]
fn a_shoulder_has_the_angle_of_its_width_and_thinner_chips() {
    let (d, a) = (10.0, 2.0);
    for ae in [1.0, 2.5, 4.0, 5.0, 7.5] {
        // the block's edge lies at Y0
        let found = slot(MillForm::FLAT, d, a, ae - d / 2.0).milled();
        let cell = found.cell.unwrap().value();
        assert!((mm(found.width) - ae).abs() < 1.5 * cell, "ae {ae}: {:?}", found.width);
        let of = |ae: f64| (1.0 - 2.0 * ae / d).acos().to_degrees();
        let (least, most) = (of(ae - 1.5 * cell), of((ae + 1.5 * cell).min(d)));
        let angle = degrees(found.angle);
        assert!(least < angle && angle < most, "ae {ae}: {angle} not in {least} … {most}");
        let chip = if ae < d / 2.0 { 0.1 * of(ae).to_radians().sin() } else { 0.1 };
        assert!((mm(found.chip) / chip - 1.0).abs() < 0.2, "ae {ae}: {:?}, {chip}", found.chip);
    }
}

#[test]
fn a_ball_cuts_as_wide_as_its_chord() {
    let (d, a) = (8.0_f64, 1.0_f64);
    let found = slot(MillForm::Ball, d, a, 30.0).milled();
    let cell = found.cell.unwrap().value();
    let chord = 2.0 * (a * (d - a)).sqrt();
    assert!((mm(found.width) - chord).abs() < 3.0 * cell, "{:?}, {chord}", found.width);
    assert!((mm(found.depth) - a).abs() < 1e-3);
    let r = d / 2.0;
    let section = r * r * ((r - a) / r).acos() - (r - a) * chord / 2.0;
    assert!((found.removed_mm3 / (100.0 * section) - 1.0).abs() < 0.02, "{}", found.removed_mm3);
}

#[test]
fn a_cone_cuts_a_v() {
    let form = MillForm::Conical { angle: Angle::deg(90.0), tip: Length::ZERO };
    let found = slot(form, 10.0, 2.0, 30.0).milled();
    assert!((found.removed_mm3 / (100.0 * 4.0) - 1.0).abs() < 0.02, "{}", found.removed_mm3);
    assert!((mm(found.width) - 4.0).abs() < 3.0 * found.cell.unwrap().value());
}

#[test]
fn a_bull_leaves_its_corners_in_a_slot() {
    let (d, c, a) = (10.0, 2.0, 4.0);
    let form = MillForm::Cylindrical { corner: Length::mm(c) };
    let found = slot(form, d, a, 30.0).milled();
    let section = d * a - 2.0 * (c * c - PI * c * c / 4.0);
    assert!((found.removed_mm3 / (100.0 * section) - 1.0).abs() < 0.03, "{}", found.removed_mm3);
}

#[test]
fn a_full_circle_removes_its_ring() {
    let (d, r, a) = (6.0, 15.0, 2.0);
    let mut mover = Mover::new(MillForm::FLAT, d, [65.0, 30.0, 5.0]);
    mover.feed([65.0, 30.0, -a]);
    mover.along(State::Feed, 20.0, 2.0 * PI * r, |share| {
        let phi = share * 2.0 * PI;
        [50.0 + r * phi.cos(), 30.0 + r * phi.sin(), -a]
    });
    let found = mover.milled();
    let ring = PI * ((r + d / 2.0).powi(2) - (r - d / 2.0).powi(2)) * a;
    assert!((found.removed_mm3 / ring - 1.0).abs() < 0.02, "{} of {ring}", found.removed_mm3);
    assert!((degrees(found.angle) - 180.0).abs() < 30.0, "{:?}", found.angle);
}

#[test]
fn a_ramp_removes_its_wedge() {
    let (d, a) = (10.0, 4.0);
    let mut mover = Mover::new(MillForm::FLAT, d, [20.0, 30.0, 0.0]);
    mover.feed([80.0, 30.0, -a]);
    mover.feed([20.0, 30.0, -a]);
    let found = mover.milled();
    let slot = (60.0 * d + PI * d * d / 4.0) * a;
    assert!((found.removed_mm3 / slot - 1.0).abs() < 0.02, "{} of {slot}", found.removed_mm3);
    assert!((mm(found.depth) - a).abs() < 0.05, "{:?}", found.depth);
}

#[test]
fn a_rapid_through_the_stock_is_found_with_its_place_and_one_beside_it_is_not() {
    let mut through = Mover::new(MillForm::FLAT, 10.0, [-20.0, 30.0, -1.0]);
    through.rapid([120.0, 30.0, -1.0]);
    through.rapid([120.0, 30.0, 5.0]);
    let feature = through.finish().unwrap();
    let found = milled(&feature);
    assert_eq!(found.rapid_count, 1, "{:?}", found.rapids);
    assert!((found.rapids[0].depth.value() - 1.0).abs() < 1e-6);
    assert_eq!(found.rapids[0].place.line, 1);
    let said = feature.verdict.reason().unwrap();
    assert!(matches!(feature.verdict, Verdict::Fail { .. }), "{said}");
    let from = "the rapid in line 1 takes T1 (an end mill) 1 mm into the stock at X";
    assert!(said.starts_with(from), "{said}");
    assert!(said.contains(" Y30 Z-1 of G54"), "{said}");

    let mut beside = Mover::new(MillForm::FLAT, 10.0, [-20.0, -5.0, -1.0]);
    beside.rapid([120.0, -5.0, -1.0]);
    assert!(beside.finish().is_none(), "it was not fed");
}

#[test]
fn rapids_are_said_in_the_frame_and_unit_of_their_program() {
    let mut inches = Mover::new(MillForm::FLAT, 10.0, [50.8, 25.4, 5.0]);
    let of_g55 = ProgramFrame {
        unit: canon::LengthUnit::Inch,
        work_offset: 2,
        origin: Position::xyz(25.4, 0.0, 0.0),
        tool: Position::xyz(0.0, 0.0, LENGTH_MM),
        ..ProgramFrame::default()
    };
    inches.milling.frame(1, of_g55);
    for depth in [2.54, 5.08, 7.62, 10.16, 12.7] {
        inches.rapid([50.8, 25.4, -depth]);
        inches.rapid([50.8, 25.4, 5.0]);
    }
    let feature = inches.finish().unwrap();
    let said = feature.verdict.reason().unwrap();
    let first =
        "the rapid in line 1 takes T1 (an end mill) 0.1 in into the stock at X1 Y1 Z-0.1 of G55; ";
    assert!(said.starts_with(first), "{said}");
    assert!(said.contains("Z-0.3 of G55; and 2 more"), "{said}");
}

#[test]
fn a_rapid_back_through_what_was_cut_is_none_and_a_deeper_one_is() {
    let mut mover = slot(MillForm::FLAT, 10.0, 3.0, 30.0);
    mover.rapid([-20.0, 30.0, -3.0]);
    assert_eq!(mover.milling.at.as_ref().unwrap().found.rapid_count, 0);
    mover.rapid([-20.0, 30.0, -3.15]); // scrapes
    mover.rapid([120.0, 30.0, -3.15]);
    mover.rapid([120.0, 30.0, -4.0]);
    mover.rapid([-20.0, 30.0, -4.0]);
    let found = mover.milled();
    assert_eq!(found.rapid_count, 1);
    assert!((found.rapids[0].depth.value() - 1.0).abs() < 0.01, "{:?}", found.rapids);
}

#[test]
fn a_rapid_plunge_is_one_finding_and_the_way_out_is_none() {
    let mut mover = Mover::new(MillForm::FLAT, 10.0, [50.0, 30.0, 5.0]);
    mover.rapid([50.0, 30.0, -6.0]);
    mover.rapid([50.0, 30.0, 5.0]);
    mover.rapid([50.0, 30.0, -6.0]);
    mover.rapid([50.0, 30.0, 5.0]);
    let found = mover.milled();
    assert_eq!(found.rapid_count, 1, "what it went through is gone: {:?}", found.rapids);
    assert!((found.rapids[0].depth.value() - 6.0).abs() < 0.01);
}

#[test]
fn a_large_mill_that_rises_where_its_cut_ends_is_no_finding() {
    let mut mover = Mover::new(MillForm::FLAT, 50.0, [-40.0, 30.0, 5.0]);
    for x in [20.3, 41.7, 63.9] {
        mover.rapid([x, 30.0, 5.0]);
        mover.rapid([x, 30.0, 0.5]);
        mover.feed([x, 30.0, -2.0]);
        mover.rapid([x, 30.0, 5.0]);
        mover.rapid([x, 30.0, -2.0]);
        mover.feed([x + 17.3, 30.0, -2.0]);
        mover.rapid([x + 17.3, 30.0, 5.0]);
    }
    let found = mover.milled();
    assert!(found.cell.unwrap() > Length::mm(1.0));
    assert!(found.rapids.is_empty(), "{:?}", found.rapids);
}

#[test]
fn a_dwell_in_the_cut_changes_no_chip() {
    let chip = |dwells: bool| {
        let mut mover = Mover::new(MillForm::FLAT, 10.0, [-20.0, 30.0, -2.0]);
        for x in [13.3, 41.9, 120.0] {
            mover.feed([x, 30.0, -2.0]);
            if dwells {
                mover.sample.report.state = State::Dwell;
                for _ in 0..500 {
                    mover.look();
                }
            }
        }
        let found = mover.milled();
        (mm(found.chip), found.removal_mm3_per_s.unwrap().value)
    };
    let (with, without) = (chip(true), chip(false));
    assert!((with.0 - without.0).abs() < 1e-3 * without.0, "{with:?} {without:?}");
    assert!((with.1 / without.1 - 1.0).abs() < 0.1, "{with:?} {without:?}");
}

#[test]
fn the_clamped_place_changes_nothing() {
    let at = |zero: [f64; 3]| {
        let mut mover =
            Mover::at(config(tool(1, 10.0, Some(MillForm::FLAT)), zero), zero, [-20.0, 1.0, -2.0]);
        mover.feed([120.0, 1.0, -2.0]);
        mover.milled()
    };
    let (here, there) = (at([0.0; 3]), at([-312.7, 45.3, -118.4]));
    assert!((here.removed_mm3 - there.removed_mm3).abs() < 1e-3 * here.removed_mm3);
    assert!((mm(here.width) - mm(there.width)).abs() < 1e-6);
    let places = [here, there].map(|found| found.depth.unwrap().place.at);
    for (a, b) in places[0].iter().zip(places[1]) {
        assert!((*a - b).abs() < Length::mm(0.3), "{places:?}");
    }
}

#[test]
fn a_cut_with_the_spindle_at_rest_or_backwards_is_wrong() {
    for (spin, said) in [(0.0, "at rest"), (-100.0, "turning backwards")] {
        let mut mover = Mover::new(MillForm::FLAT, 10.0, [-20.0, 30.0, -2.0]);
        mover.spin = spin;
        mover.feed([120.0, 30.0, -2.0]);
        let feature = mover.finish().unwrap();
        assert!(matches!(feature.verdict, Verdict::Fail { .. }));
        let reason = feature.verdict.reason().unwrap();
        assert!(reason.contains(&format!("it cuts with the spindle {said}: line 1")), "{reason}");
    }
}

#[test]
fn what_is_not_known_is_not_judged() {
    let judged = |mover: Mover| mover.finish().unwrap().verdict;
    let reason = |verdict: &Verdict| {
        assert!(matches!(verdict, Verdict::NotJudged { .. }), "{verdict:?}");
        verdict.reason().unwrap().to_owned()
    };
    let cut = |config: Config| {
        let mut mover = Mover::at(config, [0.0; 3], [-20.0, 30.0, -2.0]);
        mover.feed([120.0, 30.0, -2.0]);
        judged(mover)
    };
    let flat = || config(tool(1, 10.0, Some(MillForm::FLAT)), [0.0; 3]);
    let formless = cut(config(tool(1, 10.0, None), [0.0; 3]));
    assert!(reason(&formless).contains("the form of the mill is not known"));
    let nowhere = cut(Config { mill_stock: None, ..flat() });
    assert!(reason(&nowhere).contains("where the material is was not known"));
    assert!(reason(&cut(flat())).contains("states no limit of this mill"));
    let mut assumed = flat();
    assumed.mill_stock.as_mut().unwrap().source = StockSource::Extent;
    let assumed = reason(&cut(assumed));
    assert!(assumed.contains("X 0 to 100, Y 0 to 60, Z -20 to 0 mm of G54"), "{assumed}");
    let mut sized = flat();
    sized.mill_stock.as_mut().unwrap().source = StockSource::Size;
    let sized = reason(&cut(sized));
    assert!(
        sized.contains("where the stock lies is assumed, its size a comment's: X 0"),
        "{sized}"
    );
    let described = Config {
        described_mills: ToolLibrary::new([Tool {
            stand_in: true,
            ..tool(1, 10.0, Some(MillForm::FLAT))
        }]),
        tools: ToolLibrary::default(),
        ..flat()
    };
    let mut mover = Mover::at(flat(), [0.0; 3], [-20.0, 30.0, -2.0]);
    mover.config = described;
    mover.rapid([120.0, 30.0, -2.0]);
    let said = reason(&judged(mover));
    assert!(said.contains("the mill is assumed, by the program's comment"), "{said}");
    assert!(said.contains("if so, the rapid in line 1 takes T1"), "{said}");
    let mut air = Mover::at(flat(), [0.0; 3], [-20.0, 30.0, 2.0]);
    air.feed([120.0, 30.0, 2.0]);
    assert!(reason(&judged(air)).contains("it met no stock"));
    let mut turned = Mover::at(flat(), [0.0; 3], [-20.0, 30.0, -2.0]);
    turned.feed([0.0, 30.0, -2.0]);
    turned.sample.feedback.axes[3].position = Coordinate::new(10.0);
    turned.feed([20.0, 30.0, -2.0]);
    assert!(reason(&judged(turned)).contains("a rotary axis has moved"));
}

#[test]
fn limits_of_the_tool_decide() {
    let with = |limits: MillLimits| {
        let mut limited = tool(1, 10.0, Some(MillForm::FLAT));
        if let ToolKind::EndMill(mill) = &mut limited.kind {
            (mill.limits, mill.body) = (limits, Some(CutterMaterial::Carbide));
        }
        limited.body.stick_out = Some(Length::mm(40.0));
        let mut config = config(limited, [0.0; 3]);
        config.material = Some(canon::Material::Aluminium);
        let mut mover = Mover::at(config, [0.0; 3], [-20.0, 30.0, -2.0]);
        mover.feed([120.0, 30.0, -2.0]);
        mover.finish().unwrap()
    };
    let some = |mm| Some(Length::mm(mm));
    let none = MillLimits::default();
    assert!(with(MillLimits { chip: some(0.12), ..none }).verdict.is_pass());
    let chip = with(MillLimits { chip: some(0.08), ..none }).verdict;
    let said = "the chip of a tooth is 0.1 mm, of 0.08 mm that the tool may have: line 1";
    assert!(chip.reason().unwrap().starts_with(said), "{chip:?}");
    assert!(!with(MillLimits { depth: some(1.5), ..none }).verdict.is_pass());
    // 1300 N/mm² · 2 mm · 0.1 mm, one of two teeth in a slot; F·L³/(3·E·I) with 8 mm
    let bent = with(MillLimits { deflection: some(0.02), ..none });
    let force = milled(&bent).force.unwrap().value.value();
    assert!((force - 260.0).abs() < 1.0, "{force}");
    let stiff = 3.0 * 600_000.0 * PI * 8.0_f64.powi(4) / 64.0;
    let closed = force * 40.0_f64.powi(3) / stiff;
    let found = mm(milled(&bent).deflection);
    assert!((found - closed).abs() < 1e-9 && bent.verdict.is_pass() != (closed > 0.02), "{found}");
}

#[test]
fn a_smaller_mill_gets_finer_cells_and_the_stock_stays_what_it_was() {
    let tools =
        ToolLibrary::new([tool(1, 20.0, Some(MillForm::FLAT)), tool(2, 2.0, Some(MillForm::FLAT))]);
    let config = Config { tools, ..config(tool(1, 20.0, None), [0.0; 3]) };
    let mut mover = Mover::at(config, [0.0; 3], [-20.0, 30.0, -3.0]);
    mover.feed([120.0, 30.0, -3.0]);
    mover.sample.feedback.tool = Some(2);
    mover.at = [-20.0, 30.0, -3.0];
    mover.feed([120.0, 30.0, -3.0]); // in air
    mover.feed([120.0, 30.0, -4.0]);
    mover.feed([-20.0, 30.0, -4.0]);
    assert_eq!(mover.features.len(), 1);
    let second = mover.milled();
    assert!((second.cell.unwrap().value() - 0.05).abs() < 1e-9);
    assert!((mm(second.depth) - 1.0).abs() < 1e-3, "{:?}", second.depth);
    assert!((second.removed_mm3 / (100.0 * 2.0) - 1.0).abs() < 0.03, "{}", second.removed_mm3);
}

#[test]
fn a_large_block_has_no_more_cells_than_are_allowed() {
    let at = |v: [f64; 3]| v.map(Length::mm);
    for to in [[1200.0, 800.0, 18.0], [3000.0, 1.0, 5.0], [0.5, 2000.0, 5.0]] {
        let block = Stock { from: at([0.0; 3]), to: at(to), zero: at([0.0; 3]) };
        let field = Field::new(block, 0.2).unwrap();
        assert!(field.bytes() as f64 <= 1.1 * 4.0 * field::MOST_CELLS, "{to:?} {}", field.bytes());
    }
    let flat = Stock { from: at([0.0; 3]), to: at([0.0, 1.0, 1.0]), zero: at([0.0; 3]) };
    assert!(Field::new(flat, 1.0).is_none());
}
