//! A scene: the largest load at the tip in every pose, what it takes and what ends it; the push of four designs.

use std::path::Path;

use fra_model::{Motion, State};

use super::Payload;
use super::report::{Pose, Report};
use crate::cli::kept::write;
use crate::cli::{Failure, Outcome, note, say};
use softlimb_design::blocked::{blocked_designs, picture};
use softlimb_limb::Limb;
use softlimb_limb::payload::{LoadCase, capacity, held_limb};
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Standard gravity, down in the scene's frame, m/s2.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.80665];

pub(super) fn run(command: &Payload, file: &Path) -> Result<Outcome, Failure> {
    let case = case(command)?;
    let scene = scene::load(file)?;
    let limb = Limb::new(&scene)?;
    let plan = motion::plan(&scene, &limb)?;
    let rest = limb.modules().iter().map(|module| module.curve.states()[0]).collect();
    let mut shapes: Vec<(String, Vec<State<f64>>)> = vec![("at rest".into(), rest)];
    for phase in &plan.phases {
        let states = limb.modules().iter().zip(&phase.values).map(|(module, value)| module.state_at(*value));
        shapes.extend(states.collect::<Option<Vec<_>>>().map(|states| (phase.name.clone(), states)));
    }
    let poses = shapes.into_iter().map(|(name, states)| pose(&scene, &limb, name, &states, &case));
    let poses = poses.collect::<Result<Vec<_>, Failure>>()?;
    let straight = limb.modules().iter().find(|module| matches!(module.motion, Motion::Extension | Motion::Expansion));
    let designs = match straight {
        Some(module) => blocked_designs(module).map_err(Failure::new)?.map(|found| (module.name.clone(), found)),
        None => None,
    };
    let report = Report { scene: &scene, limb: &limb, case, poses, designs };
    if command.json {
        say(&report.json().to_string())?
    } else {
        say(&report.table())?
    }
    match (&command.svg, &report.designs) {
        (Some(file), Some((name, designs))) => write(file, &picture(name, designs))?,
        (Some(_), None) => return Err(Failure::new("--svg: the scene has no module that extends or expands")),
        (None, _) => {}
    }
    let fallen = report.poses.iter().filter(|pose| !pose.holds()).count();
    if fallen > 0 {
        note(&format!(
            "warning: in {fallen} of {} poses pressures cannot hold the limb's own weight",
            report.poses.len()
        ));
        return Ok(Outcome::DoneWithWarnings);
    }
    Ok(Outcome::Done)
}

fn case(command: &Payload) -> Result<LoadCase, Failure> {
    let &[x, y, z] = &command.direction[..] else {
        let count = command.direction.len();
        return Err(Failure::wrong_line(format!("--direction has {count} values: three are wanted, X,Y,Z")));
    };
    let length = (x * x + y * y + z * z).sqrt();
    if !(length.is_finite() && length > 0.0) {
        return Err(Failure::wrong_line(format!(
            "--direction {x},{y},{z} is not allowed: a finite direction of length > 0"
        )));
    }
    let share = command.buckling_share;
    if !(share > 0.0 && share <= 1.0) {
        return Err(Failure::wrong_line(format!("--buckling-share = {share} is not allowed: > 0, at most 1")));
    }
    Ok(LoadCase { direction: [x, y, z], gravity_m_per_s2: GRAVITY, spacers: command.spacers, buckling_share: share })
}

fn pose(scene: &Scene, limb: &Limb, name: String, states: &[State<f64>], case: &LoadCase) -> Result<Pose, Failure> {
    let holding = held_limb(scene, limb, states, case).map_err(Failure::new)?;
    let free = LoadCase { buckling_share: f64::INFINITY, ..*case };
    let unbuckled = held_limb(scene, limb, states, &free).map_err(Failure::new)?;
    let unbalanced = holding.unbalanced().map_err(Failure::new)?;
    let unbalanced = unbalanced.into_iter().map(str::to_owned).collect();
    Ok(Pose {
        name,
        unbalanced,
        own: capacity(&holding.own_weight()).map_err(Failure::new)?,
        found: capacity(&holding.question).map_err(Failure::new)?,
        unbuckled: capacity(&unbuckled.question).map_err(Failure::new)?,
        holding,
    })
}
