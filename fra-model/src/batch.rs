//! Many actuators at once.

use crate::actuator::Actuator;
use crate::direct::{Direct, Equilibrium, LANES, Lanes, forward_lanes};
use crate::parameters::InvalidParameter;
use crate::real::Real;
use crate::solution::{Load, Solution};
use crate::tube::Tube;

/// The equilibria of actuators, each at its own gauge pressure, Pa, without external load: [`Actuator::forward`] of each.
///
/// They are solved side by side by the vector arithmetic that `token` is a value of; those it cannot answer for are solved one by one.
/// Solves as many as the shortest slice has.
///
/// # Errors
/// [`InvalidParameter`] of a pressure that is not finite; the solutions are then of no use.
#[inline(always)]
pub fn forward_many<T: Real, V: Lanes<T>>(
    token: V,
    actuators: &[Actuator<T>],
    pressures_pa: &[T],
    solutions: &mut [Solution<T>],
) -> Result<(), InvalidParameter<T>> {
    const { assert!(V::COUNT >= 1 && V::COUNT <= LANES, "one to eight lanes") };
    let count = actuators.len().min(pressures_pa.len()).min(solutions.len());
    let mut batch = Batch { token, actuators, pressures_pa, solutions };
    // Those that take several steps go together, so that the others need not wait for them.
    let mut groups: [Group<T>; 2] = [const { Group::EMPTY }; 2];
    let mut index = 0;
    loop {
        while index < count && groups.iter().all(|group| group.count < V::COUNT) {
            match actuators[index].tube().and_then(|tube| Some((tube, tube.direct()?))) {
                Some((tube, (direct, unit))) => {
                    let pressure = pressures_pa[index] / unit;
                    let group = usize::from(!direct.is_one_step_to(pressure));
                    groups[group].push(Lane { index, tube, direct, pressure });
                }
                None => batch.one(index)?,
            }
            index += 1;
        }
        let fullest = usize::from(groups[1].count > groups[0].count);
        if groups[fullest].count == 0 {
            return Ok(());
        }
        batch.solve(&mut groups[fullest])?;
    }
}

/// One actuator of a group.
#[derive(Clone, Copy)]
struct Lane<'a, T: Real> {
    index: usize,
    tube: &'a Tube<T>,
    direct: &'a Direct<T>,
    pressure: T,
}

/// Actuators to be solved side by side.
struct Group<'a, T: Real> {
    lanes: [Option<Lane<'a, T>>; LANES],
    count: usize,
}

impl<'a, T: Real> Group<'a, T> {
    const EMPTY: Self = Self { lanes: [None; LANES], count: 0 };

    fn push(&mut self, lane: Lane<'a, T>) {
        self.lanes[self.count] = Some(lane);
        self.count += 1;
    }
}

struct Batch<'a, T: Real, V> {
    token: V,
    actuators: &'a [Actuator<T>],
    pressures_pa: &'a [T],
    solutions: &'a mut [Solution<T>],
}

impl<T: Real, V: Lanes<T>> Batch<'_, T, V> {
    /// Solves a group and empties it.
    #[inline(always)]
    fn solve(&mut self, group: &mut Group<'_, T>) -> Result<(), InvalidParameter<T>> {
        // Lanes to spare repeat the first.
        let Some(first) = group.lanes[0].filter(|_| group.count > 0) else { return Ok(()) };
        let mut directs = [first.direct; LANES];
        let mut pressures = [first.pressure; LANES];
        for (i, lane) in group.lanes.iter().take(group.count).flatten().enumerate() {
            (directs[i], pressures[i]) = (lane.direct, lane.pressure);
        }
        let mut found: [Option<Equilibrium<T>>; LANES] = [const { None }; LANES];
        forward_lanes(self.token, directs, &pressures, &mut found);
        for (lane, found) in group.lanes.iter().take(group.count).flatten().zip(&found) {
            let Some(found) = found else {
                self.one(lane.index)?;
                continue;
            };
            let mut solution = lane.tube.solved(found);
            solution.state.pressure_pa = self.pressures_pa[lane.index];
            self.solutions[lane.index] = solution;
        }
        group.count = 0;
        Ok(())
    }

    #[cold]
    #[inline(never)]
    fn one(&mut self, index: usize) -> Result<(), InvalidParameter<T>> {
        self.solutions[index] = self.actuators[index].forward(self.pressures_pa[index], &Load::none())?;
        Ok(())
    }
}
