use super::*;

fn found(axis: &str, text: &str) -> Vec<String> {
    let text = format!("extends = \"mill-5-axis\"\n[axes.{axis}.compensation]\n{text}\n");
    match crate::machine::parse(&text, 0) {
        Ok(_) => Vec::new(),
        Err(findings) => findings.into_iter().map(|one| one.message).collect(),
    }
}
