//! All sequences of inputs up to a length, from several beginnings: what the safe states promise holds in every tick of every sequence.
//!
//! An input lasts for [`TICKS`] ticks, as many as a sensor takes to count as implausible. Sequences of four are run; of five where
//! `SOFTLIMB_SAMPLES` is `full`.

use softlimb_firmware::{TickOutputs, ValvePulse};
use softlimb_protocol::*;

use crate::common::Bench;

const TICKS: usize = 3;

/// Everything that a host, an operator and the sensors can do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Input {
    Nothing,
    StopPressed,
    SensorOpen,
    OverPressure,
    NoPressure,
    Knot,
    Pulse(PulseDirection),
    Command(CommandCode),
}

const INPUTS: [Input; 14] = [
    Input::Nothing,
    Input::StopPressed,
    Input::SensorOpen,
    Input::OverPressure,
    Input::NoPressure,
    Input::Knot,
    Input::Pulse(PulseDirection::Fill),
    Input::Pulse(PulseDirection::Vent),
    Input::Command(CommandCode::Start),
    Input::Command(CommandCode::Hold),
    Input::Command(CommandCode::Vent),
    Input::Command(CommandCode::EmergencyStop),
    Input::Command(CommandCode::ClearFaults),
    Input::Command(CommandCode::Flush),
];

/// Ticks in which a promise was at stake: a search that meets none of them shows nothing.
#[derive(Debug, Default)]
struct Seen {
    sequences: u64,
    filled_while_running: u64,
    filled_by_hand: u64,
    stopped: u64,
    vented_after_over_pressure: u64,
    faulted: u64,
    supply_cut: u64,
    states: [u64; 6],
}

/// The device with a second, simple account of what it owes.
#[derive(Clone)]
struct Watched {
    bench: Bench,
    /// Stopped, and not cleared since.
    is_stopped: bool,
    /// Over the limit in the last ticks, as a latched fault, and not cleared since.
    is_over: bool,
    is_faulted: bool,
    /// A pulse by hand was accepted in this state.
    is_by_hand: bool,
}

impl Watched {
    fn new(bench: Bench) -> Self {
        Self { bench, is_stopped: false, is_over: false, is_faulted: false, is_by_hand: false }
    }

    fn state(&self) -> DeviceState {
        self.bench.controller.state()
    }

    fn apply(&mut self, input: Input) {
        let bench = &mut self.bench;
        let is_taken = |ack: Ack| ack.result == ResultCode::Ok;
        match input {
            Input::Nothing => {}
            Input::StopPressed => bench.emergency_stop = true,
            Input::SensorOpen => bench.code[0] = Some(0),
            Input::OverPressure => bench.pressure_pa[0] = 160e3,
            Input::NoPressure => bench.pressure_pa[0] = 0.0,
            Input::Knot => {
                let index = bench.controller.queue().next_index();
                bench.setpoint(index, bench.now_us + 20_000, &[120_000]);
            }
            Input::Pulse(direction) => self.is_by_hand |= is_taken(bench.pulse(0, direction, 2_000)),
            Input::Command(code) => {
                let is_taken = is_taken(bench.command(code));
                self.is_stopped |= code == CommandCode::EmergencyStop;
                if is_taken && code == CommandCode::ClearFaults {
                    (self.is_stopped, self.is_over, self.is_faulted) = (false, false, false);
                }
            }
        }
        self.is_stopped |= self.bench.emergency_stop;
    }

    /// The input ends; a pressure that was set stays.
    fn release(&mut self) {
        self.bench.emergency_stop = false;
        self.bench.code[0] = None;
        self.bench.messages.clear();
    }

    fn tick(&mut self, seen: &mut Seen) -> Result<(), &'static str> {
        let before = self.state();
        let outputs = self.bench.tick();
        let state = self.state();
        self.is_by_hand &= state == before || state == DeviceState::Holding && before == DeviceState::Ready;
        let faults = self.bench.controller.faults();
        self.is_over |= faults.contains(FaultCode::OverPressure);
        seen.states[state as usize] += 1;
        self.check(&outputs, seen)?;
        self.is_faulted |= state == DeviceState::Faulted;
        Ok(())
    }

    fn check(&self, outputs: &TickOutputs, seen: &mut Seen) -> Result<(), &'static str> {
        let state = self.state();
        let fills = outputs.valves.iter().any(|pulse| pulse.fill_us > 0);
        seen.filled_while_running += u64::from(fills && state == DeviceState::Running);
        seen.filled_by_hand += u64::from(fills && state == DeviceState::Holding);
        let may_fill = state == DeviceState::Running || state == DeviceState::Holding && self.is_by_hand;
        if fills && !may_fill {
            return Err("fills without running");
        }
        let configured = self.bench.controller.config().map_or(outputs.valves.len(), |config| config.channels.len());
        let all_vent = outputs.valves[..configured].iter().all(|pulse| *pulse == ValvePulse::VENTING);
        if self.is_stopped {
            seen.stopped += 1;
            if !all_vent || outputs.supply_open || outputs.pump_duty > 0 {
                return Err("is stopped, and does not vent, or takes air");
            }
        }
        if self.is_over {
            seen.vented_after_over_pressure += 1;
            if outputs.valves[0] != ValvePulse::VENTING {
                return Err("was over its limit, and does not vent");
            }
        }
        let may_take_air = matches!(state, DeviceState::Running | DeviceState::Holding | DeviceState::Faulted);
        if outputs.supply_open && !may_take_air {
            return Err("lets air to the fill valves before a start");
        }
        if self.is_faulted {
            seen.faulted += 1;
            if state != DeviceState::Faulted {
                return Err("left the faulted state without being cleared");
            }
        }
        if self.bench.controller.faults().cuts_supply() {
            seen.supply_cut += 1;
            if outputs.supply_open || outputs.pump_duty > 0 {
                return Err("takes air after a fault that cuts the supply");
            }
        }
        Ok(())
    }
}

fn search(from: &Watched, depth: usize, path: &mut Vec<Input>, seen: &mut Seen) {
    if depth == 0 {
        seen.sequences += 1;
        return;
    }
    for input in INPUTS {
        let mut device = from.clone();
        path.push(input);
        device.apply(input);
        for _ in 0..TICKS {
            if let Err(broken) = device.tick(seen) {
                panic!("after {path:?} the device {broken}; it is {:?}", device.state());
            }
        }
        device.release();
        search(&device, depth - 1, path, seen);
        path.pop();
    }
}

/// Devices to begin with: without a configuration, ready, filling on the way to 120 kPa, holding, venting.
fn beginnings() -> Vec<Watched> {
    let mut unconfigured = Bench::new();
    unconfigured.hello();
    let ready = Bench::ready(&[SetpointKind::Pressure]);
    let mut filling = Bench::ready(&[SetpointKind::Pressure]);
    for index in 0..40 {
        let (time_us, value) = (filling.now_us + 20_000 * (u64::from(index) + 1), 120_000.min(3_000 * index as i32));
        assert_eq!(filling.setpoint(index, time_us, &[value]).result, ResultCode::Ok);
    }
    assert_eq!(filling.command(CommandCode::Start).result, ResultCode::Ok);
    filling.attach(1, 0.0);
    filling.ticks(200);
    filling.fixtures.clear();
    let mut holding = filling.clone();
    holding.command(CommandCode::Hold);
    let mut venting = filling.clone();
    venting.command(CommandCode::Vent);
    let mut all = vec![unconfigured, ready, filling, holding, venting];
    all.iter_mut().for_each(|bench| bench.messages.clear());
    all.into_iter().map(Watched::new).collect()
}

#[test]
fn safe_states_keep_their_promises_in_all_sequences() {
    let is_full = std::env::var_os("SOFTLIMB_SAMPLES").is_some_and(|value| value == "full");
    let depth = if is_full { 5 } else { 4 };
    let mut seen = Seen::default();
    for device in beginnings() {
        search(&device, depth, &mut Vec::new(), &mut seen);
    }
    println!("{seen:?}");
    assert_eq!(seen.sequences, 5 * (INPUTS.len() as u64).pow(depth as u32));
    let Seen { filled_while_running, filled_by_hand, stopped, vented_after_over_pressure, faulted, supply_cut, .. } =
        seen;
    let counts = [filled_while_running, filled_by_hand, stopped, vented_after_over_pressure, faulted, supply_cut];
    assert!(counts.iter().chain(&seen.states).all(|count| *count > 1_000), "a promise is never at stake: {seen:?}");
}
