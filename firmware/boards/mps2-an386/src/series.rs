//! Queries to a tube of several windings: one segment that bends and one that lengthens.

use core::hint::black_box;

use fra_model::{Actuator, ActuatorParameters, Families, Load, Motion, Series, SeriesTarget, Solution, Status};
use nalgebra::Isometry3;

use crate::Bench;
use crate::actuators::{CASES, sheet};

const NAME: &str = "two segments";
const PRESSURE_PA: f32 = 20e3;
const BEND_RAD: f32 = 0.5;
const MOUNT_RAD: f32 = 0.3;

/// Puts all queries; whether there were answers.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    let lengthens = CASES[0].parameters;
    let bends = ActuatorParameters { motion: Motion::Bending, fiber: sheet(3.0, Families::Two), ..lengthens };
    let (Ok(bends), Ok(lengthens)) = (Actuator::new(&bends), Actuator::new(&lengthens)) else { return false };
    let segments = [bends, lengthens];
    let Ok(series) = Series::new(&segments) else { return false };
    let none = Load::none();
    let forward = bench.put("forward, cold", NAME, || black_box(&series).forward(black_box(PRESSURE_PA), &none));
    let target = SeriesTarget::BendAngle(BEND_RAD);
    let inverse = bench.put("inverse, cold", NAME, || black_box(&series).inverse(black_box(target), &none));
    let mut shapes = segments.each_ref().map(|segment| (segment.rest(), MOUNT_RAD));
    let mut keep = |index: usize, solution: &Solution<f32>| {
        if let Some(shape) = shapes.get_mut(index) {
            shape.0 = solution.state;
        }
    };
    let forward_each = series.forward_each(PRESSURE_PA, &none, &mut keep);
    let inverse_each = series.inverse_each(target, &none, &mut keep);
    bench.put("pose of a tip", NAME, || black_box(&series).tip_pose(&Isometry3::identity(), black_box(shapes)));
    let answers = [forward, inverse, forward_each, inverse_each];
    let whole = series.segments().len() == segments.len();
    whole && answers.into_iter().all(|answer| answer.is_ok_and(|found| found.status == Status::Solved))
}
