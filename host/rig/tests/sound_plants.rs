//! Sound plants of every shipped scene: valves, restrictors, volumes, supplies and sensors of the scene, spread as wide as workshops make them. No
//! fault is reported, whatever pressures the device follows.

use std::path::{Path, PathBuf};

use crate::samples::samples;
use softlimb_limb::Limb;
use softlimb_protocol::{ConfigChannel, ConfigVolume, FaultCode, Outputs, SetpointKind};
use softlimb_rig::link::{DeviceConfiguration, Event, Knot, StreamOptions, stream};
use softlimb_rig::{configuration, simulate};
use softlimb_scene::Scene;
use softlimb_sim::plant::{MotionSettings, Spread, Supply};
use softlimb_sim::{SimSettings, SimulatedMcu};

/// Time between two knots, us; length of a run, s.
const KNOT_US: u64 = 20_000;
const LENGTH_S: f64 = 30.0;

/// Plants of each scene.
const PLANTS: u32 = 40;

/// Standard deviations of the widest spread: volumes to 30 %, conductances to 20 %, delays to 30 %.
const WIDEST: Spread = Spread {
    modulus: 0.05,
    wall_thickness: 0.02,
    fiber_angle_rad: 0.009,
    volume: 0.1,
    dead_volume: 0.2,
    valve_conductance: 0.067,
    valve_delay: 0.1,
    sensor_offset: 0.003,
    sensor_gain: 0.002,
};

/// Leak, m3/(s Pa), and amplitude of the motion, m3, of a chamber of 80 mL; smaller chambers have less of both, larger ones more motion.
const REFERENCE_M3: f64 = 80e-6;
const LEAK: f64 = 1e-12;
const MOTION_M3: f64 = 0.7e-6;

/// Highest pressure of the references over the limit, and largest change of it from knot to knot: the device takes no faster one.
const HIGHEST: f64 = 0.9;
const CHANGE: f64 = 0.12;

/// All scenes, those without a design too.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = ["", "open", "loaded"].into_iter().flat_map(|name| std::fs::read_dir(folder.join(name)).unwrap());
    let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    assert!(paths.len() >= 15, "{paths:?}");
    paths
}

/// One channel of each module of a scene, driven by pressures.
struct Bench {
    scene: Scene,
    limb: Limb,
    /// Numbers of the channels in the limb.
    channels: Vec<usize>,
    configuration: DeviceConfiguration,
    /// Highest pressure of each reference, Pa.
    highest_pa: Vec<f64>,
}

impl Bench {
    fn new(path: &Path) -> Self {
        let scene = softlimb_scene::load(path).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let limb = Limb::new(&scene).expect("a limb");
        let inverses = softlimb_motion::inverses(&scene, &limb).expect("tables");
        let whole = configuration(&scene, &inverses, &limb);
        let channels: Vec<_> = limb.modules().iter().map(|module| module.channels.start).collect();
        let channel = |number: &usize| {
            let channel = whole.channels[*number].clone();
            let setpoint_max = channel.pressure_max_pa as i32;
            ConfigChannel { setpoint_kind: SetpointKind::Pressure.into(), setpoint_min: 0, setpoint_max, ..channel }
        };
        let volume = |(number, channel): (&usize, u8)| {
            let volume = whole.volumes.iter().find(|volume| usize::from(volume.channel) == *number)?;
            Some(ConfigVolume { channel, ..volume.clone() })
        };
        let configuration = DeviceConfiguration {
            system: whole.system.clone(),
            channels: channels.iter().map(channel).collect(),
            volumes: channels.iter().zip(0..).filter_map(volume).collect(),
            inverses: Vec::new(),
        };
        // Some templates of a design burst below the limit of their scene.
        let highest_pa = limb.modules().iter().map(|module| {
            let states = module.curve.states().iter();
            HIGHEST * states.map(|state| state.pressure_pa).fold(0.0, f64::max).min(module.pressure_max_pa)
        });
        let highest_pa = highest_pa.collect();
        Self { scene, limb, channels, configuration, highest_pa }
    }

    /// The plant of a seed.
    fn plant(&self, seed: u64) -> SimSettings {
        let mut settings = simulate::settings(&self.scene, &self.limb, seed);
        let plant = &mut settings.plant;
        plant.spread = WIDEST;
        let pressure_pa = match plant.supply {
            Supply::Regulated { pressure_pa } => pressure_pa,
            Supply::Pump(pump) => pump.initial_pressure_pa,
        };
        // As it is, or halfway to an end of the range that the device takes.
        let system = &self.configuration.system;
        let ends_pa = [system.supply_min_pa, system.supply_max_pa].map(f64::from);
        let pressures_pa = [pressure_pa, 0.5 * (pressure_pa + ends_pa[0]), 0.5 * (pressure_pa + ends_pa[1])];
        plant.supply = Supply::Regulated { pressure_pa: pressures_pa[seed as usize % 3] };
        plant.channels = self.channels.iter().map(|number| plant.channels[*number].clone()).collect();
        for (channel, index) in plant.channels.iter_mut().zip(0..) {
            let (radius_m, length_m) = (channel.actuator.inner_radius_m, channel.actuator.length_m);
            let size = std::f64::consts::PI * radius_m * radius_m * length_m / REFERENCE_M3;
            channel.creep_share = [0.15, 0.06][(seed / 2 + index) as usize % 2];
            channel.leak_m3_per_s_pa = LEAK * size.min(1.0);
            let amplitude_m3 = if (seed + index).is_multiple_of(2) { MOTION_M3 * size } else { 0.0 };
            channel.motion = MotionSettings { amplitude_m3, frequency_hz: 2.0 };
        }
        settings
    }

    /// Reference of a channel, 0 to 1 of its highest pressure.
    fn share(seed: u64, channel: usize, time_s: f64) -> f64 {
        let turn = seed as f64 + 1.7 * channel as f64;
        match seed % 4 {
            // Steps of 0.3 s, and rests.
            3 => {
                let level = |step: f64| 0.5 + 0.5 * (2.4 * step + turn).sin();
                let step = (time_s / 2.5).floor();
                let share = ((time_s - 2.5 * step) / 0.3).min(1.0);
                level(step - 1.0) + share * (level(step) - level(step - 1.0))
            }
            // The same, faster than any valve, and long rests.
            1 => {
                let level = |step: f64| 0.5 + 0.5 * (2.4 * step + turn).sin();
                level((time_s / 6.0).floor())
            }
            // Two sines, and a rest of 4 s in 16 s.
            _ => {
                let moved_s = 12.0 * (time_s / 16.0).floor() + (time_s % 16.0).min(12.0);
                let (slow, fast) = (0.7 * moved_s + turn, (1.5 + turn % 3.0) * moved_s + 2.0 * turn);
                0.5 + 0.31 * slow.sin() + 0.19 * fast.sin()
            }
        }
    }

    fn knots(&self, seed: u64) -> Vec<Knot> {
        let mut last = vec![0.0; self.channels.len()];
        let knot = |index: u64| {
            let time_us = index * KNOT_US;
            for (channel, last) in last.iter_mut().enumerate() {
                *last += (Self::share(seed, channel, time_us as f64 * 1e-6) - *last).clamp(-CHANGE, CHANGE);
            }
            let values = last.iter().zip(&self.highest_pa).map(|(share, highest_pa)| (share * highest_pa) as i32);
            Knot { time_us, outputs: Outputs::default(), values: values.collect() }
        };
        (0..=(LENGTH_S * 1e6) as u64 / KNOT_US).map(knot).collect()
    }

    /// The faults of a run on a plant of a seed, in words.
    fn faults(&self, seed: u64) -> Vec<String> {
        let mut device = SimulatedMcu::new(&self.plant(seed)).expect("sound settings");
        let mut faults = Vec::new();
        let options = StreamOptions::new(1);
        let outcome = stream(&mut device, &self.configuration, &self.knots(seed), &options, |_, event| {
            if let Event::Fault { message, .. } = event
                && message.code.known() != Some(FaultCode::SetpointsExhausted)
            {
                let (code, channel, value) = (message.code, message.channel, message.value);
                faults.push(format!("{code:?}, channel {channel}, {value}"));
            }
        });
        if let Err(error) = outcome
            && faults.is_empty()
        {
            faults.push(error.to_string());
        }
        faults
    }
}

#[test]
fn sound_plants_of_all_scenes_raise_no_fault() {
    let count = u64::from(samples(PLANTS));
    let paths = scenes();
    let faults = |path: &PathBuf| -> Vec<String> {
        let bench = Bench::new(path);
        let name = path.file_stem().expect("a file").to_string_lossy().into_owned();
        let runs = (1..=count).map(|seed| (seed, bench.faults(seed)));
        runs.filter(|(_, faults)| !faults.is_empty())
            .map(|(seed, faults)| format!("{name}, seed {seed}: {faults:?}"))
            .collect()
    };
    let wrong: Vec<_> = std::thread::scope(|scope| {
        let parts: Vec<_> = paths.iter().map(|path| scope.spawn(move || faults(path))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("runs")).collect()
    });
    assert!(wrong.is_empty(), "{wrong:#?}");
}
