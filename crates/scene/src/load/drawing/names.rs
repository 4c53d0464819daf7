//! Which element a name means: by its id, then by its label.

use crate::load::nearest::nearest;
use crate::load::seating::Complaint;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use usvg::roxmltree::{Document, Node};

/// The name of everything that is drawn.
pub(in crate::load) const WHOLE_DRAWING: &str = "*";
/// Namespace of Inkscape's labels.
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
/// Elements that draw something.
const DRAWN: [&str; 12] =
    ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "g", "use", "a", "svg"];

/// An element that can be meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    id: Option<String>,
    label: Option<String>,
    /// The id by which it is found in the text that [`Names::read`] returns; none for the root.
    pub(super) key: Option<String>,
    tag: String,
    line: u32,
    /// Its number in the document.
    pub(super) number: usize,
    has_text: bool,
}

/// The elements of a drawing by their names.
pub(super) struct Names {
    file: String,
    elements: Vec<Element>,
}

impl Names {
    /// The names in a drawing, and its text with an id for every element that has only a label.
    pub(super) fn read(path: &Path, text: &str, document: &Document<'_>) -> (Self, String) {
        let ids: BTreeSet<&str> = document.descendants().filter_map(|n| n.attribute("id")).collect();
        let mut unused = (1..).map(|i| format!("element-{i}")).filter(|id| !ids.contains(id.as_str()));
        let (mut elements, mut insertions) = (Vec::new(), Vec::new());
        for node in document.descendants().filter(Node::is_element) {
            let is_root = node == document.root_element();
            let id = node.attribute("id").map(str::to_owned);
            let label = node.attribute((INKSCAPE, "label")).or(node.attribute("data-name")).map(str::to_owned);
            if id.is_none() && label.is_none() && !is_root {
                continue;
            }
            let mut key = id.clone().filter(|_| !is_root);
            if let (None, Some(at), false) = (&id, end_of_tag_name(text, &node), is_root) {
                key = unused.next();
                insertions.extend(key.iter().map(|id| (at, format!(" id=\"{id}\""))));
            }
            elements.push(Element {
                tag: node.tag_name().name().to_owned(),
                line: document.text_pos_at(node.range().start).row,
                number: node.id().get_usize(),
                has_text: node.descendants().any(|n| n.tag_name().name() == "text"),
                id,
                label,
                key,
            });
        }
        let file = path.display().to_string();
        (Self { file, elements }, with_insertions(text, insertions))
    }

    /// The element called `name`.
    pub(super) fn find(&self, name: &str) -> Result<&Element, Complaint> {
        let with = |of: fn(&Element) -> Option<&String>| -> Vec<&Element> {
            self.elements.iter().filter(|e| of(e).is_some_and(|n| n == name)).collect()
        };
        let (by_id, by_label) = (with(|e| e.id.as_ref()), with(|e| e.label.as_ref()));
        let root = self.elements.first().filter(|_| name == WHOLE_DRAWING);
        match (by_id.as_slice(), by_label.as_slice(), root) {
            ([only], ..) | ([], [only], _) => Ok(only),
            ([], [], Some(root)) => Ok(root),
            ([first, second, ..], ..) => Err(self.ambiguous("id", name, first, second)),
            ([], [first, second, ..], _) => Err(self.ambiguous("label", name, first, second)),
            ([], [], None) => {
                let drawn = self.elements.iter().filter(|e| DRAWN.contains(&e.tag.as_str()));
                let names: BTreeSet<&str> =
                    drawn.flat_map(|e| [&e.id, &e.label]).flatten().map(String::as_str).collect();
                let message = format!("{} has no element `{name}`", self.file);
                Err((message, nearest(name, &names.into_iter().collect::<Vec<_>>())))
            }
        }
    }

    fn ambiguous(&self, what: &str, name: &str, first: &Element, second: &Element) -> Complaint {
        let (file, a, b) = (&self.file, first.line, second.line);
        let message = format!("two elements have the {what} `{name}`: {file}:{a} and {file}:{b}");
        (message, format!("give each its own {what}"))
    }

    /// Where an element is, and what it is, in words.
    pub(super) fn place(&self, name: &str, element: &Element) -> String {
        format!("`{name}` ({}:{}, <{}>)", self.file, element.line, element.tag)
    }

    /// Why there is nothing of an element.
    pub(super) fn explain_absence(&self, name: &str, element: &Element) -> Complaint {
        let place = self.place(name, element);
        if element.has_text {
            let message = format!("the text {place} gives no outline: it is empty, or no font has its letters");
            return (message, "name a font file: `[drawing] font = \"...ttf\"`, or convert the text to paths".into());
        }
        let remedy = "name a path, a basic shape, a text or a group, outside of <defs>, of a size above 0";
        (format!("{place} draws no line"), remedy.into())
    }
}

/// Where in `text` the tag name of an element ends, if it stands there as such.
fn end_of_tag_name(text: &str, node: &Node<'_, '_>) -> Option<usize> {
    let start = node.range().start;
    let tag = text.get(start..)?.strip_prefix('<')?;
    let length = tag.find(|c: char| c.is_ascii_whitespace() || c == '>' || c == '/')?;
    tag[..length].ends_with(node.tag_name().name()).then_some(start + 1 + length)
}

fn with_insertions(text: &str, insertions: Vec<(usize, String)>) -> String {
    let by_place: HashMap<usize, String> = insertions.into_iter().collect();
    let mut places: Vec<usize> = by_place.keys().copied().collect();
    places.sort_unstable();
    let mut result = String::with_capacity(text.len() + 24 * places.len());
    let mut done = 0;
    for place in places {
        result += &text[done..place];
        result += &by_place[&place];
        done = place;
    }
    result + &text[done..]
}
