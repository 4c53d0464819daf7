//! The word that was meant.

/// "; did you mean `x`?"-like help: the known name nearest to `name`, if one is near enough, and all of them if they
/// are few.
pub(crate) fn nearest(name: &str, known: &[impl AsRef<str>]) -> String {
    let best = known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(&name.to_lowercase(), &k.as_ref().to_lowercase()), k.as_ref()))
        .min();
    let list = || known.iter().map(|k| format!("`{}`", k.as_ref())).collect::<Vec<_>>().join(", ");
    match best {
        None => "there are none".into(),
        Some((distance, k)) if distance <= 1 + k.len().min(name.len()) / 3 => format!("did you mean `{k}`?"),
        Some(_) if known.len() <= 24 => format!("there are {}", list()),
        Some((_, k)) => format!("there are {} others, the nearest is `{k}`", known.len()),
    }
}
