//! The operator at a page: its orders as keys, and what it sees.

use std::time::{Duration, Instant};

use super::view::View;
use softlimb_console::{Console, Jog, Order};
use softlimb_limb::Limb;
use softlimb_motion::jog;
use softlimb_motion::jog::{Settings, Way};
use softlimb_rig::run::{JogView, Operator, Press};
use softlimb_scene::Scene;

/// Time between two views.
const SHOWN: Duration = Duration::from_millis(50);

pub(super) struct Hand<'a> {
    page: &'a Console,
    scene: &'a Scene,
    drives: usize,
    shown: Option<Instant>,
    /// Arrival of the first order whose setpoint has not been sent.
    came: Option<Instant>,
    /// Times from orders to their setpoints on the wire.
    pub(super) waits: Vec<Duration>,
}

impl<'a> Hand<'a> {
    pub(super) fn new(page: &'a Console, (scene, limb): (&'a Scene, &Limb)) -> Self {
        Self { page, scene, drives: limb.drives().len(), shown: None, came: None, waits: Vec::new() }
    }
}

impl Operator for Hand<'_> {
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press> {
        let mut presses = Vec::new();
        // Orders from before the device was ready are dropped, but for these two.
        let is_first = self.shown.is_none();
        let counts = |order: &Order| !is_first || matches!(order, Order::Vent | Order::End);
        for (order, waited) in self.page.orders().into_iter().filter(|(order, _)| counts(order)) {
            let keys = keys(order, view.jog.settings(), self.drives);
            if keys.iter().any(|key| matches!(key, Press::Order(_))) {
                self.came = self.came.or_else(|| Instant::now().checked_sub(waited));
            }
            presses.extend(keys);
        }
        // The view of a look with orders waits for the next look.
        if presses.is_empty() && self.shown.is_none_or(|shown| shown.elapsed() >= SHOWN) {
            self.shown = Some(Instant::now());
            self.page.show(&View::live(self.scene, view));
        }
        presses
    }

    fn sent(&mut self, _waited_us: u64) {
        self.waits.extend(self.came.take().map(|came| came.elapsed()));
    }
}

/// The keys of an order.
fn keys(order: Order, settings: Settings, drives: usize) -> Vec<Press> {
    let press = |order| vec![Press::Order(order)];
    match order {
        Order::Arm => Vec::new(),
        Order::Task => vec![Press::Task],
        Order::Jog(jog) => moved(jog, settings, drives, jog::Order::Hold),
        Order::Step(jog) => moved(jog, settings, drives, jog::Order::Go),
        Order::Stop => press(jog::Order::Stop),
        Order::Gripper => press(jog::Order::Gripper),
        Order::Vent => vec![Press::Vent],
        Order::Resume => vec![Press::Resume],
        Order::End => vec![Press::End],
        Order::Break { name, channel } => vec![Press::Break(name, channel)],
    }
}

/// A move with its settings before it. A drive or an axis that the limb does not have moves nothing.
fn moved(wanted: Jog, settings: Settings, drives: usize, order: fn(Way) -> jog::Order) -> Vec<Press> {
    if wanted.axis > 2 || wanted.drive.is_some_and(|drive| drive >= drives) {
        return Vec::new();
    }
    let mut orders = Vec::new();
    if settings.drive != wanted.drive {
        orders.push(wanted.drive.map_or(jog::Order::SelectTip, jog::Order::SelectDrive));
    }
    let turned = |now: f64, list: &[f64], place: usize, [down, up]: [jog::Order; 2]| {
        let now = list.iter().position(|value| *value == now).unwrap_or(0);
        let place = place.min(list.len() - 1);
        let count = now.abs_diff(place);
        vec![if place > now { up } else { down }; count]
    };
    let speeds = [jog::Order::Slower, jog::Order::Faster];
    orders.extend(turned(settings.speed(), &jog::SPEEDS, wanted.speed, speeds));
    orders.extend(turned(settings.step(), &jog::STEPS, wanted.step, [jog::Order::Shorter, jog::Order::Longer]));
    orders.push(order(Way { axis: wanted.axis, with: wanted.with }));
    orders.into_iter().map(Press::Order).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn move_brings_its_settings() {
        let jog = Jog { drive: Some(1), axis: 0, with: false, speed: 2, step: 0 };
        let way = Way { axis: 0, with: false };
        let expected = [jog::Order::SelectDrive(1), jog::Order::Faster, jog::Order::Shorter, jog::Order::Hold(way)];
        assert_eq!(keys(Order::Jog(jog), Settings::default(), 3), expected.map(Press::Order));
        let tip = Jog { drive: None, axis: 2, with: true, speed: 1, step: 1 };
        let step = jog::Order::Go(Way { axis: 2, with: true });
        assert_eq!(keys(Order::Step(tip), Settings::default(), 3), [Press::Order(step)]);
    }

    #[test]
    fn drive_that_is_not_there_moves_no_other() {
        let jog = Jog { drive: Some(3), axis: 0, with: true, speed: 1, step: 1 };
        assert_eq!(keys(Order::Jog(jog), Settings::default(), 3), []);
        assert_eq!(keys(Order::Jog(Jog { drive: None, axis: 3, ..jog }), Settings::default(), 3), []);
    }
}
