//! Wound benders, whose analytic bend errs: designs against finite elements of the section, which the search does not ask.

use fra_model::Motion;
use softlimb_design::actuators::{Answer, Budget, Geometry, Problem, SegmentAnswer, solve};
use softlimb_fea::cross_section::{EndLoad, Options, Section};

use crate::design::common::extension;

/// The winding of the problem file, and one whose threads stretch.
const STIFF: (&str, &str) = ("3.61e8", "3.61e8");
const SOFT: (&str, &str) = ("3.61e8", "8e6");

fn effort(seed: u64) -> Budget {
    Budget { seed, ..Budget::default() }
}

fn bending(angles: &str, targets: &str, changes: &[(&str, &str)]) -> Problem {
    let targets = format!("{{\"bend_angle_rad\": {targets}}}");
    let bends = [
        ("\"extension\"", "\"bending\""),
        ("length_per_m2", "bend_angle_per_rad2"),
        ("[0, 15]", angles),
        ("{\"length_m\": [0.2, 0.21]}", &targets),
    ];
    Problem::read(&extension(&[&bends[..], changes].concat())).expect("a wound bender")
}

/// Bends at gauge pressures, rad, on a finer mesh than that of the design.
fn bends(problem: &Problem, geometry: &Geometry, pressures_pa: &[f64]) -> Vec<f64> {
    let (parameters, second) = problem.segments()[0].by_section(geometry).expect("wound");
    assert!(parameters.motion == Motion::Bending && second.is_none());
    let mut options = Options::default();
    options.mesh.radial += 2;
    options.mesh.around += 8;
    let curve =
        Section::new(&parameters, &options).and_then(|section| section.curve(pressures_pa, &EndLoad::default()));
    let answers = curve.expect("a geometry of the model").answers;
    answers
        .iter()
        .map(|answer| answer.equilibrium().expect("bends").state.over(geometry.length_m).bend_angle_rad)
        .collect()
}

fn geometry(found: &SegmentAnswer) -> Geometry {
    Geometry {
        inner_radius_m: found.inner_radius_m,
        outer_radius_m: found.outer_radius_m,
        length_m: found.length_m,
        angle_rad: found.angle_deg.to_radians(),
    }
}

/// The bends of an answer are those of finite elements at its pressures, and these are within its bounds.
fn bends_as_stated(problem: &Problem, answer: &Answer) {
    let found = &answer.segments[0];
    assert_eq!(found.bend.expect("wound").model, "section-fe", "{found:?}");
    let pressures_pa: Vec<f64> = found.phases.iter().map(|phase| phase.pressure_pa).collect();
    assert!(pressures_pa.iter().all(|pressure_pa| (0.0..=found.pressure_cap_pa).contains(pressure_pa)), "{found:?}");
    for (phase, exact) in found.phases.iter().zip(bends(problem, &geometry(found), &pressures_pa)) {
        assert!((phase.found - exact).abs() < 2e-3 * exact + 1e-9, "{phase:?} {exact}");
    }
}

/// Bends that a hidden geometry has, by finite elements: a design of the winding's angle reaches them, and with the angle given it keeps it.
#[test]
fn wound_benders_reach_the_bends_of_a_hidden_geometry() {
    let mut errors: Vec<f64> = Vec::new();
    for (angle_deg, angles, winding) in [
        (3.0, "[0, 25]", STIFF),
        (14.0, "[0, 25]", SOFT),
        (22.0, "[10, 25]", STIFF),
        (18.0, "[18, 18]", STIFF),
        (18.0, "[18, 18]", SOFT),
    ] {
        let open = bending(angles, "[0, 0]", &[winding]);
        let hidden = Geometry {
            inner_radius_m: 8e-3,
            outer_radius_m: 12e-3,
            length_m: 0.2,
            angle_rad: f64::to_radians(angle_deg),
        };
        let targets = bends(&open, &hidden, &[20e3, 50e3]);
        let problem = bending(angles, &format!("{targets:?}"), &[winding]);
        let answer = solve(&problem, &effort(1)).expect("an answer");
        let found = &answer.segments[0];
        println!("{angle_deg} deg: {} deg, objective {:.1e}, {:?}", found.angle_deg, answer.objective, found.phases);
        assert_eq!(answer.status, "reached", "{answer:?}");
        bends_as_stated(&problem, &answer);
        errors.extend(found.phases.iter().filter_map(|phase| Some(phase.analytic? / phase.found - 1.0)));
        if angles == "[18, 18]" {
            assert!((found.angle_deg - 18.0).abs() < 1e-9, "{}", found.angle_deg);
        }
    }
    // The analytic bend is off.
    assert!(
        errors.iter().all(|error| error.abs() > 2e-3) && errors.iter().any(|error| error.abs() > 0.05),
        "{errors:?}"
    );
}

/// The largest bend by finite elements that geometries on a grid of the bounds have, all as long as they may be.
fn farthest(problem: &Problem) -> f64 {
    let segment = &problem.segments()[0];
    let at = |[low, high]: [f64; 2], part: usize| low + 0.5 * part as f64 * (high - low);
    let [inner, wall] = segment.bounds.sizes_m;
    let bend = |corner: usize| {
        let inner_radius_m = at(inner, corner % 3);
        let geometry = Geometry {
            inner_radius_m,
            outer_radius_m: inner_radius_m + at(wall, corner / 3 % 3),
            length_m: segment.bounds.length_m[1],
            angle_rad: at(segment.bounds.angle_rad, corner / 9),
        };
        bends(problem, &geometry, &[segment.pressure_max_pa])[0]
    };
    (0..27).map(bend).fold(0.0, f64::max)
}

/// No geometry of a grid bends further by finite elements than the design.
#[test]
fn wound_bender_bends_as_far_as_its_bounds_allow() {
    for (angles, winding) in [("[8, 20]", STIFF), ("[8, 20]", SOFT), ("[18, 18]", SOFT)] {
        let problem = bending(angles, "[100]", &[winding]);
        let answer = solve(&problem, &effort(1)).expect("an answer");
        bends_as_stated(&problem, &answer);
        let (found, most) = (answer.segments[0].phases[0].found, farthest(&problem));
        println!("{angles} {winding:?}: {found} rad, on the grid {most} rad");
        assert!(found >= most * (1.0 - 2e-3), "{found} {most} {answer:?}");
    }
}

/// Bends that only the last part of the bounds reaches, and one beyond it.
#[test]
fn bend_at_the_edge_of_reach_is_reached() {
    let open = bending("[18, 18]", "[100]", &[SOFT]);
    let most = solve(&open, &effort(1)).expect("an answer").segments[0].phases[0].found;
    for share in [0.97, 0.998] {
        let problem = bending("[18, 18]", &format!("[{}]", share * most), &[SOFT]);
        let answer = solve(&problem, &effort(2)).expect("an answer");
        assert_eq!(answer.status, "reached", "{share}: {answer:?}");
        bends_as_stated(&problem, &answer);
        let phase = answer.segments[0].phases[0];
        assert!((phase.analytic.expect("an equilibrium") / phase.found - 1.0).abs() > 0.02, "{phase:?}");
    }
    // Beyond it the largest bend is the answer, and the shortfall stands in it.
    let problem = bending("[18, 18]", &format!("[{}]", 1.1 * most), &[SOFT]);
    let answer = solve(&problem, &effort(3)).expect("an answer");
    let phase = answer.segments[0].phases[0];
    assert!(answer.status == "best_found" && phase.bound == Some("pressure_max_pa"), "{answer:?}");
    assert!((phase.residual / (0.1 * most) + 1.0).abs() < 0.02, "{phase:?} {most}");
    bends_as_stated(&problem, &answer);
}

/// With an effort, no pressure of finite elements at the geometry found has a smaller sum of bend and effort.
#[test]
fn effort_and_bend_are_balanced_by_finite_elements() {
    let effort_weight = ("\"weights\": {", "\"weights\": {\"effort\": 100, ");
    let problem = bending("[18, 18]", "[0.6, 1.1]", &[effort_weight, SOFT]);
    let answer = solve(&problem, &effort(1)).expect("an answer");
    bends_as_stated(&problem, &answer);
    let (segment, found) = (&problem.segments()[0], &answer.segments[0]);
    for (goal, phase) in segment.goals.iter().zip(&found.phases) {
        let goal = goal.expect("stated");
        let pressures_pa: Vec<f64> = (-3..=3).map(|step| phase.pressure_pa * (1.0 + 0.02 * f64::from(step))).collect();
        let cost = |(pressure_pa, bend): (&f64, f64)| {
            goal.weight * (bend - goal.value).powi(2) + segment.effort_per_pa2 * pressure_pa.powi(2)
        };
        let costs: Vec<f64> =
            pressures_pa.iter().zip(bends(&problem, &geometry(found), &pressures_pa)).map(cost).collect();
        assert!(costs[3] > 0.0 && costs.iter().all(|cost| *cost >= costs[3] * (1.0 - 2e-3)), "{costs:?}");
    }
}

/// Two benders of other lengths on one supply line, with the bends of hidden geometries at common pressures.
#[test]
fn wound_benders_on_one_supply_line_reach_common_bends() {
    let one = extension(&[
        ("\"extension\"", "\"bending\""),
        ("length_per_m2", "bend_angle_per_rad2"),
        ("[0, 15]", "[18, 18]"),
        SOFT,
        ("\"format\": 1,", "\"format\": 1, \"shared_pressure\": true,"),
        ("{\"length_m\": [0.2, 0.21]}", "{\"bend_angle_rad\": [0, 0]}"),
    ]);
    let open = Problem::read(&one).expect("a wound bender");
    let hidden =
        |length_m| Geometry { inner_radius_m: 8e-3, outer_radius_m: 12e-3, length_m, angle_rad: f64::to_radians(18.0) };
    let first = one.find("    {\n").expect("a segment");
    let last = one.rfind("    }").expect("its end") + 5;
    let with =
        |length_m| one[first..last].replace("[0, 0]", &format!("{:?}", bends(&open, &hidden(length_m), &[20e3, 50e3])));
    let text = format!("{}{},\n{}{}", &one[..first], with(0.2), with(0.25), &one[last..]);
    let problem = Problem::read(&text).expect("two benders");
    let answer = solve(&problem, &effort(1)).expect("an answer");
    println!("{answer:?}");
    assert_eq!(answer.status, "reached");
    let [a, b] = [0, 1].map(|i| answer.segments[i].phases.iter().map(|phase| phase.pressure_pa).collect::<Vec<_>>());
    assert_eq!(a, b, "one line has one pressure");
    for (index, segment) in answer.segments.iter().enumerate() {
        let exact = bends(&problem, &geometry(segment), &a);
        for (phase, exact) in segment.phases.iter().zip(exact) {
            assert!(
                (phase.found / exact - 1.0).abs() < 2e-3 && phase.residual.abs() < 1e-4,
                "{index} {phase:?} {exact}"
            );
        }
    }
}

/// A winding of no modulus keeps its radius: the analytic model is all there is. So it is where its error is within the tolerance.
#[test]
fn other_benders_keep_the_analytic_model() {
    let plain = bending("[18, 18]", "[0.5]", &[("3.61e8", "0")]);
    let answer = solve(&plain, &effort(1)).expect("an answer");
    assert!(answer.segments[0].bend.is_none() && answer.segments[0].phases[0].analytic.is_none(), "{answer:?}");
    assert!(!serde_json::to_string(&answer).expect("JSON").contains("section-fe"));
}
