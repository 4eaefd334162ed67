//! Segments in series under load: a chain of modules without anything between them, at one pressure.

use nalgebra::Vector3;
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb};
use softlimb_scene::{Scene, parse};

use crate::statics::shooting;

/// Motion, length, winding and direction of a segment.
type Part = (&'static str, u32, &'static str, i32);

const EXTENDED_AND_BENT: &[Part] = &[("extension", 60, "hoop", 0), ("bending", 100, "", 0)];
const ALL_MOTIONS: &[Part] =
    &[("twisting", 50, "screw", 0), ("bending", 60, "", 0), ("extension", 40, "hoop", 0), ("bending", 50, "", 75)];
const BY_FINITE_ELEMENTS: &[Part] = &[("bending", 70, "helix", 0), ("bending", 60, "", 180)];

/// The parts as segments of one module, or as modules with connectors of no length.
fn scene(parts: &[Part], is_series: bool, direction: &str) -> Scene {
    let mut text = format!(
        "format = 1\nname = \"series\"\n[materials.silicone]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.223 MPa\"\n\
         density = \"1080 kg/m3\"\n[windings.hoop]\nangle = \"3 deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [windings.screw]\nangle = \"28 deg\"\nfamilies = 1\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [windings.helix]\nangle = \"15 deg\"\nfamilies = 2\nmodulus = \"20 MPa\"\nthickness = \"0.1 mm\"\n\
         [limb]\nbase_direction = {direction}\nbase_up = [0, 1, 0]\nconnector = {{ length = \"0 mm\", mass = \"0 g\" }}\n\
         end_effector = {{ length = \"30 mm\", radius = \"8 mm\", mass = \"4 g\" }}\n"
    );
    let module = |name: &str, motion: &str, mount: i32| {
        format!(
            "[[module]]\nname = \"{name}\"\nmotion = \"{motion}\"\nactuators = 1\ninner_radius = \"6 mm\"\nouter_radius = \"9 mm\"\n\
             material = \"silicone\"\nmount_angle = \"{mount} deg\"\n"
        )
    };
    let winding = |winding: &str| if winding.is_empty() { String::new() } else { format!("winding = \"{winding}\"\n") };
    if is_series {
        text += &module("m", parts[parts.len() - 1].0, 20);
    }
    for (index, (motion, length_mm, wound, direction)) in parts.iter().enumerate() {
        let own = format!("length = \"{length_mm} mm\"\n{}", winding(wound));
        if is_series {
            let bends =
                if *motion == "bending" { format!("bend_direction = \"{direction} deg\"\n") } else { String::new() };
            text += &format!("[[module.segments]]\nmotion = \"{motion}\"\n{own}{bends}");
        } else {
            text += &format!("{}{own}", module(&format!("m{index}"), motion, 20 + direction));
        }
    }
    let name = if is_series { "m" } else { "m0" };
    text += &format!(
        "[[phase]]\nname = \"p\"\nduration = \"5 s\"\ntargets = {{ {name} = {{ pressure = \"10 kPa\" }} }}\n[limits]\npressure_max = \"60 kPa\"\n"
    );
    parse(&text, "test.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn loaded(scene: &Scene, limb: &Limb, pressure_pa: f64, payload_kg: f64) -> LoadedLimb {
    let (pressures, bays) = (vec![pressure_pa; limb.channels()], vec![1; limb.modules().len()]);
    let load = Load { payload_kg, force_n: [0.0, 0.02, 0.01] };
    LoadedLimb::new(scene, limb, &pressures, &bays, &load).expect("an equilibrium")
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (Vector3::from(a) - Vector3::from(b)).norm()
}

#[test]
fn series_is_the_chain_of_its_segments_as_modules_at_one_pressure() {
    for (parts, payload_kg) in [(EXTENDED_AND_BENT, 6e-3), (ALL_MOTIONS, 3e-3), (BY_FINITE_ELEMENTS, 4e-3)] {
        let [one, several] = [true, false].map(|is_series| {
            let scene = scene(parts, is_series, "[1, 0, 0]");
            let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
            (scene, limb)
        });
        assert_eq!((one.1.modules().len(), several.1.modules().len()), (1, parts.len()));
        assert!((one.0.mass_kg() - several.0.mass_kg()).abs() < 1e-15);
        for pressure_pa in [0.0, 15e3, 35e3] {
            let [a, b] = [&one, &several].map(|(scene, limb)| loaded(scene, limb, pressure_pa, payload_kg));
            assert!((a.free_tip().translation.vector - b.free_tip().translation.vector).norm() < 1e-12);
            let [free, settled] = [a.free_tip(), a.settle(Fidelity::Fourfold, None).expect("it stands").shape.tip()];
            let other = b.settle(Fidelity::Fourfold, None).expect("it stands").shape.tip();
            let moved_m = (settled.translation.vector - free.translation.vector).norm();
            let off_m = (settled.translation.vector - other.translation.vector).norm();
            println!("{parts:?} {pressure_pa} Pa: {moved_m:.4} m moved, {off_m:.1e} m off");
            assert!(moved_m > 5e-3 && off_m < 1e-11, "{moved_m} {off_m:e}");
            let [one, several] = [(&one, a), (&several, b)]
                .map(|((scene, _), limb)| limb.stand(1e-2, scene.rest_length_m()).expect("it stands"));
            assert!(apart(one.tip_m, several.tip_m) < 1e-10);
            let [stiff, other] = [&one, &several].map(|standing| standing.stiffness_n_per_m.expect("stable"));
            assert!(stiff.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-7 * b), "{stiff:?} {other:?}");
            assert!((one.load_factor - several.load_factor).abs() < 1e-6 * several.load_factor);
            // A column of all segments buckles before one that plates hold at both ends.
            assert!(one.buckling_margin <= several.buckling_margin * (1.0 + 1e-9));
        }
    }
}

/// By the shooting solution, with the rod of the settled limb as modules.
#[test]
fn loaded_series_is_the_beam_that_is_shot_from_its_root() {
    for parts in [EXTENDED_AND_BENT, ALL_MOTIONS] {
        let [one, several] = [true, false].map(|is_series| {
            let scene = scene(parts, is_series, "[1, 0, 0]");
            let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
            let settled = loaded(&scene, &limb, 25e3, 3e-3).settle(Fidelity::Fourfold, None).expect("it stands");
            (settled, scene.rest_length_m())
        });
        let exact = shooting::tip(&several.0.limb.rod).expect("followed");
        let found = one.0.shape.tip().translation.vector;
        let (off, sag) =
            ((found - exact).norm() / one.1, (found - one.0.limb.free_tip().translation.vector).norm() / one.1);
        println!("{parts:?}: {sag:.3} of the length moved, {off:.1e} off");
        assert!(sag > 0.03 && off < 1e-2 * sag, "{sag} {off:e}");
    }
}

/// Halves of one winding are the whole: shape, deformation, and the load of buckling of the column from end to end.
#[test]
fn equal_segments_are_one_column() {
    let whole: &[Part] = &[("extension", 200, "hoop", 0)];
    let halves: &[Part] = &[("extension", 100, "hoop", 0), ("extension", 100, "hoop", 0)];
    let [one, two] = [(whole, false), (halves, true)].map(|(parts, is_series)| {
        let scene = scene(parts, is_series, "[0, 0, -1]");
        let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
        // Pushed along its axis from below.
        let load = Load { payload_kg: 0.0, force_n: [0.0, 2e-3, 0.14] };
        let limb = LoadedLimb::new(&scene, &limb, &[20e3], &[1], &load).expect("an equilibrium");
        let settled = limb.settle(Fidelity::Fourfold, None).expect("it stands");
        let tube = settled.limb.buckling(&settled.rod, &settled.shape).expect("a tube");
        let deformed = settled.limb.deformed(&settled.rod, &settled.shape);
        (tube, deformed, settled.shape.tip().translation.vector)
    });
    let ((tube, deformed, tip), (other, of_two, tip_of_two)) = (one, two);
    assert!((tip - tip_of_two).norm() < 2e-5, "{tip} {tip_of_two}");
    assert_eq!((deformed.len(), of_two.len(), other.module), (1, 1, 0));
    assert!((deformed[0].axial_stretch - of_two[0].axial_stretch).abs() < 1e-5, "{deformed:?} {of_two:?}");
    assert!((deformed[0].bend_angle_rad[0] - of_two[0].bend_angle_rad[0]).abs() < 1e-3, "{deformed:?} {of_two:?}");
    println!("{tube:?} {other:?}");
    // Compressions are those of the middles, which the weight of the wall sets apart.
    assert!((tube.critical_n - other.critical_n).abs() < 5e-3 * tube.critical_n, "{tube:?} {other:?}");
}
