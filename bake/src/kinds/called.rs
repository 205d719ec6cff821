//! Words of a person → the kinds that they mean.

use genescape_schema::{Kind, Kinds};

use crate::bad_input::BadInput;

/// Those that words of a person mean.
///
/// # Errors
/// A word that means none, with those that are near.
pub fn called<'a>(kinds: &'a Kinds, words: &[String]) -> Result<Vec<&'a Kind>, BadInput> {
    let mut all = Vec::new();
    for word in words {
        let meant = meant(kinds, word);
        if meant.is_empty() {
            return Err(BadInput(format!("there is no kind {word}{}", near(kinds, word))));
        }
        all.extend(meant);
    }
    Ok(all)
}

/// The one of that name, or those that have it as a word of theirs.
fn meant<'a>(kinds: &'a Kinds, word: &str) -> Vec<&'a Kind> {
    let exact: Vec<&Kind> = kinds.iter().filter(|kind| kind.id == word).collect();
    if exact.is_empty() { kinds.iter().filter(|kind| kind.is_called(word)).collect() } else { exact }
}

fn near(kinds: &Kinds, word: &str) -> String {
    let names = kinds.iter().flat_map(|kind| std::iter::once(kind.id.as_str()).chain(kind.id.split('_')));
    let near = names.map(|name| (strsim::osa_distance(word, name), name)).min();
    near.filter(|(distance, _)| *distance <= 2.max(word.len() / 3))
        .map_or("; `bake kinds` lists all".to_owned(), |(_, id)| format!("; did you mean {id}?"))
}
