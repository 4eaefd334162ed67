//! Bundles of twisting actuators, which plates hold back, beside their tubes as rods of their own between the plates.

use softlimb_limb::statics::{Bundle, Load, LoadedLimb};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Scene, parse};

use crate::statics::Stream;

/// A limb of one twisting module, upright.
pub(super) struct Case {
    pub(super) count: u8,
    pub(super) radius_mm: f64,
    pub(super) spacers: u8,
    pub(super) inner_mm: f64,
    pub(super) wall_mm: f64,
    pub(super) length_mm: f64,
    pub(super) angle_deg: f64,
}

impl Case {
    pub(super) fn scene(&self) -> Scene {
        parse(&self.text(), "twisted.toml").unwrap_or_else(|error| panic!("{error}"))
    }

    pub(super) fn text(&self) -> String {
        let Self { count, radius_mm, spacers, inner_mm, wall_mm, length_mm, angle_deg } = self;
        let outer_mm = inner_mm + wall_mm;
        format!(
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
        )
    }

    pub(super) fn random(stream: &mut Stream) -> Self {
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
        let [twist_rad, length_m] =
            by_tubes(&scene, &limb, state.pressure_pa, state.twist_rad).expect("an equilibrium");
        let rest_m = module.length_m();
        let (radius_m, bay) = (module.reach_m(), rest_m / module.bays() as f64);
        // A tube's end goes along its circle and along the axis.
        let motion_m = (length_m - rest_m).hypot(radius_m * twist_rad);
        let off =
            [(state.twist_rad / twist_rad - 1.0).abs(), (state.axial_stretch * rest_m - length_m).abs() / motion_m];
        let free = module.actuator.forward(state.pressure_pa, &fra_model::Load::none()).expect("finite").state;
        let share = state.twist_rad / free.twist_rad;
        let lean = 2.0 * radius_m * (0.5 * twist_rad / module.bays() as f64).sin() / (bay * state.axial_stretch);
        println!(
            "{number}: {} at {:.1} mm, bays of {:.1} mm, {:.1} kPa: share {share:.3}, lean {lean:.3}, twist {:.2} deg, length {:.5}; off {:.4} % and {:.4} %",
            case.count,
            1e3 * radius_m,
            1e3 * bay,
            1e-3 * state.pressure_pa,
            twist_rad.to_degrees(),
            length_m / rest_m - 1.0,
            100.0 * off[0],
            100.0 * off[1]
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

fn page_case(count: u8, radius_mm: f64, spacers: u8) -> Case {
    Case { count, radius_mm, spacers, inner_mm: 10.0, wall_mm: 4.0, length_mm: 240.0, angle_deg: 28.0 }
}

/// The table of `docs/explanation/bundles.md`.
#[test]
fn table_of_twists_is_that_of_the_page() {
    let page = include_str!("../../../../docs/explanation/bundles.md");
    let pressure_pa = 20e3;
    let mut missing = Vec::new();
    let alone = module(&Limb::new(&page_case(1, 0.0, 0).scene()).expect("a limb")).curve.at(pressure_pa).twist_rad;
    println!("alone {:.1} deg", alone.to_degrees());
    for (radius_mm, spacers) in [(30.0, 0), (30.0, 1), (30.0, 5), (60.0, 0), (60.0, 1), (60.0, 5)] {
        let case = page_case(3, radius_mm, spacers);
        let scene = case.scene();
        let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let module = module(&limb);
        let free = module.actuator.forward(pressure_pa, &fra_model::Load::none()).expect("finite").state;
        let state = module.curve.at(pressure_pa);
        assert_eq!(state.pressure_pa, pressure_pa, "on the curve");
        let [twist_rad, length_m] = by_tubes(&scene, &limb, pressure_pa, state.twist_rad).expect("an equilibrium");
        let row = format!(
            "| {radius_mm:.0} mm | {:.0} mm | {:.1} % | {:.1} % | {:.4} | {:.4} |",
            240.0 / f64::from(spacers + 1),
            100.0 * state.twist_rad / free.twist_rad,
            100.0 * twist_rad / free.twist_rad,
            state.axial_stretch,
            length_m / module.length_m()
        );
        println!("{row}");
        missing.extend((!page.contains(&row)).then_some(row));
    }
    assert!(missing.is_empty(), "not in the page:\n{}", missing.join("\n"));
}

/// One on the axis does as it does alone, to the last bit.
#[test]
fn one_on_the_axis_twists_freely() {
    let limb = Limb::new(&page_case(1, 0.0, 5).scene()).expect("a limb");
    let module = module(&limb);
    let alone = softlimb_limb::StateCurve::new(&module.actuator, module.reference_max_pa);
    assert!(!module.is_restrained() && module.twist_share().is_none());
    assert_eq!(module.curve.states(), alone.states());
}

/// Springs of equal tubes, as the statics and the simulated limb take them, rest in the states of the curve.
#[test]
fn statics_and_simulated_limb_rest_where_the_curve_is() {
    let limb = Limb::new(&page_case(3, 45.0, 2).scene()).expect("a limb");
    let module = module(&limb);
    let states = module.curve.states();
    for state in [&states[1], &states[states.len() / 2], &states[states.len() - 1]] {
        let bundle = Bundle::new(module, &[state.pressure_pa; 3], module.bays()).expect("an equilibrium");
        assert!((bundle.free.stretch - state.axial_stretch).abs() < 1e-9, "{:?}", bundle.free);
        assert!((bundle.free.twist_rad_per_m * module.length_m() - state.twist_rad).abs() < 1e-9, "{:?}", bundle.free);
        let alone = module.actuator.forward(state.pressure_pa, &fra_model::Load::none()).expect("finite").state;
        let held = module.held_back(&[(module.actuator, alone); 3]).expect("an equilibrium");
        assert!(
            (held.axial_stretch - state.axial_stretch).abs() < 1e-9 && (held.twist_rad - state.twist_rad).abs() < 1e-9
        );
        assert!(held.twist_rad.abs() < 0.9 * alone.twist_rad.abs());
    }
}

/// Small twists by hand: a tube slides by `a t` and yields by its shear and its S in series; the torques of the free twist and of the slide balance.
/// The free tube stretches along, which couples to the torque: the bundle keeps the axial force at zero.
#[test]
fn small_twists_are_those_of_springs_in_series() {
    for (radius_mm, spacers) in [(30.0, 0), (45.0, 2), (60.0, 5)] {
        let limb = Limb::new(&page_case(4, radius_mm, spacers).scene()).expect("a limb");
        let module = module(&limb);
        let pressure_pa = 200.0;
        let bundle = Bundle::new(module, &[pressure_pa; 4], module.bays()).expect("an equilibrium");
        let tube = bundle.tubes[0].1;
        let (radius_m, bay_m) = (1e-3 * radius_mm, 0.24 / f64::from(spacers + 1));
        let yields = bay_m / tube.shear_n + bay_m.powi(3) / (12.0 * tube.bending_nm2);
        let slide = radius_m * radius_m * bay_m / yields;
        let torsion = tube.torsion_nm2 - tube.coupling_nm * tube.coupling_nm / tube.axial_n;
        let expected = torsion / (torsion + slide);
        let free = module.actuator.forward(pressure_pa, &fra_model::Load::none()).expect("finite").state;
        let found = module.curve.at(pressure_pa).twist_rad / free.twist_rad;
        println!("{radius_mm} mm, {spacers} spacers: {found:.5}, by hand {expected:.5}");
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}

/// `check` warns where little of the twist is left.
#[test]
fn low_shares_are_warned_about() {
    let warnings =
        |radius_mm, spacers| Limb::new(&page_case(3, radius_mm, spacers).scene()).expect("a limb").restraint_warnings();
    assert!(warnings(30.0, 0).is_empty());
    let found = warnings(60.0, 5);
    assert!(
        found.len() == 1 && found[0].contains("`shoulder`") && found[0].contains("% of the twist of one alone"),
        "{found:?}"
    );
}

/// CalculiX (`cargo xtask lab bundles`, docs/evidence/solid-elements.md): three tubes of 120 mm between a plate and the base, 5 kPa.
#[test]
fn share_is_that_of_solid_elements() {
    let calculix = 0.09748 / 0.12542;
    let limb = Limb::new(&Case { length_mm: 120.0, ..page_case(3, 30.0, 0) }.scene()).expect("a limb");
    let module = module(&limb);
    let free = module.actuator.forward(5e3, &fra_model::Load::none()).expect("finite").state;
    let share = module.curve.at(5e3).twist_rad / free.twist_rad;
    println!(
        "share {:.2} %, CalculiX {:.2} %, {:+.2} %",
        100.0 * share,
        100.0 * calculix,
        100.0 * (share / calculix - 1.0)
    );
    assert!((share / calculix - 1.0).abs() < 0.01, "{share}");
}
