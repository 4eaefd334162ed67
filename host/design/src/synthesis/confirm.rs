//! What the model says about a limb that was found: pressures by its explicit inverses, everything else by forward solves at these.

use fra_model::State;

use super::aim::{DIRECTION_MM, MM};
use super::candidate::{Candidate, Figures, ModuleDesign, WayPointAnswer};
use super::made::{Made, Shape};
use super::moves::Move;
use super::realise::Exact;
use super::response::Section;
use super::table::Curve;
use super::task::{Space, Task, TaskError};
use softlimb_numerics::statistics::root_mean_square;

/// Standard atmosphere, Pa.
const ATMOSPHERE_PA: f64 = 101_325.0;

fn refused(space: &Space, reason: impl std::fmt::Display) -> TaskError {
    TaskError::Bounds { place: format!("module {}", space.segment.name), reason: reason.to_string() }
}

/// Asks the model about a limb that was found.
///
/// # Errors
/// [`TaskError::Bounds`] where it does not confirm a section.
pub(super) fn confirm(exact: &Exact, sections: &[Space]) -> Result<Candidate, TaskError> {
    let (task, layout) = (exact.objective.task, &exact.objective.layout);
    let final_spaces: Vec<Space> = sections
        .iter()
        .enumerate()
        .map(|(module, space)| {
            let mut space = space.clone();
            space.segment.bounds.length_m = [layout.length_and_mount(&exact.place, module)[0][0]; 2];
            space
        })
        .collect();
    let mut made = Vec::new();
    for (module, space) in final_spaces.iter().enumerate() {
        let section = Section::new(space, &[0.5; 4]).map_err(|reason| refused(space, reason))?;
        let next = final_spaces.get(module + 1).map(Space::behind);
        made.push(Made {
            section,
            density_kg_per_m3: space.density_kg_per_m3,
            actuators: space.actuators,
            name: &space.segment.name,
            mount_angle_rad: layout.mount_angle_rad(&exact.place, module),
            rigid_m: task.rigid_parts_m(space.ends_m[1], next),
            rigid_kg: if next.is_some_and(|next| next.joined) { 0.0 } else { task.rigid_mass_kg[0] },
            ends_m: space.ends_m,
            joined: space.joined,
        });
    }
    let curves = exact.objective.curves(&exact.place);
    let mut way_points = Vec::new();
    let mut shapes = Vec::new();
    let mut spare = None;
    for to in 0..task.way_points.len() {
        let shares: Vec<f64> = (0..made.len()).map(|module| exact.place[layout.share(to, module)]).collect();
        let states =
            pressed(&made, &shares).ok_or_else(|| refused(&final_spaces[0], "a deformation found has no pressure"))?;
        let shape = Shape::new(task, &made, states);
        let mut answer = shape.answer(task, &made, to);
        let nearest = nearest(exact, &curves, to);
        spare = nearest.iter().map(|(spare, _)| *spare).chain(spare).reduce(f64::min);
        if task.move_to(to) {
            answer.move_clearance_m = nearest.iter().map(|(_, distance)| *distance).reduce(f64::min);
        }
        way_points.push(answer);
        shapes.push(shape);
    }
    let modules: Vec<ModuleDesign> = made.iter().map(Made::design).collect();
    let figures = figures(task, &made, &modules, &way_points, &shapes, spare);
    let objective_mm2 = objective(task, &way_points, &shapes);
    Ok(Candidate { modules, way_points, figures, objective_mm2, shortfall: None, evaluations: 0 })
}

/// Forward solutions at the pressures of shares. Segments of one actuator get the mean of their pressures. `None` where a share has no pressure.
fn pressed(made: &[Made], shares: &[f64]) -> Option<Vec<State<f64>>> {
    let pressures_pa: Vec<f64> =
        made.iter().zip(shares).map(|(made, share)| made.pressure_pa(*share)).collect::<Option<_>>()?;
    let mut states = Vec::with_capacity(made.len());
    let mut first = 0;
    while first < made.len() {
        let segments = made[first + 1..].iter().take_while(|made| made.joined).count() + 1;
        let chamber = first..first + segments;
        let mean_pa = pressures_pa[chamber.clone()].iter().sum::<f64>() / segments as f64;
        let cap_pa = made[chamber.clone()].iter().map(|made| made.section.cap_pa()).fold(f64::INFINITY, f64::min);
        for made in &made[chamber] {
            states.push(made.section.at(mean_pa.min(cap_pa))?);
        }
        first += segments;
    }
    Some(states)
}

/// For every obstacle the least clearance beyond what is required and the least clearance, m: at a way-point, or along the move to it.
fn nearest(exact: &Exact, curves: &[Curve], to: usize) -> Vec<(f64, f64)> {
    let (objective, task) = (&exact.objective, exact.objective.task);
    let line = Move { objective, place: &exact.place, curves, from: to.checked_sub(1), to };
    let found = task.obstacles.iter().filter_map(|obstacle| {
        let distance_m = line.nearest(&obstacle.shape, f64::INFINITY)?.clearance.distance_m;
        Some((distance_m - obstacle.clearance_m, distance_m))
    });
    found.collect()
}

fn objective(task: &Task, way_points: &[WayPointAnswer], shapes: &[Shape]) -> f64 {
    let mut sum = 0.0;
    for ((answer, way_point), shape) in way_points.iter().zip(&task.way_points).zip(shapes) {
        let turned = 2.0 * (0.5 * answer.direction_error_rad).sin();
        sum += way_point.weight * ((MM * answer.tip_error_m).powi(2) + (DIRECTION_MM * turned).powi(2));
        sum += shape.penetration_mm2(task);
    }
    sum
}

fn figures(
    task: &Task,
    made: &[Made],
    modules: &[ModuleDesign],
    way_points: &[WayPointAnswer],
    shapes: &[Shape],
    spare_clearance_m: Option<f64>,
) -> Figures {
    let most = |value: fn(&WayPointAnswer) -> f64| way_points.iter().map(value).fold(0.0, f64::max);
    Figures {
        tip_error_rms_m: root_mean_square(way_points.iter().map(|answer| answer.tip_error_m)).unwrap_or(0.0),
        tip_error_max_m: most(|answer| answer.tip_error_m),
        direction_error_max_rad: most(|answer| answer.direction_error_rad),
        pressure_max_pa: most(|answer| answer.pressure_pa.iter().copied().fold(0.0, f64::max)),
        mass_kg: modules.iter().map(|module| module.mass_kg).sum::<f64>() + task.rigid_mass_kg[1],
        spare_clearance_m,
        air_m3: air(made, shapes),
    }
}

/// Gas put in from rest through all way-points, as its volume at atmospheric pressure, m3: isothermal, and what is vented is lost.
fn air(made: &[Made], shapes: &[Shape]) -> f64 {
    let free = |state: &State<f64>| state.volume_m3 * (state.pressure_pa + ATMOSPHERE_PA) / ATMOSPHERE_PA;
    let mut sum = 0.0;
    for (module, made) in made.iter().enumerate() {
        let mut before = free(made.section.rest());
        for shape in shapes {
            let now = free(&shape.states[module]);
            sum += f64::from(made.actuators) * (now - before).max(0.0);
            before = now;
        }
    }
    sum
}
