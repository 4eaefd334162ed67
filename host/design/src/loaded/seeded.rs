//! Seeded tasks that a hidden limb does under load: for tests and comparisons of searches.

use nalgebra::Vector3;

use super::built::Built;
use super::evaluate::{Judgement, evaluate};
use super::inverse::Stand;
use super::local_solve::NOTHING;
use super::space::{LimbSizes, LimbSpace};
use super::task::{LoadedPose, LoadedTask};
use crate::synthesis::Aim;
use softlimb_numerics::Random;

/// Limbs that are drawn for a task at most.
const DRAWS: usize = 3000;
/// Standard deviation of a limb about the first guess, in the unit box.
const SPREAD: f64 = 0.2;
/// Bounds of the pressures of a pose over their ranges, and of the payload, kg.
const SHARES: [f64; 2] = [0.05, 0.95];
const PAYLOAD_KG: [f64; 2] = [0.2, 0.6];
/// Least distance of two poses, m.
const APART_M: f64 = 0.05;

/// A task with the limb that it was made with.
#[derive(Clone, Debug)]
pub struct Seeded {
    /// The task.
    pub task: LoadedTask,
    /// Sizes that keep every margin of it.
    pub hidden: LimbSizes,
}

/// A task that a limb of the space does: it takes a payload up, moves it, and puts it down, at three places where the hidden limb has its tip under these
/// loads. Rigid parts and limits are those of `like`; there are no obstacles. `None` where no limb that was drawn keeps every margin.
pub fn seeded(like: &LoadedTask, space: &LimbSpace, seed: u64) -> Option<Seeded> {
    let mut random = Random::new(seed, 3);
    let guess = space.first_guess();
    let between = |random: &mut Random, [low, high]: [f64; 2]| low + (high - low) * random.uniform();
    (0..DRAWS).find_map(|_| {
        let point: Vec<f64> = guess.iter().map(|x| (x + SPREAD * random.normal()).clamp(0.0, 1.0)).collect();
        let hidden = space.sizes(&point);
        let kg = between(&mut random, PAYLOAD_KG);
        let poses = [("pick", 0.0, kg), ("carry", kg, kg), ("place", kg, 0.0)];
        let shares = poses.map(|_| hidden.home.iter().map(|_| between(&mut random, SHARES)).collect::<Vec<f64>>());
        let mut task = LoadedTask { obstacles: Vec::new(), poses: Vec::new(), ..like.clone() };
        let built = Built::new(&task, space, &hidden, 0.0)?;
        for ((name, move_kg, hold_kg), shares) in poses.into_iter().zip(&shares) {
            let tip_m = Stand::at(&built, shares, move_kg, None).ok()?.tip_m();
            let pose = LoadedPose {
                name: name.to_owned(),
                aim: Aim::Point(tip_m),
                direction: None,
                move_kg,
                hold_kg,
                carried: None,
            };
            task.poses.push(pose);
        }
        let apart = |pair: &[LoadedPose]| (place(&pair[0]) - place(&pair[1])).norm() >= APART_M;
        let keeps = task.poses.windows(2).all(apart)
            && evaluate(&task, space, &hidden, &Judgement::default())?.objective() <= NOTHING;
        keeps.then_some(Seeded { task, hidden })
    })
}

fn place(pose: &LoadedPose) -> Vector3<f64> {
    match &pose.aim {
        Aim::Point(place_m) => *place_m,
        Aim::Inside { center_m, .. } => *center_m,
    }
}
