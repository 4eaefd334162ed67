//! Pressures for a desired wrench, for nine actuators of a board and for 27.

use core::hint::black_box;

use fra_model::{Allocated, Allocation, AllocationStatus};

use crate::Bench;
use crate::answer::{Answer, Note};

/// Largest pressure, Pa.
const LIMIT_PA: f32 = 1e5;
const REGULARISER: f32 = 1e-3;
/// Wrenches of two ticks, N and N m.
const BEFORE: [f32; 6] = [2.0, -3.0, 60.0, 0.6, -0.4, 0.1];
const NOW: [f32; 6] = [2.1, -2.9, 61.0, 0.62, -0.42, 0.1];
const WEIGHTS: [f32; 6] = [1.0, 1.0, 1.0, 30.0, 30.0, 30.0];

impl<const N: usize> Answer for Allocation<f32, 6, N> {
    fn note(&self) -> Note {
        Note::of("-", 0, [f32::from(u8::try_from(self.count()).unwrap_or(u8::MAX))])
    }
}

impl<const N: usize> Answer for Allocated<f32, 6, N> {
    fn note(&self) -> Note {
        let status = match self.status {
            AllocationStatus::Solved => "solved",
            AllocationStatus::NotConverged => "not converged",
            AllocationStatus::NotFinite => "not finite",
        };
        let numbers = self.pressures_pa.into_iter().chain(self.wrench).chain([self.residual]);
        Note::of(status, self.iterations, numbers)
    }
}

/// Actuators that push and turn in many directions: the wrench per pascal of each, m2 and m3.
fn columns<const N: usize>() -> [[f32; 6]; N] {
    let mut last = 1_u32;
    let mut number = || {
        last = last.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f32::from((last >> 16) as u16) / 32_768.0 - 1.0
    };
    let mut columns = [[0.0; 6]; N];
    for column in &mut columns {
        let (arm_x, arm_y) = (0.03 * number(), 0.03 * number());
        let push = 5e-4;
        let (x, y) = (0.2 * push * number(), 0.2 * push * number());
        *column = [x, y, push, arm_y * push, -arm_x * push, arm_x * y - arm_y * x];
    }
    columns
}

/// All queries; whether each had its answer.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    put::<9>(bench, "nine pressures") && put::<27>(bench, "27 pressures")
}

fn put<const N: usize>(bench: &mut impl Bench, name: &str) -> bool {
    let (columns, limits) = (columns::<N>(), [[0.0, LIMIT_PA]; N]);
    let built = bench.put("new, allocation", name, || {
        Allocation::<f32, 6, N>::new(black_box(&columns), &limits, &WEIGHTS, black_box(REGULARISER))
    });
    let Ok(allocation) = built else { return false };
    let cold = bench.put("allocation, cold", name, || black_box(&allocation).solve(black_box(&BEFORE)));
    let warm = bench.put("allocation, warm", name, || {
        black_box(&allocation).solve_from(black_box(&cold.pressures_pa), black_box(&NOW))
    });
    let referred = bench.put("allocation with references", name, || {
        black_box(allocation).towards(black_box(&[0.5 * LIMIT_PA; N])).map(|allocation| allocation.solve(&NOW))
    });
    let Ok(referred) = referred else { return false };
    [cold.status, warm.status, referred.status].into_iter().all(|status| status == AllocationStatus::Solved)
}
