//! Which properties and references are written for an element: as attributes, in its style, or in a style sheet.

use super::limits::{Excess, MOST_SELECTOR_PARTS, MOST_STYLE_STEPS};
use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass, StyleSheet};
use usvg::roxmltree::{Document, Node};

/// Namespace of the older form of references.
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// The style sheets of a drawing.
pub(super) struct Styles<'d> {
    sheet: StyleSheet<'d>,
    /// Steps to find out which rules are for one element.
    pub(super) steps_per_element: f64,
}

impl<'d> Styles<'d> {
    /// Reads the style sheets, after a look at what it takes to find the elements that their rules are for.
    pub(super) fn read(document: &'d Document<'_>) -> Result<Self, Excess> {
        let elements = document.descendants().filter(Node::is_element).count() as f64;
        let depth = document.descendants().map(|n| n.ancestors().take(64).count()).max().unwrap_or_default() as f64;
        let mut sheet = StyleSheet::new();
        let mut steps_per_element = 0.0;
        for node in document.descendants().filter(|n| n.has_tag_name("style")) {
            let text = node.text().unwrap_or_default();
            for selector in text.split('{').flat_map(|part| part.rsplit('}').next().unwrap_or_default().split(',')) {
                let parts =
                    selector.split([' ', '\t', '\n', '\r', '>', '+', '~']).filter(|part| !part.is_empty()).count();
                if parts > MOST_SELECTOR_PARTS {
                    let message = format!("a selector of a style rule has more than {MOST_SELECTOR_PARTS} parts");
                    return Err(Excess::new(node.range(), message));
                }
                steps_per_element += depth.powi(parts.max(1) as i32 - 1);
            }
            if elements * steps_per_element > MOST_STYLE_STEPS {
                return Err(Excess::new(node.range(), too_many_steps()));
            }
            if node.attribute("type").is_none_or(|kind| kind == "text/css") {
                sheet.parse_more(text);
            }
        }
        Ok(Self { sheet, steps_per_element })
    }

    /// All properties that are written for `node`, with their values; of several for one property any may win.
    pub(super) fn declared<'a>(&'a self, node: Node<'a, '_>) -> impl Iterator<Item = (&'a str, &'a str)> {
        let rules = self.sheet.rules.iter().filter(move |rule| rule.selector.matches(&Styled(node)));
        let from_rules = rules.flat_map(|rule| rule.declarations.iter().map(|d| (d.name, d.value)));
        let style = node.attribute("style").unwrap_or_default();
        let from_style = DeclarationTokenizer::from(style).map(|d| (d.name, d.value));
        let attributes = node.attributes().filter(|a| a.namespace().is_none());
        attributes.map(|a| (a.name(), a.value())).chain(from_style).chain(from_rules)
    }

    /// The ids that `node` refers to, with the properties that do.
    pub(super) fn references<'a>(&'a self, node: Node<'a, '_>) -> Vec<(&'a str, &'a str)> {
        // Links lead somewhere, they draw nothing from there.
        let link = href(node).filter(|_| node.tag_name().name() != "a").and_then(|href| href.trim().strip_prefix('#'));
        let mut found: Vec<_> = link.map(|id| ("href", id)).into_iter().collect();
        for (property, value) in self.declared(node) {
            found.extend(urls(value).map(|id| (property, id)));
        }
        found
    }
}

/// What is told when there are too many style rules for so many elements.
pub(super) fn too_many_steps() -> String {
    format!("finding the elements of its style rules takes more than {MOST_STYLE_STEPS:e} steps")
}

/// Where an element refers to as a whole.
pub(super) fn href<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.attribute("href").or(node.attribute((XLINK, "href")))
}

/// The ids in `url(#id)`.
fn urls(value: &str) -> impl Iterator<Item = &str> {
    value.match_indices("url(").filter_map(|(at, _)| {
        let inside = value[at + 4..].split(')').next()?;
        inside.trim_matches(|c: char| c.is_ascii_whitespace() || c == '"' || c == '\'').strip_prefix('#')
    })
}

/// An element as style rules see it.
struct Styled<'a, 'd>(Node<'a, 'd>);

impl simplecss::Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        class == PseudoClass::FirstChild && self.0.prev_sibling_element().is_none()
    }
}
