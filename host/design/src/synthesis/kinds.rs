//! Tasks by kind and seed, to measure methods on: three modules, four to six way-points, three obstacles (kind H: eight, and six
//! way-points), and a hidden limb that does it.
//!
//! | kind | modules from the base |
//! | --- | --- |
//! | A | extension, bending, extension |
//! | B | twisting, bending, extension |
//! | C | extension, bending, bending |
//! | E | bending, bending, extension |
//! | H | extension, bending, bending, hemmed in |

use std::f64::consts::PI;

use fra_model::{Families, Material, Motion, Placement};
use nalgebra::{Isometry3, Vector3};

use super::chain::Chain;
use super::layout::Layout;
use super::objective::Objective;
use super::realise::fine_tables;
use super::task::{Obstacle, Space, Task, TaskError, WayPoint};
use crate::actuators::{GeometryBounds, Segment, Sizes, Winding};
use softlimb_numerics::Random;
use softlimb_scene::collision::{Body, Shape};

/// A kind of task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Extension, bending, extension.
    A,
    /// Twisting, bending, extension.
    B,
    /// Extension, bending, bending.
    C,
    /// Bending, bending, extension.
    E,
    /// Extension, bending, bending among eight obstacles.
    H,
}

/// A task, and what its modules may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Posed {
    /// The task.
    pub task: Task,
    /// The modules from the base outwards.
    pub spaces: Vec<Space>,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::A, Self::B, Self::C, Self::E, Self::H];

    /// Its letter.
    pub fn letter(self) -> char {
        match self {
            Self::A => 'A',
            Self::B => 'B',
            Self::C => 'C',
            Self::E => 'E',
            Self::H => 'H',
        }
    }

    /// Its modules from the base outwards.
    pub fn motions(self) -> [Motion; 3] {
        match self {
            Self::A => [Motion::Extension, Motion::Bending, Motion::Extension],
            Self::B => [Motion::Twisting, Motion::Bending, Motion::Extension],
            Self::C | Self::H => [Motion::Extension, Motion::Bending, Motion::Bending],
            Self::E => [Motion::Bending, Motion::Bending, Motion::Extension],
        }
    }

    /// The task of this kind with that seed.
    ///
    /// # Errors
    /// [`TaskError`] where the model cannot solve the bounds of all kinds.
    pub fn pose(self, seed: u64) -> Result<Posed, TaskError> {
        let spaces: Vec<Space> = self.motions().map(space).to_vec();
        let mut random = Random::new(seed, 1000 + self.letter() as u64);
        let hemmed_in = self == Self::H;
        let count = if hemmed_in { 6 } else { 4 + (3.0 * random.uniform()) as usize };
        let mut task = empty_task(count);
        let hidden: Vec<Space> =
            spaces.iter().map(|space| space.at_section(std::array::from_fn(|_| random.uniform()))).collect();
        let tables = fine_tables(&hidden)?;
        let layout = Layout::new(&hidden.iter().collect::<Vec<_>>(), count);
        let place = random.point(layout.width());
        let objective = Objective::new(&task, layout, tables.iter().collect(), 0);
        let bodies: Vec<_> = (0..count).map(|index| body_and_tip(&objective, &place, index)).collect();
        task.way_points = bodies.iter().map(|(_, tip)| WayPoint::at((*tip).into())).collect();
        task.obstacles = obstacles(&bodies, if hemmed_in { 8 } else { 3 }, &mut random);
        Ok(Posed { task, spaces })
    }
}

/// The bounds that all kinds have in common.
pub fn space(motion: Motion) -> Space {
    let angle_deg: [f64; 2] = match motion {
        Motion::Twisting => [15.0, 45.0],
        Motion::Expansion => [60.0, 90.0],
        Motion::Extension | Motion::Bending => [0.0, 15.0],
    };
    let families = if motion == Motion::Twisting { Families::One } else { Families::Two };
    let winding =
        Winding { families, modulus_pa: 361e6, placement: Placement::Sheet, thickness_m: 0.178e-3, wall_share: 1.0 };
    Space {
        segment: Segment {
            name: format!("{motion:?}").to_lowercase(),
            motion,
            material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
            winding: (motion != Motion::Bending).then_some(winding),
            section: None,
            second: None,
            bounds: GeometryBounds {
                sizes: Sizes::InnerAndWall,
                sizes_m: [[6e-3, 10e-3], [3e-3, 5e-3]],
                length_m: [0.1, 0.3],
                angle_rad: angle_deg.map(f64::to_radians),
            },
            pressure_max_pa: 60e3,
            limit_margin: 0.05,
            goals: Vec::new(),
            effort_per_pa2: 0.0,
        },
        actuators: if motion == Motion::Twisting { 1 } else { 3 },
        reach_m: if motion == Motion::Twisting { 0.0 } else { 25e-3 },
        ends_m: [0.0; 2],
        joined: false,
        mount_angle_rad: [-PI, PI],
        density_kg_per_m3: 1080.0,
    }
}

fn empty_task(way_points: usize) -> Task {
    Task {
        base: Isometry3::identity(),
        connector_m: [15e-3, 40e-3],
        tool_m: [50e-3, 15e-3],
        rigid_mass_kg: [0.1, 0.2],
        way_points: vec![WayPoint::at([0.0; 3]); way_points],
        obstacles: Vec::new(),
        moves: false,
        from_rest: false,
    }
}

fn body_and_tip(objective: &Objective, place: &[f64], way_point: usize) -> (Body, Vector3<f64>) {
    let curves = objective.curves(place);
    let pose = objective.poses.iter().find(|pose| pose.to == way_point && pose.share == 1.0);
    let mut chain = Chain::default();
    if let Some(pose) = pose {
        objective.chain(place, &curves, pose, &mut chain);
    }
    (chain.body(objective.task, &objective.start()), chain.tip)
}

/// Solids, each a few millimetres beside the hidden limb at one way-point and clear of it at all.
fn obstacles(bodies: &[(Body, Vector3<f64>)], count: usize, random: &mut Random) -> Vec<Obstacle> {
    let mut obstacles: Vec<Obstacle> = Vec::new();
    while obstacles.len() < count {
        let (body, _) = &bodies[(random.uniform() * bodies.len() as f64) as usize];
        let piece = body.pieces()[(random.uniform() * body.pieces().len() as f64) as usize];
        let mut unit = || Vector3::from_fn(|_, _| 2.0 * random.uniform() - 1.0).normalize();
        let (away, along) = (unit(), unit());
        let radius_m = 0.02 + 0.03 * random.uniform();
        let gap_m = 2e-3 + 8e-3 * random.uniform();
        let center_m = piece.point_m(random.uniform()) + away * (piece.radius_m() + radius_m + gap_m);
        let half = along * 0.05;
        let shape = match obstacles.len() % 3 {
            0 => Shape::sphere(center_m.into(), radius_m),
            1 => Shape::capsule((center_m - half).into(), (center_m + half).into(), radius_m),
            _ => Shape::cuboid(center_m.into(), [radius_m; 3], nalgebra::UnitQuaternion::from_scaled_axis(along)),
        };
        let Ok(shape) = shape else { continue };
        let clear = bodies.iter().all(|(body, _)| body.clears(&shape, 1e-3));
        // At the base there must be room, whatever the limb.
        if clear && shape.distance(&Vector3::zeros()).distance_m > 0.06 {
            obstacles.push(Obstacle { name: format!("obstacle {}", obstacles.len() + 1), shape, clearance_m: 0.0 });
        }
    }
    obstacles
}
