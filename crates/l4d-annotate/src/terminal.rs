//! Taking the terminal and giving it back, whatever happens in between.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ratatui::crossterm::cursor::{Hide, Show};
use ratatui::crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use ratatui::crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use ratatui::crossterm::{execute, queue};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::error::AnnotateError;

/// Whether the terminal is ours now.
static TAKEN: AtomicBool = AtomicBool::new(false);
/// Whether the terminal keeps pictures until a command makes it forget them.
static KEEPS_PICTURES: AtomicBool = AtomicBool::new(false);
/// Longest wait for a terminal that may not answer.
const ANSWER_TIME: Duration = Duration::from_millis(500);
/// Makes kitty forget the pictures that it was given.
const FORGET_PICTURES: &[u8] = b"\x1b_Ga=d,d=A,q=2\x1b\\";

/// The terminal, taken: raw, on its second screen. Dropping it gives it back.
#[derive(Debug)]
pub struct TerminalGuard(());

impl TerminalGuard {
    /// Takes the terminal of the process. A panic in any thread gives it back before it is reported.
    ///
    /// # Errors
    /// Input or output is no terminal, or it cannot be set up.
    pub fn take() -> Result<Self, AnnotateError> {
        if !io::stdin().is_terminal() {
            return Err(AnnotateError::NoTerminal("standard input"));
        }
        if !io::stdout().is_terminal() {
            return Err(AnnotateError::NoTerminal("standard output"));
        }
        give_back_on_panic();
        enable_raw_mode().map_err(AnnotateError::Terminal)?;
        TAKEN.store(true, Ordering::SeqCst);
        let taken = Self(());
        enter(&mut io::stdout()).map_err(AnnotateError::Terminal)?;
        Ok(taken)
    }

    /// Notes that pictures are left with the terminal, as kitty's protocol does.
    pub fn keeps_pictures(&self) {
        KEEPS_PICTURES.store(true, Ordering::SeqCst);
    }

    /// Whether the terminal answers questions: one that does not must not be asked any others, since waiting
    /// for the answer would swallow the person's keys.
    pub fn answers(&self, in_tmux: bool) -> bool {
        const ANSWER: &[u8] = b"\x1b[0n";
        let question = if in_tmux { "\x1bPtmux;\x1b\x1b[5n\x1b\\" } else { "\x1b[5n" };
        let mut stdout = io::stdout();
        if stdout.write_all(question.as_bytes()).and_then(|()| stdout.flush()).is_err() {
            return false;
        }
        let deadline = Instant::now() + ANSWER_TIME;
        let mut heard = Vec::new();
        while let Some(byte) = next_byte(deadline) {
            heard.push(byte);
            if heard.ends_with(ANSWER) {
                return true;
            }
        }
        false
    }
}

impl Drop for TerminalGuard {
    fn drop(&mut self) {
        give_back();
    }
}

fn next_byte(deadline: Instant) -> Option<u8> {
    let stdin = io::stdin();
    let left = deadline.checked_duration_since(Instant::now())?;
    let timeout = Timespec::try_from(left).ok()?;
    let mut waiting = [PollFd::new(&stdin, PollFlags::IN)];
    let ready = poll(&mut waiting, Some(&timeout)).ok()?;
    let mut byte = [0];
    // Past the buffer of the standard library, which would keep what comes after the answer.
    (ready > 0 && rustix::io::read(&stdin, &mut byte).ok()? == 1).then_some(byte[0])
}

fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        // No one is left to report to if this fails.
        leave(&mut io::stdout()).ok();
        disable_raw_mode().ok();
    }
}

fn give_back_on_panic() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            give_back();
            report(panic);
        }));
    });
}

fn enter(out: &mut impl io::Write) -> io::Result<()> {
    execute!(out, EnterAlternateScreen, EnableBracketedPaste, Hide)
}

fn leave(out: &mut impl io::Write) -> io::Result<()> {
    queue!(out, DisableBracketedPaste)?;
    if KEEPS_PICTURES.load(Ordering::SeqCst) {
        out.write_all(FORGET_PICTURES)?;
    }
    execute!(out, LeaveAlternateScreen, Show)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_switched_on_is_switched_off_again() {
        let (mut on, mut off) = (Vec::new(), Vec::new());
        enter(&mut on).unwrap();
        leave(&mut off).unwrap();
        let [on, off] = [on, off].map(|bytes| String::from_utf8(bytes).unwrap());
        // The cursor is hidden on entering; the second screen and bracketed paste are switched on.
        for (mode, entering, leaving) in [(25, 'l', 'h'), (1049, 'h', 'l'), (2004, 'h', 'l')] {
            assert!(on.contains(&format!("\x1b[?{mode}{entering}")), "{mode}");
            assert!(off.contains(&format!("\x1b[?{mode}{leaving}")), "{mode}");
        }
        assert_eq!((on.matches("\x1b[?").count(), off.matches("\x1b[?").count()), (3, 3));
    }
}
