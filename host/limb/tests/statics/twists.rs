//! Bundles of twisting actuators, which plates hold back, beside their tubes as rods of their own between the plates.

use softlimb_limb::statics::{Load, LoadedLimb};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Scene, parse};

use crate::statics::Stream;

/// A limb of one twisting module, upright.
struct Case {
    count: u8,
    radius_mm: f64,
    spacers: u8,
    inner_mm: f64,
    wall_mm: f64,
    length_mm: f64,
    angle_deg: f64,
}

impl Case {
    fn scene(&self) -> Scene {
        let Self { count, radius_mm, spacers, inner_mm, wall_mm, length_mm, angle_deg } = self;
        let outer_mm = inner_mm + wall_mm;
        let text = format!(
            "format = 1\nname = \"twisted\"\n\
             limb = {{ base_direction = [0, 0, 1], base_up = [1, 0, 0], connector = {{ length = 0, mass = 0 }} }}\n\
             materials.silicone = {{ law = \"neo-hookean\", shear_modulus = \"0.223 MPa\" }}\n\
             windings.helix = {{ angle = \"{angle_deg} deg\", families = 1, modulus = \"361 MPa\", \
             thickness = \"0.178 mm\" }}\n\
             [[module]]\nname = \"shoulder\"\nmotion = \"twisting\"\nactuators = {count}\n{}spacers = {spacers}\n\
             inner_radius = \"{inner_mm} mm\"\nouter_radius = \"{outer_mm} mm\"\nlength = \"{length_mm} mm\"\n\
             material = \"silicone\"\nwinding = \"helix\"\n\
             [[phase]]\nname = \"p\"\nduration = 1\ntargets = {{ shoulder = {{ twist = \"0 deg\" }} }}\n\
             [limits]\npressure_max = \"60 kPa\"\n",
            if *count > 1 { format!("circle_radius = \"{radius_mm} mm\"\n") } else { String::new() },
        );
        parse(&text, "twisted.toml").unwrap_or_else(|error| panic!("{error}"))
    }

    fn random(stream: &mut Stream) -> Self {
        let (inner_mm, wall_mm) = (stream.between(8.0, 12.0), stream.between(4.0, 7.0));
        let count = stream.between(2.0, 7.0) as u8;
        let touching_mm = (inner_mm + wall_mm) / (std::f64::consts::PI / f64::from(count)).sin();
        Self {
            count,
            radius_mm: (1.2 * touching_mm).max(stream.between(20.0, 60.0)),
            spacers: stream.between(0.0, 7.0) as u8,
            inner_mm,
            wall_mm,
            length_mm: stream.between(100.0, 300.0),
            angle_deg: stream.between(15.0, 40.0) * if stream.next() < 0.5 { -1.0 } else { 1.0 },
        }
    }
}

fn module(limb: &Limb) -> &LimbModule {
    &limb.modules()[0]
}

/// Twist, rad, and length, m, of the module with each tube a rod between its plates; the twist is that near `near_rad`.
fn by_tubes(scene: &Scene, limb: &Limb, pressure_pa: f64, near_rad: f64) -> Option<[f64; 2]> {
    let module = module(limb);
    let pressures_pa = vec![pressure_pa; limb.channels()];
    let loaded = LoadedLimb::new(scene, limb, &pressures_pa, &[module.bays()], &Load::default())?;
    let tip = loaded.tubes_at_rest(4)?.tip();
    let about = limb.base().rotation.inverse() * tip.rotation;
    let twist_rad = about.scaled_axis().z;
    let turns = ((near_rad - twist_rad) / std::f64::consts::TAU).round();
    Some([twist_rad + std::f64::consts::TAU * turns, (tip.translation.vector - limb.base().translation.vector).norm()])
}

#[test]
fn curves_are_the_equilibria_of_tubes_between_plates() {
    let mut stream = Stream(0x7757_1571);
    let (mut shares, mut leans, mut worst) = (Vec::new(), Vec::new(), [0.0_f64; 2]);
    for number in 0..50 {
        let case = Case::random(&mut stream);
        let scene = case.scene();
        let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let module = module(&limb);
        let state = module.curve.at(stream.between(0.3, 1.0) * module.curve.pressure_max_pa());
        let [twist_rad, length_m] = by_tubes(&scene, &limb, state.pressure_pa, state.twist_rad).expect("an equilibrium");
        let rest_m = module.length_m();
        let (radius_m, bay) = (module.reach_m(), rest_m / module.bays() as f64);
        // A tube's end goes along its circle and along the axis.
        let motion_m = (length_m - rest_m).hypot(radius_m * twist_rad);
        let off = [(state.twist_rad / twist_rad - 1.0).abs(), (state.axial_stretch * rest_m - length_m).abs() / motion_m];
        let free = module.actuator.forward(state.pressure_pa, &fra_model::Load::none()).expect("finite").state;
        let share = state.twist_rad / free.twist_rad;
        let lean = 2.0 * radius_m * (0.5 * twist_rad / module.bays() as f64).sin() / (bay * state.axial_stretch);
        println!(
            "{number}: {} at {:.1} mm, bays of {:.1} mm, {:.1} kPa: share {share:.3}, lean {lean:.3}, twist {:.2} deg, length {:.5}; off {:.4} % and {:.4} %",
            case.count, 1e3 * radius_m, 1e3 * bay, 1e-3 * state.pressure_pa, twist_rad.to_degrees(), length_m / rest_m - 1.0, 100.0 * off[0], 100.0 * off[1]
        );
        worst = [0, 1].map(|i: usize| worst[i].max(off[i]));
        shares.push(share);
        leans.push(lean.abs());
    }
    println!("worst {worst:?}");
    assert!(worst[0] <= 5e-3 && worst[1] <= 5e-3, "{worst:?}");
    // The bundles are held back by little and by much, and lean far.
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    assert!(least(&shares) < 0.2 && most(&shares) > 0.7 && most(&leans) > 0.2, "{shares:?} {leans:?}");
}
