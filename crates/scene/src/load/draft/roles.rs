//! What the elements of a drawing are for, by their names.

use kurbo::{BezPath, ParamCurve, PathEl};
use usvg::roxmltree::{Document, Node};

/// What an element stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Body,
    Crack,
    Guide,
    Collider,
}

/// The names that say so, also in the plural and numbered.
pub(super) const NAMES: &str = "`body`, `crack`, `guide` and `collider` (any case, also numbered: `Crack 2`)";

/// Elements whose content is not drawn where it stands.
const NOT_DRAWN: [&str; 10] =
    ["defs", "clipPath", "mask", "symbol", "marker", "pattern", "metadata", "style", "title", "desc"];
/// Elements that draw a shape or a line.
const DRAWN: [&str; 9] = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "use"];
const CONTAINERS: [&str; 4] = ["g", "a", "svg", "switch"];

/// An element and what it is for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Named {
    /// What its name, or that of a layer around it, says; none: nothing.
    pub(super) role: Option<Role>,
    /// Id, or label where there is no id.
    pub(super) name: Option<String>,
    /// Line of the drawing it stands in.
    pub(super) line: u32,
    pub(super) tag: String,
    /// Whether it is a line with two ends, as a crack is.
    pub(super) is_open: bool,
}

/// The elements that draw something, in the order of the drawing. A group that is called a body is one element, and so
/// is one that is called something else and has one member; of other groups the members count.
pub(super) fn elements(document: &Document<'_>) -> Vec<Named> {
    let mut found = Vec::new();
    document.root_element().children().for_each(|child| collect(child, None, &mut found));
    found
}

fn collect(node: Node<'_, '_>, around: Option<Role>, found: &mut Vec<Named>) {
    let tag = node.tag_name().name();
    if !node.is_element() || NOT_DRAWN.contains(&tag) {
        return;
    }
    let role = own_role(&node).or(around);
    let is_container = CONTAINERS.contains(&tag);
    let members = || node.descendants().skip(1).filter(|n| DRAWN.contains(&n.tag_name().name()));
    let is_whole = (role == Some(Role::Body) || own_role(&node).is_some() && members().count() == 1)
        && !node.descendants().skip(1).any(|n| own_role(&n).is_some());
    if is_container && !is_whole {
        node.children().for_each(|child| collect(child, role, found));
    } else if is_container || DRAWN.contains(&tag) {
        found.push(Named {
            role,
            name: names(&node).next().map(str::to_owned),
            line: node.document().text_pos_at(node.range().start).row,
            tag: tag.to_owned(),
            is_open: is_open(&node),
        });
    }
}

/// Whether an element draws lines that do not come back to where they begin.
fn is_open(node: &Node<'_, '_>) -> bool {
    match node.tag_name().name() {
        "line" => true,
        "polyline" => {
            let numbers = node.attribute("points").unwrap_or_default().split(|c: char| c.is_whitespace() || c == ',');
            let numbers: Vec<&str> = numbers.filter(|number| !number.is_empty()).collect();
            numbers.len() > 3 && numbers[..2] != numbers[numbers.len() - 2..]
        }
        "path" => BezPath::from_svg(node.attribute("d").unwrap_or_default()).is_ok_and(|path| {
            let closes = path.iter().any(|element| element == PathEl::ClosePath);
            let ends = path.segments().next().zip(path.segments().last());
            !closes && ends.is_some_and(|(first, last)| first.start() != last.end())
        }),
        _ => false,
    }
}

/// Id and labels of an element.
fn names<'n>(node: &Node<'n, '_>) -> impl Iterator<Item = &'n str> + use<'n> {
    const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
    [node.attribute("id"), node.attribute((INKSCAPE, "label")), node.attribute("data-name")].into_iter().flatten()
}

fn own_role(node: &Node<'_, '_>) -> Option<Role> {
    names(node).find_map(role)
}

/// What a name says: one of the words, perhaps with a number behind.
pub(super) fn role(name: &str) -> Option<Role> {
    const WORDS: [(&str, Role); 8] = [
        ("bodies", Role::Body),
        ("body", Role::Body),
        ("cracks", Role::Crack),
        ("crack", Role::Crack),
        ("guides", Role::Guide),
        ("guide", Role::Guide),
        ("colliders", Role::Collider),
        ("collider", Role::Collider),
    ];
    // Illustrator writes the characters that an id cannot have as `_x20_`.
    let name = name.trim().to_lowercase().replace("_x20_", " ").replace("_x5f_", "_").replace("_x2d_", "-");
    WORDS.iter().find_map(|(word, role)| {
        let rest = name.strip_prefix(word)?;
        let number = rest.trim_matches(|c: char| c.is_whitespace() || "_-.#:()".contains(c));
        number.chars().all(|c| c.is_ascii_digit()).then_some(*role)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_say_what_elements_are() {
        for name in ["body", "Body 2", "BODY_01", "body-1", " Bodies", "body2", "Body_x20_3", "body (2)"] {
            assert_eq!(role(name), Some(Role::Body), "{name}");
        }
        assert_eq!(role("CRACK_01"), Some(Role::Crack));
        assert_eq!(role("guide.3"), Some(Role::Guide));
        assert_eq!(role("Colliders"), Some(Role::Collider));
        for name in ["bodywork", "crack path", "my crack", "path12", "", "crackle-1", "1 body"] {
            assert_eq!(role(name), None, "{name}");
        }
    }

    #[test]
    fn layers_hand_their_names_down() {
        let svg =
            "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape'>
            <defs><path id='body'/></defs>
            <g id='layer1' inkscape:label='Body 1'><g id='a'><path id='p1'/><path id='p2'/></g></g>
            <g id='Cracks'><path id='p3'/><g><line inkscape:label='left one'/><path/></g></g>
            <g id='body-9'><rect id='p5'/><path id='guide'/></g><circle id='p6'/></svg>";
        let document = Document::parse(svg).unwrap();
        let found: Vec<_> = elements(&document).into_iter().map(|e| (e.role, e.name)).collect();
        let name = |s: &str| Some(s.to_owned());
        let truth = [
            (Some(Role::Body), name("layer1")),
            (Some(Role::Crack), name("p3")),
            (Some(Role::Crack), name("left one")),
            (Some(Role::Crack), None),
            (Some(Role::Body), name("p5")),
            (Some(Role::Guide), name("guide")),
            (None, name("p6")),
        ];
        assert_eq!(found, truth);
    }
}
