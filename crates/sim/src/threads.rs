//! Work shared out between threads: `rayon` with the feature `threads`, the one thread there is without it.
//!
//! What is shared out adds numbers up only by blocks that are the same for any number of threads, and what comes back
//! is in order, so the results are the same either way.

#[cfg(not(feature = "threads"))]
pub(crate) use alone::{current_num_threads, is_at_hand, join, prelude};
#[cfg(feature = "threads")]
pub(crate) use rayon::{current_num_threads, join, prelude};

use prelude::*;
use std::ops::Range;

/// Numbers of each list that a thread goes through at once: few enough to stay in the cache of its core, many enough to
/// be worth handing out.
const PART: usize = 4096;

/// From so many numbers on, work is handed to threads that have to be woken.
const WORTH_WAKING: usize = 20_000;

/// The most of `count` numbers that go to one thread.
pub(crate) fn part(count: usize) -> usize {
    let is_worth_it = current_num_threads() > 1 && (is_at_hand() || count >= WORTH_WAKING);
    if is_worth_it { PART } else { usize::MAX }
}

/// Shares out `lists` of one length in parts of at most `part` numbers: `work` is given the place of the first number
/// of a part, and the part of each list.
pub(crate) fn share_out<T: Send, const N: usize>(
    lists: [&mut [T]; N],
    part: usize,
    work: &(impl Fn(usize, [&mut [T]; N]) + Sync),
) {
    share_out_from(0, lists, part, work);
}

fn share_out_from<T: Send, const N: usize>(
    start: usize,
    mut lists: [&mut [T]; N],
    part: usize,
    work: &(impl Fn(usize, [&mut [T]; N]) + Sync),
) {
    let count = lists.first().map_or(0, |list| list.len());
    if count <= part {
        return work(start, lists);
    }
    let middle = count / 2;
    let upper = lists.each_mut().map(|list| {
        let (lower, upper) = std::mem::take(list).split_at_mut(middle);
        *list = lower;
        upper
    });
    join(|| share_out_from(start, lists, part, work), || share_out_from(start + middle, upper, part, work));
}

/// Numbers that are summed up, or otherwise become one, before they meet others.
const BLOCK: usize = 4096;

/// What `work` makes of each block of `numbers`, in order, the place of its first one given. Blocks are the same for
/// any number of threads, so that sums of what comes of them are as well.
pub(crate) fn of_blocks<T: Send, R: Send>(
    numbers: &mut [T],
    work: impl Fn(usize, &mut [T]) -> R + Sync + Send,
) -> Vec<R> {
    let is_shared = part(numbers.len()) < numbers.len();
    let blocks = numbers.chunks_mut(BLOCK).enumerate();
    let work = |(k, block): (usize, &mut [T])| work(k * BLOCK, block);
    if is_shared {
        let blocks: Vec<_> = blocks.collect();
        blocks.into_par_iter().map(work).collect()
    } else {
        blocks.map(work).collect()
    }
}

/// The same for the numbers below `count` themselves.
pub(crate) fn ranges<R: Send>(count: usize, work: impl Fn(Range<usize>) -> R + Sync + Send) -> Vec<R> {
    let starts: Vec<usize> = (0..count).step_by(BLOCK).collect();
    let work = |start: usize| work(start..(start + BLOCK).min(count));
    if part(count) < count {
        starts.into_par_iter().map(work).collect()
    } else {
        starts.into_iter().map(work).collect()
    }
}

/// What `work` makes of each of some items, in order, where each takes as long as some ten thousand numbers: from a few
/// on it is handed to threads that have to be woken.
pub(crate) fn of_each<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    let fewest = if is_at_hand() { 2 } else { 4 };
    if current_num_threads() > 1 && items.len() >= fewest {
        items.par_iter().map(work).collect()
    } else {
        items.iter().map(work).collect()
    }
}

/// The sum of the products of two lists of one length.
#[inline(always)]
pub(crate) fn dot(one: &[f64], other: &[f64]) -> f64 {
    // Some sums beside each other, which need not wait for each other.
    const BESIDE: usize = 8;
    let mut sums = [0.0; BESIDE];
    let (mut ones, mut others) = (one.chunks_exact(BESIDE), other.chunks_exact(BESIDE));
    for (a, b) in ones.by_ref().zip(others.by_ref()) {
        for k in 0..BESIDE {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = ones.remainder().iter().zip(others.remainder()).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Whether this thread is one of those that share the work, so that handing some of it out costs little.
#[cfg(feature = "threads")]
fn is_at_hand() -> bool {
    rayon::current_thread_index().is_some()
}

/// The part of `rayon` that the solver uses, for one thread.
#[cfg(not(feature = "threads"))]
mod alone {
    /// Threads that share the work.
    pub(crate) fn current_num_threads() -> usize {
        1
    }

    /// Whether handing work out costs little.
    pub(crate) fn is_at_hand() -> bool {
        true
    }

    /// Does both.
    pub(crate) fn join<A, B>(one: impl FnOnce() -> A, other: impl FnOnce() -> B) -> (A, B) {
        (one(), other())
    }

    /// As `rayon::prelude`.
    pub(crate) mod prelude {
        /// What owns or counts its items.
        pub(crate) trait IntoParallelIterator: IntoIterator + Sized {
            fn into_par_iter(self) -> Self::IntoIter {
                self.into_iter()
            }
        }

        impl<I: IntoIterator> IntoParallelIterator for I {}

        /// What lends its items.
        pub(crate) trait ParallelSlice<T> {
            fn par_iter(&self) -> std::slice::Iter<'_, T>;
            fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T>;
        }

        impl<T> ParallelSlice<T> for [T] {
            fn par_iter(&self) -> std::slice::Iter<'_, T> {
                self.iter()
            }

            fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
                self.iter_mut()
            }
        }

        /// What a parallel iterator has and an iterator has not.
        pub(crate) trait ParallelIterator: Iterator + Sized {
            /// The fewest items for which a thread is worth its while.
            fn with_min_len(self, _least: usize) -> Self {
                self
            }

            /// `value` of each item, with a workspace that `workspace` makes for each thread.
            fn map_init<W, R>(
                self,
                workspace: impl FnOnce() -> W,
                value: impl Fn(&mut W, Self::Item) -> R,
            ) -> impl Iterator<Item = R> {
                let mut workspace = workspace();
                self.map(move |item| value(&mut workspace, item))
            }
        }

        impl<I: Iterator> ParallelIterator for I {}
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: whole numbers, whose sums are exact; and the sums of one thread, to the last bit, where they are not.
    #[test]
    fn sums_of_blocks_are_those_of_any_number_of_threads() {
        for count in [0, 1, 7, 8, 4095, 4096, 4097, 50_001] {
            let with = |threads: usize, number: fn(usize) -> f64| -> [f64; 2] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let mut numbers: Vec<f64> = (0..count).map(number).collect();
                let ones = vec![1.0; count];
                pool.install(|| {
                    let sums = of_blocks(&mut numbers, |start, block| dot(block, &ones[start..start + block.len()]));
                    let products = ranges(count, |range| range.map(|k| number(k) * number(k)).sum::<f64>());
                    [sums.iter().sum(), products.iter().sum()]
                })
            };
            let n = count as f64;
            let exact = [n * (n - 1.0) / 2.0, (n - 1.0) * n * (2.0 * n - 1.0) / 6.0];
            assert_eq!(with(1, |k| k as f64), exact, "{count}");
            let alone = with(1, |k| (k as f64).sin());
            for threads in [2, 3] {
                assert_eq!(with(threads, |k| (k as f64).sin()).map(f64::to_bits), alone.map(f64::to_bits), "{count}");
            }
        }
    }

    /// Truth: the items one by one, in their order, by any number of threads.
    #[test]
    fn what_is_made_of_each_comes_in_order() {
        let items: Vec<u64> = (0..57).collect();
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for count in [0, 1, 2, 3, 4, items.len()] {
                let squares = pool.install(|| of_each(&items[..count], |x| x * x));
                assert_eq!(squares, items[..count].iter().map(|x| x * x).collect::<Vec<_>>());
            }
        }
    }
}
