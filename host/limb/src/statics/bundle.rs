//! Parallel tubes between rigid plates as one rod: its shape without load and its stiffness per length at rest.
//!
//! At a stretch `lambda`, bends `u` (towards `x` and `y`) and a twist rate `t` the tube at `r_i` has the stretch `lambda - u . r_i`. The
//! energy of all tubes, each by its own tangent ([`Tangent`]), is a square form in `(lambda, u_x, u_y, t)`; its minimum is the free shape.
//! Plates that slide against each other bend the tubes between them to an S: `12 EI/a^2` a tube for plates `a` apart as they are stretched, in
//! series with the shear of the walls. Plates that turn against each other do the same to tubes off the axis. A rod whose bends follow its moments
//! has a part of that S already, `a^2/12` over the bending stiffness of the bundle: it is taken off the slide, so that a chain of plates and the
//! rod yield alike to small loads.

use fra_model::Motion;
use nalgebra::{Matrix2, Matrix4, Matrix4x2, Matrix6, Vector4, Vector6};

use super::restraint::{Leaning, equilibrium, tangent};
use super::rod::Piece;
use super::spring::{Spring, TubeStrain};
use super::tube::{LINE, Tangent};
use crate::LimbModule;

/// Turns for the springs of twisting tubes without load, and the change of a strain up to which they are right, times the distance of plates where
/// it is a rate.
const TURNS: usize = 20;
/// Turns after which bending and shear stiffness of their walls change no more.
const WALLS: usize = 3;
const CONVERGED: f64 = 1e-10;
/// Compliance to bending that the rod of leaning tubes lacks, over the square of their lean by bending: 0.8 to 1.5 beside tubes as rods of their
/// own, on circles of 31 to 60 mm with up to 104 deg between plates 120 to 200 mm apart.
const LEAN: f64 = 1.1;
/// Share of the slide of leaning tubes, with their plates not bent, that a rod's bends may have. Struts that lean far slide less than a rod
/// bends.
const BENDS_MOST: f64 = 0.8;

/// The shape of a bundle, per length at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// Stretch of the bundle's axis.
    pub stretch: f64,
    /// Bend towards `x`, which is the module's mount angle, and towards `y`, rad/m.
    pub bend_rad_per_m: [f64; 2],
    /// Twist, rad/m.
    pub twist_rad_per_m: f64,
}

impl Free {
    /// Stretch, bends and twist, as [`Bundle::stiffness`] has them.
    fn strain(&self) -> Vector4<f64> {
        let [x, y] = self.bend_rad_per_m;
        Vector4::new(self.stretch, x, y, self.twist_rad_per_m)
    }
}

/// How plates slide against each other in one direction, per force across the bundle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slide {
    /// Slide of the tubes between them, 1/N.
    pub(super) tubes: f64,
    /// The part of it that a rod has by its bends, 1/N.
    pub(super) bends: f64,
}

/// A bundle at given pressures.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// Its shape without load.
    pub free: Free,
    /// Second derivatives of its energy by stretch, bends and twist rate: N, N m, N m2 and so on.
    pub stiffness: Matrix4<f64>,
    /// Second derivatives by these four and by slides towards `x` and `y`: not 0 where tubes of a twisting bundle lean.
    pub coupled: Matrix4x2<f64>,
    /// Slides towards `x` and `y` without load.
    pub free_shear: [f64; 2],
    /// Shear stiffness, N.
    pub shear_n: f64,
    /// What it shortens by when it slides, over the square of the slide and the stretch: 3/5 for slender tubes, less where walls shear.
    pub sway: f64,
    /// How it slides towards `x` and `y`.
    pub(super) slides: [Slide; 2],
    /// Distance of its plates at rest, m.
    pub bay_m: f64,
    /// Position of each tube in the section, m, and the tube.
    pub tubes: Vec<([f64; 2], Tangent)>,
    /// The models of the tubes; none of tubes that are linear springs.
    springs: Vec<Spring>,
}

impl Bundle {
    /// The bundle of a module with a gauge pressure, Pa, in each actuator, and `bays` >= 1 stretches between plates, so `bays - 1` spacers.
    ///
    /// `None` where an actuator has no equilibrium at its pressure or is a series, or where there is not one pressure per actuator. The lines of bending
    /// actuators at different heights hold each other; in a row along the axis of bending they add no stiffness in its plane.
    pub fn new(module: &LimbModule, pressures_pa: &[f64], bays: usize) -> Option<Self> {
        Self::with_known(module, pressures_pa, bays, Vec::new())
    }

    /// The bundle of the same module at other gauge pressures, Pa: actuators that keep theirs are not solved again. `None` as of [`Bundle::new`].
    pub fn at_pressures(&self, module: &LimbModule, pressures_pa: &[f64]) -> Option<Self> {
        // Where plates hold tubes back, their springs depend on the whole bundle.
        let known = if module.is_restrained() { &[] } else { &self.springs[..] };
        let known = known.iter().map(|spring| (spring.pressure_pa(), spring.clone())).collect();
        Self::with_known(module, pressures_pa, self.bays(module.length_m()), known)
    }

    fn with_known(
        module: &LimbModule,
        pressures_pa: &[f64],
        bays: usize,
        mut known: Vec<(f64, Spring)>,
    ) -> Option<Self> {
        if pressures_pa.len() != module.channels.len() || bays == 0 || module.is_series() {
            return None;
        }
        // Bundles mostly have one pressure, and the model is what costs.
        let mut springs = Vec::with_capacity(pressures_pa.len());
        for (position, pressure_pa) in module.positions_m().into_iter().zip(pressures_pa) {
            let found = known.iter().find(|(pressure, _)| pressure == pressure_pa).map(|(_, spring)| spring.clone());
            let spring = found.or_else(|| module.spring(*pressure_pa))?;
            known.push((*pressure_pa, spring.clone()));
            springs.push((position, spring));
        }
        Self::of_springs(module.motion, springs, module.length_m() / bays as f64)
    }

    /// The bundle of tubes at places of the section, m, by their models, with plates `bay_m` apart. `None` where their energy has no minimum.
    ///
    /// Twisting tubes beside the axis are held far from their free shape: their springs are about the shape that they have between the plates.
    pub fn of_springs(motion: Motion, springs: Vec<([f64; 2], Spring)>, bay_m: f64) -> Option<Self> {
        let tubes: Vec<_> = springs.iter().map(|(place, spring)| (*place, spring.tangent())).collect();
        let springs = springs.into_iter().map(|(_, spring)| spring).collect();
        let mut bundle = Self { springs, ..Self::of_tubes(motion, tubes, bay_m)? };
        if !holds_back(motion, &bundle.tubes) {
            return Some(bundle);
        }
        for turn in 0..TURNS {
            let before = bundle.free.strain();
            if turn < WALLS {
                bundle.springs = bundle.held_springs(&before)?;
            }
            let tubes = bundle.tubes_at(motion, &before)?;
            let rest = equilibrium(&tubes, bay_m, Some(&sliding(&before, bundle.free_shear)))?;
            bundle = Self { springs: bundle.springs, ..Self::leaning_about(rest, tubes, bay_m)? };
            let change = bundle.free.strain() - before;
            if turn >= WALLS && change.x.abs().max(bay_m * change.fixed_rows::<3>(1).amax()) <= CONVERGED {
                return Some(bundle);
            }
        }
        None
    }

    /// The same bundle with its tubes' springs about strains of the bundle: stretch, bends and twist, as [`Bundle::stiffness`] has them.
    ///
    /// `None` where a tube has no stable equilibrium there, or where its tubes are linear springs.
    pub fn strained(&self, motion: Motion, strain: &Vector4<f64>) -> Option<Self> {
        let tubes = self.tubes_at(motion, strain)?;
        let found = if holds_back(motion, &tubes) {
            // The slide of leaning tubes is no linear spring either.
            Self::leaning_about(tangent(&tubes, self.bay_m, &sliding(strain, [0.0; 2]))?, tubes, self.bay_m)
        } else {
            Self::about(minimum(motion, &tubes)?, tubes, self.bay_m)
        };
        Some(Self { springs: self.springs.clone(), ..found? })
    }

    /// The models of twisting tubes with the walls that they have where plates hold them.
    fn held_springs(&self, strain: &Vector4<f64>) -> Option<Vec<Spring>> {
        let mut known: Vec<(TubeStrain, &Spring, Spring)> = Vec::new();
        let mut springs = Vec::with_capacity(self.springs.len());
        for ((place, tube), spring) in self.tubes.iter().zip(&self.springs) {
            let leaning = leaning(*place, tube, self.bay_m, strain)?;
            let own = [leaning.stretch, 0.0, leaning.twist_rad_per_m];
            let found = known.iter().find(|(strain, other, _)| *strain == own && other.is_like(spring));
            let held = found.map(|(.., held)| held.clone()).or_else(|| spring.held_at(&own))?;
            known.push((own, spring, held.clone()));
            springs.push(held);
        }
        Some(springs)
    }

    /// Its tubes with their springs about strains of the bundle.
    fn tubes_at(&self, motion: Motion, strain: &Vector4<f64>) -> Option<Vec<([f64; 2], Tangent)>> {
        if self.springs.is_empty() {
            return None;
        }
        let mut known: Vec<(TubeStrain, &Spring, Tangent)> = Vec::new();
        let mut tubes = Vec::with_capacity(self.tubes.len());
        let held = holds_back(motion, &self.tubes);
        for ((place, tube), spring) in self.tubes.iter().zip(&self.springs) {
            let own = if held {
                let leaning = leaning(*place, tube, self.bay_m, strain)?;
                [leaning.stretch, 0.0, leaning.twist_rad_per_m]
            } else {
                tube_strain(motion, *place, strain)
            };
            let found = known.iter().find(|(strain, other, _)| *strain == own && other.is_like(spring));
            let about = || if held { spring.wound_at(&own) } else { spring.tangent_at(&own) };
            let tangent = found.map(|(.., tangent)| *tangent).or_else(about)?;
            known.push((own, spring, tangent));
            tubes.push((*place, tangent));
        }
        Some(tubes)
    }

    /// Whether its tubes know their models.
    pub(super) fn has_springs(&self) -> bool {
        !self.springs.is_empty()
    }

    /// The bundle of tubes at places of the section, m, with plates `bay_m` apart. `None` where their energy has no minimum.
    pub fn of_tubes(motion: Motion, tubes: Vec<([f64; 2], Tangent)>, bay_m: f64) -> Option<Self> {
        if holds_back(motion, &tubes) {
            return Self::leaning_about(equilibrium(&tubes, bay_m, None)?, tubes, bay_m);
        }
        Self::about(minimum(motion, &tubes)?, tubes, bay_m)
    }

    /// The same with its shape without load and the stiffness there.
    fn about(
        (free, mut stiffness): (Vector4<f64>, Matrix4<f64>),
        tubes: Vec<([f64; 2], Tangent)>,
        bay_m: f64,
    ) -> Option<Self> {
        let long_m = free[0] * bay_m;
        let slides = slides(&stiffness, &tubes, long_m);
        let turning = |([x, y], tube): &([f64; 2], Tangent)| slide_n(tube, mean_nm2(tube), long_m) * (x * x + y * y);
        stiffness[(3, 3)] += tubes.iter().map(turning).sum::<f64>();
        let shear_n = 1.0 / own_slide(&slides);
        Some(Self::of_parts(&sliding(&free, [0.0; 2]), (stiffness, Matrix4x2::zeros(), shear_n), slides, tubes, bay_m))
    }

    /// The same of leaning tubes, with the stiffness of their plates, slides included.
    fn leaning_about(
        (free, plates): (Vector6<f64>, Matrix6<f64>),
        tubes: Vec<([f64; 2], Tangent)>,
        bay_m: f64,
    ) -> Option<Self> {
        let long_m = free[0] * bay_m;
        if tubes.len() == 1 {
            // It stands for its circle, whose slides are not known.
            let stiffness = plates.fixed_view::<4, 4>(0, 0).into_owned();
            let slides = slides(&stiffness, &tubes, long_m);
            let parts = (stiffness, Matrix4x2::zeros(), 1.0 / own_slide(&slides));
            return Some(Self::of_parts(&free, parts, slides, tubes, bay_m));
        }
        let mut yields = plates.cholesky()?.inverse();
        let bends = yields.fixed_view::<2, 2>(1, 1) * (long_m * long_m / 12.0);
        let bends = bends * f64::min(1.0, BENDS_MOST / largest(&(bends * plates.fixed_view::<2, 2>(4, 4))));
        let slides = [0, 1].map(|axis| Slide { tubes: yields[(4 + axis, 4 + axis)], bends: bends[(axis, axis)] });
        // A rod has the slide of its bends by itself.
        let mut own = yields.fixed_view_mut::<2, 2>(4, 4);
        own -= bends;
        let rod = yields.cholesky()?.inverse();
        let parts = (
            rod.fixed_view::<4, 4>(0, 0).into_owned(),
            rod.fixed_view::<4, 2>(0, 4).into_owned(),
            0.5 * (rod[(4, 4)] + rod[(5, 5)]),
        );
        // The stiffness about a strain has the work of axial forces on slides.
        Some(Self { sway: 0.0, ..Self::of_parts(&free, parts, slides, tubes, bay_m) })
    }

    fn of_parts(
        free: &Vector6<f64>,
        (stiffness, coupled, shear_n): (Matrix4<f64>, Matrix4x2<f64>, f64),
        slides: [Slide; 2],
        tubes: Vec<([f64; 2], Tangent)>,
        bay_m: f64,
    ) -> Self {
        let long_m = free[0] * bay_m;
        let sway = 0.5 * (sway(&slides[0], 0, &tubes, long_m) + sway(&slides[1], 1, &tubes, long_m));
        let free_shear = [free[4], free[5]];
        let free = Free { stretch: free[0], bend_rad_per_m: [free[1], free[2]], twist_rad_per_m: free[3] };
        Self { free, stiffness, coupled, free_shear, shear_n, sway, slides, bay_m, tubes, springs: Vec::new() }
    }

    /// Slide of a rod's own per force across it, 1/N: that of the tubes without the part that the rod's bends have.
    pub(super) fn own_slide(&self) -> f64 {
        own_slide(&self.slides)
    }

    /// The bundle as a rod of a length at rest, m, without mass and with nothing behind it.
    pub fn piece(&self, length_m: f64) -> Piece {
        let Free { stretch, bend_rad_per_m: [x, y], twist_rad_per_m } = self.free;
        Piece {
            free: [stretch, x, y, twist_rad_per_m],
            free_shear: self.free_shear,
            stiffness: self.stiffness,
            coupled: self.coupled,
            shear_n: self.shear_n,
            sway: self.sway,
            length_m,
            mount_angle_rad: 0.0,
            kg_per_m: 0.0,
            rigid_m: 0.0,
            masses: Vec::new(),
        }
    }

    /// How a tube leans in the shape without load, where plates hold twisting tubes back; `None` for other tubes.
    pub(crate) fn leaning(&self, motion: Motion, tube: usize) -> Option<Leaning> {
        let (place, tangent) = self.tubes.get(tube).filter(|_| holds_back(motion, &self.tubes))?;
        leaning(*place, tangent, self.bay_m, &self.free.strain())
    }

    /// Share by which leaning tubes bend more easily than the rod, about, in the shape without load; `None` where plates hold none back.
    pub(super) fn softer(&self, motion: Motion) -> Option<f64> {
        let of = |leaning: Leaning| LEAN * leaning.bend * leaning.bend;
        (0..self.tubes.len()).filter_map(|tube| self.leaning(motion, tube)).map(of).reduce(f64::max)
    }

    /// Stretches between plates in a module of this length at rest, m.
    pub(super) fn bays(&self, length_m: f64) -> usize {
        (length_m / self.bay_m).round().max(1.0) as usize
    }
}

/// Strains of a bundle with the slides of its plates.
fn sliding(strain: &Vector4<f64>, [x, y]: [f64; 2]) -> Vector6<f64> {
    Vector6::new(strain.x, strain.y, strain.z, strain.w, x, y)
}

/// The largest eigenvalue of a product of two symmetric matrices with positive ones.
fn largest(product: &Matrix2<f64>) -> f64 {
    let half = 0.5 * product.trace();
    half + (half * half - product.determinant()).max(0.0).sqrt()
}

/// Mean slide of both directions that is the rod's own, per force, 1/N.
fn own_slide(slides: &[Slide; 2]) -> f64 {
    0.5 * slides.iter().map(|slide| slide.tubes - slide.bends).sum::<f64>()
}

/// Bending stiffness of a tube towards `x` and `y`, N m2.
fn bends_nm2(tube: &Tangent) -> [f64; 2] {
    [tube.bending_nm2, tube.across_nm2]
}

/// The mean of both.
pub(super) fn mean_nm2(tube: &Tangent) -> f64 {
    0.5 * (tube.bending_nm2 + tube.across_nm2)
}

/// Force per slide of a tube between plates `long_m` apart as they are stretched: an S in series with the shear of the wall, N.
pub(super) fn slide_n(tube: &Tangent, bending_nm2: f64, long_m: f64) -> f64 {
    1.0 / (1.0 / tube.shear_n + long_m * long_m / (12.0 * bending_nm2))
}

/// Slides of a bundle with the stiffness of its stretch and bends.
fn slides(stiffness: &Matrix4<f64>, tubes: &[([f64; 2], Tangent)], long_m: f64) -> [Slide; 2] {
    [0, 1].map(|axis| {
        let all_n: f64 = tubes.iter().map(|(_, tube)| slide_n(tube, bends_nm2(tube)[axis], long_m)).sum();
        let at = axis + 1;
        // The stretch gives way to the bend.
        let whole_nm2 = stiffness[(at, at)] - stiffness[(0, at)].powi(2) / stiffness[(0, 0)];
        Slide { tubes: 1.0 / all_n, bends: long_m * long_m / (12.0 * whole_nm2) }
    })
}

/// By how much a tube of a slide `g` shortens, over `g^2/2`, where the part `share` of the slide is an S and the rest shear of the wall: an S
/// leans by 6/5 of its square, and a wall that shears leans only with what is bent before it.
pub(super) fn shortening(share: f64) -> f64 {
    (2.0 - 0.8 * share) * share
}

/// Shortening of the rod's own slide, so that with that of its bends it is the mean of the tubes'.
fn sway(slide: &Slide, axis: usize, tubes: &[([f64; 2], Tangent)], long_m: f64) -> f64 {
    let of_tube = |(_, tube): &([f64; 2], Tangent)| {
        let bending_nm2 = bends_nm2(tube)[axis];
        shortening(slide_n(tube, bending_nm2, long_m) * long_m * long_m / (12.0 * bending_nm2))
    };
    let mean = tubes.iter().map(of_tube).sum::<f64>() / tubes.len() as f64;
    let own = slide.tubes - slide.bends;
    0.5 * (mean * slide.tubes * slide.tubes - (1.2 * slide.bends + 2.0 * own) * slide.bends) / (own * own)
}

/// Whether plates hold tubes back from the twist that they have alone.
fn holds_back(motion: Motion, tubes: &[([f64; 2], Tangent)]) -> bool {
    motion == Motion::Twisting && tubes.iter().any(|([x, y], _)| *x != 0.0 || *y != 0.0)
}

fn leaning([x, y]: [f64; 2], tube: &Tangent, bay_m: f64, strain: &Vector4<f64>) -> Option<Leaning> {
    // Plates that turn against each other bend about the middle between them.
    let cos = (0.5 * strain.w * bay_m).cos();
    Leaning::of(tube, x.hypot(y), bay_m, strain.x - (strain.y * x + strain.z * y) * cos, strain.w)
}

/// Shape of least energy of tubes that plates do not hold back, and the stiffness of stretch, bends and twist.
fn minimum(motion: Motion, tubes: &[([f64; 2], Tangent)]) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let (mut stiffness, mut force) = (Matrix4::zeros(), Vector4::zeros());
    for (place, tube) in tubes {
        let (own, rest) = energy(motion, *place, tube);
        stiffness += own;
        force += own * rest;
    }
    Some((stiffness.cholesky()?.solve(&force), stiffness))
}

/// The square form of one tube and its minimum.
pub(super) fn energy(motion: Motion, [x, y]: [f64; 2], tube: &Tangent) -> (Matrix4<f64>, Vector4<f64>) {
    // What turns and is not wound to turn is held by the others, as the kinematics have it.
    let (twist, coupling) =
        if motion == Motion::Twisting { (tube.twist_rad_per_m, tube.coupling_nm) } else { (0.0, 0.0) };
    let rest = Vector4::new(tube.stretch, tube.bend_rad_per_m, 0.0, twist);
    let mut own = Matrix4::from_diagonal(&Vector4::new(0.0, tube.bending_nm2, tube.across_nm2, tube.torsion_nm2));
    let arm = Vector4::new(1.0, -x, -y, 0.0);
    if motion == Motion::Bending {
        // The line that keeps its length is at the outer radius, on the side that the tube bends to.
        let line = Vector4::new(1.0, -(x + tube.outer_radius_m), 0.0, 0.0);
        own += line * line.transpose() * tube.axial_n;
        // Across, the walls at both sides count alone: a line goes slack where it is pushed.
        own[(2, 2)] += tube.axial_n / LINE * y * y;
        let rest = rest + Vector4::new(x * tube.bend_rad_per_m, 0.0, 0.0, 0.0);
        return (own, rest);
    }
    own += arm * arm.transpose() * tube.axial_n;
    let turn = Vector4::new(0.0, 0.0, 0.0, coupling);
    own += arm * turn.transpose() + turn * arm.transpose();
    (own, rest)
}

/// Strains of a tube at a place of the section, m, where its bundle has these.
fn tube_strain(motion: Motion, [x, y]: [f64; 2], bundle: &Vector4<f64>) -> TubeStrain {
    let [stretch, bend_x, bend_y, twist] = <[f64; 4]>::from(*bundle);
    match motion {
        Motion::Bending => [stretch, bend_x, 0.0],
        Motion::Twisting => [stretch, 0.0, twist],
        Motion::Extension | Motion::Expansion => [stretch - bend_x * x - bend_y * y, 0.0, 0.0],
    }
}
