//! GroIMP's inline value syntax, as in attributes of `graph.xml` and option values of `project.gs`:
//! `[some.Class field=value]`, `( ... )`, `{ ... }`, `#94`, `*MetaGraph:#94`, `@base64`, strings, `null`.

use crate::values::{Kind, Symbol, Value, ValueId, Values};

/// Adds the value that `text` describes. Text that does not follow the syntax becomes plain data, so that a
/// field nobody asks for never stops reading.
pub(crate) fn parse_value(values: &mut Values, text: &str, line: usize) -> ValueId {
    let Some(all) = parse_fields(values, text, line) else {
        return plain(values, text, line);
    };
    let parsed = values.get(all);
    let bare = parsed.text.is_some();
    let mut members = values.iter(parsed.members);
    let (first, second) = (members.next().cloned(), members.next().is_some());
    drop(members);
    match first {
        None => plain(values, text, line),
        Some(only) if only.name.is_none() && !second && !bare => values.add(only),
        Some(_) => all,
    }
}

fn plain(values: &mut Values, text: &str, line: usize) -> ValueId {
    let mut value = Value::new(Kind::Data, line);
    value.text = Some(text.into());
    values.add(value)
}

/// A bracket that is not closed yet.
struct Open {
    value: ValueId,
    close: Option<char>,
    bare: String,
    name: Option<Symbol>,
}

impl Open {
    fn new(values: &mut Values, kind: Kind, close: Option<char>, line: usize) -> Self {
        Open { value: values.add(Value::new(kind, line)), close, bare: String::new(), name: None }
    }
}

/// Adds an object with the fields that `text` lists; `None` if brackets or quotes do not match.
pub(crate) fn parse_fields(values: &mut Values, text: &str, line: usize) -> Option<ValueId> {
    // Values nest; the explicit stack keeps hostile nesting off the machine's.
    let mut stack = vec![Open::new(values, Kind::Object, None, line)];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        if values.is_full() {
            return None;
        }
        let after = &rest[first.len_utf8()..];
        let top = stack.last_mut()?;
        match first {
            c if c.is_whitespace() || c == ',' => rest = after,
            '[' => {
                let mut open = Open::new(values, Kind::Object, Some(']'), line);
                let (class, tail) = word(after.trim_start());
                let class = values.intern(class);
                values.get_mut(open.value).type_name = Some(class);
                open.name = None;
                stack.push(open);
                rest = tail;
            }
            '(' => {
                stack.push(Open::new(values, Kind::Object, Some(')'), line));
                rest = after;
            }
            '{' => {
                stack.push(Open::new(values, Kind::Array, Some('}'), line));
                rest = after;
            }
            ']' | ')' | '}' => {
                let done = stack.pop()?;
                if done.close != Some(first) {
                    return None;
                }
                let value = close(values, done);
                attach(values, stack.last_mut()?, value);
                rest = after;
            }
            '"' | '\'' => {
                let (string, tail) = quoted(after, first)?;
                add(values, top, Kind::Data, Some(&string), line);
                rest = tail;
            }
            '#' | '*' | '@' => {
                let kind = match first {
                    '#' => Kind::Ref,
                    '*' => Kind::Shared,
                    _ => Kind::Serialized,
                };
                let (reference, tail) = word_with_quotes(after);
                add(values, top, kind, Some(reference), line);
                rest = tail;
            }
            '=' => return None,
            _ => {
                let (token, tail) = word(rest);
                let unspaced = tail.trim_start();
                if let Some(tail) = unspaced.strip_prefix('=') {
                    top.name = Some(values.intern(token));
                    rest = tail;
                } else {
                    rest = tail;
                    if token == "null" {
                        add(values, top, Kind::Null, None, line);
                    } else if top.name.is_some() {
                        add(values, top, Kind::Data, Some(token), line);
                    } else {
                        top.bare.push_str(token);
                        top.bare.push(' ');
                    }
                }
            }
        }
    }
    let done = stack.pop()?;
    stack.is_empty().then(|| close(values, done))
}

fn close(values: &mut Values, open: Open) -> ValueId {
    if !open.bare.is_empty() {
        values.get_mut(open.value).text = Some(open.bare.trim_end().into());
    }
    open.value
}

fn add(values: &mut Values, open: &mut Open, kind: Kind, text: Option<&str>, line: usize) {
    let mut value = Value::new(kind, line);
    value.text = text.map(Into::into);
    let value = values.add(value);
    attach(values, open, value);
}

fn attach(values: &mut Values, open: &mut Open, value: ValueId) {
    values.get_mut(value).name = open.name.take();
    values.append_to(open.value, value);
}

/// Splits off a word: up to white space, a comma, a bracket, a quote or `=`.
fn word(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| c.is_whitespace() || ",[](){}\"'=".contains(c)).unwrap_or(text.len());
    text.split_at(end)
}

/// As [`word`], but a quoted part and `=` (base64 padding) belong to it.
fn word_with_quotes(text: &str) -> (&str, &str) {
    let mut in_quotes = false;
    let mut escaped = false;
    let end = text.find(|c: char| {
        if escaped {
            escaped = false;
            return false;
        }
        match c {
            '\\' => escaped = true,
            '"' => in_quotes = !in_quotes,
            _ => return !in_quotes && (c.is_whitespace() || ",[](){}".contains(c)),
        }
        false
    });
    text.split_at(end.unwrap_or(text.len()))
}

/// Contents of a quoted string and what follows it; `None` if the closing quote is missing.
fn quoted(text: &str, quote: char) -> Option<(String, &str)> {
    let mut string = String::new();
    let mut chars = text.char_indices();
    while let Some((at, c)) = chars.next() {
        match c {
            '\\' => string.push(chars.next()?.1),
            c if c == quote => return Some((string, &text[at + c.len_utf8()..])),
            c => string.push(c),
        }
    }
    None
}

/// Path in `/:"/project/objects/images/leaf"`, the text of a shared object from the registry.
pub(crate) fn registry_path(shared: &str) -> Option<String> {
    let quoted_path = shared.trim().strip_prefix("/:")?.trim_start();
    match quoted_path.strip_prefix('"') {
        Some(rest) => quoted(rest, '"').map(|(path, _)| path),
        None => Some(quoted_path.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_objects_nest() {
        let mut values = Values::default();
        let text = "visibleLayers={true false}epsilon=1.0E-6 camera=(minZ=0.1 projection=[a.P aspect=1.0 \
                    fov=2]transformation=(1.0 0.0))navigator=null s=\"a\\\"b\" r=#94 m=*MetaGraph:#95";
        let all = parse_fields(&mut values, text, 1).unwrap();
        let members = values.get(all).members;
        let find = |members, name| values.find(members, name).unwrap().clone();
        assert_eq!(find(members, "visibleLayers").text(), "true false");
        assert_eq!(find(members, "epsilon").text(), "1.0E-6");
        assert_eq!(find(members, "navigator").kind, Kind::Null);
        assert_eq!(find(members, "s").text(), "a\"b");
        assert_eq!((find(members, "r").kind, find(members, "r").text()), (Kind::Ref, "94"));
        assert_eq!((find(members, "m").kind, find(members, "m").text()), (Kind::Shared, "MetaGraph:#95"));
        let camera = find(members, "camera");
        assert_eq!(find(camera.members, "transformation").text(), "1.0 0.0");
        let projection = find(camera.members, "projection");
        assert_eq!(values.type_of(&projection), Some("a.P"));
        assert_eq!(find(projection.members, "fov").text(), "2");
    }

    #[test]
    fn single_values() {
        let mut values = Values::default();
        let mut parse = |text: &str| {
            let id = parse_value(&mut values, text, 1);
            let value = values.get(id).clone();
            (value.kind, value.text().to_owned(), values.type_of(&value).map(str::to_owned))
        };
        assert_eq!(parse("0.07"), (Kind::Data, "0.07".into(), None));
        assert_eq!(parse("null").0, Kind::Null);
        assert_eq!(parse("[a.B true 21]"), (Kind::Object, "true 21".into(), Some("a.B".into())));
        assert_eq!(parse("[a.B"), (Kind::Data, "[a.B".into(), None));
        assert_eq!(parse("x = ] y"), (Kind::Data, "x = ] y".into(), None));
    }

    #[test]
    fn deep_nesting_needs_no_stack() {
        let mut values = Values::default();
        let text = format!("{}{}", "(".repeat(200_000), ")".repeat(200_000));
        std::thread::Builder::new()
            .stack_size(128 * 1024)
            .spawn(move || {
                parse_value(&mut values, &text, 1);
            })
            .unwrap()
            .join()
            .unwrap();
    }

    #[test]
    fn registry_paths() {
        let path = registry_path("/:\"/project/objects/images/a b\"");
        assert_eq!(path.as_deref(), Some("/project/objects/images/a b"));
        assert_eq!(registry_path("MetaGraph:#94"), None);
    }
}
