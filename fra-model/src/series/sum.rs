//! Adding up segments.

use crate::actuator::Actuator;
use crate::number::real::Real;
use crate::solution::{Solution, Status};

use super::{SeriesLimit, SeriesSolution, SeriesState};

/// Segments added up so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<T> {
    pub(super) status: Status,
    pub(super) state: SeriesState<T>,
    pub(super) limit: Option<SeriesLimit<T>>,
    residual: T,
    pub(super) iterations: u32,
}

impl<T: Real> Sum<T> {
    pub(super) fn new(pressure_pa: T) -> Self {
        let zero = T::zero();
        let state = SeriesState {
            pressure_pa,
            length_m: zero,
            extension_m: zero,
            twist_rad: zero,
            bend_angle_rad: zero,
            volume_m3: zero,
            volume_change_m3: zero,
            compliance_m3_per_pa: zero,
        };
        Self { status: Status::Solved, state, limit: None, residual: zero, iterations: 0 }
    }

    pub(super) fn add(&mut self, segment: usize, actuator: &Actuator<T>, solution: &Solution<T>) {
        let p = actuator.parameters();
        let rest_volume = T::pi() * p.inner_radius_m * p.inner_radius_m * p.length_m;
        let (sum, state) = (&mut self.state, &solution.state);
        sum.length_m += p.length_m * state.axial_stretch;
        sum.extension_m += p.length_m * state.axial_strain;
        sum.twist_rad += state.twist_rad;
        sum.bend_angle_rad += state.bend_angle_rad;
        sum.volume_m3 += state.volume_m3;
        sum.volume_change_m3 += rest_volume * state.volume_strain;
        sum.compliance_m3_per_pa += state.compliance_m3_per_pa;
        self.residual = self.residual.max(solution.residual);
        self.iterations = self.iterations.saturating_add(solution.iterations);
        match solution.status {
            Status::Solved => {}
            Status::NoSolution => self.end(SeriesLimit { segment, pressure_pa: solution.limit_pressure_pa }),
            // Where this one ends is not known, nor whether it ends first.
            Status::NotConverged => self.status = Status::NotConverged,
        }
    }

    /// Takes note of a segment without equilibrium: the one without a limit pressure, else the one with the least counts.
    fn end(&mut self, other: SeriesLimit<T>) {
        if self.status == Status::Solved {
            self.status = Status::NoSolution;
        }
        let first = self.limit.is_none_or(|limit| match (limit.pressure_pa, other.pressure_pa) {
            (Some(least), Some(pressure)) => pressure.abs() < least.abs(),
            (least, pressure) => least.is_some() && pressure.is_none(),
        });
        if first {
            self.limit = Some(other);
        }
    }

    pub(super) fn solution(self) -> SeriesSolution<T> {
        let limit = self.limit.filter(|_| self.status == Status::NoSolution);
        let Self { mut status, state, residual, iterations, .. } = self;
        let sums = [state.length_m, state.extension_m, state.twist_rad, state.bend_angle_rad, state.volume_m3];
        if status == Status::Solved && !sums.iter().all(T::is_finite) {
            status = Status::NotConverged;
        }
        SeriesSolution { status, state, limit, residual, iterations }
    }
}
