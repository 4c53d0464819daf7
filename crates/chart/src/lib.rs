//! Charts of numbers as SVG: lines on linear or logarithmic axes, bars of parts, maps of two parameters,
//! drawings to scale.
//!
//! Promises: one file suits light and dark pages, because colours are classes of a style sheet that asks for the
//! preference of the reader; text is text; the same numbers give the same bytes. Does not promise interaction, nor a
//! layout for any size: a figure is as wide as a page of text, and grows downwards.
//!
//! Libraries for charts write fixed colours into every element, so that each figure would be two files.
//!
//! A [`Figure`] has [`Panel`]s, each with a [`Plot`]; [`Figure::to_svg`] draws it.
//!
//! ```
//! use fissure_chart::{Axis, Figure, Line, Panel, Plot};
//!
//! let line = Line { name: "second order".into(), points: vec![(4.0, 0.04), (8.0, 0.01)], ..Line::default() };
//! let plot = Plot::Lines { x: Axis::logarithmic("cells"), y: Axis::logarithmic("error"), lines: vec![line] };
//! let figure = Figure {
//!     title: "Errors".into(),
//!     caption: vec!["Made up.".into()],
//!     columns: 1,
//!     panels: vec![Panel { title: "A case".into(), plot }],
//! };
//! assert!(figure.to_svg().starts_with("<svg"));
//! ```

mod axis;
mod bars;
mod drawing;
mod figure;
mod lines;
mod map;
mod style;
mod svg;

pub use axis::{Axis, Scale, word};
pub use bars::Bar;
pub use drawing::Stroke;
pub use figure::{Figure, Panel, Plot};
pub use lines::Line;
pub use map::Map;
