//! Function of each pin. The table in `docs/reference/hardware.md` is printed from here.

use core::fmt;

use softlimb_protocol::Outputs;

/// Channels of the board: as many as it has sensors and pairs of valves.
pub const CHANNELS: usize = 9;

/// The controller of this board.
pub type Controller = softlimb_firmware::Controller<CHANNELS>;

/// Inputs of its tick.
pub type TickInputs = softlimb_firmware::TickInputs<CHANNELS>;

/// Outputs of its tick.
pub type TickOutputs = softlimb_firmware::TickOutputs<CHANNELS>;

/// Converter inputs: the channels' sensors, the supply's and the voltage of the valves' supply.
pub const SENSORS: usize = CHANNELS + 2;

/// Ports in use.
pub const PORTS: usize = 3;

/// A port of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// GPIOA.
    A = 0,
    /// GPIOB.
    B = 1,
    /// GPIOC.
    C = 2,
}

/// One pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin {
    /// Its port.
    pub port: Port,
    /// Its number, 0..=15.
    pub number: u8,
}

impl Pin {
    /// Its bit in the registers of its port.
    #[must_use]
    pub const fn bit(self) -> u16 {
        1 << self.number
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "P{:?}{}", self.port, self.number)
    }
}

const fn a(number: u8) -> Pin {
    Pin { port: Port::A, number }
}

const fn b(number: u8) -> Pin {
    Pin { port: Port::B, number }
}

const fn c(number: u8) -> Pin {
    Pin { port: Port::C, number }
}

/// Gates of the fill valves, high energizes. None of them is a pin that the chip's own loader drives for its serial ports 1 and 3
/// but PC10 and PC11, nor one that is pulled up at reset.
pub const FILL: [Pin; CHANNELS] = [b(12), b(13), b(14), b(15), c(8), c(9), c(10), c(11), c(12)];

/// Gates of the vent valves, high energizes.
pub const VENT: [Pin; CHANNELS] = [b(5), b(6), b(7), b(8), b(9), b(10), a(8), a(9), a(10)];

/// Gate of the valve that lets the supply in, high energizes.
pub const SUPPLY: Pin = c(6);

/// Gate of the pump, high energizes.
pub const PUMP: Pin = c(7);

/// Gate of the gripper, high closes it.
pub const GRIPPER: Pin = c(4);

/// The digital outputs with their pins.
pub const DIGITAL: [(Outputs, Pin); 1] = [(Outputs::GRIPPER, GRIPPER)];

/// Sensors of the channels, then of the supply, then the divider at the valves' supply, with their input of the converter.
pub const SENSOR: [(Pin, u8); SENSORS] = [
    (a(0), 0),
    (a(1), 1),
    (a(4), 4),
    (a(6), 6),
    (a(7), 7),
    (b(0), 8),
    (b(1), 9),
    (c(0), 10),
    (c(1), 11),
    (c(2), 12),
    (c(5), 15),
];

/// The emergency stop: a contact to ground that opens when it is pressed, so that a broken wire stops too.
pub const EMERGENCY_STOP: Pin = c(3);

/// Output of the link.
pub const LINK_OUT: Pin = a(2);

/// Input of the link.
pub const LINK_IN: Pin = a(3);

/// All outputs of one port.
#[must_use]
pub const fn outputs(port: Port) -> u16 {
    let mut mask = in_port(SUPPLY, port) | in_port(PUMP, port) | digital(port);
    let mut channel = 0;
    while channel < CHANNELS {
        mask |= in_port(FILL[channel], port) | in_port(VENT[channel], port);
        channel += 1;
    }
    mask
}

const fn in_port(pin: Pin, port: Port) -> u16 {
    if pin.port as u8 == port as u8 { pin.bit() } else { 0 }
}

const fn digital(port: Port) -> u16 {
    let (mut mask, mut output) = (0, 0);
    while output < DIGITAL.len() {
        mask |= in_port(DIGITAL[output].1, port);
        output += 1;
    }
    mask
}

/// The digital outputs, port by port.
pub const DIGITALS: [u16; PORTS] = [digital(Port::A), digital(Port::B), digital(Port::C)];

/// All outputs, port by port.
pub const OUTPUTS: [u16; PORTS] = [outputs(Port::A), outputs(Port::B), outputs(Port::C)];

/// The vents of all channels, port by port.
pub const VENTS: [u16; PORTS] = [vents(Port::A), vents(Port::B), vents(Port::C)];

const fn vents(port: Port) -> u16 {
    let (mut mask, mut channel) = (0, 0);
    while channel < CHANNELS {
        mask |= in_port(VENT[channel], port);
        channel += 1;
    }
    mask
}

/// The table of the pins as text: one line a pin, cells of a Markdown table.
pub struct Table;

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "| pin | what | electrically |\n| --- | --- | --- |")?;
        for (channel, pin) in FILL.iter().enumerate() {
            writeln!(f, "| {pin} | fill valve of channel {channel} | output, pulled down; high energizes |")?;
        }
        for (channel, pin) in VENT.iter().enumerate() {
            writeln!(f, "| {pin} | vent valve of channel {channel} | output, pulled down; high energizes |")?;
        }
        writeln!(f, "| {SUPPLY} | supply valve | output, pulled down; high energizes |")?;
        writeln!(f, "| {PUMP} | pump | output, pulled down; high runs |")?;
        writeln!(f, "| {GRIPPER} | gripper | output, pulled down; high closes |")?;
        for (channel, (pin, input)) in SENSOR.iter().take(CHANNELS).enumerate() {
            writeln!(f, "| {pin} | pressure sensor of channel {channel} | analog, ADC1 input {input} |")?;
        }
        let [.., (supply, supply_input), (divider, divider_input)] = SENSOR;
        writeln!(f, "| {supply} | pressure sensor of the supply | analog, ADC1 input {supply_input} |")?;
        writeln!(f, "| {divider} | voltage of the valves' supply, divided | analog, ADC1 input {divider_input} |")?;
        writeln!(f, "| {EMERGENCY_STOP} | emergency stop | input, pulled up; high stops |")?;
        writeln!(f, "| {LINK_OUT} | link to the host | USART2 TX, 3.3 V, 921600 baud, 8N1 |")?;
        writeln!(f, "| {LINK_IN} | link from the host | USART2 RX |")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pins with a use of their own on boards with these chips: debugger, crystals, USB, boot selection, the NUCLEO's lamp.
    const TAKEN: [Pin; 12] = [a(13), a(14), a(15), b(2), b(3), b(4), b(11), c(14), c(15), a(11), a(12), a(5)];

    fn all() -> Vec<Pin> {
        let sensors = SENSOR.iter().map(|(pin, _)| *pin);
        FILL.into_iter()
            .chain(VENT)
            .chain(sensors)
            .chain([SUPPLY, PUMP, GRIPPER, EMERGENCY_STOP, LINK_OUT, LINK_IN])
            .collect()
    }

    #[test]
    fn every_pin_exists_has_one_use_and_none_of_its_own() {
        let pins = all();
        for (index, pin) in pins.iter().enumerate() {
            assert!(pin.number < 16 && !TAKEN.contains(pin), "{pin}");
            assert!(!pins[..index].contains(pin), "{pin} has two uses");
        }
        assert_eq!(pins.len(), 2 * CHANNELS + SENSORS + 6);
    }

    #[test]
    fn masks_hold_every_output_once() {
        assert_eq!(OUTPUTS.map(u16::count_ones).iter().sum::<u32>(), 21);
        assert_eq!(OUTPUTS[0], 1 << 8 | 1 << 9 | 1 << 10);
    }

    #[test]
    fn converter_inputs_are_those_of_their_pins() {
        // Reference manual RM0090, "ADC": PA0-7 are inputs 0-7, PB0-1 are 8-9, PC0-5 are 10-15.
        for (pin, input) in SENSOR {
            let first = match pin.port {
                Port::A => 0,
                Port::B => 8,
                Port::C => 10,
            };
            assert_eq!(input, first + pin.number, "{pin}");
        }
    }
}
