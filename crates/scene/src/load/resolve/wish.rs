//! What a scene wants of its resolution.

use super::{Resolved, Resolver};
use crate::fault::{KeyPath, SceneFault};
use crate::wish::{Wish, WishError};

impl Resolver<'_> {
    /// The wish of the document, if it has one: it takes the place of a resolution.
    pub(super) fn wish(&self) -> Resolved<Option<Wish>> {
        let keys = &self.document.grid;
        type Read = fn(&str) -> Result<Wish, WishError>;
        let wishes: [(&str, &Option<String>, Read); 2] =
            [("accuracy", &keys.accuracy, Wish::accuracy), ("budget", &keys.budget, Wish::budget)];
        let Some((key, word, read)) = wishes.iter().find_map(|(key, word, read)| Some((*key, word.as_ref()?, read)))
        else {
            return Ok(None);
        };
        let path = KeyPath::setting("grid", key);
        let others = [
            ("budget", keys.budget.is_some() && key != "budget"),
            ("particle_spacing", keys.particle_spacing.is_some()),
            ("cell_size", keys.cell_size.is_some()),
        ];
        if let Some((other, _)) = others.iter().find(|(_, given)| *given) {
            let message = format!("both `{key}` and `{other}` are given, and each says how fine the scene is");
            let remedy = format!("leave `{other}` out: `{key}` chooses particles and cells; or leave `{key}` out");
            return Err(SceneFault::new(path, message, remedy));
        }
        let wrong = |error: WishError| SceneFault::new(path, format!("`{key}` cannot be `{word}`"), error.to_string());
        read(word).map(Some).map_err(wrong)
    }
}
