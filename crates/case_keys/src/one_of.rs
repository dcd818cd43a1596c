//! Values of several types, told apart by the type that is written.
//!
//! The errors of untagged enums of serde contain no place, so these values are read by a visitor.

use serde::Deserializer;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, DeserializeOwned, Error, SeqAccess, Unexpected, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// The value of a list of entries.
type FromList<T, Entry> = fn(Vec<Entry>) -> T;

/// A value that is a text, and may be a number, a whole number or a list instead.
pub(crate) trait OneOf: Sized {
    /// The entries of a list.
    type Entry: DeserializeOwned;
    /// The accepted types, for errors.
    const EXPECTED: &'static str;
    /// The value of a text.
    const OF_TEXT: fn(String) -> Self;
    /// The value of any number, if that is accepted.
    const OF_NUMBER: Option<fn(f64) -> Self> = None;
    /// The value of a whole number, if only those are accepted.
    const OF_WHOLE: Option<fn(usize) -> Self> = None;
    /// The value of a list, if that is accepted.
    const OF_LIST: Option<FromList<Self, Self::Entry>> = None;
}

/// Reads a value of several types.
///
/// # Errors
/// A type that is not accepted.
pub(crate) fn deserialize<'de, T: OneOf, S: Deserializer<'de>>(deserializer: S) -> Result<T, S::Error> {
    deserializer.deserialize_any(OneOfVisitor(PhantomData))
}

struct OneOfVisitor<T>(PhantomData<T>);

impl<'de, T: OneOf> Visitor<'de> for OneOfVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        Ok(T::OF_TEXT(text.to_owned()))
    }
    fn visit_f64<E: Error>(self, value: f64) -> Result<T, E> {
        let of_number = T::OF_NUMBER.ok_or_else(|| E::invalid_type(Unexpected::Float(value), &self))?;
        Ok(of_number(value))
    }
    fn visit_i64<E: Error>(self, value: i64) -> Result<T, E> {
        let Some(of_whole) = T::OF_WHOLE else { return self.visit_f64(value as f64) };
        usize::try_from(value).map(of_whole).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))
    }
    fn visit_u64<E: Error>(self, value: u64) -> Result<T, E> {
        let Some(of_whole) = T::OF_WHOLE else { return self.visit_f64(value as f64) };
        usize::try_from(value).map(of_whole).map_err(|_| E::invalid_value(Unexpected::Unsigned(value), &self))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        let of_list = T::OF_LIST.ok_or_else(|| A::Error::invalid_type(Unexpected::Seq, &self))?;
        Vec::deserialize(SeqAccessDeserializer::new(entries)).map(of_list)
    }
}
