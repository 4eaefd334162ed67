//! Sixteen loaded arms, four of them with two stable shapes: the shape that a run would reach, and the error that the statics state.
//!
//! The reference follows the arm from rest. Pressures and loads grow together in small steps, each from the shape before, by rods in four pieces
//! a module with springs about their own strains. Every few steps, and at the end, every tube is a rod between its plates, in fine pieces. The
//! statics take large steps, the cheapest model and other springs.

use nalgebra::{DVector, Vector3};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb, Settled};
use softlimb_scene as scene;
use softlimb_scene::Scene;

use crate::statics::Stream;

/// Steps of the reference, and the longest move of the tip in one of them over the length: no jump to another shape.
const STEPS: usize = 64;
const LONGEST_MOVE: f64 = 0.1;
/// Pieces of the reference's tubes: the statics have up to 8.
const FINE: usize = 12;
/// Distance of two tips over the length from which they are those of two shapes.
const APART: f64 = 0.05;
/// The error that the statics are asked for, and the least that they are held to.
const TOLERANCE: f64 = 0.01;
const SMALL: f64 = 0.001;

/// An arm of the sample: limb, pressures and payload.
struct Arm {
    scene: Scene,
    limb: Limb,
    pressures_pa: Vec<f64>,
    payload_kg: f64,
    spacers: usize,
}

impl Arm {
    fn new(seed: u64) -> Self {
        let mut stream = Stream(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed + 1));
        (0..8).for_each(|_| drop(stream.next()));
        let file = format!("{}/../../scenes/weightless-a.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).expect("a scene");
        let axis = Vector3::new(stream.between(-1.0, 1.0), stream.between(-1.0, 1.0), stream.between(-1.0, 1.0));
        let up = axis.cross(&Vector3::new(0.3, -0.5, 0.8));
        let (radius, spread) = (stream.between(10.0, 18.0), stream.between(1.6, 3.0));
        let [wide, thick] = [spread * radius, 1.4 * radius];
        let text = text
            .replace("base_direction = [1, 0, 0]", &format!("base_direction = [{}, {}, {}]", axis.x, axis.y, axis.z))
            .replace("base_up = [0, 0, 1]", &format!("base_up = [{}, {}, {}]", up.x, up.y, up.z))
            .replace("mass = \"300 g\"", "mass = \"130 g\"")
            .replace("mass = \"400 g\"", "mass = \"200 g\"")
            .replace("circle_radius = \"30 mm\"", &format!("circle_radius = \"{wide} mm\""))
            .replace("spacing = \"34 mm\"", &format!("spacing = \"{} mm\"", 2.2 * thick))
            .replace("outer_radius = \"14 mm\"", &format!("outer_radius = \"{thick} mm\""))
            .replace("inner_radius = \"10 mm\"", &format!("inner_radius = \"{radius} mm\""));
        let scene = scene::parse(&text, "arm.toml").unwrap_or_else(|error| panic!("{error}"));
        let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
        let of_module = |module: &softlimb_limb::LimbModule| {
            vec![stream.between(0.0, 0.8) * module.reference_max_pa; module.channels.len()]
        };
        let pressures_pa = limb.modules().iter().flat_map(of_module).collect();
        let (payload_kg, spacers) = (stream.between(0.0, 0.8), 3 + (3.0 * stream.next()) as usize);
        Self { scene, limb, pressures_pa, payload_kg, spacers }
    }

    fn length_m(&self) -> f64 {
        self.scene.rest_length_m()
    }

    /// The arm at shares of its pressures and of its loads.
    fn at(&self, pressures: f64, loads: f64) -> LoadedLimb {
        let pressures_pa: Vec<f64> = self.pressures_pa.iter().map(|pressure| pressure * pressures).collect();
        let load = Load { payload_kg: self.payload_kg, ..Load::default() };
        let bays = vec![self.spacers + 1; self.limb.modules().len()];
        let mut limb = LoadedLimb::new(&self.scene, &self.limb, &pressures_pa, &bays, &load).expect("in range");
        limb.rod.gravity_m_per_s2 *= loads;
        limb
    }

    /// The tip of the path of `at`, whose argument grows to 1; `None` where the path ends or jumps.
    fn followed(&self, at: impl Fn(f64) -> LoadedLimb) -> Option<Vector3<f64>> {
        let mut last: Option<(Vec<nalgebra::Vector4<f64>>, DVector<f64>, Vector3<f64>)> = None;
        let mut tip = None;
        for step in 0..=STEPS {
            let limb = at(step as f64 / STEPS as f64);
            let near = last.as_ref().map(|(strains, ..)| limb.at_strains(strains)).transpose().ok()?;
            let start = last.as_ref().map(|(_, q, _)| q);
            let Settled { limb, rod, shape } = near.unwrap_or(limb).settle(Fidelity::Fourfold, start).ok()?;
            let rods = shape.tip().translation.vector;
            if last.as_ref().is_some_and(|(.., before)| (rods - before).norm() > LONGEST_MOVE * self.length_m()) {
                return None;
            }
            if step == STEPS {
                tip = limb.tubes_near(&rod, &shape.q, FINE).map(|plates| plates.tip().translation.vector);
            }
            last = Some((limb.strains(&rod, &shape.q), shape.q, rods));
        }
        tip
    }
}

#[test]
fn search_for_arms() {
    for seed in 0..200 {
        let arm = Arm::new(seed);
        let Some(truth) = arm.followed(|share| arm.at(share, share)) else {
            println!("{seed}: path ends; stand {}", arm.at(1.0, 1.0).stand(TOLERANCE, arm.length_m()).is_ok());
            continue;
        };
        let standing = match arm.at(1.0, 1.0).stand(TOLERANCE, arm.length_m()) {
            Ok(standing) => standing,
            Err(lost) => {
                println!("{seed}: {lost}");
                continue;
            }
        };
        let off = (Vector3::from(standing.tip_m) - truth).norm() / arm.length_m();
        let told = standing.answer.error();
        println!(
            "{seed}: off {:.4} % told {:.4} % ratio {:.2} tier {} second {} bent {:?} buckling {:.2}",
            100.0 * off,
            100.0 * told,
            told / off,
            standing.answer.tier.name(),
            standing.second_tip_m.is_some(),
            standing.bent_back,
            standing.buckling_margin
        );
    }
}
