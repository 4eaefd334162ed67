//! Section 2: materials and winding.

use super::*;

/// Energy per volume of a neo-Hookean wall.
pub(super) fn eq_2_neo_hookean(mu1: Pressure, i1: Ratio) -> Pressure {
    mu1 / 2.0 * (i1 - 3.0 * ONE)
}

pub(super) fn yeoh(c: [Pressure; 3], i1: Ratio) -> Pressure {
    let j = i1 - 3.0 * ONE;
    c[0] * j + c[1] * j * j + c[2] * j * j * j
}

pub(super) fn yeoh_slope(c: [Pressure; 3], i1: Ratio) -> Pressure {
    let j = i1 - 3.0 * ONE;
    c[0] + 2.0 * c[1] * j + 3.0 * c[2] * j * j
}

/// Energy per volume of one fiber family.
pub(super) fn eq_3_fiber(mu2: Pressure, i4: Ratio) -> Pressure {
    mu2 / 2.0 * (i4 - ONE) * (i4 - ONE)
}

/// Energy per area of one family in a sheet.
pub(super) fn sheet_energy(thickness: Length, mu2: Pressure, i4: Ratio) -> ForcePerLength {
    thickness * eq_3_fiber(mu2, i4)
}

/// `4 mu2 thickness = E A/p`: tension per width and strain of threads `p` apart.
pub(super) fn thread_to_sheet(thread_modulus: Pressure, thread_area: Area, spacing: Length) -> ForcePerLength {
    thread_modulus * thread_area / spacing
}

/// (4): energy per volume of the elastomer, by its law.
pub(super) fn elastomer_energy(material: &Material<f64>, i1: Ratio) -> Pressure {
    match *material {
        Material::NeoHookean { shear_modulus_pa } => eq_2_neo_hookean(pa(shear_modulus_pa), i1),
        Material::Yeoh { c_pa } => yeoh(c_pa.map(pa), i1),
    }
}

/// `2 W'`, the modulus in the stresses.
pub(super) fn elastomer_modulus(material: &Material<f64>, i1: Ratio) -> Pressure {
    match *material {
        Material::NeoHookean { shear_modulus_pa } => pa(shear_modulus_pa),
        Material::Yeoh { c_pa } => 2.0 * yeoh_slope(c_pa.map(pa), i1),
    }
}

/// `I1 = tr F F^T`.
pub(super) fn i1(f: &Tensor) -> Ratio {
    f.iter().flatten().fold(0.0 * ONE, |sum, &entry| sum + entry * entry)
}

/// `I4 = |F S|^2`, `S = (0, cos a, sin a)`.
pub(super) fn i4(f: &Tensor, angle: Angle) -> Ratio {
    f.iter().map(|row| row[1] * angle.cos() + row[2] * angle.sin()).fold(0.0 * ONE, |sum, s| sum + s * s)
}

/// At rest and in tension along its axial threads a tube is as stiff as rubber (`3 mu1` over the wall) and threads together.
#[test]
fn winding_of_threads_has_the_stiffness_of_its_threads() {
    let (radius, modulus, spacing) = (m(0.0889e-3), pa(31.067e9), m(3e-3));
    let tension = thread_to_sheet(modulus, PI * radius * radius, spacing);
    let thickness = m(0.178e-3);
    let mu2: Pressure = tension / (4.0 * thickness);
    let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
    let p = wound(p, 90.0, Families::One, mu2.get::<pascal>(), Placement::Sheet, 1e3 * thickness.get::<meter>());
    let (inner, outer, length) = (m(p.inner_radius_m), m(p.outer_radius_m), m(p.length_m));
    let wall: Force = 3.0 * pa(0.2e6) * PI * (outer * outer - inner * inner);
    let threads: Force = tension * TAU * outer;
    let expected: ForcePerLength = (wall + threads) / length;
    let held = Actuator::new(&p).unwrap().blocked(0.0, 1.0, 0.0).unwrap();
    let found: ForcePerLength = Force::new::<newton>(held.stiffness[0][0]) / m(1.0);
    close(found, expected, wall / length * 1e-9);
}
