//! What an element has that its outline does not show: masks, filters, patterns, pictures, references to elsewhere.

use super::styles::{Styles, href};
use crate::load::seating::Complaint;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use usvg::roxmltree::{Document, Node, NodeId};

/// Effects that are kept; more of them say nothing new.
const MOST: usize = 64;

/// What is not applied.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Kind {
    Mask,
    Filter,
    Pattern,
    Picture,
    /// A reference to something that is not in the drawing.
    Elsewhere(String),
}

/// An effect and the elements that it is seen in, by their numbers in the document.
struct Effect {
    kind: Kind,
    /// The element that has it, and its line.
    tag: String,
    line: u32,
    /// That element, all around it, and all that refer to one of these.
    around: BTreeSet<usize>,
    /// That element and all inside of it; none for what concerns a picture or a reference alone.
    inside: Range<usize>,
}

/// The effects of a drawing.
pub(super) struct Effects(Vec<Effect>);

impl Effects {
    pub(super) fn read(document: &Document<'_>, styles: &Styles<'_>) -> Self {
        let by_id: HashMap<&str, Node<'_, '_>> =
            document.descendants().filter_map(|n| Some((n.attribute("id")?, n))).collect();
        let (mut found, mut users) = (Vec::new(), HashMap::<usize, Vec<usize>>::new());
        for node in document.descendants().filter(Node::is_element) {
            let number = node.id().get_usize();
            for target in styles.references(node).iter().filter_map(|(_, id)| by_id.get(id)) {
                users.entry(target.id().get_usize()).or_default().push(number);
            }
            if found.len() < MOST {
                found.extend(kinds(node, styles, &by_id).map(|kind| (node, kind)));
            }
        }
        let effect = |(node, kind): (Node<'_, '_>, Kind)| {
            let number = node.id().get_usize();
            let count = if matches!(kind, Kind::Picture | Kind::Elsewhere(_)) { 0 } else { node.descendants().count() };
            Effect {
                kind,
                tag: node.tag_name().name().to_owned(),
                line: document.text_pos_at(node.range().start).row,
                around: around(node, document, &users),
                inside: number..number + count,
            }
        };
        Self(found.into_iter().map(effect).collect())
    }

    fn of(&self, number: usize) -> impl Iterator<Item = &Effect> {
        self.0.iter().filter(move |e| e.around.contains(&number) || e.inside.contains(&number))
    }

    /// That nothing cuts pieces out of element `number`, which is at `place`.
    pub(super) fn check_masks(&self, number: usize, place: &str) -> Result<(), Complaint> {
        self.of(number).find(|e| e.kind == Kind::Mask).map_or(Ok(()), |e| {
            let message =
                format!("{place}: the mask of the <{}> in line {} cannot be applied to an outline", e.tag, e.line);
            Err((message, "turn the mask into a clip, or cut the outline itself, in the SVG editor".into()))
        })
    }

    /// What element `number`, which is at `place`, has that its area does not show.
    pub(super) fn remarks(&self, number: usize, place: &str) -> Vec<Complaint> {
        let remark = |e: &Effect| {
            let (tag, line) = (&e.tag, e.line);
            let (what, remedy) = match &e.kind {
                Kind::Mask => return None,
                Kind::Filter => (
                    format!("the filter of the <{tag}> in line {line} does not change the outline"),
                    "remove the filter",
                ),
                Kind::Pattern => (
                    format!("the pattern of the <{tag}> in line {line} counts as a full fill"),
                    "draw its parts as shapes if they are meant",
                ),
                Kind::Picture => {
                    (format!("the <{tag}> in line {line} has no outline and is left out"), "trace it in the SVG editor")
                }
                Kind::Elsewhere(target) => (
                    format!(
                        "the <{tag}> in line {line} refers to `{target}`, which is not in the drawing, and is left out"
                    ),
                    "copy what it refers to into the drawing",
                ),
            };
            Some((format!("{place}: {what}"), remedy.to_owned()))
        };
        self.of(number).filter_map(remark).collect()
    }
}

/// The effects that an element itself has.
fn kinds(node: Node<'_, '_>, styles: &Styles<'_>, by_id: &HashMap<&str, Node<'_, '_>>) -> impl Iterator<Item = Kind> {
    let tag = node.tag_name().name();
    let mut kinds = Vec::new();
    for (property, value) in styles.declared(node) {
        match property {
            "mask" if value != "none" => kinds.push(Kind::Mask),
            "filter" if value != "none" => kinds.push(Kind::Filter),
            _ => {}
        }
    }
    let is_pattern = |id: &str| by_id.get(id).is_some_and(|n| n.tag_name().name() == "pattern");
    if styles.references(node).iter().any(|(property, id)| ["fill", "stroke"].contains(property) && is_pattern(id)) {
        kinds.push(Kind::Pattern);
    }
    match (tag, href(node)) {
        ("image", _) => kinds.push(Kind::Picture),
        ("use", Some(target)) if target.trim().strip_prefix('#').is_none_or(|id| !by_id.contains_key(id)) => {
            kinds.push(Kind::Elsewhere(target.chars().take(80).collect()));
        }
        _ => {}
    }
    kinds.dedup();
    kinds.into_iter()
}

/// The element, all around it, and all that refer to one of these.
fn around(node: Node<'_, '_>, document: &Document<'_>, users: &HashMap<usize, Vec<usize>>) -> BTreeSet<usize> {
    let mut around = BTreeSet::new();
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        for around_it in node.ancestors() {
            if !around.insert(around_it.id().get_usize()) {
                break;
            }
            let using = users.get(&around_it.id().get_usize()).into_iter().flatten();
            open.extend(using.filter_map(|&user| document.get_node(NodeId::from(user))));
        }
    }
    around
}
