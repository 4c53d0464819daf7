//! The table of ranges as bounds in the JSON schema, so that editors tell what the program would.

use super::Range;
use schemars::Schema;
use schemars::transform::Transform;
use serde_json::{Map, Value, json};

/// Puts a range on the numbers of a key: on the number itself, on both components of a point, on those of all points of
/// a list.
pub(crate) struct Bounds(Range);

/// Puts two ranges on the numbers of pairs: on what a curve goes over, and on its values.
pub(crate) struct PairBounds(Range, Range);

/// Bounds of a curve: pairs of what it goes over and its value.
pub(crate) fn pairs(over: Range, value: Range) -> PairBounds {
    PairBounds(over, value)
}

impl Range {
    /// The range as a transform of a schema.
    pub(crate) fn bounds(self) -> Bounds {
        Bounds(self)
    }

    /// Keywords of JSON schema and their values. Where infinity is allowed no upper end is given: JSON has no infinity.
    fn keywords(self) -> Map<String, Value> {
        let [low, high] = self.ends;
        let mut keywords = Map::new();
        keywords.insert(if low { "minimum" } else { "exclusiveMinimum" }.to_owned(), json!(self.low));
        if self.infinity.is_none() {
            keywords.insert(if high { "maximum" } else { "exclusiveMaximum" }.to_owned(), json!(self.high));
        }
        keywords
    }
}

impl Transform for Bounds {
    fn transform(&mut self, schema: &mut Schema) {
        let mut here = schema.as_object_mut();
        // Down through lists to what they are lists of.
        while let Some(object) = here {
            if !object.contains_key("items") {
                object.extend(self.0.keywords());
                return;
            }
            here = object.get_mut("items").and_then(Value::as_object_mut);
        }
    }
}

impl Transform for PairBounds {
    fn transform(&mut self, schema: &mut Schema) {
        let pair = schema.get_mut("items").and_then(Value::as_object_mut);
        if let Some((pair, number)) = pair.and_then(|pair| pair.remove("items").map(|number| (pair, number))) {
            let bounded = [self.0, self.1].map(|range| {
                let mut number = number.clone();
                if let Some(object) = number.as_object_mut() {
                    object.extend(range.keywords());
                }
                number
            });
            pair.insert("prefixItems".to_owned(), json!(bounded));
        }
    }
}
