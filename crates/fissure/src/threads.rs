//! How many threads compute.

use crate::exit::Exit;
use crate::failure::Failure;
use std::num::NonZero;

/// Sets the number of threads for the whole program, and returns it; without a wish: one per core.
pub(crate) fn set(wish: Option<u16>) -> Result<usize, Failure> {
    let threads = wish.map_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get), usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(|error| {
        Failure::new(Exit::Usage, format!("cannot start {threads} threads: {error}"), "ask for fewer with --threads")
    })?;
    Ok(threads)
}

/// Workers that make meshes beside a solver that has `threads`: a few, because each holds a frame.
pub(crate) fn mesh_workers(threads: usize) -> usize {
    (threads / 2).clamp(1, 8)
}
