//! Attacks on the verdict: small programs as different posts write them, each with what must come
//! of it, thought out before it was run.
//!
//! `attacks.tsv` is the table; the programs lie in `attacks/`, and `attacks/generate.py` writes
//! both. A change runs every sixth of them, a night all. A case that is known to be judged wrongly
//! is marked `open: …` in its remark, and must go on being wrong: when it is mended, the mark goes.
use control::job::ProgramOptions;
use control::job::options::{Compensation, DecimalPoint};
use control::stops::AfterStop;
use leadscrew::{Ending, Program, RunOptions};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Every sixth is run at a change.
const STEP: usize = 6;

/// A row of the table.
struct Attack<'a> {
    name: &'a str,
    machine: &'a str,
    options: &'a str,
    story: &'a str,
    /// `pass`, `no pass` or `refused`.
    expected: &'a str,
    /// Words that must be said, or, behind `!`, must not be.
    says: &'a str,
    /// Verdict of the judge that looked at each feature alone.
    before: &'a str,
    /// What was corrected, or `open: why`.
    remark: &'a str,
}

fn rows(table: &str) -> Vec<Attack<'_>> {
    let rows = table.lines().skip(1).map(|line| {
        let columns: Vec<&str> = line.split('\t').collect();
        let [name, machine, options, story, expected, says, before, remark] = columns[..] else {
            panic!("{line}");
        };
        assert!(["pass", "no pass", "refused"].contains(&expected), "{line}");
        Attack { name, machine, options, story, expected, says, before, remark }
    });
    rows.collect()
}

/// Words of the command line, those between quotes as one.
fn words(options: &str) -> Vec<&str> {
    let parts = options.split('\'').enumerate();
    parts.fold(Vec::new(), |mut words, (index, part)| {
        if index % 2 == 1 {
            words.push(part);
        } else {
            words.extend(part.split_whitespace());
        }
        words
    })
}

/// Options as `leadscrew run` takes them.
fn options(attack: &Attack<'_>, home: &Path) -> (ProgramOptions, RunOptions) {
    let (mut program, mut run) = (ProgramOptions::on(attack.machine), RunOptions::default());
    let mut words = words(attack.options).into_iter();
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap_or_else(|| panic!("{word} needs a value"));
        match word {
            "--tools" => program.tools = Some(home.join(value())),
            "--dialect" => program.dialect = interp::Dialect::named(value()),
            "--decimal-point" => {
                assert_eq!(value(), "calculator");
                program.decimal_point = Some(DecimalPoint::Calculator);
            }
            "--pre-drilled" => program.pre_drilled = true,
            "--feed-forward" => program.without_feed_forward = value() == "off",
            "--compensation" => {
                assert_eq!(value(), "wrong");
                program.compensation = Compensation::Wrong;
            }
            "--seed" => run.seed = value().parse().ok(),
            "--fault" => run.faults.push(value().to_owned()),
            "--operator" => {
                run.operator.extend(value().split(';').map(|one| one.trim().to_owned()));
            }
            "--recover" => run.recover = Some(AfterStop::Out),
            other => panic!("{other}"),
        }
    }
    (program, run)
}

/// What came of a program, and all that was said of it.
fn verdict(attack: &Attack<'_>, home: &Path) -> (&'static str, String) {
    let (program, run) = options(attack, home);
    let path = home.join(format!("{}.ngc", attack.name));
    let job = Program::open(&path).and_then(|text| text.on(program));
    let finished = match job.and_then(|job| job.run(&run)) {
        Ok(finished) => finished,
        Err(why) => return ("refused", why.sentence()),
    };
    let mut said: Vec<String> = finished.findings().iter().map(|d| d.message.clone()).collect();
    for feature in finished.features() {
        said.extend(feature.verdict.reason().map(str::to_owned));
        if feature.has_assumed_hole() {
            said.push("IF THE HOLES ARE THERE".into());
        }
    }
    said.extend(finished.outcome.watch.breaches().iter().map(|breach| breach.what.clone()));
    let came = if finished.ending() == Ending::Good { "pass" } else { "no pass" };
    (came, said.join("; "))
}

/// Whether it came as expected; what came where a refusal is as good is said as it came.
fn is_as_expected(attack: &Attack<'_>, (came, said): &(&str, String)) -> bool {
    let is_verdict = match attack.expected {
        "no pass" => *came != "pass",
        other => *came == other,
    };
    let is_said = match attack.says.strip_prefix('!') {
        Some(never) => !said.contains(never),
        None => said.contains(attack.says),
    };
    is_verdict && is_said
}

#[test]
fn each_attack_comes_to_what_was_thought_out_before() {
    let tests = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests");
    let (table, home) =
        (std::fs::read_to_string(tests.join("attacks.tsv")).unwrap(), tests.join("attacks"));
    let all = rows(&table);
    let step = test_support::size::of(STEP, 1);
    let chosen: Vec<&Attack<'_>> = all.iter().step_by(step).collect();
    let (next, lines, wrong) =
        (AtomicUsize::new(0), Mutex::new(Vec::new()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Relaxed);
                    let Some(attack) = chosen.get(index) else { break };
                    let came = verdict(attack, &home);
                    let Attack { name, story, expected, before, remark, .. } = attack;
                    let line = format!(
                        "{name}: {story}: expected {expected}, before {before}, now {}",
                        came.0
                    );
                    let is_open = remark.starts_with("open");
                    if is_as_expected(attack, &came) == is_open {
                        let mark = if is_open { "the mark `open` is to go" } else { &came.1 };
                        wrong.lock().unwrap().push(format!("{line}: {mark}"));
                    }
                    lines.lock().unwrap().push((index, line));
                }
            });
        }
    });
    let mut lines = lines.into_inner().unwrap();
    lines.sort_unstable();
    for (_, line) in &lines {
        println!("{line}");
    }
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), chosen.len(), wrong.join("\n"));
}

#[test]
fn a_third_of_the_attacks_are_good_parts_and_few_are_open() {
    let table = include_str!("attacks.tsv");
    let all = rows(table);
    let of = |is: &dyn Fn(&Attack<'_>) -> bool| all.iter().filter(|attack| is(attack)).count();
    assert!(all.len() >= 150 && 3 * of(&|attack| attack.expected == "pass") >= all.len());
    let open = of(&|attack| attack.remark.starts_with("open"));
    assert!(20 * open <= all.len(), "{open}");
}
