//! From parameters to measured points: a deck, a run, and what it says.

use super::ccx::{End, Runner, drive};
use super::dat::Progress;
use super::options::pressures;
use super::outcome::{Run, reduce};
use super::{Deck, FemError, Model, Options, Subject};

/// Runs are tried again with half the increment so often where an iterate overstretched a fiber.
const RETRIES: u32 = 2;
/// Smallest share of the load that is tried as the largest increment.
const SMALLEST_SHARE: f64 = 0.001;

/// Progress of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunProgress {
    /// Share of the pressures, 0 to 1.
    pub share: f64,
    /// Increments that converged.
    pub increments: u32,
    /// Iterations.
    pub iterations: u32,
}

/// Runs CalculiX on one actuator or a bundle under rising gauge pressures, Pa. `clock` tells seconds from any beginning; `watch` is told
/// the progress some times a second.
///
/// # Errors
/// [`FemError`] where the input is refused, or the run left nothing that can be trusted. A run that ends before the last pressure is no
/// error: its points say so.
pub fn run(
    subject: &Subject,
    options: &Options,
    pressures_pa: &[f64],
    runner: &Runner,
    clock: &dyn Fn() -> f64,
    watch: &mut dyn FnMut(RunProgress),
) -> Result<Run, FemError> {
    pressures(pressures_pa)?;
    let (mut options, mut spent) = (*options, 0.0);
    let steps = pressures_pa.len() as f64;
    let mut tell = |now: Progress| {
        watch(RunProgress { share: now.time / steps, increments: now.increments, iterations: now.iterations });
    };
    let mut tries = 0;
    loop {
        let model = Model::new(subject, &options)?;
        let deck = Deck::new(&model, "actuator", pressures_pa)?;
        let raw = drive(runner, &deck, clock, &mut tell)?;
        if matches!(raw.end, End::Diverged { overstretched: true, .. }) && tries < RETRIES {
            (tries, spent) = (tries + 1, spent + raw.seconds);
            options.increment = Some((0.5 * model.increment()).max(SMALLEST_SHARE));
            continue;
        }
        let reduced = reduce(model, pressures_pa, &raw, subject.parameters.inner_radius_m);
        let mut run = reduced.map_err(|error| error.blaming(raw.disk_is_full))?;
        run.seconds += spent;
        run.points.iter_mut().for_each(|point| point.seconds = point.seconds.map(|seconds| seconds + spent));
        return Ok(run);
    }
}
