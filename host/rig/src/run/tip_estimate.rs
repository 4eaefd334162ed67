//! Estimate of the tip from orientations of the modules' end plates.
//!
//! The turn of a plate against the one before it bends the module's axis to an arc of constant curvature and torsion, of the planned length. The arcs
//! follow each other from the base. The estimate is the planned tip, and the difference between the arcs by measured and by planned orientations. A
//! departure of the nominal limb from constant curvature cancels in it to first order.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use super::solid;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::{Carried, Nominal, Plan, carried, payload_kg};
use softlimb_scene::Scene;
use softlimb_scene::collision::Body;

/// Change of a pressure for a derivative, as a share of its range.
const STEP: f64 = 1e-3;

/// Smallest motion of the estimate in a corrected direction, over that in the best direction. Along a nearly straight limb the orientations hardly
/// change with the tip: a correction there would drive modules against each other, to the ends of their ranges.
const SHOWN: f64 = 0.1;

/// Pressures of the channels, Pa, and mass at the tip, kg.
type Setpoints = (Vec<f64>, f64);

/// A module of the nominal limb.
#[derive(Clone, Copy, Debug)]
struct PlannedModule {
    /// Length of its axis, m.
    length_m: f64,
    /// Length of the rigid parts behind it, m.
    rigid_length_m: f64,
    /// Turn of its end against its start, in the frame of the start, rad.
    turn: Vector3<f64>,
    /// Orientation of its end plate in the frame of the scene.
    orientation: UnitQuaternion<f64>,
}

/// Estimator of the tip from orientations. Its inputs are scene, limb and plan.
pub(super) struct TipEstimate<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    plan: &'a Plan,
    carried: Vec<Carried>,
    /// The nominal limb under load; `None` where the setpoints are not corrected for weight.
    nominal: Option<Nominal<'a>>,
    /// Modules at the latest setpoints.
    last: Option<(Setpoints, Vec<PlannedModule>)>,
}

impl<'a> TipEstimate<'a> {
    pub(super) fn new(scene: &'a Scene, limb: &'a Limb, plan: &'a Plan) -> Self {
        let nominal = plan.weighed().map(|weighed| Nominal::new(scene, limb, weighed.tier));
        Self { scene, limb, plan, carried: carried(scene.phases()), nominal, last: None }
    }

    /// The tip, m, by the orientations of the end plates at a time of the plan, us; `None` where the nominal limb has no shape.
    pub(super) fn tip_m(&mut self, time_us: f64, orientations: &[UnitQuaternion<f64>]) -> Option<Vector3<f64>> {
        let setpoints = self.setpoints(time_us);
        let modules = match self.last.take().filter(|(last, _)| *last == setpoints) {
            Some((_, modules)) => modules,
            None => self.modules(&setpoints)?,
        };
        let planned: Vec<_> = modules.iter().map(|module| module.orientation).collect();
        let [seen_m, planned_m] = [orientations, &planned].map(|ends| arcs_end_m(self.limb.base(), &modules, ends));
        self.last = Some((setpoints, modules));
        Some(Vector3::from(self.plan.tip_m(self.limb, time_us)) + seen_m - planned_m)
    }

    /// As [`motion::planned_slopes`], of the estimate instead of the tip; the first channel of a group has the velocity by all of them. Velocities
    /// are those in the directions that orientations show well.
    pub(super) fn slopes(&mut self, groups: &[(usize, Range<usize>)], time_us: f64) -> Vec<(Vector3<f64>, f64)> {
        let mut slopes = motion::planned_slopes(self.scene, self.limb, self.plan, time_us);
        slopes.iter_mut().for_each(|(velocity, _)| *velocity = Vector3::zeros());
        let setpoints = self.setpoints(time_us);
        let Some(modules) = self.modules(&setpoints) else { return slopes };
        let end_m = |ends: &[PlannedModule]| {
            let ends: Vec<_> = ends.iter().map(|module| module.orientation).collect();
            arcs_end_m(self.limb.base(), &modules, &ends)
        };
        let here_m = end_m(&modules);
        // Motion by the whole range of each group, m.
        let mut motions_m = Vec::with_capacity(groups.len());
        for (drive, channels) in groups {
            let (mut pressures_pa, payload_kg) = setpoints.clone();
            let highest_pa = self.limb.drive(*drive).pressure_max_pa;
            // Towards the middle of the range there is an equilibrium.
            let upwards = pressures_pa[channels.start] < 0.5 * highest_pa;
            let step_pa = if upwards { STEP * highest_pa } else { -STEP * highest_pa };
            pressures_pa[channels.clone()].iter_mut().for_each(|pressure_pa| *pressure_pa += step_pa);
            let moved = self.modules(&(pressures_pa, payload_kg));
            let velocity = moved.map_or_else(Vector3::zeros, |moved| (end_m(&moved) - here_m) / step_pa);
            slopes[channels.start].0 = velocity;
            motions_m.push(velocity * highest_pa);
        }
        let shown = shown(&motions_m);
        slopes.iter_mut().for_each(|(velocity, _)| *velocity = shown * *velocity);
        slopes
    }

    fn setpoints(&self, time_us: f64) -> Setpoints {
        let pressures_pa: Vec<f64> =
            self.plan.states_at(time_us).iter().map(|state| state.pressure_pa.max(0.0)).collect();
        (self.limb.channel_values(&pressures_pa), payload_kg(&self.carried, &self.plan.phases, time_us as u64))
    }

    /// Modules of the nominal limb.
    fn modules(&mut self, (pressures_pa, payload_kg): &Setpoints) -> Option<Vec<PlannedModule>> {
        let states: Vec<_> =
            self.limb.drives().map(|drive| drive.curve.at(pressures_pa[drive.channels.start])).collect();
        let body = match &mut self.nominal {
            None => self.limb.body(&states),
            Some(nominal) => {
                let pose = nominal.at_channels(pressures_pa, *payload_kg).ok()?;
                let mut body = Body::new(self.limb.base());
                self.limb.loaded_shape(&pose.rod, &pose.shape.q, &states, &mut body);
                body
            }
        };
        Some(planned_modules(self.limb, &body))
    }
}

/// Projection on the directions in which motions are at least a share [`SHOWN`] of those in the best one.
fn shown(motions_m: &[Vector3<f64>]) -> Matrix3<f64> {
    let squares = motions_m.iter().map(|motion| motion * motion.transpose()).sum::<Matrix3<f64>>().symmetric_eigen();
    let least = SHOWN * SHOWN * squares.eigenvalues.max();
    let axes = squares.eigenvectors.column_iter().zip(&squares.eigenvalues);
    axes.filter(|(_, square)| **square >= least).map(|(axis, _)| axis * axis.transpose()).sum()
}

/// The modules of a limb with a shape.
fn planned_modules(limb: &Limb, body: &Body) -> Vec<PlannedModule> {
    let mut start = limb.base().rotation;
    let module = |(moving, behind): solid::Part<'_>| {
        // Half of a piece turns by less than half a revolution.
        let turn = moving.iter().map(|piece| {
            let [from, middle] = [0.0, 0.5].map(|share| piece.pose(share).rotation);
            (middle * from.inverse()).scaled_axis() * 2.0
        });
        let turn = start.inverse() * turn.sum::<Vector3<f64>>();
        let orientation = moving.last().map_or(start, |piece| piece.pose(1.0).rotation);
        start = orientation;
        let [length_m, rigid_length_m] =
            [moving, behind].map(|pieces| pieces.iter().map(|piece| piece.length_m()).sum());
        PlannedModule { length_m, rigid_length_m, turn, orientation }
    };
    solid::parts(limb, body).into_iter().map(module).collect()
}

/// End of the chain of arcs that have the orientations of the end plates, m.
fn arcs_end_m(base: &Isometry3<f64>, modules: &[PlannedModule], orientations: &[UnitQuaternion<f64>]) -> Vector3<f64> {
    let mut chain = Body::new(base);
    for (module, orientation) in modules.iter().zip(orientations) {
        let turn = (chain.end().rotation.inverse() * orientation).scaled_axis();
        chain.screw(&nearest(turn, &module.turn), &(Vector3::z() * module.length_m), 0.0);
        chain.rigid(module.rigid_length_m, 0.0);
    }
    chain.end().translation.vector
}

/// The turn of the same rotation that is nearest to another one: whole revolutions do not show in a rotation.
fn nearest(turn: Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let axis = turn.try_normalize(1e-9).or_else(|| to.try_normalize(1e-9)).unwrap_or_default();
    turn + axis * (TAU * ((to - turn).dot(&axis) / TAU).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(name: &str) -> Scene {
        let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        softlimb_scene::load(path).unwrap_or_else(|error| panic!("{}", error.render(false)))
    }

    #[test]
    fn planar_arc_ends_by_its_closed_form() {
        let about_y = |angle: f64| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
        let (length_m, rigid_length_m) = (0.3, 0.05);
        // Beyond half a revolution the plan tells which turn is meant.
        for (bend, planned) in [(0.7, 0.5), (-1.2, -1.0), (2.9, 3.3), (4.0, 3.0), (6.2, 6.0), (1e-7, 0.0)] {
            let module = PlannedModule {
                length_m,
                rigid_length_m,
                turn: Vector3::y() * planned,
                orientation: UnitQuaternion::identity(),
            };
            let end_m = arcs_end_m(&Isometry3::identity(), &[module], &[about_y(bend)]);
            let (sine, cosine) = bend.sin_cos();
            // 1 - cos of a small angle cancels.
            let across = 2.0 * (0.5 * bend).sin().powi(2);
            let expected =
                Vector3::new(across, 0.0, sine) * (length_m / bend) + Vector3::new(sine, 0.0, cosine) * rigid_length_m;
            assert!((end_m - expected).norm() < 1e-9, "{bend}: {end_m} in place of {expected}");
        }
    }

    #[test]
    fn arcs_of_a_limb_of_arcs_end_at_its_tip() {
        for name in ["single-bending", "weightless-b"] {
            let scene = scene(name);
            let limb = Limb::new(&scene).unwrap();
            for share in [0.0, 0.4, 0.9] {
                let states: Vec<_> = limb.drives().map(|drive| drive.curve.at(share * drive.pressure_max_pa)).collect();
                let modules = planned_modules(&limb, &limb.body(&states));
                let ends: Vec<_> = modules.iter().map(|module| module.orientation).collect();
                let apart_m = arcs_end_m(limb.base(), &modules, &ends) - Vector3::from(limb.tip(&states));
                assert!(apart_m.norm() < 1e-9, "{name} at {share}: {apart_m}");
            }
        }
    }

    #[test]
    fn directions_without_motion_are_not_shown() {
        let along = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let shown = shown(&[along(0.1, 0.0, 0.01), along(0.0, 0.05, 0.0), along(0.1, 0.0, -0.01)]);
        assert!((shown - Matrix3::from_diagonal(&along(1.0, 1.0, 0.0))).norm() < 1e-9, "{shown}");
    }

    /// The loaded limb has no arcs of constant curvature.
    #[test]
    fn planned_orientations_give_the_planned_tip_and_others_the_change_of_the_nominal_limb() {
        let scene = scene("loaded/carry-hanging");
        let limb = Limb::new(&scene).unwrap();
        let plan = motion::plan(&scene, &limb).unwrap();
        let mut estimate = TipEstimate::new(&scene, &limb, &plan);
        let time_us = 5.2e6;
        let setpoints = estimate.setpoints(time_us);
        let oriented =
            |modules: Vec<PlannedModule>| modules.iter().map(|module| module.orientation).collect::<Vec<_>>();
        let planned = oriented(estimate.modules(&setpoints).unwrap());
        let planned_m = estimate.tip_m(time_us, &planned).unwrap();
        assert!((planned_m - Vector3::from(plan.tip_m(&limb, time_us))).norm() < 1e-9, "{planned_m}");
        let mut nominal = Nominal::new(&scene, &limb, plan.weighed().unwrap().tier);
        let mut nominal_m =
            |(pressures_pa, payload_kg): &Setpoints| nominal.at_channels(pressures_pa, *payload_kg).unwrap().tip_m();
        let before_m = nominal_m(&setpoints);
        // A bender, a twisting module, and one tube of a straight bundle, whose extension no orientation shows.
        for (channels, share) in [(3..6, 0.2), (0..3, 0.2), (6..7, 0.4)] {
            let (mut pressures_pa, payload_kg) = setpoints.clone();
            pressures_pa[channels.clone()].iter_mut().for_each(|pressure_pa| *pressure_pa += 5e3);
            let moved = (pressures_pa, payload_kg);
            let ends = oriented(estimate.modules(&moved).unwrap());
            let seen_m = estimate.tip_m(time_us, &ends).unwrap() - planned_m;
            let true_m = nominal_m(&moved) - before_m;
            assert!((seen_m - true_m).norm() < share * true_m.norm(), "{channels:?}: {seen_m} of {true_m}");
        }
    }
}
