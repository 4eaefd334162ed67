//! Forward and inverse problems of many actuators at once, on the vector units and the processors that are there.

use std::num::NonZero;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::{Mutex, OnceLock};
use std::thread;

use fra_model::{
    Actuator, Arithmetic, InvalidParameter, LANES, Lanes, Motion, Prepared, PressureRange, Solution, Target,
    atanh_series, forward_many, forward_prepared, inverse_many,
};
use pulp::{Arch, Simd, WithSimd};

/// Fewest actuators that are worth a thread.
const SHARE: usize = 2048;
/// Actuators that a thread takes at a time.
const PIECE: usize = 512;

/// The equilibria of actuators, each at its own gauge pressure, Pa, without external load, written to `solutions`.
///
/// The answers are those of [`Actuator::forward`] of each, up to rounding. For several pressures of the same actuators, [`ActuatorBatch`] is
/// faster.
///
/// # Panics
/// When the slices differ in length.
///
/// # Errors
/// [`InvalidParameter`] when a pressure is not finite; the solutions are then of no use.
pub fn forward(
    actuators: &[Actuator<f64>],
    pressures_pa: &[f64],
    solutions: &mut [Solution<f64>],
) -> Result<(), InvalidParameter<f64>> {
    in_shares(LANES, actuators, pressures_pa, solutions, |_, actuators, pressures_pa, solutions| {
        Arch::new().dispatch(Batch { prepared: None, actuators, pressures_pa, solutions })
    })
}

/// The gauge pressures in a range, Pa, at which actuators reach a target each without external load, written to `solutions`.
///
/// The answers are those of [`Actuator::inverse_within`] of each, up to rounding.
///
/// # Panics
/// When the slices differ in length.
///
/// # Errors
/// As [`Actuator::inverse_within`]; the solutions are then of no use.
pub fn inverse(
    actuators: &[Actuator<f64>],
    targets: &[Target<f64>],
    range: &PressureRange<f64>,
    solutions: &mut [Solution<f64>],
) -> Result<(), InvalidParameter<f64>> {
    in_shares(LANES, actuators, targets, solutions, |_, actuators, targets, solutions| {
        Arch::new().dispatch(InverseBatch { actuators, targets, range, solutions })
    })
}

/// Actuators, borrowed or owned, to be solved side by side at any number of pressures.
#[derive(Debug)]
pub struct ActuatorBatch<A> {
    actuators: A,
    lanes: usize,
    /// Straight tubes in the layout of the vector units, from the first forward solve on; none of actuators that all bend.
    groups: OnceLock<Vec<Prepared<f64>>>,
}

impl<A: AsRef<[Actuator<f64>]>> ActuatorBatch<A> {
    /// For the vector units that are there.
    pub fn new(actuators: A) -> Self {
        Self { actuators, lanes: Arch::new().dispatch(Width), groups: OnceLock::new() }
    }

    fn groups(&self) -> &[Prepared<f64>] {
        self.groups.get_or_init(|| {
            let actuators = self.actuators();
            let all_bend = actuators.iter().all(|actuator| actuator.parameters().motion == Motion::Bending);
            if all_bend { Vec::new() } else { actuators.chunks(self.lanes).map(Prepared::new).collect() }
        })
    }

    /// The actuators, in order.
    pub fn actuators(&self) -> &[Actuator<f64>] {
        self.actuators.as_ref()
    }

    /// Number of actuators that are solved side by side.
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// [`forward`](Self::forward) of the actuators from the index `from` on, as many as there are pressures, on the calling thread: for callers
    /// with threads of their own.
    ///
    /// # Panics
    /// When `from` is no multiple of [`lanes`](Self::lanes), or there are fewer solutions or actuators than pressures.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a pressure is not finite.
    pub fn forward_from(
        &self,
        from: usize,
        pressures_pa: &[f64],
        solutions: &mut [Solution<f64>],
    ) -> Result<(), InvalidParameter<f64>> {
        assert!(from.is_multiple_of(self.lanes) && pressures_pa.len() <= solutions.len(), "whole groups");
        let actuators = &self.actuators()[from..from + pressures_pa.len()];
        let groups = from / self.lanes..(from + actuators.len()).div_ceil(self.lanes);
        let prepared = self.groups().get(groups);
        Arch::new().dispatch(Batch { prepared, actuators, pressures_pa, solutions })
    }

    /// [`inverse`] of the actuators from the index `from` on, as many as there are targets, on the calling thread.
    ///
    /// # Panics
    /// When there are fewer solutions or actuators than targets.
    ///
    /// # Errors
    /// As [`inverse`].
    pub fn inverse_from(
        &self,
        from: usize,
        targets: &[Target<f64>],
        range: &PressureRange<f64>,
        solutions: &mut [Solution<f64>],
    ) -> Result<(), InvalidParameter<f64>> {
        assert!(targets.len() <= solutions.len(), "one solution a target");
        let actuators = &self.actuators()[from..from + targets.len()];
        Arch::new().dispatch(InverseBatch { actuators, targets, range, solutions })
    }

    /// [`forward`] of the actuators.
    ///
    /// # Panics
    /// When there are not as many pressures or solutions as actuators.
    ///
    /// # Errors
    /// [`InvalidParameter`] when a pressure is not finite.
    pub fn forward(&self, pressures_pa: &[f64], solutions: &mut [Solution<f64>]) -> Result<(), InvalidParameter<f64>>
    where
        A: Sync,
    {
        in_shares(self.lanes, self.actuators(), pressures_pa, solutions, |from, _, pressures_pa, solutions| {
            self.forward_from(from, pressures_pa, solutions)
        })
    }
}

/// Asked once: to find out takes as long as to solve hundreds of actuators.
fn processors() -> usize {
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    *PROCESSORS.get_or_init(|| thread::available_parallelism().map_or(1, NonZero::get))
}

/// Runs `solve` on pieces of the slices, which begin at multiples of `group`, on as many processors as they are worth, each of which takes
/// a piece when it is done with one; it is told where its piece begins.
fn in_shares<Q: Sync>(
    group: usize,
    actuators: &[Actuator<f64>],
    given: &[Q],
    solutions: &mut [Solution<f64>],
    solve: impl Fn(usize, &[Actuator<f64>], &[Q], &mut [Solution<f64>]) -> Result<(), InvalidParameter<f64>> + Sync,
) -> Result<(), InvalidParameter<f64>> {
    assert_eq!((actuators.len(), actuators.len()), (given.len(), solutions.len()), "one of each per actuator");
    let threads = processors().min(actuators.len() / SHARE).max(1);
    let share = if threads > 1 { PIECE } else { actuators.len() };
    let share = share.next_multiple_of(group).max(group);
    let pieces = actuators.chunks(share).zip(given.chunks(share)).zip(solutions.chunks_mut(share));
    let pieces = Mutex::new(pieces.enumerate());
    // The error of the first piece that has one: pieces are taken in turn, so none before it is left out.
    let work = || {
        loop {
            let piece = pieces.lock().expect("no panic while it is held").next();
            let (i, ((actuators, given), solutions)) = piece?;
            if let Err(error) = solve(i * share, actuators, given, solutions) {
                return Some((i, error));
            }
        }
    };
    let errors = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let own = work();
        let others = others.into_iter().map(|other| other.join().expect("the solver does not panic"));
        others.chain([own]).flatten().collect::<Vec<_>>()
    });
    errors.into_iter().min_by_key(|(i, _)| *i).map_or(Ok(()), |(_, error)| Err(error))
}

/// The lanes of the widest vectors there are.
struct Width;

impl WithSimd for Width {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES.clamp(1, LANES)
    }
}

struct Batch<'a> {
    /// The actuators in groups of as many as there are lanes, where they are laid out already.
    prepared: Option<&'a [Prepared<f64>]>,
    actuators: &'a [Actuator<f64>],
    pressures_pa: &'a [f64],
    solutions: &'a mut [Solution<f64>],
}

impl WithSimd for Batch<'_> {
    type Output = Result<(), InvalidParameter<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { prepared, actuators, pressures_pa, solutions } = self;
        let token = Vector::of(simd, 0.0);
        let Some(prepared) = prepared else { return forward_many(token, actuators, pressures_pa, solutions) };
        forward_prepared(token, prepared, actuators, pressures_pa, solutions)
    }
}

struct InverseBatch<'a> {
    actuators: &'a [Actuator<f64>],
    targets: &'a [Target<f64>],
    range: &'a PressureRange<f64>,
    solutions: &'a mut [Solution<f64>],
}

impl WithSimd for InverseBatch<'_> {
    type Output = Result<(), InvalidParameter<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { actuators, targets, range, solutions } = self;
        inverse_many(Vector::of(simd, 0.0), actuators, targets, range, solutions)
    }
}

/// A vector register of the processor.
#[derive(Clone, Copy)]
struct Vector<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Vector<S> {
    #[inline(always)]
    fn of(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }
}

/// A method of one instruction.
macro_rules! instruction {
    ($method:ident, $name:ident $(, $other:ident)?) => {
        #[inline(always)]
        fn $method(self $(, $other: Self)?) -> Self {
            Self { simd: self.simd, values: self.simd.$name(self.values $(, $other.values)?) }
        }
    };
}

macro_rules! operator {
    ($trait:ident, $method:ident, $name:ident) => {
        impl<S: Simd> $trait for Vector<S> {
            type Output = Self;
            instruction!($method, $name, other);
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { simd: self.simd, values: self.simd.neg_f64s(self.values) }
    }
}

impl<S: Simd> Arithmetic for Vector<S> {
    instruction!(root, sqrt_f64s);
    instruction!(magnitude, abs_f64s);
    instruction!(least, min_f64s, other);
    instruction!(greatest, max_f64s, other);

    #[inline(always)]
    fn is_single(self) -> bool {
        false
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        let Self { simd, values } = self;
        let mask = simd.less_than_or_equal_f64s(values, other.values);
        let shares = simd.select_f64s(mask, simd.splat_f64s(1.0), simd.splat_f64s(0.0));
        simd.reduce_min_f64s(shares) > 0.0
    }

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Self::of(self.simd, value)
    }

    #[inline(always)]
    fn atanh_over(self, s2: Self) -> Self {
        atanh_series(s2)
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self { simd: self.simd, values: self.simd.negate_mul_add_e_f64s(a.values, b.values, self.values) }
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self { simd: self.simd, values: self.simd.mul_add_e_f64s(a.values, b.values, self.values) }
    }
}

impl<S: Simd> Lanes<f64> for Vector<S> {
    const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn load(self, values: &[f64; LANES]) -> Self {
        Self { simd: self.simd, values: S::as_simd_f64s(values).0[0] }
    }

    #[inline(always)]
    fn store(self, values: &mut [f64; LANES]) {
        S::as_mut_simd_f64s(values).0[0] = self.values;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fra_model::{ActuatorParameters, Families, Fiber, Load, Material, Placement, Status};
    use std::f64::consts::PI;

    fn actuator(i: usize) -> Actuator<f64> {
        let share = i as f64 / 10_000.0;
        let families = if i.is_multiple_of(3) { Families::One } else { Families::Two };
        let fiber = Fiber {
            angle_rad: 1.5 * (share * 7.0).fract(),
            families,
            modulus_pa: 1e5 * 1e4_f64.powf((share * 31.0).fract()),
            placement: if i.is_multiple_of(50) { Placement::Layer } else { Placement::Sheet },
            thickness_m: 2e-4,
            radius_m: 7.5e-3,
        };
        let motion = if i.is_multiple_of(101) { Motion::Bending } else { Motion::Extension };
        Actuator::new(&ActuatorParameters {
            motion,
            inner_radius_m: 6e-3,
            outer_radius_m: 7.6e-3 + 4e-3 * share,
            length_m: 0.1,
            material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
            fiber: Some(fiber),
        })
        .expect("valid")
    }

    fn assert_equal(many: &[Solution<f64>], one_by_one: &[Solution<f64>]) {
        for (a, b) in many.iter().zip(one_by_one) {
            assert_eq!((a.status, a.state.pressure_pa), (b.status, b.state.pressure_pa));
            let pairs = [
                (a.state.volume_strain, b.state.volume_strain),
                (a.state.outer_radius_m, b.state.outer_radius_m),
                (a.state.twist_rad, b.state.twist_rad),
                (a.state.compliance_m3_per_pa, b.state.compliance_m3_per_pa),
            ];
            for (x, y) in pairs {
                assert!(a.status != Status::Solved || (x - y).abs() <= 1e-9 * y.abs(), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn batch_is_answered_as_one_by_one() {
        let actuators: Vec<_> = (0..5000).map(actuator).collect();
        let pressures_pa: Vec<_> = (0..5000).map(|i| -1e4 + 17.0 * f64::from(i)).collect();
        let one_by_one: Vec<_> = actuators
            .iter()
            .zip(&pressures_pa)
            .map(|(actuator, pressure_pa)| actuator.forward(*pressure_pa, &Load::none()).expect("finite"))
            .collect();
        let mut solutions = vec![one_by_one[0]; 5000];
        forward(&actuators, &pressures_pa, &mut solutions).expect("finite");
        assert_equal(&solutions, &one_by_one);
        for count in [5000, 4097, 1, 0] {
            let mut solutions = vec![one_by_one[0]; count];
            ActuatorBatch::new(&actuators[..count]).forward(&pressures_pa[..count], &mut solutions).expect("finite");
            assert_equal(&solutions, &one_by_one[..count]);
        }
    }

    /// Benders, bare or with a hoop or a helix, walls from thin to very thick, laws that stiffen and soften.
    fn bender(i: usize) -> Actuator<f64> {
        let share = |step: f64| (i as f64 * step).fract();
        let inner_radius_m = 8e-3 * if i.is_multiple_of(40) { 0.05 } else { 0.12 + 0.85 * share(0.618) };
        let fiber = Fiber {
            angle_rad: if i.is_multiple_of(5) { 0.1 } else { 0.0 },
            families: Families::Two,
            modulus_pa: 1e9,
            placement: Placement::Sheet,
            thickness_m: 2e-4,
            radius_m: inner_radius_m + (8e-3 - inner_radius_m) * share(0.371),
        };
        let c_pa = [8e4, if i.is_multiple_of(7) { -2e3 } else { 4e3 }, 600.0];
        let neo_hookean = Material::NeoHookean { shear_modulus_pa: 0.2e6 };
        Actuator::new(&ActuatorParameters {
            motion: Motion::Bending,
            inner_radius_m,
            outer_radius_m: 8e-3,
            length_m: 0.1,
            material: if i.is_multiple_of(3) { Material::Yeoh { c_pa } } else { neo_hookean },
            fiber: (!i.is_multiple_of(4)).then_some(fiber),
        })
        .expect("valid")
    }

    #[test]
    fn bends_are_answered_as_one_by_one() {
        let benders: Vec<_> = (0..5000).map(bender).collect();
        // Up to bends that take more angles than tables have, and panels towards the outer face.
        let targets: Vec<_> = (0..5000)
            .map(|i| match i % 23 {
                0 => Target::BendAngle(0.0),
                1 => Target::BendAngle(12.0 * PI),
                _ => Target::BendAngle(2.0 * PI * (f64::from(i) * 0.731).fract().powi(2)),
            })
            .collect();
        for range in [PressureRange::physical(), PressureRange { least_pa: 1e3, most_pa: 60e3 }] {
            let one_by_one: Vec<_> = benders
                .iter()
                .zip(&targets)
                .map(|(bender, target)| bender.inverse_within(&range, *target, &Load::none()).expect("a bend"))
                .collect();
            let mut solutions = vec![one_by_one[0]; 5000];
            inverse(&benders, &targets, &range, &mut solutions).expect("bends");
            assert_same_bends(&solutions, &one_by_one);
            let solved = one_by_one.iter().filter(|one| one.status == Status::Solved).count();
            assert!(solved > if range.least_pa < 0.0 { 4000 } else { 1000 }, "{solved}");
        }
        let pressures_pa: Vec<_> = (0..5000).map(|i| -2e3 + 3e5 * (f64::from(i) * 0.417).fract().powi(3)).collect();
        let one_by_one: Vec<_> = benders
            .iter()
            .zip(&pressures_pa)
            .map(|(bender, pressure_pa)| bender.forward(*pressure_pa, &Load::none()).expect("finite"))
            .collect();
        let mut solutions = vec![one_by_one[0]; 5000];
        forward(&benders, &pressures_pa, &mut solutions).expect("finite");
        assert_same_bends(&solutions, &one_by_one);
        assert!(one_by_one.iter().filter(|one| one.status == Status::Solved).count() > 4000);
    }

    fn assert_same_bends(many: &[Solution<f64>], one_by_one: &[Solution<f64>]) {
        let mut worst = [0.0_f64; 3];
        for (i, (a, b)) in many.iter().zip(one_by_one).enumerate() {
            assert_eq!((a.status, a.limit_pressure_pa), (b.status, b.limit_pressure_pa), "{i}: {a:?} {b:?}");
            if a.status == Status::Solved {
                let pairs = [
                    (a.state.pressure_pa, b.state.pressure_pa),
                    (a.state.bend_angle_rad, b.state.bend_angle_rad),
                    (a.state.compliance_m3_per_pa, b.state.compliance_m3_per_pa),
                ];
                for ((worst, (x, y)), most) in worst.iter_mut().zip(pairs).zip([2e-14, 2e-14, 1e-13]) {
                    let off = if x == y { 0.0 } else { (x / y - 1.0).abs() };
                    assert!(off < most, "{i}: {a:?} {b:?}");
                    *worst = worst.max(off);
                }
            }
        }
        println!("{worst:?}");
    }

    #[test]
    fn target_that_is_no_bend_is_refused() {
        let benders = [bender(1), bender(2)];
        let blank = benders[0].forward(0.0, &Load::none()).expect("finite");
        let targets = [Target::BendAngle(0.1), Target::AxialStretch(1.1)];
        let error = inverse(&benders, &targets, &PressureRange::physical(), &mut [blank; 2]).expect_err("no bend");
        assert_eq!(error.field, "axial_stretch");
        let error = inverse(&benders[..1], &[Target::BendAngle(-0.1)], &PressureRange::physical(), &mut [blank]);
        assert_eq!(error.expect_err("backwards").field, "bend_angle_rad");
    }

    #[test]
    fn pressure_that_is_no_number_is_refused() {
        let actuators = [actuator(1), actuator(2)];
        let blank = actuators[0].forward(0.0, &Load::none()).expect("finite");
        let error = forward(&actuators, &[1e3, f64::NAN], &mut [blank; 2]).expect_err("not finite");
        assert_eq!(error.field, "pressure_pa");
    }
    #[test]
    fn first_refusal_of_several_is_reported() {
        let actuators: Vec<_> = (0..5000).map(actuator).collect();
        let blank = actuators[0].forward(0.0, &Load::none()).expect("finite");
        let mut pressures_pa = vec![1e3; 5000];
        (pressures_pa[2 * PIECE + 3], pressures_pa[3 * PIECE]) = (f64::INFINITY, f64::NAN);
        let many = ActuatorBatch::new(&actuators);
        for _ in 0..20 {
            let error = many.forward(&pressures_pa, &mut vec![blank; 5000]).expect_err("not finite");
            assert_eq!((error.field, error.value), ("pressure_pa", f64::INFINITY));
        }
    }
}
