//! A made-up but plausible run for the tests of the log and the report: a limb of an
//! extending, a bending and an extending module of three channels each. Setpoints are
//! smooth moves between phase targets; pressures follow with a lag, and the limb
//! follows the pressures with a stiffness error.

use fra_model::StateQuantity;
use softlimb_rig::link::PortErrors;
use softlimb_rig::record::{
    Body, ChannelSample, FaultRecord, LinkSummary, ModuleInfo, ModuleSample, OutputSample, PhaseInfo, RunInfo, RunLog,
    Sample, Shape, TargetRecord,
};

/// Sample period, s.
pub(crate) const PERIOD_S: f64 = 0.01;
/// Lag of pressure behind its reference, s.
const LAG_S: f64 = 0.12;
/// Undeformed lengths of the modules, m.
const LENGTH_M: [f64; 3] = [0.20, 0.25, 0.15];
/// Roll of the bending plane about the axis of the base, rad.
const ROLL_RAD: f64 = 0.6;
/// Targets of the modules at the ends of the phases: stretch, rad, stretch.
const TARGETS: [[f64; 3]; 5] =
    [[1.0, 0.0, 1.0], [1.25, 0.6, 1.0], [1.10, 1.3, 1.20], [1.30, 0.9, 1.30], [1.0, 0.0, 1.0]];

/// The run's description: four phases of a 3 s move and a 2 s hold.
pub(crate) fn info() -> RunInfo {
    let module = |name: &str, motion: &str, quantity, first: usize| ModuleInfo {
        name: name.into(),
        motion: motion.into(),
        quantity,
        channels: first..first + 3,
        pressure_limit_pa: Some(150e3),
    };
    let phases = ["reach", "grasp", "lift", "return"].iter().zip(0..).map(|(name, index)| PhaseInfo {
        name: (*name).into(),
        start_s: 5.0 * f64::from(index),
        move_s: 3.0,
        hold_s: 2.0,
        gripper: None,
        region: None,
        nearest: None,
        swing: None,
    });
    RunInfo {
        scene_name: "synthetic-limb".into(),
        scene_text: "schema = 1\nname = \"synthetic-limb\"  # <made up> & small\n".into(),
        tool_version: "0.1.0".into(),
        firmware_version: "0.1.0".into(),
        schema_hash: 0xe306_9283,
        config_hash: 0x0000_00ff,
        seed: Some(u64::MAX),
        start_unix_ns: 0,
        modules: vec![
            module("proximal", "extension", StateQuantity::AxialStretch, 0),
            module("elbow", "bending", StateQuantity::BendAngle, 3),
            module("distal", "extension", StateQuantity::AxialStretch, 6),
        ],
        phases: phases.collect(),
        limb: None,
        solids: Vec::new(),
        clearance_m: None,
        carried: Vec::new(),
        simulated: true,
        weightless: false,
        truth: None,
        feedback: None,
        corrections: false,
        injected_faults: Vec::new(),
    }
}

/// The whole run of 20 s.
pub(crate) fn run() -> RunLog {
    let info = info();
    let mut lagged = TARGETS[0];
    let mut samples = Vec::new();
    let (mut shapes, mut bodies) = (Vec::new(), Vec::new());
    for step in 0..=2000_u32 {
        let time_s = f64::from(step) * PERIOD_S;
        let setpoint = setpoint_at(time_s);
        let ripple = 0.002 * (time_s * 11.0).sin();
        for (value, target) in lagged.iter_mut().zip(setpoint) {
            *value += (target - *value) * PERIOD_S / LAG_S;
        }
        let modelled = lagged.map(|value| value + ripple);
        let achieved = [stiffer(modelled[0], 1.0), modelled[1] * 0.94, stiffer(modelled[2], 1.0)];
        samples.push(sample(time_s, setpoint, modelled, achieved));
        if step % 10 == 0 {
            let line_m = backbone(achieved);
            // Its distance from a post falls and rises again once.
            let nearest = Some((0.012 + 0.01 * (time_s - 9.0).abs(), "post".to_owned()));
            let tip_unloaded_m = Some(tip(achieved));
            bodies.push(Body { time_s, radius_m: vec![0.03; line_m.len()], line_m, nearest, tip_unloaded_m });
        }
        if step % 20 == 0 {
            shapes.push(Shape { time_s, setpoint: backbone(setpoint), achieved: Some(backbone(achieved)) });
        }
    }
    let faults = vec![FaultRecord {
        time_s: 12.34,
        channel: 4,
        code: 1,
        value: -7,
        text: "sensor of channel 4 implausible".into(),
    }];
    let link = LinkSummary {
        frames_sent: 2210,
        frames_received: 4105,
        bytes_sent: 68_510,
        bytes_received: 175_000,
        retransmitted: 3,
        crc_errors: 2,
        telemetry_lost: 1,
        port_errors: Some(PortErrors { overrun: 2, framing: 0, noise: 5, parity: 0, queue_full: 0 }),
    };
    let peak_chamber_pa = (0..9).map(|channel| 90e3 + 1e3 * f64::from(channel)).collect();
    let met = TargetRecord { name: "lift".into(), time_s: Some(12.54), least_m: Some(4.56e-3), held_s: 0.8 };
    let missed = TargetRecord { name: "place".into(), time_s: None, least_m: None, held_s: 0.0 };
    let (wall_s, targets) = (Some(0.25), vec![met, missed]);
    let contacts = Vec::new();
    RunLog { info, samples, faults, shapes, bodies, link, peak_chamber_pa, wall_s, targets, contacts, incomplete: None }
}

fn stiffer(stretch: f64, rest: f64) -> f64 {
    rest + (stretch - rest) * 0.95
}

/// Minimum-jerk move from target to target, then hold.
fn setpoint_at(time_s: f64) -> [f64; 3] {
    let phase = ((time_s / 5.0) as usize).min(3);
    let s = ((time_s - 5.0 * phase as f64) / 3.0).min(1.0);
    let blend = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let (from, to) = (TARGETS[phase], TARGETS[phase + 1]);
    std::array::from_fn(|module| from[module] + (to[module] - from[module]) * blend)
}

/// Gauge pressure that a module needs for a deformation, Pa; made up, monotone.
fn pressure_pa(module: usize, value: f64) -> f64 {
    match module {
        1 => 62e3 * value.max(0.0).powf(0.9),
        _ => 150e3 * (value - 1.0).max(0.0).powf(0.8) * 1.4,
    }
}

fn sample(time_s: f64, setpoint: [f64; 3], modelled: [f64; 3], achieved: [f64; 3]) -> Sample {
    let channels = (0..9).map(|channel| {
        let module = channel / 3;
        let spread = 1.0 + 0.04 * ((channel % 3) as f64 - 1.0);
        let measured = pressure_pa(module, modelled[module]) * spread;
        let reference = pressure_pa(module, setpoint[module]) * spread;
        ChannelSample {
            pressure_pa: (measured / 10.0).round() * 10.0,
            reference_pa: reference,
            duty: ((reference - measured) / 20e3).clamp(-1.0, 1.0),
            status: u8::from(channel == 4 && (12.3..12.5).contains(&time_s)),
            true_pressure_pa: Some(measured + 180.0 * (channel as f64 - 4.0)),
        }
    });
    let modules = (0..3).map(|module| ModuleSample {
        setpoint: setpoint[module],
        modelled: modelled[module],
        achieved: Some(achieved[module]),
    });
    Sample {
        time_s,
        state: 2,
        fault_bits: if time_s >= 12.34 { 1 << 1 } else { 0 },
        supply_pa: 240e3 - 300.0 * time_s,
        valve_supply_v: Some(24.0),
        outputs: OutputSample {
            bits: u8::from((8.0..18.0).contains(&time_s)),
            gripper_closure: Some(((time_s - 8.0) / 0.3).clamp(0.0, 1.0)),
        },
        channels: channels.collect(),
        modules: modules.collect(),
        tip_setpoint_m: tip(setpoint),
        tip_modelled_m: tip(modelled),
        tip_achieved_m: Some(tip(achieved)),
    }
}

fn tip(modules: [f64; 3]) -> [f64; 3] {
    backbone(modules).pop().unwrap_or_default()
}

/// Straight, circular arc, straight: base to tip, m.
fn backbone([proximal, bend_rad, distal]: [f64; 3]) -> Vec<[f64; 3]> {
    let mut points = vec![[0.0; 3]];
    let (mut along, mut across) = (LENGTH_M[0] * proximal, 0.0);
    let place = |along: f64, across: f64| [across * ROLL_RAD.cos(), across * ROLL_RAD.sin(), -along];
    points.push(place(along, across));
    for piece in 0..16 {
        let angle = bend_rad * (f64::from(piece) + 0.5) / 16.0;
        along += LENGTH_M[1] / 16.0 * angle.cos();
        across += LENGTH_M[1] / 16.0 * angle.sin();
        points.push(place(along, across));
    }
    along += LENGTH_M[2] * distal * bend_rad.cos();
    across += LENGTH_M[2] * distal * bend_rad.sin();
    points.push(place(along, across));
    points
}
