//! Overrides from the command line: `--set solver.preset=thesis`.

use crate::fault::{Key, KeyPath};
use crate::load::nearest::nearest;
use crate::materials::material_presets;
use toml::{Table, Value};

/// One override: a path of keys and a value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Override {
    /// As it was typed.
    pub(crate) argument: String,
    keys: Vec<String>,
    value: Value,
}

/// What is wrong, and the remedy.
type Complaint = (String, String);

const FORM: &str = "write it as `--set table.key=value`, for example `--set body.plate.material=glass`";

impl Override {
    /// Parses `a.b.c=value`. The value is TOML; what is not becomes a string, so that bare words need no quotes.
    pub(crate) fn parse(argument: &str) -> Result<Self, Complaint> {
        let (key, value) =
            argument.split_once('=').ok_or_else(|| (format!("`{argument}` has no `=`"), FORM.to_owned()))?;
        let keys = parse_keys(key).ok_or_else(|| (format!("`{key}` is not a key"), FORM.to_owned()))?;
        let value = parse_value(value.trim())?;
        Ok(Self { argument: argument.into(), keys, value })
    }

    /// Sets the value in `table`. Items of arrays are meant by name or index. Returns the path that was set.
    pub(crate) fn apply(&self, table: &mut Table) -> Result<KeyPath, Complaint> {
        let mut path = KeyPath::default();
        let (last, parents) = self.keys.split_last().ok_or_else(|| ("no key".to_owned(), FORM.to_owned()))?;
        if let [array, name, ..] = self.keys.as_slice() {
            add_preset_material(table, array, name);
        }
        let (mut here, start) = match parents.split_first() {
            None => {
                table.insert(last.clone(), self.value.clone());
                return Ok(KeyPath::top(last));
            }
            Some((first, rest)) => {
                path.0.push(first.as_str().into());
                (table.entry(first.clone()).or_insert_with(|| empty(first)), rest)
            }
        };
        for key in start {
            here = step(here, key, &mut path)?;
        }
        *step(here, last, &mut path)? = self.value.clone();
        if let Value::Table(table) = here {
            let parents: Vec<&str> = parents.iter().map(String::as_str).collect();
            replaced_by(&parents, last).iter().for_each(|other| drop(table.remove(*other)));
        }
        Ok(path)
    }
}

/// Keys of a table that one of them takes the place of: a wish that of a resolution, keyframes that of one number, and
/// the other way round.
fn replaced_by(table: &[&str], key: &str) -> &'static [&'static str] {
    match (table, key) {
        (["grid"], "accuracy") => &["budget", "particle_spacing", "cell_size"],
        (["grid"], "budget") => &["accuracy", "particle_spacing", "cell_size"],
        (["grid"], "particle_spacing") => &["accuracy", "budget"],
        (["output", "opening" | "explode"], "factor") => &["keyframes"],
        (["output", "opening" | "explode"], "keyframes") => &["factor"],
        _ => &[],
    }
}

/// What stands under a top-level key that the file does not have.
fn empty(key: &str) -> Value {
    const ARRAYS: [&str; 11] = [
        "material",
        "body",
        "region",
        "toughness",
        "crack",
        "flaws",
        "guide",
        "collider",
        "load",
        "support",
        "initial_velocity",
    ];
    if ARRAYS.contains(&key) { Value::Array(Vec::new()) } else { Value::Table(Table::new()) }
}

/// Changing a material that comes with Fissure needs no `[[material]]` in the file.
fn add_preset_material(table: &mut Table, array: &str, name: &str) {
    if array != "material" || !material_presets().iter().any(|m| m.name == name) {
        return;
    }
    let materials = table.entry("material").or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(materials) = materials
        && !materials.iter().any(|m| m.get("name").and_then(Value::as_str) == Some(name))
    {
        materials.push(Value::Table(Table::from_iter([("name".to_owned(), Value::String(name.into()))])));
    }
}

/// The value under `key` of a table (made when it is not there) or array (which must have it).
fn step<'v>(here: &'v mut Value, key: &str, path: &mut KeyPath) -> Result<&'v mut Value, Complaint> {
    match here {
        Value::Table(table) => {
            path.0.push(key.into());
            Ok(table.entry(key.to_owned()).or_insert_with(|| Value::Table(Table::new())))
        }
        Value::Array(items) => {
            let names: Vec<_> = items.iter().filter_map(|i| i.get("name")?.as_str().map(str::to_owned)).collect();
            let named = items.iter().position(|i| i.get("name").and_then(Value::as_str) == Some(key));
            let index = named.or_else(|| key.parse().ok()).filter(|&i| i < items.len()).ok_or_else(|| {
                let help = if names.is_empty() {
                    format!("`{path}` has {} items, numbered from 0", items.len())
                } else {
                    nearest(key, &names)
                };
                (format!("`{path}` has no item `{key}`"), help)
            })?;
            path.0.push(Key::Index(index));
            Ok(&mut items[index])
        }
        other => Err((
            format!("`{path}` is a {}, it has no key `{key}`", other.type_str()),
            format!("set `{path}` itself, or give it a table in the scene file"),
        )),
    }
}

/// Splits a dotted key as TOML does (quotes allow dots inside a name).
fn parse_keys(key: &str) -> Option<Vec<String>> {
    let mut keys = Vec::new();
    let mut table: Table = toml::from_str(&format!("{key} = 0")).ok()?;
    loop {
        if table.len() != 1 {
            return None;
        }
        let (name, value) = table.into_iter().next()?;
        keys.push(name);
        match value {
            Value::Table(inner) => table = inner,
            _ => return Some(keys),
        }
    }
}

fn parse_value(text: &str) -> Result<Value, Complaint> {
    let parsed = toml::from_str::<Table>(&format!("v = {text}"));
    match parsed {
        Ok(mut table) if table.len() == 1 => Ok(table.remove("v").unwrap_or_else(|| Value::String(text.into()))),
        Err(error) if text.starts_with(['[', '{', '"', '\'']) => Err((
            format!("`{text}` is not a TOML value: {}", error.message().trim()),
            "check brackets and quotes".into(),
        )),
        _ => Ok(Value::String(text.into())),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn set(table: &mut Table, argument: &str) -> Result<String, Complaint> {
        Ok(Override::parse(argument)?.apply(table)?.to_string())
    }

    #[test]
    fn items_are_found_by_name_and_index() {
        let mut table: Table = toml::from_str("[[body]]\nname = 'a'\n[[body]]\nname = 'b'").unwrap();
        assert_eq!(set(&mut table, "body.b.material=glass").unwrap(), "body[1].material");
        assert_eq!(set(&mut table, "body.0.velocity=[1, 2.5]").unwrap(), "body[0].velocity");
        assert_eq!(table["body"][1]["material"].as_str(), Some("glass"));
        assert_eq!(table["body"][0]["velocity"][1].as_float(), Some(2.5));
        let (message, remedy) = set(&mut table, "body.bb.material=glass").unwrap_err();
        assert!(message.contains("`bb`") && remedy.contains("`b`"), "{message} {remedy}");
        assert!(set(&mut table, "body.a.name.x=1").unwrap_err().0.contains("string"));
        assert_eq!(set(&mut table, "material.pmma.density=1").unwrap(), "material[0].density");
    }

    /// The last word on the resolution counts, whichever key it is.
    #[test]
    fn a_wish_and_a_resolution_take_the_place_of_each_other() {
        let mut table: Table = toml::from_str("[grid]\nparticle_spacing = 0.1\ncell_size = 0.2").unwrap();
        for (argument, left) in [
            ("grid.accuracy=2%", &["accuracy"][..]),
            ("grid.budget=30s", &["budget"]),
            ("grid.particle_spacing=0.1", &["particle_spacing"]),
            ("grid.cell_size=0.3", &["cell_size", "particle_spacing"]),
        ] {
            set(&mut table, argument).unwrap();
            assert!(table["grid"].as_table().unwrap().keys().eq(left), "{argument}: {table}");
        }
    }

    proptest! {
        /// Truth: what `toml` itself writes for a value is read back as that value, under the same keys.
        #[test]
        fn any_toml_value_passes(keys in prop::collection::vec("[a-z_\"]{0,3}[a-z0-9.]{1,5}", 1..4),
                                 number in any::<f64>(), integer in any::<i64>(), text in ".{0,12}") {
            prop_assume!(number.is_finite());
            let keys: Vec<String> = keys.iter().map(|k| k.replace('"', "")).collect();
            let written = keys.iter().map(|k| format!("\"{k}\"")).collect::<Vec<_>>().join(".");
            for value in [Value::Float(number), Value::Integer(integer), Value::String(text.clone()),
                          Value::Array(vec![Value::Float(number), Value::String(text)])] {
                let parsed = Override::parse(&format!("{written}={value}")).unwrap();
                prop_assert_eq!(&parsed.keys, &keys);
                prop_assert_eq!(&parsed.value, &value);
            }
        }

        /// Any argument is refused with a remedy, or its value is found under its keys; a bare word is taken as it is.
        #[test]
        fn any_text_is_refused_or_read(argument in prop_oneof![".{0,30}", "[a-z. \"]{1,6}=.{0,20}"],
                                       word in "[a-z][a-z ]{2,8}[a-z]") {
            let mut table = Table::new();
            let set = Override::parse(&argument).and_then(|set| set.apply(&mut table).map(|_| set));
            match set {
                Ok(set) => {
                    let (first, further) = set.keys.split_first().unwrap();
                    let inner = |value: Option<&'_ Value>, key: &String| value?.get(key).cloned();
                    let found = further.iter().fold(table.get(first).cloned(), |here, key| inner(here.as_ref(), key));
                    // As text, because NaN is not equal to itself.
                    prop_assert_eq!(found.map(|v| v.to_string()), Some(set.value.to_string()));
                }
                Err((message, remedy)) => prop_assert!(!message.is_empty() && !remedy.is_empty()),
            }
            prop_assume!(!["true", "false"].contains(&word.as_str()));
            prop_assert_eq!(Override::parse(&format!("a={word}")).unwrap().value, Value::String(word));
        }
    }
}
