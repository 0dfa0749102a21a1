//! `leadscrew polygon`: from the form wanted to the block that cuts it; table, G-code, JSON and
//! page.
use crate::args::{Format, PolygonArgs};
use crate::tables::table;
use crate::{progress, say};
use comfy_table::Cell;
use control::Refused;
use control::config::machine_file::MachineSource;
use control::polygon::CANDIDATES;
use forms::polygon::{Actuator, Detail, Facet, Swings};
use leadscrew::polygon::{
    Aim, Design, Designed, PolygonOptions, Progress, Proof, SolvedMotion, design,
};
use report::{PolygonPlan, Side};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use units::{Angle, Length, Spin};

/// Speeds of the picture.
const SPEEDS: u32 = 9;

/// Heads of the table of what was cut.
const PROVED: [&str; 9] = [
    "work",
    "swings",
    "claimed",
    "servo error",
    "cut, uncompensated",
    "cut, compensated",
    "across flats",
    "tilt",
    "limited by",
];

/// Do it.
pub(crate) fn command(args: &PolygonArgs, quiet: bool) -> Result<(), Refused> {
    let bar = progress::Progress::new(1, "cutting (simulated)");
    let designed = design(&options(args), &mut |told| match told {
        Progress::Runs(runs) => bar.set_length(runs.max(1)),
        Progress::Run => bar.inc(1),
    })?;
    drop(bar);
    let told =
        Told { design: &designed.design, best: &designed.ways[designed.best], all: &designed };
    if let Some(out) = &args.out {
        let page = report::polygon_html(&told.page());
        store::output::write_file(out, page.as_bytes())?;
    }
    match args.format {
        Format::Json => say::out(&format!("{:#}\n", told.json())),
        Format::Text if quiet => Ok(()),
        Format::Text => {
            let report = args.out.as_ref();
            let written = report.map_or(String::new(), |out| format!("page: {}\n", out.display()));
            say::out(&(told.text() + &written))
        }
    }
}

/// The same for programs, on this machine.
pub(crate) fn answer(args: &PolygonArgs, machine: MachineSource) -> Result<Value, Refused> {
    let designed = design(&PolygonOptions { machine, ..options(args) }, &mut |_| ())?;
    let told =
        Told { design: &designed.design, best: &designed.ways[designed.best], all: &designed };
    Ok(told.json())
}

fn options(args: &PolygonArgs) -> PolygonOptions {
    PolygonOptions {
        machine: (&args.machine).into(),
        sides: args.sides,
        insert_angles: args.insert_angles.clone(),
        inserts: args.inserts,
        across_flats: args.across_flats,
        tip_radius: args.tip_radius,
        ratio: args.ratio.clone(),
        stock: args.stock,
        speed: args.speed,
        flatness: args.flatness,
        actuator: args.actuator.into(),
        harmonics: args.harmonics,
        phase_table: args.phase_table.clone(),
        length: args.length,
        feed: args.feed,
        tool: args.tool,
        tools: args.tools.clone(),
        internal: args.internal,
        simulate: args.simulate,
    }
}

/// Everything that is told.
struct Told<'d> {
    all: &'d Designed,
    design: &'d Design,
    best: &'d SolvedMotion,
}

impl Told<'_> {
    fn text(&self) -> String {
        let mut rows = table([
            "oscillating axis",
            "flatness",
            "amplitude",
            "acceleration",
            "drive",
            "limited by",
        ]);
        for row in self.rows() {
            rows.add_row(row.into_iter().map(Cell::new).collect::<Vec<_>>());
        }
        let words = self.words().join("\n");
        let proved = if self.all.proofs.is_empty() {
            String::new()
        } else {
            let mut rows = table(PROVED);
            for row in self.proved() {
                rows.add_row(row.into_iter().map(Cell::new).collect::<Vec<_>>());
            }
            format!("\ncut on the simulated machine:\n{rows}\n")
        };
        let claimed = self.claimed();
        format!("{words}\n{rows}\n{proved}\n{claimed}\n\n{}", self.design.gcode(self.best))
    }

    /// What the block below is claimed to cut.
    fn claimed(&self) -> String {
        match &self.all.claim {
            Ok(claim) => claim.words(),
            Err(why) => format!("the block below is refused as it stands: {why}"),
        }
    }

    /// A row for each speed that was run.
    fn proved(&self) -> Vec<[String; 9]> {
        let um = |x: Length| format!("{:.3} µm", x.in_um());
        let row = |p: &Proof| {
            [
                format!("{:.0} rpm", p.spin.in_rpm()),
                p.name.to_owned(),
                um(p.claim.cut.flatness),
                um(p.claim.servo.flatness),
                um(p.sent.flatness),
                um(p.compensated.flatness),
                format!("{:+.1} µm", p.compensated.size.in_um()),
                format!("{:+.4}°", p.compensated.tilt.in_deg()),
                p.binding.clone().unwrap_or_default(),
            ]
        };
        self.all.proofs.iter().map(row).collect()
    }

    fn sides(&self) -> usize {
        self.design.form.facets().len()
    }

    /// Angle at the corners: the sharpest.
    fn corner(&self) -> Angle {
        let facets = self.design.form.facets();
        let normals: Vec<f64> =
            facets.iter().map(|f| (-f.centre.value()).rem_euclid(1.0)).collect();
        let next = |k: usize| normals[(k + 1) % normals.len()];
        let turn = |k: usize| (next(k) - normals[k]).rem_euclid(1.0);
        let sharpest = (0..normals.len()).map(turn).fold(0.0, f64::max);
        Angle::rev(0.5 - sharpest)
    }

    fn words(&self) -> Vec<String> {
        let Design { form, machine, work, .. } = self.design;
        let none = form.flatness(&Swings::default());
        let mut words = vec![
            format!(
                "{} sides, {:.3} mm across flats, {}, on {}: {} inserts on {:.3} mm, {}:{}, axes {:.3} mm apart",
                self.sides(),
                form.across_flats.value(),
                match self.sides() {
                    0..=2 => "no corners".to_owned(),
                    _ => format!(
                        "corners of {:.2}° ({:.3} mm across)",
                        self.corner().in_deg(),
                        2.0 * form.corner_radius().value()
                    ),
                },
                machine.name,
                form.inserts.len(),
                form.tip_radius.value(),
                form.turns[1],
                form.turns[0],
                form.centres().value()
            ),
            format!(
                "without oscillation flat to {:.2} µm; at {:.0} rpm:",
                none.in_um(),
                work.in_rpm()
            ),
        ];
        if let Some((fastest, Aim { flatness, whose })) = &self.all.aim {
            let (flatness, name) = (flatness.in_um(), self.best.name);
            words.push(match fastest {
                Some(spin) => {
                    format!("{flatness:.2} µm, {whose}, by {name} up to {:.0} rpm", spin.in_rpm())
                }
                None => format!(
                    "{flatness:.2} µm, {whose}, is not reached by {name} at any speed: {:.2} µm is, at {:.0} rpm",
                    self.best.solution.flatness.in_um(),
                    work.in_rpm()
                ),
            });
        }
        words
    }

    fn rows(&self) -> Vec<[String; 6]> {
        self.all
            .ways
            .iter()
            .map(|way| {
                let who = CANDIDATES.iter().find(|c| c.0 == way.name).map_or(&[][..], |c| c.1);
                let each = |of: &dyn Fn(Actuator, &[f64; 5]) -> String| {
                    let peaks = who.iter().zip(&way.solution.peaks);
                    peaks.map(|(a, p)| of(*a, p)).collect::<Vec<_>>().join(", ")
                };
                let chosen = if std::ptr::eq(way, self.best) { "▸ " } else { "  " };
                [
                    format!("{chosen}{}", way.name),
                    format!("{:.3} µm", way.solution.flatness.in_um()),
                    each(&|a, p| match a {
                        Actuator::ToolPhase => format!("{:.4}°", p[0] * 360.0),
                        _ => format!("{:.4} mm", p[0]),
                    }),
                    each(&|a, p| match a {
                        Actuator::ToolPhase => format!("{:.0} rad/s²", p[2] * TAU),
                        _ => format!("{:.2} m/s²", p[2] * 1e-3),
                    }),
                    each(&|a, p| match a {
                        Actuator::ToolPhase => format!("{:.2} N·m", p[4]),
                        _ => format!("{:.0} N", p[4]),
                    }),
                    way.solution.binding.clone().unwrap_or_default(),
                ]
            })
            .collect()
    }

    fn json(&self) -> Value {
        let Design { form, machine, work, .. } = self.design;
        let ways = self.all.ways.iter().map(|way| {
            let series = way.solution.command.0.iter().map(|s| {
                let terms = s.terms.iter().map(|t| json!([t.per_turn, t.cosine, t.sine]));
                json!({ "actuator": s.actuator.name(), "terms": terms.collect::<Vec<_>>() })
            });
            json!({
                "swings": way.name,
                "chosen": std::ptr::eq(way, self.best),
                "flatness_um": way.solution.flatness.in_um(),
                "limited_by": way.solution.binding,
                "peaks": way.solution.peaks,
                "series": series.collect::<Vec<_>>(),
            })
        });
        json!({
            "machine": machine.name,
            "sides": self.sides(),
            "across_flats_mm": form.across_flats.value(),
            "corner_angle_deg": self.corner().in_deg(),
            "centre_distance_mm": form.centres().value(),
            "rpm": work.in_rpm(),
            "flatness_without_um": form.flatness(&Swings::default()).in_um(),
            "flatness_um": self.best.solution.flatness.in_um(),
            "simulated": self.all.proofs.iter().map(|p| json!({
                "rpm": p.spin.in_rpm(),
                "swings": p.name,
                "claimed_um": p.claim.cut.flatness.in_um(),
                "servo_error_um": p.claim.servo.flatness.in_um(),
                "flatness_um": p.sent.flatness.in_um(),
                "flatness_compensated_um": p.compensated.flatness.in_um(),
                "across_flats_error_um": p.compensated.size.in_um(),
                "tilt_deg": p.compensated.tilt.in_deg(),
                "limited_by": p.binding,
            })).collect::<Vec<_>>(),
            "fastest_rpm": self.all.aim.as_ref().and_then(|aim| aim.0).map(Spin::in_rpm),
            "ways": ways.collect::<Vec<_>>(),
            "claim": self.all.claim.as_ref().ok().map(|claim| json!({
                "flatness_um": claim.cut.flatness.in_um(),
                "flatness_as_ordered_um": claim.as_ordered.flatness.in_um(),
                "across_flats_mm": claim.cut.across_flats.value(),
                "servo_error_um": claim.servo.flatness.in_um(),
                "across_flats_error_um": claim.servo.across_flats.in_um(),
                "flatness_at_most_um": claim.flatness_at_most().in_um(),
            })),
            "refused": self.all.claim.as_ref().err(),
            "gcode": self.design.gcode(self.best),
        })
    }

    fn page(&self) -> PolygonPlan {
        let Design { form, .. } = self.design;
        let facets = form.facets();
        let d = form.across_flats.value() / 2.0;
        let mut outline: Vec<(f64, f64)> = facets
            .iter()
            .flat_map(|f| {
                let (sine, cosine) = (-f.centre).in_rad().sin_cos();
                [f.from, f.to]
                    .map(|s| (d * cosine - s.value() * sine, d * sine + s.value() * cosine))
            })
            .collect();
        outline.dedup_by(|a, b| (a.0 - b.0).hypot(a.1 - b.1) < 1e-6);
        let closed = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).hypot(a.1 - b.1) < 1e-6;
        if outline.len() > 1 && closed(&outline[0], &outline[outline.len() - 1]) {
            outline.pop();
        }
        outline.extend(outline.first().copied());
        let cutter = form.cutter();
        let swings = &self.best.solution.actual;
        let tips = form.inserts.iter().map(|insert| {
            let steps = 1440 * form.turns[1];
            (0..=steps)
                .map(|i| {
                    let work =
                        Angle::rev(f64::from(i) * f64::from(form.turns[1]) / f64::from(steps));
                    let tip = cutter.tip(work, *insert, swings.at(work));
                    (tip.x.value(), tip.y.value())
                })
                .collect()
        });
        let profile = |facet: &Facet, swings: &Swings| -> Vec<(f64, f64)> {
            let found = form.profile(facet, swings);
            found.points.iter().map(|p| (p[0].value(), p[1].in_um())).collect()
        };
        let sides = |swings: &Swings| -> Vec<Side> {
            let side = |facet: &Facet| Side {
                normal_rad: (-facet.centre).in_rad(),
                distance: d,
                profile: profile(facet, swings),
            };
            facets.iter().map(side).collect()
        };
        PolygonPlan {
            title: format!(
                "{} sides, {:.3} mm across flats",
                facets.len(),
                form.across_flats.value()
            ),
            words: self.words().into_iter().chain([self.claimed()]).collect(),
            heads: [
                "oscillating axis",
                "flatness",
                "amplitude",
                "acceleration",
                "drive",
                "limited by",
            ]
            .map(str::to_owned)
            .to_vec(),
            rows: self.rows().into_iter().map(|row| row.to_vec()).collect(),
            tips: tips.collect(),
            stock_radius: form.stock_radius.value(),
            outline,
            sides: vec![
                ("without oscillation".to_owned(), sides(&Swings::default())),
                (format!("by {}", self.best.name), sides(swings)),
            ],
            speeds: self.speeds(),
            proved_heads: PROVED.map(str::to_owned).to_vec(),
            proved: self.proved().into_iter().map(|row| row.to_vec()).collect(),
            proved_speeds: self.proved_speeds(),
            wanted: self.design.wanted.map(Length::in_um),
            gcode: self.design.gcode(self.best),
        }
    }

    fn proved_speeds(&self) -> Vec<report::Named> {
        let line = |of: fn(&Proof) -> Length| {
            self.all.proofs.iter().map(|p| (p.spin.in_rpm(), of(p).in_um())).collect::<Vec<_>>()
        };
        if self.all.proofs.is_empty() {
            return Vec::new();
        }
        vec![
            ("compensated".to_owned(), line(|p| p.compensated.flatness)),
            ("as computed, uncompensated".to_owned(), line(|p| p.sent.flatness)),
            ("claimed".to_owned(), line(|p| p.claim.cut.flatness)),
        ]
    }

    fn speeds(&self) -> Vec<report::Named> {
        let most = self.design.work.in_rpm().max(500.0) * 2.0;
        let [work, tool] = [0, 1].map(|i| self.design.machine.spindles[i].max.in_rpm());
        let most = most.min(work).min(tool / self.design.form.ratio());
        let at = |i: u32| 50.0 + (most - 50.0) * f64::from(i) / f64::from(SPEEDS - 1);
        let still = self.design.form.flatness(&Swings::default()).in_um();
        let without = ("without".to_owned(), (0..SPEEDS).map(|i| (at(i), still)).collect());
        let ways = self.all.ways.iter().filter_map(|way| {
            let (name, who) = CANDIDATES.iter().find(|c| c.0 == way.name)?;
            let line = (0..SPEEDS).filter_map(|i| {
                let Design { phases, .. } = self.design;
                let way = self.design.solve(name, who, Spin::rpm(at(i)), phases, Detail::Drawn)?;
                Some((at(i), way.solution.flatness.in_um()))
            });
            Some(((*name).to_owned(), line.collect()))
        });
        ways.chain([without]).collect()
    }
}
