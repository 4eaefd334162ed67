//! Steering modules: a pressure for each actuator, against arcs in closed form, the statics, and dense loads.

use fra_model::State;
use nalgebra::{Matrix3, Vector3, Vector6};
use softlimb_limb::Limb;
use softlimb_limb::payload::{Hold, LimbCapacity, LoadCase, Outcome, capacity, limb_capacity};
use softlimb_limb::statics::{Bundle, Tangent};
use softlimb_scene as scene;

const GRAVITY: f64 = 9.80665;
const LENGTH_M: f64 = 0.2;
const CIRCLE_M: f64 = 0.045;
const CONNECTOR_M: f64 = 0.02;
const CONNECTOR_KG: f64 = 0.13;

/// One module that hangs, its first actuator towards `x` of the scene.
fn text(actuators: u8, steering: bool) -> String {
    format!(
        r#"
format = 1
name = "one"

[materials.soft]
law = "neo-hookean"
shear_modulus = "0.305 MPa"
density = "1080 kg/m3"

[windings.hoop-like]
angle = "3 deg"
families = 2
modulus = "361 MPa"
thickness = "0.178 mm"

[limb]
base_direction = [0, 0, -1]
base_up = [1, 0, 0]
connector = {{ length = "20 mm", mass = "130 g" }}

[[module]]
name = "one"
motion = "extension"
actuators = {actuators}
circle_radius = "45 mm"
inner_radius = "12 mm"
outer_radius = "16 mm"
length = "200 mm"
material = "soft"
winding = "hoop-like"
spacers = 5
steering = {steering}

[[phase]]
name = "on"
duration = "2 s"
targets = {{ one = {{ pressure = "30 kPa" }} }}

[limits]
pressure_max = "150 kPa"
"#
    )
}

fn built(actuators: u8, steering: bool) -> (scene::Scene, Limb) {
    let scene = scene::parse(&text(actuators, steering), "one.toml").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    (scene, limb)
}

fn states(limb: &Limb, pressures_pa: &[f64]) -> Vec<State<f64>> {
    limb.drives().zip(pressures_pa).map(|(drive, pa)| drive.curve.at(*pa)).collect()
}

fn holding(both: &(scene::Scene, Limb), states: &[State<f64>], direction: [f64; 3], gravity: f64) -> LimbCapacity {
    let case = LoadCase { direction, gravity_m_per_s2: [0.0, 0.0, -gravity], spacers: None, buckling_share: 0.5 };
    limb_capacity(&both.0, &both.1, states, &case).unwrap_or_else(|error| panic!("{error}"))
}

/// Equal stretches are the plain module.
#[test]
fn equal_pressures_hold_what_the_plain_module_holds() {
    let (plain, steering) = (built(3, false), built(3, true));
    for (kpa, direction) in [(0.0, [0.0, 0.0, -1.0]), (60.0, [0.0, 0.0, 1.0]), (60.0, [1.0, 0.5, 0.2])] {
        let one = holding(&plain, &states(&plain.1, &[1e3 * kpa]), direction, GRAVITY);
        let three = holding(&steering, &states(&steering.1, &[1e3 * kpa; 3]), direction, GRAVITY);
        let [one_n, three_n] = [&one, &three].map(|holding| capacity(&holding.question).expect("solved").load_n);
        assert!((one_n - three_n).abs() < 1e-6 * one_n.abs(), "{kpa} kPa, {direction:?}: {one_n} {three_n}");
        let [own, others] = [&one, &three].map(|holding| capacity(&holding.own_weight()).expect("solved").load_n);
        assert!((own - others).abs() < 1e-6 * own.abs().max(1.0), "{own} {others}");
    }
}

/// At the shape that the bundle has without load by the least of its energy, its pressures leave nothing to balance, the bent tubes' own moment included.
#[test]
fn bundle_without_load_is_in_balance_in_the_shape_of_the_statics() {
    let both = built(3, true);
    let module = &both.1.modules()[0];
    for pressures_pa in [[100e3, 40e3, 60e3], [20e3, 80e3, 110e3], [90e3, 0.0, 0.0]] {
        let mut bundle = Bundle::new(module, &pressures_pa, module.bays()).expect("a bundle");
        for _ in 0..30 {
            let [x, y] = bundle.free.bend_rad_per_m;
            let strain = nalgebra::Vector4::new(bundle.free.stretch, x, y, 0.0);
            bundle = bundle.strained(module.motion, &strain).expect("stable tubes");
        }
        let [ux, uy] = bundle.free.bend_rad_per_m;
        let at = |[x, y]: [f64; 2]| {
            let stretch = bundle.free.stretch - ux * x - uy * y;
            module.curve.find(|state| state.axial_stretch, stretch).expect("a state of this stretch")
        };
        let states: Vec<State<f64>> = module.positions_m().into_iter().map(at).collect();
        let holding = holding(&both, &states, [0.0, 0.0, -1.0], 0.0);
        let found = &holding.question.bundles[0].bundle;
        let left: Vector6<f64> = found.wrench(&pressures_pa).expect("solved");
        let walls_nm = found.walls.fixed_rows::<3>(3).norm();
        let moment_nm = left.fixed_rows::<3>(3).norm();
        println!("{pressures_pa:?}: {:.2e} N, {moment_nm:.2e} N m of {walls_nm:.2e} N m of the walls", left.z);
        // Of the walls' stiffness only its change with the pressure is left.
        assert!(moment_nm < 0.03 * walls_nm && left.z.abs() < 1e-3, "{left} {walls_nm}");
    }
}

/// Wrench of weights and of one newton at the tip on the near end of a bent module, in its frame: `x` of the scene, `-y`, down.
struct Arc {
    towards: [f64; 2],
    angle_rad: f64,
    length_m: f64,
}

impl Arc {
    /// From the stretches of three actuators, by the inverse of the three equations.
    fn of(stretches: [f64; 3]) -> (Self, Vector3<f64>) {
        let turn = |i: usize| (std::f64::consts::TAU * i as f64 / 3.0).sin_cos();
        let rows = Matrix3::from_fn(|i, column| match column {
            0 => 1.0,
            1 => -CIRCLE_M * turn(i).1,
            _ => -CIRCLE_M * turn(i).0,
        });
        let shape = rows.lu().solve(&Vector3::from(stretches)).expect("three equations");
        let bend = shape.y.hypot(shape.z);
        let towards = [shape.y / bend, shape.z / bend];
        (Self { towards, angle_rad: bend * LENGTH_M, length_m: shape.x * LENGTH_M }, shape)
    }

    /// A point of the centre line, or beyond its end along the tangent, m.
    fn at(&self, share: f64, beyond_m: f64) -> Vector3<f64> {
        let radius_m = self.length_m / self.angle_rad;
        let (sin, cos) = (self.angle_rad * share).sin_cos();
        let (aside, along) = (radius_m * (1.0 - cos) + beyond_m * sin, radius_m * sin + beyond_m * cos);
        Vector3::new(self.towards[0] * aside, self.towards[1] * aside, along)
    }

    /// Axial force and both moments of a force at a point.
    fn rows(force: &Vector3<f64>, at: &Vector3<f64>) -> Vector3<f64> {
        let moment = at.cross(force);
        Vector3::new(force.z, moment.x, moment.y)
    }
}

/// The largest load by a scan: at each load the three pressures that balance it, by Newton's method on the model, until one leaves its range.
#[test]
fn largest_load_is_that_of_a_scan_over_loads() {
    let both = built(3, true);
    let module = &both.1.modules()[0];
    let most_pa = module.reference_max_pa.min(module.curve.pressure_max_pa());
    for pressures_pa in [[100e3, 40e3, 60e3], [20e3, 80e3, 70e3]] {
        let states = states(&both.1, &pressures_pa);
        let stretches = [0, 1, 2].map(|i: usize| states[i].axial_stretch);
        let (arc, shape) = Arc::of(stretches);
        let wall_kg = both.0.modules()[0].mass_kg();
        let parts = 2000;
        let line =
            (0..parts).map(|k| (wall_kg / f64::from(parts), arc.at((f64::from(k) + 0.5) / f64::from(parts), 0.0)));
        let masses = line.chain([(CONNECTOR_KG, arc.at(1.0, 0.5 * CONNECTOR_M))]);
        let weights: Vector3<f64> = masses.map(|(kg, at)| Arc::rows(&Vector3::new(0.0, 0.0, kg * GRAVITY), &at)).sum();
        // The tubes' own bending turns the far end back.
        let tubes = |pa: f64| Tangent::of(&module.actuator, pa).expect("solved").bending_nm2;
        let own_nm2: f64 = pressures_pa.into_iter().map(tubes).sum();
        let walls = Vector3::new(0.0, own_nm2 * shape.z, -own_nm2 * shape.y);
        let pushes = |p: &Vector3<f64>| {
            let push = |i: usize| -module.actuator.blocked(p[i], stretches[i], 0.0).expect("finite").force_n;
            let at = |i: usize| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / 3.0).sin_cos();
                Vector3::new(CIRCLE_M * cos, CIRCLE_M * sin, 0.0)
            };
            (0..3).map(|i| Arc::rows(&Vector3::new(0.0, 0.0, push(i)), &at(i))).sum::<Vector3<f64>>()
        };
        for direction in [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [-0.4, 0.8, 0.3]] {
            let unit = Vector3::from(direction).normalize();
            // In the frame of the base: `x`, `-y`, down.
            let load = Arc::rows(&Vector3::new(unit.x, -unit.y, -unit.z), &arc.at(1.0, CONNECTOR_M));
            let held = holding(&both, &states, direction, GRAVITY);
            let found = capacity(&held.question).expect("solved");
            assert_eq!(found.outcome, Outcome::Solved);
            let push_max_n = &held.question.bundles[0].push_max_n;
            let (mut at_pa, mut scanned_n) = (Vector3::from(pressures_pa), f64::NAN);
            let step_n = 2e-3 * found.load_n.abs();
            for k in 0..2000 {
                let load_n = step_n * f64::from(k);
                let left = |p: &Vector3<f64>| pushes(p) + weights + walls + load * load_n;
                for _ in 0..6 {
                    let here = left(&at_pa);
                    let column = |i: usize| (left(&(at_pa + Vector3::ith(i, 1.0))) - here) * 1.0;
                    let slope = Matrix3::from_columns(&[column(0), column(1), column(2)]);
                    at_pa -= slope.lu().solve(&here).expect("three independent actuators");
                }
                let inside = at_pa.iter().all(|p| (0.0..=most_pa).contains(p));
                let push = |i: usize| -module.actuator.blocked(at_pa[i], stretches[i], 0.0).expect("finite").force_n;
                if !inside || (0..3).any(|i| push(i) > push_max_n[i]) {
                    scanned_n = load_n;
                    break;
                }
            }
            println!("{pressures_pa:?} {direction:?}: {:.4} N, scanned {scanned_n:.4} N", found.load_n);
            // The scan is one step beyond at most; Simpson's rule and the affine program cost the rest.
            let off_n = scanned_n - found.load_n;
            assert!(off_n > -step_n && off_n < 3.0 * step_n, "{direction:?}: {} {scanned_n}", found.load_n);
        }
    }
}

/// Of more than three actuators each is held at its line beside the arc.
#[test]
fn four_actuators_are_held_at_lines_beside_the_arc() {
    let both = built(4, true);
    let held_at = |pressures_pa: &[f64]| {
        let states = states(&both.1, pressures_pa);
        let holding = holding(&both, &states, [0.0, 0.0, -1.0], GRAVITY);
        let of = |i: usize| match holding.question.bundles[0].bundle.actuators[i].hold {
            Hold::Straight { axial_stretch, .. } => axial_stretch,
            Hold::Bent { .. } => panic!("a straight actuator"),
        };
        ([0, 1, 2, 3].map(of), [0, 1, 2, 3].map(|i: usize| states[i].axial_stretch))
    };
    let (held, own) = held_at(&[100e3, 20e3, 40e3, 60e3]);
    // Opposite lines have the same mean, which is that of all; their differences are those of the actuators.
    let mean = own.iter().sum::<f64>() / 4.0;
    for i in [0, 1] {
        let (sum, difference) = (held[i] + held[i + 2], held[i] - held[i + 2]);
        assert!((sum - 2.0 * mean).abs() < 1e-12 && (difference - (own[i] - own[i + 2])).abs() < 1e-12, "{held:?}");
    }
    assert!((held[0] - own[0]).abs() > 1e-3, "four unequal stretches are on no plane");
}
