//! Rods under load with their tips and times, for `host/lab/benches/statics/compare.py`: one line of JSON.
//!
//!     cargo run --release -p softlimb-lab --example statics_rods
//!
//! A heavy level cantilever, and a limb of three modules, hanging with a payload and level without. Each is told as the rod that is solved,
//! so that another program can solve the same one.

use std::time::Instant;

use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion, Vector3, Vector4};
use serde::Serialize;
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb, Piece, Rod, by_fidelity};
use softlimb_scene as scene;

const ROUNDS: usize = 200;
const PRESSURE_PA: f64 = 40e3;
/// A pose nearby, from which the warm solution starts: its pressures or loads differ by this share.
const NEARBY: f64 = 1.01;

/// Microseconds of the fastest of several runs.
fn fastest(mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e6
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

/// 0.81 m level, 1.4 N m2, a weight of 8 N/m; nearly rigid in all but bending.
fn cantilever(share: f64) -> Rod {
    let piece = Piece {
        free: [1.0, 0.0, 0.0, 0.0],
        free_shear: [0.0; 2],
        stiffness: Matrix4::from_diagonal(&Vector4::new(1e4, 1.4, 1.4, 1.4)),
        coupled: nalgebra::Matrix4x2::zeros(),
        shear_n: 1e4,
        sway: 0.6,
        length_m: 0.81,
        mount_angle_rad: 0.0,
        kg_per_m: 0.8 * share,
        rigid_m: 0.0,
        masses: Vec::new(),
    };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    Rod {
        base: Isometry3::from_parts(Translation3::identity(), turn),
        pieces: vec![piece],
        gravity_m_per_s2: Vector3::new(0.0, 0.0, -10.0),
        tip_force_n: Vector3::zeros(),
    }
}

/// The limb of a scene, hanging or level, with plates every 60 mm. The lines of its bending module stretch as its walls do, not a
/// hundred times less: that would cost a program that follows waves in time ten times the steps.
fn limb(share: f64, direction: &str, up: &str, payload_kg: f64) -> Rod {
    let text = std::fs::read_to_string("scenes/weightless-a.toml").expect("run from the root of the workspace");
    let text = text
        .replace("base_direction = [1, 0, 0]", &format!("base_direction = {direction}"))
        .replace("base_up = [0, 0, 1]", &format!("base_up = {up}"));
    let scene = scene::parse(&text, "limb").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    let pressures = vec![PRESSURE_PA * share; limb.channels()];
    let load = Load { payload_kg, ..Load::default() };
    let mut rod =
        LoadedLimb::new(&scene, &limb, &pressures, &vec![4; limb.modules().len()], &load).expect("a limb").rod;
    rod.pieces[1].stiffness[(0, 0)] /= 100.0;
    rod
}

#[derive(Serialize)]
struct Case {
    name: &'static str,
    rod: RodData,
    free_tip_m: [f64; 3],
    tiers: [Tier; 3],
}

#[derive(Serialize)]
struct RodData {
    origin_m: [f64; 3],
    axes: [[f64; 3]; 3],
    pieces: Vec<PieceData>,
    gravity_m_per_s2: [f64; 3],
}

#[derive(Serialize)]
struct PieceData {
    free: [f64; 4],
    stiffness: [[f64; 4]; 4],
    shear_n: f64,
    sway: f64,
    length_m: f64,
    mount_angle_rad: f64,
    kg_per_m: f64,
    rigid_m: f64,
    masses: Vec<(f64, f64)>,
}

#[derive(Serialize)]
struct Tier {
    name: &'static str,
    tip_m: [f64; 3],
    cold_us: f64,
    warm_us: f64,
}

fn data(rod: &Rod) -> RodData {
    let piece = |piece: &Piece| PieceData {
        free: piece.free,
        // Columns of a symmetric matrix are its rows.
        stiffness: piece.stiffness.into(),
        shear_n: piece.shear_n,
        sway: piece.sway,
        length_m: piece.length_m,
        mount_angle_rad: piece.mount_angle_rad,
        kg_per_m: piece.kg_per_m,
        rigid_m: piece.rigid_m,
        masses: piece.masses.clone(),
    };
    RodData {
        origin_m: rod.base.translation.vector.into(),
        axes: (*rod.base.rotation.to_rotation_matrix().matrix()).into(),
        pieces: rod.pieces.iter().map(piece).collect(),
        gravity_m_per_s2: rod.gravity_m_per_s2.into(),
    }
}

fn case(name: &'static str, make: impl Fn(f64) -> Rod) -> Case {
    let (here, near) = (make(1.0), make(NEARBY));
    let free = by_fidelity(&here, Fidelity::Kinematic, None).expect("the kinematics").1.tip().translation.vector;
    let tiers = [Fidelity::Linear, Fidelity::Double, Fidelity::Fourfold].map(|tier| {
        let (_, shape) = by_fidelity(&here, tier, None).expect("stable");
        let start = by_fidelity(&near, tier, None).expect("stable").1.q;
        Tier {
            name: tier.name(),
            tip_m: shape.tip().translation.vector.into(),
            cold_us: fastest(|| drop(by_fidelity(&here, tier, None))),
            warm_us: fastest(|| drop(by_fidelity(&here, tier, Some(&start)))),
        }
    });
    Case { name, rod: data(&here), free_tip_m: free.into(), tiers }
}

fn main() {
    let hanging = |share| limb(share, "[0, 0, -1]", "[1, 0, 0]", 0.2);
    let level = |share| limb(share, "[1, 0, 0]", "[0, 0, 1]", 0.0);
    let cases = [case("cantilever", cantilever), case("hanging limb", hanging), case("level limb", level)];
    println!("{}", serde_json::to_string(&cases).expect("finite numbers"));
}
