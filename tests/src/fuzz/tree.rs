//! Trees of values, as TOML and JSON have them, and what may happen to them.

use super::random::Random;
use std::fmt::Write;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Tree {
    /// Nothing; JSON only.
    Null,
    /// True or false.
    Bool(bool),
    /// An integer.
    Integer(i64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
    /// An array.
    List(Vec<Tree>),
    /// A table.
    Table(Vec<(String, Tree)>),
}

impl From<toml::Value> for Tree {
    fn from(value: toml::Value) -> Self {
        match value {
            toml::Value::String(text) => Self::Text(text),
            toml::Value::Integer(number) => Self::Integer(number),
            toml::Value::Float(number) => Self::Number(number),
            toml::Value::Boolean(value) => Self::Bool(value),
            toml::Value::Datetime(moment) => Self::Text(moment.to_string()),
            toml::Value::Array(items) => Self::List(items.into_iter().map(Self::from).collect()),
            toml::Value::Table(table) => Self::Table(table.into_iter().map(|(k, v)| (k, v.into())).collect()),
        }
    }
}

impl From<serde_json::Value> for Tree {
    fn from(value: serde_json::Value) -> Self {
        match value {
            serde_json::Value::Null => Self::Null,
            serde_json::Value::Bool(value) => Self::Bool(value),
            serde_json::Value::Number(number) => {
                number.as_i64().map_or_else(|| Self::Number(number.as_f64().unwrap_or(0.0)), Self::Integer)
            }
            serde_json::Value::String(text) => Self::Text(text),
            serde_json::Value::Array(items) => Self::List(items.into_iter().map(Self::from).collect()),
            serde_json::Value::Object(table) => Self::Table(table.into_iter().map(|(k, v)| (k, v.into())).collect()),
        }
    }
}

/// Words that values of text may become: names, keys, choices, paths, and nonsense.
const WORDS: [&str; 41] = [
    "",
    ".",
    "..",
    "../x",
    "/",
    "/dev/zero",
    "a/b",
    "a\nb",
    "\u{0}",
    "é",
    "𝔘",
    "pmma",
    "glass",
    "snow",
    "jello",
    "plate",
    "crack-1",
    "body",
    "b",
    "c",
    "thesis",
    "total",
    "updated",
    "cubic",
    "gimp",
    "pic",
    "apic",
    "aflip",
    "xpic",
    "left",
    "top",
    "both",
    "start",
    "none",
    "drawing.svg",
    "veins.png",
    "1-48",
    "0-99999999999",
    "auto",
    "stress",
    "x",
];

/// Keys that may appear anywhere.
const KEYS: [&str; 36] = [
    "name",
    "material",
    "shape",
    "rectangle",
    "circle",
    "polygon",
    "svg",
    "min",
    "max",
    "center",
    "radius",
    "line",
    "points",
    "tips",
    "guide",
    "select",
    "edge",
    "near",
    "region",
    "force",
    "traction",
    "curve",
    "fix",
    "velocity_x",
    "keyframes",
    "count",
    "density",
    "length",
    "margin",
    "branching",
    "plasticity",
    "range",
    "rate",
    "particle_spacing",
    "cell_size",
    "holes",
];

impl Tree {
    /// Number of values in the tree, itself included.
    pub(super) fn size(&self) -> usize {
        1 + match self {
            Self::List(items) => items.iter().map(Self::size).sum(),
            Self::Table(entries) => entries.iter().map(|(_, value)| value.size()).sum(),
            _ => 0,
        }
    }

    /// The value with the number `index`, in the order of writing.
    fn at(&mut self, index: usize) -> &mut Self {
        if index == 0 {
            return self;
        }
        let mut left = index - 1;
        // Found first, borrowed then.
        let children: Vec<usize> = match self {
            Self::List(items) => items.iter().map(Self::size).collect(),
            Self::Table(entries) => entries.iter().map(|(_, value)| value.size()).collect(),
            _ => Vec::new(),
        };
        let child = children.iter().position(|&size| {
            let is_here = left < size;
            left -= if is_here { 0 } else { size };
            is_here
        });
        match (self, child) {
            (Self::List(items), Some(child)) => items[child].at(left),
            (Self::Table(entries), Some(child)) => entries[child].1.at(left),
            (other, _) => other,
        }
    }

    /// Changes one value of the tree; `other`: a tree of the same kind, to take parts from.
    pub(super) fn mutate(&mut self, random: &mut Random, other: &Self) {
        let place = random.below(self.size());
        match random.below(8) {
            0 => {
                let mut other = other.clone();
                let part = random.below(other.size());
                *self.at(place) = other.at(part).clone();
            }
            1 => *self.at(place) = Self::random(random, 0),
            _ => self.at(place).mutate_here(random),
        }
    }

    fn mutate_here(&mut self, random: &mut Random) {
        match self {
            Self::Null | Self::Bool(_) => *self = Self::Bool(random.once_in(2)),
            Self::Integer(number) => match random.below(4) {
                0 => {
                    *number =
                        *random.pick(&[0, 1, -1, 2, 1000, 1_000_000, i64::MAX, i64::MIN, 1 << 32, 100_000_000_000])
                }
                1 => *self = Self::Number(random.hostile()),
                2 => *number = number.wrapping_add(*random.pick(&[1, -1, 10])),
                _ => *number = random.bits() as i64,
            },
            Self::Number(number) => match random.below(4) {
                0 => *number *= *random.pick(&[-1.0, 10.0, 0.1, 1e6, 1e-6, 1e12, 1.000_000_1]),
                1 => *number = random.plain(),
                _ => *number = random.hostile(),
            },
            Self::Text(text) => text.replace_range(.., random.pick::<&str>(&WORDS)),
            Self::List(items) => mutate_list(items, random),
            Self::Table(entries) => mutate_table(entries, random),
        }
    }

    fn random(random: &mut Random, depth: usize) -> Self {
        match random.below(if depth > 3 { 4 } else { 6 }) {
            0 => Self::Number(random.hostile()),
            1 => Self::Integer(random.bits() as i64),
            2 => Self::Bool(true),
            3 => Self::Text((*random.pick(&WORDS)).to_owned()),
            4 => Self::List((0..random.below(4)).map(|_| Self::random(random, depth + 1)).collect()),
            _ => {
                let entry = |random: &mut Random| ((*random.pick(&KEYS)).to_owned(), Self::random(random, depth + 1));
                Self::Table((0..random.below(4)).map(|_| entry(random)).collect())
            }
        }
    }

    /// The tree as the value of a TOML key, on one line.
    pub(super) fn to_toml(&self, text: &mut String) {
        match self {
            // TOML has no word for it.
            Self::Null => text.push_str("\"\""),
            Self::Number(number) if number.is_nan() => text.push_str("nan"),
            Self::Number(number) if number.is_infinite() => text.push_str(if *number > 0.0 { "inf" } else { "-inf" }),
            Self::Number(number) => drop(write!(text, "{number:?}")),
            Self::List(items) => {
                text.push('[');
                for item in items {
                    item.to_toml(text);
                    text.push(',');
                }
                text.push(']');
            }
            Self::Table(entries) => {
                text.push('{');
                for (i, (key, value)) in entries.iter().enumerate() {
                    text.push_str(if i > 0 { ", " } else { " " });
                    write_text(key, text);
                    text.push('=');
                    value.to_toml(text);
                }
                text.push('}');
            }
            Self::Bool(_) | Self::Integer(_) | Self::Text(_) => self.write_plain(text),
        }
    }

    /// The tree as a TOML document.
    pub(super) fn to_toml_document(&self) -> String {
        let mut text = String::new();
        let Self::Table(entries) = self else { return text };
        for (key, value) in entries {
            write_text(key, &mut text);
            text.push_str(" = ");
            value.to_toml(&mut text);
            text.push('\n');
        }
        text
    }

    /// The tree as JSON.
    pub(super) fn to_json(&self, text: &mut String) {
        match self {
            Self::Null => text.push_str("null"),
            // Neither exists in JSON; the second is too large for a number.
            Self::Number(number) if number.is_nan() => text.push_str("NaN"),
            Self::Number(number) if number.is_infinite() => text.push_str("1e999"),
            Self::Number(number) => drop(write!(text, "{number:?}")),
            Self::List(items) => {
                text.push('[');
                for (i, item) in items.iter().enumerate() {
                    text.push_str(if i > 0 { "," } else { "" });
                    item.to_json(text);
                }
                text.push(']');
            }
            Self::Table(entries) => {
                text.push('{');
                for (i, (key, value)) in entries.iter().enumerate() {
                    text.push_str(if i > 0 { "," } else { "" });
                    write_text(key, text);
                    text.push(':');
                    value.to_json(text);
                }
                text.push('}');
            }
            Self::Bool(_) | Self::Integer(_) | Self::Text(_) => self.write_plain(text),
        }
    }

    fn write_plain(&self, text: &mut String) {
        match self {
            Self::Bool(value) => drop(write!(text, "{value}")),
            Self::Integer(number) => drop(write!(text, "{number}")),
            Self::Text(value) => write_text(value, text),
            _ => {}
        }
    }
}

/// Text in quotes, as TOML and JSON both have it.
fn write_text(value: &str, text: &mut String) {
    text.push('"');
    for c in value.chars() {
        match c {
            '"' | '\\' => text.extend(['\\', c]),
            c if c.is_control() => drop(write!(text, "\\u{:04x}", c as u32)),
            c => text.push(c),
        }
    }
    text.push('"');
}

fn mutate_list(items: &mut Vec<Tree>, random: &mut Random) {
    let at = random.below(items.len());
    match random.below(5) {
        0 if !items.is_empty() => drop(items.remove(at)),
        1 if !items.is_empty() => {
            let copies = *random.pick(&[1, 1, 1, 2, 5, 40]);
            items.extend(vec![items[at].clone(); copies]);
        }
        2 if !items.is_empty() => {
            let with = random.below(items.len());
            items.swap(at, with);
        }
        3 => items.reverse(),
        _ => items.push(Tree::random(random, 0)),
    }
}

fn mutate_table(entries: &mut Vec<(String, Tree)>, random: &mut Random) {
    let at = random.below(entries.len());
    match random.below(5) {
        0 | 1 if !entries.is_empty() => drop(entries.remove(at)),
        2 if !entries.is_empty() => entries[at].0 = (*random.pick(&KEYS)).to_owned(),
        3 if !entries.is_empty() => {
            let with = random.below(entries.len());
            let value = entries[with].1.clone();
            entries[at].1 = value;
        }
        _ => entries.push(((*random.pick(&KEYS)).to_owned(), Tree::random(random, 0))),
    }
}

/// Changes bytes: some flipped, cut out, doubled or put in.
pub(super) fn mutate_bytes(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(16)).min(bytes.len());
        match random.below(7) {
            0 | 1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            2 if !bytes.is_empty() => bytes[at] = random.bits() as u8,
            3 if !bytes.is_empty() => drop(bytes.drain(at..end)),
            4 if !bytes.is_empty() => {
                let part = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, part);
            }
            5 => bytes.truncate(at),
            _ => {
                let value = random.hostile().to_le_bytes();
                bytes.splice(at..(at + 8).min(bytes.len()), value);
            }
        }
    }
}
