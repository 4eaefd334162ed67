//! A limb as it will be made, asked of the model and of its kinematics.

use fra_model::{Link, Motion, Segment, State};
use nalgebra::{Isometry3, Vector3};

use super::aim::{MM, missed};
use super::candidate::{ModuleDesign, WayPointAnswer};
use super::points::body_points;
use super::response::Section;
use super::task::{Obstacle, Task, Total, WayPoint};
use softlimb_scene::collision::Body;

/// One module as it will be made.
pub(super) struct Made<'a> {
    pub(super) section: Section<'a>,
    pub(super) density_kg_per_m3: f64,
    pub(super) actuators: u32,
    pub(super) name: &'a str,
    pub(super) mount_angle_rad: f64,
    /// Lengths of the rigid parts behind it, m: connector with ends, and tool.
    pub(super) rigid_m: [f64; 2],
    /// Mass of the connector behind it, kg; 0 before a segment of the same actuator.
    pub(super) rigid_kg: f64,
    /// Lengths of its ends at the base and at the tip, m.
    pub(super) ends_m: [f64; 2],
    /// Whether it is a segment of the actuator before it.
    pub(super) joined: bool,
}

/// The limb in one configuration, by the kinematics of the model.
pub(super) struct Shape {
    pub(super) states: Vec<State<f64>>,
    pub(super) tip: Isometry3<f64>,
    pub(super) body: Body,
    pub(super) links: Vec<(Link<f64>, f64)>,
    /// Where the part of the limb starts that moves.
    start: Isometry3<f64>,
    /// Lengths of the rigid parts behind each module, m.
    rigid_m: Vec<[f64; 2]>,
}

impl Made<'_> {
    /// The pressure of a share, Pa.
    pub(super) fn pressure_pa(&self, share: f64) -> Option<f64> {
        Some(self.section.state(share)?.pressure_pa.max(0.0))
    }

    /// Length of the part that moves, m.
    pub(super) fn length_m(&self) -> f64 {
        self.section.candidate.geometry.length_m
    }

    /// Length with its ends, m.
    fn whole_m(&self) -> f64 {
        self.length_m() + self.ends_m.iter().sum::<f64>()
    }

    pub(super) fn wall_volume_m3(&self) -> f64 {
        let geometry = &self.section.candidate.geometry;
        std::f64::consts::PI * (geometry.outer_radius_m.powi(2) - geometry.inner_radius_m.powi(2)) * self.whole_m()
    }

    pub(super) fn design(&self) -> ModuleDesign {
        let geometry = &self.section.candidate.geometry;
        let elastomer = self.wall_volume_m3() * self.density_kg_per_m3 * f64::from(self.actuators);
        ModuleDesign {
            name: self.name.to_owned(),
            motion: self.section.motion().into(),
            inner_radius_m: geometry.inner_radius_m,
            outer_radius_m: geometry.outer_radius_m,
            length_m: self.whole_m(),
            fiber_angle_rad: geometry.angle_rad,
            windings_rad: self.section.candidate.segment.windings_rad(geometry),
            mount_angle_rad: if self.section.motion() == Motion::Bending { self.mount_angle_rad } else { 0.0 },
            pressure_cap_pa: self.section.cap_pa(),
            mass_kg: elastomer + self.rigid_kg,
        }
    }

    pub(super) fn deformation(&self, state: &State<f64>) -> f64 {
        match self.section.motion() {
            Motion::Extension => state.axial_stretch,
            Motion::Expansion => state.outer_radius_m,
            Motion::Bending => state.bend_angle_rad,
            Motion::Twisting => state.twist_rad,
        }
    }
}

impl Shape {
    pub(super) fn new(task: &Task, made: &[Made], states: Vec<State<f64>>) -> Self {
        let start = task.start(made.first().map_or(0.0, |first| first.ends_m[0]));
        let mut body = Body::new(&start);
        let mut tip = start;
        let mut links = Vec::new();
        for (made, state) in made.iter().zip(&states) {
            let segment = Segment::of_bundle(made.section.motion(), made.length_m(), made.section.reach_m(), state)
                .unwrap_or(Segment { length_m: made.length_m(), bend_angle_rad: 0.0, twist_rad: 0.0 });
            let link =
                Link { segment, mount_angle_rad: made.mount_angle_rad, rigid_length_m: made.rigid_m.iter().sum() };
            let radius_m = made.section.reach_m() + state.outer_radius_m;
            body.module(&segment, made.mount_angle_rad, radius_m);
            let [connector_m, tool_m] = made.rigid_m;
            body.rigid(connector_m, task.connector_m[1]);
            body.rigid(tool_m, task.tool_m[1]);
            tip *= link.pose();
            links.push((link, radius_m));
        }
        let rigid_m = made.iter().map(|made| made.rigid_m).collect();
        Self { states, tip, body, links, start, rigid_m }
    }

    pub(super) fn answer(&self, task: &Task, made: &[Made], to: usize) -> WayPointAnswer {
        let way_point = &task.way_points[to];
        let totals: Vec<f64> = way_point.totals.iter().map(|total| self.total(made, total)).collect();
        let tip = self.tip.translation.vector;
        let axis = self.tip.rotation * Vector3::z();
        let clearances: Vec<_> = task
            .obstacles
            .iter()
            .filter_map(|obstacle| Some((obstacle, self.body.clearance(&obstacle.shape)?.distance_m)))
            .collect();
        let spare = |(obstacle, distance): &(&Obstacle, f64)| distance - obstacle.clearance_m;
        let nearest = clearances.iter().min_by(|a, b| spare(a).total_cmp(&spare(b)));
        WayPointAnswer {
            pressure_pa: self.states.iter().map(|state| state.pressure_pa).collect(),
            deformation: made.iter().zip(&self.states).map(|(made, state)| made.deformation(state)).collect(),
            tip_m: tip.into(),
            axis: axis.into(),
            tip_error_m: self.missed_m(way_point, &totals),
            totals,
            direction_error_rad: way_point.direction.map_or(0.0, |direction| {
                (2.0 * (0.5 * (axis - direction.axis).norm()).min(1.0).asin() - direction.tolerance_rad).max(0.0)
            }),
            clearance_m: clearances.iter().map(|(_, distance)| *distance).reduce(f64::min),
            nearest_obstacle: nearest.map(|(obstacle, _)| obstacle.name.clone()),
            move_clearance_m: None,
        }
    }

    /// Deformation of a module, summed over its segments, m or rad.
    fn total(&self, made: &[Made], total: &Total) -> f64 {
        let segments = made[total.first + 1..].iter().take_while(|made| made.joined).count() + 1;
        let own = total.first..total.first + segments;
        let sum =
            |of: fn(&Segment<f64>) -> f64| self.links[own.clone()].iter().map(|(link, _)| of(&link.segment)).sum();
        match total.motion {
            Motion::Extension => sum(|segment| segment.length_m),
            Motion::Bending => sum(|segment| segment.bend_angle_rad),
            Motion::Twisting => sum(|segment| segment.twist_rad),
            Motion::Expansion => self.states[total.first].outer_radius_m,
        }
    }

    /// Distance of the tip from its aim, or errors of the modules with targets, m; a radian counts as 100 mm.
    fn missed_m(&self, way_point: &WayPoint, totals: &[f64]) -> f64 {
        let tip_m = way_point.aim.as_ref().map_or(0.0, |aim| missed(&self.tip.translation.vector, aim).norm_squared());
        let off_m = |(total, found): (&Total, &f64)| (total.mm() / MM * (found - total.value)).powi(2);
        (tip_m + way_point.totals.iter().zip(totals).map(off_m).sum::<f64>()).sqrt()
    }

    /// Squared penetrations of the body points, mm2.
    pub(super) fn penetration_mm2(&self, task: &Task) -> f64 {
        let mut pose = self.start;
        let mut sum = 0.0;
        for ((link, radius_m), rigid_m) in self.links.iter().zip(&self.rigid_m) {
            for (along, radius) in body_points(task, *rigid_m, *radius_m) {
                let point = if along <= 1.0 {
                    pose * link.pose_at(along)
                } else {
                    let distance = (along - 1.0) * link.rigid_length_m;
                    pose * link.pose_at(1.0) * nalgebra::Translation3::new(0.0, 0.0, distance)
                };
                for obstacle in &task.obstacles {
                    let distance = obstacle.shape.distance(&point.translation.vector).distance_m;
                    sum += (MM * (obstacle.clearance_m + radius - distance).max(0.0)).powi(2);
                }
            }
            pose *= link.pose();
        }
        sum
    }
}
