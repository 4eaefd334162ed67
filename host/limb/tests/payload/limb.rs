//! Limbs in a pose: what they have to hold, and what they can.

use std::path::Path;

use fra_model::State;
use softlimb_limb::Limb;
use softlimb_limb::payload::{LoadCase, Outcome, capacity, limb_capacity, polar, polar_picture};
use softlimb_scene as scene;

const GRAVITY: f64 = 9.80665;

fn scene_a() -> scene::Scene {
    scene::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/weightless-a.toml")).unwrap()
}

fn rest(limb: &Limb) -> Vec<State<f64>> {
    limb.modules().iter().map(|module| module.curve.states()[0]).collect()
}

const CASE: LoadCase = LoadCase {
    direction: [0.0, 0.0, -1.0],
    gravity_m_per_s2: [0.0, 0.0, -GRAVITY],
    spacers: Some(2),
    buckling_share: f64::INFINITY,
};

/// Straight out, forward: moments of the weights about the near end of each module by hand.
#[test]
fn weights_of_a_straight_limb_turn_about_its_base_as_by_hand() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let holding = limb_capacity(&scene, &limb, &rest(&limb), &CASE).unwrap();
    let wall = scene.modules()[0].elastomer_mass_kg();
    // Near ends at 0, 255 and 510 mm; modules of 240 mm, connectors of 15 mm and 300 g, a gripper of 50 mm and 400 g.
    let places = |k: f64| {
        let near = 0.255 * k;
        wall * (near + 0.12) + 0.3 * (near + 0.2475)
    };
    let gripper = 0.4 * (3.0 * 0.255 + 0.025);
    let base = GRAVITY * (places(0.0) + places(1.0) + places(2.0) + gripper);
    assert!((holding.modules[0].weight_moment_nm - base).abs() < 1e-9 * base);
    let last = GRAVITY * (wall * 0.12 + 0.3 * 0.2475 + 0.4 * 0.28);
    assert!((holding.modules[2].weight_moment_nm - last).abs() < 1e-9);
    assert!((holding.modules[0].arm_m - 0.815).abs() < 1e-12);
    assert!((holding.weight_n - scene.mass_kg() * GRAVITY).abs() < 1e-12);
}

/// Upwards out of the base's plane a load hangs on the limb alone: without gravity the sum of pushes holds a push along the limb.
#[test]
fn weakest_module_decides_along_the_limb() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let case = LoadCase { direction: [-1.0, 0.0, 0.0], gravity_m_per_s2: [0.0; 3], ..CASE };
    let holding = limb_capacity(&scene, &limb, &rest(&limb), &case).unwrap();
    let found = capacity(&holding.question).unwrap();
    assert_eq!(found.outcome, Outcome::Solved);
    let module = &limb.modules()[0];
    let most = module.reference_max_pa.min(module.curve.pressure_max_pa());
    let push = -3.0 * module.actuator.blocked(most, 1.0, 0.0).unwrap().force_n;
    assert!((found.load_n - push).abs() < 1e-6 * push, "{} against {push}", found.load_n);
    // The load that one bay of the isotropic wall buckles at is of this size: 3 mu I with the length of a third, and mu A/2 in shear, which
    // an elastica that shears has in series: 1/N = 1/E + 1/(G + N).
    let (ri, ro) = (10e-3_f64, 14e-3_f64);
    let bending = 3.0 * 0.223e6 * std::f64::consts::PI / 4.0 * (ro.powi(4) - ri.powi(4));
    let euler = 4.0 * std::f64::consts::PI.powi(2) * bending / 0.08_f64.powi(2);
    let shear = 0.5 * 0.223e6 * std::f64::consts::PI * (ro * ro - ri * ri);
    let mut wall = 0.0;
    for _ in 0..200 {
        wall = 1.0 / (1.0 / euler + 1.0 / (shear + wall));
    }
    let said = holding.modules[0].critical_n[0];
    assert!(said > 0.9 * wall && said < 2.0 * wall, "{said} N against {wall} N of the bare wall");
}

/// More spacers never hold less, and a limit of the push never more.
#[test]
fn spacers_and_buckling_order_the_loads() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let load = |spacers: u32, buckling_share: f64| {
        let case = LoadCase {
            direction: [-1.0, 0.0, 0.0],
            spacers: Some(spacers),
            buckling_share,
            gravity_m_per_s2: [0.0; 3],
        };
        capacity(&limb_capacity(&scene, &limb, &rest(&limb), &case).unwrap().question).unwrap().load_n
    };
    let (none, two, free) = (load(0, 0.5), load(2, 0.5), load(0, f64::INFINITY));
    assert!(none < 0.7 * free, "without spacers the tubes buckle first: {none} of {free} N");
    assert!(two >= none && two <= free * (1.0 + 1e-9), "{none}, {two}, {free}");
}

/// What it holds of its own weights is in proportion to gravity. Straight out it holds none: its elbow bends down and cannot lift.
#[test]
fn own_weights_are_held_in_proportion() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let plan = softlimb_motion::plan(&scene, &limb).unwrap();
    let bent: Vec<_> =
        limb.modules().iter().zip(&plan.phases[1].values).map(|(m, v)| m.state_at(*v).unwrap()).collect();
    let share = |gravity: f64| {
        let case = LoadCase { gravity_m_per_s2: [0.0, 0.0, -gravity], ..CASE };
        capacity(&limb_capacity(&scene, &limb, &bent, &case).unwrap().own_weight()).unwrap()
    };
    let (one, half) = (share(GRAVITY), share(0.5 * GRAVITY));
    assert_eq!(one.outcome, Outcome::Solved);
    assert!(one.load_n > 0.05 && one.load_n < 1.0, "{} of its own weights", one.load_n);
    assert!((half.load_n - 2.0 * one.load_n).abs() < 1e-6, "{} and {}", one.load_n, half.load_n);
    let straight = limb_capacity(&scene, &limb, &rest(&limb), &CASE).unwrap();
    assert_eq!(capacity(&straight.question).unwrap().outcome, Outcome::Infeasible);
    let none = capacity(&straight.own_weight()).unwrap();
    assert!(none.outcome == Outcome::Solved && none.load_n.abs() < 1e-6, "{none:?}");
    // A lift by another could balance each module by itself, the elbow too.
    assert!(straight.unbalanced().unwrap().is_empty());
}

/// The shoulder of one family has its limit point at 118.8 kPa: where that comes first, pressures end there, and it is said.
#[test]
fn pressures_end_at_the_limit_point_where_that_comes_first() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/weightless-b.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let raised = text.replace("pressure_max = \"100 kPa\"", "pressure_max = \"130 kPa\"");
    assert_ne!(text, raised);
    let ends = |text: &str| -> Vec<bool> {
        let scene = scene::parse(text, "b.toml").unwrap();
        let limb = Limb::new(&scene).unwrap();
        let holding = limb_capacity(&scene, &limb, &rest(&limb), &CASE).unwrap();
        let most: Vec<f64> = holding.question.bundles.iter().map(|bundle| bundle.limits_pa[0][1]).collect();
        // As `softlimb eval --batch` says of the same tube.
        assert!(most[0] <= 118_783.0, "{most:?}");
        assert!(most[1] > 90e3 && most[2] > 90e3, "{most:?}");
        holding.modules.iter().map(|module| module.ends_at_limit_point).collect()
    };
    assert!(ends(&text).iter().all(|ends| !ends));
    assert_eq!(ends(&raised), [true, false, false], "the twisting shoulder");
}

#[test]
fn load_cases_that_make_no_sense_are_refused() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let states = rest(&limb);
    let refused = |case: LoadCase| limb_capacity(&scene, &limb, &states, &case).unwrap_err().to_string();
    assert!(refused(LoadCase { direction: [0.0; 3], ..CASE }).contains("direction = 0"));
    assert!(refused(LoadCase { buckling_share: 0.0, ..CASE }).contains("buckling_share = 0"));
    assert!(refused(LoadCase { gravity_m_per_s2: [f64::NAN, 0.0, 0.0], ..CASE }).contains("gravity_m_per_s2"));
    assert!(limb_capacity(&scene, &limb, &states[..1], &CASE).unwrap_err().to_string().contains("states = 1"));
}

/// Without gravity: along the limb the sum of pushes, and what lies on either side of the limb's plane is alike.
#[test]
fn loads_all_around_have_the_push_along_the_limb_and_its_symmetry() {
    let scene = scene_a();
    let limb = Limb::new(&scene).unwrap();
    let case = LoadCase { gravity_m_per_s2: [0.0; 3], ..CASE };
    let found = polar("straight", (&scene, &limb), &rest(&limb), &case).unwrap();
    let [across, side] = &found.loads_n;
    assert_eq!((across.len(), across.first(), side.first()), (73, across.last(), side.last()));
    let module = &limb.modules()[0];
    let most = module.reference_max_pa.min(module.curve.pressure_max_pa());
    let push = -3.0 * module.actuator.blocked(most, 1.0, 0.0).unwrap().force_n;
    assert!((across[36][0] + push).abs() < 1e-6 * push && across[36][1].abs() < 1e-6 * push, "{:?}", across[36]);
    for index in 0..=72 {
        let (one, other) = (side[index], side[(108 - index) % 72]);
        let size = one[0].hypot(one[1]).max(1e-3);
        assert!(
            (one[0] + other[0]).abs() < 1e-5 * size && (one[1] - other[1]).abs() < 1e-5 * size,
            "{one:?} {other:?}"
        );
    }
    let svg = polar_picture("limb", &[found]);
    assert!(svg.contains(">straight<") && svg.contains(" N<") && !svg.contains("NaN") && !svg.contains("inf"));
}
