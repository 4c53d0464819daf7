//! Work shared out between threads: `rayon` with the feature `threads`, the one thread there is without it.
//!
//! Nothing that is shared out adds numbers up, and what comes back is in order, so the results are the same either way.

#[cfg(not(feature = "threads"))]
pub(crate) use alone::{current_num_threads, join, prelude};
#[cfg(feature = "threads")]
pub(crate) use rayon::{current_num_threads, join, prelude};

/// The part of `rayon` that the solver uses, for one thread.
#[cfg(not(feature = "threads"))]
mod alone {
    /// Threads that share the work.
    pub(crate) fn current_num_threads() -> usize {
        1
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
