//! Other loops, on the plant without a device: pulses of a PI controller with feed-forward, valves that are on or off beyond a dead band, and
//! valves without delays.

use fra_model::{Actuator, Load};
use softlimb_sim::plant::{
    ChannelDrive, ChannelSettings, Drive, Plant, PlantSettings, REFERENCE_DENSITY_KG_PER_M3, ValveSettings,
};

use super::Method;
use super::bench::{Moment, Recording};
use super::program::{end_s, knots_pa, reference_pa};
use crate::faults::bench::CHANNELS;

const TICK_US: u16 = 1_000;
const TICK_S: f64 = 1e-3;

/// Ticks that the chambers rest before the start.
const BEFORE: usize = 200;

/// Error beyond which the on-off loop opens a valve, Pa.
const DEAD_BAND_PA: f64 = 1e3;

/// Effect of a tick that a valve without delay is credited with before its first whole one, Pa.
const FIRST_EFFECT_PA: f64 = 500.0;

/// Control period of the PI loop, ticks, and its gains, 1/s and 1/s2.
const PERIOD: usize = 20;
const PROPORTIONAL_PER_S: f64 = 15.0;
const INTEGRAL_PER_S2: f64 = 20.0;

/// Shortest time for which it opens a valve, us.
const SHORTEST_US: f64 = 500.0;

/// Air: specific gas constant, J/(kg K), temperature, K, exponent of a chamber with some heat from its wall, and pressure of the room, Pa.
const R_AIR: f64 = 287.05;
const ROOM_K: f64 = 293.15;
const EXPONENT: f64 = 1.2;
const ROOM_PA: f64 = 101_325.0;
const SUPPLY_PA: f64 = 200e3;
/// Distance of the pressures at which a volume is known, Pa, and their number.
const STEP_PA: f64 = 5e3;
const STEPS: usize = 32;
/// Fittings and tube beside the actuator, m3.
const BESIDE_M3: f64 = 6.9e-6;
/// Sonic conductance of 1 m of 2.5 mm tube, m3/(s Pa).
const LINE_M3_PER_S_PA: f64 = 3.78e-9;

/// Runs the program on a plant by one of these loops, which knows the channels as `told`.
pub(super) fn record(settings: &PlantSettings, told: &[ChannelSettings], method: Method) -> Recording {
    let is_swift = method == Method::Swift;
    let mut plant = Plant::new(&if is_swift { without_delay(settings) } else { settings.clone() })
        .expect("the settings of the bench");
    let mut swift: [Swift; CHANNELS] = std::array::from_fn(|_| Swift::new());
    let sensors: Vec<_> = settings.channels.iter().map(|channel| channel.sensor).collect();
    let knots_pa = knots_pa();
    let mut loops: [Loop; CHANNELS] = std::array::from_fn(|channel| Loop::new(&told[channel]));
    let mut moments = Vec::new();
    let ticks = (end_s() / TICK_S).round() as usize;
    for tick in 0..BEFORE + ticks {
        let time_s = (tick as f64 - BEFORE as f64) * TICK_S;
        let truth = is_swift.then(|| plant.truth());
        let channels: [ChannelDrive; CHANNELS] = std::array::from_fn(|channel| {
            let (sensor, code) = (sensors[channel], plant.pressure_codes()[channel]);
            let share = (f64::from(code) / f64::from(sensor.adc_full_scale) - 0.1) / 0.8;
            let reading_pa = sensor.min_pa + share * (sensor.max_pa - sensor.min_pa);
            let wanted_pa = |ahead_s: f64| reference_pa(&knots_pa, (time_s + ahead_s).max(0.0));
            match &truth {
                Some(truth) => swift[channel].drive(truth.channels[channel].pressure_pa, wanted_pa(TICK_S)),
                None if method == Method::OnOff => on_off(reading_pa, wanted_pa(0.0)),
                None => loops[channel].drive(tick, reading_pa, wanted_pa),
            }
        });
        plant.step(&Drive { channels: &channels, supply_open: true, pump: 1.0, gripper_on: false });
        if tick < BEFORE {
            continue;
        }
        moments.push(Moment::of(&plant.truth(), time_s + TICK_S));
    }
    Recording { moments, fault: None }
}

fn on_off(reading_pa: f64, wanted_pa: f64) -> ChannelDrive {
    let error_pa = wanted_pa - reading_pa;
    let coil = |is_on: bool| if is_on { TICK_US } else { 0 };
    ChannelDrive { fill_us: coil(error_pa > DEAD_BAND_PA), vent_us: coil(error_pa < -DEAD_BAND_PA) }
}

fn without_delay(settings: &PlantSettings) -> PlantSettings {
    let mut settings = settings.clone();
    for channel in &mut settings.channels {
        (channel.valve.on_delay_us, channel.valve.off_delay_us, channel.valve.jitter_us) = (0.0, 0.0, 0.0);
    }
    settings
}

/// Valves without delays: open in each tick for as long as the pressure lacks, by their last effects.
struct Swift {
    last_pa: f64,
    last: ChannelDrive,
    /// Change of the pressure by a whole tick of the fill and of the vent valve, Pa.
    effects_pa: [f64; 2],
}

impl Swift {
    fn new() -> Self {
        Self { last_pa: 0.0, last: ChannelDrive::default(), effects_pa: [FIRST_EFFECT_PA; 2] }
    }

    fn drive(&mut self, pressure_pa: f64, wanted_pa: f64) -> ChannelDrive {
        let change_pa = pressure_pa - self.last_pa;
        for (effect_pa, (coil_us, moved_pa)) in
            self.effects_pa.iter_mut().zip([(self.last.fill_us, change_pa), (self.last.vent_us, -change_pa)])
        {
            if coil_us == TICK_US && moved_pa > 0.0 {
                *effect_pa = moved_pa;
            }
        }
        let lacking_pa = wanted_pa - pressure_pa;
        let coil_us = |lacking_pa: f64, effect_pa: f64| (lacking_pa / effect_pa).clamp(0.0, 1.0) * f64::from(TICK_US);
        let drive = ChannelDrive {
            fill_us: coil_us(lacking_pa, self.effects_pa[0]) as u16,
            vent_us: coil_us(-lacking_pa, self.effects_pa[1]) as u16,
        };
        (self.last_pa, self.last) = (pressure_pa, drive);
        drive
    }
}

/// The PI loop of one channel.
struct Loop {
    /// Volume of a rigid chamber whose pressure changes as fast, m3, at multiples of [`STEP_PA`].
    volumes_m3: Vec<f64>,
    valve: ValveSettings,
    integral_pa_per_s: f64,
    /// Rest of the coil time of the fill and of the vent valve, us.
    coils_us: [f64; 2],
}

impl Loop {
    /// The loop knows the actuator's volume and compliance by the model.
    fn new(nominal: &ChannelSettings) -> Self {
        let actuator = Actuator::new(&nominal.actuator).expect("an actuator of the bench");
        let volume_m3 = |index: usize| {
            let state = actuator.forward(STEP_PA * index as f64, &Load::none()).expect("a pressure of the bench").state;
            state.volume_m3 + BESIDE_M3
        };
        let volumes_m3: Vec<f64> = (0..=STEPS).map(volume_m3).collect();
        let rigid = volumes_m3.windows(2).enumerate().map(|(index, pair)| {
            let inside_pa = ROOM_PA + STEP_PA * (index as f64 + 0.5);
            0.5 * (pair[0] + pair[1]) + EXPONENT * inside_pa * (pair[1] - pair[0]) / STEP_PA
        });
        let valve = nominal.valve;
        Self { volumes_m3: rigid.collect(), valve, integral_pa_per_s: 0.0, coils_us: [0.0; 2] }
    }

    fn drive(&mut self, tick: usize, reading_pa: f64, wanted_pa: impl Fn(f64) -> f64) -> ChannelDrive {
        if tick.is_multiple_of(PERIOD) {
            self.decide(reading_pa, wanted_pa);
        }
        let now_us = self.coils_us.map(|coil_us| coil_us.clamp(0.0, f64::from(TICK_US)));
        self.coils_us = [0, 1].map(|valve| self.coils_us[valve] - now_us[valve]);
        ChannelDrive { fill_us: now_us[0] as u16, vent_us: now_us[1] as u16 }
    }

    /// Rate of the reference over the next period, plus what the error wants, divided by the modelled rate of the valve.
    fn decide(&mut self, reading_pa: f64, wanted_pa: impl Fn(f64) -> f64) {
        let period_s = PERIOD as f64 * TICK_S;
        let error_pa = wanted_pa(0.0) - reading_pa;
        let ahead_pa_per_s = (wanted_pa(period_s) - wanted_pa(0.0)) / period_s;
        let rate_pa_per_s = ahead_pa_per_s + PROPORTIONAL_PER_S * error_pa + self.integral_pa_per_s;
        let fills = rate_pa_per_s > 0.0;
        let most_pa_per_s = self.rate_pa_per_s(reading_pa, fills);
        let share = rate_pa_per_s.abs() / most_pa_per_s;
        // A valve that is open for all of the period can do no more: the integral waits.
        if share < 1.0 {
            self.integral_pa_per_s += INTEGRAL_PER_S2 * period_s * error_pa;
        }
        let open_us = (share * period_s * 1e6).min(period_s * 1e6);
        let coil_us = open_us + self.valve.on_delay_us - self.valve.off_delay_us;
        let coil_us = if open_us < SHORTEST_US { 0.0 } else { coil_us.min(period_s * 1e6) };
        self.coils_us = if fills { [coil_us, 0.0] } else { [0.0, coil_us] };
    }

    /// Modelled rate of the pressure with an open valve, Pa/s: ISO 6358 through valve and line, into or out of the chamber.
    fn rate_pa_per_s(&self, pressure_pa: f64, fills: bool) -> f64 {
        let inside_pa = ROOM_PA + pressure_pa.max(0.0);
        let (up_pa, down_pa) = if fills { (ROOM_PA + SUPPLY_PA, inside_pa) } else { (inside_pa, ROOM_PA) };
        let conductance = 1.0 / (self.valve.conductance_m3_per_s_pa.powi(-2) + LINE_M3_PER_S_PA.powi(-2)).sqrt();
        let critical = self.valve.critical_ratio;
        let beyond = ((down_pa / up_pa - critical) / (1.0 - critical)).clamp(0.0, 0.999);
        let flow_kg_per_s = conductance * REFERENCE_DENSITY_KG_PER_M3 * up_pa * (1.0 - beyond * beyond).sqrt();
        let index = ((pressure_pa.max(0.0) / STEP_PA) as usize).min(self.volumes_m3.len() - 1);
        let volume_m3 = self.volumes_m3[index];
        EXPONENT * R_AIR * ROOM_K * flow_kg_per_s / volume_m3
    }
}
