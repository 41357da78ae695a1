//! Results as trees of plain values, which go to JavaScript by one path.
//!
//! serde writes a serialiser's code into every struct that it serialises, with the failure of every field: through this
//! one, which cannot fail and does little, that is a third of what it is through serde-wasm-bindgen's.

use core::fmt::{Debug, Display, Formatter};

use serde::ser::{Impossible, SerializeMap, SerializeSeq, SerializeStruct, SerializeTuple};
use serde::{Serialize, Serializer};

/// A plain value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Nothing.
    Null,
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// Values in order.
    List(Vec<Self>),
    /// Values by name, in order.
    Record(Vec<(String, Self)>),
}

impl Value {
    /// The tree of anything that is made of numbers, texts, flags, options, sequences, structs and unit variants.
    pub fn of(value: &impl Serialize) -> Self {
        match value.serialize(Tree) {
            Ok(tree) => tree,
            Err(never) => match never {},
        }
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_none(),
            Self::Flag(flag) => serializer.serialize_bool(*flag),
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::Text(text) => serializer.serialize_str(text),
            Self::List(items) => serializer.collect_seq(items),
            Self::Record(fields) => serializer.collect_map(fields.iter().map(|(name, value)| (name, value))),
        }
    }
}

/// Makes trees.
struct Tree;

/// A list or a record that is being made.
#[derive(Default)]
struct Branch {
    items: Vec<Value>,
    fields: Vec<(String, Value)>,
}

impl Branch {
    #[inline(never)]
    fn item(&mut self, value: Value) {
        self.items.push(value);
    }

    #[inline(never)]
    fn field(&mut self, name: &str, value: Value) {
        self.fields.push((name.to_owned(), value));
    }
}

/// The error of what cannot fail.
enum Never {}

impl Debug for Never {
    fn fmt(&self, _: &mut Formatter<'_>) -> core::fmt::Result {
        match *self {}
    }
}

impl Display for Never {
    fn fmt(&self, _: &mut Formatter<'_>) -> core::fmt::Result {
        match *self {}
    }
}

impl core::error::Error for Never {}

impl serde::ser::Error for Never {
    fn custom<T: Display>(_: T) -> Self {
        // Serialize implementations of this crate raise no error of their own.
        unreachable!()
    }
}

impl SerializeSeq for Branch {
    type Ok = Value;
    type Error = Never;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Never> {
        self.item(value.serialize(Tree)?);
        Ok(())
    }

    fn end(self) -> Result<Value, Never> {
        Ok(Value::List(self.items))
    }
}

impl SerializeTuple for Branch {
    type Ok = Value;
    type Error = Never;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Never> {
        SerializeSeq::serialize_element(self, value)
    }

    fn end(self) -> Result<Value, Never> {
        SerializeSeq::end(self)
    }
}

impl SerializeStruct for Branch {
    type Ok = Value;
    type Error = Never;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> Result<(), Never> {
        self.field(name, value.serialize(Tree)?);
        Ok(())
    }

    fn end(self) -> Result<Value, Never> {
        Ok(Value::Record(self.fields))
    }
}

impl SerializeMap for Branch {
    type Ok = Value;
    type Error = Never;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), Never> {
        // Keys are texts: nothing else is a name.
        if let Value::Text(name) = key.serialize(Tree)? {
            self.field(&name, Value::Null);
        }
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Never> {
        let value = value.serialize(Tree)?;
        if let Some((_, last)) = self.fields.last_mut() {
            *last = value;
        }
        Ok(())
    }

    fn end(self) -> Result<Value, Never> {
        SerializeStruct::end(self)
    }
}

/// Methods that take a number.
macro_rules! numbers {
    ($($method:ident: $type:ty),+) => {
        $(fn $method(self, number: $type) -> Result<Value, Never> {
            Ok(Value::Number(number as f64))
        })+
    };
}

impl Serializer for Tree {
    type Ok = Value;
    type Error = Never;
    type SerializeSeq = Branch;
    type SerializeTuple = Branch;
    type SerializeTupleStruct = Impossible<Value, Never>;
    type SerializeTupleVariant = Impossible<Value, Never>;
    type SerializeMap = Branch;
    type SerializeStruct = Branch;
    type SerializeStructVariant = Impossible<Value, Never>;

    numbers! {
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64,
        serialize_f32: f32, serialize_f64: f64
    }

    fn serialize_bool(self, flag: bool) -> Result<Value, Never> {
        Ok(Value::Flag(flag))
    }

    fn serialize_char(self, char: char) -> Result<Value, Never> {
        Ok(Value::Text(char.to_string()))
    }

    fn serialize_str(self, text: &str) -> Result<Value, Never> {
        Ok(Value::Text(text.to_owned()))
    }

    fn serialize_bytes(self, bytes: &[u8]) -> Result<Value, Never> {
        self.collect_seq(bytes)
    }

    fn serialize_none(self) -> Result<Value, Never> {
        Ok(Value::Null)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Value, Never> {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Result<Value, Never> {
        Ok(Value::Null)
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<Value, Never> {
        Ok(Value::Null)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Result<Value, Never> {
        self.serialize_str(variant)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<Value, Never> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<Value, Never> {
        let mut record = Branch::default();
        record.serialize_field(variant, value)?;
        SerializeStruct::end(record)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Branch, Never> {
        Ok(Branch::default())
    }

    fn serialize_tuple(self, _: usize) -> Result<Branch, Never> {
        Ok(Branch::default())
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Self::SerializeTupleStruct, Never> {
        unsupported()
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Never> {
        unsupported()
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Branch, Never> {
        Ok(Branch::default())
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Branch, Never> {
        Ok(Branch::default())
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeStructVariant, Never> {
        unsupported()
    }
}

/// Shapes that no result has.
fn unsupported<T>() -> Result<T, Never> {
    unreachable!()
}
