//! What a page sends.

use serde::Deserialize;

/// One order to the limb.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "order", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Order {
    /// Connect, configure, fill the supply, and follow the orders.
    Arm,
    /// Run the plan of the scene, or go on with it.
    Task,
    /// Move in a direction until [`Order::Stop`]; the page repeats it while it is held.
    Jog(Jog),
    /// Move by a step.
    Step(Jog),
    /// Stop where the limb is.
    Stop,
    /// Close or open the gripper.
    Gripper,
    /// Let the pressures down. Every page may send it.
    Vent,
    /// Go on after that.
    Resume,
    /// Let the pressures down and end the session.
    End,
    /// Break a part of the simulated device.
    Break {
        /// Name of the fault.
        name: String,
        /// Channel, from 0; absent for a fault of no channel.
        channel: Option<usize>,
    },
}

/// A move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jog {
    /// The drive that moves; the tip without it.
    pub drive: Option<usize>,
    /// Axis of the world, 0 to 2.
    pub axis: usize,
    /// Whether in the positive direction; of a drive, whether its pressure rises.
    pub with: bool,
    /// Place in the list of speeds, the slowest first.
    pub speed: usize,
    /// Place in the list of steps, the shortest first.
    pub step: usize,
}

/// One message of a page.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct Message {
    /// Sequence number; the answer repeats it.
    pub(crate) number: u64,
    #[serde(flatten)]
    pub(crate) act: Act,
}

/// Content of a message.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub(crate) enum Act {
    /// Takes over if no page commands.
    Take {
        /// Always true.
        take: bool,
    },
    /// An order.
    Order(Order),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_and_others_refused() {
        let read = |text: &str| serde_json::from_str::<Message>(text);
        let jog = Jog { drive: None, axis: 2, with: true, speed: 1, step: 0 };
        let text = r#"{"number":7,"order":"jog","drive":null,"axis":2,"with":true,"speed":1,"step":0}"#;
        assert_eq!(read(text).unwrap(), Message { number: 7, act: Act::Order(Order::Jog(jog)) });
        assert_eq!(read(r#"{"number":8,"take":true}"#).unwrap().act, Act::Take { take: true });
        let fault = Order::Break { name: "leak".into(), channel: Some(2) };
        assert_eq!(read(r#"{"number":9,"order":"break","name":"leak","channel":2}"#).unwrap().act, Act::Order(fault));
        for text in ["", "{}", r#"{"number":1}"#, r#"{"number":1,"order":"fly"}"#, r#"{"order":"vent"}"#] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
