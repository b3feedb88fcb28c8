//! Rust source as tokens, without comments, literals and unit tests.

/// A word or sign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Token {
    /// An identifier or keyword.
    Word(String),
    /// `::`
    Path,
    /// Any other sign.
    Sign(char),
}

impl Token {
    /// The word, if it is one.
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }

    /// Whether it is this sign.
    pub fn is(&self, sign: char) -> bool {
        *self == Self::Sign(sign)
    }
}

/// Returns the tokens of a file up to its unit tests, which by convention are at its end.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut rest = before_tests(text);
    while let Some(first) = rest.chars().next() {
        rest = if rest.starts_with("//") {
            rest.find('\n').map_or("", |end| &rest[end..])
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or("", |end| &rest[end + 2..])
        } else if let Some(after) = after_string(rest) {
            after
        } else if first == '\'' {
            after_quote(rest)
        } else if first.is_alphanumeric() || first == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            found.push(Token::Word(rest[..end].to_owned()));
            &rest[end..]
        } else if let Some(after) = rest.strip_prefix("::") {
            found.push(Token::Path);
            after
        } else {
            if !first.is_whitespace() {
                found.push(Token::Sign(first));
            }
            &rest[first.len_utf8()..]
        };
    }
    found
}

/// Returns the text of a file up to its unit tests, which by convention are at its end.
pub fn before_tests(text: &str) -> &str {
    let start = text.find("#[cfg(test)]\nmod ").filter(|at| {
        let line = text[*at..].lines().nth(1).unwrap_or_default();
        line.trim_end().ends_with('{')
    });
    start.map_or(text, |at| &text[..at])
}

/// Returns the text after a string literal: plain, raw or of bytes.
fn after_string(text: &str) -> Option<&str> {
    let plain = text.strip_prefix('b').unwrap_or(text);
    if let Some(raw) = plain.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        if let Some(inside) = raw[hashes..].strip_prefix('"') {
            let close = format!("\"{}", "#".repeat(hashes));
            return Some(inside.find(&close).map_or("", |end| &inside[end + close.len()..]));
        }
    }
    let inside = plain.strip_prefix('"')?;
    let mut escaped = false;
    for (i, c) in inside.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return Some(&inside[i + 1..]),
            _ => {}
        }
    }
    Some("")
}

/// Returns the text after a character literal or the tick of a lifetime.
fn after_quote(text: &str) -> &str {
    let inside = &text[1..];
    if let Some(escaped) = inside.strip_prefix('\\') {
        return escaped.get(1..).and_then(|rest| rest.find('\'').map(|end| &rest[end + 1..])).unwrap_or("");
    }
    let mut chars = inside.chars();
    chars.next();
    chars.as_str().strip_prefix('\'').unwrap_or(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        tokens(text).iter().filter_map(|t| t.word().map(str::to_owned)).collect()
    }

    #[test]
    fn comments_literals_and_unit_tests_are_no_words() {
        let text =
            "// one\nlet two = \"three \\\" four\"; /* five */ let six = 'x'; let nine: &'a str = r#\"te\"n\"#;\n";
        assert_eq!(words(text), ["let", "two", "let", "six", "let", "nine", "a", "str"]);
        assert_eq!(words("fn a() {}\n#[cfg(test)]\nmod tests {\n use super::b;\n}"), ["fn", "a"]);
        assert_eq!(words("'\\n' a '\\'' b b\"x\" '\"' c"), ["a", "b", "c"]);
    }

    #[test]
    fn a_declared_test_file_does_not_end_the_source() {
        assert_eq!(words("#[cfg(test)]\nmod tests;\nfn b() {}"), ["cfg", "test", "mod", "tests", "fn", "b"]);
    }
}
