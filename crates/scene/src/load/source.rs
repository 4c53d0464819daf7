//! A scene file as text, its overrides, and where each key is written.

use super::error::{LoadError, LoadErrorKind};
use super::explain::{explain, syntax_remedy};
use super::overrides::Override;
use super::place::Place;
use crate::document::Document;
use crate::fault::{Key, KeyPath, SceneFault};
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// A scene file with its overrides.
#[derive(Debug)]
pub(crate) struct SceneSource {
    pub(crate) path: PathBuf,
    pub(crate) text: String,
    overrides: Vec<(KeyPath, Override)>,
}

impl SceneSource {
    /// Parses the text of the scene file at `path` and applies `overrides` to it.
    pub(crate) fn parse(path: &Path, text: String, overrides: &[String]) -> Result<(Self, Document), LoadError> {
        let malformed = |e: toml::de::Error| {
            let message = format!("not valid TOML: {}", e.message());
            let start = e.span().map_or(0, |span| span.start.min(text.len()));
            let before = text.get(..start).and_then(|t| t.rfind('\n')).map_or(0, |at| at + 1);
            let line = text.get(before..).and_then(|rest| rest.lines().next()).unwrap_or_default();
            let malformed = LoadError::malformed(path, &text, e.span(), message, syntax_remedy(&text, line));
            // The file could be read; it is the scene that is wrong.
            LoadError { kind: LoadErrorKind::Scene, ..malformed }
        };
        let mut table: toml::Table = toml::from_str(&text).map_err(malformed)?;
        let mut applied = Vec::new();
        for argument in overrides {
            let set = Override::parse(argument).map_err(|(message, remedy)| set_error(argument, message, remedy))?;
            let path = set.apply(&mut table).map_err(|(message, remedy)| set_error(argument, message, remedy))?;
            applied.push((path, set));
        }
        let source = Self { path: path.into(), text: text.clone(), overrides: applied };
        let document = source.document(table)?;
        Ok((source, document))
    }

    fn document(&self, table: toml::Table) -> Result<Document, LoadError> {
        serde_path_to_error::deserialize(toml::Value::Table(table)).map_err(|error| {
            let mut path = KeyPath(
                error
                    .path()
                    .iter()
                    .filter_map(|segment| match segment {
                        serde_path_to_error::Segment::Seq { index } => Some(Key::Index(*index)),
                        serde_path_to_error::Segment::Map { key } => Some(Key::Name(key.clone())),
                        serde_path_to_error::Segment::Enum { variant } => Some(Key::Name(variant.clone())),
                        serde_path_to_error::Segment::Unknown => None,
                    })
                    .collect(),
            );
            let (message, remedy) = explain(error.inner().message(), &mut path, &self.written());
            self.error(SceneFault::new(path, message, remedy))
        })
    }

    /// Everything that is written, overrides included, for messages: parsed anew, so that a sound scene does not keep
    /// it twice.
    fn written(&self) -> toml::Value {
        let mut table: toml::Table = toml::from_str(&self.text).unwrap_or_default();
        // They went in without complaint before.
        self.overrides.iter().for_each(|(_, set)| drop(set.apply(&mut table)));
        toml::Value::Table(table)
    }

    /// The paths of the keys that overrides set, in their order.
    pub(crate) fn set_paths(&self) -> impl Iterator<Item = &KeyPath> {
        self.overrides.iter().map(|(path, _)| path)
    }

    /// A fault of the scene, shown where its key is written: in the file, or in the override that set it.
    pub(crate) fn error(&self, fault: SceneFault) -> LoadError {
        LoadError::fault(self.locate(&fault.path), fault)
    }

    /// Where `path` is written: file or override, its text, and the bytes meant. The deepest part that is written
    /// counts.
    pub(crate) fn locate(&self, path: &KeyPath) -> Place {
        let set = self.overrides.iter().rev().find(|(set, _)| {
            let common = set.0.len().min(path.0.len());
            set.0[..common] == path.0[..common] && path.0.len() >= set.0.len()
        });
        if let Some((_, set)) = set {
            let (path, text) = (format!("--set {}", set.argument).into(), set.argument.clone());
            return Place { path, span: Some(0..text.len()), text };
        }
        Place { path: self.path.clone(), text: self.text.clone(), span: self.span(path) }
    }

    /// Bytes of the file where the deepest part of `path` that is written there stands.
    fn span(&self, path: &KeyPath) -> Option<Range<usize>> {
        let file = DeTable::parse(&self.text).ok()?;
        let mut span = None;
        let mut here: Option<&DeValue<'_>> = None;
        for (depth, key) in path.0.iter().enumerate() {
            let table = if depth == 0 { Some(file.get_ref()) } else { here.and_then(DeValue::as_table) };
            let next = match key {
                Key::Name(name) => table.and_then(|t| t.get_key_value(name.as_str())).map(|(key, value)| {
                    // A whole table in braces or brackets is shown by its key, a plain value by itself.
                    let plain = !value.get_ref().is_table() && !value.get_ref().is_array();
                    (if plain { value.span() } else { key.span() }, value)
                }),
                Key::Index(index) => {
                    here.and_then(DeValue::as_array).and_then(|a| a.get(*index)).map(|value| (value.span(), value))
                }
            };
            let Some((range, value)) = next else { break };
            span = Some(range);
            here = Some(value.get_ref());
        }
        span
    }
}

fn set_error(argument: &str, message: String, remedy: String) -> LoadError {
    LoadError {
        kind: super::LoadErrorKind::Scene,
        path: PathBuf::from(format!("--set {argument}")).into(),
        source_text: Some(argument.into()),
        span: Some(0..argument.len()),
        message,
        remedy,
    }
}
