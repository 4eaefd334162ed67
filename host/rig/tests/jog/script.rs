//! An operator who follows a script and presses keys by what the log shows.

use softlimb_motion::jog::{Order, Way};
use softlimb_rig::run::{JogView, Operator, Press};

/// Time that the limb is given to follow a step before the next key, s.
const SETTLED_S: f64 = 0.4;
/// Longest session, s.
const LONGEST_S: f64 = 200.0;

pub(crate) struct Script {
    holds: bool,
    /// Time of the last key, s, and the key that is down.
    pressed_s: f64,
    down: Option<Way>,
    /// Axis by its rank that is tried next: the one that misses most first.
    rank: usize,
    /// Times from keys to their setpoints on the wire, us.
    pub(crate) waited_us: Vec<u64>,
}

impl Script {
    /// Moves the tip to each target along the axis that misses most, or the next where that one is refused; and does there what the
    /// gripper shall do.
    pub(crate) fn towards_targets(holds: bool) -> Self {
        Self { holds, pressed_s: 0.0, down: None, rank: 0, waited_us: Vec::new() }
    }

    fn released(&mut self, time_s: f64) -> Vec<Press> {
        self.pressed_s = time_s;
        if self.down.take().is_some() { vec![Press::Order(Order::Stop)] } else { Vec::new() }
    }
}

impl Operator for Script {
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press> {
        let Some(sample) = view.sample else { return Vec::new() };
        let (time_s, targets) = (sample.time_s, view.jog.targets());
        assert!(
            time_s < LONGEST_S,
            "{:?}, missing {:?}, refused: {:?}",
            targets.attempts(),
            targets.missing_m(),
            view.jog.refusal()
        );
        let Some(target) = targets.next() else { return vec![Press::End] };
        if let Some(way) = self.down {
            // A key is let go where its axis is near enough, or where it is refused.
            let left_m =
                targets.missing_m().map_or(0.0, |missing| missing[way.axis]) * if way.with { 1.0 } else { -1.0 };
            let refused = view.jog.refusal().is_some();
            self.rank = if refused { self.rank + 1 } else { self.rank };
            return if left_m < 4e-3 || refused { self.released(time_s) } else { Vec::new() };
        }
        if view.jog.refusal().is_some() && time_s == self.pressed_s {
            self.rank += 1;
        } else if view.jog.is_moving() || time_s < self.pressed_s + SETTLED_S {
            return Vec::new();
        } else if view.jog.refusal().is_none() {
            self.rank = 0;
        }
        self.pressed_s = time_s;
        if targets.is_there() {
            return target.gripper.map(|_| Press::Order(Order::Gripper)).into_iter().collect();
        }
        let missing = targets.missing_m().expect("a target");
        let mut axes = [0, 1, 2];
        axes.sort_by(|a, b| missing[*b].abs().total_cmp(&missing[*a].abs()));
        let axis = axes[self.rank % 3];
        let way = Way { axis, with: missing[axis] > 0.0 };
        if missing[axis].abs() < 1e-3 {
            self.rank += 1;
            return Vec::new();
        }
        self.down = self.holds.then_some(way);
        vec![Press::Order(if self.holds { Order::Hold(way) } else { Order::Go(way) })]
    }

    fn sent(&mut self, waited_us: u64) {
        self.waited_us.push(waited_us);
    }
}

/// Keys at times of the log, s.
pub(crate) struct Timed<'k> {
    keys: &'k [(f64, Press)],
}

impl<'k> Timed<'k> {
    pub(crate) fn new(keys: &'k [(f64, Press)]) -> Self {
        Self { keys }
    }
}

impl Operator for Timed<'_> {
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press> {
        let time_s = view.sample.map_or(0.0, |sample| sample.time_s);
        let due = self.keys.iter().take_while(|(at_s, _)| *at_s <= time_s).count();
        let (now, later) = self.keys.split_at(due);
        self.keys = later;
        now.iter().map(|(_, press)| press.clone()).collect()
    }
}
