//! Design problems by kind and seed, to measure methods on: three segments, four phases.
//!
//! | kind | segments | targets |
//! | --- | --- | --- |
//! | A | extension, bending, extension | of a hidden design within the bounds |
//! | B | twisting, bending, extension | the same |
//! | C | extension, bending, bending | the same |
//! | D | extension, bending, twisting | of hidden designs, then pulled apart beyond what one geometry spans |
//! | F | extension, bending, extension | those of A, but one supply line for all |
//! | G | twisting, bending, extension | those of B, but one supply line for all |

use fra_model::{Actuator, Families, Load, Material, Motion, Placement, Status};

use super::problem::{GeometryBounds, Goal, Problem, Segment, Sizes, Winding};
use softlimb_numerics::Random;

/// Phases of every problem.
const PHASES: usize = 4;
/// 1 mm counts as much as 1 mm: per m2.
const PER_M2: f64 = 1e6;
/// 1 mm at 100 mm from the axis: per rad2.
const PER_RAD2: f64 = 1e4;
/// How far the targets of kind D are pulled away from their middle.
const PULLED: f64 = 1.6;

/// A kind of problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Reachable: extension, bending, extension.
    A,
    /// Reachable: twisting, bending, extension.
    B,
    /// Reachable: extension, bending, bending.
    C,
    /// Unreachable.
    D,
    /// A with one pressure for all.
    F,
    /// B with one pressure for all.
    G,
}

impl std::fmt::Display for Kind {
    /// The motions of its segments, and whether they share a pressure.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::A | Self::B | Self::C | Self::D => f.write_str(&self.motions().map(Motion::name).join(", ")),
            Self::F => f.write_str("motions of A, one pressure"),
            Self::G => f.write_str("motions of B, one pressure"),
        }
    }
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 6] = [Self::A, Self::B, Self::C, Self::D, Self::F, Self::G];

    /// Its letter.
    pub fn letter(self) -> char {
        match self {
            Self::A => 'A',
            Self::B => 'B',
            Self::C => 'C',
            Self::D => 'D',
            Self::F => 'F',
            Self::G => 'G',
        }
    }

    fn motions(self) -> [Motion; 3] {
        match self {
            Self::A | Self::F => [Motion::Extension, Motion::Bending, Motion::Extension],
            Self::B | Self::G => [Motion::Twisting, Motion::Bending, Motion::Extension],
            Self::C => [Motion::Extension, Motion::Bending, Motion::Bending],
            Self::D => [Motion::Extension, Motion::Bending, Motion::Twisting],
        }
    }

    /// The problem of this kind with that seed.
    pub fn problem(self, seed: u64) -> Problem {
        let mut random = Random::new(seed, self.letter() as u64);
        let segment = |motion: Motion| {
            let mut segment = bounded(motion);
            while segment.goals.is_empty() {
                segment.goals = goals(&segment, &mut random, self == Self::D).unwrap_or_default();
            }
            segment
        };
        Problem { segments: self.motions().map(segment).to_vec(), shared_pressure: matches!(self, Self::F | Self::G) }
    }
}

/// A segment with the bounds of all kinds and no goals yet.
fn bounded(motion: Motion) -> Segment {
    let angle_deg = match motion {
        Motion::Twisting => [15.0, 45.0],
        Motion::Expansion => [60.0, 90.0],
        Motion::Extension | Motion::Bending => [0.0, 15.0],
    };
    let families = if motion == Motion::Twisting { Families::One } else { Families::Two };
    let winding =
        Winding { families, modulus_pa: 361e6, placement: Placement::Sheet, thickness_m: 0.178e-3, wall_share: 1.0 };
    Segment {
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
    }
}

/// What a hidden design does at hidden pressures; `None` where it has no equilibrium there.
fn goals(segment: &Segment, random: &mut Random, unreachable: bool) -> Option<Vec<Option<Goal>>> {
    let geometry = segment.geometry(&random.point(segment.dimensions()));
    let actuator = Actuator::new(&segment.parameters(&geometry)).ok()?;
    let beyond = actuator.forward(segment.pressure_max_pa / (1.0 - segment.limit_margin), &Load::none()).ok()?;
    let mut values = Vec::new();
    for _ in 0..PHASES {
        let solution = actuator.forward(segment.pressure_max_pa * random.uniform(), &Load::none()).ok()?;
        if solution.status != Status::Solved || beyond.status != Status::Solved {
            return None;
        }
        values.push(segment.measure(&solution.state, geometry.length_m));
    }
    if unreachable {
        pull_apart(segment, &mut values);
    }
    let weight = if segment.motion == Motion::Extension { PER_M2 } else { PER_RAD2 };
    Some(values.into_iter().map(|value| Some(Goal { value, weight })).collect())
}

/// Targets such that no geometry has them all: lengths that span more than any stretch, angles of which one is beyond the largest.
fn pull_apart(segment: &Segment, values: &mut [f64]) {
    let middle = values.iter().sum::<f64>() / values.len() as f64;
    let spread = values.iter().map(|value| (value - middle).abs()).fold(f64::MIN_POSITIVE, f64::max);
    for value in values.iter_mut() {
        *value = match segment.motion {
            Motion::Extension => middle * PULLED.powf((*value - middle) / spread * 2.0),
            _ => *value * PULLED * 4.0,
        };
    }
}

/// A supply line with wide bounds and targets that contradict each other, to measure searches on: two to five segments of any motion, two
/// to five phases, each target from another hidden design, so that no common pressures meet them all. Pressures reach beyond limit points.
pub fn wide_line(seed: u64) -> Problem {
    let mut random = Random::new(seed, 0x51de);
    let count = 2 + (random.uniform() * 4.0) as usize;
    let phases = 2 + (random.uniform() * 4.0) as usize;
    let segment = |index: usize| {
        let motions = [Motion::Extension, Motion::Twisting, Motion::Bending, Motion::Expansion];
        let mut segment = wide(motions[(random.uniform() * 4.0) as usize]);
        segment.name = format!("{} {}", segment.name, index + 1);
        while segment.goals.len() < phases {
            segment.goals.extend(hidden_goal(&segment, &mut random).map(Some));
        }
        segment
    };
    Problem { segments: (0..count).map(segment).collect(), shared_pressure: true }
}

/// [`bounded`] with wide bounds.
fn wide(motion: Motion) -> Segment {
    let mut segment = bounded(motion);
    let angle_deg: [f64; 2] = match motion {
        Motion::Twisting => [10.0, 60.0],
        Motion::Expansion => [60.0, 90.0],
        Motion::Extension | Motion::Bending => [0.0, 35.0],
    };
    segment.bounds.sizes_m = [[4e-3, 20e-3], [1.5e-3, 8e-3]];
    segment.bounds.length_m = [0.05, 0.5];
    segment.bounds.angle_rad = angle_deg.map(f64::to_radians);
    segment.pressure_max_pa = 120e3;
    segment
}

/// What a hidden design does at a hidden pressure below its limit point; `None` where that is not known.
fn hidden_goal(segment: &Segment, random: &mut Random) -> Option<Goal> {
    let geometry = segment.geometry(&random.point(segment.dimensions()));
    let pressure_pa = segment.pressure_max_pa * random.uniform();
    let actuator = Actuator::new(&segment.parameters(&geometry)).ok()?;
    let solution = actuator.forward(pressure_pa, &Load::none()).ok()?;
    let value = segment.measure(&solution.state, geometry.length_m);
    let is_length = matches!(segment.motion, Motion::Extension | Motion::Expansion);
    let weight = if is_length { PER_M2 } else { PER_RAD2 };
    (solution.status == Status::Solved).then_some(Goal { value, weight })
}
