//! Suggestions for mistyped names.

/// The text ` (did you mean `NAME`?)` with the name in `known` that is most similar to `name`;
/// empty if none is similar. Letter case is ignored. For error messages.
///
/// ```
/// let known = ["sphere", "torus"];
/// assert_eq!(geobench_mesh::did_you_mean("Tours", &known), " (did you mean `torus`?)");
/// assert_eq!(geobench_mesh::did_you_mean("box", &known), "");
/// ```
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    let name = name.to_lowercase();
    let most = |known: &str| (1 + known.len() / 3).min(name.len() / 2);
    // A beginning of three letters or more is similar, but less than any misspelling.
    let edits = |known: &str| match strsim::damerau_levenshtein(&name, known) {
        edits if edits <= most(known) => Some(edits),
        _ if name.len() >= 3 && known.starts_with(&name) => Some(usize::MAX),
        _ => None,
    };
    known
        .iter()
        .filter_map(|known| Some((edits(known)?, known)))
        .min()
        .map_or_else(String::new, |(_, known)| {
            format!(" (did you mean `{known}`?)")
        })
}

#[cfg(test)]
mod tests {
    use super::did_you_mean;

    #[test]
    fn misspellings_are_found_and_nothing_else() {
        let known = ["sphere", "uvsphere", "torus", "tetrahedron"];
        let found = |name| did_you_mean(name, &known);
        assert_eq!(found("shpere"), " (did you mean `sphere`?)");
        assert_eq!(found("Tours"), " (did you mean `torus`?)");
        assert_eq!(found("tetraeder"), " (did you mean `tetrahedron`?)");
        assert_eq!(found("tetra"), " (did you mean `tetrahedron`?)");
        assert_eq!(found("te"), "");
        assert_eq!(did_you_mean("foo", &["box", "fmm"]), "");
        assert_eq!(found("xyz"), "");
        assert_eq!(found(""), "");
        assert_eq!(found(&"sphere".repeat(9)), "");
    }
}
