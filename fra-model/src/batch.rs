//! Many actuators at once.

use crate::actuator::Actuator;
use crate::direct::{Column, Columns, LANES, Lanes};
use crate::parameters::InvalidParameter;
use crate::real::Real;
use crate::size::Size;
use crate::solution::{Load, Solution, State, Status};
use crate::tube::Tube;

/// Up to [`LANES`] actuators, laid out to be solved side by side at any number of pressures.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<T: Real> {
    /// `None` where no actuator can be solved side by side.
    tubes: Option<Tubes<T>>,
}

/// The straight tubes among the actuators; the lanes of others, and lanes to spare, repeat one of them.
#[derive(Clone, Copy, Debug)]
struct Tubes<T: Real> {
    has: [bool; LANES],
    direct: Columns<T>,
    size: Size<Column<T>>,
}

impl<T: Real> Prepared<T> {
    /// Lays out the first [`LANES`] actuators, or as many as there are.
    pub fn new(actuators: &[Actuator<T>]) -> Self {
        let tube = |i: usize| actuators.get(i).and_then(Actuator::tube).and_then(|tube| Some((tube, tube.direct()?)));
        let Some((first, direct)) = (0..LANES).find_map(tube) else { return Self { tubes: None } };
        let lanes: [Option<_>; LANES] = core::array::from_fn(tube);
        let direct = Columns::new(lanes.map(|lane| lane.map_or(direct, |(_, direct)| direct)));
        let sizes = lanes.map(|lane| lane.map_or(first, |(tube, _): (&Tube<T>, _)| tube).size());
        Self { tubes: Some(Tubes { has: lanes.map(|lane| lane.is_some()), direct, size: Size::columns(&sizes) }) }
    }

    /// The equilibria of the actuators it was prepared from, each at its own gauge pressure, Pa, without external load:
    /// [`Actuator::forward`] of each.
    ///
    /// They are solved side by side by the vector arithmetic that `token` is a value of; those it cannot answer for are solved one by
    /// one. Solves as many as the shortest slice has, at most [`LANES`].
    ///
    /// # Errors
    /// [`InvalidParameter`] of a pressure that is not finite; the solutions are then of no use.
    #[inline(always)]
    pub fn forward<V: Lanes<T>>(
        &self,
        token: V,
        actuators: &[Actuator<T>],
        pressures_pa: &[T],
        solutions: &mut [Solution<T>],
    ) -> Result<(), InvalidParameter<T>> {
        const { assert!(V::COUNT >= 1 && V::COUNT <= LANES, "one to eight lanes") };
        let count = actuators.len().min(pressures_pa.len()).min(solutions.len()).min(LANES);
        let mut answered = [false; LANES];
        if let Some(tubes) = &self.tubes {
            tubes.forward(token, &pressures_pa[..count], &mut solutions[..count], &mut answered);
        }
        for i in 0..count {
            if !answered[i] {
                one(&actuators[i], pressures_pa[i], &mut solutions[i])?;
            }
        }
        Ok(())
    }
}

#[cold]
#[inline(never)]
fn one<T: Real>(actuator: &Actuator<T>, pressure_pa: T, solution: &mut Solution<T>) -> Result<(), InvalidParameter<T>> {
    *solution = actuator.forward(pressure_pa, &Load::none())?;
    Ok(())
}

impl<T: Real> Tubes<T> {
    /// Solves as many as the vectors have lanes; says which it has answers for.
    #[inline(always)]
    fn forward<V: Lanes<T>>(
        &self,
        token: V,
        pressures_pa: &[T],
        solutions: &mut [Solution<T>],
        answered: &mut [bool; LANES],
    ) {
        let mut pressures = [T::zero(); LANES];
        pressures[..pressures_pa.len()].copy_from_slice(pressures_pa);
        let size = self.size.vectors(token);
        let end = self.direct.forward(token.load(&pressures) * size.per_shear_modulus);
        let spread = |value: V| {
            let mut to = [T::zero(); LANES];
            value.store(&mut to);
            to
        };
        let (e, w, margin) = (spread(end.at.e), spread(end.at.w), spread(end.margin));
        let [stretch, inner, outer, twist, volume, compliance] =
            size.of_state(end.at.e, end.at.w, end.at.g, end.volume_rate).map(spread);
        let residual = spread(end.residual);
        for (i, solution) in solutions.iter_mut().enumerate().take(V::COUNT) {
            if !(self.has[i] && margin[i] >= T::zero() && compliance[i].is_finite() && pressures[i].is_finite()) {
                continue;
            }
            answered[i] = true;
            *solution = Solution {
                status: Status::Solved,
                state: State {
                    pressure_pa: pressures[i],
                    axial_stretch: stretch[i],
                    axial_strain: e[i],
                    inner_radius_m: inner[i],
                    outer_radius_m: outer[i],
                    twist_rad: twist[i],
                    bend_angle_rad: T::zero(),
                    volume_m3: volume[i],
                    volume_strain: w[i],
                    compliance_m3_per_pa: compliance[i],
                },
                limit_pressure_pa: None,
                residual: residual[i],
                iterations: end.evaluations,
            };
        }
    }
}

/// The equilibria of actuators, each at its own gauge pressure, Pa, without external load: [`Actuator::forward`] of each, by
/// [`Prepared`]. Solves as many as the shortest slice has.
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
    let groups = actuators.chunks(V::COUNT).zip(pressures_pa.chunks(V::COUNT)).zip(solutions.chunks_mut(V::COUNT));
    for ((actuators, pressures_pa), solutions) in groups {
        Prepared::new(actuators).forward(token, actuators, pressures_pa, solutions)?;
    }
    Ok(())
}
