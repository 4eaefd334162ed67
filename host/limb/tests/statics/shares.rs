//! Shares of the free bend that bundles of bending actuators reach between plates.

use fra_model::Arrangement;
use softlimb_limb::Limb;
use softlimb_limb::statics::{BendShare, Bundle, Tangent};
use softlimb_scene::{Scene, parse};

/// A bending actuator of the scenes: its line is a hundred times as stiff as its wall.
fn tube() -> Tangent {
    Tangent {
        stretch: 1.06,
        bend_rad_per_m: 4.0,
        twist_rad_per_m: 0.0,
        axial_n: 26_900.0,
        bending_nm2: 0.073,
        across_nm2: 0.02,
        torsion_nm2: 0.01,
        coupling_nm: 0.0,
        shear_n: 33.0,
        outer_radius_m: 0.014,
    }
}

fn share(arrangement: Arrangement<f64>, count: u8) -> BendShare {
    let positions_m: Vec<[f64; 2]> = arrangement.positions_m(count).collect();
    BendShare::of(&positions_m, &tube()).expect("it bends")
}

/// Springs of the strips, of stiffness `K` at the heights `x` about their mean, beside `B` of each tube: `B / (B + K mean(x^2))`, and on a
/// circle of radius `a` the mean square of the heights is `a^2/2` for three tubes and more, `a^2` for two.
#[test]
fn circles_bend_by_the_closed_form_of_their_strips() {
    let (k, b) = (tube().axial_n, tube().bending_nm2);
    for (count, part) in [(2, 1.0), (3, 0.5), (4, 0.5), (6, 0.5), (9, 0.5)] {
        for radius_m in [0.03, 0.05] {
            let expected = b / (b + k * part * radius_m * radius_m);
            let found = share(Arrangement::Circle { radius_m }, count).held;
            assert!((found / expected - 1.0).abs() < 1e-9, "{count} {radius_m}: {found} {expected}");
        }
    }
}

/// Three on a circle whose first line is slack: two stiff springs at `-a/2`, a soft one at `a`. About their common centroid the sum of
/// `k_i k_j (x_i - x_j)^2` over pairs, by the sum of `k`, is the stiffness that the plates add.
#[test]
fn slack_line_leaves_its_wall() {
    let (k, b, a) = (tube().axial_n, tube().bending_nm2, 0.03);
    let wall = k / 100.0;
    let added = 2.0 * k * wall * (1.5 * a) * (1.5 * a) / (2.0 * k + wall);
    let expected = 3.0 * b / (3.0 * b + added);
    let found = share(Arrangement::Circle { radius_m: a }, 3);
    assert!((found.slack / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    assert!(found.held < 0.01 && found.slack < 0.5, "{found:?}");
}

#[test]
fn rows_bend_as_one_actuator() {
    for count in 1..=9 {
        let found = share(Arrangement::Row { spacing_m: 0.03 }, count);
        assert!((found.held - 1.0).abs() < 5e-3 && (found.slack - 1.0).abs() < 5e-3, "{count} {found:?}");
    }
}

const CIRCLE: &str = "circle_radius = \"30 mm\"";
const ROW: &str = "arrangement = \"row\"\nspacing = \"30 mm\"";

fn scene(places: &str, count: u8) -> Scene {
    let text = format!(
        "format = 1\nname = \"bent\"\nlimb.connector = {{ length = 0, mass = 0 }}\n\
         materials.silicone = {{ law = \"neo-hookean\", shear_modulus = \"0.223 MPa\" }}\n\
         [[module]]\nname = \"elbow\"\nmotion = \"bending\"\nactuators = {count}\n{places}\n\
         inner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\nmaterial = \"silicone\"\n\
         [[phase]]\nname = \"p\"\nduration = 1\ntargets = {{ elbow = {{ pressure = \"20 kPa\" }} }}\n\
         [limits]\npressure_max = \"100 kPa\"\n"
    );
    parse(&text, "bent.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The bundle of the statics has the shape of one of its tubes, and is stiffer by their number in the plane.
#[test]
fn bundle_of_a_row_has_the_shape_of_its_tubes() {
    let limb = Limb::new(&scene(ROW, 3)).expect("a row bends");
    let module = &limb.modules()[0];
    let alone = Tangent::of(&module.actuator, 40e3).expect("an equilibrium");
    let bundle = Bundle::new(module, &[40e3; 3], 1).expect("an equilibrium");
    assert!((bundle.free.bend_rad_per_m[0] / alone.bend_rad_per_m - 1.0).abs() < 5e-3, "{:?}", bundle.free);
    assert!(bundle.free.bend_rad_per_m[1].abs() < 1e-12 && (bundle.free.stretch - alone.stretch).abs() < 1e-12);
    // A bend that the strips' length leaves free, since the axis stretches with it.
    let [whole, mixed, axial] = [(1, 1), (0, 1), (0, 0)].map(|at: (usize, usize)| bundle.stiffness[at]);
    assert!(((whole - mixed * mixed / axial) / (3.0 * alone.bending_nm2) - 1.0).abs() < 1e-9);
    assert!((-mixed / axial / module.actuator.parameters().outer_radius_m - 1.0).abs() < 1e-12);
    // Across, the walls of the outer two at 30 mm; the line of one is a hundred times as stiff as its wall.
    let across = 3.0 * alone.across_nm2 + 2.0 * alone.axial_n / 100.0 * 0.03 * 0.03;
    assert!((bundle.stiffness[(2, 2)] / across - 1.0).abs() < 1e-12);
}

#[test]
fn circle_of_benders_is_refused_at_its_module() {
    let error = Limb::new(&scene(CIRCLE, 3)).expect_err("held").render(false);
    for part in [
        "error: the bending actuators of `elbow` hold each other",
        "bent.toml:5:",
        "% of the free bend",
        "`arrangement = \"row\"` with a `spacing` from 28.000 mm on, or `actuators = 1`",
    ] {
        assert!(error.contains(part), "{part}: {error}");
    }
    assert!(Limb::new(&scene("", 1)).is_ok());
}

/// The table of `docs/explanation/bundles.md`.
#[test]
fn table_of_shares_is_that_of_the_page() {
    let page = include_str!("../../../../docs/explanation/bundles.md");
    let limb = Limb::new(&scene("", 1)).expect("one bends");
    let alone = Tangent::of(&limb.modules()[0].actuator, 50e3).expect("an equilibrium");
    let circle = |radius_m| Arrangement::Circle { radius_m };
    let cases = [
        ("circle of 2, radius 30 mm", circle(0.03), 2),
        ("circle of 3, radius 16.2 mm (touching)", circle(0.0162), 3),
        ("circle of 3, radius 30 mm", circle(0.03), 3),
        ("circle of 6, radius 30 mm", circle(0.03), 6),
        ("row of 3, spacing 30 mm", Arrangement::Row { spacing_m: 0.03 }, 3),
        ("one", circle(0.0), 1),
    ];
    let mut missing = Vec::new();
    for (name, arrangement, count) in cases {
        let positions_m: Vec<[f64; 2]> = arrangement.positions_m(count).collect();
        let share = BendShare::of(&positions_m, &alone).expect("it bends");
        let row = format!("| {name} | {:.1} % | {:.0} % |", 100.0 * share.held, 100.0 * share.slack);
        println!("{row}");
        missing.extend((!page.contains(&row)).then_some(row));
    }
    assert!(missing.is_empty(), "not in the page:\n{}", missing.join("\n"));
}
