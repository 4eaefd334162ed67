//! What the model says about a limb that was found: pressures by its explicit inverses, everything else by forward solves at these.

use fra_model::{Link, Load, Motion, Segment, State, Status};
use nalgebra::{Isometry3, Vector3};

use super::aim::{DIRECTION_MM, MM, missed};
use super::candidate::{Candidate, Figures, ModuleDesign, WayPointAnswer};
use super::moves::Move;
use super::points::body_points;
use super::realise::Exact;
use super::response::Section;
use super::table::Curve;
use super::task::{Obstacle, Space, Task, TaskError};
use crate::obstacle::Body;

/// Standard atmosphere, Pa.
const ATMOSPHERE_PA: f64 = 101_325.0;

/// One module as it will be made.
struct Made<'a> {
    section: Section<'a>,
    density_kg_per_m3: f64,
    name: &'a str,
    mount_angle_rad: f64,
    rigid_m: f64,
}

/// The limb in one configuration, by the kinematics of the model.
struct Shape {
    states: Vec<State<f64>>,
    tip: Isometry3<f64>,
    body: Body,
    links: Vec<(Link<f64>, f64)>,
}

fn refused(space: &Space, reason: impl std::fmt::Display) -> TaskError {
    TaskError::Bounds { place: format!("module {}", space.segment.name), reason: reason.to_string() }
}

/// Asks the model about a limb that was found.
///
/// # Errors
/// [`TaskError::Bounds`] where it does not confirm a section.
pub(super) fn confirm(exact: &Exact, sections: &[Space]) -> Result<Candidate, TaskError> {
    let (task, layout) = (exact.objective.task, &exact.objective.layout);
    let final_spaces: Vec<Space> = sections
        .iter()
        .enumerate()
        .map(|(module, space)| {
            let mut space = space.clone();
            space.segment.bounds.length_m = [layout.length_and_mount(&exact.place, module)[0][0]; 2];
            space
        })
        .collect();
    let mut made = Vec::new();
    for (module, space) in final_spaces.iter().enumerate() {
        let section = Section::new(space, &[0.5; 4], task.circle_radius_m).map_err(|reason| refused(space, reason))?;
        let last = module + 1 == final_spaces.len();
        made.push(Made {
            section,
            density_kg_per_m3: space.density_kg_per_m3,
            name: &space.segment.name,
            mount_angle_rad: layout.mount_angle_rad(&exact.place, module),
            rigid_m: task.connector_m[0] + if last { task.tool_m[0] } else { 0.0 },
        });
    }
    let curves = exact.objective.curves(&exact.place);
    let mut way_points = Vec::new();
    let mut shapes = Vec::new();
    let mut spare = None;
    for to in 0..task.way_points.len() {
        let states = made
            .iter()
            .enumerate()
            .map(|(module, made)| made.pressed(exact.place[layout.share(to, module)]))
            .collect::<Option<Vec<_>>>();
        let states = states.ok_or_else(|| refused(&final_spaces[0], "a deformation found has no pressure"))?;
        let shape = Shape::new(task, &made, states);
        let mut answer = shape.answer(task, &made, to);
        let nearest = nearest(exact, &curves, to);
        spare = nearest.iter().map(|(spare, _)| *spare).chain(spare).reduce(f64::min);
        if task.move_to(to) {
            answer.move_clearance_m = nearest.iter().map(|(_, distance)| *distance).reduce(f64::min);
        }
        way_points.push(answer);
        shapes.push(shape);
    }
    let modules: Vec<ModuleDesign> = made.iter().map(|made| made.design(task)).collect();
    let figures = figures(task, &made, &modules, &way_points, &shapes, spare);
    let objective_mm2 = objective(task, &way_points, &shapes);
    Ok(Candidate { modules, way_points, figures, objective_mm2, shortfall: None, evaluations: 0 })
}

/// For every obstacle the least clearance beyond what is required and the least clearance, m: at a way-point, or along the move to it.
fn nearest(exact: &Exact, curves: &[Curve], to: usize) -> Vec<(f64, f64)> {
    let (objective, task) = (&exact.objective, exact.objective.task);
    let line = Move { objective, place: &exact.place, curves, from: to.checked_sub(1), to };
    let found = task.obstacles.iter().filter_map(|obstacle| {
        let distance_m = line.least(&obstacle.shape)?.clearance.distance_m;
        Some((distance_m - obstacle.clearance_m, distance_m))
    });
    found.collect()
}

impl Made<'_> {
    /// The forward solution at the pressure of a share.
    fn pressed(&self, share: f64) -> Option<State<f64>> {
        let pressure_pa = self.section.state(share)?.pressure_pa.max(0.0);
        let solution = self.section.candidate.actuator.forward(pressure_pa, &Load::none()).ok()?;
        (solution.status == Status::Solved).then_some(solution.state)
    }

    fn length_m(&self) -> f64 {
        self.section.candidate.geometry.length_m
    }

    fn wall_volume_m3(&self) -> f64 {
        let geometry = &self.section.candidate.geometry;
        std::f64::consts::PI * (geometry.outer_radius_m.powi(2) - geometry.inner_radius_m.powi(2)) * geometry.length_m
    }

    fn design(&self, task: &Task) -> ModuleDesign {
        let geometry = &self.section.candidate.geometry;
        let elastomer = self.wall_volume_m3() * self.density_kg_per_m3 * f64::from(task.actuators);
        ModuleDesign {
            name: self.name.to_owned(),
            motion: self.section.motion().into(),
            inner_radius_m: geometry.inner_radius_m,
            outer_radius_m: geometry.outer_radius_m,
            length_m: geometry.length_m,
            fiber_angle_rad: geometry.angle_rad,
            mount_angle_rad: if self.section.motion() == Motion::Bending { self.mount_angle_rad } else { 0.0 },
            pressure_cap_pa: self.section.cap_pa(),
            mass_kg: elastomer + task.rigid_mass_kg[0],
        }
    }

    fn deformation(&self, state: &State<f64>) -> f64 {
        match self.section.motion() {
            Motion::Extension => state.axial_stretch,
            Motion::Expansion => state.outer_radius_m,
            Motion::Bending => state.bend_angle_rad,
            Motion::Twisting => state.twist_rad,
        }
    }
}

impl Shape {
    fn new(task: &Task, made: &[Made], states: Vec<State<f64>>) -> Self {
        let mut body = Body::new(&task.base);
        let mut tip = task.base;
        let mut links = Vec::new();
        for (index, (made, state)) in made.iter().zip(&states).enumerate() {
            let segment = Segment::of_bundle(made.section.motion(), made.length_m(), task.circle_radius_m, state)
                .unwrap_or(Segment { length_m: made.length_m(), bend_angle_rad: 0.0, twist_rad: 0.0 });
            let link = Link { segment, mount_angle_rad: made.mount_angle_rad, rigid_length_m: made.rigid_m };
            let radius_m = task.circle_radius_m + state.outer_radius_m;
            body.module(&segment, made.mount_angle_rad, radius_m);
            body.rigid(task.connector_m[0], task.connector_m[1]);
            if index + 1 == states.len() {
                body.rigid(task.tool_m[0], task.tool_m[1]);
            }
            tip *= link.pose();
            links.push((link, radius_m));
        }
        Self { states, tip, body, links }
    }

    fn answer(&self, task: &Task, made: &[Made], to: usize) -> WayPointAnswer {
        let way_point = &task.way_points[to];
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
            tip_error_m: missed(&tip, &way_point.aim).norm(),
            direction_error_rad: way_point.direction.map_or(0.0, |direction| {
                (2.0 * (0.5 * (axis - direction.axis).norm()).min(1.0).asin() - direction.tolerance_rad).max(0.0)
            }),
            clearance_m: clearances.iter().map(|(_, distance)| *distance).reduce(f64::min),
            nearest_obstacle: nearest.map(|(obstacle, _)| obstacle.name.clone()),
            move_clearance_m: None,
        }
    }

    /// Squared penetrations of the body points, mm2.
    fn penetration_mm2(&self, task: &Task) -> f64 {
        let mut pose = task.base;
        let mut sum = 0.0;
        for (index, (link, radius_m)) in self.links.iter().enumerate() {
            let last = index + 1 == self.links.len();
            for (along, radius) in body_points(task, last, *radius_m) {
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

fn objective(task: &Task, way_points: &[WayPointAnswer], shapes: &[Shape]) -> f64 {
    let mut sum = 0.0;
    for ((answer, way_point), shape) in way_points.iter().zip(&task.way_points).zip(shapes) {
        let turned = 2.0 * (0.5 * answer.direction_error_rad).sin();
        sum += way_point.weight * ((MM * answer.tip_error_m).powi(2) + (DIRECTION_MM * turned).powi(2));
        sum += shape.penetration_mm2(task);
    }
    sum
}

fn figures(
    task: &Task,
    made: &[Made],
    modules: &[ModuleDesign],
    way_points: &[WayPointAnswer],
    shapes: &[Shape],
    spare_clearance_m: Option<f64>,
) -> Figures {
    let most = |value: fn(&WayPointAnswer) -> f64| way_points.iter().map(value).fold(0.0, f64::max);
    let squares: f64 = way_points.iter().map(|answer| answer.tip_error_m.powi(2)).sum();
    Figures {
        tip_error_rms_m: (squares / way_points.len() as f64).sqrt(),
        tip_error_max_m: most(|answer| answer.tip_error_m),
        direction_error_max_rad: most(|answer| answer.direction_error_rad),
        pressure_max_pa: most(|answer| answer.pressure_pa.iter().copied().fold(0.0, f64::max)),
        mass_kg: modules.iter().map(|module| module.mass_kg).sum::<f64>() + task.rigid_mass_kg[1],
        spare_clearance_m,
        air_m3: air(task, made, shapes),
    }
}

/// Gas put in from rest through all way-points, as its volume at atmospheric pressure, m3: isothermal, and what is vented is lost.
fn air(task: &Task, made: &[Made], shapes: &[Shape]) -> f64 {
    let free = |state: &State<f64>| state.volume_m3 * (state.pressure_pa + ATMOSPHERE_PA) / ATMOSPHERE_PA;
    let mut sum = 0.0;
    for (module, made) in made.iter().enumerate() {
        let mut before = free(&made.section.candidate.actuator.rest());
        for shape in shapes {
            let now = free(&shape.states[module]);
            sum += (now - before).max(0.0);
            before = now;
        }
    }
    sum * f64::from(task.actuators)
}
