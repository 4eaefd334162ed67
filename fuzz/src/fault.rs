//! Faults of a serial line on one frame.

use crate::draw::Draw;

/// Kinds of faults.
const KINDS: usize = 12;

/// The bytes of a frame, which is not empty, with a fault. The result always differs from the frame.
pub(crate) fn hurt(whole: &[u8], draw: &mut Draw<'_>) -> Vec<u8> {
    loop {
        let mut wire = whole.to_vec();
        corrupt(&mut wire, draw);
        if wire != whole {
            return wire;
        }
    }
}

fn corrupt(wire: &mut Vec<u8>, draw: &mut Draw<'_>) {
    let place = draw.below(wire.len());
    match draw.below(KINDS) {
        0 => flip(wire, 1 + draw.below(4), draw),
        1 => flip(wire, 8 + draw.below(25), draw),
        2 => overwrite(wire, place, 2 + draw.below(7), draw),
        3 => drop(wire.remove(place)),
        4 => wire.insert(place, draw.number() as u8),
        5 => wire.insert(place, 0),
        6 => drop(wire.pop()),
        7 => wire.truncate(place),
        8 => {
            let other = draw.below(wire.len());
            wire.swap(place, other);
        }
        9 => garbage(wire, place, draw),
        10 => {
            let (end, at) = (place + draw.below(wire.len() - place), draw.below(wire.len()));
            let piece = wire[place..=end].to_vec();
            wire.splice(at..at, piece);
        }
        // A line that is stuck for a while.
        _ => {
            let (end, level) = (wire.len().min(place + 1 + draw.below(16)), [0x00, 0xFF][draw.below(2)]);
            wire[place..end].fill(level);
        }
    }
}

fn flip(wire: &mut [u8], count: usize, draw: &mut Draw<'_>) {
    for _ in 0..count {
        wire[draw.below(wire.len())] ^= 1 << draw.below(8);
    }
}

fn overwrite(wire: &mut [u8], place: usize, count: usize, draw: &mut Draw<'_>) {
    wire.iter_mut().skip(place).take(count).for_each(|byte| *byte = draw.number() as u8);
}

/// Up to 64 bytes of another baud or another sender.
fn garbage(wire: &mut Vec<u8>, place: usize, draw: &mut Draw<'_>) {
    let noise: Vec<u8> = (0..=draw.below(64)).map(|_| draw.number() as u8).collect();
    wire.splice(place..place, noise);
}
