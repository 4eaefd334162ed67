//! Samples: repeatable, within the extents, convergent; and the cubes they are counted in.

use softlimb_limb::workspace::{
    Command, ExtremeLine, Grid, Points, Workspace, convergence, extents, picture, sample, sample_single,
};

use crate::workspace::{limb_of, limb_with};

#[test]
fn samples_depend_on_the_seed_alone() {
    let (_, limb) = limb_of("weightless-a");
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    for points in [Points::Faces, Points::Even, Points::Random] {
        let one = sample(&space, points, 20_003, 5, 1);
        for threads in [2, 3, 8] {
            assert_eq!(one, sample(&space, points, 20_003, 5, threads));
        }
        assert_eq!(one[..100], sample(&space, points, 100, 5, 2), "more samples go on where fewer end");
        assert_ne!(one[..100], sample(&space, points, 100, 6, 1));
    }
    assert!(sample(&space, Points::Even, 0, 1, 2).is_empty());
}

#[test]
fn samples_stay_within_the_extents_and_come_closer() {
    let (_, limb) = limb_of("weightless-b");
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let found = extents(&space).expect("extents");
    let tips = sample(&space, Points::Faces, 100_000, 1, 2);
    for axis in 0..3 {
        let [least, largest] = &found.of[axis];
        assert!(tips.iter().all(|tip| tip[axis] >= least.value_m - 1e-7 && tip[axis] <= largest.value_m + 1e-7));
    }
    let rows = convergence(&space, &found, &[100, 100_000], 1, 2);
    for set in 0..3 {
        assert!(rows[1].missing[set] < rows[0].missing[set] && rows[1].missing[set] > -1e-6, "{rows:?}");
    }
    assert!(rows[1].missing[2] < 0.7 * rows[1].missing[0], "faces are where the extents are: {rows:?}");
}

/// Single precision has 1e-7 of a metre; differences of lengths over a radius of 3 cm make bends of it, and those move the tip.
#[test]
fn pictures_are_within_micrometres_of_the_samples() {
    let mixed = limb_with(&[
        ("extension", 4, "mount_angle = \"20 deg\""),
        ("bending", 3, "mount_angle = \"70 deg\""),
        ("twisting", 3, ""),
        ("expansion", 2, ""),
        ("extension", 1, ""),
    ]);
    let scenes = ["weightless-a", "weightless-b", "weightless-c"].map(|name| limb_of(name).1);
    let mut worst = 0.0_f64;
    for limb in scenes.iter().chain([&mixed]) {
        for command in [Command::Actuators, Command::Modules] {
            let space = Workspace::new(limb, command).expect("a workspace");
            for points in [Points::Faces, Points::Even, Points::Random] {
                let (single, double) = (sample_single(&space, points, 9001, 3, 1), sample(&space, points, 9001, 3, 1));
                let off = single.iter().flatten().zip(double.iter().flatten()).map(|(a, b)| (f64::from(*a) - b).abs());
                worst = off.fold(worst, f64::max);
                assert_eq!(single, sample_single(&space, points, 9001, 3, 3), "whatever the threads");
                assert_eq!(single[..77], sample_single(&space, points, 77, 3, 1), "whatever the number");
            }
        }
    }
    println!("largest difference of a coordinate between single and double precision: {:.2} um", 1e6 * worst);
    assert!(worst < 5e-6, "{worst:e} m");
}

/// A lattice of points fills a ball: the cubes hold its volume, and too much by a part of its surface.
#[test]
fn cubes_measure_a_ball() {
    let lattice = |side: f64| {
        let count = (0.5 / side).ceil() as i32 + 1;
        let line = (-count..=count).map(move |i| (f64::from(i) + 0.5) * side);
        let points = line.clone().flat_map(move |x| {
            let line = line.clone();
            line.clone().flat_map(move |y| line.clone().map(move |z| [x, y, z]))
        });
        points.filter(|p| p.iter().map(|x| x * x).sum::<f64>() <= 0.25).collect::<Vec<_>>()
    };
    let exact = std::f64::consts::PI / 6.0;
    let points = lattice(0.005);
    let volumes = [0.1, 0.05, 0.025].map(|side| Grid::new(&points, side, 3).volume_m3() / exact - 1.0);
    assert!(
        volumes.windows(2).all(|pair| pair[1] < 0.6 * pair[0]) && volumes[2] > 0.0 && volumes[2] < 0.12,
        "{volumes:?}"
    );
    let disc: f64 = Grid::new(&points, 0.025, 3).depths(1).len() as f64 * 0.025 * 0.025;
    assert!((disc / (std::f64::consts::PI * 0.25) - 1.0).abs() < 0.1);
}

#[test]
fn picture_shows_three_views_and_the_limb_at_its_extremes() {
    let (_, limb) = limb_of("weightless-a");
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let grid = Grid::new(&sample(&space, Points::Faces, 2000, 1, 1), 0.05, space.axes().len());
    let rest: Vec<_> = limb.modules().iter().map(|module| module.curve.states()[0]).collect();
    let found = extents(&space).expect("extents");
    for reach in found.of.iter().flatten() {
        let line = space.line_by_the_model(&reach.pressures_pa).expect("an equilibrium");
        let end = line.last().expect("a point");
        assert!(end.iter().zip(&reach.tip_m).all(|(a, b)| (a - b).abs() < 1e-9), "{end:?} and {:?}", reach.tip_m);
    }
    let highest = space.line_by_the_model(&found.of[2][1].pressures_pa).expect("an equilibrium");
    let svg = picture(
        "arm",
        (&grid, None),
        &limb.backbone(&rest),
        &[ExtremeLine { name: "highest", axis: 2, line_m: highest }],
    );
    let views = ["arm: ", "from the side", "from the front", "from above"];
    assert!(views.iter().all(|view| svg.contains(view)) && !svg.contains("NaN"));
    let wide = Grid::new(&sample(&space, Points::Faces, 4000, 1, 1), 0.05, space.axes().len());
    let over = picture("arm", (&grid, Some(&wide)), &limb.backbone(&rest), &[]);
    // One in each view and one in the key.
    let hatched = |text: &str| text.matches("faint hatched\"").count();
    assert_eq!((hatched(&over), hatched(&svg)), (4, 0), "without load");
    assert!(over.contains(">reachable without load only<") && svg.contains(">limb at an extreme<"));
    assert!(svg.matches(">highest<").count() == 2 && (1..=5).all(|shade| svg.contains(&format!("shade{shade}\""))));
}

#[test]
fn tips_on_a_plane_or_a_surface_fill_no_volume() {
    let lattice = |height: &dyn Fn(f64, f64) -> f64| {
        let line = || (0..40).map(|i| 0.01 * f64::from(i));
        line().flat_map(|x| line().map(move |y| [x, y, height(x, y)])).collect::<Vec<_>>()
    };
    // Of no axis, and in single precision as the samples are.
    let tilted = lattice(&|x, y| 0.3 * x - 0.7 * y).into_iter().map(|tip| tip.map(|x| x as f32)).collect::<Vec<_>>();
    assert_eq!(Grid::new(&tilted, 0.02, 3).volume_m3(), 0.0);
    let dome = lattice(&|x, y| x * y);
    assert_eq!(Grid::new(&dome, 0.02, 2).volume_m3(), 0.0);
    assert!(Grid::new(&dome, 0.02, 3).volume_m3() > 0.0);
}

#[test]
fn depths_count_the_cubes_behind_each_other() {
    let tips = [[0.5, 0.5, 0.5], [0.5, 1.5, 0.5], [0.5, 3.5, 0.5], [2.5, 0.5, 1.5], [0.6, 0.6, 0.6]];
    let grid = Grid::new(&tips, 1.0, 3);
    assert_eq!(grid.depths(1), [([0.5, 0.5], 3), ([2.5, 1.5], 1)]);
    assert_eq!(grid.depths(2), [([0.5, 0.5], 1), ([0.5, 1.5], 1), ([0.5, 3.5], 1), ([2.5, 0.5], 1)]);
}
