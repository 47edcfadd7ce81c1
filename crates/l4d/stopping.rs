//! Ctrl-C, and what else asks a process to end: a verb that is stopped says how to go on.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::out::Printer;

/// Whether a verb that saves what it has was asked to end.
static ASKED: AtomicBool = AtomicBool::new(false);
/// By which signal.
static SIGNAL: AtomicI32 = AtomicI32::new(0);

/// Says so once the process is asked to end, which then ends as it would have.
pub(crate) fn say_when_stopped(how_to_go_on: &'static str, out: Arc<Printer>) -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::spawn(move || {
        for signal in signals.forever() {
            out.warn(format_args!("stopped; {how_to_go_on}"));
            emulate_default_handler(signal).ok();
        }
    });
    Ok(())
}

/// What a verb looks at that saves what it has before it ends.
pub(crate) fn asked() -> &'static AtomicBool {
    &ASKED
}

/// Notes that the process is asked to end, for a verb that looks at [`asked`]; a second signal ends it at once.
pub(crate) fn save_when_stopped(out: Arc<Printer>) -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    thread::spawn(move || {
        for signal in signals.forever() {
            SIGNAL.store(signal, Ordering::Relaxed);
            if ASKED.swap(true, Ordering::Relaxed) {
                emulate_default_handler(signal).ok();
            }
            out.warn("stopping: what was learned is saved first; once more to stop at once");
        }
    });
    Ok(())
}

/// Ends the process as the signal would have that asked for it, if one did.
pub(crate) fn end_as_asked() {
    if ASKED.load(Ordering::Relaxed) {
        emulate_default_handler(SIGNAL.load(Ordering::Relaxed)).ok();
    }
}
