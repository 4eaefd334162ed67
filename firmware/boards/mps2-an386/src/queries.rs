//! The queries: every public function of the model, put as a controller would.

use core::hint::black_box;

use fra_model::{
    Actuator, Arrangement, Link, Load, Motion, Parameter, PressureRange, Segment, State, Status, Tracker, tip_pose,
};
use nalgebra::Isometry3;

use crate::Bench;
use crate::actuators::{CASES, Case};
use crate::answer::{Answer, Note};

/// A warm start is this share of the pressure away.
const NEAR: f32 = 0.98;
/// Newton iterations allowed from a warm start.
const BUDGET: u32 = 20;
/// From the axis of a limb to those of its actuators, m.
const CIRCLE_RADIUS_M: f32 = 0.03;

/// A count as an answer.
struct Count(usize);

impl Answer for Count {
    fn note(&self) -> Note {
        let count = u16::try_from(self.0).unwrap_or(u16::MAX);
        Note::of("-", 0, [f32::from(count)])
    }
}

/// A place `[x, y]` as an answer.
struct Place([f32; 2]);

impl Answer for Place {
    fn note(&self) -> Note {
        Note::of("-", 0, self.0)
    }
}

/// Puts all queries; whether each had the answer it must have: that there is a solution.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    let answered = CASES.each_ref().map(|case| put(bench, case));
    limb(bench);
    places(bench);
    answered.into_iter().all(|well| well)
}

/// All about one actuator; whether it could be solved.
fn put(bench: &mut impl Bench, case: &Case) -> bool {
    let name = case.name;
    let checked = bench.put("check", name, || black_box(&case.parameters).check());
    bench.put("shear modulus", name, || black_box(&case.parameters.material).shear_modulus_pa());
    let built = bench.put("new", name, || Actuator::new(black_box(&case.parameters)));
    let Ok(actuator) = &built else { return false };
    bench.put("rest", name, || black_box(actuator).rest());
    let none = Load::none();
    let cold = bench
        .put("forward, cold", name, || black_box(actuator).forward(black_box(case.pressure_pa), &none))
        .map(|solution| solution.state);
    let near = actuator.forward(NEAR * case.pressure_pa, &none).map(|solution| solution.state);
    let (Ok(cold), Ok(near)) = (cold, near) else { return false };
    bench.put("mean of two states", name, || {
        State::combine([black_box(&near), black_box(&cold)], |[one, other]| 0.5 * (one + other))
    });
    let solved = solvers(bench, case, actuator, (&cold, &near)) && tracked(bench, case, (&cold, &near));
    let blocked = case.parameters.motion == Motion::Bending || blocked(bench, case, actuator, &cold);
    let slopes = derivatives(bench, case, actuator, &cold);
    shape(bench, case, actuator, &cold);
    checked.is_ok() && solved && blocked && slopes
}

/// The solvers on the way to a state, from nothing and from a state near it; whether all arrive.
fn solvers(
    bench: &mut impl Bench,
    case: &Case,
    actuator: &Actuator<f32>,
    (cold, near): (&State<f32>, &State<f32>),
) -> bool {
    let (name, none, target, pressure_pa) = (case.name, Load::none(), case.target(cold), case.pressure_pa);
    let search = actuator.by_search();
    let range = PressureRange::physical();
    let listed = bench.put("inverse, all answers", name, || {
        let mut found = 0;
        let ended = black_box(actuator).inverse_all(&range, black_box(target), &none, &mut |_| found += 1);
        ended.map(|_| Count(found))
    });
    bench.put("range of pressures", name, || Count(black_box(range).contains(black_box(pressure_pa)).into()));
    let answers = [
        bench.put("inverse, within a range", name, || {
            black_box(actuator).inverse_within(black_box(&range), black_box(target), &none)
        }),
        bench.put("forward, warm", name, || {
            black_box(actuator).forward_from(black_box(near), black_box(pressure_pa), &none)
        }),
        bench.put("forward, warm, within a budget", name, || {
            black_box(actuator).forward_near(black_box(near), black_box(pressure_pa), &none, BUDGET)
        }),
        bench.put("inverse, cold", name, || black_box(actuator).inverse(black_box(target), &none)),
        bench
            .put("inverse, warm", name, || black_box(actuator).inverse_from(black_box(near), black_box(target), &none)),
        bench.put("inverse, warm, within a budget", name, || {
            black_box(actuator).inverse_near(black_box(near), black_box(target), &none, BUDGET)
        }),
        bench.put("inverse, by search", name, || black_box(&search).inverse(black_box(target), &none)),
    ];
    let solved = answers.iter().all(|answer| answer.as_ref().is_ok_and(|solution| solution.status == Status::Solved));
    solved && listed.is_ok_and(|Count(found)| found > 0)
}

/// The same by what a device has of the model, where it has it; whether that arrives.
fn tracked(bench: &mut impl Bench, case: &Case, (cold, near): (&State<f32>, &State<f32>)) -> bool {
    let (name, target, pressure_pa) = (case.name, case.target(cold), case.pressure_pa);
    let built = bench.put("new, tracker", name, || Tracker::new(black_box(&case.parameters)));
    let Ok(Some(tracker)) = built else { return built.is_ok() };
    bench.put("rest, tracker", name, || black_box(&tracker).rest());
    let forward =
        bench.put("forward, tracker", name, || black_box(&tracker).forward(black_box(near), black_box(pressure_pa)));
    let inverse =
        bench.put("inverse, tracker", name, || black_box(&tracker).inverse(black_box(near), black_box(target)));
    [forward, inverse].iter().all(|found| matches!(found, Ok(Some(_))))
}

/// The loads that hold a state.
fn blocked(bench: &mut impl Bench, case: &Case, actuator: &Actuator<f32>, state: &State<f32>) -> bool {
    let ends = (state.axial_stretch, state.twist_rad);
    let blocked = bench.put("blocked", case.name, || {
        let (stretch, twist) = black_box(ends);
        black_box(actuator).blocked(black_box(case.pressure_pa), stretch, twist)
    });
    let Ok(blocked) = blocked else { return false };
    let slope = bench.put("derivative of the loads by a radius", case.name, || {
        black_box(actuator).blocked_sensitivity(black_box(&blocked), black_box(Parameter::OuterRadius))
    });
    blocked.status == Status::Solved && slope.is_ok()
}

/// The centre line of a bundle of such actuators, where it has one.
fn shape(bench: &mut impl Bench, case: &Case, actuator: &Actuator<f32>, state: &State<f32>) {
    let parameters = actuator.parameters();
    let segment = Segment::of_bundle(parameters.motion, parameters.length_m, CIRCLE_RADIUS_M, state);
    if let Some(segment) = segment {
        bench.put("pose of a module", case.name, || black_box(segment).pose());
        bench.put("pose within a module", case.name, || black_box(segment).pose_at(black_box(0.3)));
    }
}

/// Derivatives of an equilibrium; whether the model has them.
fn derivatives(bench: &mut impl Bench, case: &Case, actuator: &Actuator<f32>, state: &State<f32>) -> bool {
    let (name, none, radius) = (case.name, Load::none(), Parameter::OuterRadius);
    let forward = bench.put("derivative by a radius", name, || {
        black_box(actuator).sensitivity(black_box(state), &none, black_box(radius))
    });
    let inverse = bench.put("derivative of the pressure by a radius", name, || {
        black_box(actuator).inverse_sensitivity(black_box(state), &none, case.target(state), black_box(radius))
    });
    let condition = bench.put("condition", name, || black_box(actuator).condition(black_box(state), &none));
    let inputs = bench.put("number of inputs", name, || Count(black_box(actuator).inputs().count()));
    forward.is_ok() && inputs.0 > 0 && inverse.is_ok() && condition.is_ok()
}

/// The pose of a limb of three modules.
fn limb(bench: &mut impl Bench) {
    let link = |bend_angle_rad, twist_rad, mount_angle_rad| Link {
        segment: Segment { length_m: 0.26, bend_angle_rad, twist_rad },
        mount_angle_rad,
        rigid_length_m: 0.015,
    };
    let links = [link(0.0, 0.0, 0.0), link(1.1, 0.0, 3.0), link(0.0, 0.7, 0.0)];
    bench.put("pose within a link", "bending", || black_box(links[1]).pose_at(black_box(0.3)));
    let stretches = [1.05_f32, 1.21, 1.13];
    bench.put("bend of a module", "steering", || {
        let (segment, towards_rad) = Segment::of_stretches(0.26, black_box(CIRCLE_RADIUS_M), &black_box(stretches))
            .unwrap_or((links[0].segment, 0.0));
        Place([segment.bend_angle_rad, towards_rad])
    });
    bench.put("pose of a tip", "three modules", || tip_pose(&Isometry3::identity(), black_box(links)));
}

/// The places of the actuators of a bundle.
fn places(bench: &mut impl Bench) {
    let arrangements = [
        ("circle of three", Arrangement::Circle { radius_m: CIRCLE_RADIUS_M }),
        ("row of three", Arrangement::Row { spacing_m: 0.034 }),
    ];
    for (name, arrangement) in arrangements {
        let count = 3;
        bench.put("place of an actuator", name, || Place(black_box(arrangement).position_m(black_box(1), count)));
        bench.put("last place of a bundle", name, || {
            black_box(arrangement).positions_m(black_box(count)).last().map(Place)
        });
        bench.put("reach of a bundle", name, || black_box(arrangement).reach_m(black_box(count)));
        bench.put("nearest two of a bundle", name, || black_box(arrangement).nearest_m(black_box(count)));
    }
}
