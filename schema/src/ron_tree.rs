//! Turns RON text into a tree of values that know where in the text they stand. The `ron` crate does the parsing;
//! what it lends from its input (field names and raw values) is found again in the text by its address.

use std::fmt;
use std::ops::Range;

use ron::Options;
use ron::error::SpannedError;
use ron::value::RawValue;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// How deep values may stand within others. Each level is read once more than the one around it.
pub(crate) const MAX_DEPTH: usize = 32;

/// A value and the text it was written as.
pub(crate) struct Node<'a> {
    /// The value's text, without space and comments around it.
    pub text: &'a str,
    /// Where that text begins, in bytes.
    pub start: usize,
    pub value: Value<'a>,
}

pub(crate) enum Value<'a> {
    Number(f64),
    Text(String),
    /// `Name(field: value, …)`; the name may be missing.
    Struct(Vec<Field<'a>>),
    /// `[…]` or `(…, …)`.
    List(Vec<Node<'a>>),
    Some(Box<Node<'a>>),
    None,
    /// A name alone.
    Word,
    /// Everything that our files have no use for.
    Other,
}

pub(crate) struct Field<'a> {
    pub name: &'a str,
    pub name_start: usize,
    pub node: Node<'a>,
}

impl<'a> Node<'a> {
    pub fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    /// The name before the bracket of a struct; empty if there is none.
    pub fn struct_name(&self) -> &'a str {
        let end = self.text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(self.text.len());
        &self.text[..end]
    }

    /// What a person would call this kind of value.
    pub fn kind(&self) -> &'static str {
        match self.value {
            Value::Number(_) => "a number",
            Value::Text(_) => "a text",
            Value::Struct(_) => "named values in brackets",
            Value::List(_) => "a list",
            Value::Some(_) => "Some(…)",
            Value::None => "None",
            Value::Word => "a word",
            Value::Other => "something else",
        }
    }
}

/// The text as the parser needs it: of the same length or one line break longer, so that every place is kept.
pub(crate) fn prepare(text: &str) -> String {
    // A byte order mark, as some editors write, is three bytes of nothing; a comment may end the file.
    let mut prepared = text.replacen('\u{feff}', "   ", usize::from(text.starts_with('\u{feff}')));
    if !prepared.ends_with('\n') {
        prepared.push('\n');
    }
    prepared
}

/// Parses text from [`prepare`].
pub(crate) fn parse(text: &str) -> Result<Node<'_>, SpannedError> {
    // The deserializer has passed over comments and attributes when it stands ready.
    let start = text.len() - ron::Deserializer::from_str(text)?.remainder().len();
    let reader = Reader { text: text[start..].trim_end(), whole: text };
    let value = options().from_str_seed(text, reader)?;
    Ok(Node { text: reader.text, start, value })
}

fn options() -> Options {
    Options::default().with_recursion_limit(MAX_DEPTH)
}

/// Reads one value whose text is known.
#[derive(Clone, Copy)]
struct Reader<'a> {
    text: &'a str,
    whole: &'a str,
}

impl<'a> Reader<'a> {
    fn place(self, part: &str) -> usize {
        part.as_ptr() as usize - self.whole.as_ptr() as usize
    }

    fn node<E: Error>(self, raw: &'a RawValue) -> Result<Node<'a>, E> {
        let text = raw.trim().get_ron();
        let reader = Reader { text, whole: self.whole };
        let value = options().from_str_seed(text, reader).map_err(|error| E::custom(error.code))?;
        Ok(Node { text, start: self.place(text), value })
    }
}

impl<'a> DeserializeSeed<'a> for Reader<'a> {
    type Value = Value<'a>;

    fn deserialize<D: Deserializer<'a>>(self, deserializer: D) -> Result<Value<'a>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'a> Visitor<'a> for Reader<'a> {
    type Value = Value<'a>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E: Error>(self, _: bool) -> Result<Value<'a>, E> {
        Ok(Value::Word)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Value<'a>, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Value<'a>, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Value<'a>, E> {
        Ok(Value::Number(number))
    }

    fn visit_char<E: Error>(self, _: char) -> Result<Value<'a>, E> {
        Ok(Value::Other)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Value<'a>, E> {
        Ok(Value::Text(text.to_owned()))
    }

    fn visit_bytes<E: Error>(self, _: &[u8]) -> Result<Value<'a>, E> {
        Ok(Value::Other)
    }

    fn visit_none<E: Error>(self) -> Result<Value<'a>, E> {
        Ok(Value::None)
    }

    fn visit_some<D: Deserializer<'a>>(self, deserializer: D) -> Result<Value<'a>, D::Error> {
        let raw = <&RawValue as serde::Deserialize>::deserialize(deserializer)?;
        Ok(Value::Some(Box::new(self.node(raw)?)))
    }

    fn visit_unit<E: Error>(self) -> Result<Value<'a>, E> {
        Ok(if self.text.ends_with(')') { Value::Struct(Vec::new()) } else { Value::Word })
    }

    fn visit_seq<A: SeqAccess<'a>>(self, mut items: A) -> Result<Value<'a>, A::Error> {
        let mut nodes = Vec::new();
        while let Some(raw) = items.next_element()? {
            nodes.push(self.node(raw)?);
        }
        let empty_struct = nodes.is_empty() && self.text.ends_with(')');
        Ok(if empty_struct { Value::Struct(Vec::new()) } else { Value::List(nodes) })
    }

    fn visit_map<A: MapAccess<'a>>(self, mut entries: A) -> Result<Value<'a>, A::Error> {
        if self.text.starts_with(|c: char| !(c == '(' || c == '_' || c.is_alphabetic())) {
            // A `{…}` or a range `1..2`.
            while entries.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
            return Ok(Value::Other);
        }
        let mut fields = Vec::new();
        while let Some(name) = entries.next_key::<&'a str>()? {
            let node = self.node(entries.next_value()?)?;
            fields.push(Field { name, name_start: self.place(name), node });
        }
        Ok(Value::Struct(fields))
    }
}
