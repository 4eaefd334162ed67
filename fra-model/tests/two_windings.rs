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

/// The inputs of both windings and of the wall.
const INPUTS: [Parameter; 10] = [
    Parameter::OuterRadius,
    Parameter::InnerRadius,
    Parameter::FiberAngle,
    Parameter::FiberModulus,
    Parameter::SheetThickness,
    Parameter::WindingRadius,
    Parameter::SecondFiberAngle,
    Parameter::SecondFiberModulus,
    Parameter::SecondSheetThickness,
    Parameter::SecondWindingRadius,
];

fn place<'a>(p: &'a mut ActuatorParameters<f64>, second: &'a mut Fiber<f64>, parameter: Parameter) -> &'a mut f64 {
    let first = p.fiber.as_mut().expect("wound");
    match parameter {
        Parameter::OuterRadius => &mut p.outer_radius_m,
        Parameter::InnerRadius => &mut p.inner_radius_m,
        Parameter::FiberAngle => &mut first.angle_rad,
        Parameter::FiberModulus => &mut first.modulus_pa,
        Parameter::SheetThickness => &mut first.thickness_m,
        Parameter::WindingRadius => &mut first.radius_m,
        Parameter::SecondFiberAngle => &mut second.angle_rad,
        Parameter::SecondFiberModulus => &mut second.modulus_pa,
        Parameter::SecondSheetThickness => &mut second.thickness_m,
        Parameter::SecondWindingRadius => &mut second.radius_m,
        other => panic!("{other:?} is not of a winding or the wall"),
    }
}

/// The value of an input.
fn stated(mut p: ActuatorParameters<f64>, mut second: Fiber<f64>, parameter: Parameter) -> f64 {
    *place(&mut p, &mut second, parameter)
}

/// Largest difference of two derivatives of the motion by an input of a size, and the larger of their sizes.
fn change(found: &State<f64>, other: [f64; 3], size: f64) -> (f64, f64) {
    let found = [found.axial_strain, found.outer_radius_m / (8.0 * MM), found.twist_rad * 8.0 * MM / 0.1];
    let largest = |values: [f64; 3]| size * values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    (largest(std::array::from_fn(|i| found[i] - other[i])), largest(found).max(largest(other)))
}

/// Derivatives by every input are the differences of equilibria at four values of it.
#[test]
fn derivatives_are_differences_of_equilibria() {
    let (mut worst, mut count) = (0.0_f64, 0);
    for sample in 0..PAIRS {
        let (p, second, pressure_pa, load) = pair(sample);
        let two = new(&p, &second);
        let solution = two.forward(pressure_pa, &load).expect("finite");
        // Towards a limit point the motion runs away between the steps.
        let is_far = |share: f64| two.forward(share * pressure_pa, &load).expect("finite").status == Status::Solved;
        if !(solution.status == Status::Solved && is_far(1.2)) {
            continue;
        }
        for parameter in INPUTS {
            if two.inputs().all(|input| input != parameter) {
                assert!(two.sensitivity(&solution.state, &load, parameter).is_err(), "{sample} {parameter:?}");
                continue;
            }
            let exact = two.sensitivity(&solution.state, &load, parameter).expect("an input");
            let value = stated(p, second, parameter);
            let size = if value == 0.0 { 1.0 } else { value.abs() };
            let at = |steps: f64| {
                let (mut p, mut second) = (p, second);
                *place(&mut p, &mut second, parameter) = value + 1e-4 * steps * size;
                let solution = wound(&p, &second).ok()?.forward_from(&solution.state, pressure_pa, &load).ok()?;
                (solution.status == Status::Solved).then(|| motion(&solution.state))
            };
            // A winding on the surface has no place further out, and a right angle is the largest.
            let Some(around) = [-2.0, -1.0, 1.0, 2.0].map(at).into_iter().collect::<Option<Vec<_>>>() else { continue };
            let slope = |i: usize| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| around[k][i]);
                (8.0 * (c - b) - (d - a)) / (12.0 * 1e-4 * size)
            };
            let (off, most) = change(&exact, [0, 1, 2].map(slope), size);
            // Differences of motions that are rounded have an error of their own.
            let off = off / (most + 1e-3);
            assert!(off < 1e-6, "{sample} {parameter:?}: {off:e} {p:?} {second:?} {load:?}");
            worst = worst.max(off);
            count += 1;
        }
    }
    println!("{count} derivatives, largest difference {worst:.1e}");
    assert!(count > 800, "{count}");
}

/// Derivatives by the parts of a winding sum up to that by the whole; a helix and its mirror image turn against each other.
#[test]
fn derivatives_by_parts_sum_up() {
    use Parameter::*;
    let pressure_pa = 15e3;
    let load = Load { force_n: 0.5, torque_nm: 1e-3 };
    for (angle_deg, modulus_pa) in [(5.0, 1e6), (30.0, 1e6), (30.0, 200e6), (70.0, 200e6)] {
        let bare = tube(Motion::Twisting, 6.0, 8.0, DRAGONSKIN_30);
        let one = sheet(angle_deg, Families::One, modulus_pa);
        let with = |fiber| ActuatorParameters { fiber: Some(fiber), ..bare };
        let by = |actuator: &Actuator<f64>, parameter| {
            let state = actuator.forward(pressure_pa, &load).expect("finite").state;
            let found = actuator.sensitivity(&state, &load, parameter).expect("an input");
            [found.axial_strain, found.outer_radius_m / (8.0 * MM), found.twist_rad * 8.0 * MM / 0.1]
        };
        let part = |share: f64| Fiber { modulus_pa: share * modulus_pa, ..one };
        let (whole, parts) = (Actuator::new(&with(one)).expect("valid"), new(&with(part(0.3)), &part(0.7)));
        let both = Actuator::new(&with(Fiber { families: Families::Two, ..one })).expect("valid");
        let mirrored = new(&with(one), &Fiber { angle_rad: -one.angle_rad, ..one });
        for (of_one, first, second) in [
            (FiberAngle, FiberAngle, SecondFiberAngle),
            (SheetThickness, SheetThickness, SecondSheetThickness),
            (WindingRadius, WindingRadius, SecondWindingRadius),
        ] {
            let turned = if of_one == FiberAngle { -1.0 } else { 1.0 };
            for (whole, parts, sign) in [(&whole, &parts, 1.0), (&both, &mirrored, turned)] {
                let (whole, first, second) = (by(whole, of_one), by(parts, first), by(parts, second));
                let size = whole.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for ((whole, first), second) in whole.iter().zip(first).zip(second) {
                    let off = (first + sign * second - whole).abs() / size;
                    assert!(off < 1e-8, "{angle_deg} {modulus_pa} {of_one:?}: {first} {second} {whole}");
                }
            }
        }
        // The share of the stiffness is that of the modulus.
        let (whole, first, second) =
            (by(&whole, FiberModulus), by(&parts, FiberModulus), by(&parts, SecondFiberModulus));
        for ((whole, first), second) in whole.iter().zip(first).zip(second) {
            let size = whole.abs().max(1e-15);
            assert!(
                (first - whole).abs() < 1e-6 * size && (second - whole).abs() < 1e-6 * size,
                "{first} {second} {whole}"
            );
        }
    }
}

/// The blocked loads of two windings follow each input, and their condition number bounds how a change of all inputs shows.
#[test]
fn blocked_loads_and_condition_know_both_windings() {
    let p = ActuatorParameters {
        fiber: Some(sheet(30.0, Families::One, 20e6)),
        ..tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6))
    };
    let second = sheet(80.0, Families::One, 2e6);
    let two = new(&p, &second);
    let blocked = |two: &Actuator<f64>| two.blocked(20e3, 1.02, -0.1).expect("straight");
    for parameter in INPUTS {
        let exact = two.blocked_sensitivity(&blocked(&two), parameter).expect("an input");
        let value = stated(p, second, parameter);
        let at = |step: f64| {
            let (mut p, mut second) = (p, second);
            *place(&mut p, &mut second, parameter) = value * (1.0 + step);
            wound(&p, &second).ok().map(|two| blocked(&two)).map(|found| [found.force_n, found.torque_nm])
        };
        let (Some(low), Some(high)) = (at(-1e-5), at(1e-5)) else { continue };
        for ((low, high), exact) in low.iter().zip(high).zip([exact.force_n, exact.torque_nm]) {
            let slope = (high - low) / 2e-5;
            assert!(
                (slope - value * exact).abs() < 1e-6 * slope.abs() + 1e-9,
                "{parameter:?} {slope} {}",
                value * exact
            );
        }
    }
    let state = two.forward(20e3, &Load::none()).expect("finite").state;
    let condition = two.condition(&state, &Load::none()).expect("an equilibrium");
    assert!(condition > 1.0 && condition < 1e3, "{condition}");
}

/// Two equal segments with two windings are one of twice the length.
#[test]
fn segments_with_two_windings_add_up() {
    let helix = sheet(30.0, Families::One, 200e6);
    let p = ActuatorParameters { fiber: Some(helix), ..tube(Motion::Twisting, 6.0, 8.0, neo_hookean(0.2e6)) };
    let axial = Fiber { angle_rad: std::f64::consts::FRAC_PI_2, ..helix };
    let (half, whole) = (new(&p, &axial), new(&ActuatorParameters { length_m: 2.0 * p.length_m, ..p }, &axial));
    let twist_rad = whole.forward(50e3, &Load::none()).expect("finite").state.twist_rad;
    let segments = [half, half];
    let series = Series::new(&segments).expect("one tube");
    let found = series.inverse(SeriesTarget::Twist(twist_rad), &Load::none()).expect("in range");
    assert_eq!(found.status, Status::Solved);
    assert!((found.state.pressure_pa / 50e3 - 1.0).abs() < 1e-9, "{found:?}");
}
