//! The paper's equations as printed, and what is wrong with them.

use super::*;

/// (10): `2 P int [R_i (1 - cos phi) + b] R_i^2 sin^2 phi dphi`.
pub(super) fn eq_10_printed(pressure: Pressure, inner: Length, wall: Length) -> Energy {
    2.0 * PI * pressure * eq_13_denominator(inner, wall)
}

pub(super) fn eq_13_denominator(inner: Length, wall: Length) -> Volume {
    mean(PANELS, |turn| {
        let around = rad(PI * turn);
        (inner * (ONE - around.cos()) + wall) * inner * inner * around.sin() * around.sin()
    })
}

/// (11) with (12), its factor `L` aside: `2 int int s_zz/lambda (R_i + t)(R_i + b - (R_i + t) cos phi) dphi dt`.
pub(super) fn eq_11_printed_without_length(
    mu: Pressure,
    inner: Length,
    wall: Length,
    curvature: ReciprocalLength,
) -> Energy {
    mean(PANELS, |share| {
        let radius = inner + wall * share;
        let stretch: Ratio = ONE + curvature * wall * (1.0 - share);
        let stress: Pressure = mu * (stretch * stretch - ONE / (stretch * stretch));
        let arm: Length = mean(PANELS, |turn| inner + wall - radius * rad(PI * turn).cos());
        TAU * stress / stretch * radius * arm * wall
    })
}

/// (10) is a moment, (11) a moment times the length, (13) a pressure times the length. At a given curvature every piece of an
/// actuator needs the same pressure; printed, a piece twice as long needs twice as much. Without the factor the dimension is right
/// and the bend is not: (12) makes it more than six times too large.
#[test]
fn eq_11_and_13_printed_have_a_length_too_many() {
    let (inner, wall, mu) = (m(6e-3), m(2e-3), pa(0.2e6));
    let curvature = rad(0.7) / m(0.1);
    let pressures = [m(0.1), m(0.2)].map(|length| {
        let mut p = tube(Motion::Bending, 6.0, 8.0, neo_hookean(mu.get::<pascal>()));
        p.length_m = length.get::<meter>();
        let target = Target::BendAngle(Angle::from(curvature * length).get::<radian>());
        let pressure = pa(Actuator::new(&p).unwrap().inverse(target, &Load::none()).unwrap().state.pressure_pa);
        let moment: Mechanical<P3> = eq_11_printed_without_length(mu, inner, wall, curvature) * length;
        let printed: ForcePerLength = moment / (2.0 * PI * eq_13_denominator(inner, wall));
        (pressure, printed)
    });
    let [(once, printed_once), (twice, printed_twice)] = pressures;
    close(twice, once, once * 1e-12);
    close(printed_twice, 2.0 * printed_once, printed_once * 1e-12);

    let cap: Energy = eq_10_printed(once, inner, wall);
    close(cap, PI * once * inner * inner * (inner + wall), cap * 1e-12);
    assert!(eq_11_printed_without_length(mu, inner, wall, 6.0 * curvature) < cap);
}

/// (14) with weights that are numbers: lengths and angles off their goals, as numbers in some unit.
pub(super) fn eq_14_printed(length_off: f64, bend_off: f64) -> f64 {
    length_off * length_off + bend_off * bend_off
}

/// Of two designs, one with an error in length and one in bend, the first is better in meters and the second in millimeters. Weights
/// that carry units settle it: 1 mm is as bad as 0.01 rad.
#[test]
fn eq_14_printed_prefers_another_design_in_another_unit() {
    let designs = [(m(4e-3), rad(0.0)), (m(0.0), rad(0.1))];
    let [long, bent] = designs.map(|(off, bend)| eq_14_printed(off.get::<meter>(), bend.get::<radian>()));
    assert!(long < bent);
    let [long, bent] = designs.map(|(off, bend)| eq_14_printed(off.get::<millimeter>(), bend.get::<radian>()));
    assert!(long > bent);

    let [long, bent] = designs.map(|(off, bend)| {
        let (length_square, bend_square): (Area, Ratio) = (off * off, bend * bend);
        length_square / (m(1e-3) * m(1e-3)) + bend_square / (rad(0.01) * rad(0.01))
    });
    close(long, 16.0 * ONE, 1e-12 * ONE);
    close(bent, 100.0 * ONE, 1e-12 * ONE);
}

/// (18): a wrench off its goal, squared: the force in N, the moment in N times some unit of length.
pub(super) fn eq_18_printed(force_off: f64, moment_off: f64) -> f64 {
    force_off * force_off + moment_off * moment_off
}

/// As for (14). A length that compares moments with forces settles it: here 1 N m at an arm of 0.1 m is as bad as 10 N.
#[test]
fn eq_18_printed_prefers_another_design_in_another_unit() {
    let designs = [(0.5, 0.0), (0.0, 0.1)].map(|(f, t)| (Force::new::<newton>(f), Torque::new::<newton_meter>(t)));
    let [pulled, turned] = designs.map(|(f, t)| eq_18_printed(f.get::<newton>(), t.get::<newton_meter>()));
    assert!(pulled > turned);
    let [pulled, turned] = designs.map(|(f, t)| eq_18_printed(f.get::<newton>(), t.get::<newton_millimeter>()));
    assert!(pulled < turned);

    let [pulled, turned] = designs.map(|(f, t)| {
        let (force_square, moment_square): (Squared<P2>, Squared<P4>) = (f * f, t * t);
        force_square + moment_square / (m(0.1) * m(0.1))
    });
    let unit = Force::new::<newton>(1.0) * Force::new::<newton>(1.0);
    close(pulled, 0.25 * unit, 1e-12 * unit);
    close(turned, 1.0 * unit, 1e-12 * unit);
}
