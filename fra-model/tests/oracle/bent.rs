//! One random bending actuator of a sweep, its load and pressures, and what the oracle says about every answer.

use fra_model::*;

use super::sample::{Random, bending, convert};
use super::scalar::Scalar;
use super::section::Section;
use super::tally::{LIMIT_PRESSURE, ROUNDINGS, Rules, Tally, Verdict, rated, unusable};

/// Asks one actuator at five pressures.
pub(crate) fn sweep_bending<T: Scalar>(random: &mut Random, rules: &Rules, tally: &mut Tally, name: &str) {
    let parameters = convert(&bending(random), T::rounded);
    let exact = convert(&parameters, T::exact);
    let actuator = Actuator::new(&parameters).expect("a sane actuator");
    let mut load = Load::none();
    let plain = Section::new(&exact, &Load::none());
    if random.chance(0.5) {
        let unit = plain.mu1() * exact.outer_radius_m.powi(3);
        load.torque_nm = T::rounded(unit * random.log_between(1e-3, 0.3) * random.sign());
        load.force_n = T::rounded(unit / exact.outer_radius_m * random.log_between(1e-3, 0.3) * random.sign());
    }
    let section = Section::new(&exact, &Load { force_n: load.force_n.exact(), torque_nm: load.torque_nm.exact() });
    let branch = section.rise(&rules.rough, exact.length_m / exact.outer_radius_m * random.log_between(1e-4, 3.0));
    let describe = |pressure: f64| format!("{name} {} at {pressure:e} Pa, {load:?}, {parameters:?}", T::NAME);
    for _ in 0..5 {
        let ((_, straight), (end, last)) = (branch.points[0], branch.points[branch.points.len() - 1]);
        let share = if random.chance(0.3) { random.log_between(1e-6, 1.0) } else { random.between(-0.1, 1.3) };
        let pressure = T::rounded(straight + share * (last - straight)).exact();
        if pressure > last && !branch.turns {
            tally.skip();
            continue;
        }
        let solution = actuator.forward(T::rounded(pressure), &load).expect("finite");
        let verdict = unusable(&solution).unwrap_or_else(|| {
            // What a rounding of the inputs does to the pressures at the ends: those are differences of the wall's moment and the load.
            let rounding = |angle: f64, at: f64| {
                let condition = section.condition_of_pressure(&rules.rough, angle, at);
                (ROUNDINGS * T::EPSILON * condition).max(LIMIT_PRESSURE) * at.abs()
            };
            let limit = if pressure - straight < last - pressure { (0.0, straight) } else { (end, last) };
            let outside = pressure <= straight || pressure >= last;
            let at_limit = (pressure - limit.1).abs() <= rounding(limit.0, limit.1);
            match solution.status {
                Status::Solved if outside && at_limit => Verdict::Refused,
                Status::Solved if outside => Verdict::OtherBranch(f64::INFINITY),
                Status::Solved => {
                    let angle = section.angle(&rules.fine, pressure, &branch);
                    let error = (solution.state.bend_angle_rad.exact() / angle - 1.0).abs();
                    rated(error, T::EPSILON * section.condition(&rules.rough, angle, pressure))
                }
                _ if !outside && !at_limit => Verdict::FalseRefusal,
                _ => {
                    let found = solution.limit_pressure_pa.map_or(f64::NAN, T::exact);
                    let right = (found - limit.1).abs() <= rounding(limit.0, limit.1);
                    if right { Verdict::Refused } else { Verdict::WrongLimit }
                }
            }
        });
        tally.add((Motion::Bending, None), verdict, || describe(pressure));
    }
}
