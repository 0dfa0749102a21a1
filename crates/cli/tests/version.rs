//! `leadscrew --version` names its commit, and the build script does so in a repository, outside
//! one and without git: it is tried in a small package of its own.
use std::{fs, path::Path, process::Command};

/// Two folders deep, as the real package is; its program prints what `--version` prints.
fn package() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    let at = root.path().join("crates/small");
    fs::create_dir_all(at.join("src")).unwrap();
    let manifest =
        "[package]\nname = \"small\"\nversion = \"1.2.3\"\nedition = \"2024\"\n[workspace]\n";
    fs::write(at.join("Cargo.toml"), manifest).unwrap();
    let program = "//! Prints it.\nfn main() { println!(\"{}\", env!(\"LEADSCREW_VERSION\")); }\n";
    fs::write(at.join("src/main.rs"), program).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("build.rs");
    fs::copy(script, at.join("build.rs")).unwrap();
    root
}

fn git(root: &Path, words: &[&str]) {
    let mut command = Command::new("git");
    command.args(["-c", "user.name=a", "-c", "user.email=a@b.c"]).args(words).current_dir(root);
    assert!(command.output().unwrap().status.success(), "git {words:?}");
}

fn commit(root: &Path) -> String {
    git(root, &["commit", "--quiet", "--allow-empty", "--message", "Next"]);
    let mut command = Command::new("git");
    let output = command.args(["rev-parse", "--short=12", "HEAD"]).current_dir(root).output();
    String::from_utf8(output.unwrap().stdout).unwrap().trim().to_owned()
}

/// What the program prints after `cargo build`, and whether cargo compiled anything.
fn built(root: &Path, path: Option<&str>) -> (String, bool) {
    let at = root.join("crates/small");
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let mut command = Command::new(cargo);
    command
        .args(["build", "--offline"])
        .current_dir(&at)
        .env("CARGO_TARGET_DIR", at.join("target"));
    command.env_remove("CARGO_PKG_VERSION").env("RUSTC", rustc());
    if let Some(path) = path {
        command.env("PATH", path);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let printed = Command::new(at.join("target/debug/small")).output().unwrap().stdout;
    (String::from_utf8(printed).unwrap().trim().to_owned(), said.contains("Compiling"))
}

/// The compiler by its path: it is found without `PATH`.
fn rustc() -> String {
    let output = Command::new("rustc").args(["--print", "sysroot"]).output().unwrap();
    format!("{}/bin/rustc", String::from_utf8(output.stdout).unwrap().trim())
}

#[test]
fn the_program_names_its_version_and_a_commit() {
    let output = Command::new(env!("CARGO_BIN_EXE_leadscrew")).arg("--version").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let start = format!("leadscrew {} (commit ", env!("CARGO_PKG_VERSION"));
    assert!(text.starts_with(&start) && text.ends_with(")\n"), "{text}");
}

#[test]
fn a_new_commit_builds_again_and_nothing_else_does() {
    let folder = package();
    let root = folder.path();
    git(root, &["init", "--quiet"]);
    let first = commit(root);
    assert_eq!(built(root, None), (format!("1.2.3 (commit {first})"), true));
    assert!(!built(root, None).1, "built again without a change");
    let second = commit(root);
    assert_eq!(built(root, None), (format!("1.2.3 (commit {second})"), true));
    git(root, &["pack-refs", "--all"]);
    built(root, None); // the file of the branch is gone
    assert!(!built(root, None).1, "built again without a change, with packed refs");
    let third = commit(root);
    assert_eq!(built(root, None), (format!("1.2.3 (commit {third})"), true));
}

#[test]
fn sources_without_a_repository_have_an_unknown_commit() {
    let folder = package();
    assert_eq!(built(folder.path(), None), ("1.2.3 (commit unknown)".to_owned(), true));
    assert!(!built(folder.path(), None).1, "built again without a change");
}

#[test]
fn a_machine_without_git_has_an_unknown_commit() {
    let folder = package();
    git(folder.path(), &["init", "--quiet"]);
    commit(folder.path());
    // the linker and nothing else is on the path
    let tools = tempfile::tempdir().unwrap();
    for tool in ["cc", "ld", "as"] {
        let mut which = Command::new("sh");
        let found = which.args(["-c", &format!("command -v {tool}")]).output().unwrap().stdout;
        let found = String::from_utf8(found).unwrap();
        if !found.trim().is_empty() {
            std::os::unix::fs::symlink(found.trim(), tools.path().join(tool)).unwrap();
        }
    }
    let printed = built(folder.path(), tools.path().to_str()).0;
    assert_eq!(printed, "1.2.3 (commit unknown)");
}
