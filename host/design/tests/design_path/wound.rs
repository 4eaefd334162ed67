//! Wound benders, whose analytic bend errs, in limbs that are led by their tip.

use fra_model::{Link, Load, Motion, Segment, State, tip_pose};
use nalgebra::Vector3;
use softlimb_design::actuators::{Bounds, Geometry, Winding};
use softlimb_design::synthesis::kinds::{Kind, space};
use softlimb_design::synthesis::{Aim, Budget, Space, Task, WayPoint, design};
use softlimb_fea::cross_section::{EndLoad, Options, Section};

use crate::design_path::remade::Remade;

/// A bending module whose mirrored threads are at an angle from the hoop, with an axial thread where `is_reinforced`, and an extending one.
fn spaces(angle_deg: f64, is_reinforced: bool) -> [Space; 2] {
    let extending = space(Motion::Extension);
    let mut bending = space(Motion::Bending);
    let segment = &mut bending.segment;
    segment.bounds.angle_rad = [angle_deg.to_radians(); 2];
    let winding = extending.segment.winding.expect("wound");
    (segment.winding, segment.section) = (Some(winding), Some(winding));
    if is_reinforced {
        let axial = Winding { modulus_pa: 2e6, ..winding };
        segment.second = Some((axial, 60_f64.to_radians()));
    }
    [bending, extending]
}

/// The state of an actuator at a gauge pressure, on a finer mesh than that of the design; of straight ones by the closed form.
fn state(space: &Space, geometry: &Geometry, pressure_pa: f64) -> State<f64> {
    let Some((parameters, second)) = space.segment.by_section(geometry) else {
        return space.segment.actuator(geometry).unwrap().forward(pressure_pa, &Load::none()).unwrap().state;
    };
    let mut options = Options::default();
    options.mesh.radial += 2;
    options.mesh.around += 8;
    let section = match &second {
        None => Section::new(&parameters, &options),
        Some(second) => Section::with_two_windings(&parameters, second, &options),
    };
    let answer = section.unwrap().curve(&[pressure_pa], &EndLoad::default()).unwrap().answers[0];
    answer.equilibrium().expect("bends").state.over(geometry.length_m)
}

/// Way-points that a hidden limb has by finite elements are reached, again by finite elements, and the analytic bend would miss them.
#[test]
fn tip_is_led_by_bends_of_finite_elements() {
    for (angle_deg, is_reinforced) in [(12.0, false), (22.0, false), (4.0, true)] {
        let spaces = spaces(angle_deg, is_reinforced);
        let mut task = Kind::A.pose(1).unwrap().task;
        task.obstacles.clear();
        let middle = |[low, high]: Bounds, share: f64| low + share * (high - low);
        let hidden = spaces.clone().map(|space| {
            let bounds = &space.segment.bounds;
            let inner_radius_m = middle(bounds.sizes_m[0], 0.6);
            Geometry {
                inner_radius_m,
                outer_radius_m: inner_radius_m + middle(bounds.sizes_m[1], 0.3),
                length_m: middle(bounds.length_m, 0.4),
                angle_rad: middle(bounds.angle_rad, 0.5),
            }
        });
        let tip = |task: &Task, states: Vec<State<f64>>, lengths_m: [f64; 2], mounts_rad: [f64; 2]| {
            let links = states.into_iter().enumerate().map(|(index, state)| {
                let reach_m = spaces[index].reach_m;
                let segment = Segment::of_bundle(spaces[index].motion(), lengths_m[index], reach_m, &state).unwrap();
                let rigid_length_m = task.connector_m[0] + if index == 1 { task.tool_m[0] } else { 0.0 };
                Link { segment, mount_angle_rad: mounts_rad[index], rigid_length_m }
            });
            tip_pose(&task.base, links).translation.vector
        };
        let pressures_pa = [[15e3, 50e3], [35e3, 20e3], [52e3, 40e3]];
        let lengths_m = hidden.map(|geometry| geometry.length_m);
        task.way_points = pressures_pa
            .iter()
            .map(|pressures_pa| {
                let states = (0..2).map(|index| state(&spaces[index], &hidden[index], pressures_pa[index]));
                WayPoint::at(tip(&task, states.collect(), lengths_m, [0.7, 0.0]).into())
            })
            .collect();
        let found = design(&task, &spaces, &Budget::default()).unwrap();
        assert!(found.does_it(), "{angle_deg} {is_reinforced}: {:?}", found.shortfall);
        let remade = Remade::new(&task, &spaces, &found);
        remade.within_bounds(&found);
        let mut missed_analytically_m = 0.0_f64;
        for (answer, way_point) in found.way_points.iter().zip(&task.way_points) {
            let Some(Aim::Point(point)) = &way_point.aim else { panic!("a point") };
            let states =
                spaces.iter().zip(&found.modules).zip(&answer.pressure_pa).map(|((space, module), pressure_pa)| {
                    let geometry = Geometry {
                        inner_radius_m: module.inner_radius_m,
                        outer_radius_m: module.outer_radius_m,
                        length_m: module.length_m,
                        angle_rad: module.fiber_angle_rad,
                    };
                    state(space, &geometry, *pressure_pa)
                });
            let lengths_m = [0, 1].map(|index: usize| found.modules[index].length_m);
            let mounts_rad = [0, 1].map(|index: usize| found.modules[index].mount_angle_rad);
            let off_m = (tip(&task, states.collect(), lengths_m, mounts_rad) - point).norm();
            println!("{angle_deg} {is_reinforced}: {off_m:.1e} m off");
            assert!(off_m < 1e-5, "{angle_deg} {is_reinforced}: {off_m:e} m");
            assert!((Vector3::from(answer.tip_m) - point).norm() < 1e-6);
            let analytic = remade.tip(&remade.at_pressures(&answer.pressure_pa));
            missed_analytically_m = missed_analytically_m.max((analytic - point).norm());
        }
        println!("{angle_deg} {is_reinforced}: analytic {missed_analytically_m:.1e} m off");
        assert!(missed_analytically_m > 2e-3, "{angle_deg} {is_reinforced}: {missed_analytically_m:e} m");
    }
}
