//! The questions: every public function of the model, put as a controller would.

use core::hint::black_box;

use fra_model::{
    Actuator, Argument, InverseTable, Link, Load, Motion, Parameter, Segment, Solution, State, Status,
    TABLE_COEFFICIENTS, TableParameters, VolumeTable, tip_pose,
};
use nalgebra::Isometry3;

use crate::Desk;
use crate::actuators::{CASES, Case};

/// A warm start is this share of the pressure away.
const NEAR: f32 = 0.98;
/// Newton iterations allowed from a warm start.
const BUDGET: u32 = 20;
/// From the axis of a limb to those of its actuators, m.
const CIRCLE_RADIUS_M: f32 = 0.03;

/// Puts all questions; whether each had the answer it must have: that there is a solution.
pub(crate) fn put_all(desk: &mut impl Desk) -> bool {
    let answered = CASES.each_ref().map(|case| put(desk, case));
    limb(desk);
    let tabulated = TABLES.map(|(name, argument, count)| table(desk, name, argument, count));
    answered.into_iter().chain(tabulated).all(|well| well)
}

/// The solvers of one actuator.
fn put(desk: &mut impl Desk, case: &Case) -> bool {
    let name = case.name;
    let (pressure_pa, none) = (case.pressure_pa, Load::none());
    let built = desk.put("new", name, || Actuator::new(black_box(&case.parameters)));
    let Ok(actuator) = &built else { return false };
    desk.put("rest", name, || black_box(actuator).rest());
    let cold = desk.put("forward, cold", name, || black_box(actuator).forward(black_box(pressure_pa), &none));
    let near = actuator.forward(NEAR * pressure_pa, &none);
    let (Ok(cold), Ok(near)) = (cold, near) else { return false };
    let (start, target) = (near.state, case.target(&cold.state));
    let answers = [
        desk.put("forward, warm", name, || {
            black_box(actuator).forward_from(black_box(&start), black_box(pressure_pa), &none)
        }),
        desk.put("inverse, cold", name, || black_box(actuator).inverse(black_box(target), &none)),
        desk.put("inverse, warm", name, || {
            black_box(actuator).inverse_from(black_box(&start), black_box(target), &none)
        }),
        desk.put("inverse, warm, within a budget", name, || {
            black_box(actuator).inverse_near(black_box(&start), black_box(target), &none, BUDGET)
        }),
    ];
    let parameters = &case.parameters;
    if parameters.motion != Motion::Bending {
        let ends = (cold.state.axial_stretch, cold.state.twist_rad);
        let held = desk.put("held", name, || {
            let (stretch, twist) = black_box(ends);
            black_box(actuator).held(black_box(pressure_pa), stretch, twist)
        });
        if !held.is_ok_and(|held| held.status == Status::Solved) {
            return false;
        }
    }
    let slopes = derivatives(desk, case, actuator, &cold.state);
    let segment = Segment::of_bundle(parameters.motion, parameters.length_m, CIRCLE_RADIUS_M, &cold.state);
    if let Some(segment) = segment {
        desk.put("pose of a module", name, || black_box(segment).pose());
    }
    let solved = |solution: &Solution<f32>| solution.status == Status::Solved;
    slopes && solved(&cold) && solved(&near) && answers.iter().all(|answer| answer.as_ref().is_ok_and(solved))
}

/// What an equilibrium depends on; whether the model says it.
fn derivatives(desk: &mut impl Desk, case: &Case, actuator: &Actuator<f32>, state: &State<f32>) -> bool {
    let (name, none, radius) = (case.name, Load::none(), Parameter::OuterRadius);
    let forward = desk.put("derivative by a radius", name, || {
        black_box(actuator).sensitivity(black_box(state), &none, black_box(radius))
    });
    let inverse = desk.put("derivative of the pressure by a radius", name, || {
        black_box(actuator).inverse_sensitivity(black_box(state), &none, case.target(state), black_box(radius))
    });
    let condition = desk.put("condition", name, || black_box(actuator).condition(black_box(state), &none));
    forward.is_ok() && inverse.is_ok() && condition.is_ok()
}

/// The pose of a limb of three modules.
fn limb(desk: &mut impl Desk) {
    let link = |bend_angle_rad, twist_rad, mount_angle_rad| Link {
        segment: Segment { length_m: 0.26, bend_angle_rad, twist_rad },
        mount_angle_rad,
        rigid_length_m: 0.015,
    };
    let links = [link(0.0, 0.0, 0.0), link(1.1, 0.0, 3.0), link(0.0, 0.7, 0.0)];
    desk.put("pose of a tip", "three modules", || tip_pose(&Isometry3::identity(), black_box(links)));
}

/// Tables with their coefficients: of the degree that most actuators need, and of the highest one.
const TABLES: [(&str, Argument, usize); 3] = [
    ("degree 5", Argument::Linear, 6),
    ("degree 16", Argument::Linear, TABLE_COEFFICIENTS),
    ("degree 16, of a root", Argument::Root, TABLE_COEFFICIENTS),
];

/// The lookups that stand in for a solver: a bend between 0 and 3 rad up to 97 kPa, with all coefficients in use.
fn table(desk: &mut impl Desk, name: &str, argument: Argument, count: usize) -> bool {
    const PRESSURE_MAX_PA: f32 = 97e3;
    let half = 0.5 * PRESSURE_MAX_PA;
    let mut pressures = [0.25; TABLE_COEFFICIENTS];
    let mut volumes = [1e-9; TABLE_COEFFICIENTS];
    pressures[..2].copy_from_slice(&[half, half]);
    volumes[..2].copy_from_slice(&[90e-6, 15e-6]);
    let inverse = InverseTable::new(&TableParameters {
        from: 0.0,
        to: 3.0,
        argument,
        steps: 32_768,
        pressure_max_pa: PRESSURE_MAX_PA,
        coefficients: &pressures[..count],
    });
    let volume = VolumeTable::new(PRESSURE_MAX_PA, &volumes[..count]);
    let (Ok(inverse), Ok(volume)) = (inverse, volume) else { return false };
    let found = desk.put("inverse, table", name, || black_box(&inverse).lookup(black_box(1.234)));
    let air = desk.put("volume, table", name, || black_box(&volume).lookup(black_box(40e3)));
    found.is_ok() && air.is_ok()
}
