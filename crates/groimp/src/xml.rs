//! The XML that GroIMP writes, as a stream of start and end tags with line numbers.

use crate::ReadError;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::borrow::Cow;

/// A tag.
pub(crate) enum Tag<'a> {
    Start(Element<'a>),
    End,
    /// End of the file; all elements are closed.
    Eof,
}

/// A start tag with its attributes.
pub(crate) struct Element<'a> {
    pub name: String,
    pub line: usize,
    pub attributes: Vec<(&'a str, Cow<'a, str>)>,
}

impl Element<'_> {
    pub fn attribute(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(k, _)| *k == key).map(|(_, value)| value.as_ref())
    }
}

/// Pull reader over one file. An empty element yields a start and an end.
pub(crate) struct Xml<'a> {
    file: &'a str,
    text: &'a str,
    reader: Reader<&'a [u8]>,
    counted_to: usize,
    line: usize,
    depth: usize,
}

impl<'a> Xml<'a> {
    /// Checks the encoding and starts at the first byte. `file` is for messages.
    pub fn new(file: &'a str, bytes: &'a [u8]) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|error| ReadError::Xml {
            file: file.to_owned(),
            line: 1 + count_lines(&bytes[..error.valid_up_to()]),
            reason: "the bytes are not UTF-8, which is what GroIMP writes".to_owned(),
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Ok(Xml { file, text, reader, counted_to: 0, line: 1, depth: 0 })
    }

    /// The next tag; text, comments and processing instructions are passed over.
    pub fn next(&mut self) -> Result<Tag<'a>, ReadError> {
        loop {
            let start = self.reader.buffer_position();
            let event = self.reader.read_event();
            let line = self.line_at(start);
            match event {
                Ok(Event::Start(tag)) => {
                    self.depth += 1;
                    return self.element(tag, line).map(Tag::Start);
                }
                Ok(Event::End(_)) => {
                    self.depth = self.depth.saturating_sub(1);
                    return Ok(Tag::End);
                }
                Ok(Event::Eof) if self.depth > 0 => {
                    let reason = format!(
                        "the file ends while {} elements are open, expected their end tags; it is cut off",
                        self.depth
                    );
                    return Err(self.error(line, reason));
                }
                Ok(Event::Eof) => return Ok(Tag::Eof),
                Ok(_) => {}
                Err(error) => {
                    let line = self.line_at(self.reader.error_position());
                    return Err(self.error(line, error.to_string()));
                }
            }
        }
    }

    fn element(&self, tag: BytesStart<'a>, line: usize) -> Result<Element<'a>, ReadError> {
        let name = String::from_utf8_lossy(tag.local_name().as_ref()).into_owned();
        // The tag borrows from the text, but its iterator borrows from the tag: go back to the text.
        let raw: &'a str = self.borrowed(tag.attributes_raw());
        let mut attributes = Vec::new();
        let mut iterator = quick_xml::events::attributes::Attributes::new(raw, 0);
        // A second attribute of the same name loses; the check for it takes quadratic time.
        for attribute in iterator.with_checks(false) {
            let attribute = attribute.map_err(|error| self.error(line, error.to_string()))?;
            let key = std::str::from_utf8(attribute.key.into_inner()).unwrap_or_default();
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|error| self.error(line, error.to_string()))?;
            attributes.push((key, value));
        }
        Ok(Element { name, line, attributes })
    }

    /// The same bytes with the life time of the text.
    fn borrowed(&self, part: &[u8]) -> &'a str {
        let offset = (part.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        self.text.get(offset..offset.wrapping_add(part.len())).unwrap_or("")
    }

    /// Line of a byte position; positions mostly grow, so counting goes on where it stopped.
    fn line_at(&mut self, position: u64) -> usize {
        let position = usize::try_from(position).unwrap_or(usize::MAX).min(self.text.len());
        if position < self.counted_to {
            self.counted_to = 0;
            self.line = 1;
        }
        self.line += count_lines(&self.text.as_bytes()[self.counted_to..position]);
        self.counted_to = position;
        self.line
    }

    fn error(&self, line: usize, reason: String) -> ReadError {
        ReadError::Xml { file: self.file.to_owned(), line, reason }
    }
}

fn count_lines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|b| **b == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_carry_lines_and_unescaped_attributes() {
        let text = b"<?xml version=\"1.0\"?>\n<a>\n <b x=\"&quot;1&#34;\"\n y='2'/>\n</a>\n";
        let mut xml = Xml::new("f", text).unwrap();
        let Tag::Start(a) = xml.next().unwrap() else { panic!("start of a expected") };
        assert_eq!((a.name.as_str(), a.line), ("a", 2));
        let Tag::Start(b) = xml.next().unwrap() else { panic!("start of b expected") };
        assert_eq!((b.line, b.attribute("x"), b.attribute("y")), (3, Some("\"1\""), Some("2")));
        assert!(matches!(xml.next().unwrap(), Tag::End));
        assert!(matches!(xml.next().unwrap(), Tag::End));
        assert!(matches!(xml.next().unwrap(), Tag::Eof));
    }

    #[test]
    fn line_breaks_in_attributes_are_spaces_unless_escaped() {
        // As for Java's readers, and so for GroIMP: section 3.3.3 of XML 1.0.
        let mut xml = Xml::new("f", b"<a x='1\n2\t3&#10;4'/>").unwrap();
        let Tag::Start(a) = xml.next().unwrap() else { panic!("start of a expected") };
        assert_eq!(a.attribute("x"), Some("1 2 3\n4"));
    }

    #[test]
    fn a_cut_off_file_names_the_line() {
        let mut xml = Xml::new("f", b"<a>\n<b>\n").unwrap();
        let error = loop {
            match xml.next() {
                Ok(Tag::Eof) => panic!("the end was accepted"),
                Ok(_) => {}
                Err(error) => break error,
            }
        };
        assert!(matches!(error, ReadError::Xml { line: 3, .. }), "{error}");
    }
}
