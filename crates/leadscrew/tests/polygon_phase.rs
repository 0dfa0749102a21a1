//! The angle R of G51.2 turns a polygon and leaves it as flat as it was: what swings counts from
//! the middle of the facet. Computed by plain trigonometry from what the drives are sent.
use canon::{Harmonic, OpKind, Oscillating, Oscillation, Polygon, ToolKind};
use control::job::ProgramOptions;
use leadscrew::Program;
use std::f64::consts::TAU;

/// A cutter among work, all in mm and turns.
struct Cut {
    polygon: Polygon,
    centres: f64,
    radius: f64,
    inserts: Vec<f64>,
}

/// What a program orders.
fn cut(begin: &str, tool: u32, x: f64) -> Cut {
    let text = format!(
        "G21 G90 G94 G17\nT{tool} M6\nG43 H{tool}\nG0 X90 Y0 Z5\nM3 S60\n{begin}\nG0 X{x} Z2\nG1 Z-5 F50\nG0 X90\nG50.2\nM5\nM30\n"
    );
    let options = ProgramOptions::on("polygon-lathe");
    let mut job = Program::of("polygon.ngc", text).on(options).unwrap();
    let findings = job.check();
    assert!(findings.iter().all(|finding| !finding.is_error()), "{begin}: {findings:?}");
    let operations = job.operations();
    let found = operations.all().iter().find_map(|op| match &op.kind {
        OpKind::Polygon(polygon) => Some(polygon.clone()),
        _ => None,
    });
    let ToolKind::PolygonCutter(cutter) = &job.session.tools.get(tool).unwrap().kind else {
        panic!("T{tool} is a polygon cutter")
    };
    Cut {
        polygon: found.unwrap(),
        centres: x,
        radius: cutter.radius.value(),
        inserts: cutter.inserts.iter().map(|insert| insert.value()).collect(),
    }
}

/// A sum of harmonics where the work stands.
fn sum(harmonics: &[Harmonic], work: f64, period: f64) -> f64 {
    let term = |h: &Harmonic| {
        let angle = TAU * f64::from(h.per_turn) * work / period;
        h.cosine * angle.cos() + h.sine * angle.sin()
    };
    harmonics.iter().map(term).sum()
}

impl Cut {
    /// What shall come at the tool, by the work's angle.
    fn swing(&self, on: Oscillating, work: f64) -> f64 {
        let Polygon { oscillations, wanted, .. } = &self.polygon;
        let all: &[Oscillation] = if wanted.is_empty() { oscillations } else { wanted };
        let of_it = all.iter().filter(|oscillation| oscillation.on == on);
        let values = of_it.map(|oscillation| {
            let by_work = self.polygon.by_work(&oscillation.harmonics);
            sum(&by_work, work, self.polygon.period())
        });
        values.sum()
    }

    /// Tip of an insert in the work's own frame.
    fn tip(&self, insert: f64, work: f64) -> [f64; 2] {
        let ratio = self.polygon.ratio.value();
        let phase = self.polygon.phase.value() + self.swing(Oscillating::ToolPhase, work);
        let tool = TAU * (ratio * work + phase + insert);
        let x = self.centres + self.swing(Oscillating::Axis(canon::Axis::X), work)
            - self.radius * tool.cos();
        let y = self.swing(Oscillating::Axis(canon::Axis::Y), work) - self.radius * tool.sin();
        let (sine, cosine) = (TAU * work).sin_cos();
        [x * cosine + y * sine, y * cosine - x * sine]
    }

    /// Out-of-flat of the worst facet, µm: highest less lowest about its own line.
    fn flatness_um(&self) -> f64 {
        let ratio = self.polygon.ratio.value();
        let turns = self.polygon.period().round();
        let passes = (ratio * turns).round();
        let sides = passes * self.inserts.len() as f64 / turns;
        let half = (self.centres - self.radius) * (std::f64::consts::PI / sides).tan();
        let mut worst = 0.0_f64;
        for insert in &self.inserts {
            for pass in 0..passes as i32 {
                // here the insert points at the work's axis
                let middle = (f64::from(pass) - self.polygon.phase.value() - insert) / ratio;
                let (sine, cosine) = (TAU * middle).sin_cos();
                let points = (-400..=400).filter_map(|step| {
                    let [x, y] = self.tip(*insert, middle + f64::from(step) / 400.0 / ratio / 8.0);
                    let (out, along) = (x * cosine - y * sine, x * sine + y * cosine);
                    (along.abs() <= half).then_some([along, out])
                });
                worst = worst.max(zone(&points.collect::<Vec<_>>()));
            }
        }
        worst * 1e3
    }
}

/// Highest less lowest about the line of least squares.
fn zone(points: &[[f64; 2]]) -> f64 {
    let count = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / count;
    let (s, h) = (mean(0), mean(1));
    let slope = points.iter().map(|p| (p[0] - s) * (p[1] - h)).sum::<f64>()
        / points.iter().map(|p| (p[0] - s).powi(2)).sum::<f64>();
    let off = points.iter().map(|p| p[1] - h - slope * (p[0] - s));
    let (low, high) =
        off.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

#[test]
fn what_swings_counts_from_the_middle_of_the_facet_whatever_r_is() {
    // three inserts and two, either sense of the tool's lead, one turn and two
    let cases = [
        ("G51.2 P1 Q2 R# D1", 21, 58.5, 0.4),
        ("G51.2 P1 Q2 R# D2", 21, 58.5, 0.4),
        ("G51.2 P1 Q2 R# D4", 21, 58.5, 0.4),
        ("G51.2 P1 Q2 R# D6", 21, 58.5, 0.4),
        ("G51.2 P1 Q2 R# D4", 22, 65.0, 0.4),
        ("G51.2 P2 Q5 R# D4", 22, 65.0, 0.4),
        ("G51.2 P1 Q2 R# I0.0009", 21, 58.5, f64::INFINITY),
        ("G51.2 P1 Q2 R# J0.002", 21, 58.5, f64::INFINITY),
        ("G51.2 P1 Q2 R# K0.35", 21, 58.5, f64::INFINITY),
        ("G51.3 L6 A0.05 B0.3\nG51.2 P1 Q2 R#", 21, 58.5, f64::INFINITY),
    ];
    for (begin, tool, x, most) in cases {
        let of = |r: i32| cut(&begin.replace('#', &r.to_string()), tool, x);
        let mut cut = of(0);
        let flat = cut.flatness_um();
        println!("{begin}: {flat} µm");
        assert!(flat < most, "{begin}: {flat} µm");
        for r in (5..360).step_by(5) {
            cut.polygon.phase = units::Angle::deg(f64::from(r));
            let turned = cut.flatness_um();
            assert!((turned - flat).abs() < 1e-3, "{begin} at R{r}: {turned} for {flat} µm");
        }
        // and what the program itself orders there is that
        let turned = of(60).flatness_um();
        assert!((turned - flat).abs() < 1e-3, "{begin}: {turned} for {flat} µm");
    }
}
