//! How much a drawing may ask for, so that no file takes the machine down.
//!
//! Each limit is far above what drawings of people need, and low enough that what comes close to it is still read in
//! about a second.

use std::ops::Range;

/// Bytes that the entities of a drawing may add to its text.
pub(super) const MOST_ENTITY_BYTES: u64 = 256 << 10;
/// Attributes of an element.
pub(super) const MOST_ATTRIBUTES: usize = 100;
/// Elements, texts and comments as they are written.
pub(super) const MOST_NODES: u32 = 200_000;
/// Elements when every reference is replaced by what it refers to.
pub(super) const MOST_ELEMENTS: u64 = 200_000;
/// Numbers in paths and lists, when every reference is replaced by what it refers to.
pub(super) const MOST_NUMBERS: u64 = 4_000_000;
/// Characters that are drawn, when every reference is replaced by what it refers to.
pub(super) const MOST_CHARACTERS: u64 = 5_000;
/// Elements inside each other, references included.
pub(super) const DEEPEST: usize = 128;
/// Steps to find the elements that style rules are for.
pub(super) const MOST_STYLE_STEPS: f64 = 1e7;
/// Parts of a selector of a style rule, such as `g > .thin path`.
pub(super) const MOST_SELECTOR_PARTS: usize = 8;
/// The largest number: beyond, single precision overflows in products.
pub(super) const LARGEST_NUMBER: f64 = 1e9;
/// The smallest width and height of a drawing.
pub(super) const SMALLEST_SIZE: f64 = 1e-6;

/// Segments of a path whose stroke is an area.
pub(super) const MOST_STROKED_SEGMENTS: usize = 20_000;
/// Dashes of a path.
pub(super) const MOST_DASHES: f64 = 20_000.0;
/// Points that the curves of one element may be flattened to.
pub(super) const MOST_POINTS: usize = 200_000;
/// Crossings of the outlines of one element.
pub(super) const MOST_CROSSINGS: usize = 20_000;
/// Pairs of edges that may be looked at to count these.
pub(super) const MOST_PAIRS: usize = 200_000_000;
/// Strips between the edges of shapes that share an edge.
pub(super) const MOST_STRIPS: usize = 100_000;
/// Parts that an element may fall into.
pub(super) const MOST_PARTS: usize = 2_000;

/// Something that goes beyond a limit: the bytes of the text where it is, and what it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Excess {
    pub(super) span: Range<usize>,
    pub(super) message: String,
}

impl Excess {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { span, message: message.into() }
    }
}
