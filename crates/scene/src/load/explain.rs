//! What a key of a scene file wants, in words, when it was given something else.

use super::schema;
use crate::fault::{Key, KeyPath, nearest};
use toml::Value;

/// Turns the message of the deserializer into ours, and into what to do. `path`: where it happened; for an unknown key it gets to point at the key.
/// `file`: everything that was written.
pub(super) fn explain(message: &str, path: &mut KeyPath, file: &Value) -> (String, String) {
    let message = message.trim();
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field") {
        let unknown = quoted.next().unwrap_or_default().to_owned();
        let known: Vec<_> = quoted.collect();
        if path.0.last() != Some(&Key::Name(unknown.clone())) {
            path.0.push(Key::Name(unknown.clone()));
        }
        let owner = KeyPath(path.0[..path.0.len() - 1].to_vec()).to_string();
        let whose = if owner.is_empty() { "of a scene".to_owned() } else { format!("of `{owner}`") };
        return (format!("unknown key `{unknown}` {whose}"), nearest(&unknown, &known));
    }
    if message.starts_with("unknown variant") {
        let unknown = quoted.next().unwrap_or_default().to_owned();
        let known: Vec<_> = quoted.collect();
        return (format!("`{path}` cannot be `{unknown}`"), nearest(&unknown, &known));
    }
    if message.starts_with("missing field") {
        let missing = quoted.next().unwrap_or_default();
        let remedy = match description(&path.then(missing)) {
            Some(words) => format!("add `{missing} = ...`: {words}"),
            None => format!("add `{missing} = ...`"),
        };
        return (format!("`{path}` lacks the key `{missing}`"), remedy);
    }
    let written = at(file, path);
    if let ([Key::Name(array)], Some(written)) = (path.0.as_slice(), written)
        && message.ends_with("expected a sequence")
        && let Some(example) = example(array)
    {
        return not_a_list(array, written, example);
    }
    let found = written.map_or_else(String::new, |value| format!(" is {}", show(value)));
    let told = match wanted(message) {
        Some(words) => format!("`{path}`{found}, but it takes {words}"),
        None => format!("`{path}`{found}: {message}"),
    };
    (told, description(path).unwrap_or_else(|| "see `fissure schema` for what each key holds".into()))
}

/// The complaint about a top-level key that is no list of tables.
fn not_a_list(array: &str, written: &Value, example: &str) -> (String, String) {
    let message = match written {
        Value::Table(_) => {
            format!("`[{array}]` is a single table, but there can be several: each begins with `[[{array}]]`")
        }
        value => format!("`{array}` is {}, but it is a list of tables: each begins with `[[{array}]]`", show(value)),
    };
    (message, format!("write {example}"))
}

/// An item of a top-level array of tables, as one writes it.
fn example(array: &str) -> Option<&'static str> {
    Some(match array {
        "material" => {
            "`[[material]]` with `name = \"...\"` and its values below it; the material of a body is a key of `[[body]]`: `material = \"pmma\"`"
        }
        "body" => "`[[body]]` with `name = \"plate\"`, `material = \"pmma\"` and `shape = { ... }` below it",
        "region" => "`[[region]]` with `material = \"glass\"` and `shape = { ... }` below it",
        "toughness" => "`[[toughness]]` with `image = \"...png\"`, or `shape = { ... }` and `factor = 0.5`, below it",
        "crack" => "`[[crack]]` with `line = [[x, y], [x, y]]` below it",
        "flaws" => "`[[flaws]]` with `count = 20` and `length = 0.1` below it",
        "guide" => "`[[guide]]` with `name = \"path\"` and `line = [[x, y], [x, y]]` below it",
        "collider" => "`[[collider]]` with `shape = { half_plane = { point = [0, 0] } }` below it",
        "load" => "`[[load]]` with `select = { edge = \"top\" }` and `force = [0, 1e6]` below it",
        "support" => "`[[support]]` with `select = { edge = \"bottom\" }` and `fix = \"both\"` below it",
        "initial_velocity" => "`[[initial_velocity]]` with `velocity = [0, -1]` below it",
        _ => return None,
    })
}

/// What the deserializer expected, in words; none where it speaks plainly itself.
fn wanted(message: &str) -> Option<String> {
    if message.starts_with("wanted exactly 1 element") || message.contains("expected map with a single key") {
        return Some("a table with exactly one key, which says what kind it is".into());
    }
    let expected = message.rsplit_once("expected ")?.1.trim_end_matches('.');
    let words = match expected {
        "f64" | "f32" => "a number, without quotes",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0",
        "i32" | "i64" => "a whole number",
        "a boolean" => "`true` or `false`",
        "a string" | "path string" => "text in quotes",
        "a sequence" => "a list in brackets, `[...]`",
        "a map" => "a table in braces, `{ key = ... }`",
        "string or map" | "map or string" | "newtype variant" | "struct variant" | "string or table" => {
            "a table in braces with one key, which says what kind it is"
        }
        "unit variant" => "a plain word in quotes",
        _ if expected.starts_with("an array of length 2") || expected.starts_with("a tuple of size 2") => {
            "two numbers, `[x, y]`"
        }
        "fewer elements in array" | "more elements in array" => "two numbers, `[x, y]`",
        _ if expected.starts_with("enum ") => "one of the words it knows, in quotes",
        _ if expected.starts_with("struct ") => "a table of keys, in braces or below a heading",
        plain => plain,
    };
    Some(words.into())
}

/// A value as messages show it: short.
fn show(value: &Value) -> String {
    const MOST: usize = 40;
    let text = match value {
        Value::Table(_) => return "a table".into(),
        Value::Array(items) if items.iter().any(|item| matches!(item, Value::Table(_))) => {
            return format!("a list of {} items", items.len());
        }
        Value::String(text) => format!("the text \"{text}\""),
        other => other.to_string(),
    };
    if text.chars().count() > MOST { text.chars().take(MOST).chain("...".chars()).collect() } else { text }
}

/// The value at a path.
fn at<'v>(file: &'v Value, path: &KeyPath) -> Option<&'v Value> {
    path.0.iter().try_fold(file, |here, key| match key {
        Key::Name(name) => here.get(name.as_str()),
        Key::Index(index) => here.get(*index),
    })
}

/// What the schema says of the key at a path.
fn description(path: &KeyPath) -> Option<String> {
    let schema = schema();
    let mut here = &schema;
    for key in &path.0 {
        here = match key {
            Key::Name(name) => forms(&schema, here).into_iter().find_map(|form| form.get("properties")?.get(name))?,
            Key::Index(_) => forms(&schema, here).into_iter().find_map(|form| form.get("items"))?,
        };
    }
    let text = here.get("description")?.as_str()?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned())
}

/// A schema and all forms that it stands for: references followed, alternatives listed.
fn forms<'s>(root: &'s serde_json::Value, schema: &'s serde_json::Value) -> Vec<&'s serde_json::Value> {
    let mut found = vec![schema];
    let mut next = 0;
    while let Some(&form) = found.get(next) {
        next += 1;
        let name = form.get("$ref").and_then(|r| r.as_str()).and_then(|r| r.strip_prefix("#/$defs/"));
        found.extend(name.and_then(|name| root.get("$defs")?.get(name)));
        for key in ["anyOf", "oneOf", "allOf"] {
            found.extend(form.get(key).and_then(|list| list.as_array()).into_iter().flatten());
        }
    }
    found
}
