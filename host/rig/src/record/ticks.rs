//! Inputs and outputs of the controller in each tick: with the bytes of the link, all that a re-run needs.

use super::cdr::{CdrError, CdrReader};
use super::messages::{begin, open};
use serde::Serialize;

const STOP_PRESSED: u8 = 1;
const SUPPLY_OPEN: u8 = 2;

/// Coil times of one channel in one tick, us.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct CoilPulse {
    /// The channel.
    pub channel: u8,
    /// Time for which the fill valve's coil is energized, from the start of the tick.
    pub fill_us: u16,
    /// The same of the vent valve.
    pub vent_us: u16,
}

/// One control tick of a simulated or emulated device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DeviceTick {
    /// The device's clock, us.
    pub device_us: u64,
    /// Codes of the converter: the channels, then the supply.
    pub codes: Vec<u16>,
    /// Code of the voltage of the valves' supply; 0 in logs of earlier versions.
    pub valve_supply_code: u16,
    /// The emergency stop is pressed.
    pub stop_pressed: bool,
    /// The supply valve is energized.
    pub supply_open: bool,
    /// Pump speed, of 255.
    pub pump_duty: u8,
    /// Bits of the digital outputs.
    pub outputs: u8,
    /// The channels with an energized coil, in rising order.
    pub pulses: Vec<CoilPulse>,
}

/// Length of a control tick, us.
const TICK_US: u64 = 1_000;

/// The longest row of consecutive ticks with equally many codes, and the rest.
pub(super) fn first_row(ticks: &[DeviceTick]) -> (&[DeviceTick], &[DeviceTick]) {
    let follows = |[a, b]: [&DeviceTick; 2]| b.device_us == a.device_us + TICK_US && a.codes.len() == b.codes.len();
    let broken = ticks.windows(2).position(|pair| !follows([&pair[0], &pair[1]]));
    ticks.split_at(broken.map_or(ticks.len(), |index| index + 1))
}

/// Encodes consecutive ticks.
pub(super) fn encode_ticks(unix_ns: u64, ticks: &[DeviceTick], at_pins: bool) -> Vec<u8> {
    let Some(first) = ticks.first() else { return begin(unix_ns).into_bytes() };
    let switches =
        |tick: &DeviceTick| u8::from(tick.stop_pressed) * STOP_PRESSED + u8::from(tick.supply_open) * SUPPLY_OPEN;
    let codes = ticks.iter().map(|tick| &tick.codes[..]).collect::<Vec<_>>().concat();
    let pulses: Vec<(u16, CoilPulse)> =
        (0..).zip(ticks).flat_map(|(index, tick)| tick.pulses.iter().map(move |&pulse| (index, pulse))).collect();
    let mut cdr = begin(unix_ns);
    cdr.u64(first.device_us);
    cdr.u8(u8::from(at_pins));
    cdr.u8(first.codes.len().saturating_sub(1) as u8);
    cdr.u16_sequence(codes.into_iter());
    cdr.u8_sequence(&ticks.iter().map(switches).collect::<Vec<_>>());
    cdr.u8_sequence(&ticks.iter().map(|tick| tick.pump_duty).collect::<Vec<_>>());
    cdr.u8_sequence(&ticks.iter().map(|tick| tick.outputs).collect::<Vec<_>>());
    cdr.u16_sequence(pulses.iter().map(|(index, _)| *index));
    cdr.u8_sequence(&pulses.iter().map(|(_, pulse)| pulse.channel).collect::<Vec<_>>());
    cdr.u16_sequence(pulses.iter().map(|(_, pulse)| pulse.fill_us));
    cdr.u16_sequence(pulses.iter().map(|(_, pulse)| pulse.vent_us));
    cdr.u16_sequence(ticks.iter().map(|tick| tick.valve_supply_code));
    cdr.into_bytes()
}

/// Decodes ticks, and whether their outputs are those of pins.
pub(super) fn decode_ticks(message: &[u8]) -> Result<(Vec<DeviceTick>, bool), CdrError> {
    let mut cdr = open(message)?;
    let (first_us, at_pins, channels) = (cdr.u64()?, cdr.u8()? != 0, usize::from(cdr.u8()?));
    let codes = cdr.sequence(CdrReader::u16)?;
    let (switches, pump_duty, outputs) = (cdr.u8_sequence()?, cdr.u8_sequence()?, cdr.u8_sequence()?);
    let pulse_tick = cdr.sequence(CdrReader::u16)?;
    let pulse_channel = cdr.u8_sequence()?;
    let (fill_us, vent_us) = (cdr.sequence(CdrReader::u16)?, cdr.sequence(CdrReader::u16)?);
    let columns = codes.chunks(channels + 1).zip(switches).zip(pump_duty).zip(outputs).zip(0_u64..);
    let mut ticks: Vec<DeviceTick> = columns
        .map(|((((codes, switches), pump_duty), outputs), index)| DeviceTick {
            device_us: first_us.saturating_add(index * TICK_US),
            codes: codes.to_vec(),
            valve_supply_code: 0,
            stop_pressed: switches & STOP_PRESSED != 0,
            supply_open: switches & SUPPLY_OPEN != 0,
            pump_duty,
            outputs,
            pulses: Vec::new(),
        })
        .collect();
    // Logs of earlier versions end before it.
    let voltages = cdr.sequence(CdrReader::u16).unwrap_or_default();
    ticks.iter_mut().zip(voltages).for_each(|(tick, code)| tick.valve_supply_code = code);
    for (((tick, channel), fill_us), vent_us) in pulse_tick.into_iter().zip(pulse_channel).zip(fill_us).zip(vent_us) {
        if let Some(tick) = ticks.get_mut(usize::from(tick)) {
            tick.pulses.push(CoilPulse { channel, fill_us, vent_us });
        }
    }
    Ok((ticks, at_pins))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(device_us: u64, codes: &[u16], pulses: &[(u8, u16, u16)]) -> DeviceTick {
        let pulses = pulses.iter().map(|&(channel, fill_us, vent_us)| CoilPulse { channel, fill_us, vent_us });
        DeviceTick {
            device_us,
            codes: codes.to_vec(),
            valve_supply_code: 2_700 + (device_us / 1_000) as u16,
            stop_pressed: device_us == 6_000,
            supply_open: device_us != 6_000,
            pump_duty: (device_us / 100) as u8,
            outputs: 1,
            pulses: pulses.collect(),
        }
    }

    #[test]
    fn ticks_come_back_as_they_were() {
        let ticks = [
            tick(5_000, &[410, 411, 3_000], &[]),
            tick(6_000, &[409, 0, 3_001], &[(0, 1_000, 0), (1, 0, 250)]),
            tick(7_000, &[4_095, 1, 2_999], &[(1, 3, 4)]),
        ];
        for at_pins in [false, true] {
            assert_eq!(decode_ticks(&encode_ticks(0, &ticks, at_pins)), Ok((ticks.to_vec(), at_pins)));
        }
    }

    #[test]
    fn row_ends_where_a_tick_is_missing_or_has_other_codes() {
        let row =
            [tick(1_000, &[1, 2], &[]), tick(2_000, &[1, 2], &[]), tick(4_000, &[1, 2], &[]), tick(5_000, &[1], &[])];
        let (first, rest) = first_row(&row);
        assert_eq!((first.len(), rest.len()), (2, 2));
        assert_eq!(first_row(rest).0.len(), 1);
        assert!(first_row(&[]).0.is_empty());
    }
}
