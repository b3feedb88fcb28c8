//! Suggestions for misspelled words: the nearest known word.

/// Levenshtein distance, case-insensitive.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(64).flat_map(char::to_lowercase).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().take(64).flat_map(char::to_lowercase).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// The nearest known word, if it is close enough.
pub fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    // Two swapped letters count as two replacements.
    let limit = if length < 4 { 1 } else { (length / 3).clamp(2, 3) };
    known.map(|k| (edit_distance(word, k), k)).filter(|k| k.0 <= limit).min().map(|k| k.1)
}

/// `"a", "b" or "c"`.
pub fn quoted<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.map(|w| format!("\"{w}\"")).collect();
    match words.split_last() {
        None => "nothing".into(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
    }
}

/// What to write instead of `word`.
pub fn hint<'a>(word: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    const MAX_SUGGESTIONS: usize = 24;
    let count = known.clone().count();
    if count == 0 {
        return "none is defined: define it first, or leave this out".into();
    }
    let mut list = known.clone().take(MAX_SUGGESTIONS).collect::<Vec<_>>().join(", ");
    if count > MAX_SUGGESTIONS {
        list.push_str(", …");
    }
    match nearest(word, known) {
        Some(near) => format!("{near}   (did you mean it? known are: {list})"),
        None if count == 1 => list,
        None => format!("one of: {list}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distances_agree_with_the_textbook() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("Radius", "radius"), 0);
    }

    #[test]
    fn near_words_are_proposed_and_far_ones_are_not() {
        let known = ["radius", "height", "warning"];
        assert_eq!(nearest("raduis", known.into_iter()), Some("radius"));
        assert_eq!(nearest("modle", ["model", "srdf", "base"].into_iter()), Some("model"));
        assert_eq!(nearest("colour", known.into_iter()), None);
        assert_eq!(quoted(known.into_iter()), "\"radius\", \"height\" or \"warning\"");
    }
}
