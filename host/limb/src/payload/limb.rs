//! A limb in a pose: what every bundle has to balance, from the tip to the base.
//!
//! A module is cut at its near end: its own walls and all that follows hang on it. Balanced by pressure are the axial force and the two
//! bending moments of a bundle that extends or expands, the three moments of one that twists, and the moment in the plane of the bend of
//! one that bends. The bent tubes of a steering module turn back by their bending stiffness, too. The rest, shear before all, is left to the walls, and the pose taken for what it is: how far a limb sags is no question here.

use fra_model::{Link, State};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, Vector6};

use super::bundle::{PayloadError, require};
use super::capacity::{LoadQuery, capacity};
use super::held::Held;
use super::program::Outcome;
use crate::{Limb, LimbModule};
use softlimb_scene::Scene;

/// What a load case takes besides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadCase {
    /// Direction of the load at the tip, in the scene's frame; not zero.
    pub direction: [f64; 3],
    /// Gravity in the scene's frame, m/s2.
    pub gravity_m_per_s2: [f64; 3],
    /// Spacers in each module in place of its own; `None` for its own.
    pub spacers: Option<u32>,
    /// The share of the load that a bay buckles at which a push may reach, > 0; infinite for no such limit.
    pub buckling_share: f64,
}

/// What a module has to hold in a pose, and its buckling loads.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleLoad {
    /// Its name in the scene.
    pub name: String,
    /// Moment of the weights alone about its near end, N m.
    pub weight_moment_nm: f64,
    /// Moment of one newton at the tip there, N m/N.
    pub arm_m: f64,
    /// Force that each actuator buckles at between two spacers, both ends clamped, N; none for a bending module.
    pub critical_n: Vec<f64>,
    /// Whether its highest pressure is the limit point of the free actuator and not what the scene allows.
    pub ends_at_limit_point: bool,
}

/// A limb in a pose as a question for its largest load.
#[derive(Clone, Debug)]
pub struct LimbCapacity {
    /// The bundles.
    pub question: LoadQuery,
    /// The modules, in the order of the bundles.
    pub modules: Vec<ModuleLoad>,
    /// Weight of elastomer, connectors and end effector, N.
    pub weight_n: f64,
    /// The tip, m, in the scene's frame.
    pub tip_m: [f64; 3],
}

/// Masses at their places, m in the scene's frame, in order from the base.
type Masses = Vec<(f64, Point3<f64>)>;

/// The question of a limb in a pose: in states, one a drive.
///
/// # Errors
/// [`PayloadError`] for a load case out of range, or a module that no pressure balances in this pose.
pub fn limb_capacity(
    scene: &Scene,
    limb: &Limb,
    states: &[State<f64>],
    case: &LoadCase,
) -> Result<LimbCapacity, PayloadError> {
    let direction = Vector3::from(case.direction);
    let length = direction.norm();
    require(length.is_finite() && length > 0.0, "direction", length, "a finite direction of length > 0")?;
    require(case.buckling_share > 0.0, "buckling_share", case.buckling_share, "> 0, or infinite")?;
    let gravity = Vector3::from(case.gravity_m_per_s2);
    require(gravity.norm().is_finite(), "gravity_m_per_s2", gravity.norm(), "finite")?;
    require(states.len() == limb.drives().len(), "states", states.len() as f64, "one for each setpoint")?;
    let several = limb.modules().iter().map(|module| module.segments().len()).max().unwrap_or_default();
    require(several == 0, "segments", several as f64, "modules of one segment")?;
    let links: Vec<Link<f64>> = limb.links(states).map(|(_, link, _)| link).collect();
    let (poses, masses) = chain(scene, limb, &links);
    let tip = poses[links.len()] * Point3::origin();
    let mut holding = LimbCapacity {
        question: LoadQuery { bundles: Vec::new(), arm_m: 1.0 },
        modules: Vec::new(),
        weight_n: scene.mass_kg() * gravity.norm(),
        tip_m: tip.coords.into(),
    };
    for (index, module) in limb.modules().iter().enumerate() {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), module.mount_angle_rad());
        let frame = Isometry3::from_parts(poses[index].translation, poses[index].rotation * turn);
        let wrench = |force: &Vector3<f64>, at: &Point3<f64>| {
            let (force, at) = (frame.inverse_transform_vector(force), frame.inverse_transform_point(at));
            let moment = at.coords.cross(&force);
            Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
        };
        let constant = masses[index..].iter().flatten().map(|(kg, at)| wrench(&(gravity * *kg), at)).sum();
        let per_load = wrench(&(direction / length), &tip);
        let spacers = case.spacers.unwrap_or_else(|| scene.modules()[index].spacers.into());
        let held = Held { module, states: &states[limb.drives_of(index)], link: &links[index] };
        let (station, critical_n) = held.station(constant, per_load, (case.buckling_share, spacers))?;
        holding.modules.push(ModuleLoad {
            name: module.name.clone(),
            weight_moment_nm: station.constant.fixed_rows::<3>(3).norm(),
            arm_m: station.per_load.fixed_rows::<3>(3).norm(),
            critical_n,
            ends_at_limit_point: module
                .curve
                .limit_point_pa()
                .is_some_and(|limit_pa| limit_pa < module.reference_max_pa),
        });
        holding.question.bundles.push(station);
    }
    let radius = limb.modules().iter().map(LimbModule::reach_m).fold(0.0, f64::max);
    holding.question.arm_m = if radius > 0.0 { radius } else { 0.01 };
    Ok(holding)
}

impl LimbCapacity {
    /// The same limb asked for the largest multiple of its own weights that it holds without any other load.
    pub fn own_weight(&self) -> LoadQuery {
        let mut question = self.question.clone();
        for bundle in &mut question.bundles {
            bundle.per_load = std::mem::replace(&mut bundle.constant, Vector6::zeros());
        }
        question
    }

    /// Names of the modules that no pressures balance, whatever the load.
    ///
    /// # Errors
    /// As [`capacity`](super::capacity()).
    pub fn unbalanced(&self) -> Result<Vec<&str>, PayloadError> {
        let mut names = Vec::new();
        for (bundle, module) in self.question.bundles.iter().zip(&self.modules) {
            let alone = LoadQuery { bundles: vec![bundle.clone()], arm_m: self.question.arm_m };
            if capacity(&alone)?.outcome == Outcome::Infeasible {
                names.push(module.name.as_str());
            }
        }
        Ok(names)
    }
}

/// Poses of the near ends of the modules and of the tip, and the masses of each module with its rigid part.
fn chain(scene: &Scene, limb: &Limb, links: &[Link<f64>]) -> (Vec<Isometry3<f64>>, Vec<Masses>) {
    let (mut poses, mut masses) = (vec![*limb.base()], Vec::new());
    let last = limb.modules().len() - 1;
    for (index, (module, link)) in limb.modules().iter().zip(links).enumerate() {
        let start = poses[index];
        let [connector_m, tool_m] = module.rigid_parts_m();
        let end = start * link.pose_at(1.0);
        let walls = scene.modules()[index].mass_kg();
        // Simpson's rule along the arc.
        let share = |share: f64, weight: f64| (walls * weight, start * link.pose_at(share) * Point3::origin());
        let behind = |z: f64| end * Point3::new(0.0, 0.0, z);
        let mut own = vec![share(0.0, 1.0 / 6.0), share(0.5, 4.0 / 6.0), share(1.0, 1.0 / 6.0)];
        own.push((scene.limb().connector_mass_kg, behind(0.5 * connector_m)));
        if let Some(tool) = scene.limb().end_effector.as_ref().filter(|_| index == last) {
            own.push((tool.mass_kg, behind(connector_m + 0.5 * tool_m)));
        }
        masses.push(own);
        poses.push(start * link.pose());
    }
    (poses, masses)
}
