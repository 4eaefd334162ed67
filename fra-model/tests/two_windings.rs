//! Tubes with two windings: the balance of stresses, equivalent tubes with one, saturation, limit pressures, refusals.

use crate::common::stresses::resultants_of;
use crate::common::*;
use fra_model::*;

const PAIRS: u32 = 200;

/// Quasi-random number in 0..1: the fractional part of a multiple of a power of the golden ratio. Each sample has its own sequence.
fn fraction(sample: u32, stream: i32) -> f64 {
    (f64::from(sample + 1) * 1.220_744_084_605_759_5_f64.powi(-stream)).fract()
}

fn between(low: f64, high: f64, fraction: f64) -> f64 {
    low + (high - low) * fraction
}

fn sheet(angle_deg: f64, families: Families, modulus_pa: f64) -> Fiber<f64> {
    Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa,
        placement: Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: 8.0 * MM,
    }
}

/// A pair of windings of a tube, a pressure and a load: signed angles, moduli over three decades, every placement.
fn pair(sample: u32) -> (ActuatorParameters<f64>, Fiber<f64>, f64, Load<f64>) {
    let material = if sample.is_multiple_of(2) { neo_hookean(0.2e6) } else { DRAGONSKIN_30 };
    let mut p = tube(Motion::Twisting, 6.0, 8.0, material);
    let placements = [Placement::Sheet, Placement::Layer, Placement::Smeared];
    let fiber = |stream: i32, shift: u32| {
        let families = if (sample / 3 + shift).is_multiple_of(2) { Families::One } else { Families::Two };
        let angle_deg = match (sample + shift) % 10 {
            0 => 90.0,
            5 => 0.0,
            _ => between(-90.0, 90.0, fraction(sample, stream)),
        };
        let modulus_pa = 1e5 * 1e3_f64.powf(fraction(sample, stream + 1));
        let placement = placements[((sample + shift) / 2 % 3) as usize];
        let radius_m = between(6.5, 8.0, fraction(sample, stream + 2)) * MM;
        let radius_m = if placement == Placement::Layer { radius_m.min(7.8 * MM) } else { radius_m };
        Fiber { placement, radius_m, ..sheet(angle_deg, families, modulus_pa) }
    };
    p.fiber = Some(fiber(1, 0));
    let second = fiber(4, 1);
    let pressure_pa = between(1.0, 24.0, fraction(sample, 7)) * KPA;
    let loaded = sample % 3;
    let load = Load {
        force_n: if loaded > 0 { between(-1.0, 2.0, fraction(sample, 8)) } else { 0.0 },
        torque_nm: if loaded > 1 { between(-5e-3, 5e-3, fraction(sample, 9)) } else { 0.0 },
    };
    (p, second, pressure_pa, load)
}

fn single_fiber(fiber: Fiber<f64>) -> Fiber<f32> {
    let Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m } = fiber;
    let [angle_rad, modulus_pa, thickness_m, radius_m] =
        [angle_rad, modulus_pa, thickness_m, radius_m].map(|value| value as f32);
    Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m }
}

fn wound<T: Precision>(p: &ActuatorParameters<T>, second: &Fiber<T>) -> Result<Actuator<T>, InvalidParameter<T>> {
    Actuator::new(p)?.with_second_fiber(second)
}

fn new(p: &ActuatorParameters<f64>, second: &Fiber<f64>) -> Actuator<f64> {
    wound(p, second).expect("valid")
}

/// Stretch, growth and turn of the outer surface.
fn motion(state: &State<f64>) -> [f64; 3] {
    [state.axial_strain, state.outer_radius_m / (8.0 * MM) - 1.0, state.twist_rad * 8.0 * MM / 0.1]
}

/// Largest difference relative to the motion.
fn deviation(found: &State<f64>, exact: &State<f64>) -> f64 {
    let (found, exact) = (motion(found), motion(exact));
    let difference = found.iter().zip(exact).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    difference / exact.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

#[test]
fn pairs_balance_the_stresses_in_the_wall_and_in_both_windings() {
    let (mut worst, mut solved) = (0.0_f64, 0);
    for sample in 0..PAIRS {
        let (p, second, pressure_pa, load) = pair(sample);
        let solution = new(&p, &second).forward(pressure_pa, &load).expect("finite");
        if solution.status == Status::NoSolution {
            continue;
        }
        assert_eq!(solution.status, Status::Solved, "{sample}: {p:?} {second:?} {solution:?}");
        solved += 1;
        let windings = [p.fiber.expect("stated"), second];
        let state = solution.state;
        let found = resultants_of(&p, &windings, [state.axial_stretch, state.inner_radius_m, state.twist_rad]);
        let stiffest = windings[0].modulus_pa.max(second.modulus_pa);
        let scale = p.material.shear_modulus_pa() + 1e-3 * stiffest;
        let area = std::f64::consts::PI * p.outer_radius_m.powi(2);
        let off = [
            (found.pressure_pa - pressure_pa) / scale,
            (found.force_n - load.force_n) / (scale * area),
            (found.torque_nm - load.torque_nm) / (scale * area * p.outer_radius_m),
        ];
        for off in off {
            assert!(off.abs() < 1e-9, "{sample}: {off:e} {p:?} {second:?} {load:?}");
            worst = worst.max(off.abs());
        }
    }
    println!("{solved} of {PAIRS} pairs have an equilibrium; largest residual {worst:.1e}");
    assert!(solved > 150, "{solved}");
}

#[test]
fn single_precision_agrees_with_double() {
    let (mut worst, mut solved) = (0.0_f64, 0);
    for sample in 0..PAIRS {
        let (p, second, pressure_pa, load) = pair(sample);
        let exact = new(&p, &second).forward(pressure_pa, &load).expect("finite");
        if exact.status != Status::Solved {
            continue;
        }
        let of_single = wound(&single(&p), &single_fiber(second)).expect("valid");
        let load = Load { force_n: load.force_n as f32, torque_nm: load.torque_nm as f32 };
        let found = of_single.forward(pressure_pa as f32, &load).expect("finite");
        assert_eq!(found.status, Status::Solved, "{sample}: {p:?} {second:?}");
        let [strain, growth, turn] = motion(&exact.state);
        let largest = strain.abs().max(growth.abs()).max(turn.abs());
        let off = f64::from(found.state.axial_strain) - strain;
        let turned = f64::from(found.state.twist_rad) * 8.0 * MM / 0.1 - turn;
        let off = off.abs().max(turned.abs()) / largest;
        worst = worst.max(off);
        solved += 1;
    }
    println!("largest deviation of {solved} pairs in single precision: {worst:.1e}");
    assert!(solved > 150 && worst < 1e-4, "{worst:e}");
}

/// A helix and its mirror image are two families; a winding in two parts is the whole of it.
#[test]
fn equivalent_pairs_are_one_winding() {
    let load = Load { force_n: 0.5, torque_nm: 1e-3 };
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        let bare = tube(Motion::Extension, 6.0, 8.0, material);
        for angle_deg in [0.0, 5.0, 30.0, 36.0, 70.0] {
            for modulus_pa in [1e6, 200e6] {
                let with = |fiber| ActuatorParameters { fiber: Some(fiber), ..bare };
                let one = sheet(angle_deg, Families::One, modulus_pa);
                let mirrored = Fiber { angle_rad: -one.angle_rad, ..one };
                let both = solve_loaded(&with(Fiber { families: Families::Two, ..one }), 15e3, load);
                let pair = new(&with(one), &mirrored).forward(15e3, &load).expect("finite");
                assert_eq!([both.status, pair.status], [Status::Solved; 2], "{angle_deg}");
                assert!(deviation(&pair.state, &both.state) < 1e-9, "{angle_deg} {pair:?} {both:?}");
                let part = |share: f64| Fiber { modulus_pa: share * modulus_pa, ..one };
                let whole = solve_loaded(&with(one), 15e3, load);
                let parts = new(&with(part(0.3)), &part(0.7)).forward(15e3, &load).expect("finite");
                assert_eq!([whole.status, parts.status], [Status::Solved; 2], "{angle_deg}");
                assert!(deviation(&parts.state, &whole.state) < 1e-9, "{angle_deg} {parts:?} {whole:?}");
            }
        }
    }
}

#[test]
fn limit_pressure_is_that_of_the_equivalent_winding() {
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        for (modulus_pa, placement) in [(1e6, Placement::Sheet), (0.2e6, Placement::Smeared)] {
            let axial = Fiber { placement, ..sheet(90.0, Families::One, modulus_pa) };
            let with = |fiber| ActuatorParameters { fiber: Some(fiber), ..tube(Motion::Expansion, 6.0, 8.0, material) };
            let whole = solve(&with(axial), 200e3).limit_pressure_pa.expect("has a limit");
            let part = |share: f64| Fiber { modulus_pa: share * modulus_pa, ..axial };
            let two = new(&with(part(0.25)), &part(0.75));
            let limit = two.forward(200e3, &Load::none()).expect("finite").limit_pressure_pa.expect("has a limit");
            assert!((limit / whole - 1.0).abs() < 1e-9, "{limit} {whole}");
            let below = two.forward(limit * (1.0 - 1e-6), &Load::none()).expect("finite");
            let above = two.forward(limit * (1.0 + 1e-6), &Load::none()).expect("finite");
            assert_eq!([below.status, above.status], [Status::Solved, Status::NoSolution]);
        }
    }
}

/// A helix alone twists on; with an axial thread that keeps the length the twist saturates.
#[test]
fn helix_and_axial_thread_saturate() {
    let helix = sheet(30.0, Families::One, 200e6);
    let p = ActuatorParameters { fiber: Some(helix), ..tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6)) };
    let two = new(&p, &Fiber { angle_rad: std::f64::consts::FRAC_PI_2, ..helix });
    let at = |kpa: f64| two.forward(kpa * KPA, &Load::none()).expect("finite");
    let twist = |kpa: f64| {
        let solution = at(kpa);
        assert_eq!(solution.status, Status::Solved, "{kpa}");
        solution.state.twist_rad.abs()
    };
    let twists = [10.0, 50.0, 100.0, 200.0, 400.0, 800.0].map(twist);
    let alone = solve(&p, 400e3);
    println!("twists {twists:.3?} rad; helix alone: {alone:?}");
    assert!(alone.status == Status::NoSolution && alone.limit_pressure_pa < Some(100.0 * KPA), "{alone:?}");
    assert!(alone.state.twist_rad.abs() > 2.0 * twists[5], "{alone:?}");
    assert!(twists.is_sorted(), "{twists:?}");
    assert!(twists[5] - twists[4] < 0.1 * twists[1], "{twists:?}");
}

#[test]
fn inverse_returns_the_pressure_of_the_forward_problem() {
    let mut count = 0;
    for sample in 0..PAIRS {
        let (p, second, pressure_pa, load) = pair(sample);
        let two = new(&p, &second);
        let forward = two.forward(pressure_pa, &load).expect("finite");
        if forward.status != Status::Solved || forward.state.axial_strain < 1e-3 || load != Load::none() {
            continue;
        }
        let target = Target::AxialStretch(forward.state.axial_stretch);
        let found = two.inverse_within(&PressureRange::physical(), target, &load).expect("in range");
        assert_eq!(found.status, Status::Solved, "{sample}");
        // Another, lower pressure may reach the same stretch.
        assert!(found.state.pressure_pa <= pressure_pa * (1.0 + 1e-6), "{sample}: {found:?} {pressure_pa}");
        let again = two.forward(found.state.pressure_pa, &load).expect("finite").state;
        assert!((again.axial_stretch - forward.state.axial_stretch).abs() < 1e-9, "{sample}");
        count += 1;
    }
    assert!(count > 15, "{count}");
}

#[test]
fn errors_name_the_second_winding() {
    let axial = sheet(90.0, Families::One, 1e6);
    let p = ActuatorParameters { fiber: Some(axial), ..tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6)) };
    let wrong = [
        (Fiber { angle_rad: 2.0, ..axial }, "second_fiber.angle_rad", 2.0),
        (Fiber { modulus_pa: -1.0, ..axial }, "second_fiber.modulus_pa", -1.0),
        (Fiber { thickness_m: 0.0, ..axial }, "second_fiber.thickness_m", 0.0),
        (Fiber { radius_m: 9e-3, ..axial }, "second_fiber.radius_m", 9e-3),
    ];
    for (fiber, field, value) in wrong {
        let error = wound(&p, &fiber).expect_err("not accepted");
        assert_eq!((error.field, error.value), (field, value));
    }
    let first = ActuatorParameters { fiber: Some(Fiber { angle_rad: 2.0, ..axial }), ..p };
    assert_eq!(wound(&first, &axial).expect_err("not accepted").field, "angle_rad");
    let bending = ActuatorParameters { motion: Motion::Bending, ..p };
    assert!(wound(&bending, &axial).expect_err("bends").allowed.starts_with("straight actuators only"));
}

#[test]
fn derivatives_take_one_winding() {
    let axial = sheet(90.0, Families::One, 1e6);
    let p = ActuatorParameters { fiber: Some(axial), ..tube(Motion::Extension, 6.0, 8.0, neo_hookean(0.2e6)) };
    let two = new(&p, &Fiber { angle_rad: 0.1, ..axial });
    let state = two.forward(5e3, &Load::none()).expect("finite").state;
    let refused = two.sensitivity(&state, &Load::none(), Parameter::OuterRadius).expect_err("two windings");
    assert!(refused.to_string().starts_with("second_fiber.angle_rad = 0.1 is not allowed: one winding"), "{refused}");
    let blocked = two.blocked(5e3, 1.0, 0.0).expect("straight");
    assert!(two.blocked_sensitivity(&blocked, Parameter::OuterRadius).is_err());
    assert!(two.condition(&state, &Load::none()).is_err());
    assert!(Series::new(&[two, two]).is_err());
}
