//! The types that the page is written against, and the document of the API, say what the program
//! says.
use std::path::Path;

#[test]
fn the_types_of_the_page_are_those_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/src/api/types.ts");
    let text = server::types::typescript();
    if std::env::var_os("UPDATE_API").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &text).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == text, "{} is old: UPDATE_API=1 writes it", path.display());
}

#[test]
fn every_address_of_the_documentation_is_in_the_document_of_the_api() {
    let document = server::openapi();
    assert_eq!(document["openapi"], "3.1.0");
    let paths = document["paths"].as_object().unwrap();
    let doc = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/api.md");
    let text = std::fs::read_to_string(doc).unwrap();
    for (path, entry) in paths {
        let short = path.trim_start_matches("/api/v1/").trim_end_matches("/{path}");
        assert!(
            text.contains(&format!("{short}`")) || text.contains(short),
            "{path} is not in docs/api.md"
        );
        for (method, operation) in entry.as_object().unwrap() {
            assert!(operation["operationId"].is_string(), "{method} {path}");
        }
    }
    // each type that is named is there
    let mut named = Vec::new();
    references(&document, &mut named);
    let schemas = document["components"]["schemas"].as_object().unwrap();
    assert!(named.len() > 20);
    for name in named {
        let name = name.trim_start_matches("#/components/schemas/");
        assert!(schemas.contains_key(name), "{name} has no schema");
    }
}

fn references(value: &serde_json::Value, found: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(fields) => {
            for (name, value) in fields {
                match value.as_str().filter(|_| name == "$ref") {
                    Some(reference) => found.push(reference.to_owned()),
                    None => references(value, found),
                }
            }
        }
        serde_json::Value::Array(values) => values.iter().for_each(|v| references(v, found)),
        _ => {}
    }
}
