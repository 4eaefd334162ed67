//! The terminal of `softlimb jog`: reads keys, draws the screen, and restores the terminal at the end.

use std::io::{Stdout, Write, stdout};
use std::time::{Duration, Instant};

use crossterm::cursor::{Hide, MoveTo, Show};
use crossterm::event::{
    DisableFocusChange, EnableFocusChange, Event, KeyboardEnhancementFlags, PopKeyboardEnhancementFlags,
    PushKeyboardEnhancementFlags, poll, read,
};
use crossterm::style::Print;
use crossterm::terminal::{
    Clear, ClearType, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode, size,
    supports_keyboard_enhancement,
};
use crossterm::{execute, queue};

use super::super::Failure;
use super::keys::Keys;
use softlimb_rig::run::Press;

/// Time between two drawings without a key.
const DRAWN: Duration = Duration::from_millis(100);

pub(super) struct Terminal {
    out: Stdout,
    keys: Keys,
    drawn: Option<Instant>,
    has_flags: bool,
}

impl Terminal {
    /// Takes the terminal, and asks it once whether it reports the release of keys.
    pub(super) fn open() -> Result<Self, Failure> {
        let failed = |error| Failure::new(format!("the terminal cannot be used: {error}"));
        enable_raw_mode().map_err(failed)?;
        let has_flags = supports_keyboard_enhancement().unwrap_or(false);
        let mut terminal = Self { out: stdout(), keys: Keys::new(has_flags), drawn: None, has_flags };
        execute!(terminal.out, EnterAlternateScreen, EnableFocusChange, Hide, Clear(ClearType::All)).map_err(failed)?;
        if has_flags {
            // Letters tell their release only where all keys are escape codes.
            let flags = KeyboardEnhancementFlags::DISAMBIGUATE_ESCAPE_CODES
                | KeyboardEnhancementFlags::REPORT_EVENT_TYPES
                | KeyboardEnhancementFlags::REPORT_ALL_KEYS_AS_ESCAPE_CODES;
            execute!(terminal.out, PushKeyboardEnhancementFlags(flags)).map_err(failed)?;
        }
        Ok(terminal)
    }

    pub(super) fn tells_releases(&self) -> bool {
        self.keys.tells_releases
    }

    /// The keys since the last look. A terminal that is gone ends the session.
    pub(super) fn presses(&mut self) -> Vec<Press> {
        let mut presses = Vec::new();
        loop {
            match poll(Duration::ZERO).and_then(|is_there| if is_there { read().map(Some) } else { Ok(None) }) {
                Ok(None) => return presses,
                Ok(Some(Event::Key(key))) => presses.extend(self.keys.press(key)),
                Ok(Some(Event::FocusLost)) => presses.extend(self.keys.lost()),
                Ok(Some(Event::Resize(..))) => self.drawn = None,
                Ok(Some(_)) => {}
                Err(_) => return vec![Press::End],
            }
        }
    }

    /// Draws lines where it is time.
    pub(super) fn draw(&mut self, lines: impl FnOnce() -> Vec<String>) {
        let is_new = self.drawn.is_none();
        if self.drawn.is_some_and(|drawn| drawn.elapsed() < DRAWN) {
            return;
        }
        self.drawn = Some(Instant::now());
        let (columns, rows) = size().unwrap_or((80, 24));
        let clear = if is_new { queue!(self.out, Clear(ClearType::All)) } else { Ok(()) };
        let lines = lines();
        let drawn = clear.and_then(|()| {
            for (row, line) in (0..rows).zip(&lines) {
                let line: String = line.chars().take(usize::from(columns)).collect();
                queue!(self.out, MoveTo(0, row), Print(line), Clear(ClearType::UntilNewLine))?;
            }
            queue!(self.out, Clear(ClearType::FromCursorDown))?;
            self.out.flush()
        });
        // Where drawing fails, the next reading of keys ends the session.
        drop(drawn);
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Each by itself: whatever fails, the rest shall be as it was.
        if self.has_flags {
            let _ = execute!(self.out, PopKeyboardEnhancementFlags);
        }
        let _ = execute!(self.out, DisableFocusChange, Show, LeaveAlternateScreen);
        let _ = disable_raw_mode();
    }
}
