//! Each `curl` line of docs/api.md does what it says, in its order.

use crate::common::Served;
use std::path::Path;
use std::process::Command;

#[test]
fn the_curl_lines_of_the_documentation_are_accepted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("docs/api.md")).unwrap();
    let served = Served::at_pace(40.0);
    let address = served.server.address().to_string();
    let lines: Vec<_> = text.lines().filter(|line| line.starts_with("curl ")).collect();
    assert!(lines.len() >= 9, "{lines:?}");
    for line in lines {
        if line.contains("\"home\"") {
            served.until("ready", |status| status["is_ready"] == true);
        }
        if line.contains("\"load\"") {
            served.until("homed", |status| {
                status["axes"].as_array().unwrap().iter().all(|axis| axis["is_homed"] == true)
            });
        }
        let line = line.replace("127.0.0.1:8383", &address).replacen(
            "curl ",
            "curl --fail-with-body --noproxy '*' ",
            1,
        );
        let run = Command::new("sh").arg("-c").arg(&line).current_dir(&root).output().unwrap();
        let said = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{line}: {said} {}", String::from_utf8_lossy(&run.stderr));
        let answer: serde_json::Value = serde_json::from_str(&said).unwrap();
        assert_ne!(answer["accepted"], false, "{line}: {said}");
    }
}
