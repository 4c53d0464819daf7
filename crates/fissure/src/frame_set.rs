//! Sets of frame numbers as typed: `1-45x2`, `1,10,20-30`, `-5--1`.

use crate::exit::Exit;
use crate::failure::Failure;
use std::fmt;
use std::str::FromStr;

/// A set of frame numbers: a union of ranges with strides.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FrameSet {
    /// As it was typed.
    text: String,
    ranges: Vec<Range>,
}

/// `first`, `first + stride`, ... up to `last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Range {
    first: i64,
    last: i64,
    stride: i64,
}

impl Range {
    /// The highest frame.
    fn end(&self) -> i64 {
        self.last - (self.last - self.first) % self.stride
    }
}

/// Why a set of frames cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no range of frames; write for example 7, 1-45, 1-45x2 or 1,10,20-30")]
pub(crate) struct FrameSetError(String);

impl FrameSet {
    /// Whether `frame` belongs to the set.
    pub(crate) fn contains(&self, frame: i64) -> bool {
        self.ranges.iter().any(|r| (r.first..=r.last).contains(&frame) && (frame - r.first) % r.stride == 0)
    }

    /// That every frame of the set is one of `first` to `last`, which `whose` has.
    ///
    /// # Errors
    /// Names the frames that are not.
    pub(crate) fn must_be_in(&self, first: i64, last: i64, whose: &str) -> Result<(), Failure> {
        let outside = |r: &&Range| r.first < first || r.end() > last;
        let Some(range) = self.ranges.iter().find(outside) else { return Ok(()) };
        let number = if range.first < first || range.first > last { range.first } else { range.end() };
        Err(Failure::new(
            Exit::Usage,
            format!("`--frames {self}` asks for frame {number}, which {whose} does not have"),
            format!("{whose} has the frames {first}-{last}"),
        ))
    }

    /// The highest frame of the set.
    pub(crate) fn last(&self) -> i64 {
        self.ranges.iter().map(Range::end).max().unwrap_or(i64::MIN)
    }
}

impl FromStr for FrameSet {
    type Err = FrameSetError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let ranges = text.split(',').map(|part| range(part.trim()).ok_or_else(|| FrameSetError(part.to_owned())));
        Ok(Self { text: text.to_owned(), ranges: ranges.collect::<Result<_, _>>()? })
    }
}

impl fmt::Display for FrameSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

fn range(text: &str) -> Option<Range> {
    let (span, stride) = match text.split_once('x') {
        Some((span, stride)) => (span, number(stride)?),
        None => (text, 1),
    };
    // The first character may be a sign; a dash after it separates the ends.
    let dash = span.char_indices().skip(1).find(|(_, c)| *c == '-').map(|(i, _)| i);
    let (first, last) = match dash {
        Some(i) => (number(&span[..i])?, number(&span[i + 1..])?),
        None => (number(span)?, number(span)?),
    };
    (first <= last && stride >= 1).then_some(Range { first, last, stride })
}

/// Frame numbers have at most nine digits, so that differences cannot overflow.
fn number(text: &str) -> Option<i64> {
    text.parse::<i64>().ok().filter(|n| n.abs() <= 999_999_999)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn members(text: &str) -> Vec<i64> {
        let set: FrameSet = text.parse().unwrap();
        (-20..=60).filter(|&f| set.contains(f)).collect()
    }

    #[test]
    fn ranges_strides_lists_and_signs() {
        assert_eq!(members("7"), [7]);
        assert_eq!(members("1-9x4"), [1, 5, 9]);
        assert_eq!(members("1-10x4"), [1, 5, 9]);
        assert_eq!(members("3, 1-2"), [1, 2, 3]);
        assert_eq!(members("-3--1"), [-3, -2, -1]);
        assert_eq!(members("-1-1"), [-1, 0, 1]);
    }

    #[test]
    fn the_last_frame_is_one_that_is_in_the_set() {
        assert_eq!("1-10x4,2".parse::<FrameSet>().unwrap().last(), 9);
    }

    #[test]
    fn frames_that_are_not_there_are_named() {
        let told = |text: &str| {
            let set: FrameSet = text.parse().unwrap();
            set.must_be_in(1, 48, "the scene").map_err(|failure| format!("{failure} {:?}", failure.remedy))
        };
        for fine in ["1-48", "48", "1-50x5", "5,7-9"] {
            assert_eq!(told(fine), Ok(()), "{fine}");
        }
        for (bad, number) in [("40-60", 60), ("0-4", 0), ("5,100-200", 100), ("1-50x7", 50), ("-3", -3)] {
            let told = told(bad).unwrap_err();
            assert!(
                told.contains(&format!("frame {number},")) && told.contains("1-48") && told.contains(bad),
                "{told}"
            );
        }
    }

    #[test]
    fn nonsense_is_refused_and_named() {
        for bad in ["", "a", "5-1", "1-5x0", "1-5x-1", "1--", "1-2-3", "99999999999", "é-1"] {
            let error = bad.parse::<FrameSet>().unwrap_err();
            assert!(error.to_string().contains(&format!("`{bad}`")), "{error}");
        }
    }
}
