//! A scene made ready for a device: planned, checked, and turned into what goes over the link.

use std::sync::atomic::AtomicBool;

use softlimb_protocol::Outputs;
use softlimb_sim::{Processor, SimSettings, SimulatedMcu, here};

use super::RunError;
use super::assemble::{Assembler, phase_infos, run_info};
use super::bodied::Laws;
use super::feedback::{Frame, Settings, Task, follow};
use super::observed::Observed;
use super::recording::Bench;
use super::reference::Planned;
use crate::camera::Camera;
use crate::imu::Imus;
use crate::link;
use crate::link::{
    DeviceConfiguration, Event, Knot, LinkError, SampleRequest, Sampling, StreamOptions, Traffic, Transport,
};
use crate::record::{LinkSummary, RunInfo, RunLog, Sample, SwingInfo};
use crate::report::{self, Summary};
use crate::simulate;
use softlimb_limb::{Drive, Limb};
use softlimb_motion as motion;
use softlimb_motion::{ModuleInverse, Plan, Sent, Swing, Vibrations};
use softlimb_scene::{BodyEffects, Corrections, Scene, TrueLimb};

/// Number of the link session. A simulated device is new in every run, so one number serves, and equal runs are equal logs.
pub(super) const SESSION: u16 = 1;

/// Time beyond the link timeout for a device to notice that its last host has gone, us.
const OCCUPIED_MARGIN_US: u64 = 500_000;

/// Origin of the numbers of a run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin {
    /// The simulated device and limb.
    Simulated {
        /// Seed of everything random in it.
        seed: u64,
    },
    /// A device behind a port.
    Device {
        /// When the run began, ns since 1970-01-01 UTC.
        unix_ns: u64,
    },
}

impl Origin {
    /// Seed of a simulated run.
    pub(super) fn seed(self) -> Option<u64> {
        match self {
            Self::Simulated { seed } => Some(seed),
            Self::Device { .. } => None,
        }
    }
}

/// A scene made ready for a device.
pub(crate) struct Prepared<'a> {
    scene: &'a Scene,
    limb: Limb,
    /// Plan of the run.
    plan: Plan,
    inverses: Vec<ModuleInverse>,
    configuration: DeviceConfiguration,
    sent: Sent,
    sampling: Option<Sampling>,
    /// Settings of feedback; `None` without.
    feedback: Option<Settings>,
    laws: Laws,
}

impl<'a> Prepared<'a> {
    /// A plan of a scene with the scene's corrections, checked that a device can follow.
    pub(super) fn planned(scene: &'a Scene, limb: Limb, plan: Plan) -> Result<Self, RunError> {
        let sent = motion::sent(scene, &limb, &plan)?;
        let feedback = Settings::of(scene, &limb, &plan)?;
        Ok(Self { feedback, ..Self::sending(scene, limb, plan, sent)? })
    }

    /// Plans a scene and checks that a device can follow, with the scene's corrections and feedback.
    pub(crate) fn of(scene: &'a Scene) -> Result<Self, RunError> {
        let limb = Limb::new(scene)?;
        let plan = motion::plan(scene, &limb)?;
        Self::planned(scene, limb, plan)
    }

    /// Plans a scene and checks that a device can follow, without the scene's corrections and feedback.
    pub(crate) fn by_model(scene: &'a Scene) -> Result<Self, RunError> {
        let limb = Limb::new(scene)?;
        let plan = motion::plan(scene, &limb)?;
        let sent = Sent::uncorrected(&limb, &plan);
        Self::sending(scene, limb, plan, sent)
    }

    /// The same limb and the same goals, but the setpoints that are sent are corrected.
    pub(crate) fn corrected(&self, corrections: &Corrections) -> Result<Self, RunError> {
        let sent = motion::corrected(self.scene, &self.limb, &self.plan, corrections)?;
        let laws = self.laws.clone();
        Ok(Self { laws, ..Self::sending(self.scene, self.limb.clone(), self.plan.clone(), sent)? })
    }

    fn sending(scene: &'a Scene, limb: Limb, plan: Plan, sent: Sent) -> Result<Self, RunError> {
        let inverses = motion::inverses(scene, &limb)?;
        motion::check_goals(scene, &limb, &plan, &sent, &inverses)?;
        let configuration = crate::configuration(scene, &inverses, &limb);
        let (sampling, feedback, laws) = (None, None, Laws::default());
        Ok(Self { scene, limb, plan, inverses, configuration, sent, sampling, feedback, laws })
    }

    /// The same with samples beside the telemetry, for a line of some baud, if it is one.
    pub(super) fn sampled(mut self, request: SampleRequest, baud: Option<u32>) -> Result<Self, RunError> {
        let cancel = AtomicBool::new(false);
        let options = stream_options(&self.configuration, &self.limb, SESSION, &cancel);
        let traffic = Traffic {
            channels: self.configuration.channels.len(),
            telemetry_us: self.configuration.system.telemetry_period_us,
            knot_us: self.plan.knot_period_us(),
            heartbeat_us: options.heartbeat_us,
        };
        self.sampling = Some(Sampling::new(request, &traffic, baud)?);
        Ok(self)
    }

    /// The scene.
    pub(crate) fn scene(&self) -> &Scene {
        self.scene
    }

    /// The limb by the model.
    pub(crate) fn limb(&self) -> &Limb {
        &self.limb
    }

    /// Plan of the run.
    pub(crate) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Verified error of the pressure that the device finds for each drive, Pa; `None` where one is not looked up in tables.
    pub(crate) fn inverse_errors_pa(&self) -> Option<Vec<f64>> {
        let error_pa = |drive: Drive<'_>| Some(self.inverses[drive.index].error()? * drive.pressure_max_pa);
        self.limb.drives().map(error_pa).collect()
    }

    pub(super) fn info(&self, origin: Origin) -> RunInfo {
        let mut info = run_info(self.scene, &self.limb, phase_infos(self.scene, &self.plan), origin);
        info.feedback = self.feedback.as_ref().map(Settings::observer);
        info.corrections = self.scene.corrections().is_some();
        for object in &mut info.carried {
            object.start_m = Some(self.plan.tip_m(&self.limb, object.from_s * 1e6));
        }
        let can_swing =
            info.seed.is_none() || matches!(self.scene.plant().truth, TrueLimb::Body(BodyEffects { swing: true, .. }));
        // A limb that falls has no vibrations, and its plan was refused before.
        let swings = can_swing.then(|| motion::swings(self.scene, &self.limb, &self.plan).unwrap_or_default());
        for (phase, swing) in info.phases.iter_mut().zip(swings.unwrap_or_default()) {
            let Swing { residual_m, moved: Vibrations { frequency_hz: [frequency_hz, _], .. }, .. } = swing;
            phase.swing = Some(SwingInfo { residual_m, frequency_hz });
        }
        info
    }

    /// What makes samples of a run of the limb of a scene, which need not be the planned one. The seeds are those of a body's specimen and of the
    /// noise of camera and IMUs.
    pub(super) fn assembler<'p>(
        &'p self,
        plant: &'p Scene,
        simulated: &'p Limb,
        (seed, noise): (u64, u64),
    ) -> Assembler<'p> {
        let reference = Planned::new(self.scene, &self.limb, &self.plan);
        let tier = self.plan.weighed().map(|weighed| weighed.tier);
        let camera = self.scene.camera().map(|camera| Camera::new(*camera, noise, seed));
        let imus = self.scene.imu().map(|imu| Imus::new(*imu, self.limb.modules().len(), noise, seed));
        Assembler::new((self.scene, &self.limb), reference, tier, (plant, simulated), (seed, self.laws.clone()))
            .observed_by(camera, imus)
    }

    /// Settings of a session with a device.
    pub(super) fn options<'c>(&self, session: u16, cancel: &'c AtomicBool) -> StreamOptions<'c> {
        let options = stream_options(&self.configuration, &self.limb, session, cancel);
        StreamOptions { sampling: self.sampling, ..options }
    }

    /// Streams the setpoints to a device, corrected by a camera or by IMUs if the scene has such feedback. `on_event` gives their measurements at a report.
    pub(super) fn stream<D: Transport>(
        &self,
        device: &mut D,
        options: &StreamOptions<'_>,
        mut on_event: impl FnMut(&mut D, Event) -> Option<Frame>,
    ) -> Result<link::Summary, LinkError> {
        let Self { scene, limb, plan, sent, .. } = self;
        let Some(settings) = &self.feedback else {
            let knots = wire_knots(plan, sent);
            return link::stream(device, &self.configuration, &knots, options, |device, event| {
                on_event(device, event);
            });
        };
        let task = Task { scene, limb, plan, sent, settings };
        follow(device, (&self.configuration, options), task, on_event)
    }

    /// Runs on a simulated device and keeps the samples in memory: `parts` is the seed of what the limb is, `noise` of what differs from
    /// run to run.
    pub(crate) fn samples(&self, parts: u64, noise: u64) -> Result<Vec<Sample>, RunError> {
        let mut settings = simulate::settings(self.scene, &self.limb, parts);
        (settings.seed, settings.plant.noise_seed) = (noise, noise);
        Ok(self.log(&settings)?.samples)
    }

    /// Runs on a simulated device and keeps the log in memory, without shapes, bodies and counters of the link. The log ends with the schedule:
    /// no figure looks at the venting behind it.
    fn log(&self, settings: &SimSettings) -> Result<RunLog, RunError> {
        let processor: Box<dyn Processor> = Box::new(here());
        let mut device = Observed::new(SimulatedMcu::with_processor(settings, processor)?);
        let seeds = (settings.plant.seed, settings.seed);
        let mut assembler = self.assembler(self.scene, &self.limb, seeds).samples_only();
        let (mut samples, mut faults) = (Vec::new(), Vec::new());
        let cancel = AtomicBool::new(false);
        let options = StreamOptions { vents: false, ..self.options(SESSION, &cancel) };
        let ended = self.stream(&mut device, &options, |device, event| {
            match event {
                Event::Armed { start_us, .. } => assembler.start(start_us),
                Event::Telemetry { message, .. } => {
                    let truth = device.truth_at(message.time_us);
                    let seen = assembler.sample(&message, truth.as_ref())?;
                    faults.extend(seen.faults);
                    samples.push(seen.sample);
                    return Some(seen.frame);
                }
                Event::Fault { message, .. } => faults.push(assembler.fault(&message)),
                _ => {}
            }
            None
        });
        ended.map_err(|cause| RunError::Link(Box::new(cause)))?;
        Ok(RunLog {
            info: self.info(Origin::Simulated { seed: settings.seed }),
            samples,
            faults,
            shapes: Vec::new(),
            bodies: Vec::new(),
            link: LinkSummary::default(),
            peak_chamber_pa: device.peak_chamber_pa(),
            wall_s: None,
            targets: Vec::new(),
            contacts: assembler.contacts(),
            incomplete: None,
        })
    }
}

/// Runs a scene on a simulated limb for each seed, without logs. The figures of merit are those of [`run`](super::run) with that seed. The
/// simulation ends with the schedule: faults and contacts while the limb is vented do not count. Counters of the link are zero. `each` ends
/// the runs by returning `false`.
///
/// # Errors
/// [`RunError`] if the scene cannot run. Errors of a single seed are passed to `each`.
pub fn summaries(
    scene: &Scene,
    seeds: impl IntoIterator<Item = u64>,
    mut each: impl FnMut(u64, Result<Summary, RunError>) -> bool,
) -> Result<(), RunError> {
    let prepared = Prepared::of(scene)?;
    for seed in seeds {
        let settings = simulate::settings(scene, prepared.limb(), seed);
        if !each(seed, prepared.log(&settings).map(|log| report::summary(&log))) {
            break;
        }
    }
    Ok(())
}

/// Settings of a session with a device that has a configuration of a limb.
pub(super) fn stream_options<'c>(
    configuration: &DeviceConfiguration,
    limb: &Limb,
    session: u16,
    cancel: &'c AtomicBool,
) -> StreamOptions<'c> {
    let defaults = StreamOptions::new(session);
    let system = &configuration.system;
    let heartbeat_us = defaults.heartbeat_us.min(u64::from(system.link_timeout_us) / 4);
    // The ramp down takes its time; twice that and the default is long enough.
    let highest_pa = limb.modules().iter().map(|module| module.pressure_max_pa).fold(0.0, f64::max);
    let ramp_us = (highest_pa / f64::from(system.vent_ramp_pa_per_s) * 1e6) as u64;
    let vent_max_us = defaults.vent_max_us + 2 * ramp_us;
    // A host that went away keeps its session for this long.
    let occupied_max_us = u64::from(system.link_timeout_us) + OCCUPIED_MARGIN_US;
    StreamOptions { cancel: Some(cancel), heartbeat_us, vent_max_us, occupied_max_us, ..defaults }
}

/// One setpoint per channel at every knot, and the gripper as the plan has it then.
fn wire_knots(plan: &Plan, sent: &Sent) -> Vec<Knot> {
    let rows = sent.knots().iter().zip(0..);
    let knot = |(values, index): (&Vec<i32>, u64)| {
        let time_us = index * sent.knot_period_us();
        let outputs = Outputs::default().with(Outputs::GRIPPER, plan.is_gripping_at(time_us));
        Knot { time_us, outputs, values: values.clone() }
    };
    rows.map(knot).collect()
}

/// Runs the setpoints of a plan on a simulated device and keeps the samples in memory. `parts` is the seed of what the limb is, `noise` of what
/// differs from run to run.
///
/// # Errors
/// [`RunError`].
pub fn samples(
    scene: &Scene,
    limb: &Limb,
    (plan, sent): (&Plan, &Sent),
    (parts, noise): (u64, u64),
) -> Result<Vec<Sample>, RunError> {
    Prepared::sending(scene, limb.clone(), plan.clone(), sent.clone())?.samples(parts, noise)
}
