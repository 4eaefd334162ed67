//! Two windings of different angle, stiffness and place. Of straight tubes the thick-wall equations are exact; bending ones twist, too.

use std::f64::consts::{FRAC_PI_2, PI};

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Motion, Placement, Status};
use softlimb_fea::cross_section::{Answer, EndLoad, Limiter, Options, Outcome, Section, SectionState, Winding};

use crate::section::cases::{SOFT, tube};
use crate::section::straight::deviation;
use crate::section::sweep::{Numbers, scale};

const PAIRS: u32 = 200;

/// A tube with two windings and a load of up to a tenth of what its shear modulus means.
fn pair(numbers: &mut Numbers) -> (ActuatorParameters<f64>, Fiber<f64>, Load<f64>) {
    let motion = numbers.one_of(&[Motion::Extension, Motion::Expansion, Motion::Twisting]);
    let mut tube = numbers.tube(motion);
    tube.fiber = Some(numbers.fiber(&tube));
    let mut second = numbers.fiber(&tube);
    // A third of them have an axial thread, a tenth a hoop.
    second.angle_rad = match numbers.between(0.0, 1.0) {
        share if share < 0.33 => FRAC_PI_2,
        share if share < 0.43 => 0.0,
        _ => second.angle_rad,
    };
    let force_n = PI * tube.inner_radius_m.powi(2) * scale(&tube);
    let loaded = numbers.one_of(&[0.0, 1.0]);
    let load = Load {
        force_n: loaded * force_n * numbers.between(-0.05, 0.1),
        torque_nm: loaded * force_n * tube.inner_radius_m * numbers.between(-0.1, 0.1),
    };
    (tube, second, load)
}

#[test]
fn random_pairs_have_the_answers_of_the_thick_wall_equations() {
    let mut numbers = Numbers::new(79);
    let (mut solved, mut ends, mut worst, mut farthest) = (0, 0, 0.0, 0.0);
    for sample in 0..PAIRS {
        let (parameters, second, load) = pair(&mut numbers);
        let pressures: Vec<f64> = (0..3).map(|_| numbers.over(0.03, 3.0) * scale(&parameters)).collect();
        let two = Actuator::new(&parameters).and_then(|tube| tube.with_second_fiber(&second)).expect("valid");
        let section = Section::with_two_windings(&parameters, &second, &Options::default()).expect("valid");
        let curve = section.curve(&pressures, &EndLoad::of(&load, parameters.motion)).expect("valid");
        for answer in curve.answers {
            let exact = two.forward(answer.pressure_pa, &load).expect("valid");
            let case = format!("{sample}: {parameters:?} {second:?} {load:?} {answer:?} {exact:?}");
            match (answer.outcome, exact.status) {
                (Outcome::Equilibrium(found), Status::Solved) => {
                    let state = found.state.over(parameters.length_m);
                    let off = deviation(&state, &exact.state, parameters.outer_radius_m);
                    assert!(off < 1e-5, "{off:e} {case}");
                    (worst, solved) = (f64::max(worst, off), solved + 1);
                }
                (Outcome::NoEquilibrium { limit_pressure_pa }, Status::NoSolution) => {
                    let limit = exact.limit_pressure_pa.expect("the branch ends");
                    let off = (limit_pressure_pa / limit - 1.0).abs();
                    farthest = f64::max(farthest, off);
                    assert!(off < 1e-6, "{off:e} {case}");
                    ends += 1;
                }
                (Outcome::LoadNotCarried, Status::NoSolution) => ends += 1,
                _ => panic!("{case}"),
            }
        }
    }
    println!(
        "{PAIRS} pairs: {solved} equilibria, {worst:.1e} of the motion at most; {ends} beyond the end of the branch, limit pressures within {farthest:.1e}"
    );
    assert!(solved > 2 * PAIRS && ends > 0, "{solved}");
}

fn sheet(angle_deg: f64, families: Families, modulus_pa: f64) -> Fiber<f64> {
    let (placement, angle_rad) = (Placement::Sheet, angle_deg.to_radians());
    Fiber { angle_rad, families, modulus_pa, placement, thickness_m: 1e-4, radius_m: 8e-3 }
}

/// Without the axial thread the branch of this helix ends at 88 kPa; with it the twist saturates.
#[test]
fn helix_and_axial_thread_saturate() {
    let helix = sheet(30.0, Families::One, 200e6);
    let parameters = ActuatorParameters { fiber: Some(helix), ..tube(Motion::Twisting, 6.0, 8.0, SOFT) };
    let pressures = [50e3, 100e3, 200e3, 400e3, 800e3];
    let alone = Section::new(&parameters, &Options::default()).expect("valid");
    let curve = alone.curve(&pressures, &EndLoad::default()).expect("valid");
    assert!(
        matches!(curve.answers[1].outcome, Outcome::NoEquilibrium { limit_pressure_pa } if limit_pressure_pa < 89e3)
    );
    let axial = sheet(90.0, Families::One, 200e6);
    let both = Section::with_two_windings(&parameters, &axial, &Options::default()).expect("valid");
    let curve = both.curve(&pressures, &EndLoad::default()).expect("valid");
    let twist =
        |answer: &Answer| answer.equilibrium().expect("saturates").state.over(parameters.length_m).twist_rad.abs();
    let twists: Vec<f64> = curve.answers.iter().map(twist).collect();
    println!("twists {twists:.4?} rad");
    assert!(twists.is_sorted() && twists[4] - twists[3] < 0.03 * twists[4], "{twists:?}");
}

/// A bending actuator of one helix, and the section with a second one.
fn bender(first: Fiber<f64>, second: &Fiber<f64>, limiter: Limiter) -> Section {
    let parameters = ActuatorParameters { fiber: Some(first), ..tube(Motion::Bending, 6.0, 8.0, SOFT) };
    let options = Options { limiter: Some(limiter), ..Options::default() };
    Section::with_two_windings(&parameters, second, &options).expect("valid")
}

fn state(section: &Section, pressure_pa: f64) -> SectionState {
    let curve = section.curve(&[pressure_pa], &EndLoad::default()).expect("valid");
    curve.answers[0].equilibrium().unwrap_or_else(|| panic!("{curve:?}")).state
}

const STRIP: Limiter = Limiter::Strip { half_angle_rad: 0.26, stiffness_n_per_m: 1e5 };

#[test]
fn mirrored_helices_are_two_families_and_do_not_twist() {
    for limiter in [Limiter::Line, STRIP] {
        let one = sheet(7.0, Families::One, 200e6);
        let pair = state(&bender(one, &sheet(-7.0, Families::One, 200e6), limiter), 30e3);
        let options = Options { limiter: Some(limiter), ..Options::default() };
        let both = Fiber { families: Families::Two, ..one };
        let parameters = ActuatorParameters { fiber: Some(both), ..tube(Motion::Bending, 6.0, 8.0, SOFT) };
        let both = state(&Section::new(&parameters, &options).expect("valid"), 30e3);
        assert!((pair.bend_rates_rad_per_m[0] / both.bend_rates_rad_per_m[0] - 1.0).abs() < 1e-9, "{pair:?} {both:?}");
        assert_eq!(pair.twist_rate_rad_per_m, 0.0);
    }
}

/// The mirror image of a bending actuator bends alike and twists the other way; half a turn about the strip maps it on itself, so that
/// nothing bends to the side.
#[test]
fn different_helices_bend_and_twist() {
    for (limiter, angles, moduli) in [
        (STRIP, [5.0, -10.0], [200e6, 200e6]),
        (STRIP, [5.0, 30.0], [200e6, 50e6]),
        (Limiter::Line, [-8.0, 8.0], [50e6, 200e6]),
    ] {
        let of = |sign: f64| {
            let [first, second] = [0, 1].map(|i| sheet(sign * angles[i], Families::One, moduli[i]));
            state(&bender(first, &second, limiter), 30e3)
        };
        let [this, mirror] = [of(1.0), of(-1.0)];
        println!(
            "{angles:?} deg, {moduli:?} Pa: {:?} rad/m, twist {}",
            this.bend_rates_rad_per_m, this.twist_rate_rad_per_m
        );
        let [bend, mirrored] = [this, mirror].map(|state| state.bend_rates_rad_per_m);
        assert!((bend[0] / mirrored[0] - 1.0).abs() < 1e-9, "{this:?} {mirror:?}");
        assert!((this.twist_rate_rad_per_m / mirror.twist_rate_rad_per_m + 1.0).abs() < 1e-8, "{this:?} {mirror:?}");
        assert!(this.twist_rate_rad_per_m.abs() > 0.05 * bend[0], "{this:?}");
        assert!(bend[1].abs().max(mirrored[1].abs()) < 1e-6 * bend[0], "{this:?}");
    }
}

/// The whole section with a strip that holds nothing.
#[test]
fn bender_with_a_soft_strip_is_the_straight_tube() {
    let [first, second] = [sheet(20.0, Families::One, 50e6), sheet(-35.0, Families::One, 100e6)];
    let soft = Limiter::Strip { half_angle_rad: 0.26, stiffness_n_per_m: 1e-6 };
    let found = state(&bender(first, &second, soft), 20e3);
    let parameters = ActuatorParameters { fiber: Some(first), ..tube(Motion::Twisting, 6.0, 8.0, SOFT) };
    let exact = Actuator::new(&parameters)
        .and_then(|tube| tube.with_second_fiber(&second))
        .expect("valid")
        .forward(20e3, &Load::none())
        .expect("finite")
        .state;
    let twist_rad = found.over(parameters.length_m).twist_rad;
    assert!((twist_rad / exact.twist_rad - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    assert!((found.axial_strain / exact.axial_strain - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    assert!(found.bend_rates_rad_per_m[0].abs() < 1e-4, "{found:?}");
}

/// `dU/dP = P dV/dP` along the branch of a bender that twists: energy, volume and equilibrium agree.
#[test]
fn work_of_the_pressure_is_the_energy_of_a_bender_that_twists() {
    let section = bender(sheet(5.0, Families::One, 200e6), &sheet(30.0, Families::One, 50e6), STRIP);
    let [less, at, more] = [-20.0, 0.0, 20.0].map(|change| state(&section, 20e3 + change));
    let energy = (more.energy_j_per_m - less.energy_j_per_m) / 40.0;
    let work = at.pressure_pa * at.compliance_m2_per_pa;
    assert!((energy / work - 1.0).abs() < 2e-3, "{energy} {work}");
}

#[test]
fn second_winding_out_of_range_is_named() {
    let first = sheet(5.0, Families::One, 200e6);
    let parameters = ActuatorParameters { fiber: Some(first), ..tube(Motion::Bending, 6.0, 8.0, SOFT) };
    let refused = |parameters: &ActuatorParameters<f64>, second: Fiber<f64>, options: &Options| {
        Section::with_two_windings(parameters, &second, options).expect_err("out of range").to_string()
    };
    let plain = Options::default();
    assert_eq!(
        refused(&parameters, Fiber { thickness_m: 0.0, ..first }, &plain),
        "second winding: thickness_m = 0 is not allowed: finite and > 0"
    );
    assert_eq!(
        refused(&parameters, Fiber { radius_m: 9e-3, ..first }, &plain),
        "second winding: radius_m = 0.009 is not allowed: inner_radius_m to outer_radius_m"
    );
    let ideal = Options { winding: Winding::Ideal, ..plain };
    assert!(refused(&parameters, first, &ideal).starts_with("second winding: angle_rad = "));
    let soft = ActuatorParameters { fiber: Some(Fiber { modulus_pa: 0.0, ..first }), ..parameters };
    assert!(refused(&soft, first, &plain).starts_with("modulus_pa = 0 is not allowed: > 0 on a bending actuator"));
}
