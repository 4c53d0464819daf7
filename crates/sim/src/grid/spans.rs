//! Places of an unbounded lattice, kept as spans: runs of columns in rows. Memory goes with what is there, not with the
//! box around it.

/// A run of neighbouring places in one row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Span {
    /// Its first column.
    pub(crate) first: i32,
    /// The column after its last one.
    pub(crate) end: i32,
    /// Number of the place in the first column; the others follow.
    pub(crate) number: u32,
}

impl Span {
    /// Number of the place in `column`, if it is one of the span.
    fn number_of(&self, column: i32) -> Option<usize> {
        (self.first <= column && column < self.end).then(|| self.number as usize + (column - self.first) as usize)
    }

    /// (column, number) of its places from `low` to `high`.
    fn within(self, low: i32, high: i32) -> impl Iterator<Item = (i32, usize)> {
        let from = self.first.max(low);
        (from..self.end.min(high.saturating_add(1)))
            .map(move |column| (column, self.number as usize + (column - self.first) as usize))
    }
}

/// A row that has spans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Row {
    row: i32,
    /// Its first span; those up to the first of the next row belong to it.
    first: u32,
}

/// Sorted spans in sorted rows; none overlap.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct SpanRows {
    rows: Vec<Row>,
    spans: Vec<Span>,
}

impl SpanRows {
    /// The same with no place in it; memory is kept.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.spans.clear();
    }

    /// Adds a span behind all others: its row is that of the last one or above it, its columns are beyond those of the
    /// row.
    pub(crate) fn push(&mut self, row: i32, span: Span) {
        debug_assert!(self.rows.last().is_none_or(|last| last.row <= row), "rows rise");
        if self.rows.last().is_none_or(|last| last.row != row) {
            self.rows.push(Row { row, first: self.spans.len() as u32 });
        }
        self.spans.push(span);
    }

    /// Number of rows that have spans.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Number of spans.
    #[cfg(test)]
    pub(crate) fn span_count(&self) -> usize {
        self.spans.len()
    }

    /// The row at `index` of those that have spans.
    pub(crate) fn row(&self, index: usize) -> i32 {
        self.rows[index].row
    }

    /// Where `row` is among those that have spans.
    pub(crate) fn index_of(&self, row: i32) -> Option<usize> {
        // Rows without a gap, the usual case, are counted off.
        let ahead = usize::try_from(row.checked_sub(self.rows.first()?.row)?).ok()?;
        match self.rows.get(ahead) {
            Some(found) if found.row == row => Some(ahead),
            _ => self.rows.binary_search_by_key(&row, |r| r.row).ok(),
        }
    }

    /// Index of the first row at or above `row`.
    pub(crate) fn index_from(&self, row: i32) -> usize {
        self.rows.partition_point(|r| r.row < row)
    }

    /// Spans of the row at `index`.
    pub(crate) fn spans_of(&self, index: usize) -> &[Span] {
        let end = self.rows.get(index + 1).map_or(self.spans.len(), |next| next.first as usize);
        &self.spans[self.rows[index].first as usize..end]
    }

    /// Rows that have spans, rising, each with them.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (i32, &[Span])> {
        (0..self.rows.len()).map(|index| (self.rows[index].row, self.spans_of(index)))
    }

    /// The span of the row at `index` that holds `column`.
    pub(crate) fn span_with(&self, index: usize, column: i32) -> Option<&Span> {
        let spans = self.spans_of(index);
        let after = spans.partition_point(|span| span.first <= column);
        spans.get(after.checked_sub(1)?).filter(|span| column < span.end)
    }

    /// Number of the place in `column` of `row`.
    pub(crate) fn number(&self, column: i32, row: i32) -> Option<usize> {
        self.span_with(self.index_of(row)?, column)?.number_of(column)
    }

    /// (column, row, number) of the places in the box from `low` to `high` (column, row; both included), row by row,
    /// columns rising.
    pub(crate) fn within(&self, low: [i32; 2], high: [i32; 2]) -> impl Iterator<Item = (i32, i32, usize)> {
        let rows = (self.index_from(low[1])..self.rows.len()).take_while(move |&index| self.rows[index].row <= high[1]);
        rows.flat_map(move |index| {
            let (row, spans) = (self.rows[index].row, self.spans_of(index));
            let from = spans.partition_point(|span| span.end <= low[0]);
            let near = spans[from..].iter().take_while(move |span| span.first <= high[0]);
            near.flat_map(move |span| span.within(low[0], high[0]).map(move |(column, number)| (column, row, number)))
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        /// Truth: a map of all places.
        #[test]
        fn spans_find_what_a_map_of_places_finds(
            gaps in prop::collection::vec((0_i32..4, 0_i32..3, 1_i32..5), 0..30),
            low in [-8_i32..40, -8_i32..40],
            size in [0_i32..12, 0_i32..12],
        ) {
            let mut spans = SpanRows::default();
            let mut map = BTreeMap::new();
            let (mut row, mut column, mut number) = (-3, -5, 0_u32);
            for (rows, columns, count) in gaps {
                if rows > 0 {
                    (row, column) = (row + rows, -5);
                }
                column += columns;
                spans.push(row, Span { first: column, end: column + count, number });
                for k in 0..count {
                    map.insert((row, column + k), number as usize + k as usize);
                }
                (column, number) = (column + count, number + count as u32);
            }
            for j in -6..50 {
                for i in -8..80 {
                    prop_assert_eq!(spans.number(i, j), map.get(&(j, i)).copied());
                }
            }
            let high = [low[0] + size[0], low[1] + size[1]];
            let found: Vec<_> = spans.within(low, high).collect();
            let inside = |&(&(j, i), _): &(&(i32, i32), &usize)| {
                (low[0]..=high[0]).contains(&i) && (low[1]..=high[1]).contains(&j)
            };
            let expected: Vec<_> = map.iter().filter(inside).map(|(&(j, i), &n)| (i, j, n)).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
