//! The declarations of a source file: modules, classes and constants.
//!
//! Expressions and initialisers are kept as ranges of tokens and evaluated when they are needed.

use super::lexer::{self, Complaint, Kind, MOST_COMPLAINTS, Token};
use super::parser;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Bytes of a qualified or nested name; what is longer is cut. Declarations and constants hold copies of the names
/// around them, so a long one would need memory without end.
pub(super) const LONGEST_NAME: usize = 256;

/// Tokens between the brackets of type parameters. They are looked for behind every name, so a bracket that is not
/// closed must not be searched for up to the end of the file each time.
const LONGEST_GENERICS: usize = 200;

/// A parsed source file.
pub(super) struct File {
    pub path: String,
    /// File name without directory and extension.
    pub base_name: String,
    /// What precedes the declared names in node types: `test$` for `sub/test.rgg`.
    pub prefix: String,
    pub tokens: Vec<Token>,
    partners: Vec<usize>,
    pub declarations: Vec<Declaration>,
    /// Index of a declaration by its name within the file (`Outer$Inner`).
    pub by_name: HashMap<String, usize>,
    pub constants: HashMap<String, Vec<Constant>>,
    /// Qualified names as written, `*` included.
    pub imports: Vec<String>,
    pub complaints: Vec<Complaint>,
}

/// A module or class.
#[derive(Default)]
pub(super) struct Declaration {
    pub name: String,
    /// Name with those of the enclosing declarations: `Outer$Inner`.
    pub full_name: String,
    pub line: usize,
    pub parameters: Vec<Parameter>,
    pub base: Option<Base>,
    /// Fields and instance initialisers in the order in which they run.
    pub members: Vec<Member>,
    pub methods: HashSet<String>,
    /// Body of an explicit constructor without parameters.
    pub constructor: Option<Range<usize>>,
    /// What follows `==>`.
    pub body: Option<Range<usize>>,
}

/// A module parameter.
pub(super) struct Parameter {
    pub name: String,
    /// Its type; empty for `super.name`, which is a field of the base class.
    pub kind: String,
    pub reuses_field: bool,
}

/// The `extends` clause.
pub(super) struct Base {
    pub name: String,
    pub arguments: Option<Range<usize>>,
    /// Contents of `.( ... )`.
    pub with: Vec<Range<usize>>,
}

pub(super) enum Member {
    Field { kind: String, name: String, value: Option<Range<usize>> },
    Initialiser(Range<usize>),
}

/// A class-level variable with a value.
pub(super) struct Constant {
    /// Full name of the declaration that holds it; empty at file level.
    pub owner: String,
    pub kind: String,
    /// False for `static` variables, which the model may change.
    pub fixed: bool,
    pub value: Range<usize>,
}

impl File {
    /// Parses a source; never fails.
    pub fn parse(path: &str, text: &str) -> File {
        let (tokens, mut complaints) = lexer::tokens(text);
        let (partners, more) = lexer::partners(&tokens);
        complaints.extend(more);
        let file_name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        let (base_name, extension) = file_name.rsplit_once('.').unwrap_or((file_name, ""));
        let mut file = File {
            path: path.to_owned(),
            base_name: base_name.to_owned(),
            prefix: format!("{base_name}$"),
            tokens,
            partners,
            declarations: Vec::new(),
            by_name: HashMap::new(),
            constants: HashMap::new(),
            imports: Vec::new(),
            complaints: Vec::new(),
        };
        // Unlike the others, these files do not form a class of their own around their declarations.
        let plain = matches!(extension.to_ascii_lowercase().as_str(), "xl" | "java");
        let package = parser::parse(&mut file, &mut complaints);
        if plain {
            file.prefix = if package.is_empty() { package } else { package + "." };
        }
        complaints.sort_by_key(|(line, _)| *line);
        complaints.truncate(MOST_COMPLAINTS);
        file.complaints = complaints;
        file
    }

    /// The word at an index, if there is one.
    pub fn word(&self, at: usize) -> Option<&str> {
        match self.tokens.get(at) {
            Some(Token { kind: Kind::Word(word), .. }) => Some(word),
            _ => None,
        }
    }

    pub fn is(&self, at: usize, symbol: &str) -> bool {
        matches!(self.tokens.get(at), Some(Token { kind: Kind::Symbol(s), .. }) if *s == symbol)
    }

    pub fn is_open(&self, at: usize) -> bool {
        ["(", "[", "{"].iter().any(|s| self.is(at, s))
    }

    /// What lies between the bracket at `at` and its partner.
    pub fn inside(&self, at: usize) -> Range<usize> {
        at + 1..self.partners[at].max(at + 1)
    }

    /// The index after the bracket expression at `at`.
    pub fn after(&self, at: usize) -> usize {
        // A bracket that is not closed is its own partner.
        self.partners[at] + 1
    }

    /// The index of the first of the symbols from `at` on that is in no bracket, else `end`.
    pub fn find(&self, at: usize, end: usize, symbols: &[&str]) -> usize {
        let mut at = at;
        while at < end && !symbols.iter().any(|s| self.is(at, s)) {
            at = if self.is_open(at) { self.after(at) } else { at + 1 };
        }
        at.min(end)
    }

    pub fn line(&self, at: usize) -> usize {
        self.tokens.get(at).or(self.tokens.last()).map_or(1, |token| token.line)
    }

    /// `a.b.c` at `at`, and the index behind it; generic parameters are skipped.
    pub fn qualified(&self, at: usize) -> Option<(String, usize)> {
        let mut name = self.word(at)?.to_owned();
        let mut at = at + 1;
        while self.is(at, ".") {
            let Some(word) = self.word(at + 1) else { break };
            if name.len() < LONGEST_NAME {
                name.push('.');
                name.push_str(word);
            }
            at += 2;
        }
        Some((name, self.after_generics(at)))
    }

    /// The index behind generic parameters at `at`, if there are any.
    pub fn after_generics(&self, at: usize) -> usize {
        if !self.is(at, "<") {
            return at;
        }
        let mut depth = 0usize;
        for i in at..self.tokens.len().min(at + LONGEST_GENERICS) {
            if self.is(i, "<") {
                depth += 1;
            } else if self.is(i, ">") {
                depth -= 1;
                if depth == 0 {
                    return i + 1;
                }
            } else if self.word(i).is_none() && ![",", ".", "?", "&", "[", "]"].iter().any(|s| self.is(i, s))
            {
                break;
            }
        }
        at
    }

    /// A type with generic parameters and `[]`, and the index behind it.
    pub fn type_name(&self, at: usize) -> Option<(String, usize)> {
        let (mut name, mut at) = self.qualified(at)?;
        while self.is(at, "[") && self.is(at + 1, "]") {
            if name.len() < LONGEST_NAME {
                name.push_str("[]");
            }
            at += 2;
        }
        Some((name, at))
    }
}
