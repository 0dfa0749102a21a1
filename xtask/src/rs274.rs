//! LinuxCNC's stand-alone interpreter (`rs274`, Debian package `linuxcnc-uspace`), run on a
//! program.
#![allow(clippy::disallowed_methods)] // a time limit needs a clock

use crate::listing::{Outcome, calls, tool_table};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How long a program may take; those that loop for ever are ended here.
const TIME_LIMIT: Duration = Duration::from_secs(20);

/// An installation with a home of its own, so that it reads and leaves nothing elsewhere.
pub(crate) struct Rs274 {
    home: tempfile::TempDir,
}

impl Rs274 {
    /// In a new temporary folder, with the tools both sides are given.
    pub(crate) fn new() -> Result<Self, String> {
        let home = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
        let table = home.path().join("tool.tbl");
        fs::write(&table, tool_table()).map_err(|e| format!("{}: {e}", table.display()))?;
        Ok(Self { home })
    }

    /// The command that lists a program; it starts without streams.
    pub(crate) fn command(&self, program: &Path) -> Command {
        let mut command = Command::new("rs274");
        command.env("HOME", self.home.path()).current_dir(self.home.path());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.arg("-t").arg("tool.tbl").arg("-g").arg(program);
        command
    }

    /// What it makes of a program; `None` if that takes longer than the time limit.
    pub(crate) fn list(&self, program: &Path) -> Result<Option<Outcome>, String> {
        let said = |name: &str| self.home.path().join(name);
        let file = |name: &str| File::create(said(name)).map_err(|e| format!("{name}: {e}"));
        let mut command = self.command(program);
        command.stdout(file("out")?).stderr(file("err")?);
        let child = command
            .spawn()
            .map_err(|e| format!("rs274: {e} (Debian has it in linuxcnc-uspace)"))?;
        let Some(status) = wait(child)? else { return Ok(None) };
        let text = |name| fs::read(said(name)).map(|b| String::from_utf8_lossy(&b).into_owned());
        if status.success() {
            let listing = text("out").map_err(|e| e.to_string())?;
            return Ok(Some(Outcome::Accepted(calls(&listing))));
        }
        let complaint = text("err").unwrap_or_default();
        let lines = complaint.lines().map(str::trim);
        let first = lines.filter(|l| !l.is_empty() && *l != "executing").take(1).collect();
        Ok(Some(Outcome::Refused(first)))
    }
}

fn wait(mut child: Child) -> Result<Option<ExitStatus>, String> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(Some(status)),
            Ok(None) if start.elapsed() < TIME_LIMIT => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Ok(None) => {
                child.kill().and_then(|()| child.wait()).map_err(|e| format!("rs274: {e}"))?;
                return Ok(None);
            }
            Err(e) => return Err(format!("rs274: {e}")),
        }
    }
}
