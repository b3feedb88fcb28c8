//! Words that a standard term has replaced.

use std::path::Path;

use toml::{Table, Value};

/// The list, below the root.
pub const LIST: &str = "docs/retired-terms.toml";

/// A word or phrase that is written no more.
#[derive(Debug)]
pub struct Term {
    /// As it stood: matched as a whole word, with its case.
    word: String,
    /// What to write.
    instead: String,
    /// Files (or folders, ending in `/`) in which it still means something else.
    except: Vec<String>,
    /// Only in these files; everywhere where this is empty.
    within: Vec<String>,
}

/// Reads the list: `exempt` files, then `[[term]]` with `word` (one or several), `instead`, and `except` or `within`.
pub fn read(path: &Path) -> Result<Vec<Term>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    parse(&text).map_err(|e| format!("{}: {e}", path.display()))
}

fn parse(text: &str) -> Result<Vec<Term>, String> {
    let table: Table = text.parse().map_err(|e| format!("{e}"))?;
    let entries = table.get("term").and_then(Value::as_array).ok_or("no [[term]]")?;
    let exempt = strings(table.get("exempt"));
    let mut terms = Vec::new();
    for entry in entries {
        let instead = entry.get("instead").and_then(Value::as_str).ok_or("a [[term]] without `instead`")?;
        let words = strings(entry.get("word"));
        if words.is_empty() {
            return Err(format!("the [[term]] with instead = \"{instead}\" has no `word`"));
        }
        for word in words {
            let except = exempt.iter().cloned().chain(strings(entry.get("except"))).collect();
            let within = strings(entry.get("within"));
            terms.push(Term { word, instead: instead.to_owned(), except, within });
        }
    }
    Ok(terms)
}

fn strings(value: Option<&Value>) -> Vec<String> {
    match value {
        Some(Value::String(one)) => vec![one.clone()],
        Some(Value::Array(many)) => many.iter().filter_map(Value::as_str).map(str::to_owned).collect(),
        _ => Vec::new(),
    }
}

/// Every place of the file at which a retired word stands.
pub fn problems(terms: &[Term], name: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for term in terms.iter().filter(|term| applies(term, name)) {
        for (number, line) in text.lines().enumerate() {
            if has_word(line, &term.word) {
                found.push(format!("{name}:{}: `{}` is retired: write {}", number + 1, term.word, term.instead));
            }
        }
    }
    found
}

fn applies(term: &Term, name: &str) -> bool {
    let named =
        |list: &[String]| list.iter().any(|known| name == known || known.ends_with('/') && name.starts_with(known));
    !named(&term.except) && (term.within.is_empty() || named(&term.within))
}

/// Words of so many letters are part of another where an underscore is beside them; longer ones are words of their own.
const LONGEST_JOINED: usize = 4;

/// Whether the word stands in the line with no letter or digit beside it, nor an underscore where it is short.
fn has_word(line: &str, word: &str) -> bool {
    let is_joined = word.chars().count() <= LONGEST_JOINED;
    let part_of_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' && is_joined);
    line.match_indices(word).any(|(at, _)| {
        !part_of_word(line[..at].chars().next_back()) && !part_of_word(line[at + word.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = r#"
        exempt = ["CHANGES.md"]
        [[term]]
        word = ["attic", "Attic"]
        instead = "upper layer"
        except = ["docs/old.md"]
        [[term]]
        word = "two words"
        instead = "one"
        within = ["docs/"]
    "#;

    #[test]
    fn a_retired_word_is_found_with_its_line_and_its_replacement() {
        let terms = parse(LIST).unwrap();
        let text = "first\nan attic\nand attics\nmy_attic_door";
        let found = ["a.rs:2: `attic` is retired: write upper layer", "a.rs:4: `attic` is retired: write upper layer"];
        assert_eq!(problems(&terms, "a.rs", text), found);
        assert!(problems(&terms, "docs/old.md", text).is_empty() && problems(&terms, "CHANGES.md", text).is_empty());
    }

    #[test]
    fn an_underscore_separates_long_words_only() {
        assert!(has_word("fn attic_of()", "attic") && has_word("is_old_attic", "old_attic"));
        assert!(has_word("a nook here", "nook") && !has_word("my_nook", "nook") && !has_word("attics", "attic"));
    }

    #[test]
    fn a_word_may_be_retired_in_some_folders_only() {
        let terms = parse(LIST).unwrap();
        assert_eq!(problems(&terms, "docs/a.md", "these two words").len(), 1);
        assert!(problems(&terms, "a.rs", "these two words").is_empty());
    }

    #[test]
    fn a_list_that_is_not_complete_is_refused() {
        assert!(parse("[[term]]\nword = \"a\"").unwrap_err().contains("instead"));
        assert!(parse("[[term]]\ninstead = \"a\"").unwrap_err().contains("word"));
    }
}
