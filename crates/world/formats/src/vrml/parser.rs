//! Parser of the UTF-8 encoding. Nesting is kept on a stack of its own, so depth is limited by memory alone.

use std::collections::HashMap;
use std::path::Path;

use super::document::{Document, Field, Node, Value};
use super::lexer::{Lexer, Token};
use super::node_kinds::{is_standard, may_have_surface};
use crate::Diagnostic;
use crate::tokens::show;
use crate::warning_list::WarningList;

type Result<T> = std::result::Result<T, Diagnostic>;

/// Parses the text of a file.
pub(super) fn parse<'a>(text: &'a [u8], file: &Path, warnings: &mut WarningList) -> Result<Document<'a>> {
    let mut parser = Parser {
        lexer: Lexer::at_line(text, 1),
        document: Document::default(),
        named: HashMap::new(),
        open: Vec::new(),
        file,
        warnings,
    };
    while let Some(token) = parser.lexer.next() {
        parser.token(token)?;
    }
    match parser.open.last() {
        None => Ok(parser.document),
        Some(&(Open::Node(index) | Open::List(index))) => {
            let node = &parser.document.nodes[index];
            let what = format!("the file ends inside the node {} of line {}", show(node.kind), node.line);
            Err(parser.error(what).hint("copy or export the file again"))
        }
    }
}

/// What is not closed yet, with the index of its node.
#[derive(Debug, Clone, Copy)]
enum Open {
    Node(usize),
    /// The list of nodes of the node's last field.
    List(usize),
}

struct Parser<'a, 'w> {
    lexer: Lexer<'a>,
    document: Document<'a>,
    /// The last complete node of each name.
    named: HashMap<&'a [u8], usize>,
    open: Vec<Open>,
    file: &'w Path,
    warnings: &'w mut WarningList,
}

impl<'a> Parser<'a, '_> {
    fn error(&self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(self.file, self.lexer.line(), what)
    }

    fn token(&mut self, token: Token<'a>) -> Result<()> {
        match (self.open.last().copied(), token) {
            (None | Some(Open::List(_)), Token::Word(word)) => self.statement(word),
            (Some(Open::Node(index)), Token::Word(word)) => self.body(index, word),
            (Some(Open::Node(index)), Token::Close) => {
                self.close(index);
                Ok(())
            }
            (Some(Open::List(_)), Token::CloseList) => {
                self.open.pop();
                Ok(())
            }
            (_, token) => Err(self.unexpected(token)),
        }
    }

    fn unexpected(&self, token: Token<'a>) -> Diagnostic {
        let (what, hint) = match token {
            Token::UnclosedText => return self.error("a text has no end").hint("a second quote: \"…\""),
            Token::Text(text) => (format!("the text \"{}\" belongs to no field", show(text)), "a field before it"),
            Token::Open => ("`{` without a node".to_owned(), "the kind of a node before it: Transform { … }"),
            Token::OpenList => ("`[` without a field".to_owned(), "a field before it: children [ … ]"),
            Token::Close => ("`}` without its `{`".to_owned(), "one `}` for each `{`, and `]` for each `[`"),
            Token::CloseList => ("`]` without its `[`".to_owned(), "one `]` for each `[`, and `}` for each `{`"),
            Token::Word(word) => (format!("`{}` is not expected here", show(word)), "Transform { … }"),
        };
        self.error(what).hint(hint)
    }

    /// The next token as a word.
    fn word(&mut self, of: &str) -> Result<&'a [u8]> {
        match self.lexer.next() {
            Some(Token::Word(word)) => Ok(word),
            Some(_) => Err(self.error(format!("{of} is missing")).hint("a name")),
            None => Err(self.error(format!("the file ends before {of}")).hint("copy or export the file again")),
        }
    }

    /// A statement outside of fields, or a node in a list.
    fn statement(&mut self, word: &'a [u8]) -> Result<()> {
        if self.declaration(word)? { Ok(()) } else { self.node(word) }
    }

    /// Reads a `ROUTE` or a prototype; false if the word begins neither.
    fn declaration(&mut self, word: &'a [u8]) -> Result<bool> {
        match word {
            b"ROUTE" => {
                let line = self.lexer.line();
                self.document.first_route.get_or_insert(line);
                self.route_end()?;
                if self.word("`TO` of the ROUTE")? != b"TO" {
                    return Err(self.error("a ROUTE without `TO`").hint("ROUTE NODE.EVENT TO NODE.EVENT"));
                }
                self.route_end()?;
            }
            b"PROTO" => {
                self.prototype()?;
                self.balanced()?;
            }
            b"EXTERNPROTO" => {
                self.prototype()?;
                let mut ahead = self.lexer.clone();
                if matches!(ahead.next(), Some(Token::Text(_))) {
                    self.lexer = ahead;
                } else {
                    self.balanced()?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads `NODE.EVENT`, which may have blanks around the dot.
    fn route_end(&mut self) -> Result<()> {
        let first = self.word("the node of the ROUTE")?;
        let next = self.lexer.clone().next();
        let dot_follows = matches!(next, Some(Token::Word(word)) if word.starts_with(b"."));
        let mut last = first;
        if dot_follows {
            last = self.word("the event of the ROUTE")?;
        }
        if last.ends_with(b".") {
            self.word("the event of the ROUTE")?;
        }
        Ok(())
    }

    /// Reads the name and the interface of a prototype, and warns that it is skipped.
    fn prototype(&mut self) -> Result<()> {
        let line = self.lexer.line();
        let name = self.word("the name of the prototype")?;
        if is_standard(name) {
            let what = format!("the prototype {} has the name of a node of VRML 2", show(name));
            return Err(self.error(what).hint("another name"));
        }
        self.document.prototypes.insert(name, line);
        self.warnings.push_with(|| {
            let what =
                format!("the prototype {} is skipped; a node of it where a surface may be is refused", show(name));
            Diagnostic::new(self.file, line, what).hint("the model exported without prototypes")
        });
        self.balanced()
    }

    /// Skips everything from a bracket to the bracket that closes it.
    fn balanced(&mut self) -> Result<()> {
        let line = self.lexer.line();
        let mut depth = 0_usize;
        loop {
            match self.lexer.next() {
                Some(Token::Open | Token::OpenList) => depth += 1,
                Some(Token::Close | Token::CloseList) if depth > 0 => depth -= 1,
                Some(Token::Text(_) | Token::Word(_)) if depth > 0 => {}
                _ => {
                    let what = format!("the prototype of line {line} is not complete");
                    return Err(self.error(what).hint("PROTO NAME [ … ] { … }, or EXTERNPROTO NAME [ … ] \"FILE\""));
                }
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }

    fn node(&mut self, word: &'a [u8]) -> Result<()> {
        match word {
            b"USE" => {
                let name = self.word("the name after USE")?;
                let index = *self.named.get(name).ok_or_else(|| {
                    self.error(format!("USE {}: there is no complete node of this name before", show(name)))
                        .hint(format!("DEF {} NODE {{ … }} before this line", show(name)))
                })?;
                self.attach(index, self.document.nodes[index].holds_surface);
                Ok(())
            }
            b"DEF" => {
                let name = self.word("the name after DEF")?;
                let kind = self.word("the node after DEF")?;
                self.begin(Some(name), kind)
            }
            kind => self.begin(None, kind),
        }
    }

    fn begin(&mut self, name: Option<&'a [u8]>, kind: &'a [u8]) -> Result<()> {
        let line = self.lexer.line();
        if self.lexer.next() != Some(Token::Open) {
            let what = format!("`{}` is no node: no `{{` follows", show(kind));
            return Err(Diagnostic::new(self.file, line, what).hint("a node such as Transform { … }, or USE NAME"));
        }
        let holds_surface = may_have_surface(kind, &self.document);
        let index = self.document.nodes.len();
        self.document.nodes.push(Node { kind, name, line, fields: Vec::new(), holds_surface });
        // Its surface is known when it is complete.
        self.attach(index, false);
        self.open.push(Open::Node(index));
        Ok(())
    }

    /// Adds a node to what is open.
    fn attach(&mut self, index: usize, holds_surface: bool) {
        match self.open.last() {
            None => self.document.top.push(index),
            Some(&(Open::Node(parent) | Open::List(parent))) => {
                let parent = &mut self.document.nodes[parent];
                parent.holds_surface |= holds_surface;
                if let Some(Field { value: Value::Nodes(nodes), .. }) = parent.fields.last_mut() {
                    nodes.push(index);
                }
            }
        }
    }

    fn close(&mut self, index: usize) {
        self.open.pop();
        let node = &self.document.nodes[index];
        if let Some(name) = node.name {
            self.named.insert(name, index);
        }
        let holds_surface = node.holds_surface;
        if let Some(&(Open::Node(parent) | Open::List(parent))) = self.open.last() {
            self.document.nodes[parent].holds_surface |= holds_surface;
        }
    }

    /// A statement in the body of a node: mostly a field.
    fn body(&mut self, index: usize, word: &'a [u8]) -> Result<()> {
        if self.declaration(word)? {
            return Ok(());
        }
        match word {
            // The interface of a script.
            b"eventIn" | b"eventOut" => {
                self.word("the type of the event")?;
                self.word("the name of the event").map(|_| ())
            }
            b"field" | b"exposedField" => {
                self.word("the type of the field")?;
                let name = self.word("the name of the field")?;
                self.value(index, name)
            }
            name => self.value(index, name),
        }
    }

    /// Reads the value of a field. Nodes in it are read by the following tokens.
    fn value(&mut self, index: usize, name: &'a [u8]) -> Result<()> {
        let line = self.lexer.line();
        let mut ahead = self.lexer.clone();
        let first = ahead.next();
        let missing = || {
            let what = format!("the field {} has no value", show(name));
            Diagnostic::new(self.file, line, what).hint("a number, a text, TRUE, FALSE, NULL, a node or a list in [ ]")
        };
        let is_list = first == Some(Token::OpenList);
        let second = if is_list { ahead.clone().next() } else { first };
        match second {
            Some(Token::Word(b"NULL")) if !is_list => {
                self.lexer = ahead;
                self.push_field(index, Field { name, line, value: Value::Nodes(Vec::new()) });
                Ok(())
            }
            Some(Token::Word(word)) if !is_plain(word) => {
                self.lexer = ahead;
                self.push_field(index, Field { name, line, value: Value::Nodes(Vec::new()) });
                if is_list {
                    self.open.push(Open::List(index));
                    return Ok(());
                }
                self.node(word)
            }
            Some(Token::Word(_) | Token::Text(_)) => {
                if is_list {
                    self.lexer = ahead;
                }
                self.plain(index, name, line, is_list)
            }
            Some(Token::CloseList) if is_list => {
                self.lexer = ahead;
                self.plain(index, name, line, true)
            }
            Some(Token::UnclosedText) => {
                self.lexer = ahead;
                Err(self.unexpected(Token::UnclosedText))
            }
            None => {
                let what = format!("the file ends before the value of {}", show(name));
                Err(self.error(what).hint("copy or export the file again"))
            }
            _ => Err(missing()),
        }
    }

    /// Reads numbers, texts and booleans up to `]`, or up to the next other token.
    fn plain(&mut self, index: usize, name: &'a [u8], field_line: usize, is_list: bool) -> Result<()> {
        let mut range: Option<(usize, usize)> = None;
        let mut end = self.lexer.end();
        loop {
            let mut ahead = self.lexer.clone();
            let token = ahead.next();
            match token {
                Some(Token::Text(_)) => {}
                Some(Token::Word(word)) if is_plain(word) => {}
                Some(Token::CloseList) if is_list => {
                    self.lexer = ahead;
                    break;
                }
                Some(token) if is_list => {
                    self.lexer = ahead;
                    let what = format!("the list of {} of line {field_line} is interrupted", show(name));
                    return Err(match token {
                        Token::UnclosedText => self.unexpected(token),
                        Token::Word(word) => {
                            self.error(format!("{what}: `{}` is no number", show(word))).hint("numbers, then `]`")
                        }
                        _ => self.error(what).hint("`]` at its end"),
                    });
                }
                None if is_list => {
                    let what = format!("the file ends in the list of {} of line {field_line}", show(name));
                    return Err(self.error(what).hint("copy or export the file again"));
                }
                _ => break,
            }
            range.get_or_insert((ahead.start(), ahead.line()));
            end = ahead.end();
            self.lexer = ahead;
        }
        let (start, line) = range.unwrap_or((end, field_line));
        let value = Value::Plain { text: self.lexer.slice(start, end), line };
        self.push_field(index, Field { name, line: field_line, value });
        Ok(())
    }

    fn push_field(&mut self, index: usize, field: Field<'a>) {
        self.document.nodes[index].fields.push(field);
    }
}

/// Whether a word is a number or a boolean, not the beginning of a node or field.
fn is_plain(word: &[u8]) -> bool {
    matches!(word, b"TRUE" | b"FALSE")
        || word.first().is_some_and(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
}
