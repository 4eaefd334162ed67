//! Many actuators at once.

use core::array;
use core::ops::Range;

use crate::actuator::{Actuator, within};
use crate::number::lanes::{Column, LANES, Lanes};
use crate::number::real::Real;
use crate::parameters::InvalidParameter;
use crate::precision::Precision;
use crate::solution::{Load, PressureRange, Solution, State, Status, Target};
use crate::solve::bend::{Bender, MANY, bend_many, meet_many};
use crate::solve::closed_form::{ClosedForm, Columns};
use crate::solve::size::Size;
use crate::solve::tube::Tube;

/// Up to [`LANES`] actuators, laid out to be solved side by side at any number of pressures.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<T: Real> {
    /// `None` where no actuator can be solved side by side.
    tubes: Option<Tubes<T>>,
}

/// The straight tubes among the actuators. The lanes of others, and lanes to spare, hold some tube whose answer nobody looks at.
#[derive(Clone, Copy, Debug)]
struct Tubes<T: Real> {
    /// Which lanes hold the actuator of their place.
    has: [bool; LANES],
    direct: Columns<T>,
    size: Size<Column<T>>,
}

impl<T: Real> Prepared<T> {
    /// Lays out the first [`LANES`] actuators, or as many as there are.
    pub fn new(actuators: &[Actuator<T>]) -> Self {
        let mut new = Self { tubes: None };
        new.lay_out(actuators);
        new
    }

    /// The same in the place of others.
    #[inline(always)]
    fn lay_out(&mut self, actuators: &[Actuator<T>]) {
        if let Some(tubes) = &mut self.tubes {
            tubes.has = [false; LANES];
            tubes.direct.clear();
        }
        for (lane, actuator) in actuators.iter().enumerate().take(LANES) {
            let Some(tube) = actuator.tube() else { continue };
            let Some(direct) = tube.closed_form() else { continue };
            let tubes = self.tubes.get_or_insert_with(|| Tubes::new(tube, direct));
            tubes.has[lane] = true;
            tubes.direct.set(lane..lane + 1, direct);
            tubes.size.set(lane, &tube.size());
        }
    }
}

impl<T: Real> Tubes<T> {
    #[cold]
    fn new(tube: &Tube<T>, direct: &ClosedForm<T>) -> Self {
        Self { has: [false; LANES], direct: Columns::new(direct), size: Size::columns(&tube.size()) }
    }

    /// Solves as many as the vectors have lanes; where `ONCE`, those alone that take one correction.
    #[inline(always)]
    fn forward<V: Lanes<T>, const ONCE: bool>(&self, token: V, pressures_pa: &[T; LANES]) -> Answers<T> {
        let size = self.size.vectors(token);
        let end = self.direct.forward::<V, ONCE>(token.load(pressures_pa) * size.per_shear_modulus);
        let sizes = size.of_state(end.at.e, end.at.w, end.at.g, end.volume_rate);
        let none = [T::zero(); LANES];
        let mut answers = Answers {
            strains: [none; 2],
            sizes: [none; 6],
            residual: none,
            margin: none,
            evaluations: end.evaluations,
        };
        end.at.e.store(&mut answers.strains[0]);
        end.at.w.store(&mut answers.strains[1]);
        for (to, value) in answers.sizes.iter_mut().zip(&sizes) {
            value.store(to);
        }
        end.residual.store(&mut answers.residual);
        end.margin.store(&mut answers.margin);
        answers
    }
}

/// Answers of several actuators.
struct Answers<T> {
    /// Axial strain and relative change of the volume.
    strains: [Column<T>; 2],
    /// As [`Size::of_state`] has them.
    sizes: [Column<T>; 6],
    residual: Column<T>,
    /// Those are answers where it is not negative.
    margin: Column<T>,
    evaluations: u32,
}

impl<T: Real> Answers<T> {
    /// That of one lane, if it has one.
    #[inline(always)]
    fn of(&self, i: usize, pressure_pa: T) -> Option<Solution<T>> {
        let [stretch, inner, outer, twist, volume, compliance] = &self.sizes;
        let certified = (self.margin[i] >= T::zero()) & compliance[i].is_finite() & pressure_pa.is_finite();
        let state = State {
            pressure_pa,
            axial_stretch: stretch[i],
            axial_strain: self.strains[0][i],
            inner_radius_m: inner[i],
            outer_radius_m: outer[i],
            twist_rad: twist[i],
            bend_angle_rad: T::zero(),
            volume_m3: volume[i],
            volume_strain: self.strains[1][i],
            compliance_m3_per_pa: compliance[i],
        };
        certified.then_some(Solution {
            status: Status::Solved,
            state,
            limit_pressure_pa: None,
            residual: self.residual[i],
            iterations: self.evaluations,
        })
    }
}

/// The equilibria of actuators, each at its own gauge pressure, Pa, without external load: [`Actuator::forward`] of each. Solves as many
/// as the shortest slice has.
///
/// `groups` are [`Prepared`] from the actuators, [`Lanes::COUNT`] at a time. They are solved side by side by the vector arithmetic that
/// `token` is a value of. Most take one correction, and are not kept waiting by their neighbours: those that take more are collected
/// from several groups and solved side by side as well, and what is then left, one by one. Integrals of
/// bending actuators with a hoop winding are taken side by side.
///
/// # Errors
/// [`InvalidParameter`] of a pressure that is not finite; the solutions are then of no use.
#[inline(always)]
pub fn forward_prepared<T: Precision, V: Lanes<T>>(
    token: V,
    groups: &[Prepared<T>],
    actuators: &[Actuator<T>],
    pressures_pa: &[T],
    solutions: &mut [Solution<T>],
) -> Result<(), InvalidParameter<T>> {
    let count = actuators.len().min(pressures_pa.len()).min(solutions.len());
    let mut batch = Batch { actuators, pressures_pa, waiting: None, numbers: [0; LANES], count: 0, bends: false };
    for (group, from) in groups.iter().zip((0..count).step_by(V::COUNT)) {
        batch.solve(token, group, from..count.min(from + V::COUNT), solutions)?;
    }
    batch.finish(token, solutions)?;
    batch.meet(token, solutions)
}

/// [`forward_prepared`] of actuators that are laid out on the way.
///
/// # Errors
/// [`InvalidParameter`] of a pressure that is not finite; the solutions are then of no use.
#[inline(always)]
pub fn forward_many<T: Precision, V: Lanes<T>>(
    token: V,
    actuators: &[Actuator<T>],
    pressures_pa: &[T],
    solutions: &mut [Solution<T>],
) -> Result<(), InvalidParameter<T>> {
    let count = actuators.len().min(pressures_pa.len()).min(solutions.len());
    let mut batch = Batch { actuators, pressures_pa, waiting: None, numbers: [0; LANES], count: 0, bends: false };
    let mut group = Prepared { tubes: None };
    for from in (0..count).step_by(V::COUNT) {
        let range = from..count.min(from + V::COUNT);
        group.lay_out(&actuators[range.clone()]);
        batch.solve(token, &group, range, solutions)?;
    }
    batch.finish(token, solutions)?;
    batch.meet(token, solutions)
}

/// The gauge pressures in a range at which actuators reach a target each, without external load: [`Actuator::inverse_within`] of each. Solves as
/// many as the shortest slice has.
///
/// The integrals of bending actuators with a hoop winding are taken side by side by the vector arithmetic that `token` is a value of.
///
/// # Errors
/// As [`Actuator::inverse_within`]; the solutions are then of no use.
#[inline(always)]
pub fn inverse_many<T: Precision, V: Lanes<T>>(
    token: V,
    actuators: &[Actuator<T>],
    targets: &[Target<T>],
    range: &PressureRange<T>,
    solutions: &mut [Solution<T>],
) -> Result<(), InvalidParameter<T>> {
    range.check()?;
    let of = |actuator: &Actuator<T>, target: Target<T>| actuator.bender().and_then(|bender| bender.bend_of(target));
    let one = |actuator: &Actuator<T>, target| actuator.inverse_within(range, target, &Load::none());
    let rows = || actuators.iter().zip(targets);
    for ((actuator, target), solution) in rows().zip(&mut *solutions) {
        if of(actuator, *target).is_none() {
            *solution = one(actuator, *target)?;
        }
    }
    let mut bends = rows()
        .enumerate()
        .filter_map(|(i, (actuator, target))| Some((i, (actuator.bender()?, of(actuator, *target)?))));
    while let Some(several) = Several::next(&mut bends, solutions.len()) {
        let mut left = [false; MANY];
        bend_many(token, several.bends(), |i, bent| match several.bends[i].0.bent_to(bent) {
            Some(solution) => solutions[several.numbers[i]] = within(range, solution).sound(),
            None => left[i] = true,
        });
        for number in several.marked(&left) {
            solutions[number] = one(&actuators[number], targets[number])?;
        }
    }
    Ok(())
}

/// Benders that are solved together, each with a moment or a bend.
struct Several<'a, T: Real> {
    /// Their indices among the actuators.
    numbers: [usize; MANY],
    bends: [(&'a Bender<T>, T); MANY],
    count: usize,
}

impl<'a, T: Real> Several<'a, T> {
    /// The next ones of a sequence, with an index below `end`.
    fn next(bends: &mut impl Iterator<Item = (usize, (&'a Bender<T>, T))>, end: usize) -> Option<Self> {
        let mut next = || bends.next().filter(|(number, _)| *number < end);
        let (number, bend) = next()?;
        let mut several = Self { numbers: [number; MANY], bends: [bend; MANY], count: 1 };
        while several.count < MANY
            && let Some((number, bend)) = next()
        {
            (several.numbers[several.count], several.bends[several.count]) = (number, bend);
            several.count += 1;
        }
        Some(several)
    }

    fn bends(&self) -> &[(&'a Bender<T>, T)] {
        &self.bends[..self.count]
    }

    /// Indices of those that are marked.
    fn marked(&self, marks: &[bool; MANY]) -> impl Iterator<Item = usize> {
        self.numbers.into_iter().zip(*marks).filter_map(|(number, is_marked)| is_marked.then_some(number))
    }
}

/// A batch, and those of it that wait to be solved side by side because they take more than one correction.
struct Batch<'a, T: Real> {
    actuators: &'a [Actuator<T>],
    pressures_pa: &'a [T],
    waiting: Option<Tubes<T>>,
    /// Their indices, and their number.
    numbers: [usize; LANES],
    count: usize,
    /// Whether there are bends that are left to the end.
    bends: bool,
}

impl<T: Precision> Batch<'_, T> {
    /// One correction for a group.
    #[inline(always)]
    fn solve<V: Lanes<T>>(
        &mut self,
        token: V,
        group: &Prepared<T>,
        range: Range<usize>,
        solutions: &mut [Solution<T>],
    ) -> Result<(), InvalidParameter<T>> {
        const { assert!(V::COUNT >= 1 && V::COUNT <= LANES, "one to eight lanes") };
        let Some(tubes) = &group.tubes else { return range.into_iter().try_for_each(|i| self.one(i, solutions)) };
        let own = &self.pressures_pa[range.clone()];
        let some = || array::from_fn(|lane| own.get(lane).copied().unwrap_or(T::zero()));
        let pressures = own.first_chunk().copied().unwrap_or_else(some);
        let answers = tubes.forward::<V, true>(token, &pressures);
        let mut is_left = [false; LANES];
        for (lane, solution) in solutions[range.clone()].iter_mut().enumerate() {
            match answers.of(lane, pressures[lane]) {
                Some(answer) if tubes.has[lane] => *solution = answer,
                _ => is_left[lane] = true,
            }
        }
        for (lane, number) in range.enumerate().filter(|(lane, _)| is_left[*lane]) {
            if tubes.has[lane] {
                self.wait(token, tubes, lane, number, solutions)?;
            } else {
                self.one(number, solutions)?;
            }
        }
        Ok(())
    }

    /// Has a lane wait until there are as many as the vectors have lanes.
    #[inline(always)]
    fn wait<V: Lanes<T>>(
        &mut self,
        token: V,
        from: &Tubes<T>,
        lane: usize,
        number: usize,
        solutions: &mut [Solution<T>],
    ) -> Result<(), InvalidParameter<T>> {
        // The lanes to spare hold what is there.
        let waiting = self.waiting.get_or_insert(*from);
        if self.count == 0 {
            waiting.direct.clear();
        }
        waiting.direct.copy(self.count, &from.direct, lane);
        waiting.size.set(self.count, &from.size.lane(lane));
        self.numbers[self.count] = number;
        self.count += 1;
        if self.count < V::COUNT { Ok(()) } else { self.finish(token, solutions) }
    }

    /// Solves those that wait side by side, and one by one where that does not answer.
    #[inline(always)]
    fn finish<V: Lanes<T>>(&mut self, token: V, solutions: &mut [Solution<T>]) -> Result<(), InvalidParameter<T>> {
        let Some(waiting) = &self.waiting else { return Ok(()) };
        let numbers = self.numbers;
        let mut pressures = [T::zero(); LANES];
        for (pressure, number) in pressures.iter_mut().zip(&numbers[..self.count]) {
            *pressure = self.pressures_pa[*number];
        }
        let answers = waiting.forward::<V, false>(token, &pressures);
        for (lane, &number) in numbers[..self.count].iter().enumerate() {
            match answers.of(lane, pressures[lane]) {
                Some(answer) => solutions[number] = answer,
                None => self.one(number, solutions)?,
            }
        }
        self.count = 0;
        Ok(())
    }

    /// The bends, once the rest is solved.
    #[inline(always)]
    fn meet<V: Lanes<T>>(&mut self, token: V, solutions: &mut [Solution<T>]) -> Result<(), InvalidParameter<T>> {
        if !self.bends {
            return Ok(());
        }
        let Self { actuators, pressures_pa, .. } = *self;
        let mut bends = (0..actuators.len().min(pressures_pa.len())).filter_map(|i| Some((i, self.bend(i)?)));
        while let Some(several) = Several::next(&mut bends, solutions.len()) {
            let mut left = [false; MANY];
            meet_many(token, several.bends(), |i, met, integrals| {
                let number = several.numbers[i];
                match met {
                    Some(met) => {
                        let pressure_pa = pressures_pa[number];
                        let solution = several.bends[i].0.pressed(&met, pressure_pa, &Load::none(), integrals);
                        solutions[number] = solution.sound();
                    }
                    None => left[i] = true,
                }
            });
            for number in several.marked(&left) {
                solutions[number] = actuators[number].forward(pressures_pa[number], &Load::none())?;
            }
        }
        Ok(())
    }

    /// The bender of an actuator and the moment of its pressure, if that is met side by side with others.
    fn bend(&self, i: usize) -> Option<(&Bender<T>, T)> {
        let bender = self.actuators[i].bender()?;
        Some((bender, bender.moment_at(self.pressures_pa[i])?))
    }

    #[cold]
    #[inline(never)]
    fn one(&mut self, i: usize, solutions: &mut [Solution<T>]) -> Result<(), InvalidParameter<T>> {
        if self.bend(i).is_some() {
            self.bends = true;
            return Ok(());
        }
        solutions[i] = self.actuators[i].forward(self.pressures_pa[i], &Load::none())?;
        Ok(())
    }
}
