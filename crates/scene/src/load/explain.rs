//! What a key of a scene file wants, in words, when it was given something else.

use super::schema;
use crate::fault::{Key, KeyPath};
use crate::load::nearest::nearest;
use std::sync::LazyLock;
use toml::Value;

/// The schema, made once: making it takes longer than reading a scene.
static SCHEMA: LazyLock<serde_json::Value> = LazyLock::new(schema);

/// Turns the message of the deserializer into ours, and into what to do. `path`: where it happened; for an unknown key
/// it gets to point at the key. `file`: everything that was written.
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
        let message = format!("unknown key `{unknown}` {whose}");
        let of_the_scene = SCHEMA["properties"].get(&unknown).is_some();
        let remedy = match (owner.is_empty(), of_the_scene) {
            // In TOML everything below a heading belongs to it.
            (false, true) => {
                format!("`{unknown}` is a key of the scene: write it above the first heading in brackets, or as one")
            }
            _ => nearest(&unknown, &known),
        };
        return (message, remedy);
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
    if at(file, path).is_none() && path.0.len() > 1 {
        // The last key is a word that was written in place of a table.
        path.0.pop();
    }
    let written = at(file, path);
    if let ([Key::Name(array)], Some(written)) = (path.0.as_slice(), written)
        && message.ends_with("expected a sequence")
        && let Some(example) = example(array)
    {
        return not_a_list(array, written, example);
    }
    if let [Key::Name(table), ..] = path.0.as_slice()
        && let Some(Value::Array(items)) = file.get(table)
        && items.iter().all(Value::is_table)
        && is_single_table(table)
    {
        let message = format!("`[[{table}]]` begins a list of tables, but there is only one `{table}` in a scene");
        let remedy = format!("write `[{table}]`, once, with its keys below it");
        path.0.truncate(1);
        return (message, remedy);
    }
    let found = written.map_or_else(String::new, |value| format!(" is {}", show(value)));
    let told = match choices(path).or_else(|| wanted(message)) {
        Some(words) => format!("`{path}`{found}, but it takes {words}"),
        None => format!("`{path}`{found}: {message}"),
    };
    // What an item of a list means is said of the list.
    let mut meant = path.clone();
    let described = std::iter::from_fn(|| {
        let words = description(&meant);
        meant.0.pop().map(|_| words)
    });
    let remedy = written.and_then(|written| deeper(path, written)).or_else(|| described.flatten().next());
    (told, remedy.unwrap_or_else(|| "see `fissure schema` for what each key holds".into()))
}

/// Where a key belongs that stands beside the one it should be in: `holes` beside `polygon`.
fn deeper(path: &KeyPath, written: &Value) -> Option<String> {
    let keys: Vec<&String> = written.as_table()?.keys().collect();
    let is_key = |of: &[&str]| find(&SCHEMA, &of.iter().fold(path.clone(), |path, key| path.then(*key))).is_some();
    keys.iter().filter(|key| !is_key(&[key.as_str()])).find_map(|key| {
        let owner = keys.iter().find(|owner| is_key(&[owner.as_str(), key.as_str()]))?;
        Some(format!("`{key}` is a key of `{owner}`: write `{{ {owner} = {{ {key} = ..., ... }} }}`"))
    })
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

/// Whether a top-level key is one table of keys.
fn is_single_table(key: &str) -> bool {
    let path = KeyPath(vec![Key::Name(key.to_owned())]);
    find(&SCHEMA, &path).is_some_and(|of| forms(&SCHEMA, of).iter().any(|form| form.get("properties").is_some()))
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
    if message.starts_with("wanted exactly 1 element")
        || message.contains("expected map with a single key")
        || message.ends_with("elements in map")
    {
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
        Value::Table(keys) if keys.is_empty() => return "a table".into(),
        Value::Table(keys) => {
            let keys: Vec<String> = keys.keys().map(|key| format!("`{key}`")).collect();
            format!("a table of {}", keys.join(", "))
        }
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

/// The forms of a key that is one of several words or tables of one key, as one writes them; none for other keys.
fn choices(path: &KeyPath) -> Option<String> {
    let forms = forms(&SCHEMA, find(&SCHEMA, path)?);
    let mut found: Vec<String> = Vec::new();
    for form in &forms {
        let word = |value: &serde_json::Value| value.as_str().map(|word| format!("`\"{word}\"`"));
        found.extend(form.get("enum").and_then(|e| e.as_array()).into_iter().flatten().filter_map(word));
        found.extend(form.get("const").and_then(word));
        if let (Some([only]), Some(keys)) = (
            form.get("required").and_then(|r| r.as_array()).map(Vec::as_slice),
            form.get("properties").and_then(|p| p.as_object()),
        ) && keys.len() == 1
        {
            found.extend(only.as_str().map(|key| format!("`{{ {key} = ... }}`")));
        }
    }
    // A list of points is a form of its own that no single word tells of.
    let others =
        forms.iter().any(|f| f.get("type").is_some_and(|t| ["array", "number", "boolean"].iter().any(|o| t == o)));
    (found.len() > 1 && !others).then(|| format!("one of {}", found.join(", ")))
}

/// What the schema says of the key at a path.
fn description(path: &KeyPath) -> Option<String> {
    let text = find(&SCHEMA, path)?.get("description")?.as_str()?;
    Some(text.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned())
}

/// The schema of the key at a path.
fn find<'s>(schema: &'s serde_json::Value, path: &KeyPath) -> Option<&'s serde_json::Value> {
    let mut here = schema;
    for key in &path.0 {
        here = match key {
            Key::Name(name) => forms(schema, here).into_iter().find_map(|form| form.get("properties")?.get(name))?,
            Key::Index(_) => forms(schema, here).into_iter().find_map(|form| form.get("items"))?,
        };
    }
    Some(here)
}

/// What to do about a scene file that is no TOML, by what people write; `line`: the line of the mistake.
pub(super) fn syntax_remedy(text: &str, line: &str) -> String {
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    let comma = value.split_once(',').is_some_and(|(whole, part)| {
        !whole.is_empty()
            && whole.trim_start_matches('-').bytes().all(|b| b.is_ascii_digit())
            && part.starts_with(|c: char| c.is_ascii_digit())
    });
    let is_odd = |quote: char| value.matches(quote).count() % 2 == 1;
    if text.trim_start().starts_with(['<', '{']) {
        "this is no scene file: a scene is TOML, begin one with `fissure new`".into()
    } else if comma {
        "write numbers with a point: `0.25`".into()
    } else if value.contains(|c: char| c.is_alphabetic()) && !value.contains(['"', '\'']) {
        "put text in quotes, and write numbers without units: `edge = \"top\"`, `40e6`".into()
    } else if value.contains('\\') && value.contains('"') {
        "write paths with `/`: `file = \"C:/drawings/wall.svg\"`, or in single quotes".into()
    } else if is_odd('"') {
        "put a quote before text and one behind it: `material = \"pmma\"`".into()
    } else {
        "correct the syntax".into()
    }
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
