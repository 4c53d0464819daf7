//! How many threads compute.

use crate::exit::Exit;
use crate::failure::Failure;
use std::fmt::Display;
use std::num::NonZero;

/// Address space that a thread takes for its stack, and a little more [bytes].
const OF_THREAD: usize = 0x21_0000;

/// Sets the number of threads for the whole program, and returns it; without a wish: one per core.
pub(crate) fn set(wish: Option<u16>) -> Result<usize, Failure> {
    let threads = wish.map_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get), usize::from);
    // A thread that gets its stack, and then nothing for what it begins with, ends the program without a word.
    let mut room = Vec::<u8>::new();
    room.try_reserve_exact(threads.saturating_mul(OF_THREAD)).map_err(|error| cannot_start(threads, &error))?;
    drop(std::hint::black_box(room));
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        // The solver runs on this thread: it would have to wake another one for each share of a step.
        .use_current_thread()
        .build_global()
        .map_err(|error| cannot_start(threads, &error))?;
    Ok(threads)
}

/// Threads that the system has no room for.
pub(crate) fn cannot_start(threads: usize, error: &dyn Display) -> Failure {
    Failure::new(
        Exit::Usage,
        format!("cannot start {threads} threads: {error}"),
        "ask for fewer with --threads, or allow the program more memory (`ulimit -v`) or threads (`ulimit -u`)",
    )
}

/// Whether the system gives one thread more. Libraries that start theirs by themselves do not ask.
pub(crate) fn are_to_be_had() -> bool {
    std::thread::Builder::new().spawn(|| ()).is_ok_and(|thread| thread.join().is_ok())
}

/// Workers that make meshes beside a solver that has `threads`: a few, because each holds a frame.
pub(crate) fn mesh_workers(threads: usize) -> usize {
    (threads / 2).clamp(1, 8)
}
