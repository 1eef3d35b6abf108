//! Finds the declarations in the tokens of a source.
//!
//! Only the member level of classes is parsed; method bodies, rule blocks and expressions are skipped by
//! their brackets.

use super::declarations::{Base, Constant, Declaration, File, LONGEST_NAME, Member, Parameter};
use super::lexer::{Complaint, MOST_COMPLAINTS};
use std::ops::Range;

/// Nested names contain those of all enclosing declarations, so their length has to be bounded.
const DEEPEST_NESTING: usize = 50;

/// Imports of a file that count; they are searched for every class name.
const MOST_IMPORTS: usize = 256;

/// Constants of one name in a file, in different declarations; they are searched wherever the name is used.
const MOST_NAMESAKES: usize = 256;

/// Adds the declarations to a file that has its tokens; the result is the package.
pub(super) fn parse(file: &mut File, complaints: &mut Vec<Complaint>) -> String {
    Parser { file, at: 0, open: Vec::new(), complaints }.run()
}

struct Parser<'a> {
    file: &'a mut File,
    at: usize,
    /// Declarations whose bodies are being read, and where these end.
    open: Vec<(usize, usize)>,
    complaints: &'a mut Vec<Complaint>,
}

#[derive(Default)]
struct Modifiers {
    is_static: bool,
    is_fixed: bool,
}

impl Parser<'_> {
    /// Reads everything; the result is the package.
    fn run(mut self) -> String {
        let mut package = String::new();
        while self.at < self.file.tokens.len() || !self.open.is_empty() {
            if let Some((declaration, end)) = self.open.last().copied()
                && self.at >= end
            {
                self.open.pop();
                self.at = if self.file.is(end, "}") { end + 1 } else { end };
                self.instantiation(declaration);
                continue;
            }
            let start = self.at;
            if self.file.word(start) == Some("package") {
                if let Some((name, _)) = self.file.qualified(start + 1) {
                    package = name;
                }
                self.skip_statement();
            } else {
                self.member();
            }
            self.at = self.at.max(start + 1);
        }
        package
    }

    fn complain(&mut self, at: usize, message: String) {
        if self.complaints.len() < 2 * MOST_COMPLAINTS {
            self.complaints.push((self.file.line(at), message));
        }
    }

    fn word(&self) -> Option<&str> {
        self.file.word(self.at)
    }

    fn member(&mut self) {
        let modifiers = self.modifiers();
        let next_is_name = self.file.word(self.at + 1).is_some();
        match self.word() {
            Some("import") => self.import(),
            Some("module") if next_is_name => self.declaration(true),
            Some("class" | "interface" | "enum") if next_is_name => self.declaration(false),
            Some(_) => self.field_or_method(&modifiers),
            None if self.file.is(self.at, "{") => {
                let range = self.file.inside(self.at);
                self.at = self.file.after(self.at);
                if !modifiers.is_static
                    && let Some((declaration, _)) = self.open.last()
                {
                    self.file.declarations[*declaration].members.push(Member::Initialiser(range));
                }
            }
            None if self.file.is_open(self.at) => self.at = self.file.after(self.at),
            None if self.file.is(self.at, "<") && self.file.after_generics(self.at) > self.at => {
                // Type parameters of a method.
                self.at = self.file.after_generics(self.at);
                self.field_or_method(&modifiers);
            }
            None => {
                if !self.file.is(self.at, ";") && !self.file.is(self.at, "}") {
                    self.complain(self.at, "a declaration was expected".into());
                    self.skip_statement();
                }
            }
        }
    }

    fn modifiers(&mut self) -> Modifiers {
        let mut modifiers = Modifiers::default();
        loop {
            match self.word() {
                Some("static") => modifiers.is_static = true,
                Some("const" | "final") => modifiers.is_fixed = true,
                Some(
                    "public" | "protected" | "private" | "abstract" | "transient" | "volatile"
                    | "synchronized" | "native" | "strictfp",
                ) => {}
                None if self.file.is(self.at, "@") => {
                    self.at = self.after_annotation(self.at) - 1;
                }
                _ => return modifiers,
            }
            self.at += 1;
        }
    }

    fn after_annotation(&self, at: usize) -> usize {
        match self.file.qualified(at + 1) {
            Some((_, end)) if self.file.is(end, "(") => self.file.after(end),
            Some((_, end)) => end,
            None => at + 1,
        }
    }

    fn import(&mut self) {
        let from = if self.file.word(self.at + 1) == Some("static") { self.at + 2 } else { self.at + 1 };
        if let Some((mut name, end)) = self.file.qualified(from) {
            if self.file.is(end, ".") && self.file.is(end + 1, "*") {
                name.push_str(".*");
            }
            if self.file.imports.len() < MOST_IMPORTS {
                self.file.imports.push(name);
            } else {
                self.complain(self.at, format!("more than {MOST_IMPORTS} imports are not followed"));
            }
        }
        self.skip_statement();
    }

    /// Goes behind the next `;` or `{ ... }`, but not out of the class body.
    fn skip_statement(&mut self) {
        let end = self.open.last().map_or(self.file.tokens.len(), |(_, end)| *end);
        while self.at < end {
            if self.file.is(self.at, ";") {
                self.at += 1;
                return;
            }
            let block = self.file.is(self.at, "{");
            self.at = if self.file.is_open(self.at) { self.file.after(self.at) } else { self.at + 1 };
            if block {
                return;
            }
        }
    }

    /// A module or class from its keyword up to its body; the members of the body follow in the main loop,
    /// so that nesting needs no recursion.
    fn declaration(&mut self, is_module: bool) {
        let start = self.at;
        let name = self.file.word(start + 1).unwrap_or_default().to_owned();
        let full_name = match self.open.last() {
            Some((outer, _)) => format!("{}${name}", self.file.declarations[*outer].full_name),
            None => name.clone(),
        };
        let line = self.file.line(start);
        let mut declaration = Declaration { name, full_name, line, ..Declaration::default() };
        self.at = self.file.after_generics(start + 2);
        if is_module && self.file.is(self.at, "(") {
            declaration.parameters = self.parameters(self.file.inside(self.at));
            self.at = self.file.after(self.at);
        }
        if self.word() == Some("extends") {
            if let Some((name, end)) = self.file.qualified(self.at + 1) {
                declaration.base = Some(Base { name, arguments: None, with: Vec::new() });
                self.at = end;
            } else {
                self.complain(self.at, "the name of a class is missing".into());
                self.at += 1;
            }
        }
        if let Some(base) = &mut declaration.base {
            if is_module && self.file.is(self.at, "(") {
                base.arguments = Some(self.file.inside(self.at));
                self.at = self.file.after(self.at);
            }
            while is_module && self.file.is(self.at, ".") && self.file.is(self.at + 1, "(") {
                base.with.push(self.file.inside(self.at + 1));
                self.at = self.file.after(self.at + 1);
            }
        }
        while self.file.word(self.at).is_some_and(|w| matches!(w, "implements" | "extends"))
            || (self.file.is(self.at, ",") && self.file.word(self.at + 1).is_some())
        {
            match self.file.qualified(self.at + 1) {
                Some((_, end)) => self.at = end,
                None => break,
            }
        }
        let index = self.file.declarations.len();
        if self.file.by_name.contains_key(&declaration.full_name) {
            self.complain(start, format!("'{}' is declared twice", declaration.name));
        } else {
            self.file.by_name.insert(declaration.full_name.clone(), index);
        }
        self.file.declarations.push(declaration);
        if self.file.is(self.at, "{") {
            let body = self.file.inside(self.at);
            let short = self.file.declarations[index].full_name.len() < LONGEST_NAME;
            if self.open.len() < DEEPEST_NESTING && short {
                self.open.push((index, body.end));
                self.at = body.start;
            } else {
                self.complain(self.at, "the declarations are nested too deeply".into());
                self.at = self.file.after(self.at);
            }
        } else if !self.instantiation(index) {
            if self.file.is(self.at, ";") {
                self.at += 1;
            } else {
                let name = &self.file.declarations[index].name;
                self.complain(self.at, format!("the declaration of '{name}' is not understood here"));
            }
        }
    }

    fn parameters(&self, range: Range<usize>) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        let mut start = range.start;
        while start < range.end {
            let end = self.file.find(start, range.end, &[","]);
            let mut at = start;
            loop {
                if self.file.is(at, "@") {
                    at = self.after_annotation(at);
                } else if matches!(self.file.word(at), Some("final" | "const")) {
                    at += 1;
                } else {
                    break;
                }
            }
            if self.file.word(at) == Some("super") && self.file.is(at + 1, ".") {
                if let Some(name) = self.file.word(at + 2) {
                    let name = name.to_owned();
                    parameters.push(Parameter { name, kind: String::new(), reuses_field: true });
                }
            } else if let Some((kind, at)) = self.file.type_name(at)
                && let Some(name) = self.file.word(at)
            {
                parameters.push(Parameter { name: name.to_owned(), kind, reuses_field: false });
            }
            start = end + 1;
        }
        parameters
    }

    /// Notes what follows `==>` up to the `;`, if it is there.
    fn instantiation(&mut self, declaration: usize) -> bool {
        if !self.file.is(self.at, "==>") {
            return false;
        }
        let start = self.at + 1;
        let end = self.open.last().map_or(self.file.tokens.len(), |(_, end)| *end);
        while self.at < end && !self.file.is(self.at, ";") {
            if self.word() == Some("module") && self.file.word(self.at + 1).is_some() {
                self.complain(self.at, "a ';' is missing before this module".into());
                break;
            }
            self.at = if self.file.is_open(self.at) { self.file.after(self.at) } else { self.at + 1 };
        }
        self.file.declarations[declaration].body = Some(start..self.at.min(end).max(start));
        true
    }

    fn field_or_method(&mut self, modifiers: &Modifiers) {
        let owner = self.open.last().map(|(declaration, _)| *declaration);
        // A constructor has no type before its name.
        if self.file.is(self.at + 1, "(") {
            let parameters = self.file.inside(self.at + 1);
            let name = self.word().unwrap_or_default().to_owned();
            let body = self.method_body(self.file.after(self.at + 1));
            if let Some(owner) = owner
                && self.file.declarations[owner].name == name
                && parameters.is_empty()
            {
                self.file.declarations[owner].constructor = body;
            }
            return;
        }
        let named = self.file.type_name(self.at);
        let named = named.and_then(|(kind, at)| Some((kind, self.file.word(at)?.to_owned(), at + 1)));
        let Some((kind, mut name, mut at)) = named else {
            self.complain(self.at, "this declaration is not understood".into());
            return self.skip_statement();
        };
        if self.file.is(at, "(") {
            if let Some(owner) = owner {
                self.file.declarations[owner].methods.insert(name);
            }
            self.method_body(self.file.after(at));
            return;
        }
        let scope_end = self.open.last().map_or(self.file.tokens.len(), |(_, end)| *end);
        loop {
            let array = self.file.is(at, "[");
            while self.file.is(at, "[") && self.file.is(at + 1, "]") {
                at += 2;
            }
            let kind = if array { format!("{kind}[]") } else { kind.clone() };
            let value = self.file.is(at, "=").then(|| {
                let end = self.file.find(at + 1, scope_end, &[",", ";"]);
                at + 1..end
            });
            at = value.as_ref().map_or(at, |value| value.end);
            self.variable(modifiers, owner, kind, name, value);
            match self.file.word(at + 1) {
                Some(next) if self.file.is(at, ",") => name = next.to_owned(),
                _ => break,
            }
            at += 2;
        }
        self.at = at;
        self.skip_statement();
    }

    fn variable(
        &mut self,
        modifiers: &Modifiers,
        owner: Option<usize>,
        kind: String,
        name: String,
        value: Option<Range<usize>>,
    ) {
        match (owner, value) {
            (Some(owner), value) if !modifiers.is_static && !modifiers.is_fixed => {
                let member = Member::Field { kind, name, value };
                self.file.declarations[owner].members.push(member);
            }
            (owner, Some(value)) => {
                let owner = owner.map(|owner| self.file.declarations[owner].full_name.clone());
                let owner = owner.unwrap_or_default();
                let constant = Constant { owner, kind, fixed: modifiers.is_fixed, value };
                let namesakes = self.file.constants.entry(name).or_default();
                if namesakes.len() < MOST_NAMESAKES {
                    namesakes.push(constant);
                }
            }
            (_, None) => {}
        }
    }

    /// Goes behind a method whose parameters end before `at`; its body if that is in braces.
    fn method_body(&mut self, at: usize) -> Option<Range<usize>> {
        let end = self.open.last().map_or(self.file.tokens.len(), |(_, end)| *end);
        self.at = at;
        while self.at < end {
            if self.file.is(self.at, "[") && self.file.is(self.at + 1, "]") {
                self.at += 2;
            } else if self.file.is(self.at, "{") || self.file.is(self.at, "[") {
                let body = self.file.is(self.at, "{").then(|| self.file.inside(self.at));
                self.at = self.file.after(self.at);
                return body;
            } else if self.file.is(self.at, ";") {
                self.at += 1;
                break;
            } else {
                self.at = if self.file.is_open(self.at) { self.file.after(self.at) } else { self.at + 1 };
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        File::parse("a/test.rgg", text).declarations.iter().map(|d| d.full_name.clone()).collect()
    }

    #[test]
    fn members_are_told_apart() {
        let file = File::parse(
            "test.rgg",
            "import static Other.*; const int A = 1, B = 2;\n\
             public void run() [ Axiom ==> X; x:X, (x[a] > 1) ==>> ; ]\n\
             int[] numbers() { return new int[] {1, 2}; } Map<String, List<int>> m = new Map<A, B>();\n\
             @Deprecated(\"x\") public static module X(super.length, @Range(min=-1, max=1) double s, int[] k)\n\
             extends F(length) implements Serializable, Other { float a = 1, b; void f() {} { b = 2; } } \n\
             ==> { int i = 0; } Sphere(a) [ for (int i = 0; i < 3; i++) (F(1)) ];\n\
             class Y extends X { Y() { super(2); } static class Z {} module W; }",
        );
        assert_eq!(file.complaints, []);
        assert_eq!(file.imports, ["Other.*"]);
        let names: Vec<_> = file.declarations.iter().map(|d| d.full_name.as_str()).collect();
        assert_eq!(names, ["X", "Y", "Y$Z", "Y$W"]);
        let x = &file.declarations[0];
        assert_eq!((x.line, x.body.is_some(), x.members.len()), (4, true, 3));
        let parameters: Vec<_> = x.parameters.iter().map(|p| (p.name.as_str(), p.kind.as_str())).collect();
        assert_eq!(parameters, [("length", ""), ("s", "double"), ("k", "int[]")]);
        assert!(x.methods.contains("f"));
        assert!(file.declarations[1].constructor.is_some());
        assert_eq!(file.constants["A"].len() + file.constants["B"].len(), 2);
    }

    #[test]
    fn broken_sources_lose_little() {
        assert_eq!(names("module A extends (; module B;"), ["A", "B"]);
        assert_eq!(names("module A ==> Sphere(1) module B;"), ["A", "B"]);
        assert_eq!(names("module A { { ( } } module B;"), ["A", "B"]);
        assert_eq!(names("} ) ; 5 module ; int module = 3; module B"), ["B"]);
    }

    #[test]
    fn nesting_needs_no_recursion() {
        let depth = 100_000;
        let text = "module A {".repeat(depth) + &"}".repeat(depth);
        assert_eq!(names(&text).len(), DEEPEST_NESTING + 1);
        assert_eq!(names(&("module A {".repeat(depth) + &"{[(".repeat(depth))).len(), depth);
        let _ = File::parse("x.rgg", &"<".repeat(depth));
        let _ = File::parse("x.rgg", &"a.".repeat(depth));
        let _ = File::parse("x.rgg", &"module".repeat(depth));
    }
}
