//! Contact with solids beside closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use softlimb_body::{
    Ball, Bay, Body, Contact, Effects, Hanging, Main, Mass, MemoryParameters, Moving, Plate, Solid, Tube,
};

use super::laws::Springs;

const SPRINGS: Springs =
    Springs { axial_n: 800.0, bending_nm2: [0.25, 0.3], torsion_nm2: 0.2, shear_n: 150.0, by_pressure: 2e-6 };
const NOTHING: Springs =
    Springs { axial_n: 1e-9, bending_nm2: [1e-9; 2], torsion_nm2: 1e-9, shear_n: 1e-9, by_pressure: 1e-6 };
const GRAVITY: f64 = 9.8;
/// Stiffness of a surface across itself and along itself, N/m, and its friction, as `docs/explanation/body.md` states them.
const ACROSS: f64 = 1e6;
const ALONG: f64 = 2.0 / 3.0 * 1e6;
const FRICTION: f64 = 0.5;

/// All points beyond a plane.
#[derive(Debug)]
struct HalfSpace {
    /// Out of the solid.
    normal: Vector3<f64>,
    /// A point of the plane, m.
    on_m: Vector3<f64>,
}

impl Solid for HalfSpace {
    fn distance(&self, point_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        (self.normal.dot(&(point_m - self.on_m)), self.normal)
    }
}

#[derive(Debug)]
struct Sphere {
    center_m: Vector3<f64>,
    radius_m: f64,
}

impl Solid for Sphere {
    fn distance(&self, point_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let away = point_m - self.center_m;
        (away.norm() - self.radius_m, away.normalize())
    }
}

fn half_space(normal: [f64; 3], on_m: [f64; 3]) -> Arc<dyn Solid> {
    Arc::new(HalfSpace { normal: Vector3::from(normal), on_m: Vector3::from(on_m) })
}

const LENGTH_M: f64 = 0.3;

/// A tube on a base, with these masses at its end.
fn tube(springs: Springs, base: &Isometry3<f64>, masses: Vec<Mass>, gravity: [f64; 3]) -> Body {
    let elastic = MemoryParameters::default().with(Effects::NONE);
    let tube = Tube::new(Arc::new(springs.law(Main::Stretch)), 0, [Isometry3::identity(); 2], (LENGTH_M, 4), elastic);
    let bay = Bay { rest: Isometry3::translation(0.0, 0.0, LENGTH_M), tubes: vec![tube] };
    Body::new(base, vec![bay], vec![Plate { masses }], [0.0; 3], gravity)
}

/// A tube along `z` whose end is a ball among solids.
fn among(solids: Vec<Arc<dyn Solid>>, radius_m: f64) -> Body {
    let mut body = tube(SPRINGS, &Isometry3::identity(), Vec::new(), [0.0; 3]);
    body.surround(solids, vec![Ball { plate: 0, place_m: [0.0; 3], radius_m }]);
    body
}

fn pressed(body: &mut Body, force_n: [f64; 3]) -> [f64; 3] {
    body.settle_under(&[0.0], 0.0, force_n, 1.0).unwrap();
    body.tip_m()
}

fn only(body: &Body) -> [f64; 3] {
    let [Contact { solid: 0, force_n, .. }] = body.contacts()[..] else { panic!("one solid is touched") };
    force_n
}

#[test]
fn stop_and_tube_share_a_force_as_springs() {
    let (gap_m, radius_m, force_n) = (1e-3, 0.02, 5.0);
    let mut body = among(vec![half_space([0.0, 0.0, -1.0], [0.0, 0.0, LENGTH_M + radius_m + gap_m])], radius_m);
    let free = pressed(&mut body, [0.0, 0.0, 1.0]);
    assert!((free[2] - LENGTH_M * (1.0 + 1.0 / SPRINGS.axial_n)).abs() < 1e-12 && body.contacts().is_empty());
    let tip = pressed(&mut body, [0.0, 0.0, force_n]);
    let tube_n_per_m = SPRINGS.axial_n / LENGTH_M;
    let stop_n = (force_n - tube_n_per_m * gap_m) / (1.0 + tube_n_per_m / ACROSS);
    assert!((only(&body)[2] + stop_n).abs() < 1e-6, "{:?} beside {stop_n}", only(&body));
    assert!((tip[2] - LENGTH_M - gap_m - stop_n / ACROSS).abs() < 1e-10);
    // It lets go without a pull.
    assert!((pressed(&mut body, [0.0, 0.0, 1.0])[2] - free[2]).abs() < 1e-12);
    assert!(body.contacts().is_empty());
}

#[test]
fn bent_cantilever_leans_on_a_stop_as_timoshenko_has_it() {
    let (force_n, gap_m) = (1e-3, 2e-5);
    let mut body = among(vec![half_space([-1.0, 0.0, 0.0], [gap_m, 0.0, 0.0])], 0.0);
    pressed(&mut body, [force_n, 0.0, 0.0]);
    let cantilever = 1.0 / (LENGTH_M.powi(3) / (3.0 * 0.25) + LENGTH_M / SPRINGS.shear_n);
    let expected = (force_n - cantilever * gap_m) / (1.0 + cantilever / ACROSS);
    assert!((-only(&body)[0] / expected - 1.0).abs() < 1e-4, "{:?} beside {expected}", only(&body));
}

#[test]
fn friction_holds_up_to_coulombs_limit_and_slides_beyond() {
    let mut body = among(vec![half_space([0.0, 0.0, -1.0], [0.0, 0.0, LENGTH_M])], 0.0);
    let press_n = 0.04;
    pressed(&mut body, [0.0, 0.0, press_n]);
    let normal_n = -only(&body)[2];
    let limit_n = FRICTION * normal_n;
    let cantilever = 1.0 / (LENGTH_M.powi(3) / (3.0 * 0.25) + LENGTH_M / SPRINGS.shear_n);
    let pulled = |body: &mut Body, share: f64| pressed(body, [share * limit_n, 0.0, press_n])[0];
    for share in [0.3, 0.6, 0.95] {
        let expected = share * limit_n / (ALONG + cantilever);
        let x = pulled(&mut body, share);
        assert!((x / expected - 1.0).abs() < 1e-2, "{x} beside {expected}");
    }
    let stuck = pulled(&mut body, 0.95);
    // A spring of the surface does not creep.
    for _ in 0..100 {
        body.settle_under(&[0.0], 0.0, [0.95 * limit_n, 0.0, press_n], 60.0).unwrap();
    }
    assert!((body.tip_m()[0] - stuck).abs() < 1e-12);
    let slid = pulled(&mut body, 1.2);
    let expected = 0.2 * limit_n / cantilever;
    assert!((slid / expected - 1.0).abs() < 0.02, "{slid} beside {expected}");
    assert!((only(&body)[0] + limit_n).abs() < 1e-2 * limit_n);
    // Without the pull, friction holds the tube bent as far as it can.
    let back = pulled(&mut body, 0.0);
    let held = cantilever * back;
    assert!(back > 0.5 * slid && held < limit_n, "{back} of {slid}");
    assert!((only(&body)[0] - held).abs() < 0.02 * held);
}

#[test]
fn limb_and_solids_turned_as_a_whole_have_the_same_shape() {
    let turn = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.4, -1.9, 0.8));
    let force = Vector3::new(0.4, 0.1, 0.8);
    let tip = |turn: &Isometry3<f64>| {
        let mut body = tube(SPRINGS, turn, Vec::new(), [0.0; 3]);
        let ball = Sphere { center_m: (turn * Point3::new(0.05, 0.01, LENGTH_M + 0.08)).coords, radius_m: 0.06 };
        body.surround(vec![Arc::new(ball)], vec![Ball { plate: 0, place_m: [0.01, 0.0, 0.0], radius_m: 0.03 }]);
        for share in [0.25, 0.5, 0.75, 1.0] {
            body.settle_under(&[0.0], 0.0, (turn * force * share).into(), 1.0).unwrap();
        }
        assert_eq!(body.contacts().len(), 1);
        Point3::from(body.tip_m())
    };
    let apart = turn * tip(&Isometry3::identity()) - tip(&turn);
    assert!(apart.norm() < 1e-8, "{apart}");
}

/// A thing without a tube on a plane through the origin, under gravity.
fn thing(height_m: f64, gravity: [f64; 3]) -> Moving {
    let at = |x: f64, y: f64| Mass { place_m: [x, y, 0.0], kg: 0.2 };
    let masses = vec![at(0.03, 0.0), at(-0.03, 0.02), at(0.0, -0.02)];
    let base = Isometry3::translation(0.0, 0.0, height_m - LENGTH_M);
    let mut body = tube(NOTHING, &base, masses, gravity);
    let table = half_space([0.0, 0.0, 1.0], [0.0; 3]);
    body.surround(vec![table], vec![Ball { plate: 0, place_m: [0.0; 3], radius_m: 0.0 }]);
    Moving::new(body)
}

#[test]
fn thing_that_falls_on_a_table_stays_there() {
    let mut thing = thing(0.2, [0.0, 0.0, -GRAVITY]);
    let (mut highest_m, mut time_s) = (0.0_f64, 0.0);
    while time_s < 1.0 {
        thing.advance_by(&[0.0], 0.0, 0.02, 5e-3).unwrap();
        time_s += 0.02;
        let height_m = thing.body().tip_m()[2];
        // 0.2 m take 0.202 s.
        if time_s < 0.19 {
            assert!((height_m - 0.2 + 0.5 * GRAVITY * time_s * time_s).abs() < 1e-6, "{time_s} s: {height_m}");
        } else if time_s > 0.225 {
            highest_m = highest_m.max(height_m);
        }
    }
    let rest_m = -0.6 * GRAVITY / ACROSS;
    assert!(highest_m < 5e-4, "it jumps by {highest_m} m");
    assert!((thing.body().tip_m()[2] - rest_m).abs() < 1e-8 && thing.kinetic_j(0.0) < 1e-12);
    assert!((only(thing.body())[2] - 0.6 * GRAVITY).abs() < 1e-6);
}

#[test]
fn thing_on_a_slope_stays_or_slides_by_coulombs_law() {
    let run = |slope: f64, seconds: usize| {
        let (sine, cosine) = f64::atan(slope).sin_cos();
        let mut thing = thing(0.0, [GRAVITY * sine, 0.0, -GRAVITY * cosine]);
        let second = |_| {
            for _ in 0..50 {
                thing.advance_by(&[0.0], 0.0, 0.02, 5e-3).unwrap();
            }
            thing.body().tip_m()[0]
        };
        ((0..seconds).map(second).collect::<Vec<_>>(), GRAVITY * (sine - FRICTION * cosine))
    };
    let (stays_m, _) = run(0.45, 10);
    // The surface bears it from the second step on.
    assert!(stays_m[0] < 5e-4 && (stays_m[9] - stays_m[0]).abs() < 1e-9, "{stays_m:?}");
    let (at_m, rate) = run(0.7, 3);
    let measured = at_m[2] - 2.0 * at_m[1] + at_m[0];
    assert!((measured / rate - 1.0).abs() < 1e-3, "{measured} m/s2 beside {rate}");
}

#[test]
fn table_bears_an_object_until_it_is_lifted() {
    let base = Isometry3::from_parts(
        nalgebra::Translation3::new(0.0, 0.0, 0.5),
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
    );
    let mut body = tube(SPRINGS, &base, Vec::new(), [0.0, 0.0, -GRAVITY]);
    // The tip is 0.2 m above the floor: the object is 5 mm too long for it, and is grasped that much higher.
    body.surround(vec![half_space([0.0, 0.0, 1.0], [0.0; 3])], Vec::new());
    body.settle(&[0.0], 0.0, 1.0).unwrap();
    let object = Hanging { above_m: 0.02, below_m: 0.205, radius_m: 0.03 };
    body.carry(Some(object));
    let kg = 0.5;
    body.settle(&[0.0], kg, 1.0).unwrap();
    let tube_n_per_m = SPRINGS.axial_n / LENGTH_M;
    let borne_n = kg * GRAVITY / (1.0 + tube_n_per_m / ACROSS);
    assert!((only(&body)[2] - borne_n).abs() < 1e-6, "{:?} beside {borne_n}", only(&body));
    // A pressure that shortens the tube lifts it off: `by_pressure` is a strain a pascal.
    let strain = 1.1 * kg * GRAVITY / SPRINGS.axial_n;
    body.settle(&[-strain / SPRINGS.by_pressure], kg, 1.0).unwrap();
    assert!(body.contacts().is_empty());
    let expected = 0.5 - LENGTH_M * (1.0 - strain + kg * GRAVITY / SPRINGS.axial_n);
    assert!((body.tip_m()[2] - expected).abs() < 1e-9);
    body.carry(None);
    body.settle(&[0.0], 0.0, 1.0).unwrap();
    assert!((body.tip_m()[2] - 0.2).abs() < 1e-9 && body.contacts().is_empty());
}
