//! What a drawing grows to when its references are followed, and whether its numbers can be computed with.

use super::limits::*;
use super::styles::{Styles, too_many_steps};
use std::collections::HashMap;
use usvg::roxmltree::{Document, Node};

/// Attributes whose values are no numbers, although they may hold digits.
const NO_NUMBERS: [&str; 8] = ["id", "class", "style", "href", "lang", "font-family", "fill", "stroke"];

/// Checks the size, the depth and the numbers of a drawing.
pub(super) fn check_document(document: &Document<'_>, styles: &Styles<'_>) -> Result<(), Excess> {
    let root = document.root_element();
    check_page(&root)?;
    let mut by_id: HashMap<&str, Vec<Node<'_, '_>>> = HashMap::new();
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            by_id.entry(id).or_default().push(node);
        }
    }
    let mut walk = Walk { document, styles, by_id, costs: HashMap::new() };
    let cost = walk.cost(root, 0)?;
    let too_many = |count: u64, most: u64, what: &str| {
        let message = format!("the drawing has {count} {what} when its references are followed, more than {most}");
        if count > most { Err(Excess::new(start_of(&root), message)) } else { Ok(()) }
    };
    too_many(cost.elements, MOST_ELEMENTS, "elements")?;
    if cost.elements as f64 * styles.steps_per_element > MOST_STYLE_STEPS {
        return Err(Excess::new(start_of(&root), too_many_steps()));
    }
    too_many(cost.numbers, MOST_NUMBERS, "numbers")?;
    too_many(cost.characters, MOST_CHARACTERS, "characters of text")
}

/// What an element makes with all that is in it and that it refers to.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    elements: u64,
    numbers: u64,
    characters: u64,
    height: usize,
}

struct Walk<'a, 'd> {
    document: &'a Document<'d>,
    styles: &'a Styles<'a>,
    by_id: HashMap<&'a str, Vec<Node<'a, 'd>>>,
    /// None while the cost of an element is being computed.
    costs: HashMap<usize, Option<Cost>>,
}

impl<'a, 'd> Walk<'a, 'd> {
    fn cost(&mut self, node: Node<'a, 'd>, depth: usize) -> Result<Cost, Excess> {
        let key = node.id().get_usize();
        match self.costs.get(&key) {
            Some(Some(cost)) if depth + cost.height <= DEEPEST => return Ok(*cost),
            None if depth <= DEEPEST => {}
            Some(None) => return Err(Excess::new(start_of(&node), "an element contains a reference to itself")),
            _ => {
                let message = format!("elements lie more than {DEEPEST} deep in each other, references included");
                return Err(Excess::new(start_of(&node), message));
            }
        }
        self.costs.insert(key, None);
        let mut cost = Cost { elements: 1, ..Cost::default() };
        for (name, value) in self.styles.declared(node).filter(|(name, _)| !NO_NUMBERS.contains(name)) {
            cost.numbers += count_numbers(value, name == "d").map_err(|OutOfRange(number)| {
                let message = format!(
                    "`{name}` has the number {number}: numbers must lie between -{LARGEST_NUMBER:e} and {LARGEST_NUMBER:e}"
                );
                Excess::new(start_of(&node), message)
            })?;
        }
        if node.tag_name().name() == "text" {
            let texts = node.descendants().filter(Node::is_text).filter_map(|n| n.text());
            cost.characters += texts.map(|text| text.chars().count() as u64).sum::<u64>();
        }
        for child in node.children().filter(Node::is_element) {
            let inside = self.cost(child, depth + 1)?;
            cost.add(inside);
        }
        for (property, id) in self.styles.references(node) {
            let Some(&target) = self.target(property, id)? else { continue };
            let inside = self.cost(target, depth + 1)?;
            cost.add(inside);
        }
        self.costs.insert(key, Some(cost));
        Ok(cost)
    }

    /// The one element that `id` refers to.
    fn target(&self, property: &str, id: &str) -> Result<Option<&Node<'a, 'd>>, Excess> {
        match self.by_id.get(id).map(Vec::as_slice) {
            Some([only]) => Ok(Some(only)),
            Some([first, second, ..]) => {
                let [a, b] = [first, second].map(|n| self.document.text_pos_at(n.range().start).row);
                let message =
                    format!("`{property}` refers to `{id}`, but two elements have this id, in lines {a} and {b}");
                Err(Excess::new(start_of(second), message))
            }
            _ => Ok(None),
        }
    }
}

impl Cost {
    fn add(&mut self, other: Self) {
        self.elements = self.elements.saturating_add(other.elements);
        self.numbers = self.numbers.saturating_add(other.numbers);
        self.characters = self.characters.saturating_add(other.characters);
        self.height = self.height.max(other.height + 1);
    }
}

/// The `<` of an element; its whole range would show pages.
fn start_of(node: &Node<'_, '_>) -> std::ops::Range<usize> {
    node.range().start..node.range().start + 1
}

/// Checks that width, height and viewBox of the drawing make a page.
fn check_page(root: &Node<'_, '_>) -> Result<(), Excess> {
    for name in ["width", "height", "viewBox"] {
        let Some(value) = root.attribute(name) else { continue };
        let sizes = numbers(value, false).skip(if name == "viewBox" { 2 } else { 0 });
        if let Some(small) = sizes.filter_map(|n| n.parse::<f64>().ok()).find(|n| *n < SMALLEST_SIZE) {
            let message = format!("`{name}` says that the drawing is {small} wide or high: at least {SMALLEST_SIZE}");
            return Err(Excess::new(start_of(root), message));
        }
    }
    Ok(())
}

/// The first number of a value that is out of range, as it is written, cut off where it is long.
struct OutOfRange(String);

/// How many numbers there are in a value, or the first that is out of range.
fn count_numbers(value: &str, is_path: bool) -> Result<u64, OutOfRange> {
    let mut count = 0;
    for number in numbers(value, is_path) {
        if number.parse::<f64>().is_ok_and(|n| n.abs() > LARGEST_NUMBER) {
            return Err(OutOfRange(number.chars().take(40).collect()));
        }
        count += 1;
    }
    Ok(count)
}

/// The numbers in a value. Those in words and colours, such as `h2o` and `#1e99ff`, do not count; in path data letters
/// are commands.
fn numbers(value: &str, is_path: bool) -> impl Iterator<Item = &str> {
    let bytes = value.as_bytes();
    let mut at = 0;
    std::iter::from_fn(move || {
        while at < bytes.len() {
            match bytes[at] {
                b'0'..=b'9' | b'.' | b'-' | b'+' => {
                    let length = number_length(&bytes[at..]);
                    let start = at;
                    at += length.max(1);
                    if length > 0 {
                        return Some(&value[start..at]);
                    }
                }
                c if !is_path && (c == b'#' || c == b'_' || c.is_ascii_alphabetic()) => {
                    at += 1;
                    while at < bytes.len() && (bytes[at].is_ascii_alphanumeric() || b"_-".contains(&bytes[at])) {
                        at += 1;
                    }
                }
                _ => at += 1,
            }
        }
        None
    })
}

/// Bytes of the number that `bytes` begin with; 0 when they begin with none.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = usize::from(matches!(bytes.first(), Some(b'-' | b'+')));
    let whole = digits(end);
    end += whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let exponent = digits((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the grammar of SVG, by hand.
    #[test]
    fn numbers_are_found_as_svg_writes_them() {
        let found = |value, is_path| numbers(value, is_path).collect::<Vec<_>>();
        assert_eq!(found("M1-2.5.5e3l-.5+4e", true), ["1", "-2.5", ".5e3", "-.5", "+4"]);
        assert_eq!(found("translate(1e30 -4) rotate(90)", false), ["1e30", "-4", "90"]);
        assert_eq!(found("#1e9999", false), [""; 0]);
        assert_eq!(found("x12 10px 3.", false), ["10", "3."]);
    }
}
