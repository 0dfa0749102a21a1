//! Values of TOML: as numbers, and their types in words.
use toml::de::DeValue;

/// What a value is, for people.
pub(super) fn type_name(value: &DeValue<'_>) -> &'static str {
    match value.type_str() {
        "integer" => "a whole number",
        "float" => "a number",
        "string" => "text",
        "boolean" => "true or false",
        "datetime" => "a date",
        "array" => "a list",
        _ => "a table",
    }
}

/// A number, whole or not.
pub(super) fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(f) => f.as_str().parse().ok(),
        DeValue::Integer(i) => i128::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|n| n as f64)
            .or(Some(f64::INFINITY)),
        _ => None,
    }
}
