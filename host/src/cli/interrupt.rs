//! Ctrl-C as a flag that a command reads.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::{Failure, waiting};

/// Exit code of a program that Ctrl-C has ended.
pub(super) const INTERRUPTED: i32 = 130;

/// Becomes true with the first Ctrl-C or end signal; the second ends the program at once.
pub(super) fn interrupt() -> Result<Arc<AtomicBool>, Failure> {
    waiting::handles_interrupt();
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the shutdown looks at the flag before the same signal makes it true.
        flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&interrupted))
            .and_then(|_| flag::register(signal, Arc::clone(&interrupted)))
            .map_err(|error| Failure::new(format!("Ctrl-C cannot be caught: {error}")))?;
    }
    Ok(interrupted)
}
