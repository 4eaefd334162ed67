//! Segments whose best geometry lies where the highest pressure and the margin to the limit point meet.

use fra_model::{Actuator, Load, Status};
use softlimb_design::actuators::{Answer, Budget, Geometry, Problem, Segment, solve};

use crate::design::common::{extension, objective};
use crate::samples::samples;

/// The segment at sizes in shares of their bounds: inner radius, wall, fiber angle.
fn geometry(segment: &Segment, x: [f64; 3], length_m: f64) -> Geometry {
    let at = |[low, high]: [f64; 2], x: f64| low + x * (high - low);
    let [inner, wall] = segment.bounds.sizes_m;
    let inner_radius_m = at(inner, x[0]);
    Geometry {
        inner_radius_m,
        outer_radius_m: inner_radius_m + at(wall, x[1]),
        length_m,
        angle_rad: at(segment.bounds.angle_rad, x[2]),
    }
}

/// Rest and highest deformation of a geometry, by forward solves.
fn span(segment: &Segment, x: [f64; 3], length_m: f64) -> [f64; 2] {
    let geometry = geometry(segment, x, length_m);
    let actuator = Actuator::new(&segment.parameters(&geometry)).expect("a geometry of the model");
    let share = 1.0 - segment.limit_margin;
    let beyond = actuator.forward(segment.pressure_max_pa / share, &Load::none()).expect("finite");
    let pressure = match beyond.status {
        Status::Solved => segment.pressure_max_pa,
        _ => segment.pressure_max_pa.min(share * beyond.limit_pressure_pa.expect("a limit point")),
    };
    [0.0, pressure].map(|p| {
        let solution = actuator.forward(p, &Load::none()).expect("finite");
        segment.measure(&solution.state, length_m)
    })
}

/// The least of a function of one share by golden sections, which need no derivative and do not mind a kink.
fn least(f: &mut dyn FnMut(f64) -> f64, sections: usize) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, 1.0);
    let mut best = f(0.0).min(f(1.0));
    let (mut a, mut b) = (1.0 - golden, golden);
    let (mut at_a, mut at_b) = (f(a), f(b));
    for _ in 0..sections {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = f(b);
        }
        best = best.min(at_a).min(at_b);
    }
    best
}

/// Whether the highest pressure of the bounds and the margin to the limit point are equal at an answer, to a share.
fn is_on_ridge(problem: &Problem, answer: &Answer, share: f64) -> bool {
    let (segment, found) = (&problem.segments()[0], &answer.segments[0]);
    let geometry = Geometry {
        inner_radius_m: found.inner_radius_m,
        outer_radius_m: found.outer_radius_m,
        length_m: found.length_m,
        angle_rad: found.angle_deg.to_radians(),
    };
    let actuator = Actuator::new(&segment.parameters(&geometry)).expect("a geometry of the model");
    let limit = actuator.forward(2.0 * segment.pressure_max_pa, &Load::none()).expect("finite").limit_pressure_pa;
    limit.is_some_and(|limit| ((1.0 - segment.limit_margin) * limit / segment.pressure_max_pa - 1.0).abs() < share)
}

/// A number in `0..1` of a seed, without a generator: multiples of the golden section are spread evenly.
fn spread(seed: usize, stream: usize) -> f64 {
    ((seed * 7 + stream) as f64 * 0.618_033_988_749_894_9 + 0.1).fract()
}

#[test]
fn twists_beyond_reach_are_approached_as_far_as_can_be_on_the_ridge() {
    let with = |targets: &str| {
        extension(&[
            ("extension", "twisting"),
            ("length_per_m2", "twist_per_rad2"),
            ("\"families\": 2", "\"families\": 1"),
            ("[0, 15]", "[15, 45]"),
            ("60000", "110000"),
            ("\"length_m\": [0.2, 0.21]", &format!("\"twist_rad\": {targets}")),
        ])
    };
    let read = |text: &str| Problem::read(text).unwrap_or_else(|error| panic!("{error}"));
    let problem = read(&with("[-1]"));
    let segment = &problem.segments()[0];
    // Twist is proportional to the length: the section that twists most is the same for all targets. The kink is sharp in the wall; over the
    // other sizes what is best is flat or at an end, so that fewer sections do.
    let most = -least(
        &mut |inner| {
            let of = |wall: f64, angle: f64| -span(segment, [inner, wall, angle], 1.0)[1].abs();
            least(&mut |angle| least(&mut |wall| of(wall, angle), 36), 20)
        },
        20,
    );
    let (mut on_ridge, problems) = (0, samples(100) as usize);
    for seed in 0..problems {
        let [a, b] =
            [0.2, 3.0].map(|factor| -factor * 0.3 * most * (0.6 + 2.0 * spread(seed, (10.0 * factor) as usize)));
        let problem = read(&with(&format!("[{a}, {b}]")));
        let answer = solve(&problem, &Budget { seed: seed as u64, ..Budget::default() }).expect("an answer");
        let short = |target: f64| (target.abs() - 0.3 * most).max(0.0);
        let optimum = 1e6 * (short(a).powi(2) + short(b).powi(2));
        let gap = objective(&problem, &answer) / optimum - 1.0;
        assert!((-1e-6..=1e-8).contains(&gap), "{seed}: {gap:e} above {optimum}");
        assert!(answer.segments[0].starts.agreeing >= 5, "{seed}: {:?}", answer.segments[0].starts);
        on_ridge += usize::from(is_on_ridge(&problem, &answer, 1e-9));
    }
    assert_eq!(on_ridge, problems);
}

#[test]
fn radii_beyond_reach_are_approached_as_far_as_can_be_on_the_ridge() {
    let (mut on_ridge, problems) = (0, samples(100) as usize);
    for seed in 0..problems {
        let targets = [0.008 + 0.0006 * spread(seed, 1), 0.019 + 0.002 * spread(seed, 2)];
        let text = extension(&[
            ("extension", "expansion"),
            ("length_per_m2", "outer_radius_per_m2"),
            ("[0, 15]", "[90, 90]"),
            ("[0.006, 0.010]", "[0.006, 0.007]"),
            ("[0.003, 0.005]", "[0.002, 0.003]"),
            ("60000", "55000"),
            ("\"length_m\": [0.2, 0.21]", &format!("\"outer_radius_m\": [{}, {}]", targets[0], targets[1])),
        ]);
        let problem = Problem::read(&text).unwrap_or_else(|error| panic!("{error}"));
        let segment = &problem.segments()[0];
        let left = |x: [f64; 3]| {
            let [rest, widest] = span(segment, x, 0.1);
            let short = |value: f64| (rest - value).max(value - widest).max(0.0);
            1e6 * targets.map(|target| short(target).powi(2)).iter().sum::<f64>()
        };
        let optimum = least(&mut |inner| least(&mut |wall| left([inner, wall, 0.0]), 36), 20);
        let answer = solve(&problem, &Budget { seed: seed as u64, ..Budget::default() }).expect("an answer");
        let gap = objective(&problem, &answer) / optimum - 1.0;
        assert!((-1e-5..=1e-8).contains(&gap), "{seed}: {gap:e} above {optimum}");
        on_ridge += usize::from(is_on_ridge(&problem, &answer, 1e-9));
    }
    assert!(2 * on_ridge >= problems, "{on_ridge} of {problems} are on the ridge");
}
