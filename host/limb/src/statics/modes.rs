//! Natural frequencies, shapes and damping of small vibrations about a loaded shape.
//!
//! `K x = w^2 M x` with the second derivatives `K` of the potential, weights included, and the mass matrix `M` of the same unknowns. The masses
//! are those of the statics: walls and spacers at the nodes of Simpson's rule, rigid parts and payload at their middles. Each has its turning
//! inertia besides. How they move with the unknowns is read off the chain by central differences, so that `M` shares only the chain with `K`.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::rod::{Rod, STEPS, UNKNOWNS};
use super::solve::Shape;
use crate::{Limb, LimbModule};
use softlimb_scene::{Object, Scene};

/// Step of an unknown, in rad over a piece and in strain: right to about 1e-10.
const STEP: f64 = 1e-5;

/// Turning inertia of a module and its rigid part, as squares of radii of gyration, m2.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gyration {
    /// Of the section: about `x`, which is the mount angle, `y`, and the axis.
    pub section_m2: [f64; 3],
    /// Of each mass on the rigid part about its own middle: across the axis, and about it. Masses beyond the list are points.
    pub masses_m2: Vec<[f64; 2]>,
}

/// One natural vibration. Its shape is scaled to a mass of 1 kg: the amplitude has the unit m kg^(1/2).
#[derive(Clone, Debug)]
pub struct Mode {
    /// Natural frequency without damping, Hz.
    pub frequency_hz: f64,
    /// Part of the stiffness that is of the tubes' springs; the rest is of the weights: above 1 where these push the limb over.
    pub elastic_share: f64,
    /// Motion of each part of [`Rod::parts`]: shift, and turn in the frame of the scene.
    pub motion: Vec<[Vector3<f64>; 2]>,
    /// Motion of the tip.
    pub tip: Vector3<f64>,
}

impl Mode {
    /// Damping ratio: half of the elastomer's loss factor in the part that its springs have of the stiffness. Weights lose nothing.
    pub fn damping(&self, loss_factor: f64) -> f64 {
        0.5 * loss_factor * self.elastic_share
    }
}

/// A mass of the chain with its turning inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its middle, m.
    pub place_m: Vector3<f64>,
    /// From its axes to those of the scene.
    pub turn: Matrix3<f64>,
    /// kg.
    pub kg: f64,
    /// Moments of inertia about its axes, kg m2.
    pub inertia_kg_m2: Vector3<f64>,
}

impl Part {
    /// Its inertia against turns in the frame of the scene, on a turn.
    pub fn spun(&self, turn: &Vector3<f64>) -> Vector3<f64> {
        self.turn * self.inertia_kg_m2.component_mul(&self.turn.tr_mul(turn))
    }

    /// Turn from here to a pose of the same part that is less than a quarter turn away.
    pub fn turn_to(&self, other: &Self) -> Vector3<f64> {
        let turn = other.turn * self.turn.transpose();
        // Of a small turn the odd part is exact where the trace has lost it.
        let odd =
            0.5 * Vector3::new(turn[(2, 1)] - turn[(1, 2)], turn[(0, 2)] - turn[(2, 0)], turn[(1, 0)] - turn[(0, 1)]);
        let sine = odd.norm().min(1.0);
        if sine < 1e-9 { odd } else { odd * (sine.asin() / sine) }
    }
}

impl Gyration {
    /// Gyrations of a limb's modules, and of the segments of those in series. The load at the tip is a point mass, or an object that turns about its middle.
    pub fn of_limb(scene: &Scene, limb: &Limb, object: Option<&Object>) -> Vec<Self> {
        let last = limb.modules().len().saturating_sub(1);
        let of_module = |(index, module): (usize, &LimbModule)| {
            let [connector_m, tool_m] = module.rigid_parts_m();
            let mut masses_m2 = vec![cylinder_m2(connector_m, module.radius_m(&module.curve.states()[0]))];
            if index == last {
                let tool = scene.limb().end_effector.as_ref();
                masses_m2.extend(tool.map(|tool| cylinder_m2(tool_m, tool.radius_m)));
                masses_m2.push(object.map_or([0.0; 2], |object| cylinder_m2(object.height_m, object.radius_m)));
            }
            // All masses behind a series are on its last segment.
            let end = module.parts().len() - 1;
            let section_m2 = section_m2(module);
            let of_part = move |part: usize| if part == end { masses_m2.clone() } else { Vec::new() };
            (0..=end).map(move |part| Self { section_m2, masses_m2: of_part(part) })
        };
        limb.modules().iter().enumerate().flat_map(of_module).collect()
    }
}

/// Squares of radii of gyration of a module's section: tubes at their places. Spacers count as tubes do.
fn section_m2(module: &LimbModule) -> [f64; 3] {
    let parameters = module.actuator.parameters();
    let own = 0.25 * (parameters.inner_radius_m.powi(2) + parameters.outer_radius_m.powi(2));
    let places = module.positions_m();
    let mean = |axis: usize| places.iter().map(|place| place[axis] * place[axis]).sum::<f64>() / places.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    [y + own, x + own, x + y + 2.0 * own]
}

/// A full cylinder about its middle: across and about its axis.
fn cylinder_m2(length_m: f64, radius_m: f64) -> [f64; 2] {
    let square = radius_m * radius_m;
    [length_m * length_m / 12.0 + 0.25 * square, 0.5 * square]
}

impl Rod {
    /// All masses at unknowns `q`, with turning inertia of its modules, each of which may be in several pieces.
    pub fn parts(&self, q: &DVector<f64>, gyration: &[Gyration]) -> Vec<Part> {
        let split = (self.pieces.len() / gyration.len().max(1)).max(1);
        let (steps, poses) = self.chain(q.as_slice());
        let mut parts = Vec::with_capacity(self.pieces.len() * (STEPS + 3));
        let none = Gyration::default();
        for (index, (piece, pose)) in self.pieces.iter().zip(&poses).enumerate() {
            let gyration = gyration.get(index / split).unwrap_or(&none);
            let own = &steps[index * STEPS..][..STEPS];
            let mut node = |node: usize, place_m: Vector3<f64>, turn: Matrix3<f64>| {
                let kg = piece.node_kg(node);
                let inertia_kg_m2 = Vector3::from(gyration.section_m2) * kg;
                parts.push(Part { place_m, turn, kg, inertia_kg_m2 });
            };
            node(0, own[0].origin, own[0].rotation);
            own.iter().enumerate().for_each(|(at, step)| {
                node(at + 1, step.end(), step.rotation * step.motion.rotation);
            });
            let turn = pose.rotation.to_rotation_matrix().into_inner();
            for (index, (distance_m, kg)) in piece.masses.iter().enumerate() {
                let [across, about] = gyration.masses_m2.get(index).copied().unwrap_or_default();
                let place_m = pose.translation.vector + turn.column(2) * (distance_m - piece.rigid_m);
                let inertia_kg_m2 = Vector3::new(across, across, about) * *kg;
                parts.push(Part { place_m, turn, kg: *kg, inertia_kg_m2 });
            }
        }
        parts
    }

    /// How each part, and the tip, move with each unknown: shift and turn; the tip's shift comes last.
    fn motions(&self, q: &DVector<f64>, gyration: &[Gyration]) -> Vec<Vec<[Vector3<f64>; 2]>> {
        let here = self.parts(q, gyration);
        let of_unknown = |unknown: usize| {
            let length_m = self.pieces[unknown / UNKNOWNS].length_m;
            let step = if unknown % UNKNOWNS < 5 { STEP / length_m } else { STEP };
            let [less, more] = [-step, step].map(|step| {
                let mut moved = q.clone();
                moved[unknown] += step;
                let tip = self.points_m(moved.as_slice()).last().map_or_else(Vector3::zeros, |tip| Vector3::from(*tip));
                (self.parts(&moved, gyration), tip)
            });
            let per = 0.5 / step;
            let of_part = |(here, (less, more)): (&Part, (&Part, &Part))| {
                let turn = here.turn_to(more) - here.turn_to(less);
                [(more.place_m - less.place_m) * per, turn * per]
            };
            let parts = here.iter().zip(less.0.iter().zip(&more.0)).map(of_part);
            parts.chain([[(more.1 - less.1) * per, Vector3::zeros()]]).collect()
        };
        (0..self.unknowns()).map(of_unknown).collect()
    }
}

impl Shape {
    /// The slowest vibrations about the shape, at most `count`, of a rod with linear bends; `None` where the shape is not stable.
    pub fn modes(&self, rod: &Rod, gyration: &[Gyration], count: usize) -> Option<Vec<Mode>> {
        let motions = rod.motions(&self.q, gyration);
        let parts = rod.parts(&self.q, gyration);
        let size = self.q.len();
        let mut mass = DMatrix::<f64>::zeros(size, size);
        for (index, part) in parts.iter().enumerate().filter(|(_, part)| part.kg > 0.0) {
            let carried: Vec<[Vector3<f64>; 2]> =
                motions.iter().map(|all| [all[index][0] * part.kg, part.spun(&all[index][1])]).collect();
            for (a, motion) in motions.iter().enumerate() {
                let [shift, turn] = &motion[index];
                for (b, [force, torque]) in carried.iter().enumerate().take(a + 1) {
                    mass[(a, b)] += shift.dot(force) + turn.dot(torque);
                }
            }
        }
        mass.fill_upper_triangle_with_lower_triangle();
        // Of the inverse problem the largest values are the slowest vibrations, and unknowns without mass do no harm.
        let tangent = &self.potential.tangent;
        let factor = tangent.clone().cholesky()?.l();
        let half = factor.solve_lower_triangular(&mass)?;
        let inverse = factor.solve_lower_triangular(&half.transpose())?;
        let found = (0.5 * (&inverse + inverse.transpose())).symmetric_eigen();
        let mut order: Vec<usize> = (0..size).filter(|index| found.eigenvalues[*index] > 0.0).collect();
        order.sort_by(|a, b| found.eigenvalues[*b].total_cmp(&found.eigenvalues[*a]));
        let springs = rod.potential(&self.q, 0.0).tangent;
        let mode = |index: usize| {
            let square = found.eigenvalues[index];
            let own = factor.tr_solve_lower_triangular(&found.eigenvectors.column(index))? / square.sqrt();
            let along = |part: usize| {
                let sum = |kind: usize| {
                    motions.iter().zip(own.iter()).map(|(all, by)| all[part][kind] * *by).sum::<Vector3<f64>>()
                };
                [sum(0), sum(1)]
            };
            Some(Mode {
                frequency_hz: 1.0 / (std::f64::consts::TAU * square.sqrt()),
                elastic_share: (own.tr_mul(&(&springs * &own)))[(0, 0)] * square,
                motion: (0..parts.len()).map(along).collect(),
                tip: along(parts.len())[0],
            })
        };
        order.into_iter().take(count).map(mode).collect()
    }
}
