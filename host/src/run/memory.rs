//! A run that is kept in memory: the samples of a plan on a simulated limb.

use std::sync::atomic::AtomicBool;

use softlimb_sim::{Processor, SimulatedMcu, here};

use super::assemble::Assembler;
use super::observed::Observed;
use super::{RunError, stream_options, wire_knots};
use crate::design::Limb;
use crate::link::{self, Event};
use crate::motion::{self, Plan};
use crate::record::Sample;
use crate::scene::Scene;
use crate::simulate;

/// Runs a plan on a simulated device. `parts` is the seed of what the limb is, `noise` of what differs from run to run.
///
/// # Errors
/// [`RunError`].
pub fn samples(scene: &Scene, limb: &Limb, plan: &Plan, (parts, noise): (u64, u64)) -> Result<Vec<Sample>, RunError> {
    let inverses = motion::inverses(scene, limb)?;
    motion::check_goals(scene, limb, plan, &inverses)?;
    let configuration = motion::configuration(scene, &inverses, limb);
    let mut settings = simulate::settings(scene, limb, parts);
    (settings.seed, settings.plant.noise_seed) = (noise, noise);
    let processor: Box<dyn Processor> = Box::new(here());
    let mut device = Observed::new(SimulatedMcu::with_processor(&settings, processor)?);
    let mut assembler = Assembler::new(scene, limb, plan);
    let mut samples = Vec::new();
    let cancel = AtomicBool::new(false);
    let options = stream_options(limb, &configuration, &cancel);
    let ended =
        link::stream(&mut device, &configuration, &wire_knots(limb, plan), &options, |device, event| match event {
            Event::Armed { start_us, end_us } => assembler.start(start_us, end_us),
            Event::Telemetry { message, .. } => {
                let truth = device.truth_at(message.time_us);
                samples.extend(assembler.sample(&message, truth.as_ref()).map(|seen| seen.sample));
            }
            _ => {}
        });
    ended.map_err(|cause| RunError::Link(Box::new(cause)))?;
    Ok(samples)
}
