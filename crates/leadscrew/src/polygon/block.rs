//! The block that cuts a design, and what stands around it.
use super::{CANDIDATES, Design, SolvedMotion, refuse};
use control::polygon::oscillation::NOT_WORTH_MM;
use forms::polygon::{Actuator, Solution, Term};
use std::collections::BTreeSet;
use units::{Length, Spin};

/// The word D of G51.2 for each of the candidates.
const D: [u32; CANDIDATES.len()] = [4, 2, 1, 3, 5, 6];

/// Harmonics that a person reads.
const READABLE: usize = 16;

impl Design {
    /// The block to use, and what stands around it; what would be a page of harmonics is left to
    /// the control.
    pub fn gcode(&self, way: &SolvedMotion) -> String {
        let written = self.program(&way.solution, self.work, self.length, None);
        let count = written.lines().filter(|line| line.starts_with("G51.3")).count();
        if count <= READABLE || self.harmonics.is_some() {
            return written + "M30\n";
        }
        self.short_program(way.name) + "M30\n"
    }

    /// What cuts it with this oscillation, and measures it in the air afterwards if so asked.
    pub(super) fn program(
        &self,
        solution: &Solution,
        work: Spin,
        length: Length,
        looks: Option<u32>,
    ) -> String {
        let Self { form, .. } = self;
        let mut text = self.before(work);
        let series = &solution.command.0;
        let turns = f64::from(form.turns[1]);
        let periods = |term: &Term| (term.per_turn * turns).round() as u32;
        let all: BTreeSet<u32> = series.iter().flat_map(|s| s.terms.iter().map(periods)).collect();
        // what is rounded of a few hundred harmonics adds up
        let many = usize::from(all.len() > READABLE);
        for count in all {
            let mut line = String::new();
            // jerk counts a harmonic by the cube of its number
            let number = (f64::from(count) / turns / form.base()).max(1.0);
            let decimals = 6 + many + (3.0 * number.log10()).ceil() as usize;
            let least = 0.5 * 10_f64.powf(-(decimals as f64));
            for one in series {
                let Some(term) = one.terms.iter().find(|term| periods(term) == count) else {
                    continue;
                };
                if !one.swings() && term.cosine.abs() <= NOT_WORTH_MM {
                    continue;
                }
                let (letters, factor) = match one.actuator {
                    Actuator::CentreLine => (['X', 'I'], 1.0),
                    Actuator::Across => (['Y', 'J'], 1.0),
                    Actuator::ToolPhase => (['A', 'B'], 360.0),
                };
                for (letter, value) in letters.into_iter().zip([term.cosine, term.sine]) {
                    if (value * factor).abs() > least {
                        line += &format!(" {letter}{:.decimals$}", value * factor);
                    }
                }
            }
            if !line.is_empty() {
                text += &format!("G51.3 L{count}{line}\n");
            }
        }
        let looks = looks.map_or_else(String::new, |n| format!("G51.4 P{n}\n"));
        text + &self.cut("", form.centres(), work, length, &looks)
    }

    /// What cuts it with an oscillation that the control computes, of what goes by this name.
    pub fn short_program(&self, name: &str) -> String {
        let measured = if self.phases.swung.is_empty() { "" } else { " E1" };
        let by = CANDIDATES.iter().zip(D).find(|(c, _)| c.0 == name).map_or(0, |(_, d)| d);
        let by = format!(" D{by}{measured}");
        self.before(self.work) + &self.cut(&by, self.form.centres(), self.work, self.length, "")
    }

    /// The cutter clear of the bar, the work turning.
    fn before(&self, work: Spin) -> String {
        let (tool, clear) = (self.tool, refuse::clear(&self.form).value());
        let (rpm, radius) = (work.in_rpm(), self.form.tip_radius.value());
        let inserts = self.form.inserts.iter().map(|insert| format!("{:.1}", insert.in_deg()));
        let inserts: Vec<String> = inserts.collect();
        let enter = self.to_enter.as_ref().map_or_else(String::new, |why| {
            let lines = [
                why.clone(),
                "[[tool]]".to_owned(),
                format!("number = {tool}"),
                "kind = \"polygon-cutter\"".to_owned(),
                format!("tip_radius_mm = {radius:.3}"),
                format!("insert_angles_deg = [{}]", inserts.join(", ")),
                "nose_radius_mm = 0.8".to_owned(),
                "length_mm = 60.0".to_owned(),
            ];
            lines.map(|line| format!("({line})\n")).concat()
        });
        let inserts = inserts.join(" ");
        format!(
            "(T{tool}: tip radius {radius:.3} mm, inserts at {inserts} degrees)\n{enter}\
             G21 G90 G94 G17 G54\nT{tool} M6\nG43 H{tool}\nG0 X{clear:.4} Y0 Z5\nM3 S{rpm:.0}\n"
        )
    }

    /// Geared up, cut with the axes this far apart, and off again.
    fn cut(&self, by: &str, x: Length, work: Spin, length: Length, looks: &str) -> String {
        let [tool, turns] = self.form.turns;
        format!(
            "G51.2 P{turns} Q{tool} R0{by}\nG0 X{:.4} Z2\nG1 Z{:.3} F{:.1}\nG0 X{:.4}\n{looks}G50.2\nM5\n",
            x.value(),
            -length.value(),
            self.feed_per_rev.value() * work.in_rpm(),
            refuse::clear(&self.form).value()
        )
    }
}
