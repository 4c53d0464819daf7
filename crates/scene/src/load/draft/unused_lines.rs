//! Open lines of a drawing that may be meant for cracks, and are none.

use super::roles::Named;
use super::sketch::Sketch;
use crate::fault::{KeyPath, Warning};
use crate::load::drawing::WHOLE_DRAWING;

/// What to say of open lines that nothing in the scene stands for: those without a name, and where a `notch` is made
/// because no crack is drawn those of any name. None where there are none.
pub(super) fn unused_lines(elements: &[Named], sketch: &Sketch, notch: bool) -> Option<Warning> {
    let is_whole = sketch.bodies.iter().any(|body| body == WHOLE_DRAWING);
    let is_unused = |element: &&Named| match &element.name {
        _ if !element.is_open || element.role.is_some() => false,
        None => true,
        Some(name) => notch && sketch.unused.contains(name),
    };
    let unused: Vec<&Named> = elements.iter().filter(is_unused).collect();
    // A drawing of nothing but lines is a body of lines.
    let first = unused.first().filter(|_| !is_whole || unused.len() < elements.len())?;
    let name = first
        .name
        .as_ref()
        .map_or("without id and label".to_owned(), |name| format!("called `{}`", name.escape_debug()));
    let (which, verb) = match unused.len() - 1 {
        0 => (String::new(), "is"),
        more => (format!(" and {more} more"), "are"),
    };
    let role = if is_whole { "a part of the body, as all of a drawing without names" } else { "not used" };
    let instead = if notch { "; a notch starts the crack instead" } else { "" };
    Some(Warning::new(
        KeyPath::setting("drawing", "file"),
        format!(
            "the open <{}> in line {} of the drawing, {name},{which} {verb} {role}{instead}",
            first.tag, first.line
        ),
        if is_whole {
            "if it is a crack, give it the id `crack` and the outline the id `body`"
        } else {
            "if it is a crack, give it the id `crack`; if it is the path of one, `guide`"
        },
    ))
}
