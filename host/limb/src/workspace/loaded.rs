//! The workspace under weight: each pose is an equilibrium, or it is named why it is none.

use std::sync::Mutex;
use std::thread;

use nalgebra::DVector;

use super::sample::{Points, shares};
use super::space::Workspace;
use crate::statics::{Fidelity, LoadedLimb, Settled, Shape};

/// Compression of a tube over its load of buckling above which no rod is right.
const BUCKLED: f64 = 0.5;
/// Bend of a bending module the wrong way that is more than rounding, rad/m.
const BACKWARDS_RAD_PER_M: f64 = 0.05;
/// Samples that a thread takes at a time.
const PIECE: usize = 64;

/// Why a pose is not reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadedPoseError {
    /// An actuator has no equilibrium at its pressure.
    NoEquilibrium,
    /// The limb falls: the shape that it has without weight loses its stability while the weight grows.
    Falls,
    /// A tube of this module carries more than half of the load that it buckles at between two plates.
    Buckles(usize),
    /// This bending module is bent backwards, where its lines would have to shorten.
    BentBack(usize),
}

/// A pose under load.
#[derive(Clone, Debug)]
pub struct Pose {
    /// The tip, m.
    pub tip_m: [f64; 3],
    /// Its shape.
    pub shape: Shape,
}

/// How many poses are reached, and why the others are not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Reached.
    pub reached: usize,
    /// An actuator has no equilibrium.
    pub no_equilibrium: usize,
    /// The limb falls.
    pub falls: usize,
    /// By module: a tube of it is too near to buckling.
    pub buckles: Vec<usize>,
    /// By module: it is bent backwards.
    pub bent_back: Vec<usize>,
}

impl Tally {
    fn add(&mut self, unreached: LoadedPoseError) {
        match unreached {
            LoadedPoseError::NoEquilibrium => self.no_equilibrium += 1,
            LoadedPoseError::Falls => self.falls += 1,
            LoadedPoseError::Buckles(module) => self.buckles[module] += 1,
            LoadedPoseError::BentBack(module) => self.bent_back[module] += 1,
        }
    }

    /// All poses.
    pub fn total(&self) -> usize {
        let named = self.buckles.iter().chain(&self.bent_back).sum::<usize>();
        self.reached + self.no_equilibrium + self.falls + named
    }
}

/// A box of pressures, and the limb that hangs at each of its places.
pub struct Loaded<'a, 'b, H> {
    space: &'b Workspace<'a>,
    hang: H,
}

impl<'a, 'b, H: Fn(&[f64]) -> Option<LoadedLimb> + Sync> Loaded<'a, 'b, H> {
    /// `hang` gives the limb with its loads at the gauge pressures, Pa, of all channels; `None` where an actuator has no equilibrium.
    pub fn new(space: &'b Workspace<'a>, hang: H) -> Self {
        Self { space, hang }
    }

    /// The box.
    pub fn space(&self) -> &'b Workspace<'a> {
        self.space
    }

    /// Number of modules.
    fn modules(&self) -> usize {
        self.space.limb().modules().len()
    }

    /// The pose at shares of the highest pressures, on the branch of shapes that growing weight leads to; or, where there is a `start`, the unknowns
    /// of a pose nearby, on its branch.
    ///
    /// # Errors
    /// [`LoadedPoseError`], as its variants say.
    pub fn pose(
        &self,
        share: impl Fn(usize) -> f64,
        tier: Fidelity,
        start: Option<&DVector<f64>>,
    ) -> Result<Pose, LoadedPoseError> {
        let axes = self.space.axes().iter().enumerate();
        let pressures_pa: Vec<f64> = axes
            .flat_map(|(index, axis)| std::iter::repeat_n(share(index) * axis.pressure_max_pa, axis.channels.len()))
            .collect();
        let limb = (self.hang)(&pressures_pa).ok_or(LoadedPoseError::NoEquilibrium)?;
        let Settled { limb, rod, shape } = limb.settle(tier, start).map_err(|_| LoadedPoseError::Falls)?;
        if let Some(tube) = limb.buckling(&rod, &shape).filter(|tube| tube.ratio() > BUCKLED) {
            return Err(LoadedPoseError::Buckles(tube.module));
        }
        if let Some(module) = limb.bent_back(&rod, &shape, BACKWARDS_RAD_PER_M) {
            return Err(LoadedPoseError::BentBack(module));
        }
        Ok(Pose { tip_m: shape.tip().translation.vector.into(), shape })
    }

    /// Poses of the first `count` samples by the linear tier, each from the limb without weight, so that neither their order nor the number of
    /// threads matters.
    pub fn sample(
        &self,
        points: Points,
        count: usize,
        seed: u64,
        threads: usize,
    ) -> Vec<Result<[f64; 3], LoadedPoseError>> {
        let share = shares(self.space.axes().len(), points, seed);
        self.each(count, threads, |index| {
            self.pose(|axis| share(index, axis), Fidelity::Linear, None).map(|pose| pose.tip_m)
        })
    }

    /// What `of` says of the numbers up to `count`, in their order.
    pub(super) fn each<T: Send>(&self, count: usize, threads: usize, of: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let length = PIECE.min(count.div_ceil(threads.max(1))).max(1);
        let mut found: Vec<Option<T>> = (0..count).map(|_| None).collect();
        let pieces = Mutex::new(found.chunks_mut(length).enumerate());
        let work = || {
            loop {
                let next = pieces.lock().expect("no panic while it is held").next();
                let Some((piece, found)) = next else { break };
                for (index, found) in found.iter_mut().enumerate() {
                    *found = Some(of(piece * length + index));
                }
            }
        };
        thread::scope(|scope| {
            (1..threads).for_each(|_| drop(scope.spawn(work)));
            work();
        });
        found.into_iter().flatten().collect()
    }

    /// How many of the poses are reached.
    pub fn tally(&self, poses: &[Result<[f64; 3], LoadedPoseError>]) -> Tally {
        let none = vec![0; self.modules()];
        let mut tally = Tally { buckles: none.clone(), bent_back: none, ..Tally::default() };
        for pose in poses {
            match pose {
                Ok(_) => tally.reached += 1,
                Err(unreached) => tally.add(*unreached),
            }
        }
        tally
    }
}
