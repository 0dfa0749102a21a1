//! `leadscrew control` is killed at any instant, while offsets and tools are set and a program taps
//! hole after hole: what it had acknowledged is there when it is switched on again, and nothing
//! half-written is believed.
//!
//! `STATE_KILLS` says how often: `cargo xtask state-kills` 500 times.
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use test_support::size;

/// A control is killed within this of its start: it homes and cuts several threads meanwhile.
const LONGEST_LIFE_MS: u64 = 1200;
const PART: &str = "G21 G90 G54 G17 G94\nT3 M6\nG43 H3\nS1000 M3\nG0 X0 Y0 Z20\n\
                    G99 G84 X0 Y0 Z-15 R5 F1000\nG80\nG0 Z50\nM2\n";
const MORNING: &str =
    "power on\nwait ready within 5 s\nhome\nwait homed within 90 s\nload part.ngc\n";

/// What one control was told to set, and what it has kept: how often the offset and the wear were
/// set, how many programs have ended. Each is counted on from what the control before it has kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Count {
    offset: u32,
    wear: u32,
    programs: u32,
}

fn control(folder: &Path) -> Command {
    let mut control = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    control.args(["control", "--machine", "tapping-center", "--state", "state", "--script", "-"]);
    control.current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    control
}

/// A script that goes on setting and cutting for longer than a control lives.
fn script(from: Count) -> String {
    let mut script = MORNING.to_owned();
    for i in 1..=40 {
        let (offset, wear) = (from.offset + i, from.wear + i);
        writeln!(script, "offset G55 X -{:.3}", f64::from(offset) / 1e3).unwrap();
        writeln!(script, "tool 3 wear length -{:.5}", f64::from(wear) / 1e5).unwrap();
        script += "start\nwait completed within 60 s\n";
    }
    script
}

/// Start a control, kill it after so long; what it has acknowledged: a request is, once the next
/// one has been taken up.
fn killed_after(life: Duration, folder: &Path, from: Count) -> Count {
    let mut control = control(folder).spawn().unwrap();
    let mut stdin = control.stdin.take().unwrap();
    let told = script(from);
    // a control that is dead takes no more of it
    let thread = std::thread::Builder::new;
    let teller = thread().spawn(move || drop(stdin.write_all(told.as_bytes()))).unwrap();
    let said = BufReader::new(control.stdout.take().unwrap());
    let listen = move || said.lines().map_while(Result::ok).collect::<Vec<_>>();
    let listener = thread().spawn(listen).unwrap();
    std::thread::sleep(life);
    control.kill().unwrap();
    control.wait().unwrap();
    teller.join().unwrap();
    let said = listener.join().unwrap();
    let echoes: Vec<_> = said.iter().filter_map(|line| line.strip_prefix("> ")).collect();
    let before_last = echoes.split_last().map_or(&[][..], |(_, before)| before);
    let count =
        |start: &str| before_last.iter().filter(|echo| echo.starts_with(start)).count() as u32;
    Count {
        offset: from.offset + count("offset"),
        wear: from.wear + count("tool"),
        programs: from.programs + count("wait completed"),
    }
}

/// What a control that is switched on again believes; it says nothing of damaged files.
fn kept(folder: &Path) -> Count {
    let mut control = control(folder).spawn().unwrap();
    control.stdin.take().unwrap().write_all(b"offsets\nalarms\n").unwrap();
    let output = control.wait_with_output().unwrap();
    let (said, errors) =
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(output.status.success(), "{said}{errors}");
    assert!(!format!("{said}{errors}").contains("damaged"), "{said}{errors}");
    let of_offset =
        |line: &str| line.trim().strip_prefix("G55 X-")?.split(' ').next()?.parse().ok();
    let offset: f64 = said.lines().find_map(of_offset).unwrap_or(0.0);
    let tools = std::fs::read_to_string(folder.join("state/tools.toml")).unwrap_or_default();
    let tap =
        tools.split("[[tool]]").find(|entry| entry.contains("\nnumber = 3\n")).unwrap_or_default();
    let number = |start: &str| -> Option<f64> {
        let after = tap.split_once(start)?.1;
        after.split([',', '\n']).next()?.trim().parse().ok()
    };
    Count {
        offset: (offset * 1e3).round() as u32,
        wear: (number("wear_length_mm = -").unwrap_or(0.0) * 1e5).round() as u32,
        programs: number("uses = ").unwrap_or(0.0) as u32,
    }
}

#[test]
fn a_control_that_is_killed_keeps_the_offsets_tools_and_counts_that_it_has_acknowledged() {
    let kills = std::env::var("STATE_KILLS").ok().and_then(|n| n.parse().ok());
    let kills: u64 = kills.unwrap_or_else(|| size::of(6, 100));
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("part.ngc"), PART).unwrap();
    let (mut before, mut acknowledged) = (Count::default(), Count::default());
    let mut kill = 0;
    // on a busy computer none has cut a thread in its life: then further ones live longer
    while kill < kills || acknowledged.programs == 0 && kill < kills + 6 {
        // spread over the life without a period of its own
        let longer = 1 << (kill + 1).saturating_sub(kills);
        let life = Duration::from_millis(20 + longer * (kill * 7919 % LONGEST_LIFE_MS));
        let said = killed_after(life, home.path(), before);
        let now = kept(home.path());
        assert!(
            now.offset >= said.offset && now.offset <= said.offset + 1,
            "{kill}: {said:?} {now:?}"
        );
        assert!(now.wear >= said.wear && now.wear <= said.wear + 1, "{kill}: {said:?} {now:?}");
        assert!(now.programs >= said.programs, "{kill}: {said:?} {now:?}");
        acknowledged = Count {
            offset: acknowledged.offset + said.offset - before.offset,
            wear: acknowledged.wear + said.wear - before.wear,
            programs: acknowledged.programs + said.programs - before.programs,
        };
        before = now;
        kill += 1;
    }
    println!("{kill} kills; acknowledged and kept: {acknowledged:?}");
    assert!(acknowledged.offset > 0 && acknowledged.wear > 0 && acknowledged.programs > 0);
}
