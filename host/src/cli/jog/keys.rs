//! Keys of the terminal as orders.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use softlimb_motion::jog::{Order, Way};
use softlimb_rig::run::Press;

/// The help line of the screen.
pub(super) const HELP: [&str; 3] = [
    "w/s x+/x-   a/d y+/y-   r/f z+/z-   arrows as w a s d   1..9 module   0 tip   Tab next",
    "[ ] step    - + speed   g gripper   space or v vent     Enter on again   q end",
    "A module: w, a or r raises its pressure, s, d or f lowers it.",
];

/// Reads keys, and knows which one is held.
#[derive(Debug)]
pub(super) struct Keys {
    /// Whether the terminal tells releases: a direction then goes on while its key is down. Else each press is a step.
    pub(super) tells_releases: bool,
    held: Option<KeyCode>,
}

impl Keys {
    pub(super) fn new(tells_releases: bool) -> Self {
        Self { tells_releases, held: None }
    }

    /// The press of an event; `None` of a key that does nothing.
    pub(super) fn press(&mut self, event: KeyEvent) -> Option<Press> {
        let code = lower(event.code);
        match event.kind {
            KeyEventKind::Release => {
                self.held.take_if(|held| *held == code)?;
                return Some(Press::Order(Order::Stop));
            }
            KeyEventKind::Repeat if self.tells_releases => return None,
            _ => {}
        }
        if event.modifiers.contains(KeyModifiers::CONTROL) {
            return (code == KeyCode::Char('c')).then_some(Press::End);
        }
        if let Some(way) = way(code) {
            if !self.tells_releases {
                return Some(Press::Order(Order::Go(way)));
            }
            self.held = Some(code);
            return Some(Press::Order(Order::Hold(way)));
        }
        act(code)
    }

    /// The terminal lost the focus, or its size changed: no release will come.
    pub(super) fn lost(&mut self) -> Option<Press> {
        self.held.take().map(|_| Press::Order(Order::Stop))
    }
}

fn lower(code: KeyCode) -> KeyCode {
    match code {
        KeyCode::Char(letter) => KeyCode::Char(letter.to_ascii_lowercase()),
        other => other,
    }
}

fn way(code: KeyCode) -> Option<Way> {
    let (axis, with) = match code {
        KeyCode::Char('w') | KeyCode::Up => (0, true),
        KeyCode::Char('s') | KeyCode::Down => (0, false),
        KeyCode::Char('a') | KeyCode::Left => (1, true),
        KeyCode::Char('d') | KeyCode::Right => (1, false),
        KeyCode::Char('r') => (2, true),
        KeyCode::Char('f') => (2, false),
        _ => return None,
    };
    Some(Way { axis, with })
}

fn act(code: KeyCode) -> Option<Press> {
    let order = match code {
        KeyCode::Char('q') => return Some(Press::End),
        KeyCode::Char(' ' | 'v') => return Some(Press::Vent),
        KeyCode::Enter => return Some(Press::Resume),
        KeyCode::Char('g') => Order::Gripper,
        KeyCode::Char('0') => Order::SelectTip,
        KeyCode::Char(digit @ '1'..='9') => Order::SelectDrive(digit as usize - '1' as usize),
        KeyCode::Tab => Order::SelectNext,
        KeyCode::Char(']') => Order::Longer,
        KeyCode::Char('[') => Order::Shorter,
        KeyCode::Char('+' | '=') => Order::Faster,
        KeyCode::Char('-') => Order::Slower,
        _ => return None,
    };
    Some(Press::Order(order))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(letter: char, kind: KeyEventKind) -> KeyEvent {
        KeyEvent::new_with_kind(KeyCode::Char(letter), KeyModifiers::NONE, kind)
    }

    #[test]
    fn key_is_a_step_where_no_release_is_told() {
        let mut keys = Keys::new(false);
        let step = Some(Press::Order(Order::Go(Way { axis: 2, with: false })));
        assert_eq!(keys.press(event('f', KeyEventKind::Press)), step);
        assert_eq!(keys.press(event('F', KeyEventKind::Press)), step, "with the shift key");
        assert_eq!(keys.press(event('x', KeyEventKind::Press)), None);
        assert_eq!(keys.press(event(' ', KeyEventKind::Press)), Some(Press::Vent));
        let control = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        assert_eq!(keys.press(control), Some(Press::End));
    }

    #[test]
    fn key_goes_on_until_its_release() {
        let mut keys = Keys::new(true);
        let hold = |axis, with| Some(Press::Order(Order::Hold(Way { axis, with })));
        let stop = Some(Press::Order(Order::Stop));
        assert_eq!(keys.press(event('w', KeyEventKind::Press)), hold(0, true));
        assert_eq!(keys.press(event('w', KeyEventKind::Repeat)), None);
        // A second key takes over; the release of the first is ignored.
        assert_eq!(keys.press(event('a', KeyEventKind::Press)), hold(1, true));
        assert_eq!(keys.press(event('w', KeyEventKind::Release)), None);
        assert_eq!(keys.press(event('a', KeyEventKind::Release)), stop);
        keys.press(event('r', KeyEventKind::Press));
        assert_eq!((keys.lost(), keys.lost()), (stop, None));
    }
}
