//! Numbers that may be infinite: JSON has no word for that, so it is written `"inf"` there.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Word(Word),
}

#[derive(Serialize, Deserialize)]
enum Word {
    #[serde(rename = "inf")]
    Infinite,
}

pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if serializer.is_human_readable() && *value == f64::INFINITY {
        Number::Word(Word::Infinite).serialize(serializer)
    } else {
        value.serialize(serializer)
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    if !deserializer.is_human_readable() {
        return f64::deserialize(deserializer);
    }
    Ok(match Number::deserialize(deserializer)? {
        Number::Finite(value) => value,
        Number::Word(Word::Infinite) => f64::INFINITY,
    })
}
