//! Which page commands, and what the limb does without one. Times are arguments and may start anywhere.

use std::time::Duration;

use crate::order::{Act, Message, Order};

/// A held move ends when the page has not repeated it for this long.
const HELD: Duration = Duration::from_millis(150);
/// Without a page that commands, the limb is vented after this long.
const ALONE: Duration = Duration::from_secs(5);

/// A page, by its number.
pub(crate) type Client = u64;

/// Orders on their way from the pages to the limb.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    commander: Option<Client>,
    /// Each with its time of arrival.
    orders: Vec<(Order, Duration)>,
    /// The held move, and the time of its last repetition.
    held: Option<(Order, Duration)>,
    /// Time at which the last commander left.
    alone: Option<Duration>,
}

impl Desk {
    pub(crate) fn commander(&self) -> Option<Client> {
        self.commander
    }

    /// Adds a page. It commands if no other page does.
    pub(crate) fn join(&mut self, client: Client) {
        if self.commander.is_none() {
            (self.commander, self.alone) = (Some(client), None);
        }
    }

    /// Removes a page. If it commanded, the limb holds.
    pub(crate) fn leave(&mut self, client: Client, now: Duration) {
        if self.commander == Some(client) {
            (self.commander, self.held, self.alone) = (None, None, Some(now));
            self.orders.push((Order::Stop, now));
        }
    }

    /// Takes a message of a page.
    ///
    /// # Errors
    /// The reason for which it is refused, in words.
    pub(crate) fn take(&mut self, client: Client, message: Message, now: Duration) -> Result<(), String> {
        let order = match message.act {
            Act::Take { .. } => {
                self.join(client);
                return self.refuse_others(client);
            }
            Act::Order(order) => order,
        };
        if order != Order::Vent {
            self.refuse_others(client)?;
        }
        let before = self.held.take();
        if matches!(order, Order::Jog(_)) {
            self.held = Some((order.clone(), now));
        }
        // A repetition only extends the move: the limb may have refused it already.
        if before.is_none_or(|(before, _)| before != order) {
            self.orders.push((order, now));
        }
        Ok(())
    }

    fn refuse_others(&self, client: Client) -> Result<(), String> {
        if self.commander == Some(client) {
            return Ok(());
        }
        Err(match self.commander {
            Some(_) => "another page commands; this one looks, and can vent",
            None => "no page commands; take the command first",
        }
        .to_owned())
    }

    /// The orders since the last call, each with the time that it has waited, and those for a page that has fallen silent.
    pub(crate) fn orders(&mut self, now: Duration) -> Vec<(Order, Duration)> {
        let waited = |(order, came): (Order, Duration)| (order, now.saturating_sub(came));
        let mut orders: Vec<_> = std::mem::take(&mut self.orders).into_iter().map(waited).collect();
        if self.held.take_if(|(_, since)| now.saturating_sub(*since) > HELD).is_some() {
            orders.push((Order::Stop, Duration::ZERO));
        }
        if self.alone.take_if(|since| now.saturating_sub(*since) > ALONE).is_some() {
            orders.push((Order::Vent, Duration::ZERO));
        }
        orders
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Jog;

    const MS: fn(u64) -> Duration = Duration::from_millis;
    const JOG: Order = Order::Jog(Jog { drive: Some(1), axis: 0, with: true, speed: 0, step: 0 });

    fn order(number: u64, order: Order) -> Message {
        Message { number, act: Act::Order(order) }
    }

    fn orders(desk: &mut Desk, now: Duration) -> Vec<Order> {
        desk.orders(now).into_iter().map(|(order, _)| order).collect()
    }

    #[test]
    fn first_page_commands_and_all_may_vent() {
        let mut desk = Desk::default();
        desk.join(1);
        desk.join(2);
        desk.take(1, order(1, Order::Arm), MS(0)).unwrap();
        let refused = desk.take(2, order(1, Order::Task), MS(1)).unwrap_err();
        assert!(refused.contains("another page"), "{refused}");
        desk.take(2, order(2, Order::Vent), MS(2)).unwrap();
        assert_eq!(desk.orders(MS(3)), [(Order::Arm, MS(3)), (Order::Vent, MS(1))], "with their waits");
        // The command is not taken from a page that has it.
        let take = Message { number: 3, act: Act::Take { take: true } };
        assert!(desk.take(2, take.clone(), MS(4)).is_err());
        desk.leave(1, MS(5));
        let refused = desk.take(2, order(4, Order::Task), MS(6)).unwrap_err();
        assert!(refused.contains("take the command"), "{refused}");
        desk.take(2, take, MS(7)).unwrap();
        desk.take(2, order(5, Order::Task), MS(8)).unwrap();
        assert_eq!(orders(&mut desk, MS(9)), [Order::Stop, Order::Task]);
    }

    #[test]
    fn held_move_ends_with_its_repetitions() {
        let mut desk = Desk::default();
        desk.join(1);
        desk.take(1, order(1, JOG), MS(0)).unwrap();
        desk.take(1, order(2, JOG), MS(50)).unwrap();
        assert_eq!(orders(&mut desk, MS(60)), [JOG]);
        desk.take(1, order(3, JOG), MS(100)).unwrap();
        assert_eq!(orders(&mut desk, MS(249)), []);
        assert_eq!(orders(&mut desk, MS(251)), [Order::Stop]);
        assert_eq!(orders(&mut desk, MS(9000)), []);
        desk.take(1, order(4, JOG), MS(10_000)).unwrap();
        desk.take(1, order(5, Order::Stop), MS(10_010)).unwrap();
        assert_eq!(orders(&mut desk, MS(10_500)), [JOG, Order::Stop], "let go once");
    }

    #[test]
    fn limb_that_nobody_commands_holds_and_is_vented_later() {
        let mut desk = Desk::default();
        desk.join(1);
        desk.take(1, order(1, JOG), MS(0)).unwrap();
        assert_eq!(orders(&mut desk, MS(1)), [JOG]);
        desk.leave(1, MS(20));
        assert_eq!(orders(&mut desk, MS(30)), [Order::Stop]);
        assert_eq!(orders(&mut desk, MS(5_000)), []);
        assert_eq!(orders(&mut desk, MS(5_021)), [Order::Vent]);
        assert_eq!(orders(&mut desk, MS(60_000)), [], "once");
        desk.leave(7, MS(61_000));
        assert_eq!(orders(&mut desk, MS(70_000)), [], "a page that only looked");
        // A page that joins in time prevents the vent.
        desk.join(2);
        desk.leave(2, MS(80_000));
        desk.join(3);
        assert_eq!(orders(&mut desk, MS(90_000)), [Order::Stop]);
    }
}
