//! The campaign of stops as one command: what stopped taps, and what became of them, in one table.
//!
//! ```text
//!   crates/kernel/tests/stop_campaign.rs ── SUM|title|cases|recovered|nothing|refused|broken|µm|µm ──► a row of the table
//! ```
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// Of one line of the campaign: cases, recovered, nothing to do, refused, broken; and how far off
/// its thread the tap stood and came out, µm.
struct Row {
    title: String,
    counts: [u64; 5],
    um: [f64; 2],
}

impl Row {
    fn read(line: &str) -> Option<Self> {
        let mut words = line.strip_prefix("SUM|")?.split('|');
        let title = words.next()?.to_owned();
        let mut counts = [0; 5];
        for count in &mut counts {
            *count = words.next()?.parse().ok()?;
        }
        let um = [words.next()?.parse().ok()?, words.next()?.parse().ok()?];
        Some(Self { title, counts, um })
    }

    fn text(&self) -> String {
        let [cases, recovered, nothing, refused, broken] = self.counts;
        let [stop, out] = self.um;
        format!(
            "{:<66} {cases:>6} {recovered:>9} {nothing:>7} {refused:>7} {broken:>6} {stop:>8.1} {out:>8.2}",
            self.title
        )
    }

    fn all(rows: &[Self]) -> Self {
        let mut all = Self { title: "all".into(), counts: [0; 5], um: [0.0; 2] };
        for row in rows {
            all.absorb(row);
        }
        all
    }

    fn absorb(&mut self, other: &Self) {
        for (all, of) in self.counts.iter_mut().zip(other.counts) {
            *all += of;
        }
        self.um = [self.um[0].max(other.um[0]), self.um[1].max(other.um[1])];
    }
}

/// One more; those of one title are one row.
fn add(rows: &mut Vec<Row>, row: Row) {
    match rows.iter_mut().find(|other| other.title == row.title) {
        Some(other) => other.absorb(&row),
        None => rows.push(row),
    }
}

/// Run it; whether every case ended as promised.
pub(crate) fn run(full: bool) -> Result<bool, String> {
    let (every, cases) = if full { ("1", "2000") } else { ("20", "200") };
    let mut tests = Command::new(env!("CARGO"))
        .args(["test", "--release", "-p", "kernel", "--test", "all", "stop_campaign::"])
        .args(["--", "--ignored", "--nocapture"])
        .env("STOPS_EVERY_MS", every)
        .env("STOPS_AT_RANDOM", cases)
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|e| format!("cargo: {e}"))?;
    let said = tests.stdout.take().ok_or("the campaign says nothing")?;
    let mut rows = Vec::new();
    for line in BufReader::new(said).lines() {
        let line = line.map_err(|e| format!("the campaign: {e}"))?;
        // the first line of a test comes behind its name
        match line.find("SUM|").and_then(|at| Row::read(&line[at..])) {
            Some(row) => add(&mut rows, row),
            None => println!("{line}"),
        }
    }
    let good = tests.wait().map_err(|e| format!("cargo: {e}"))?.success();
    rows.sort_by(|a, b| a.title.cmp(&b.title));
    println!(
        "\n{:<66} {:>6} {:>9} {:>7} {:>7} {:>6} {:>8} {:>8}",
        "M8x1.25, 20 mm, 1000 rpm; at random M3 to M16",
        "cases",
        "recovered",
        "nothing",
        "refused",
        "broken",
        "stop \u{b5}m",
        "out \u{b5}m"
    );
    for row in &rows {
        println!("{}", row.text());
    }
    println!("{}", Row::all(&rows).text());
    println!(
        "\nnothing: the tap stood over the work, or went on to its end. broken: a tap that broke, stayed in, left its thread by more than 20 \u{b5}m \
         or spoilt a thread that was in class; in a stop with the drives alive, more than 10 \u{b5}m."
    );
    Ok(good && !rows.is_empty())
}

#[cfg(test)]
mod tests {
    use super::Row;

    #[test]
    fn a_line_of_the_campaign_is_a_row() {
        let row = Row::read("SUM|kill each 1 ms, left hand|10|7|2|1|0|20.01|0.59").unwrap();
        assert_eq!((row.counts, row.um), ([10, 7, 2, 1, 0], [20.01, 0.59]));
        assert!(Row::read("SUM|kill|10|7").is_none() && Row::read("kill").is_none());
        let all = Row::all(&[row, Row::read("SUM|b|1|0|0|0|1|3|30").unwrap()]);
        assert_eq!((all.counts, all.um), ([11, 7, 2, 1, 1], [20.01, 30.0]));
    }
}
