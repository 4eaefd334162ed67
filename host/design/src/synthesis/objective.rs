//! The objective of a search: squared errors of the tip and squared penetrations, in mm2, with exact first derivatives.
//!
//! ```text
//! J = sum over way-points   w |tip - aim|^2 + w (100 mm)^2 |axis - direction|^2
//!   + sum over body points  max(0, required clearance + radius - distance)^2
//!   + sum over segments     (1 mm / kPa)^2 (pressure - that of the segment before)^2
//! ```
//!
//! The body points are points of the centre line, evenly spaced, at every way-point and between them along the moves.

use nalgebra::{DMatrix, DVector, Isometry3};

use super::aim::{MM, aim};
use super::chain::{Bundle, COLUMNS, Chain, On};
use super::layout::Layout;
use super::points::{body_points, radius_at};
use super::response::{FIELDS, PRESSURE, RADIUS};
use super::rows::Rows;
use super::table::{Curve, Table};
use super::task::{Task, WayPoint};
use softlimb_scene::collision::Shape;

/// Weight of a pressure difference between segments of one actuator, mm/Pa.
const MM_PER_PA: f64 = 1e-3;

/// A configuration that is looked at: a way-point, or a point on the move between two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    /// The way-point that the move starts from; `None` at rest.
    pub(super) from: Option<usize>,
    /// The way-point that the move goes to.
    pub(super) to: usize,
    /// How much of the move is done, 0 to 1; at 1 it is the way-point.
    pub(super) share: f64,
}

/// An additional body point that counts: pose, obstacle, module, and where on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) pose: usize,
    pub(super) obstacle: usize,
    pub(super) module: usize,
    /// Share of the module's length; beyond 1, of the rigid part behind it.
    pub(super) along: f64,
}

/// Value, gradient `J'r` and normal matrix `J'J`, with `r` in mm.
#[derive(Clone, Debug)]
pub(super) struct Quadratic {
    pub(super) value: f64,
    pub(super) gradient: DVector<f64>,
    pub(super) normal: DMatrix<f64>,
}

/// The objective of one order of modules.
pub(super) struct Objective<'a> {
    pub(super) task: &'a Task,
    pub(super) layout: Layout,
    pub(super) tables: Vec<&'a Table>,
    pub(super) poses: Vec<Pose>,
    pub(super) spots: Vec<Spot>,
    /// Distance that is kept from obstacles beyond what is required, m.
    pub(super) spare_m: f64,
    /// Whether obstacles count.
    pub(super) obstacles: bool,
    /// The one way-point that counts, where not all do.
    pub(super) only: Option<usize>,
}

impl<'a> Objective<'a> {
    pub(super) fn new(task: &'a Task, layout: Layout, tables: Vec<&'a Table>, on_a_move: usize) -> Self {
        let mut poses = Vec::new();
        for to in 0..task.way_points.len() {
            let from = to.checked_sub(1);
            if task.move_to(to) && !task.obstacles.is_empty() {
                let share = |step: usize| step as f64 / (on_a_move + 1) as f64;
                poses.extend((1..=on_a_move).map(|step| Pose { from, to, share: share(step) }));
            }
            poses.push(Pose { from: None, to, share: 1.0 });
        }
        Self { task, layout, tables, poses, spots: Vec::new(), spare_m: 0.0, obstacles: true, only: None }
    }

    /// The responses of the sections at a place.
    pub(super) fn curves(&self, place: &[f64]) -> Vec<Curve> {
        self.tables.iter().enumerate().map(|(m, table)| table.curve(self.layout.section(place, m))).collect()
    }

    /// The shape of a module in a pose, with its derivatives.
    fn bundle(&self, place: &[f64], curve: &Curve, module: usize, pose: &Pose) -> Bundle {
        let at = |way_point: usize| place[self.layout.share(way_point, module)];
        let share = pose.share * at(pose.to) + pose.from.map_or(0.0, |from| (1.0 - pose.share) * at(from));
        let sample = curve.at(share);
        let [[length, by_length], [mount_angle_rad, by_mount]] = self.layout.length_and_mount(place, module);
        let mut bundle = Bundle { mount_angle_rad, by_mount, ..Bundle::default() };
        for field in 0..FIELDS {
            // Radius and pressure do not grow with the length.
            let along = field < RADIUS;
            let scale = if along { length } else { 1.0 };
            let [x, y, z] = sample.by_section[field].map(|by| by * scale);
            let by_share = sample.by_share[field] * scale;
            bundle.value[field] = sample.value[field] * scale;
            let per_length = if along { sample.value[field] * by_length } else { 0.0 };
            let from = pose.from.map_or(0.0, |_| 1.0 - pose.share);
            bundle.by[field] = [x, y, z, per_length, 0.0, by_share * pose.share, by_share * from];
        }
        bundle.value[RADIUS] += self.tables[module].reach_m();
        bundle.rigid_m = self.rigid_parts_m(module);
        bundle
    }

    /// Lengths of the rigid parts behind a module, m: connector with ends, and tool.
    pub(super) fn rigid_parts_m(&self, module: usize) -> [f64; 2] {
        let next = self.tables.get(module + 1).map(|table| table.behind());
        self.task.rigid_parts_m(self.tables[module].end_m(), next)
    }

    /// Where the part of the limb starts that moves.
    pub(super) fn start(&self) -> Isometry3<f64> {
        self.task.start(self.tables.first().map_or(0.0, |table| table.behind().end_m))
    }

    /// The limb in a pose.
    pub(super) fn chain(&self, place: &[f64], curves: &[Curve], pose: &Pose, chain: &mut Chain) {
        let bundles = curves.iter().enumerate().map(|(module, curve)| self.bundle(place, curve, module, pose));
        chain.place(&self.start(), bundles);
    }

    /// Value and derivatives at a place.
    pub(super) fn at(&self, place: &[f64]) -> Quadratic {
        let width = self.layout.width();
        let mut sum = Quadratic { value: 0.0, gradient: DVector::zeros(width), normal: DMatrix::zeros(width, width) };
        let curves = self.curves(place);
        let mut chain = Chain::default();
        let mut rows = Rows::new(self.tables.len());
        for (index, pose) in self.poses.iter().enumerate() {
            if self.only.is_some_and(|only| pose.share < 1.0 || only != pose.to) {
                continue;
            }
            rows.clear();
            self.chain(place, &curves, pose, &mut chain);
            if pose.share == 1.0 {
                aim(&chain, &self.task.way_points[pose.to], &mut rows);
                self.add_up(&chain, &self.task.way_points[pose.to], &mut rows);
                self.join(&chain, &mut rows);
            }
            if self.obstacles {
                self.collide(&chain, index, &mut rows);
            }
            if rows.value > 0.0 {
                self.scatter(pose, &rows, &mut sum);
            }
        }
        sum
    }

    /// Rows of the targets of modules.
    fn add_up(&self, chain: &Chain, way_point: &WayPoint, rows: &mut Rows) {
        for total in &way_point.totals {
            let segments = self.tables[total.first + 1..].iter().take_while(|table| table.behind().joined).count() + 1;
            let own = total.first..total.first + segments;
            let field = total.field();
            // The radius of the body includes the distance of its actuators from the axis.
            let beside_m = if field == RADIUS { self.tables[total.first].reach_m() } else { 0.0 };
            let found: f64 = chain.joints[own.clone()].iter().map(|joint| joint.values()[field]).sum();
            let scale = way_point.weight.sqrt() * total.mm();
            rows.add((found - beside_m - total.value) * scale, scale, |row| {
                for part in own {
                    let columns = row[part * COLUMNS..(part + 1) * COLUMNS].iter_mut();
                    columns.zip(chain.joints[part].slopes(field)).for_each(|(sum, by)| *sum += by);
                }
            });
        }
    }

    /// Rows of pressure differences between neighbouring segments of one actuator.
    fn join(&self, chain: &Chain, rows: &mut Rows) {
        for module in (1..self.tables.len()).filter(|module| self.tables[*module].behind().joined) {
            let [before, own] = [&chain.joints[module - 1], &chain.joints[module]];
            let more_pa = own.values()[PRESSURE] - before.values()[PRESSURE];
            rows.add(more_pa * MM_PER_PA, MM_PER_PA, |row| {
                let columns = row[(module - 1) * COLUMNS..(module + 1) * COLUMNS].iter_mut();
                let by = before.slopes(PRESSURE).iter().map(|by| -by).chain(own.slopes(PRESSURE).iter().copied());
                columns.zip(by).for_each(|(sum, by)| *sum += by);
            });
        }
    }

    /// Adds the rows of a pose to those of all.
    fn scatter(&self, pose: &Pose, rows: &Rows, sum: &mut Quadratic) {
        sum.value += rows.value;
        let global = |column: usize| {
            let (module, slot) = (column / COLUMNS, column % COLUMNS);
            match slot {
                5 => Some(self.layout.share(pose.to, module)),
                6 => pose.from.map(|from| self.layout.share(from, module)),
                _ => self.layout.common[module][slot],
            }
        };
        for i in 0..rows.width {
            let Some(gi) = global(i) else { continue };
            sum.gradient[gi] += rows.gradient[i];
            for j in 0..=i {
                let Some(gj) = global(j) else { continue };
                let value = rows.normal[i * rows.width + j];
                sum.normal[(gi, gj)] += value;
                if i != j {
                    sum.normal[(gj, gi)] += value;
                }
            }
        }
    }

    fn collide(&self, chain: &Chain, pose: usize, rows: &mut Rows) {
        for (module, joint) in chain.joints.iter().enumerate() {
            let [length, rigid] = joint.lengths();
            let (middle, last) = (joint.point(0.5), module + 1 == chain.joints.len());
            for obstacle in &self.task.obstacles {
                // Nothing of the module and its rigid part is farther from the middle than this.
                let far = 0.5 * length + rigid + joint.radius().0.max(self.rigid_radius(last)) + obstacle.clearance_m;
                if obstacle.shape.distance(&middle).distance_m > far {
                    continue;
                }
                let required = obstacle.clearance_m;
                for (along, radius) in body_points(self.task, joint.rigid_m(), joint.radius().0) {
                    self.touch(chain, &obstacle.shape, required + radius, (module, along), rows);
                }
            }
        }
        for spot in self.spots.iter().filter(|spot| spot.pose == pose) {
            let obstacle = &self.task.obstacles[spot.obstacle];
            let joint = &chain.joints[spot.module];
            let radius = radius_at(self.task, joint.rigid_m(), joint.radius().0, spot.along);
            self.touch(chain, &obstacle.shape, obstacle.clearance_m + radius, (spot.module, spot.along), rows);
        }
    }

    fn rigid_radius(&self, last: bool) -> f64 {
        if last { self.task.connector_m[1].max(self.task.tool_m[1]) } else { self.task.connector_m[1] }
    }

    /// One body point against one solid, from whose surface it keeps a distance.
    fn touch(&self, chain: &Chain, shape: &Shape, keeps: f64, (module, along): (usize, f64), rows: &mut Rows) {
        let joint = &chain.joints[module];
        let (on, point) = if along <= 1.0 {
            (On::Module(along), joint.point(along))
        } else {
            (On::Rigid, joint.end + joint.end_axis * ((along - 1.0) * joint.lengths()[1]))
        };
        let distance = shape.distance(&point);
        let depth = keeps + self.spare_m - distance.distance_m;
        if depth <= 0.0 {
            return;
        }
        rows.add(depth * MM, -MM, |row| {
            chain.row(module, on, &point, &distance.gradient, row);
            if let On::Module(_) = on {
                let columns = &mut row[module * COLUMNS..(module + 1) * COLUMNS];
                columns.iter_mut().zip(joint.radius().1).for_each(|(sum, by)| *sum -= by);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::super::kinds::{Kind, space};
    use super::super::task::{Aim, Direction, Total};
    use super::*;
    use softlimb_numerics::Random;

    /// Central differences of the value; hinges and cuts make the value once differentiable only, so most places, not all, must agree.
    #[test]
    fn derivatives_are_those_of_the_value() {
        for kind in Kind::ALL {
            let mut posed = kind.pose(3).unwrap();
            posed.task.moves = true;
            posed.task.obstacles.iter_mut().for_each(|obstacle| obstacle.clearance_m = 0.05);
            let axis = nalgebra::Vector3::new(0.6, 0.0, 0.8);
            posed.task.way_points[0].direction = Some(Direction { axis, tolerance_rad: 0.0 });
            posed.task.way_points[1].direction = Some(Direction { axis, tolerance_rad: 0.2 });
            let rotation = UnitQuaternion::from_scaled_axis(axis);
            let half_m = nalgebra::Vector3::repeat(0.01);
            posed.task.way_points[2].aim = Some(Aim::Inside { center_m: axis * 0.4, half_m, rotation });
            let total = |first: usize| Total { first, motion: posed.spaces[first].motion(), value: 0.7 };
            posed.task.way_points[3].totals = vec![total(0), total(1)];
            // Kind B begins with a single twisting actuator, which no segment of a bundle can join.
            posed.spaces[1].joined = kind != Kind::B;
            if kind == Kind::B {
                posed.spaces[2] = space(fra_model::Motion::Expansion);
            }
            let tables: Vec<_> = posed.spaces.iter().map(|space| Table::new(space).unwrap()).collect();
            let layout = Layout::new(&posed.spaces.iter().collect::<Vec<_>>(), posed.task.way_points.len());
            let objective = Objective::new(&posed.task, layout, tables.iter().collect(), 2);
            let mut random = Random::new(1, 1);
            let place = random.point(objective.layout.width());
            let here = objective.at(&place);
            for index in 0..place.len() {
                let moved = |step: f64| {
                    let mut there = place.clone();
                    there[index] += step;
                    objective.at(&there).value
                };
                let h = 1e-6;
                let slope = (moved(h) - moved(-h)) / (2.0 * h);
                let exact = 2.0 * here.gradient[index];
                let scale = here.gradient.amax();
                assert!((slope - exact).abs() < 1e-5 * scale, "{kind:?} variable {index}: {slope} {exact}");
            }
        }
    }
}
