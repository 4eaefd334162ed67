//! Segments in series: sums, limits, inverse problems and poses.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::*;
use fra_model::*;
use nalgebra::{Isometry3, Rotation3, Vector3};

fn with_length(p: ActuatorParameters<f64>, length_m: f64) -> ActuatorParameters<f64> {
    ActuatorParameters { length_m, ..p }
}

fn extender() -> ActuatorParameters<f64> {
    let p = tube(Motion::Extension, 6.0, 8.0, DRAGONSKIN_30);
    wound(p, 3.0, Families::Two, 361e6, Placement::Sheet, 0.178)
}

fn twister() -> ActuatorParameters<f64> {
    let p = with_length(tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.22e6)), 0.06);
    wound(p, 30.0, Families::One, 50e6, Placement::Sheet, 0.2)
}

fn contractor() -> ActuatorParameters<f64> {
    let p = with_length(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 0.05);
    wound(p, 70.0, Families::Two, 361e6, Placement::Sheet, 0.178)
}

fn expander() -> ActuatorParameters<f64> {
    let p = with_length(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2226e6)), 0.04);
    wound(p, 90.0, Families::Two, 361e6, Placement::Sheet, 0.178)
}

fn bender(length_m: f64) -> ActuatorParameters<f64> {
    with_length(tube(Motion::Bending, 6.0, 8.0, neo_hookean(0.2e6)), length_m)
}

fn built(parameters: &[ActuatorParameters<f64>]) -> Vec<Actuator<f64>> {
    parameters.iter().map(|p| Actuator::new(p).expect("valid")).collect()
}

#[track_caller]
fn solved(segments: &[Actuator<f64>], pressure_pa: f64, load: &Load<f64>) -> SeriesState<f64> {
    let solution = Series::new(segments).expect("a tube").forward(pressure_pa, load).expect("finite");
    assert_eq!((solution.status, solution.limit), (Status::Solved, None), "{solution:?}");
    solution.state
}

fn fields(s: &SeriesState<f64>) -> [f64; 8] {
    [
        s.pressure_pa,
        s.length_m,
        s.extension_m,
        s.twist_rad,
        s.bend_angle_rad,
        s.volume_m3,
        s.volume_change_m3,
        s.compliance_m3_per_pa,
    ]
}

#[track_caller]
fn agree(a: &SeriesState<f64>, b: &SeriesState<f64>, tolerance: f64) {
    for (a, b) in fields(a).into_iter().zip(fields(b)) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{a} against {b}");
    }
}

#[test]
fn one_segment_is_the_actuator_itself() {
    let load = Load { force_n: 1.0, torque_nm: -0.004 };
    for (p, load) in [
        (extender(), load),
        (twister(), load),
        (contractor(), Load::none()),
        (tube(Motion::Expansion, 6.0, 8.0, DRAGONSKIN_30), load),
        (bender(0.1), load),
    ] {
        let segments = built(&[p]);
        let actuator = segments[0];
        for pressure_pa in [0.0, 1.0, 10e3, 30e3] {
            let alone = actuator.forward(pressure_pa, &load).unwrap().state;
            let rest_volume = PI * p.inner_radius_m * p.inner_radius_m * p.length_m;
            let expected = SeriesState {
                pressure_pa,
                length_m: alone.axial_stretch * p.length_m,
                extension_m: alone.axial_strain * p.length_m,
                twist_rad: alone.twist_rad,
                bend_angle_rad: alone.bend_angle_rad,
                volume_m3: alone.volume_m3,
                volume_change_m3: alone.volume_strain * rest_volume,
                compliance_m3_per_pa: alone.compliance_m3_per_pa,
            };
            agree(&solved(&segments, pressure_pa, &load), &expected, 0.0);
        }
        // The same pressure for the same target.
        let state = actuator.forward(20e3, &load).unwrap().state;
        let target = match p.motion {
            Motion::Bending => (SeriesTarget::BendAngle(state.bend_angle_rad), Target::BendAngle(state.bend_angle_rad)),
            Motion::Twisting => (SeriesTarget::Twist(state.twist_rad), Target::Twist(state.twist_rad)),
            Motion::Extension | Motion::Expansion => {
                (SeriesTarget::Extension(state.axial_strain * p.length_m), Target::AxialStretch(state.axial_stretch))
            }
        };
        let found = Series::new(&segments).unwrap().inverse(target.0, &load).unwrap();
        let alone = actuator.inverse(target.1, &load).unwrap();
        assert_eq!((found.status, alone.status), (Status::Solved, Status::Solved));
        assert!(relative(found.state.pressure_pa, alone.state.pressure_pa) < 1e-12, "{found:?} {alone:?}");
    }
}

#[test]
fn two_halves_are_the_whole() {
    let load = Load { force_n: 0.5, torque_nm: 0.003 };
    for p in [extender(), twister(), expander(), bender(0.1)] {
        let half = with_length(p, 0.5 * p.length_m);
        let (halves, whole) = (built(&[half, half]), built(&[p]));
        for pressure_pa in [-5e3, 0.5, 20e3] {
            if p.motion == Motion::Bending && pressure_pa < 0.0 {
                continue;
            }
            agree(&solved(&halves, pressure_pa, &load), &solved(&whole, pressure_pa, &load), 1e-14);
        }
    }
}

#[test]
fn the_order_of_the_segments_does_not_matter_to_the_sums() {
    for (a, b, c, pressure_pa) in [
        (extender(), twister(), contractor(), 40e3),
        (bender(0.1), twister(), expander(), 30e3),
        (bender(0.05), bender(0.1), extender(), 50e3),
    ] {
        let first = solved(&built(&[a, b, c]), pressure_pa, &Load::none());
        for order in [[a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]] {
            agree(&solved(&built(&order), pressure_pa, &Load::none()), &first, 1e-15 * 4.0);
        }
    }
}

/// Volume taken in equals the compliance integrated, segment by segment and in sum; the closure hands out the segments' solutions.
#[test]
fn each_segment_is_handed_out_at_the_common_pressure() {
    let parameters = [extender(), bender(0.08), twister()];
    let segments = built(&parameters);
    let series = Series::new(&segments).unwrap();
    assert_eq!(series.segments().len(), 3);
    let mut seen = vec![];
    let solution = series.forward_each(25e3, &Load::none(), |index, s| seen.push((index, *s))).unwrap();
    assert_eq!(seen.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1, 2]);
    for ((index, found), p) in seen.iter().zip(&parameters) {
        assert_eq!(*found, solve(p, 25e3), "segment {index}");
    }
    let volume: f64 = seen.iter().map(|(_, s)| s.state.volume_m3).sum();
    assert!(relative(volume, solution.state.volume_m3) < 1e-15);
    let mut again = vec![];
    let target = SeriesTarget::BendAngle(solution.state.bend_angle_rad);
    let inverse = series.inverse_each(target, &Load::none(), |_, s| again.push(s.state.pressure_pa)).unwrap();
    assert_eq!(again, [inverse.state.pressure_pa; 3]);
}

#[test]
fn the_limit_is_that_of_the_first_segment_to_end() {
    let bare = with_length(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 0.03);
    let parameters = [extender(), expander(), bare, twister()];
    let limits = parameters.map(|p| solve(&p, 1e6).limit_pressure_pa);
    let least = limits[2].unwrap();
    assert!(limits[1].unwrap() > least);
    let segments = built(&parameters);
    let series = Series::new(&segments).unwrap();
    for pressure_pa in [least * (1.0 + 1e-9), 1.2 * least, 100e3] {
        let solution = series.forward(pressure_pa, &Load::none()).unwrap();
        assert_eq!(solution.status, Status::NoSolution);
        let limit = solution.limit.unwrap();
        assert_eq!(limit.segment, 2);
        assert!(relative(limit.pressure_pa.unwrap(), least) < 1e-12);
        assert_eq!(solution.state.pressure_pa, limit.pressure_pa.unwrap());
    }
    let below = solved(&segments, least * (1.0 - 1e-12), &Load::none());
    let at = series.forward(1e5, &Load::none()).unwrap().state;
    // Up to the root by which a fold is approached.
    agree(&SeriesState { compliance_m3_per_pa: at.compliance_m3_per_pa, ..below }, &at, 1e-4);

    // Targets up to there are reached, others are not.
    let reached = |extension| series.inverse(SeriesTarget::Extension(extension), &Load::none()).unwrap();
    let just = reached(at.extension_m * (1.0 - 1e-7));
    assert_eq!(just.status, Status::Solved);
    assert!(relative(just.state.extension_m, at.extension_m * (1.0 - 1e-7)) < 1e-9);
    let beyond = reached(at.extension_m * (1.0 + 1e-6));
    assert_eq!((beyond.status, beyond.limit.unwrap().segment), (Status::NoSolution, 2));
    assert!(relative(beyond.limit.unwrap().pressure_pa.unwrap(), least) < 1e-12);
}

#[test]
fn inverse_problems_lead_back() {
    for (parameters, pressures) in [
        (vec![extender(), bender(0.08), twister()], [1e2, 20e3, 80e3]),
        (vec![expander(), bender(0.2)], [1.0, 10e3, 60e3]),
        (vec![twister(), twister(), extender()], [5.0, 30e3, 90e3]),
    ] {
        let segments = built(&parameters);
        let series = Series::new(&segments).unwrap();
        for pressure_pa in pressures {
            let state = solved(&segments, pressure_pa, &Load::none());
            let targets = [
                (state.extension_m, SeriesTarget::Extension(state.extension_m)),
                (state.twist_rad, SeriesTarget::Twist(state.twist_rad)),
                (state.bend_angle_rad, SeriesTarget::BendAngle(state.bend_angle_rad)),
            ];
            for (_, target) in targets.into_iter().filter(|(value, _)| *value != 0.0) {
                let found = series.inverse(target, &Load::none()).unwrap();
                assert_eq!(found.status, Status::Solved, "{target:?} {found:?}");
                let off = relative(found.state.pressure_pa, pressure_pa);
                assert!(off < 1e-11, "{target:?} at {pressure_pa} Pa: off by {off:e}");
            }
        }
        let rest = series.inverse(SeriesTarget::Extension(0.0), &Load::none()).unwrap();
        assert_eq!((rest.status, rest.state.pressure_pa), (Status::Solved, 0.0));
    }
}

/// A series that first shortens and then lengthens: of two pressures the lower, found by scanning in small steps.
#[test]
fn of_several_pressures_the_first_on_the_way_up_answers() {
    let shortener = wound(
        tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)),
        50.0,
        Families::Two,
        361e6,
        Placement::Sheet,
        0.178,
    );
    let segments = built(&[shortener, with_length(extender(), 0.05)]);
    let series = Series::new(&segments).unwrap();
    let extension = |pressure_pa: f64| solved(&segments, pressure_pa, &Load::none()).extension_m;
    let scan: Vec<f64> = (0..2000).map(|i| extension(50.0 * f64::from(i))).collect();
    let lowest = scan.iter().copied().fold(0.0, f64::min);
    assert!(lowest < -1e-4 && scan[1999] > 0.0, "not the example meant: {lowest} {}", scan[1999]);
    for share in [0.999, 0.9, 0.5, 0.01] {
        let target = share * lowest;
        let after = scan.iter().position(|e| *e <= target).unwrap();
        let found = series.inverse(SeriesTarget::Extension(target), &Load::none()).unwrap();
        assert_eq!(found.status, Status::Solved);
        let pressure_pa = found.state.pressure_pa;
        let bracket = 50.0 * (after as f64 - 1.0)..=50.0 * after as f64;
        assert!(bracket.contains(&pressure_pa), "{share}: {pressure_pa} Pa not in {bracket:?}");
        assert!((found.state.extension_m - target).abs() <= 1e-14 * 0.15, "{}", found.state.extension_m - target);
    }
    // Beyond the turn there is no more shortening, and what is longer comes after it.
    let target = 0.5 * scan[1999];
    let found = series.inverse(SeriesTarget::Extension(target), &Load::none()).unwrap();
    let after = scan.iter().position(|e| *e >= target).unwrap();
    assert!((found.state.pressure_pa - 50.0 * after as f64).abs() <= 50.0);
    let never = series.inverse(SeriesTarget::Extension(1.01 * lowest), &Load::none()).unwrap();
    assert_eq!(never.status, Status::NoSolution);
}

fn shapes(series: &Series<f64>, pressure_pa: f64, directions: &[f64]) -> Vec<(State<f64>, f64)> {
    let mut states = vec![];
    series.forward_each(pressure_pa, &Load::none(), |_, s| states.push(s.state)).unwrap();
    states.into_iter().zip(directions.iter().copied()).collect()
}

fn tip(segments: &[Actuator<f64>], pressure_pa: f64, directions: &[f64]) -> Isometry3<f64> {
    let series = Series::new(segments).unwrap();
    series.tip_pose(&Isometry3::identity(), shapes(&series, pressure_pa, directions))
}

#[track_caller]
fn same_pose(found: &Isometry3<f64>, position: Vector3<f64>, rotation: Rotation3<f64>) {
    assert!((found.translation.vector - position).norm() < 1e-14, "{found} against {position}");
    let off = (found.rotation.to_rotation_matrix().matrix() - rotation.matrix()).norm();
    assert!(off < 1e-14, "{found} against {rotation}: off by {off:e}");
}

#[test]
fn tips_are_where_arcs_lines_and_turns_lead() {
    let pressure_pa = 40e3;
    let bent = solve(&bender(0.1), pressure_pa).state;
    let (phi, radius) = (bent.bend_angle_rad, bent.axial_stretch * 0.1 / bent.bend_angle_rad);
    let about = |axis: Vector3<f64>, angle: f64| Rotation3::from_scaled_axis(axis * angle);
    let arc = |direction: f64| {
        let (aside, along) = (radius * (1.0 - phi.cos()), radius * phi.sin());
        let towards = Vector3::new(direction.cos(), direction.sin(), 0.0);
        (towards * aside + Vector3::z() * along, about(Vector3::z().cross(&towards), phi))
    };
    // Two halves are one arc; an S ends parallel to its start.
    let (position, rotation) = arc(0.0);
    same_pose(&tip(&built(&[bender(0.05), bender(0.05)]), pressure_pa, &[0.0, 0.0]), position, rotation);
    let two = built(&[bender(0.1), bender(0.1)]);
    same_pose(
        &tip(&two, pressure_pa, &[0.0, PI]),
        Vector3::new(2.0 * radius * (1.0 - phi.cos()), 0.0, 2.0 * radius * phi.sin()),
        Rotation3::identity(),
    );
    // A bend to the side follows the first.
    let ((first, turned), (second, then)) = (arc(0.3), arc(0.3 + FRAC_PI_2));
    same_pose(&tip(&two, pressure_pa, &[0.3, 0.3 + FRAC_PI_2]), first + turned * second, turned * then);
    // A twist turns the direction of the bend behind it, not of the one before it.
    let twisted = solve(&twister(), pressure_pa).state;
    let (line, turn) = (Vector3::z() * (0.06 * twisted.axial_stretch), about(Vector3::z(), twisted.twist_rad));
    let after = tip(&built(&[twister(), bender(0.1)]), pressure_pa, &[0.0, 0.2]);
    let (position, rotation) = arc(0.2);
    same_pose(&after, line + turn * position, turn * rotation);
    let before = tip(&built(&[bender(0.1), twister()]), pressure_pa, &[0.2, 0.0]);
    same_pose(&before, position + rotation * line, rotation * turn);
    // Straight segments make one line, and turn in sum.
    let three = built(&[extender(), twister(), extender()]);
    let sum = solved(&three, pressure_pa, &Load::none());
    same_pose(&tip(&three, pressure_pa, &[0.0; 3]), Vector3::z() * sum.length_m, about(Vector3::z(), sum.twist_rad));
}

#[test]
fn segments_that_make_no_tube_are_named() {
    let wider = tube(Motion::Expansion, 6.0, 9.0, neo_hookean(0.2e6));
    let narrower = tube(Motion::Expansion, 5.0, 8.0, neo_hookean(0.2e6));
    let message = |p: &[ActuatorParameters<f64>]| Series::new(&built(p)).expect_err("no tube").to_string();
    let tail = "is not allowed: that of the first segment: they are one tube";
    assert_eq!(message(&[]), "a series needs at least one segment");
    assert_eq!(
        message(&[extender(), bender(0.1), wider]),
        format!("segment 2: outer_radius_m = 0.009000000000000001 {tail}")
    );
    assert_eq!(message(&[extender(), narrower]), format!("segment 1: inner_radius_m = 0.005 {tail}"));

    let mixed = built(&[extender(), bender(0.1)]);
    let (straight, bent) = (built(&[extender(), twister()]), built(&[bender(0.1), bender(0.05)]));
    let refused = |segments: &[Actuator<f64>], target, load: &Load<f64>| {
        Series::new(segments).unwrap().inverse(target, load).expect_err("refused").field
    };
    let none = Load::none();
    let (force, torque) = (Load { force_n: 1.0, ..none }, Load { torque_nm: 0.01, ..none });
    assert_eq!(refused(&mixed, SeriesTarget::BendAngle(0.1), &force), "external_force_n");
    assert_eq!(refused(&mixed, SeriesTarget::BendAngle(0.1), &torque), "external_torque_nm");
    assert!(Series::new(&mixed).unwrap().forward(1e4, &torque).is_err());
    assert!(Series::new(&straight).unwrap().forward(1e4, &torque).is_ok());
    assert!(Series::new(&bent).unwrap().forward(1e4, &torque).is_ok());
    assert_eq!(refused(&straight, SeriesTarget::BendAngle(0.1), &none), "bend_angle_rad");
    assert_eq!(refused(&bent, SeriesTarget::Twist(0.1), &none), "twist_rad");
    assert_eq!(refused(&bent, SeriesTarget::BendAngle(-0.1), &none), "bend_angle_rad");
    assert_eq!(refused(&straight, SeriesTarget::Twist(f64::NAN), &none), "twist_rad");
    assert_eq!(refused(&straight, SeriesTarget::Extension(-0.16), &none), "extension_m");
    assert_eq!(refused(&straight, SeriesTarget::Extension(f64::INFINITY), &none), "extension_m");
    let infinite = Load { force_n: f64::NAN, ..none };
    assert_eq!(refused(&straight, SeriesTarget::Extension(0.01), &infinite), "external_force_n");
    assert_eq!(Series::new(&straight).unwrap().forward(f64::NAN, &none).unwrap_err().field, "pressure_pa");
}

#[test]
fn single_precision_agrees_with_double() {
    let parameters = [extender(), bender(0.08), twister()];
    let (wide, narrow) = (built(&parameters), parameters.map(|p| Actuator::new(&single(&p)).unwrap()));
    for pressure_pa in [10.0_f32, 5e3, 40e3, 90e3] {
        let exact = solved(&wide, pressure_pa.into(), &Load::none());
        let series = Series::new(&narrow).unwrap();
        let found = series.forward(pressure_pa, &Load::none()).unwrap();
        assert_eq!(found.status, Status::Solved);
        let found = found.state;
        for (a, b) in [
            (found.extension_m, exact.extension_m),
            (found.twist_rad, exact.twist_rad),
            (found.bend_angle_rad, exact.bend_angle_rad),
            (found.volume_change_m3, exact.volume_change_m3),
        ] {
            assert!(relative(a.into(), b) < 1e-5, "{a} against {b} at {pressure_pa} Pa");
        }
        let inverse = series.inverse(SeriesTarget::BendAngle(found.bend_angle_rad), &Load::none()).unwrap();
        assert_eq!(inverse.status, Status::Solved);
        assert!(relative(inverse.state.pressure_pa.into(), pressure_pa.into()) < 1e-5);
    }
}
