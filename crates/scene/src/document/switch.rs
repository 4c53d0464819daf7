//! A table of values that `true` and `false` may stand for.

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// `false`: off; `true`: on, every value as by default; a table: on, with these values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "{T}OrSwitch")]
pub enum Switch<T> {
    /// Off, or on with the values by default.
    On(bool),
    /// On, with these values.
    Values(T),
}

impl<T: Default> Switch<T> {
    /// The values given; none: off.
    pub fn values(self) -> Option<T> {
        match self {
            Self::On(false) => None,
            Self::On(true) => Some(T::default()),
            Self::Values(values) => Some(values),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Switch<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SwitchVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for SwitchVisitor<T> {
            type Value = Switch<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("true, false or a table of values")
            }
            fn visit_bool<E>(self, on: bool) -> Result<Switch<T>, E> {
                Ok(Switch::On(on))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Switch<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Switch::Values)
            }
        }
        deserializer.deserialize_any(SwitchVisitor(PhantomData))
    }
}
