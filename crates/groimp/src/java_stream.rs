//! Java object streams (Java Object Serialization Specification, version 5) as data: an object with its fields,
//! whatever its class.
//!
//! Fields hold primitives, strings and arrays of primitives; that is all that GroIMP's meshes consist of. Nothing is
//! instantiated and nothing recurses. A stream needs memory in proportion to its length: arrays are only read as far
//! as there are bytes, and what is referred to twice is shared.

use std::sync::Arc;

/// An object of a stream.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JavaObject {
    /// Full name of its class.
    pub class: String,
    /// Fields of its class and the classes above by name, the uppermost class first.
    pub fields: Vec<(Arc<str>, JavaValue)>,
}

impl JavaObject {
    /// The field of that name; that of the lowest class if several have one.
    pub fn field(&self, name: &str) -> Option<&JavaValue> {
        self.fields.iter().rev().find(|(key, _)| &**key == name).map(|(_, value)| value)
    }
}

/// What a field holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum JavaValue {
    Null,
    /// byte, short, int, long, boolean or char.
    Integer(i64),
    /// float or double.
    Real(f64),
    Text(Arc<str>),
    Ints(Arc<[i32]>),
    Floats(Arc<[f32]>),
    /// Array of any other primitive type, whose elements nobody asks for.
    OtherArray,
}

const MAGIC_AND_VERSION: u32 = 0xACED_0005;
const TC_NULL: u8 = 0x70;
const TC_REFERENCE: u8 = 0x71;
const TC_CLASSDESC: u8 = 0x72;
const TC_OBJECT: u8 = 0x73;
const TC_STRING: u8 = 0x74;
const TC_ARRAY: u8 = 0x75;
const TC_BLOCKDATA: u8 = 0x77;
const TC_ENDBLOCKDATA: u8 = 0x78;
const TC_BLOCKDATALONG: u8 = 0x7A;
const SC_WRITE_METHOD: u8 = 1;
const SC_SERIALIZABLE: u8 = 2;
const FIRST_HANDLE: u32 = 0x7E_0000;
/// Classes above each other; also ends chains that bite their tail, which broken streams can hold.
const MAX_SUPERCLASSES: usize = 32;
/// Fields of an object, all classes together.
const MAX_FIELDS: usize = 4096;

/// Reads the object that a stream starts with; the error says what is wrong and where.
pub(crate) fn parse(bytes: &[u8]) -> Result<JavaObject, String> {
    let mut stream = Stream { bytes, at: 0, handles: Vec::new(), classes: Vec::new() };
    stream.object().map_err(|problem| format!("{problem} at byte {} of the Java stream", stream.at))
}

/// A class as the stream describes it.
struct Class {
    name: Arc<str>,
    flags: u8,
    fields: Vec<(u8, Arc<str>)>,
    /// Position among the classes.
    superclass: Option<usize>,
}

/// What a back reference can lead to.
#[derive(Clone)]
enum Handle {
    Class(usize),
    Value(JavaValue),
    /// The object itself, which no field of a mesh refers to.
    Object,
}

struct Stream<'a> {
    bytes: &'a [u8],
    at: usize,
    handles: Vec<Handle>,
    classes: Vec<Class>,
}

impl<'a> Stream<'a> {
    fn object(&mut self) -> Result<JavaObject, String> {
        if u32::from_be_bytes(self.array()?) != MAGIC_AND_VERSION {
            return Err("found no Java stream header, expected AC ED 00 05,".to_owned());
        }
        match self.byte()? {
            TC_OBJECT => {}
            other => return Err(format!("found element {other:#04x}, expected an object,")),
        }
        let lowest = self.class()?.ok_or("found an object without class")?;
        self.handles.push(Handle::Object);

        let mut chain = Vec::new();
        let mut next = Some(lowest);
        while let Some(class) = next {
            if chain.len() == MAX_SUPERCLASSES {
                return Err(format!("found more than {MAX_SUPERCLASSES} classes above each other"));
            }
            chain.push(class);
            next = self.classes[class].superclass;
        }
        let mut fields = Vec::new();
        for &class in chain.iter().rev() {
            let Class { flags, fields: declared, .. } = &self.classes[class];
            let (flags, declared) = (*flags, declared.clone());
            if flags & SC_SERIALIZABLE == 0 {
                return Err("found a class with a format of its own (Externalizable)".to_owned());
            }
            if fields.len() + declared.len() > MAX_FIELDS {
                return Err(format!("found an object with more than {MAX_FIELDS} fields"));
            }
            for (code, name) in declared {
                let value = self.value(code)?;
                fields.push((name, value));
            }
            if flags & SC_WRITE_METHOD != 0 {
                self.annotation()?;
            }
        }
        Ok(JavaObject { class: self.classes[lowest].name.to_string(), fields })
    }

    /// A class description, new or referred to, with those above it; `None` for null.
    fn class(&mut self) -> Result<Option<usize>, String> {
        let mut first = None;
        let mut below: Option<usize> = None;
        loop {
            let (class, is_new) = match self.byte()? {
                TC_NULL => (None, false),
                TC_REFERENCE => match self.reference()? {
                    Handle::Class(class) => (Some(class), false),
                    Handle::Value(_) | Handle::Object => {
                        return Err("found a reference to a value, expected one to a class,".to_owned());
                    }
                },
                TC_CLASSDESC => (Some(self.new_class()?), true),
                other => return Err(format!("found element {other:#04x}, expected a class,")),
            };
            match below {
                Some(below) => self.classes[below].superclass = class,
                None => first = class,
            }
            if !is_new {
                return Ok(first);
            }
            below = class;
        }
    }

    /// A class description up to the one of its superclass.
    fn new_class(&mut self) -> Result<usize, String> {
        let name = self.text()?;
        let _serial_version: [u8; 8] = self.array()?;
        let index = self.classes.len();
        self.classes.push(Class { name, flags: 0, fields: Vec::new(), superclass: None });
        self.handles.push(Handle::Class(index));
        let flags = self.byte()?;
        let count = u16::from_be_bytes(self.array()?);
        let mut fields = Vec::new();
        for _ in 0..count {
            let code = self.byte()?;
            let field = self.text()?;
            if matches!(code, b'[' | b'L') {
                // The type's name; what is stored tells its type itself.
                match self.reference_or_string()? {
                    JavaValue::Text(_) => {}
                    _ => return Err("found a field type that is no string".to_owned()),
                }
            }
            fields.push((code, field));
        }
        self.annotation()?;
        self.classes[index].flags = flags;
        self.classes[index].fields = fields;
        Ok(index)
    }

    /// Skips what a class writes besides its fields.
    fn annotation(&mut self) -> Result<(), String> {
        loop {
            let length = match self.byte()? {
                TC_ENDBLOCKDATA => return Ok(()),
                TC_BLOCKDATA => usize::from(self.byte()?),
                TC_BLOCKDATALONG => u32::from_be_bytes(self.array()?) as usize,
                other => return Err(format!("found element {other:#04x} in an annotation, expected bytes,")),
            };
            self.take(length)?;
        }
    }

    /// The value of a field by its type code.
    fn value(&mut self, code: u8) -> Result<JavaValue, String> {
        Ok(match code {
            b'B' => JavaValue::Integer(i8::from_be_bytes(self.array()?).into()),
            b'Z' => JavaValue::Integer(self.byte()?.into()),
            b'C' => JavaValue::Integer(u16::from_be_bytes(self.array()?).into()),
            b'S' => JavaValue::Integer(i16::from_be_bytes(self.array()?).into()),
            b'I' => JavaValue::Integer(i32::from_be_bytes(self.array()?).into()),
            b'J' => JavaValue::Integer(i64::from_be_bytes(self.array()?)),
            b'F' => JavaValue::Real(f32::from_be_bytes(self.array()?).into()),
            b'D' => JavaValue::Real(f64::from_be_bytes(self.array()?)),
            b'[' | b'L' => self.reference_or_string()?,
            other => return Err(format!("found a field of unknown type {other:#04x}")),
        })
    }

    /// Null, a back reference, a string or an array of primitives.
    fn reference_or_string(&mut self) -> Result<JavaValue, String> {
        match self.byte()? {
            TC_NULL => Ok(JavaValue::Null),
            TC_REFERENCE => match self.reference()? {
                Handle::Value(value) => Ok(value),
                Handle::Class(_) | Handle::Object => Err("found a reference to no value".to_owned()),
            },
            TC_STRING => {
                let value = JavaValue::Text(self.text()?);
                self.handles.push(Handle::Value(value.clone()));
                Ok(value)
            }
            TC_ARRAY => self.java_array(),
            other => {
                Err(format!("found element {other:#04x}, expected null, a string or an array of numbers,"))
            }
        }
    }

    fn java_array(&mut self) -> Result<JavaValue, String> {
        let class = self.class()?.ok_or("found an array without class")?;
        let name = Arc::clone(&self.classes[class].name);
        let handle = self.handles.len();
        self.handles.push(Handle::Object);
        let count = i32::from_be_bytes(self.array()?);
        let count = usize::try_from(count).map_err(|_| format!("found an array of length {count}"))?;
        let width = match &*name {
            "[B" | "[Z" => 1,
            "[C" | "[S" => 2,
            "[I" | "[F" => 4,
            "[J" | "[D" => 8,
            _ => return Err(format!("found an array of class {name}, expected one of numbers,")),
        };
        // Taking the bytes first bounds the elements by the length of the stream.
        let bytes = self.take(count.checked_mul(width).ok_or("found an array without end")?)?;
        let (words, _) = bytes.as_chunks::<4>();
        let value = match &*name {
            "[I" => JavaValue::Ints(words.iter().map(|word| i32::from_be_bytes(*word)).collect()),
            "[F" => JavaValue::Floats(words.iter().map(|word| f32::from_be_bytes(*word)).collect()),
            _ => JavaValue::OtherArray,
        };
        self.handles[handle] = Handle::Value(value.clone());
        Ok(value)
    }

    fn reference(&mut self) -> Result<Handle, String> {
        let handle = u32::from_be_bytes(self.array()?);
        let index = handle.checked_sub(FIRST_HANDLE).map(|index| index as usize);
        let found = index.and_then(|index| self.handles.get(index));
        found.cloned().ok_or_else(|| format!("found a reference to {handle:#x}, which is not there yet,"))
    }

    /// Java's modified UTF-8; it differs from UTF-8 only for NUL and beyond the basic plane.
    fn text(&mut self) -> Result<Arc<str>, String> {
        let length = usize::from(u16::from_be_bytes(self.array()?));
        Ok(String::from_utf8_lossy(self.take(length)?).into())
    }

    fn byte(&mut self) -> Result<u8, String> {
        let [byte] = self.array()?;
        Ok(byte)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, _) = self.bytes[self.at..].split_first_chunk::<N>().ok_or("the end came too early")?;
        self.at += N;
        Ok(*bytes)
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], String> {
        let (bytes, _) = self.bytes[self.at..].split_at_checked(length).ok_or("the end came too early")?;
        self.at += length;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An object of class A with a field for every primitive type, above it B with a string field and bytes of
    /// its own.
    fn sample() -> Vec<u8> {
        let mut s =
            vec![0xAC, 0xED, 0, 5, TC_OBJECT, TC_CLASSDESC, 0, 1, b'A', 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 4];
        s.extend([b'J', 0, 1, b'j', b'D', 0, 1, b'd', b'Z', 0, 1, b'z']);
        s.extend([b'[', 0, 1, b'a', TC_STRING, 0, 2, b'[', b'S', TC_ENDBLOCKDATA]);
        s.extend([TC_CLASSDESC, 0, 1, b'B', 0, 0, 0, 0, 0, 0, 0, 2, 3, 0, 1]);
        s.extend([b'L', 0, 1, b's', TC_REFERENCE, 0, 0x7E, 0, 1]);
        s.extend([TC_BLOCKDATA, 2, 9, 9, TC_ENDBLOCKDATA, TC_NULL]);
        // Values: B first.
        s.extend([TC_STRING, 0, 2, b'h', b'i', TC_BLOCKDATA, 1, 7, TC_ENDBLOCKDATA]);
        s.extend((-2i64).to_be_bytes());
        s.extend(0.5f64.to_be_bytes());
        s.extend([1, TC_ARRAY, TC_CLASSDESC, 0, 2, b'[', b'S', 0, 0, 0, 0, 0, 0, 0, 3, 2, 0, 0]);
        s.extend([TC_ENDBLOCKDATA, TC_NULL, 0, 0, 0, 1, 0, 5]);
        s
    }

    #[test]
    fn classes_above_come_first() {
        let object = parse(&sample()).unwrap();
        assert_eq!(object.class, "A");
        let names: Vec<_> = object.fields.iter().map(|(name, _)| &**name).collect();
        assert_eq!(names, ["s", "j", "d", "z", "a"]);
        assert_eq!(object.field("s"), Some(&JavaValue::Text("hi".into())));
        assert_eq!(object.field("j"), Some(&JavaValue::Integer(-2)));
        assert_eq!(object.field("d"), Some(&JavaValue::Real(0.5)));
        assert_eq!(object.field("z"), Some(&JavaValue::Integer(1)));
        assert_eq!(object.field("a"), Some(&JavaValue::OtherArray));
    }

    #[test]
    fn broken_streams_end_with_a_message() {
        let whole = sample();
        for length in 0..whole.len() {
            assert!(parse(&whole[..length]).unwrap_err().contains("too early"), "{length}");
        }
        for at in 0..whole.len() {
            for value in [0, 1, TC_NULL, TC_REFERENCE, TC_CLASSDESC, TC_ARRAY, 0x7F, 0xFF] {
                let mut changed = whole.clone();
                changed[at] = value;
                // Any result will do, except a panic or no end.
                let _ = parse(&changed);
            }
        }
    }

    #[test]
    fn a_class_above_itself_ends() {
        let mut s =
            vec![0xAC, 0xED, 0, 5, TC_OBJECT, TC_CLASSDESC, 0, 1, b'A', 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 0];
        s.extend([TC_ENDBLOCKDATA, TC_REFERENCE, 0, 0x7E, 0, 0]);
        assert!(parse(&s).unwrap_err().contains("above each other"));
    }
}
