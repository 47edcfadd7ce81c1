//! Ctrl-C, and what else asks a process to end: a verb that is stopped says how to go on.

use std::io;
use std::sync::Arc;
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::out::Printer;

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
