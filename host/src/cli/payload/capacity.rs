//! `softlimb payload capacity`: the largest load at the tip in every pose, its pressures and limits; the push of four designs.

use std::path::PathBuf;

use clap::Args;
use fra_model::{Motion, State};

use super::report::{Pose, Report};
use crate::cli::shared::{above_zero, limb, quantity, show_of, write};
use crate::cli::{Failure, Outcome, note};
use softlimb_design::blocked::{blocked_designs, picture};
use softlimb_limb::Limb;
use softlimb_limb::payload::{
    AFFINE, CarriedLoad, CarryLimit, CarryLimits, LoadCase, capacity, carried_load, limb_capacity, polar, polar_picture,
};
use softlimb_motion as motion;
use softlimb_scene::{Quantity, Scene};

/// Standard gravity, down in the scene's frame, m/s2.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.80665];

/// Find the largest load at the tip in every pose of a scene
#[derive(Args)]
#[command(
    name = "capacity",
    after_help = "Terms and limits: docs/explanation/payload.md\n\n\
                        Example: softlimb payload capacity scenes/pick-and-place-a.toml --svg push.svg --polar loads.svg"
)]
pub(super) struct CapacityMode {
    /// The scene file
    scene: PathBuf,
    /// Direction of the load at the tip, in the scene's frame
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 1, default_value = "0,0,-1",
        value_parser = quantity("1", f64::NEG_INFINITY, f64::INFINITY))]
    direction: Vec<Quantity>,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100))]
    spacers: Option<u32>,
    /// Largest push of an actuator over the buckling load of its bay
    #[arg(long, value_name = "RATIO", default_value = "0.5", value_parser = above_zero("1", 1.0))]
    buckling_share: Quantity,
    /// Draw the push of four designs against pressure
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Draw the largest held load against its direction, a diagram for each pose
    #[arg(long, value_name = "FILE")]
    polar: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl CapacityMode {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let case = self.case()?;
        let (scene, limb) = limb(&self.scene)?;
        scene.require_no_segments("`payload capacity`")?;
        limb.require_plane_benders(&scene, "`payload capacity`")?;
        let plan = motion::plan(&scene, &limb)?;
        let rest: Vec<State<f64>> = limb.drives().map(|drive| drive.curve.states()[0]).collect();
        let mut poses = vec![pose(&scene, &limb, "at rest".into(), &rest, &case)?];
        let mut drawn = vec![("at rest".to_owned(), rest)];
        let mut carried = carried(&scene, &limb, &plan, &case).into_iter();
        for phase in &plan.phases {
            let carried = carried.next();
            let states = limb.drives().zip(&phase.values).map(|(drive, value)| drive.state_at(*value));
            if let Some(states) = states.collect::<Option<Vec<_>>>() {
                poses.push(Pose { carried, ..pose(&scene, &limb, phase.name.clone(), &states, &case)? });
                if drawn.iter().all(|(_, known)| *known != states) {
                    drawn.push((phase.name.clone(), states));
                }
            }
        }
        let straight =
            limb.modules().iter().find(|module| matches!(module.motion, Motion::Extension | Motion::Expansion));
        let designs = match straight {
            Some(module) => blocked_designs(module).map_err(Failure::new)?.map(|found| (module.name.clone(), found)),
            None => None,
        };
        let report = Report { scene: &scene, limb: &limb, case, poses, designs };
        show_of(self.json, report.limb, &report.answer(), || report.table())?;
        match (&self.svg, &report.designs) {
            (Some(file), Some((name, designs))) => write(file, &picture(name, designs))?,
            (Some(_), None) => return Err(Failure::new("--svg: the scene has no module that extends or expands")),
            (None, _) => {}
        }
        if let Some(file) = &self.polar {
            let of = |(name, states): &(String, Vec<State<f64>>)| polar(name, (&scene, &limb), states, &case);
            let found = drawn.iter().map(of).collect::<Result<Vec<_>, _>>().map_err(Failure::new)?;
            write(file, &polar_picture(scene.name(), &found))?;
        }
        let mut outcome = Outcome::Done;
        for pose in report.poses.iter().filter(|pose| pose.off() > AFFINE) {
            note(&format!(
                "warning: `held` found no equilibrium for {}: the linearized forces are {:.0} % off the model's",
                pose.name,
                100.0 * pose.off()
            ));
            outcome = Outcome::DoneWithWarnings;
        }
        // Where the plan has weight, the statics decide.
        let short: Vec<&str> =
            report.poses.iter().filter(|pose| pose.falls_short()).map(|pose| pose.name.as_str()).collect();
        if !short.is_empty() {
            note(&format!("warning: the limb does not keep its margins with the payload of {}", short.join(", ")));
            return Ok(Outcome::DoneWithWarnings);
        }
        let fallen = report.poses.iter().filter(|pose| !pose.holds()).count();
        if fallen > 0 && report.poses.iter().all(|pose| pose.carried.is_none()) {
            note(&format!(
                "warning: in {fallen} of {} poses pressures cannot hold the limb's own weight",
                report.poses.len()
            ));
            return Ok(Outcome::DoneWithWarnings);
        }
        Ok(outcome)
    }

    fn case(&self) -> Result<LoadCase, Failure> {
        let direction: Vec<f64> = self.direction.iter().map(Quantity::si).collect();
        let &[x, y, z] = &direction[..] else {
            let count = direction.len();
            return Err(Failure::wrong_line(format!("--direction has {count} values: three are required, X,Y,Z")));
        };
        let length = (x * x + y * y + z * z).sqrt();
        if !(length.is_finite() && length > 0.0) {
            return Err(Failure::wrong_line(format!(
                "--direction {x},{y},{z} is not allowed: a finite direction of length > 0"
            )));
        }
        Ok(LoadCase {
            direction: [x, y, z],
            gravity_m_per_s2: GRAVITY,
            spacers: self.spacers,
            buckling_share: self.buckling_share.si(),
        })
    }
}

/// The largest payload at the place of each phase by the statics; none for other directions than down, or without weight.
fn carried(scene: &Scene, limb: &Limb, plan: &motion::Plan, case: &LoadCase) -> Vec<Result<CarriedLoad, CarryLimit>> {
    let [x, y, z] = case.direction;
    let down = x == 0.0 && y == 0.0 && z < 0.0 && case.spacers.is_none();
    let Some(weight) = scene.weight().filter(|weight| weight.simulated && down) else { return Vec::new() };
    let standing = scene.limits().standing;
    let limits = CarryLimits {
        error: weight.error,
        load_factor_min: standing.load_factor,
        buckling_margin_min: standing.buckling_margin,
        pressure_share_max: standing.pressure_share,
    };
    let of_phase = |(phase, carried): (&motion::PlannedPhase, motion::Carried)| {
        // What is put down is carried until the end of the move, what is taken up from the end of the hold on.
        let hold_us = if carried.moved.payload_kg > carried.held.payload_kg { 0 } else { phase.hold_us };
        let states = plan.states_at((phase.start_us + phase.move_us + hold_us) as f64);
        let pressures_pa: Vec<f64> = states.iter().map(|state| state.pressure_pa.max(0.0)).collect();
        carried_load(scene, limb, (&pressures_pa, carried.payload_kg()), &limits)
    };
    plan.phases.iter().zip(motion::carried(scene.phases())).map(of_phase).collect()
}

fn pose(scene: &Scene, limb: &Limb, name: String, states: &[State<f64>], case: &LoadCase) -> Result<Pose, Failure> {
    let holding = limb_capacity(scene, limb, states, case).map_err(Failure::new)?;
    let free = LoadCase { buckling_share: f64::INFINITY, ..*case };
    let unbuckled = limb_capacity(scene, limb, states, &free).map_err(Failure::new)?;
    let unbalanced = holding.unbalanced().map_err(Failure::new)?;
    let unbalanced = unbalanced.into_iter().map(str::to_owned).collect();
    Ok(Pose {
        name,
        carried: None,
        unbalanced,
        own: capacity(&holding.own_weight()).map_err(Failure::new)?,
        found: capacity(&holding.question).map_err(Failure::new)?,
        unbuckled: capacity(&unbuckled.question).map_err(Failure::new)?,
        holding,
    })
}
