//! From telemetry, plan and truth to the samples of the log.

use fra_model::State;
use softlimb_protocol::{Fault, PressureSample, SCHEMA_HASH, Samples, Telemetry};
use softlimb_sim::plant::Truth;

use super::bodied::{Bodied, Laws};
use super::feedback::Frame;
use super::grasp::Grasp;
use super::hanging::{Hanging, Hung};
use super::prepared::Origin;
use super::reference::Reference;
use super::solid;
use crate::camera::Camera;
use crate::imu::Imus;
use crate::link::{DeviceFault, LinkStatistics, valve_supply_v};
use crate::record::{
    Body, ChannelSample, ContactRecord, FaultRecord, LinkSummary, ModuleInfo, ModuleSample, NearestInfo, OutputSample,
    PhaseInfo, Posture, RunInfo, Sample, SampleRow, Shape,
};
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Chain, Drive, Limb, LimbModule};
use softlimb_motion::{Nominal, Plan, Pose};
use softlimb_numerics::statistics::mean;
use softlimb_scene as scene;
use softlimb_scene::{Goal, Gripper, Scene, collision};

/// Log time between two recorded shapes of the whole limb, s.
const SHAPE_PERIOD_S: f64 = 0.2;

/// Log time between two recorded solids of it, s.
const BODY_PERIOD_S: f64 = 0.1;

/// Time between two points of the planned path of the tip, us.
const PATH_PERIOD_US: usize = 200_000;

/// Makes samples of what the device sends.
pub(super) struct Assembler<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    reference: Box<dyn Reference + Send + 'a>,
    true_limb: TrueLimb<'a>,
    /// The simulated gripper; `None` where the scene has none.
    grasp: Option<Grasp>,
    /// The model's limb under load, where setpoints are corrected for weight.
    weighed: Option<Nominal<'a>>,
    camera: Option<Camera>,
    imus: Option<Imus>,
    start_us: Option<u64>,
    next_shape_s: f64,
    next_body_s: f64,
}

/// The simulated limb.
enum TrueLimb<'a> {
    /// The shape that its actuators have without load.
    Free,
    /// The planner's statics of the true actuators.
    Hanging(Hanging<'a>),
    /// Tubes between plates.
    Body(Box<Bodied<'a>>),
}

/// Observations of the limb when a message comes.
pub(super) struct Seen {
    pub(super) sample: Sample,
    /// Measurements of camera and IMUs.
    pub(super) frame: Frame,
    pub(super) shape: Option<Shape>,
    pub(super) body: Option<Body>,
    /// The same, by the model where nobody sees the limb.
    pub(super) shown: Option<Body>,
    /// The limb for viewers: as it was observed, else by the model.
    pub(super) posture: Option<Posture>,
    /// Faults of the limb itself.
    pub(super) faults: Vec<FaultRecord>,
}

impl<'a> Assembler<'a> {
    /// An assembler for the setpoints of a scene's limb and for the simulated limb. `tier` is the statics of the setpoints under load.
    pub(super) fn new(
        (scene, limb): (&'a Scene, &'a Limb),
        reference: impl Reference + Send + 'a,
        tier: Option<Fidelity>,
        (plant, simulated): (&'a Scene, &'a Limb),
        (seed, laws): (u64, Laws),
    ) -> Self {
        let weighed = tier.map(|tier| Nominal::new(scene, limb, tier));
        let true_limb = match plant.plant().truth {
            scene::TrueLimb::Body(effects) => {
                TrueLimb::Body(Box::new(Bodied::new(scene, (plant, simulated), effects, seed, laws)))
            }
            scene::TrueLimb::Simple => {
                Hanging::new(scene, (plant, simulated)).map_or(TrueLimb::Free, TrueLimb::Hanging)
            }
        };
        let grasp = Grasp::new(scene);
        Self {
            scene,
            limb,
            reference: Box::new(reference),
            true_limb,
            grasp,
            weighed,
            camera: None,
            imus: None,
            start_us: None,
            next_shape_s: 0.0,
            next_body_s: 0.0,
        }
    }

    /// The same with a camera that observes the tip, and IMUs on the end plates of the modules.
    pub(super) fn observed_by(self, camera: Option<Camera>, imus: Option<Imus>) -> Self {
        Self { camera, imus, ..self }
    }

    /// The same without shapes and bodies beside the samples.
    pub(super) fn samples_only(self) -> Self {
        Self { next_shape_s: f64::INFINITY, next_body_s: f64::INFINITY, ..self }
    }

    /// Obstacles that stopped the limb so far.
    pub(super) fn contacts(&self) -> Vec<ContactRecord> {
        match &self.true_limb {
            TrueLimb::Body(body) => body.contacts(),
            TrueLimb::Free | TrueLimb::Hanging(_) => Vec::new(),
        }
    }

    /// The trajectory starts at a device time; the first start is the zero of all times.
    pub(super) fn start(&mut self, start_us: u64) {
        self.start_us.get_or_insert(start_us);
    }

    /// The way that the setpoints have for the tip: times, s, and positions, m; empty where it is not known in advance.
    pub(super) fn planned_path(&self) -> Vec<(f64, [f64; 3])> {
        let Some(duration_us) = self.reference.duration_us() else { return Vec::new() };
        let times = (0..duration_us).step_by(PATH_PERIOD_US).chain([duration_us]);
        times.map(|time_us| (time_us as f64 * 1e-6, self.reference.tip_m(time_us))).collect()
    }

    /// The sample of a telemetry message; `None` before the start.
    pub(super) fn sample(&mut self, message: &Telemetry, truth: Option<&Truth>) -> Option<Seen> {
        let time_us = message.time_us.checked_sub(self.start_us?)?;
        let time_s = time_us as f64 * 1e-6;
        let channels = channels(message, truth);
        let modelled: Vec<State<f64>> = self.limb.drives().map(|drive| modelled(&drive, &channels)).collect();
        let achieved: Option<Vec<State<f64>>> =
            truth.map(|truth| self.limb.drives().map(|drive| achieved(&drive, truth)).collect());
        let free = truth.zip(achieved.as_ref()).map(|(truth, states)| self.limb.chain(states, &made(self.limb, truth)));
        let values = self.reference.values_at(time_us);
        let payload_kg = self.reference.payload_kg(time_us);
        let (hung, faults) = match (&mut self.true_limb, truth, &achieved) {
            (TrueLimb::Free, ..) | (_, None, _) | (.., None) => (None, Vec::new()),
            (true_limb, Some(truth), Some(states)) => {
                let held = |grasp: &mut Grasp| grasp.carried_kg(time_us, payload_kg, truth.gripper_closure);
                let (carried_kg, lost) = self.grasp.as_mut().map_or((payload_kg, None), held);
                // An object leaves the tip with its mass.
                let object = self.reference.gripped_at(time_us).filter(|_| carried_kg > 0.0);
                let (hung, faults) = true_limb.at((time_us, carried_kg, object), truth, states);
                (Some(hung), lost.into_iter().chain(faults).collect())
            }
        };
        // Without weight as the actuators are; with it as the limb hangs, and not at all where it has fallen.
        let values_achieved = match &hung {
            Some(hung) => hung.as_ref().map(|hung| hung.values.clone()),
            None => achieved.as_ref().map(|states| measured(self.limb, states)),
        };
        let tip_achieved_m = match &hung {
            Some(hung) => hung.as_ref().map(|hung| hung.tip_m),
            None => free.as_ref().map(Chain::tip),
        };
        let modules = self.limb.drives().enumerate().map(|(index, drive)| ModuleSample {
            setpoint: values[index],
            modelled: drive.measure(&modelled[index]),
            achieved: values_achieved.as_ref().map(|values| values[index]),
        });
        let nominal = self.nominal(payload_kg, &channels);
        let tip_modelled_m = match &nominal {
            None => self.limb.tip(&modelled),
            Some(pose) => pose.as_ref().map_or([f64::NAN; 3], |pose| pose.tip_m().into()),
        };
        let sample = Sample {
            time_s,
            state: message.state.raw(),
            fault_bits: message.fault_bits,
            supply_pa: 10.0 * f64::from(message.supply_10pa),
            valve_supply_v: valve_supply_v(message),
            outputs: OutputSample {
                bits: message.outputs.bits(),
                gripper_closure: truth.map(|truth| truth.gripper_closure),
            },
            channels,
            modules: modules.collect(),
            tip_setpoint_m: self.reference.tip_m(time_us),
            tip_modelled_m,
            tip_achieved_m,
        };
        let observed = || match &hung {
            Some(hung) => hung.as_ref().map(|hung| hung.body.clone()),
            None => free.as_ref().map(Chain::body),
        };
        let due = self.imus.as_mut().filter(|imus| imus.are_due(time_s));
        let readings = due.and_then(|imus| {
            let plates = solid::connectors(self.limb, &observed()?);
            Some(imus.readings(time_s, plates.iter().map(|plate| plate.rotation).collect()))
        });
        let tip_m = self.camera.as_mut().zip(tip_achieved_m);
        let tip_m = tip_m.and_then(|(camera, tip_m)| camera.image(time_s, &tip_m.into()));
        let frame = Frame { time_s, tip_m: tip_m.map(Into::into), readings: readings.unwrap_or_default() };
        let (shown, posture) = if time_s >= self.next_body_s {
            self.next_body_s += BODY_PERIOD_S;
            let unloaded = || Some(self.limb.tip(achieved.as_ref()?));
            // The model of a plan that compensates weight has the sag in it.
            let hangs = hung.is_some() && !self.scene.weightless();
            let tip_unloaded_m = if hangs && self.weighed.is_none() { unloaded() } else { None };
            let drawn = match (truth, &nominal) {
                (Some(_), _) => observed(),
                (None, None) => Some(self.limb.body(&modelled)),
                (None, Some(pose)) => pose.as_ref().map(|pose| self.loaded(pose, &modelled)),
            };
            let object = self.reference.object_at(time_us);
            let seen = |body| solid::seen((self.scene, self.limb), body, object, (time_s, tip_unloaded_m));
            let posture = drawn.as_ref().map(|body| solid::posture(self.limb, body, time_s));
            (drawn.map(seen), posture)
        } else {
            (None, None)
        };
        let shape = (time_s >= self.next_shape_s).then(|| {
            self.next_shape_s += SHAPE_PERIOD_S;
            Shape {
                time_s,
                setpoint: self.reference.line_m(time_us),
                achieved: match hung {
                    Some(hung) => hung.map(|hung| hung.line_m),
                    None => free.as_ref().map(Chain::backbone),
                },
            }
        });
        let body = shown.clone().filter(|_| truth.is_some());
        Some(Seen { sample, frame, shape, body, shown, posture, faults })
    }

    /// Samples between the telemetry messages; `None` before the start.
    pub(super) fn samples(&self, message: &Samples) -> Option<SampleRow> {
        let time_us = message.time_us.checked_sub(self.start_us?)?;
        Some(sample_row(message, time_us as f64 * 1e-6))
    }

    /// Pose of the model by the setpoints' statics, and no pose where the nominal limb would fall; `None` without weight.
    fn nominal(&mut self, payload_kg: f64, channels: &[ChannelSample]) -> Option<Option<Pose>> {
        let nominal = self.weighed.as_mut()?;
        let pressures: Vec<f64> = channels.iter().map(|channel| chamber_pa(channel).max(0.0)).collect();
        Some(nominal.at_channels(&pressures, payload_kg).ok())
    }

    /// The model's limb under load as a solid.
    fn loaded(&self, pose: &Pose, states: &[State<f64>]) -> collision::Body {
        let mut body = collision::Body::new(self.limb.base());
        self.limb.loaded_shape(&pose.rod, &pose.shape.q, states, &mut body);
        body
    }

    /// A fault on the clock of the run; one before the start is told at its start.
    pub(super) fn fault(&self, message: &Fault) -> FaultRecord {
        let time_us = self.start_us.map_or(0, |start_us| message.time_us.saturating_sub(start_us));
        FaultRecord {
            time_s: time_us as f64 * 1e-6,
            channel: message.channel,
            code: message.code.raw(),
            value: message.value,
            text: DeviceFault::from(message).to_string(),
        }
    }
}

impl TrueLimb<'_> {
    /// The shape with a mass at the tip, and what happens to the limb; `None` where it has fallen.
    fn at(
        &mut self,
        (time_us, payload_kg, object): (u64, f64, Option<usize>),
        truth: &Truth,
        free: &[State<f64>],
    ) -> (Option<Hung>, Vec<FaultRecord>) {
        match self {
            Self::Free => (None, Vec::new()),
            Self::Hanging(hanging) => hanging.at((time_us, payload_kg), truth, free),
            Self::Body(body) => {
                let (hung, fault) = body.at((time_us, payload_kg, object), truth, free);
                (hung, fault.into_iter().collect())
            }
        }
    }
}

/// Samples of a message whose first one is of `time_s`.
pub(super) fn sample_row(message: &Samples, time_s: f64) -> SampleRow {
    let value = |channel: &PressureSample| {
        (10.0 * f64::from(channel.pressure_10pa), f64::from(channel.duty) / f64::from(i8::MAX))
    };
    SampleRow {
        time_s,
        period_s: f64::from(message.period_us) * 1e-6,
        left_out: message.left_out,
        states: message.samples.iter().map(|sample| sample.state.raw()).collect(),
        channels: message.samples.iter().map(|sample| sample.channels.iter().map(value).collect()).collect(),
    }
}

/// Measurements of the channels, with the truth where it is known.
pub(super) fn channels(message: &Telemetry, truth: Option<&Truth>) -> Vec<ChannelSample> {
    let measured = message.channels.iter().enumerate();
    measured
        .map(|(index, channel)| ChannelSample {
            pressure_pa: 10.0 * f64::from(channel.pressure_10pa),
            reference_pa: 10.0 * f64::from(channel.reference_10pa),
            duty: f64::from(channel.duty) / 127.0,
            status: channel.status.bits(),
            true_pressure_pa: truth.and_then(|truth| truth.channels.get(index)).map(|channel| channel.pressure_pa),
        })
        .collect()
}

/// Pressure of a chamber, Pa; that of the sensor, which sits at the valve, where no one sees into the chamber.
fn chamber_pa(channel: &ChannelSample) -> f64 {
    channel.true_pressure_pa.unwrap_or(channel.pressure_pa)
}

/// The state that the controller's model gives a drive at the mean of its chamber pressures.
fn modelled(drive: &Drive<'_>, channels: &[ChannelSample]) -> State<f64> {
    let members = drive.channels.clone().filter_map(|channel| channels.get(channel));
    drive.curve.at(mean(members.map(chamber_pa)).unwrap_or(0.0))
}

/// The state of a drive whose module holds its actuators together: the mean of theirs, or where plates hold them back their equilibrium.
fn achieved(drive: &Drive<'_>, truth: &Truth) -> State<f64> {
    let members = drive.channels.clone().filter_map(|channel| truth.channels.get(channel));
    let alone = members.map(|member| {
        let actuator = member.parameters.model().ok()?;
        Some((actuator, State { pressure_pa: member.pressure_pa, ..member.shape }))
    });
    let held = || drive.held_back(&alone.collect::<Option<Vec<_>>>()?);
    let mean = mean_state(drive, truth);
    if !drive.is_restrained() {
        return mean;
    }
    // Tubes that lean beyond the series touch: the nominal bundle is at its end there.
    held().unwrap_or_else(|| State { pressure_pa: mean.pressure_pa, ..drive.curve.at(mean.pressure_pa) })
}

fn mean_state(drive: &Drive<'_>, truth: &Truth) -> State<f64> {
    let members = drive.channels.clone().filter_map(|channel| truth.channels.get(channel));
    // The shape lags the chamber by its creep; the pressure is the chamber's own.
    let mut shapes = members.map(|member| State { pressure_pa: member.pressure_pa, ..member.shape });
    let first = shapes.next().unwrap_or_else(|| drive.actuator.rest());
    let (sum, count) = shapes.fold((first, 1.0), |(sum, count), shape| {
        (State::combine([&sum, &shape], |[sum, value]| sum + value), count + 1.0)
    });
    State::combine([&sum], |[sum]| sum / count)
}

/// The states of the segments of each module; none where it is no series.
fn made(limb: &Limb, truth: &Truth) -> Vec<Vec<State<f64>>> {
    let of = |module: &LimbModule| {
        truth.channels.get(module.channels.start).map_or_else(Vec::new, |channel| channel.segments.clone())
    };
    limb.modules().iter().map(of).collect()
}

fn measured(limb: &Limb, states: &[State<f64>]) -> Vec<f64> {
    limb.drives().zip(states).map(|(drive, state)| drive.measure(state)).collect()
}

/// Data of the run as a whole, before the device has told its version and taken its configuration.
pub(super) fn run_info(scene: &Scene, limb: &Limb, phases: Vec<PhaseInfo>, origin: Origin) -> RunInfo {
    let modules = limb.drives().map(|drive| ModuleInfo {
        name: drive.name(),
        motion: drive.motion.name().into(),
        quantity: drive.kind,
        channels: drive.channels.clone(),
        pressure_limit_pa: Some(drive.pressure_max_pa),
    });
    let (seed, start_unix_ns) = match origin {
        // A simulated run has no date: the same run is the same log.
        Origin::Simulated { seed } => (Some(seed), 0),
        Origin::Device { unix_ns } => (None, unix_ns),
    };
    RunInfo {
        scene_name: scene.name().into(),
        scene_text: scene.source_text().into(),
        tool_version: env!("CARGO_PKG_VERSION").into(),
        firmware_version: String::new(),
        schema_hash: SCHEMA_HASH,
        config_hash: 0,
        seed,
        start_unix_ns,
        modules: modules.collect(),
        clearance_m: Some(scene.limits().clearance_m).filter(|clearance_m| *clearance_m > 0.0),
        carried: solid::carried_infos(scene, &phases),
        phases,
        solids: solid::solids(scene),
        limb: Some(solid::drawn_limb(limb)),
        simulated: seed.is_some(),
        // A limb on a device has its weight, whatever the plan says.
        weightless: seed.is_some() && scene.weightless(),
        truth: seed.and_then(|_| scene.plant().truth.label()),
        feedback: None,
        corrections: false,
        injected_faults: Vec::new(),
    }
}

/// The phases of a plan.
pub(super) fn phase_infos(scene: &Scene, plan: &Plan) -> Vec<PhaseInfo> {
    let region = |name: &str| {
        let phase = scene.phases().iter().find(|phase| phase.name.value == name)?;
        let Goal::Inside(region) = &phase.goal else { return None };
        Some(scene.regions().get(region.value)?.name.value.clone())
    };
    let phases = plan.phases.iter().map(|phase| PhaseInfo {
        name: phase.name.clone(),
        region: region(&phase.name),
        start_s: phase.start_us as f64 * 1e-6,
        move_s: phase.move_us as f64 * 1e-6,
        hold_s: phase.hold_us as f64 * 1e-6,
        gripper: phase.gripper.map(|gripper| match gripper {
            Gripper::Open => "open".to_owned(),
            Gripper::Close => "close".to_owned(),
        }),
        nearest: phase.nearest.map(|nearest| NearestInfo {
            obstacle: scene.obstacles()[nearest.obstacle].name.value.clone(),
            distance_m: nearest.distance_m,
            time_s: nearest.time_us as f64 * 1e-6,
        }),
        swing: None,
    });
    phases.collect()
}

/// The link's counters in the terms of the log.
pub(super) fn link_summary(
    statistics: &LinkStatistics,
    (bytes_sent, bytes_received): (u64, u64),
    telemetry_lost: u64,
) -> LinkSummary {
    LinkSummary {
        frames_sent: statistics.frames_sent,
        frames_received: u64::from(statistics.received.accepted),
        bytes_sent,
        bytes_received,
        retransmitted: statistics.messages_repeated + statistics.setpoints_repeated,
        crc_errors: u64::from(statistics.received.crc),
        telemetry_lost,
        port_errors: statistics.port_errors,
    }
}
