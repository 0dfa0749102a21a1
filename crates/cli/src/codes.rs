//! `leadscrew codes`: every G and M code, as the interpreter's own tables have it.
use crate::args::CodesFormat;
use crate::say;
use comfy_table::{Table, presets};
use control::Refused;
use interp::CodeInfo;
use serde_json::{Value, json};

/// Print them.
pub(crate) fn command(format: CodesFormat) -> Result<(), Refused> {
    match format {
        CodesFormat::Text => say::out(&format!("{}\n", table())),
        CodesFormat::Json => {
            let all = Value::Array(
                interp::codes().chain(interp::dialect_codes()).map(|code| object(&code)).collect(),
            );
            say::out(&format!("{all:#}\n"))
        }
    }
}

fn table() -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY);
    crate::tables::fit(&mut table);
    table.set_header(["code", "what it does", "takes", "group", "status", "dialects"]);
    for code in interp::codes().chain(interp::dialect_codes()) {
        let dialects = dialects(&code).join(", ");
        table.add_row([
            &*code.code,
            code.name,
            &code.letters,
            code.group,
            status(&code),
            &dialects,
        ]);
    }
    table
}

fn object(code: &CodeInfo) -> Value {
    json!({
        "code": code.code,
        "name": code.name,
        "letters": code.letters,
        "group": code.group,
        "modal": code.modal,
        "status": status(code),
        "dialects": dialects(code),
    })
}

/// One word for whether it is executed.
fn status(code: &CodeInfo) -> &'static str {
    if code.executed { "executed" } else { "refused" }
}

fn dialects(code: &CodeInfo) -> Vec<&'static str> {
    code.dialects.iter().map(|dialect| dialect.name()).collect()
}
