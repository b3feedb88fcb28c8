//! Tokens of the UTF-8 encoding, with their lines. Commas are white space; `#` begins a comment outside of texts.

/// A token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// `{`
    Open,
    /// `}`
    Close,
    /// `[`
    OpenList,
    /// `]`
    CloseList,
    /// The text between two quotes, with its escapes.
    Text(&'a [u8]),
    /// A quote without a second one.
    UnclosedText,
    /// A name, keyword or number.
    Word(&'a [u8]),
}

/// Splits bytes into tokens.
#[derive(Debug, Clone)]
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Line of the position.
    current: usize,
    /// Offset and line of the last token.
    start: usize,
    line: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn at_line(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, position: 0, current: line, start: 0, line }
    }

    /// Line of the last token, counted from 1.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Offset of the last token.
    pub(super) fn start(&self) -> usize {
        self.start
    }

    /// Offset behind the last token.
    pub(super) fn end(&self) -> usize {
        self.position
    }

    /// The bytes between two offsets.
    pub(super) fn slice(&self, from: usize, to: usize) -> &'a [u8] {
        &self.bytes[from..to]
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b'#' => self.advance(|b| b != b'\n' && b != b'\r'),
                b if b.is_ascii_whitespace() || b == b',' => {
                    let next = self.bytes.get(self.position + 1);
                    self.current += usize::from(b == b'\n' || (b == b'\r' && next != Some(&b'\n')));
                    self.position += 1;
                }
                _ => break,
            }
        }
    }

    fn advance(&mut self, belongs: impl Fn(u8) -> bool) {
        let rest = &self.bytes[self.position..];
        self.position += rest.iter().position(|&b| !belongs(b)).unwrap_or(rest.len());
    }

    /// Reads a text from behind its first quote.
    fn text(&mut self) -> Token<'a> {
        let begin = self.position;
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b'"' => {
                    self.position += 1;
                    return Token::Text(&self.bytes[begin..self.position - 1]);
                }
                // The escaped byte may be a line end, which must be counted.
                b'\\' if matches!(self.bytes.get(self.position + 1), Some(b'"' | b'\\')) => self.position += 1,
                _ => {}
            }
            self.current += usize::from(byte == b'\n');
            self.position += 1;
        }
        Token::UnclosedText
    }
}

impl<'a> Iterator for Lexer<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        self.skip_blanks();
        let first = *self.bytes.get(self.position)?;
        (self.start, self.line) = (self.position, self.current);
        let mark = match first {
            b'{' => Token::Open,
            b'}' => Token::Close,
            b'[' => Token::OpenList,
            b']' => Token::CloseList,
            b'"' => {
                self.position += 1;
                return Some(self.text());
            }
            _ => {
                self.advance(|b| !b.is_ascii_whitespace() && !b",{}[]\"#".contains(&b));
                return Some(Token::Word(&self.bytes[self.start..self.position]));
            }
        };
        self.position += 1;
        Some(mark)
    }
}

/// Removes the escapes of a text.
pub(super) fn unescaped(text: &[u8]) -> String {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text.iter();
    while let Some(&byte) = rest.next() {
        let escaped = matches!(rest.as_slice().first(), Some(b'"' | b'\\'));
        out.push(if byte == b'\\' && escaped { rest.next().copied().unwrap_or(byte) } else { byte });
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_comments_texts_and_brackets_are_told_apart() {
        let text = b"#VRML V2.0 utf8\r\nDEF a.b Box{size 1,2 , 3}#end{\r[\"x \\\"#\n\"]\n\"open";
        let mut lexer = Lexer::at_line(text, 1);
        let mut seen = Vec::new();
        while let Some(token) = lexer.next() {
            seen.push((token, lexer.line()));
        }
        let word = |w: &'static str| Token::Word(w.as_bytes());
        let expected = [
            (word("DEF"), 2),
            (word("a.b"), 2),
            (word("Box"), 2),
            (Token::Open, 2),
            (word("size"), 2),
            (word("1"), 2),
            (word("2"), 2),
            (word("3"), 2),
            (Token::Close, 2),
            (Token::OpenList, 3),
            (Token::Text(b"x \\\"#\n"), 3),
            (Token::CloseList, 4),
            (Token::UnclosedText, 5),
        ];
        assert_eq!(seen, expected);
        assert_eq!(unescaped(b"x \\\"\\\\ \\n"), "x \"\\ \\n");
    }
}
