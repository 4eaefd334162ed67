//! A wound bender under its weight and a mass, against finite elements of its section and a beam that is shot from its tip.

use std::f64::consts::PI;

use fra_model::ActuatorParameters;
use softlimb_fea::cross_section::{EndLoad, Options, Section};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, GRAVITY_M_PER_S2, Load, LoadedLimb};
use softlimb_scene::{Scene, parse};

const DENSITY_KG_PER_M3: f64 = 200.0;
const SHEAR_MODULUS_PA: f64 = 0.2e6;
const STEPS: usize = 200;

fn finger(winding: &str) -> Scene {
    let text = format!(
        r#"
format = 1
name = "finger"
seed = 4
weight = {{ simulated = true }}
materials.silicone = {{ law = "neo-hookean", shear_modulus = "0.2 MPa", density = "200 kg/m3" }}
windings.helix = {{ angle = "15 deg", families = 2, modulus = "20 MPa", thickness = "0.1 mm" }}
windings.soft = {{ angle = "50 deg", families = 2, modulus = "1 MPa", thickness = "0.1 mm" }}
limb.connector = {{ length = 0, mass = 0 }}

[[module]]
name = "finger"
motion = "bending"
actuators = 1
inner_radius = "6 mm"
outer_radius = "8 mm"
length = "200 mm"
material = "silicone"
winding = {winding}
pressure_max = "60 kPa"

[[phase]]
name = "bend"
duration = "2 s"
targets = {{ finger = {{ bend_angle = "30 deg" }} }}
"#
    );
    parse(&text, "finger.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// Bend per length and stretch over moments at one pressure, by finite elements.
struct Bends(Vec<(f64, [f64; 2])>);

impl Bends {
    fn new(section: &Section, pressure_pa: f64, least_nm: f64) -> Self {
        let at = |k: i32| {
            let moment_nm = least_nm * (1.0 - f64::from(k) / 8.0);
            let load = EndLoad { bending_moments_nm: [moment_nm, 0.0], ..EndLoad::default() };
            let answer = section.curve(&[pressure_pa], &load).unwrap().answers[0];
            let state = answer.equilibrium().expect("carried").state;
            (moment_nm, [state.bend_rates_rad_per_m[0], state.axial_stretch])
        };
        Self((0..=9).map(at).collect())
    }

    /// By Lagrange's formula.
    fn at(&self, moment_nm: f64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (index, (own, values)) in self.0.iter().enumerate() {
            let others = self.0.iter().enumerate().filter(|(other, _)| *other != index);
            let weight: f64 = others.map(|(_, (other, _))| (moment_nm - other) / (own - other)).product();
            (0..2).for_each(|n| sum[n] += weight * values[n]);
        }
        sum
    }
}

/// A level beam with a mass at its tip: position and direction, rad, of the tip beside the root, shot from the tip on.
struct Beam<'a> {
    parameters: &'a ActuatorParameters<f64>,
    bends: &'a Bends,
    payload_n: f64,
}

impl Beam<'_> {
    /// From the tip to the root: place, direction and moment; the tip is at zero.
    fn root(&self, tip_rad: f64) -> [f64; 4] {
        let ActuatorParameters { inner_radius_m, outer_radius_m, length_m, .. } = *self.parameters;
        let area_m2 = PI * (outer_radius_m * outer_radius_m - inner_radius_m * inner_radius_m);
        let (shear_n, weight_n_per_m) =
            (0.5 * SHEAR_MODULUS_PA * area_m2, DENSITY_KG_PER_M3 * area_m2 * GRAVITY_M_PER_S2);
        let rate = |s: f64, [_, _, angle, moment]: [f64; 4]| {
            let (sin, cos) = angle.sin_cos();
            let down_n = self.payload_n + weight_n_per_m * (length_m - s);
            // The line at the outer radius keeps its length: a force along the axis bends the tube as its moment about that line does.
            let [bend, stretch] = self.bends.at(moment - down_n * sin * outer_radius_m);
            let slide = -down_n * cos / shear_n;
            let along = stretch * cos - slide * sin;
            [along, stretch * sin + slide * cos, bend, along * down_n]
        };
        let step = -length_m / STEPS as f64;
        let moved =
            |at: [f64; 4], rate: [f64; 4], by: f64| -> [f64; 4] { std::array::from_fn(|n| at[n] + by * rate[n]) };
        (0..STEPS).fold([0.0, 0.0, tip_rad, 0.0], |at, k| {
            let s = length_m + step * k as f64;
            let a = rate(s, at);
            let b = rate(s + 0.5 * step, moved(at, a, 0.5 * step));
            let c = rate(s + 0.5 * step, moved(at, b, 0.5 * step));
            let d = rate(s + step, moved(at, c, step));
            std::array::from_fn(|n| at[n] + step / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]))
        })
    }

    /// The tip, m, ahead of the root and above it.
    fn tip_m(&self) -> [f64; 2] {
        let (mut low, mut high) = (-1.5, 3.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if self.root(middle)[2] < 0.0 { &mut low } else { &mut high }) = middle;
        }
        let [ahead, above, ..] = self.root(low);
        [-ahead, -above]
    }
}

#[test]
fn heavy_wound_bender_is_the_beam_of_finite_elements() {
    for (winding, is_wound_twice) in [("\"helix\"", false), ("[\"helix\", \"soft\"]", true)] {
        let scene = finger(winding);
        let limb = Limb::new(&scene).unwrap();
        let module = &limb.modules()[0];
        assert!(module.is_by_section());
        let parameters = module.actuator.parameters();
        let section = match module.second_fiber() {
            None => Section::new(parameters, &Options::default()),
            Some(second) => Section::with_two_windings(parameters, second, &Options::default()),
        };
        let section = section.unwrap();
        assert_eq!(module.second_fiber().is_some(), is_wound_twice);
        for pressure_pa in [10e3, 25e3, 45e3] {
            let bends = Bends::new(&section, pressure_pa, -0.014);
            for payload_kg in [0.0, 1.5e-3, 3e-3] {
                let payload_n = payload_kg * GRAVITY_M_PER_S2;
                let expected_m = Beam { parameters, bends: &bends, payload_n }.tip_m();
                let load = Load { payload_kg, ..Load::default() };
                let loaded = LoadedLimb::new(&scene, &limb, &[pressure_pa], &[1], &load).unwrap();
                let base_m = loaded.rod.base.translation.vector;
                let tip_m = |tip_m: nalgebra::Vector3<f64>| {
                    let off_m = tip_m - base_m;
                    [off_m.xy().norm(), off_m.z]
                };
                let free_m = tip_m(loaded.free_tip().translation.vector);
                let found_m = tip_m(loaded.settle(Fidelity::Fourfold, None).unwrap().shape.tip().translation.vector);
                let distance_m = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
                let (off_m, moved_m) = (distance_m(found_m, expected_m), distance_m(found_m, free_m));
                println!("{winding} {pressure_pa} Pa {payload_kg} kg: {moved_m:.5} m moved, {off_m:.1e} m off");
                // The rod has one stiffness, that of its mean bend.
                assert!(moved_m > 2e-3 && off_m < 1e-2 * moved_m, "{found_m:?} {expected_m:?} {free_m:?}");
            }
        }
    }
}
