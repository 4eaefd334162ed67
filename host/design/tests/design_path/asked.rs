//! Directions, boxes, and the figures of an answer.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use softlimb_design::synthesis::kinds::Kind;
use softlimb_design::synthesis::{Aim, Budget, Direction, ModuleMotion, design};

use crate::design_path::remade::Remade;

/// What a limb does by chance is asked of another one.
#[test]
fn directions_and_boxes_are_met() {
    for (kind, seed, tolerance_rad) in [(Kind::E, 1, 0.0), (Kind::C, 4, 0.05), (Kind::E, 3, 0.3)] {
        let mut posed = kind.pose(seed).unwrap();
        posed.task.obstacles.clear();
        let effort = |seed| Budget { seed, ..Budget::default() };
        let by_chance = design(&posed.task, &posed.spaces, &effort(1)).unwrap();
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.5, -0.2));
        let half_m = Vector3::new(5e-3, 10e-3, 2e-3);
        for (way_point, answer) in posed.task.way_points.iter_mut().zip(&by_chance.way_points).take(3) {
            way_point.direction = Some(Direction { axis: Vector3::from(answer.axis).normalize(), tolerance_rad });
            let center_m = Vector3::from(answer.tip_m) + turn * Vector3::new(4e-3, -8e-3, 0.0);
            way_point.aim = Some(Aim::Inside { center_m, half_m, rotation: turn });
        }
        let found = design(&posed.task, &posed.spaces, &effort(2)).unwrap();
        assert!(found.does_it(), "{kind:?} {seed}: {:?}", found.shortfall);
        assert_ne!(found.modules, by_chance.modules);
        let remade = Remade::new(&posed.task, &posed.spaces, &found);
        for (way_point, answer) in posed.task.way_points.iter().zip(&found.way_points).take(3) {
            let links = remade.at_pressures(&answer.pressure_pa);
            let axis = links.iter().fold(posed.task.base, |pose, (link, _)| pose * link.pose()).rotation * Vector3::z();
            let asked = way_point.direction.unwrap();
            let off = axis.cross(&asked.axis).norm().atan2(axis.dot(&asked.axis));
            assert!(off <= asked.tolerance_rad + 1e-5, "{off} rad off");
            let Some(Aim::Inside { center_m, .. }) = &way_point.aim else { panic!("a box") };
            let local = turn.inverse() * (remade.tip(&links) - center_m);
            assert!((0..3).all(|axis| local[axis].abs() <= half_m[axis] + 1e-6), "{local:?}");
        }
    }
}

#[test]
fn mass_and_air_are_those_of_tubes() {
    let mut posed = Kind::A.pose(3).unwrap();
    posed.task.obstacles.clear();
    posed.task.way_points.truncate(1);
    let found = design(&posed.task, &posed.spaces, &Budget::default()).unwrap();
    let mut mass = posed.task.rigid_mass_kg[1];
    let mut air = 0.0;
    for (index, module) in found.modules.iter().enumerate() {
        let [inner, outer] = [module.inner_radius_m, module.outer_radius_m];
        let count = f64::from(posed.spaces[index].actuators);
        mass += count * PI * (outer * outer - inner * inner) * module.length_m * 1080.0 + posed.task.rigid_mass_kg[0];
        // From rest to the only way-point: what is inside at the end, less what was. An incompressible straight wall keeps its section.
        let answer = &found.way_points[0];
        let stretch = answer.deformation[index];
        let before = PI * inner * inner * module.length_m;
        let after = match module.motion {
            ModuleMotion::Extension => {
                let links = Remade::new(&posed.task, &posed.spaces, &found).at_pressures(&answer.pressure_pa);
                let outside = links[index].1 - posed.spaces[index].reach_m;
                let length = stretch * module.length_m;
                PI * outside * outside * length - PI * (outer * outer - inner * inner) * module.length_m
            }
            // The winding keeps its radius, and the line along the outside its length.
            _ => {
                PI * outer * outer * (module.length_m + outer * stretch)
                    - (PI * outer * outer * module.length_m - before)
            }
        };
        air += count * (after * (answer.pressure_pa[index] / 101_325.0 + 1.0) - before);
    }
    let figures = &found.figures;
    assert!((figures.mass_kg - mass).abs() < 1e-12, "{} {mass}", figures.mass_kg);
    assert!((figures.air_m3 / air - 1.0).abs() < 1e-6, "{} {air}", figures.air_m3);
}
