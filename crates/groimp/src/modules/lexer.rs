//! Splits a model source into tokens with line numbers.
//!
//! The lexer accepts any input: what is no token of the language is dropped, with a problem in the
//! list. Only the operators that the parser has to tell apart are more than one character long.

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// An identifier or keyword.
    Word(String),
    /// A number or character literal. Java divides integers differently, hence the flag.
    Number { value: f64, integer: bool },
    /// A string literal without quotes and escapes.
    Text(String),
    /// An operator or bracket.
    Symbol(&'static str),
}

/// A token and the line (from 1) on which it starts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub kind: Kind,
    pub line: usize,
}

/// A place that could not be understood: line and message.
pub(super) type Complaint = (usize, String);

/// More complaints about one file would not help anybody.
pub(super) const MOST_COMPLAINTS: usize = 50;

/// Names are copied where they are used, so their length in bytes has to be bounded.
const LONGEST_WORD: usize = 128;

fn complain(complaints: &mut Vec<Complaint>, line: usize, message: impl FnOnce() -> String) {
    if complaints.len() < MOST_COMPLAINTS {
        complaints.push((line, message()));
    }
}

/// Longest first, so that a prefix never wins.
const SYMBOLS: [&str; 52] = [
    "==>>", "::>>", "==>", "::>", "-->", "<--", "...", "**=", "==", "!=", "<=", ">=", "&&", "||", "++", "--",
    "+=", "-=", "*=", "/=", "%=", "->", "=>", "**", "::", "(", ")", "[", "]", "{", "}", ";", ",", ".", "=",
    "+", "-", "*", "/", "%", "<", ">", "!", "&", "|", "^", "~", "?", ":", "@", "#", "$",
];

struct Lexer<'a> {
    rest: &'a str,
    line: usize,
    tokens: Vec<Token>,
    complaints: Vec<Complaint>,
}

/// The tokens of a source, and what is no token.
pub(super) fn tokens(text: &str) -> (Vec<Token>, Vec<Complaint>) {
    let mut lexer = Lexer { rest: text, line: 1, tokens: Vec::new(), complaints: Vec::new() };
    while lexer.step() {}
    (lexer.tokens, lexer.complaints)
}

impl<'a> Lexer<'a> {
    /// Reads one token, comment or white-space character; false at the end.
    fn step(&mut self) -> bool {
        let Some(first) = self.rest.chars().next() else { return false };
        let line = self.line;
        if self.rest.starts_with("//") {
            let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
            self.take(end);
        } else if self.rest.starts_with("/*") {
            match self.rest[2..].find("*/") {
                Some(end) => {
                    self.take(end + 4);
                }
                None => {
                    complain(&mut self.complaints, line, || "a comment is not closed".into());
                    self.take(self.rest.len());
                }
            }
        } else if first.is_whitespace() || first == '\u{feff}' {
            // A carriage return and line feed together count once.
            let pair = self.rest.starts_with("\r\n");
            self.take(if pair { 2 } else { first.len_utf8() });
        } else if first.is_alphabetic() || first == '_' {
            let end = self.rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(self.rest.len());
            let word = self.take(end);
            if word.len() <= LONGEST_WORD {
                self.push(line, Kind::Word(word.to_owned()));
            } else {
                complain(&mut self.complaints, line, || {
                    format!("a name of more than {LONGEST_WORD} bytes is left out")
                });
            }
        } else if first.is_ascii_digit()
            || (first == '.' && self.rest[1..].starts_with(|c: char| c.is_ascii_digit()))
        {
            self.number();
        } else if first == '"' || first == '\'' {
            self.quoted(first);
        } else if let Some(symbol) = SYMBOLS.iter().find(|s| self.rest.starts_with(**s)) {
            self.take(symbol.len());
            self.push(line, Kind::Symbol(symbol));
        } else {
            complain(&mut self.complaints, line, || format!("the character {first:?} is not expected here"));
            self.take(first.len_utf8());
        }
        true
    }

    fn push(&mut self, line: usize, kind: Kind) {
        self.tokens.push(Token { kind, line });
    }

    /// Consumes `length` bytes and counts the line ends in them: line feed, carriage return or both.
    fn take(&mut self, length: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at(length);
        let feeds = taken.matches('\n').count();
        let returns = taken.matches('\r').count();
        let pairs = taken.matches("\r\n").count();
        self.line += feeds + returns - pairs;
        self.rest = rest;
        taken
    }

    fn number(&mut self) {
        let line = self.line;
        let lower = |c: u8| c.to_ascii_lowercase();
        let bytes = self.rest.as_bytes();
        let radix = match bytes.get(1).copied().map(lower) {
            Some(b'x') if bytes[0] == b'0' => 16,
            Some(b'b') if bytes[0] == b'0' => 2,
            _ => 10,
        };
        if radix != 10 {
            let end = self.rest[2..]
                .find(|c: char| !c.is_ascii_alphanumeric() && c != '_')
                .map_or(self.rest.len(), |end| end + 2);
            let digits = self.take(end)[2..].replace('_', "");
            let digits = digits.trim_end_matches(['l', 'L']);
            return self.integer(line, digits, radix);
        }
        let digits = |from: usize| {
            from + bytes[from..].iter().take_while(|c| c.is_ascii_digit() || **c == b'_').count()
        };
        let mut end = digits(0);
        let mut real = false;
        // `1.(x)` and `1.name` are no numbers with a point, but `1.f` is.
        if bytes.get(end) == Some(&b'.') {
            let after = bytes.get(end + 1).copied().map_or(b' ', lower);
            let suffix = matches!(after, b'f' | b'd' | b'e')
                && !bytes.get(end + 2).is_some_and(|c| c.is_ascii_alphabetic());
            if suffix || !(after.is_ascii_alphabetic() || matches!(after, b'.' | b'(' | b'_')) {
                real = true;
                end = digits(end + 1);
            }
        }
        if bytes.get(end).copied().map(lower) == Some(b'e') {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
                real = true;
                end = digits(end + 1 + sign);
            }
        }
        let text = self.take(end).replace('_', "");
        let suffix = self.rest.chars().next().filter(|c| "fFdDlL".contains(*c));
        if let Some(suffix) = suffix {
            real |= !"lL".contains(suffix);
            self.take(1);
        }
        if !real && text.len() > 1 && text.starts_with('0') {
            return self.integer(line, &text, 8);
        }
        match text.parse::<f64>() {
            Ok(value) => self.push(line, Kind::Number { value, integer: !real }),
            Err(_) => self.no_number(line, &text),
        }
    }

    fn no_number(&mut self, line: usize, text: &str) {
        let start: String = text.chars().take(40).collect();
        complain(&mut self.complaints, line, || format!("{start:?} is not a number"));
    }

    fn integer(&mut self, line: usize, digits: &str, radix: u32) {
        match u64::from_str_radix(digits, radix) {
            Ok(value) => self.push(line, Kind::Number { value: value as f64, integer: true }),
            Err(_) => self.no_number(line, digits),
        }
    }

    /// A string or character literal. One that is not closed ends with its line.
    fn quoted(&mut self, quote: char) {
        let line = self.line;
        let mut text = String::new();
        // No literal reaches past its line; looking no further keeps many unclosed quotes cheap.
        let in_line = |c: &char| !matches!(c, '\n' | '\r');
        let mut characters = self.rest[1..].chars();
        let mut closed = false;
        while let Some(c) = characters.clone().next().filter(in_line) {
            characters.next();
            if c == quote {
                closed = true;
                break;
            }
            if c != '\\' {
                text.push(c);
                continue;
            }
            let Some(escaped) = characters.clone().next().filter(in_line) else { break };
            characters.next();
            match escaped {
                'n' => text.push('\n'),
                't' => text.push('\t'),
                'r' => text.push('\r'),
                'u' => {
                    let digits: String = characters.clone().take(4).take_while(in_line).collect();
                    match u32::from_str_radix(&digits, 16).ok().and_then(char::from_u32) {
                        Some(c) => {
                            text.push(c);
                            characters = characters.as_str()[digits.len()..].chars();
                        }
                        None => text.push('u'),
                    }
                }
                c => text.push(c),
            }
        }
        let end = self.rest.len() - characters.as_str().len();
        self.take(end);
        if !closed {
            complain(&mut self.complaints, line, || "a text in quotes is not closed".into());
        }
        if quote == '"' {
            self.push(line, Kind::Text(text));
        } else {
            let value = text.chars().next().map_or(0.0, |c| f64::from(u32::from(c)));
            self.push(line, Kind::Number { value, integer: true });
        }
    }
}

/// For every opening bracket the index of the bracket that closes it; if there is none, its own index, so
/// that what follows is read as if it was not there. Other tokens have the entry 0.
pub(super) fn partners(tokens: &[Token]) -> (Vec<usize>, Vec<Complaint>) {
    const CLOSERS: [&str; 3] = [")", "]", "}"];
    let mut partner = vec![0; tokens.len()];
    let mut complaints = Vec::new();
    let mut open: Vec<(usize, usize)> = Vec::new();
    let mut count = [0usize; 3];
    for (at, token) in tokens.iter().enumerate() {
        let Kind::Symbol(symbol) = token.kind else { continue };
        if let Some(which) = ["(", "[", "{"].iter().position(|s| *s == symbol) {
            open.push((at, which));
            count[which] += 1;
        } else if let Some(which) = CLOSERS.iter().position(|s| *s == symbol) {
            // Without this count a long row of wrong brackets would search the stack every time.
            if count[which] == 0 {
                complain(&mut complaints, token.line, || format!("'{symbol}' closes nothing"));
                continue;
            }
            while let Some((start, kind)) = open.pop() {
                count[kind] -= 1;
                if kind == which {
                    partner[start] = at;
                    break;
                }
                partner[start] = start;
                complain(&mut complaints, tokens[start].line, || format!("'{}' is missing", CLOSERS[kind]));
            }
        }
    }
    for (start, kind) in open {
        partner[start] = start;
        complain(&mut complaints, tokens[start].line, || format!("'{}' is missing", CLOSERS[kind]));
    }
    (partner, complaints)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Vec<(f64, bool)> {
        let values = tokens(text).0.into_iter().filter_map(|token| match token.kind {
            Kind::Number { value, integer } => Some((value, integer)),
            _ => None,
        });
        values.collect()
    }

    #[test]
    fn number_literals() {
        assert_eq!(
            numbers("1 0.5 .25 1. 1f 2.5F 3d 1e-2 5.0E-4 0x82B417 0xFFf 017 7L 1_000 0b101 'A'"),
            [
                (1.0, true),
                (0.5, false),
                (0.25, false),
                (1.0, false),
                (1.0, false),
                (2.5, false),
                (3.0, false),
                (0.01, false),
                (0.0005, false),
                (f64::from(0x82B417), true),
                (4095.0, true),
                (15.0, true),
                (7.0, true),
                (1000.0, true),
                (5.0, true),
                (65.0, true),
            ]
        );
        assert_eq!(numbers("1..5 2.f 3.(x)"), [(1.0, true), (0.5, false), (2.0, false), (3.0, true)]);
    }

    #[test]
    fn lines_and_comments() {
        for end in ["\n", "\r", "\r\n"] {
            let text = ["a // b", "/* c", "d */ e \"x\\\"//y\"", "'\\'' f"].join(end);
            let (tokens, complaints) = tokens(&text);
            assert_eq!(complaints, []);
            let lines: Vec<usize> = tokens.iter().map(|t| t.line).collect();
            assert_eq!(lines, [1, 3, 3, 4, 4]);
            assert_eq!(tokens[2].kind, Kind::Text("x\"//y".into()));
        }
    }

    #[test]
    fn escapes() {
        assert_eq!(tokens(r#""a\u00e4\tb\\""#).0[0].kind, Kind::Text("a\u{e4}\tb\\".into()));
    }

    #[test]
    fn broken_text() {
        for text in ["\"abc\nx", "/* abc", "'", "`", "\\", "0x", "9e99999", "\"\\", "\"\\u12"] {
            let _ = tokens(text);
        }
        assert_eq!(tokens("\"abc\nx").0[1].line, 2);
    }

    #[test]
    fn brackets() {
        let (tokens, _) = tokens("{ ( [ ] } ) {");
        let (partner, complaints) = partners(&tokens);
        assert_eq!(partner, [4, 1, 3, 0, 0, 0, 6]);
        assert_eq!(complaints.len(), 3);
    }
}
