//! Workers that turn frames into meshes while somebody else makes the frames.
//!
//! The channel between them is bounded: a solver that is faster than its workers waits, so memory does not grow with
//! the length of a sequence.

use crate::exit::Exit;
use crate::failure::Failure;
use crate::threads;
use fissure_scene::Frame;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Mutex, PoisonError};

/// One thing to do.
#[derive(Debug)]
pub(crate) enum Work {
    /// A frame that has just been computed.
    New(Box<Frame>),
    /// A frame that lies in the take, by its number.
    InTake(i64),
}

/// Where work comes from.
#[derive(Debug)]
struct Queue {
    receiver: Mutex<Receiver<Frame>>,
    /// Done when there is nothing new.
    backlog: Mutex<VecDeque<i64>>,
}

impl Queue {
    /// The next thing to do; waits for it. None when all is done.
    fn next(&self) -> Option<Work> {
        // The lock is held while waiting, so one worker waits for a frame and the others for the lock.
        let receiver = self.receiver.lock().unwrap_or_else(PoisonError::into_inner);
        let backlog = || self.backlog.lock().unwrap_or_else(PoisonError::into_inner).pop_front().map(Work::InTake);
        match receiver.try_recv() {
            Ok(frame) => Some(Work::New(Box::new(frame))),
            Err(TryRecvError::Disconnected) => backlog(),
            Err(TryRecvError::Empty) => {
                backlog().or_else(|| receiver.recv().ok().map(|frame| Work::New(Box::new(frame))))
            }
        }
    }
}

/// Runs `produce` on this thread; each frame it sends and each frame of `backlog` goes to `work` on one of `workers`
/// threads. Waits for all of them.
///
/// `work` reports its own outcome; frames may finish in any order. Sending waits while the workers are behind. Where
/// the system has no room for so many threads, fewer do the work.
///
/// # Errors
/// When not one thread can be started; `produce` has not begun then.
pub(crate) fn stream<R>(
    workers: usize,
    backlog: impl IntoIterator<Item = i64>,
    work: &(dyn Fn(Work) + Sync),
    produce: impl FnOnce(&dyn Fn(Frame)) -> R,
) -> Result<R, Failure> {
    let workers = workers.max(1);
    let (sender, receiver) = sync_channel::<Frame>(workers);
    let queue = Queue { receiver: Mutex::new(receiver), backlog: Mutex::new(backlog.into_iter().collect()) };
    std::thread::scope(|scope| {
        let worker = || {
            while let Some(item) = queue.next() {
                work(item);
            }
        };
        let start = |name: usize| std::thread::Builder::new().name(format!("mesh {name}")).spawn_scoped(scope, worker);
        for name in 0..workers {
            match start(name) {
                Ok(_) => {}
                Err(error) if name == 0 => return Err(threads::cannot_start(1, &error)),
                Err(_) => break,
            }
        }
        // The receiver outlives the sender, so sending cannot fail. The sender goes at the end: the workers then stop.
        let send = move |frame| drop(sender.send(frame));
        Ok(produce(&send))
    })
}

/// Runs `work`; a panic, which would be a mistake of the program, becomes a failure like any other, so that one frame
/// cannot lose the rest.
pub(crate) fn contain<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err(Failure::new(
            Exit::Numerical,
            "the program made a mistake (the message above says where)",
            "please report it with the scene file",
        ))
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering};

    #[test]
    fn every_frame_is_worked_on_once_and_few_wait() {
        let (sum, alive, most) = (AtomicI64::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
        let work = |work: Work| {
            std::thread::sleep(std::time::Duration::from_millis(1));
            match work {
                Work::New(frame) => {
                    sum.fetch_add(frame.number, Ordering::SeqCst);
                    alive.fetch_sub(1, Ordering::SeqCst);
                }
                Work::InTake(number) => {
                    sum.fetch_add(number, Ordering::SeqCst);
                }
            }
        };
        stream(2, 1001..=1010, &work, |send| {
            for number in 1..=100 {
                most.fetch_max(alive.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                send(Frame { number, ..Frame::default() });
            }
        })
        .unwrap();
        assert_eq!(sum.into_inner(), 5050 + 10_055);
        // Two at work, two in the channel, one at the door.
        assert!(most.into_inner() <= 5);
    }

    #[test]
    fn a_mistake_in_one_frame_is_a_failure_of_that_frame() {
        let failure = contain::<()>(|| unreachable!("on purpose"));
        assert_eq!(failure.map_err(|f| f.exit), Err(Exit::Numerical));
    }
}
