//! A designed limb, made again from the numbers of its answer with the model alone.

use fra_model::{Actuator, Link, Load, Motion, Segment, State, Status, Target, tip_pose};
use nalgebra::Vector3;
use softlimb_design::actuators::Geometry;
use softlimb_design::synthesis::{Candidate, Space, Task};

pub(crate) struct Remade<'a> {
    task: &'a Task,
    spaces: &'a [Space],
    actuators: Vec<Actuator<f64>>,
    mounts: Vec<f64>,
}

impl<'a> Remade<'a> {
    pub(crate) fn new(task: &'a Task, spaces: &'a [Space], found: &Candidate) -> Self {
        let actuators = spaces.iter().zip(&found.modules).map(|(space, module)| {
            let geometry = Geometry {
                inner_radius_m: module.inner_radius_m,
                outer_radius_m: module.outer_radius_m,
                length_m: module.length_m,
                angle_rad: module.fiber_angle_rad,
            };
            Actuator::new(&space.segment.parameters(&geometry)).unwrap()
        });
        let mounts = found.modules.iter().map(|module| module.mount_angle_rad).collect();
        Self { task, spaces, actuators: actuators.collect(), mounts }
    }

    fn links(&self, states: Vec<State<f64>>) -> Vec<(Link<f64>, f64)> {
        let count = states.len();
        let link = |(index, state): (usize, State<f64>)| {
            let parameters = self.actuators[index].parameters();
            let reach = self.spaces[index].reach_m;
            let segment = Segment::of_bundle(parameters.motion, parameters.length_m, reach, &state).unwrap();
            let tool = if index + 1 == count { self.task.tool_m[0] } else { 0.0 };
            let rigid_length_m = self.task.connector_m[0] + tool;
            let link = Link { segment, mount_angle_rad: self.mounts[index], rigid_length_m };
            (link, reach + state.outer_radius_m)
        };
        states.into_iter().enumerate().map(link).collect()
    }

    pub(crate) fn at_pressures(&self, pressure_pa: &[f64]) -> Vec<(Link<f64>, f64)> {
        let state = |(actuator, pressure): (&Actuator<f64>, &f64)| {
            let solution = actuator.forward(*pressure, &Load::none()).unwrap();
            assert_eq!(solution.status, Status::Solved);
            solution.state
        };
        self.links(self.actuators.iter().zip(pressure_pa).map(state).collect())
    }

    /// The deformations without pressure.
    pub(crate) fn rest(&self) -> Vec<f64> {
        let of = |actuator: &Actuator<f64>| match actuator.parameters().motion {
            Motion::Extension => 1.0,
            Motion::Expansion => actuator.parameters().outer_radius_m,
            Motion::Bending | Motion::Twisting => 0.0,
        };
        self.actuators.iter().map(of).collect()
    }

    /// The limb on the straight line between two deformations.
    pub(crate) fn at_deformations(&self, from: &[f64], to: &[f64], share: f64) -> Vec<(Link<f64>, f64)> {
        let states = self.actuators.iter().enumerate().map(|(index, actuator)| {
            let value = from[index] + share * (to[index] - from[index]);
            let target = match actuator.parameters().motion {
                Motion::Extension => Target::AxialStretch(value),
                Motion::Expansion => Target::OuterRadius(value),
                Motion::Bending => Target::BendAngle(value.max(0.0)),
                Motion::Twisting => Target::Twist(value),
            };
            let solution = actuator.inverse(target, &Load::none()).unwrap();
            assert_eq!(solution.status, Status::Solved);
            solution.state
        });
        self.links(states.collect())
    }

    pub(crate) fn tip(&self, links: &[(Link<f64>, f64)]) -> Vector3<f64> {
        tip_pose(&self.task.base, links.iter().map(|(link, _)| *link)).translation.vector
    }

    /// By points every 1/150 of each part.
    pub(crate) fn least_clearance(&self, links: &[(Link<f64>, f64)]) -> f64 {
        const POINTS: u32 = 150;
        let mut least = f64::INFINITY;
        let mut pose = self.task.base;
        for (index, (link, radius)) in links.iter().enumerate() {
            for step in 0..=POINTS {
                let share = f64::from(step) / f64::from(POINTS);
                let point = (pose * link.pose_at(share)).translation.vector;
                least = least.min(self.distance(&point) - radius);
                let end = pose * link.pose_at(1.0);
                let along = share * link.rigid_length_m;
                let point = end.translation.vector + end.rotation * Vector3::z() * along;
                let tool = index + 1 == links.len() && along > self.task.connector_m[0];
                let radius = if tool { self.task.tool_m[1] } else { self.task.connector_m[1] };
                least = least.min(self.distance(&point) - radius);
            }
            pose *= link.pose();
        }
        least
    }

    fn distance(&self, point: &Vector3<f64>) -> f64 {
        let distances = self.task.obstacles.iter().map(|obstacle| obstacle.shape.distance(point).distance_m);
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Bounds of geometry and pressure, and the margin to the limit point.
    pub(crate) fn within_bounds(&self, found: &Candidate) {
        let within = |value: f64, [low, high]: [f64; 2]| {
            assert!(value >= low - 1e-12 && value <= high + 1e-12, "{value} is not within {low} to {high}");
        };
        for (index, module) in found.modules.iter().enumerate() {
            let segment = &self.spaces[index].segment;
            within(module.inner_radius_m, segment.bounds.sizes_m[0]);
            within(module.outer_radius_m - module.inner_radius_m, segment.bounds.sizes_m[1]);
            within(module.length_m, segment.bounds.length_m);
            if segment.motion != Motion::Bending {
                within(module.fiber_angle_rad, segment.bounds.angle_rad);
            }
            for answer in &found.way_points {
                within(answer.pressure_pa[index], [0.0, segment.pressure_max_pa * (1.0 + 1e-12)]);
                let beyond = answer.pressure_pa[index] / (1.0 - segment.limit_margin) * (1.0 - 1e-9);
                let solution = self.actuators[index].forward(beyond, &Load::none()).unwrap();
                assert_eq!(solution.status, Status::Solved, "the margin to the limit point is kept");
            }
        }
    }
}
