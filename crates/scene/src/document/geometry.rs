//! Drawings, shapes and lines of a scene file.

use crate::range::{COORDINATE, LENGTH};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::PathBuf;

/// An SVG drawing and its scale.
///
/// Without `width` and `metres_per_unit` the drawing has the size its units say (mm, cm, in, pt, pc).
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drawing {
    /// SVG file, relative to the scene file. Required.
    pub file: PathBuf,
    /// How many metres the width of the drawing (of its viewBox, if it has one) spans.
    #[schemars(transform = LENGTH.bounds())]
    pub width: Option<f64>,
    /// How many metres one user unit of the drawing (of its viewBox, if it has one) is.
    #[schemars(transform = LENGTH.bounds())]
    pub metres_per_unit: Option<f64>,
    /// Which point of the drawing becomes (0, 0). Default: its centre.
    #[serde(default)]
    pub origin: Origin,
    /// Font file for text in the drawing, relative to the scene file; it replaces families that are not installed.
    pub font: Option<PathBuf>,
}

/// The point of a drawing that becomes (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Origin {
    /// The centre of the drawing.
    #[default]
    #[schemars(with = "CenterWord")]
    Center,
    /// The lower left corner of the drawing.
    #[schemars(with = "CornerWord")]
    Corner,
    /// A point [x, y] in the drawing's user units (y down, as in the SVG).
    Point(#[schemars(transform = COORDINATE.bounds())] [f64; 2]),
}

#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code, reason = "only describes a word to the JSON schema")]
enum CenterWord {
    Center,
}

#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code, reason = "only describes a word to the JSON schema")]
enum CornerWord {
    Corner,
}

impl<'de> Deserialize<'de> for Origin {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OriginVisitor;
        impl<'de> Visitor<'de> for OriginVisitor {
            type Value = Origin;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"center\", \"corner\" or a point [x, y]")
            }
            fn visit_str<E: serde::de::Error>(self, word: &str) -> Result<Origin, E> {
                match word {
                    "center" => Ok(Origin::Center),
                    "corner" => Ok(Origin::Corner),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(word), &self)),
                }
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Origin, A::Error> {
                Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map(Origin::Point)
            }
        }
        deserializer.deserialize_any(OriginVisitor)
    }
}

/// A plane shape: one of these.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Axis-parallel rectangle.
    Rectangle(RectangleKeys),
    /// Circle.
    Circle(CircleKeys),
    /// Polygon: its corners `[[x, y], ...]` in m, or `{ exterior = [...], holes = [[...], ...] }`.
    Polygon(PolygonKeys),
    /// Element of the drawing, by id or label: a path, a basic shape, a text, or a group of them; "*" is all that is
    /// drawn.
    Svg(String),
}

/// Axis-parallel rectangle.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RectangleKeys {
    /// Lower left corner [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub min: [f64; 2],
    /// Upper right corner [x, y] in m.
    #[schemars(transform = COORDINATE.bounds())]
    pub max: [f64; 2],
}

/// Circle.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleKeys {
    /// Centre [x, y] in m. Default: the origin.
    #[serde(default)]
    #[schemars(transform = COORDINATE.bounds())]
    pub center: [f64; 2],
    /// Radius in m.
    #[schemars(transform = LENGTH.bounds())]
    pub radius: f64,
}

/// A polygon, as its corners or with holes.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(with = "PolygonForms")]
pub struct PolygonKeys {
    /// Outer ring [m].
    pub exterior: Vec<[f64; 2]>,
    /// Holes [m].
    pub holes: Vec<Vec<[f64; 2]>>,
}

#[derive(JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
struct PolygonTable {
    /// Corners of the outer ring in m; it closes by itself.
    #[schemars(transform = COORDINATE.bounds())]
    exterior: Vec<[f64; 2]>,
    /// Corners of each hole in m.
    #[serde(default)]
    #[schemars(transform = COORDINATE.bounds())]
    holes: Vec<Vec<[f64; 2]>>,
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[allow(dead_code, reason = "only describes the two forms to the JSON schema")]
enum PolygonForms {
    Corners(#[schemars(transform = COORDINATE.bounds())] Vec<[f64; 2]>),
    Table(PolygonTable),
}

impl<'de> Deserialize<'de> for PolygonKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PolygonVisitor;
        impl<'de> Visitor<'de> for PolygonVisitor {
            type Value = PolygonKeys;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("corners [[x, y], ...] or { exterior = [...], holes = [[...], ...] }")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<PolygonKeys, A::Error> {
                let exterior = Deserialize::deserialize(SeqAccessDeserializer::new(seq))?;
                Ok(PolygonKeys { exterior, holes: Vec::new() })
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PolygonKeys, A::Error> {
                let table = PolygonTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(PolygonKeys { exterior: table.exterior, holes: table.holes })
            }
        }
        deserializer.deserialize_any(PolygonVisitor)
    }
}

/// An open line: its points `[[x, y], ...]` in m (also as `{ points = ... }`), or `{ svg = "id" }`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(with = "LineForms")]
pub enum Line {
    /// Points [m].
    Points(Vec<[f64; 2]>),
    /// Id or label of a path, line or polyline of the drawing.
    Svg(String),
}

#[derive(JsonSchema, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LineTable {
    /// Points [[x, y], ...] in m.
    Points(#[schemars(transform = COORDINATE.bounds())] Vec<[f64; 2]>),
    /// Id of an open path, line or polyline of the drawing.
    Svg(String),
}

#[derive(JsonSchema)]
#[schemars(untagged)]
#[allow(dead_code, reason = "only describes the two forms to the JSON schema")]
enum LineForms {
    Points(#[schemars(transform = COORDINATE.bounds())] Vec<[f64; 2]>),
    Table(LineTable),
}

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LineVisitor;
        impl<'de> Visitor<'de> for LineVisitor {
            type Value = Line;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("points [[x, y], ...] or { svg = \"id\" }")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Line, A::Error> {
                Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map(Line::Points)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Line, A::Error> {
                Ok(match LineTable::deserialize(MapAccessDeserializer::new(map))? {
                    LineTable::Points(points) => Line::Points(points),
                    LineTable::Svg(id) => Line::Svg(id),
                })
            }
        }
        deserializer.deserialize_any(LineVisitor)
    }
}
