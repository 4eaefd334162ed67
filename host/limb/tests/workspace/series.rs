//! Segments in series: one pressure, several arcs.

use fra_model::{Load, Series};
use nalgebra::Isometry3;
use softlimb_limb::Limb;
use softlimb_limb::workspace::{Command, Points, Workspace, extents, sample, sample_single};
use softlimb_scene::{Scene, parse};

use crate::workspace::{Stream, text_with};

const STRAIGHT: &str = "[[module.segments]]\nmotion = \"extension\"\nlength = \"70 mm\"\nwinding = \"hoops\"\n";
const TWISTING: &str = "[[module.segments]]\nmotion = \"twisting\"\nlength = \"90 mm\"\nwinding = \"helix\"\n";
const BENDING: &str = "[[module.segments]]\nmotion = \"bending\"\nlength = \"80 mm\"\n";
const ASIDE: &str = "[[module.segments]]\nmotion = \"bending\"\nlength = \"50 mm\"\nbend_direction = \"70 deg\"\n";

/// A bending series at 25 deg about the axis, in which every motion occurs, before an ordinary extending bundle.
fn of_four() -> (Scene, Limb) {
    let series = format!("mount_angle = \"25 deg\"\n{STRAIGHT}{TWISTING}{BENDING}{ASIDE}");
    let text = text_with(&[("bending", 1, &series), ("extension", 3, "")]);
    made(&text.replacen("length = \"240 mm\"\n", "", 1))
}

fn made(text: &str) -> (Scene, Limb) {
    let scene = parse(text, "test.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let limb = Limb::new(&scene).expect("a limb");
    (scene, limb)
}

/// The polynomials against `fra_model::Series`, which solves the segments together and composes their screws by itself.
#[test]
fn series_in_a_workspace_has_the_tips_of_its_segments() {
    let (scene, limb) = of_four();
    let space = Workspace::new(&limb, Command::Modules).expect("a workspace");
    assert_eq!(space.axes().len(), 2);
    let firsts: Vec<usize> = space.tables().iter().map(|table| table.first_axis).collect();
    assert_eq!(firsts, [0, 0, 0, 0, 1]);
    let actuators: Vec<_> = limb.modules()[0].segments().iter().map(|segment| segment.actuator).collect();
    let series = Series::new(&actuators).expect("one tube");
    let directions = [0.0, 0.0, 25.0, 95.0_f64].map(|direction: f64| direction.to_radians());
    let bundle = &limb.modules()[1];
    let mut random = Stream(7);
    for _ in 0..200 {
        let shares = [random.next(), random.next()];
        let mut states = Vec::new();
        let pressure_pa = shares[0] * space.axes()[0].pressure_max_pa;
        let solved =
            series.forward_each(pressure_pa, &Load::none(), |_, one| states.push(one.state)).expect("in range");
        assert_eq!(solved.status, fra_model::Status::Solved);
        let shapes = states.into_iter().zip(directions);
        let behind = series.tip_pose(&Isometry3::identity(), shapes);
        let long = bundle.actuator.forward(shares[1] * space.axes()[1].pressure_max_pa, &Load::none()).expect("finite");
        let tip = limb.base() * behind * nalgebra::Point3::new(0.0, 0.0, 0.24 * long.state.axial_stretch);
        let off = |found: [f64; 3]| (nalgebra::Point3::from(found) - tip).norm();
        assert!(off(space.tip(&shares)) < 1e-8, "{shares:?}: {:e}", off(space.tip(&shares)));
        assert!(off(space.tip_by_the_model(&shares).expect("an equilibrium")) < 1e-8);
    }
    let [double, single] = [
        sample(&space, Points::Faces, 3000, 5, 2),
        sample_single(&space, Points::Faces, 3000, 5, 2).iter().map(|tip| tip.map(f64::from)).collect(),
    ];
    for (double, single) in double.iter().zip(&single) {
        assert!(double.iter().zip(single).all(|(a, b)| (a - b).abs() < 5e-6), "{double:?} {single:?}");
    }
    assert!(scene.require_no_segments("nothing").is_err());
}

/// Two halves of one winding are the whole.
#[test]
fn workspace_of_equal_segments_is_that_of_one() {
    let halves = "[[module.segments]]\nmotion = \"bending\"\nlength = \"120 mm\"\n".repeat(2);
    let text = text_with(&[("bending", 1, &halves), ("twisting", 1, "")]);
    let (_, several) = made(&text.replacen("length = \"240 mm\"\n", "", 1));
    let (_, one) = made(&text_with(&[("bending", 1, ""), ("twisting", 1, "")]));
    let [several, one] = [&several, &one].map(|limb| {
        let space = Workspace::new(limb, Command::Modules).expect("a workspace");
        extents(&space).expect("extents").of.map(|pair| pair.map(|reach| reach.value_m))
    });
    for (several, one) in several.iter().flatten().zip(one.iter().flatten()) {
        assert!((several - one).abs() < 1e-8, "{several} {one}");
    }
}
