//! The OpenAPI document, made from the table of addresses and the schemas of the types.
use super::{BASE, Route, table};
use crate::wire::RefusalBody;
use serde_json::{Map, Value, json};
use utoipa::openapi::{RefOr, schema::Schema};
use utoipa::{PartialSchema, ToSchema};

type Named = Vec<(String, RefOr<Schema>)>;

/// What a body is.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    /// There is none.
    Nothing,
    /// Plain text.
    Text,
    /// JSON of any form.
    Any,
    /// JSON of a type: its name, its schemas, whether it is a list of it.
    Json(fn() -> String, fn(&mut Named), bool),
}

impl Shape {
    /// Of a type.
    pub(super) fn of<T: ToSchema>() -> Self {
        Self::Json(name::<T>, schemas::<T>, false)
    }

    /// Of a list of a type.
    pub(super) fn list_of<T: ToSchema>() -> Self {
        Self::Json(name::<T>, schemas::<T>, true)
    }

    fn content(self) -> Option<Value> {
        match self {
            Self::Nothing => None,
            Self::Text => Some(json!({ "text/plain": { "schema": { "type": "string" } } })),
            Self::Any => Some(json!({ "application/json": { "schema": {} } })),
            Self::Json(name, _, is_list) => {
                let one = json!({ "$ref": format!("#/components/schemas/{}", name()) });
                let schema = if is_list { json!({ "type": "array", "items": one }) } else { one };
                Some(json!({ "application/json": { "schema": schema } }))
            }
        }
    }
}

fn name<T: ToSchema>() -> String {
    T::name().into_owned()
}

fn schemas<T: ToSchema>(all: &mut Named) {
    all.push((name::<T>(), <T as PartialSchema>::schema()));
    T::schemas(all);
}

/// The document.
pub fn openapi() -> Value {
    let (mut paths, mut named) = (Map::new(), Named::new());
    schemas::<RefusalBody>(&mut named);
    for row in table() {
        for shape in [row.body, row.answer] {
            if let Shape::Json(_, schemas, _) = shape {
                schemas(&mut named);
            }
        }
        let path = format!("{BASE}{}", row.path.replace("{*", "{"));
        let entry = paths.entry(path).or_insert_with(|| json!({}));
        entry[row.method] = operation(&row);
    }
    // schemas are maps of plain values
    let schemas: Map<_, _> = named
        .into_iter()
        .map(|(name, schema)| (name, serde_json::to_value(schema).unwrap_or_default()))
        .collect();
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Leadscrew",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "A numerical control for spindle-synchronised machining, led over the network.",
            "license": { "name": "MIT OR Apache-2.0", "identifier": "MIT OR Apache-2.0" },
        },
        "servers": [{ "url": "/" }],
        "paths": paths,
        "components": {
            "schemas": schemas,
            "securitySchemes": {
                "token": { "type": "http", "scheme": "bearer" },
                "session": { "type": "apiKey", "in": "header", "name": crate::guard::SESSION },
            },
        },
        "security": [{}, { "token": [] }, { "session": [] }],
    })
}

fn operation(row: &Route) -> Value {
    let words = row.path.split(['/', '{', '}', '*', '.']).filter(|word| !word.is_empty());
    let id = [row.method].into_iter().chain(words).collect::<Vec<_>>().join("_");
    let refused = json!({
        "description": "Refused: why, and what would make it possible",
        "content": { "application/json": { "schema": { "$ref": "#/components/schemas/RefusalBody" } } },
    });
    let mut done = json!({ "description": row.summary });
    if let Some(content) = row.answer.content() {
        done["content"] = content;
    }
    let status = if matches!(row.path, "/ws" | "/lsp") { "101" } else { "200" };
    let mut operation = json!({
        "operationId": id,
        "summary": row.summary,
        "responses": { status: done, "4XX": refused, "5XX": refused },
    });
    if let Some(content) = row.body.content() {
        operation["requestBody"] = json!({ "required": true, "content": content });
    }
    let parameter = |name: &str, place: &str, kind: &str| json!({ "name": name, "in": place, "required": place == "path", "schema": { "type": kind } });
    let parameters = match row.path {
        "/events" => vec![parameter("after", "query", "integer")],
        "/ws" | "/lsp" => vec![parameter("session", "query", "string")],
        "/runs" => ["program", "verdict", "from_unix_ms", "to_unix_ms"]
            .map(|name| parameter(name, "query", "string"))
            .into(),
        path if path.ends_with("/trace") => {
            let asked = ["signals", "from_s", "to_s", "columns"];
            let asked = asked.map(|name| parameter(name, "query", "string"));
            [parameter("id", "path", "string")].into_iter().chain(asked).collect()
        }
        path if path.contains("{id}") => vec![parameter("id", "path", "string")],
        path if path.contains("{*path}") => vec![parameter("path", "path", "string")],
        _ => Vec::new(),
    };
    if !parameters.is_empty() {
        operation["parameters"] = Value::Array(parameters);
    }
    operation
}
