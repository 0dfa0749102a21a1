//! What is told of a design: table, G-code, JSON and page.
use super::{CANDIDATES, Design, Way};
use crate::tables::table;
use comfy_table::Cell;
use forms::polygon::{Actuator, Swings};
use report::PolygonPlan;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use units::{Angle, Length, Spin};

/// Speeds of the picture.
const SPEEDS: u32 = 16;

/// Everything that is told.
pub(super) struct Told<'d> {
    pub(super) design: &'d Design,
    pub(super) ways: &'d [Way],
    pub(super) best: &'d Way,
    /// At which it is as flat as wanted, if a flatness is wanted and it is ever reached.
    pub(super) fastest: Option<Spin>,
}

impl Told<'_> {
    pub(super) fn text(&self) -> String {
        let mut rows =
            table(["swings", "flatness", "largest swing", "acceleration", "drive", "limited by"]);
        for row in self.rows() {
            rows.add_row(row.into_iter().map(Cell::new).collect::<Vec<_>>());
        }
        let words = self.words().join("\n");
        format!("{words}\n{rows}\n\n{}", self.gcode())
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
                "{} sides, {:.3} mm across flats, corners of {:.2}° ({:.3} mm across), on {}: {} inserts on {:.3} mm, {}:{}, axes {:.3} mm apart",
                self.sides(),
                form.across_flats.value(),
                self.corner().in_deg(),
                2.0 * form.corner_radius().value(),
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
        if !self.design.swings() {
            let r = form.centres().value() / (form.ratio() - 1.0).powi(2);
            words.push(format!(
                "the passes, {:.2} a turn, do not repeat with the work's turn, so nothing can swing with it; a tip radius of {r:.3} mm at this distance is flat to second order by itself",
                form.base()
            ));
        }
        if let Some(wanted) = self.design.wanted {
            words.push(match self.fastest {
                Some(spin) => format!(
                    "{:.2} µm by {} up to {:.0} rpm",
                    wanted.in_um(),
                    self.best.name,
                    spin.in_rpm()
                ),
                None => format!(
                    "{:.2} µm is not reached by {} at any speed: {:.2} µm is, at {:.0} rpm",
                    wanted.in_um(),
                    self.best.name,
                    self.best.solution.flatness.in_um(),
                    work.in_rpm()
                ),
            });
        }
        words
    }

    fn rows(&self) -> Vec<[String; 6]> {
        self.ways
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

    /// The block to use, and what stands around it.
    fn gcode(&self) -> String {
        let Design { form, length, feed_per_rev, work, tool, .. } = self.design;
        // so much closer as the swing leaves the facets farther out
        let x = form.centres() - self.best.solution.offset;
        let clear = form.tip_radius + form.stock_radius + Length::mm(2.0);
        let mut text = format!(
            "T{tool} M6\nG43 H{tool}\nG0 X{:.4} Y0 Z5\nM3 S{:.0}\n",
            clear.value(),
            work.in_rpm()
        );
        let series = &self.best.solution.command.0;
        for h in 0..self.design.harmonics {
            let mut line = String::new();
            for one in series {
                let Some(term) = one.terms.get(h) else { continue };
                let (letters, factor, least) = match one.actuator {
                    Actuator::CentreLine => (['X', 'I'], 1.0, 5e-7),
                    Actuator::Across => (['Y', 'J'], 1.0, 5e-7),
                    Actuator::ToolPhase => (['A', 'B'], 360.0, 5e-7),
                };
                for (letter, value) in letters.into_iter().zip([term.cosine, term.sine]) {
                    if (value * factor).abs() > least {
                        line += &format!(" {letter}{:.6}", value * factor);
                    }
                }
            }
            if !line.is_empty() {
                let per_turn = (form.base() * (h + 1) as f64).round();
                text += &format!("G51.3 L{per_turn:.0}{line}\n");
            }
        }
        text += &format!(
            "G51.2 P{} Q{} R0\nG0 X{:.4} Z2\nG1 Z{:.3} F{:.1}\nG0 X{:.4}\nG50.2\nM5\n",
            form.turns[1],
            form.turns[0],
            x.value(),
            -length.value(),
            feed_per_rev.value() * work.in_rpm(),
            clear.value()
        );
        text
    }

    pub(super) fn json(&self) -> Value {
        let Design { form, machine, work, .. } = self.design;
        let ways = self.ways.iter().map(|way| {
            let series = way.solution.command.0.iter().map(|s| {
                let terms = s.terms.iter().map(|t| json!([t.per_turn, t.cosine, t.sine]));
                json!({ "actuator": s.actuator.name(), "terms": terms.collect::<Vec<_>>() })
            });
            json!({
                "swings": way.name,
                "chosen": std::ptr::eq(way, self.best),
                "flatness_um": way.solution.flatness.in_um(),
                "offset_um": way.solution.offset.in_um(),
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
            "fastest_rpm": self.fastest.map(Spin::in_rpm),
            "ways": ways.collect::<Vec<_>>(),
            "gcode": self.gcode(),
        })
    }

    pub(super) fn page(&self) -> PolygonPlan {
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
        let kind = form.kinds();
        let profile = |swings: &Swings| -> Vec<(f64, f64)> {
            let Some(facet) = kind.first() else { return Vec::new() };
            let found = form.profile(facet, swings);
            found.points.iter().map(|p| (p[0].value(), p[1].in_um())).collect()
        };
        PolygonPlan {
            title: format!(
                "{} sides, {:.3} mm across flats",
                facets.len(),
                form.across_flats.value()
            ),
            words: self.words(),
            heads: ["swings", "flatness", "largest swing", "acceleration", "drive", "limited by"]
                .map(str::to_owned)
                .to_vec(),
            rows: self.rows().into_iter().map(|row| row.to_vec()).collect(),
            tips: tips.collect(),
            stock_radius: form.stock_radius.value(),
            outline,
            profiles: vec![
                ("without oscillation".to_owned(), profile(&Swings::default())),
                (format!("by {}", self.best.name), profile(swings)),
            ],
            speeds: self.speeds(),
            wanted: self.design.wanted.map(Length::in_um),
            gcode: self.gcode(),
        }
    }

    fn speeds(&self) -> Vec<report::Named> {
        let most = self.design.work.in_rpm().max(500.0) * 2.0;
        let [work, tool] = [0, 1].map(|i| self.design.machine.spindles[i].max.in_rpm());
        let most = most.min(work).min(tool / self.design.form.ratio());
        let at = |i: u32| 50.0 + (most - 50.0) * f64::from(i) / f64::from(SPEEDS - 1);
        let still = self.design.form.flatness(&Swings::default()).in_um();
        let without = ("without".to_owned(), (0..SPEEDS).map(|i| (at(i), still)).collect());
        let ways = self.ways.iter().filter_map(|way| {
            let (name, who) = CANDIDATES.iter().find(|c| c.0 == way.name)?;
            let line = (0..SPEEDS).filter_map(|i| {
                let way = self.design.solve(name, who, Spin::rpm(at(i)))?;
                Some((at(i), way.solution.flatness.in_um()))
            });
            Some(((*name).to_owned(), line.collect()))
        });
        ways.chain([without]).collect()
    }
}
