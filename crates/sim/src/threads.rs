//! Work shared out between threads: `rayon` with the feature `threads`, the one thread there is without it.
//!
//! Nothing that is shared out adds numbers up, and what comes back is in order, so the results are the same either way.

#[cfg(not(feature = "threads"))]
pub(crate) use alone::{current_num_threads, is_at_hand, join, prelude};
#[cfg(feature = "threads")]
pub(crate) use rayon::{current_num_threads, join, prelude};

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
