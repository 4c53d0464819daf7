//! What is wanted of the resolution instead of a particle spacing.

/// What is wanted of the resolution of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wish {
    /// The highest K of each tip shall be within this part of it [–].
    Accuracy(f64),
    /// The run shall take so long [s].
    Budget(f64),
}

/// Why a word is no wish: how it is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WishError {
    /// It is no accuracy.
    #[error("write per cents, such as 2%: above 0% and below 100%")]
    NoPerCent,
    /// It is no time.
    #[error("write a time such as 30s, 5min or 2h, above 0")]
    NoTime,
}

impl Wish {
    /// An accuracy as it is written: "2%".
    ///
    /// # Errors
    /// [`WishError::NoPerCent`]
    pub fn accuracy(word: &str) -> Result<Self, WishError> {
        let number = word.trim().strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
        let within = number.filter(|value| *value > 0.0 && *value < 100.0).ok_or(WishError::NoPerCent)?;
        Ok(Self::Accuracy(0.01 * within))
    }

    /// A time as it is written: "30s", "5min", "2h".
    ///
    /// # Errors
    /// [`WishError::NoTime`]
    pub fn budget(word: &str) -> Result<Self, WishError> {
        let units = [("min", 60.0), ("s", 1.0), ("h", 3600.0)];
        let value = units.iter().find_map(|(unit, seconds)| {
            let value: f64 = word.trim().strip_suffix(unit)?.trim().parse().ok()?;
            Some(value * seconds)
        });
        value.filter(|value| value.is_finite() && *value > 0.0).map(Self::Budget).ok_or(WishError::NoTime)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the units. A number alone could be anything.
    #[test]
    fn wishes_have_a_unit() {
        for (word, expected) in [("2%", Some(0.02)), ("1.5 %", Some(0.015)), ("2", None), ("0%", None), ("nan%", None)]
        {
            assert_eq!(Wish::accuracy(word).ok(), expected.map(Wish::Accuracy), "{word}");
        }
        for (word, expected) in [
            ("30s", Some(30.0)),
            ("5min", Some(300.0)),
            ("0.5 h", Some(1800.0)),
            ("30", None),
            ("-1s", None),
            ("infs", None),
            ("", None),
        ] {
            assert_eq!(Wish::budget(word).ok(), expected.map(Wish::Budget), "{word}");
        }
    }
}
