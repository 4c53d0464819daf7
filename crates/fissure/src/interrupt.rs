//! Ctrl-C: before the first frame and the second time it ends the program at once; otherwise the first asks to finish
//! cleanly.

use crate::args::TalkArguments;
use crate::exit::Exit;
use crate::report::Report;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Nothing has to be finished: a signal ends the program at once.
const IDLE: u8 = 0;
/// Something is being finished: a signal asks to stop.
const BUSY: u8 = 1;
/// The user asked to stop.
const ASKED: u8 = 2;

/// Whether the user asked to stop.
#[derive(Debug, Clone)]
pub(crate) struct Interrupt(Arc<AtomicU8>);

impl Interrupt {
    /// Listens to Ctrl-C (and to a request to terminate, which farms send).
    ///
    /// Where the handler cannot be installed the signals keep their usual effect: the program ends at once, and the
    /// take stays readable all the same, as after any other death.
    pub(crate) fn listen(talk: TalkArguments) -> Self {
        let interrupt = Self(Arc::new(AtomicU8::new(IDLE)));
        let state = interrupt.0.clone();
        let handler = move || {
            match state.compare_exchange(BUSY, ASKED, Ordering::SeqCst, Ordering::SeqCst) {
                Ok(_) => return,
                Err(IDLE) => Report::new(talk)
                    .warn("interrupted before there was anything to finish; run the same command again"),
                Err(_) => {}
            }
            std::process::exit(Exit::Interrupted as i32);
        };
        // What cannot be told apart from no handler needs no word of its own.
        let _ = ctrlc::set_handler(handler);
        interrupt
    }

    /// From now on a signal asks to stop, and the program looks whether it did.
    pub(crate) fn finish_cleanly(&self) {
        let _ = self.0.compare_exchange(IDLE, BUSY, Ordering::SeqCst, Ordering::SeqCst);
    }

    /// Whether to stop.
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::SeqCst) == ASKED
    }
}
