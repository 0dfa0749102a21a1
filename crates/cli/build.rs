//! Names the commit that the program is built from, for `leadscrew --version`; `unknown` where
//! there is no git.
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // sources without a repository of their own may lie within another one
    let own = Path::new("../../.git").exists();
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).filter(|_| own);
    let version = env!("CARGO_PKG_VERSION");
    let commit = commit.as_deref().unwrap_or("unknown");
    println!("cargo::rustc-env=LEADSCREW_VERSION={version} (commit {commit})");
    if !own {
        return;
    }
    watch("HEAD");
    watch("logs/HEAD"); // a commit on a branch that was packed makes a new file
    if let Some(branch) = git(&["symbolic-ref", "--quiet", "HEAD"]) {
        watch(&branch);
    }
    watch("packed-refs");
}

/// Build again when this file of the repository changes. One that does not exist is not named:
/// cargo would build each time.
fn watch(name: &str) {
    if let Some(file) = git(&["rev-parse", "--git-path", name])
        && Path::new(&file).exists()
    {
        println!("cargo::rerun-if-changed={file}");
    }
}

/// What git answers in one line; `None` where there is no git or no repository.
fn git(words: &[&str]) -> Option<String> {
    let output = Command::new("git").args(words).output().ok()?;
    let line = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !line.is_empty()).then_some(line)
}
