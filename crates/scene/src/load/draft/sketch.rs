//! Which elements of a drawing are what.

use super::roles::{NAMES, Named, Role};
use crate::load::drawing::{LoadedDrawing, WHOLE_DRAWING};
use crate::load::seating::Complaint;

/// Most names that a message or a comment lists.
const MOST_LISTED: usize = 24;
/// What to do about a drawing without names.
const NAME_THEM: &str = "call the outline of the body `body` and the crack `crack` (Inkscape: Object > Object properties, or the layer; Illustrator \
                         and Figma: the layer, with ids exported)";

/// What was drawn, by the names of the elements.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Sketch {
    pub(super) bodies: Vec<String>,
    pub(super) cracks: Vec<String>,
    pub(super) guides: Vec<String>,
    pub(super) colliders: Vec<String>,
    /// What has some other name, and is not used.
    pub(super) unused: Vec<String>,
}

impl Sketch {
    /// What the elements of a drawing are: by their names, or because nothing else makes sense.
    ///
    /// # Errors
    /// When no body is found, or an element has a role by its layer but no name by which a scene could mean it.
    pub(super) fn of(elements: &[Named], drawing: &LoadedDrawing) -> Result<Self, Complaint> {
        let mut sketch = Self::default();
        for element in elements {
            let list = match element.role {
                Some(Role::Body) => &mut sketch.bodies,
                Some(Role::Crack) => &mut sketch.cracks,
                Some(Role::Guide) => &mut sketch.guides,
                Some(Role::Collider) => &mut sketch.colliders,
                None => &mut sketch.unused,
            };
            match &element.name {
                Some(name) => list.push(name.clone()),
                None if element.role.is_none() => {}
                None => {
                    let message = format!("the <{}> in line {} has neither id nor label", element.tag, element.line);
                    return Err((message, "give it an id, so that the scene can name it".into()));
                }
            }
        }
        if sketch.bodies.is_empty() {
            sketch.guess_body(elements, drawing)?
        }
        Ok(sketch)
    }

    /// Takes for the body what can be nothing else.
    fn guess_body(&mut self, elements: &[Named], drawing: &LoadedDrawing) -> Result<(), Complaint> {
        if elements.iter().all(|element| element.role.is_none() && element.name.is_none()) && !elements.is_empty() {
            self.bodies.push(WHOLE_DRAWING.to_owned());
            return Ok(());
        }
        let is_line = |name: &String| drawing.line(name, drawing.size() * 1e-3).is_ok();
        let (lines, shapes): (Vec<String>, Vec<String>) = self.unused.iter().cloned().partition(is_line);
        let all_named = elements.iter().all(|element| element.name.is_some());
        match shapes.as_slice() {
            [_] if all_named => {
                self.bodies = shapes;
                self.unused = lines;
                if self.cracks.is_empty() {
                    self.cracks = std::mem::take(&mut self.unused);
                }
                Ok(())
            }
            _ => {
                let named = self.cracks.iter().chain(&self.guides).chain(&self.colliders).chain(&self.unused);
                let there = match listed(named) {
                    names if names.is_empty() => "nothing has an id or a label".to_owned(),
                    names => format!("there are {names}"),
                };
                let message =
                    format!("nothing in the drawing is called a body: looked for ids and labels {NAMES}; {there}");
                Err((message, NAME_THEM.into()))
            }
        }
    }
}

/// The first of some names, for people.
pub(super) fn listed<'n>(mut names: impl Iterator<Item = &'n String>) -> String {
    let mut first: Vec<String> = names.by_ref().take(MOST_LISTED).map(|n| format!("`{}`", n.escape_debug())).collect();
    match names.count() {
        0 => {}
        more => first.push(format!("and {more} more")),
    }
    first.join(", ")
}
