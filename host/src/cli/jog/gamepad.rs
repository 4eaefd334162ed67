//! A gamepad as the Linux kernel shows it: a file of records of 8 bytes (`/dev/input/js0`; linux/Documentation/input/joydev).

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use super::super::Failure;
use softlimb_motion::jog::{Order, Way};
use softlimb_rig::run::Press;

/// Kinds of records. The first records, of the state of everything, have bit 0x80 besides.
const BUTTON: u8 = 1;
const AXIS: u8 = 2;
/// A stick moves the limb beyond half of its travel, and stops it below a third.
const ON: i16 = 16_384;
const OFF: i16 = 11_000;

/// Sticks: left one forward and back, left and right; right one up and down, which has one of two numbers. Kernels count down and right as positive.
const STICKS: [(u8, usize); 4] = [(1, 0), (0, 1), (3, 2), (4, 2)];

/// Records of a gamepad that is read beside the terminal.
pub(super) struct Gamepad {
    records: Receiver<[u8; 8]>,
    sticks: Sticks,
    is_lost: bool,
}

/// The stick that moves the limb.
#[derive(Debug, Default)]
struct Sticks {
    held: Option<(u8, Way)>,
}

impl Gamepad {
    /// Opens the file of a gamepad.
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        let mut file = File::open(path).map_err(|error| Failure::file("read", path, &error))?;
        let (sender, records) = channel();
        // It ends with the file, or when the receiver is gone.
        thread::spawn(move || {
            let mut record = [0; 8];
            while file.read_exact(&mut record).is_ok() && sender.send(record).is_ok() {}
        });
        Ok(Self { records, sticks: Sticks::default(), is_lost: false })
    }

    /// The presses since the last look. A gamepad that is lost stops the limb.
    pub(super) fn presses(&mut self) -> Vec<Press> {
        let mut presses = Vec::new();
        while !self.is_lost {
            match self.records.try_recv() {
                Ok(record) => presses.extend(self.sticks.press(record)),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    self.is_lost = true;
                    presses.extend(self.sticks.held.take().map(|_| Press::Order(Order::Stop)));
                }
            }
        }
        presses
    }
}

impl Sticks {
    fn press(&mut self, record: [u8; 8]) -> Option<Press> {
        let value = i16::from_le_bytes([record[4], record[5]]);
        match (record[6], record[7]) {
            (BUTTON, button) if value != 0 => act(button),
            (AXIS, number) => self.stick(number, value),
            // Other records, and the initial state, move nothing.
            _ => None,
        }
    }

    fn stick(&mut self, number: u8, value: i16) -> Option<Press> {
        let (_, axis) = *STICKS.iter().find(|(stick, _)| *stick == number)?;
        let way = Way { axis, with: value < 0 };
        match self.held {
            Some((held, was)) if held == number && (value.unsigned_abs() < OFF as u16 || was != way) => {
                self.held = None;
                Some(Press::Order(Order::Stop))
            }
            None if value.unsigned_abs() >= ON as u16 => {
                self.held = Some((number, way));
                Some(Press::Order(Order::Hold(way)))
            }
            _ => None,
        }
    }
}

fn act(button: u8) -> Option<Press> {
    let order = match button {
        0 => Order::Gripper,
        1 => return Some(Press::Vent),
        2 => Order::SelectNext,
        3 => Order::SelectTip,
        4 => Order::Slower,
        5 => Order::Faster,
        7 => return Some(Press::Resume),
        _ => return None,
    };
    Some(Press::Order(order))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn record(value: i16, kind: u8, number: u8) -> [u8; 8] {
        let [low, high] = value.to_le_bytes();
        [1, 2, 3, 4, low, high, kind, number]
    }

    #[test]
    fn stick_moves_until_it_is_let_go() {
        let mut sticks = Sticks::default();
        let hold = |axis, with| Some(Press::Order(Order::Hold(Way { axis, with })));
        let stop = Some(Press::Order(Order::Stop));
        assert_eq!(sticks.press(record(-30_000, AXIS | 0x80, 1)), None, "pushed before we came");
        assert_eq!(sticks.press(record(-10_000, AXIS, 1)), None);
        assert_eq!(sticks.press(record(i16::MIN, AXIS, 1)), hold(0, true), "forward");
        assert_eq!(sticks.press(record(20_000, AXIS, 4)), None, "one at a time");
        assert_eq!(sticks.press(record(-12_000, AXIS, 1)), None);
        assert_eq!(sticks.press(record(-5_000, AXIS, 1)), stop);
        assert_eq!(sticks.press(record(20_000, AXIS, 4)), hold(2, false), "down");
        assert_eq!(sticks.press(record(-20_000, AXIS, 4)), stop, "the other way passes the middle");
        assert_eq!(sticks.press(record(1, BUTTON, 1)), Some(Press::Vent));
        assert_eq!(sticks.press(record(0, BUTTON, 1)), None, "released");
    }

    #[test]
    fn gamepad_that_is_lost_lets_go() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(&record(30_000, AXIS, 0)).unwrap();
        let mut gamepad = Gamepad::open(file.path()).unwrap();
        let mut presses = Vec::new();
        while !gamepad.is_lost {
            presses.extend(gamepad.presses());
            thread::yield_now();
        }
        let right = Way { axis: 1, with: false };
        assert_eq!(presses, [Press::Order(Order::Hold(right)), Press::Order(Order::Stop)]);
    }
}
