//! Why a limb does not do under load what it is planned to do.

use fra_model::State;
use nalgebra::Vector3;

use super::correct::Corrected;
use super::nominal::NoPose;
use crate::goal::{shapes, too_near};
use crate::plan::PlannedPhase;
use softlimb_limb::Limb;
use softlimb_scene::{Goal, Phase, Scene, SceneError, Span};

/// Points looked at between two of a centre line.
const BETWEEN: usize = 4;
/// A pressure within this share of an end of its range is at that end.
const AT_END: f64 = 1e-6;

/// Makes diagnostics of a scene.
pub(super) struct Refusals<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limb: &'a Limb,
}

impl Refusals<'_> {
    /// At a time of the plan, us, the limb does not carry its load.
    pub(super) fn carries_not(&self, phases: &[PlannedPhase], time_us: u64, why: NoPose) -> SceneError {
        let phase = self.phase(phases, time_us);
        let time_s = time_us as f64 * 1e-6;
        let label = match why {
            NoPose::NoEquilibrium => format!("{time_s:.2} s into the run an actuator has no equilibrium"),
            NoPose::Lost(lost) => format!("{time_s:.2} s into the run {lost}"),
            NoPose::Buckles { module, ratio } => {
                let (name, percent) = (&self.limb.modules()[module].name, 100.0 * ratio);
                format!(
                    "{time_s:.2} s into the run a tube of `{name}` carries {percent:.0} % of the load that it buckles at between two plates"
                )
            }
        };
        let title = match time_us {
            0 => "the limb does not carry its own weight at rest",
            _ => "the limb does not carry its load in this phase",
        };
        let help = "let it hang (`base_direction`), give its modules `spacers`, or make it lighter or stiffer; \
                    `[weight]` with `compensated = false` plans without";
        self.scene.diagnostic(phase.span, title, &label, Some(help))
    }

    /// The tip does not get to the goal of a phase under load.
    pub(super) fn out_of_reach(&self, index: usize, nearest: &Corrected, spans_pa: &[f64]) -> SceneError {
        let ends = self.limb.modules().iter().zip(nearest.pressures_pa.iter().zip(spans_pa));
        let ends: Vec<String> = ends
            .filter_map(|(module, (pressure, span))| match pressure / span {
                share if share < AT_END => Some(format!("`{}` has no pressure left", module.name)),
                share if share > 1.0 - AT_END => Some(format!("`{}` is at its highest pressure", module.name)),
                _ => None,
            })
            .collect();
        let because =
            if ends.is_empty() { "no pressures of its modules move the tip there".to_owned() } else { ends.join(", ") };
        let label = format!("under its load the nearest the tip gets is {:.1} mm away: {because}", 1e3 * nearest.off_m);
        let [x, y, z] = <[f64; 3]>::from(nearest.pose.tip_m()).map(|v| v * 1e3);
        let help = format!(
            "the nearest reachable point is [\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]; `[weight]` with `compensated = false` plans without weight"
        );
        let title = "the limb cannot reach this goal under its load";
        self.scene.diagnostic(goal_span(&self.scene.phases()[index]), title, &label, Some(&help))
    }

    /// Holds the centre line of the loaded limb to the clearance from obstacles: points along it at a knot.
    ///
    /// # Errors
    /// A diagnostic at the phase.
    pub(super) fn clear(
        &self,
        phases: &[PlannedPhase],
        time_us: u64,
        (line_m, states): (&[[f64; 3]], &[State<f64>]),
    ) -> Result<(), SceneError> {
        let shapes = shapes(self.scene);
        if shapes.is_empty() {
            return Ok(());
        }
        let required_m = self.scene.limits().clearance_m;
        let radius_m =
            self.limb.modules().iter().zip(states).map(|(module, state)| module.radius_m(state)).fold(0.0, f64::max);
        for (obstacle, shape) in shapes.iter().enumerate() {
            for pair in line_m.windows(2) {
                let [from, to] = [Vector3::from(pair[0]), Vector3::from(pair[1])];
                let least_m = (0..=BETWEEN)
                    .map(|point| shape.distance(&from.lerp(&to, point as f64 / BETWEEN as f64)).distance_m - radius_m)
                    .fold(f64::INFINITY, f64::min);
                if least_m < required_m {
                    let name = &self.scene.obstacles()[obstacle].name.value;
                    let label =
                        format!("{:.2} s into the run {}", time_us as f64 * 1e-6, too_near(name, least_m, required_m));
                    let title = "under its load the limb comes too near an obstacle in this phase";
                    return Err(self.scene.diagnostic(self.phase(phases, time_us).span, title, &label, None));
                }
            }
        }
        Ok(())
    }

    fn phase(&self, phases: &[PlannedPhase], time_us: u64) -> &Phase {
        let index = phases.iter().rposition(|phase| phase.start_us <= time_us).unwrap_or(0);
        &self.scene.phases()[index]
    }
}

/// Where the goal of a phase is written.
fn goal_span(phase: &Phase) -> Span {
    match &phase.goal {
        Goal::Targets(targets) => targets.first().map_or(phase.span, |target| target.value.span),
        Goal::Tip(tip) => tip.span,
        Goal::Inside(region) => region.span,
        Goal::Series(span) => *span,
    }
}
