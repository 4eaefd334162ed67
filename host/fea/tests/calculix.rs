//! Runs of CalculiX itself, held to other methods: the thick-wall equations of `fra-model` and the section finite elements.
//!
//! They need the program `ccx` (Debian, Ubuntu: apt-get install calculix-ccx). Without it they say that they are skipped; where the
//! variable CI is set they fail. `--nocapture` shows what was found.

use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::Instant;

use crate::fem::sample::{plain, wound};
use fra_model::{Actuator, ActuatorParameters, Arrangement, Families, Fiber, Load, Material, Motion};
use softlimb_fea::axisymmetric::{Thread, thread_sheet};
use softlimb_fea::cross_section::{EndLoad, Section};
use softlimb_fea::solid as fem;
use softlimb_fea::solid::{End, FiberModel, Options, PointStatus, Rates, Run, Runner, Subject};

/// One run at a time: each wants a core and memory of its own.
static TURN: Mutex<()> = Mutex::new(());

/// Whether there is a CalculiX. Continuous integration must have it, or nobody would notice.
fn is_installed() -> bool {
    let mut command = Command::new("ccx");
    let found = command.arg("-v").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found || !ci, "CI is set and CalculiX is missing: apt-get install calculix-ccx");
    if !found {
        // The thread of a test has its name. Not by the macro, whose output a test that passes does not show.
        let thread = std::thread::current();
        let name = thread.name().unwrap_or("a test of CalculiX");
        let _ =
            writeln!(std::io::stderr(), "skipped: {name}; CalculiX is missing (Debian: apt-get install calculix-ccx)");
    }
    found
}

fn run(subject: Subject, options: Options, pressures_pa: &[f64]) -> Run {
    let _turn = TURN.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let begin = Instant::now();
    let clock = || begin.elapsed().as_secs_f64();
    let runner = Runner { timeout_s: 3600.0, ..Runner::default() };
    let run = fem::run(&subject, &options, pressures_pa, &runner, &clock, &mut |_| {}).expect("a run");
    println!(
        "{:?} {:?}: {} nodes, {} increments, {} iterations, {:.1} s, {:?}",
        subject.parameters.motion,
        options.fibers,
        run.model.nodes(),
        run.increments,
        run.iterations,
        run.seconds,
        run.end
    );
    run
}

/// Runs a single actuator and gives the middle at each pressure, all of which must converge.
fn middle(parameters: ActuatorParameters<f64>, options: Options, pressures_pa: &[f64]) -> Vec<Rates> {
    let run = run(Subject::single(parameters), options, pressures_pa);
    assert_eq!(run.end, End::Finished);
    run.points.iter().map(|point| point.middle.expect("converged")).collect()
}

/// The same by the thick-wall equations.
fn thick_wall(parameters: ActuatorParameters<f64>, pressure_pa: f64) -> Rates {
    let state = Actuator::new(&parameters).unwrap().forward(pressure_pa, &Load::none()).unwrap().state;
    Rates {
        axial_stretch: state.axial_stretch,
        outer_radius_m: state.outer_radius_m,
        inner_radius_m: state.inner_radius_m,
        twist_rate_rad_per_m: state.twist_rad / parameters.length_m,
        bend_rate_rad_per_m: 0.0,
    }
}

/// Says what was found and holds it to a bar, both relative.
#[track_caller]
fn hold(what: &str, found: f64, expected: f64, bar: f64) {
    let off = found / expected - 1.0;
    println!("  {what}: {found:.6} against {expected:.6}, off by {:.3} %, bar {:.1} %", 100.0 * off, 100.0 * bar);
    assert!(off.abs() <= bar, "{what}: {found} against {expected}");
}

#[test]
fn plain_tube_grows_as_the_thick_wall_equations_say() {
    if !is_installed() {
        return;
    }
    let yeoh = Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1466.1] };
    for material in [plain(Motion::Expansion).material, yeoh] {
        let parameters = ActuatorParameters { material, ..plain(Motion::Expansion) };
        let pressures = [20e3, 35e3];
        for (found, pressure) in middle(parameters, Options::default(), &pressures).iter().zip(pressures) {
            let exact = thick_wall(parameters, pressure);
            hold("growth outside, mm", 1e3 * found.outer_radius_m - 8.0, 1e3 * exact.outer_radius_m - 8.0, 3e-3);
            hold("growth inside, mm", 1e3 * found.inner_radius_m - 6.0, 1e3 * exact.inner_radius_m - 6.0, 3e-3);
        }
    }
}

#[test]
fn smeared_windings_extend_expand_and_twist_as_the_thick_wall_equations_say() {
    if !is_installed() {
        return;
    }
    let options = Options { increment: Some(0.25), ..Options::default() };
    let extension = wound(Motion::Extension, 3.0, Families::Two);
    for (found, pressure) in middle(extension, options, &[20e3, 40e3]).iter().zip([20e3, 40e3]) {
        let exact = thick_wall(extension, pressure);
        hold("extension, axial strain", found.axial_stretch - 1.0, exact.axial_stretch - 1.0, 1e-2);
    }
    let expansion = wound(Motion::Expansion, 80.0, Families::Two);
    let found = middle(expansion, options, &[20e3])[0];
    let exact = thick_wall(expansion, 20e3);
    hold("expansion, growth outside, mm", 1e3 * found.outer_radius_m - 8.0, 1e3 * exact.outer_radius_m - 8.0, 1e-2);
    hold("expansion, axial strain", found.axial_stretch - 1.0, exact.axial_stretch - 1.0, 1e-2);
    let twisting = wound(Motion::Twisting, 30.0, Families::One);
    let options = Options { along: Some(14), bulk_ratio: 1000.0, ..options };
    let found = middle(twisting, options, &[10e3])[0];
    let exact = thick_wall(twisting, 10e3);
    hold("twist rate, rad/m", found.twist_rate_rad_per_m, exact.twist_rate_rad_per_m, 1e-2);
}

#[test]
fn smeared_winding_bends_as_the_section_says() {
    if !is_installed() {
        return;
    }
    let bending = wound(Motion::Bending, 3.0, Families::Two);
    let options =
        Options { around: Some(16), along: Some(16), bulk_ratio: 1000.0, increment: Some(0.25), ..Options::default() };
    let found = middle(bending, options, &[20e3])[0];
    let section = Section::new(&bending, &Default::default()).unwrap();
    let curve = section.curve(&[20e3], &EndLoad::default()).unwrap();
    let state = curve.answers[0].equilibrium().expect("an equilibrium").state;
    hold("bend rate, rad/m", found.bend_rate_rad_per_m, state.bend_rates_rad_per_m[0], 1e-2);
    hold("strain of the axis", found.axial_stretch - 1.0, state.axial_stretch - 1.0, 1.5e-2);
}

#[test]
fn threads_close_to_each_other_do_what_the_sheet_does() {
    if !is_installed() {
        return;
    }
    // Under half a millimetre of cover, on 2 mm of wall: helices three quarters of it apart, rings one half.
    let covered = |motion, angle| ActuatorParameters {
        outer_radius_m: 8.5e-3,
        length_m: 40e-3,
        ..wound(motion, angle, Families::One)
    };
    let threads = |mm: f64| Options {
        fibers: FiberModel::Threads { spacing_m: Some(mm * 1e-3) },
        increment: Some(0.25),
        ..Options::default()
    };
    let helices = covered(Motion::Twisting, 30.0);
    let found = middle(helices, threads(1.5), &[10e3])[0];
    let exact = thick_wall(helices, 10e3);
    hold("helices, twist rate, rad/m", found.twist_rate_rad_per_m, exact.twist_rate_rad_per_m, 3e-2);
    let rings = covered(Motion::Extension, 0.0);
    let found = middle(rings, threads(1.0), &[20e3])[0];
    let exact = thick_wall(rings, 20e3);
    hold("rings, axial strain", found.axial_stretch - 1.0, exact.axial_stretch - 1.0, 3e-2);
}

/// Two families that cross, two thirds of the wall apart on its very surface, against the sheet by the section finite elements.
#[test]
fn double_helix_of_threads_does_what_the_sheet_does() {
    if !is_installed() {
        return;
    }
    let crossing = ActuatorParameters { length_m: 40e-3, ..wound(Motion::Extension, 3.0, Families::Two) };
    let options = Options {
        fibers: FiberModel::Threads { spacing_m: Some(1.31e-3) },
        around: Some(16),
        increment: Some(0.25),
        ..Options::default()
    };
    let pressures_pa = [20e3];
    let run = run(Subject::single(crossing), options, &pressures_pa);
    assert_eq!(run.end, End::Finished);
    let spacing_m = run.model.thread_spacing_m().expect("threads");
    println!("  {:.3} mm apart", 1e3 * spacing_m);
    assert!(spacing_m <= 0.75 * 2e-3, "{spacing_m}");
    let section = Section::new(&crossing, &Default::default()).unwrap();
    let curve = section.curve(&pressures_pa, &EndLoad::default()).unwrap();
    for (point, answer) in run.points.iter().zip(&curve.answers) {
        let (found, state) = (point.middle.expect("converged"), answer.equilibrium().expect("an equilibrium").state);
        hold("double helix, axial strain", found.axial_stretch - 1.0, state.axial_stretch - 1.0, 3e-2);
    }
}

/// Rings three quarters of the wall apart, between which the wall bulges, against the strain that one period of wall and thread has by
/// finite elements of the half-plane.
#[test]
fn distant_rings_do_what_the_period_of_a_thread_says() {
    if !is_installed() {
        return;
    }
    let rings =
        ActuatorParameters { outer_radius_m: 8.5e-3, length_m: 40e-3, ..wound(Motion::Extension, 0.0, Families::One) };
    let fibers = FiberModel::Threads { spacing_m: Some(1.5e-3) };
    let run = run(Subject::single(rings), Options { fibers, increment: Some(0.25), ..Options::default() }, &[20e3]);
    let found = run.points[0].middle.expect("converged");
    let spacing_m = run.model.thread_spacing_m().expect("threads");
    let fiber = rings.fiber.expect("wound");
    let stiffness_n = 4.0 * fiber.modulus_pa * fiber.thickness_m * spacing_m;
    let thread = Thread { stiffness_n, spacing_m, width_m: 0.18e-3 };
    let sheet = thread_sheet(&rings, &thread, 20e3).expect("an equilibrium");
    hold("distant rings, axial strain", found.axial_stretch - 1.0, sheet.strain, 3e-2);
    // What the distance costs against the sheet, for the description.
    let off = (found.axial_stretch - 1.0) / (thick_wall(rings, 20e3).axial_stretch - 1.0) - 1.0;
    println!("  {:.3} mm apart, against the sheet: off by {:.2} %", 1e3 * spacing_m, 100.0 * off);
}

#[test]
fn pressure_beyond_the_limit_point_gets_no_figures() {
    if !is_installed() {
        return;
    }
    let actuator = Actuator::new(&plain(Motion::Expansion)).unwrap();
    let limit = actuator.forward(90e3, &Load::none()).unwrap().limit_pressure_pa.expect("a limit point");
    let run = run(Subject::single(plain(Motion::Expansion)), Options::default(), &[30e3, 90e3]);
    assert_eq!(run.points[0].status, PointStatus::Converged);
    assert!(run.points[1].middle.is_none() && run.points[1].ends.is_none());
    match run.points[1].status {
        PointStatus::NotReached { reached_pa } => hold("pressure reached, Pa", reached_pa, limit, 0.03),
        PointStatus::BeyondJump { between_pa: [low, high] } => assert!(low < limit && limit < high, "{low} {high}"),
        PointStatus::Converged => panic!("a figure beyond the limit"),
    }
}

#[test]
fn bundle_extends_like_one_of_its_actuators() {
    if !is_installed() {
        return;
    }
    let parameters = ActuatorParameters { length_m: 40e-3, ..wound(Motion::Extension, 3.0, Families::Two) };
    let options = Options {
        radial: Some(1),
        around: Some(8),
        along: Some(8),
        bulk_ratio: 1000.0,
        increment: Some(0.5),
        ..Options::default()
    };
    let bundle = run(
        Subject { actuators: 3, arrangement: Arrangement::Circle { radius_m: 10e-3 }, ..Subject::single(parameters) },
        options,
        &[10e3],
    );
    let single = run(Subject::single(parameters), options, &[10e3]);
    let ends = [&bundle, &single].map(|run| run.points[0].ends.expect("converged"));
    hold("strain between the ends", ends[0].axial_stretch - 1.0, ends[1].axial_stretch - 1.0, 1e-2);
    assert!(ends[0].bend_angle_rad.abs() < 1e-3, "{ends:?}");
}

/// Hoops with a soft helix, and a bender with hoops and a soft pair of helices.
#[test]
fn two_windings_move_as_the_section_says() {
    if !is_installed() {
        return;
    }
    let soft = |angle_deg: f64, families, modulus_pa| Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa,
        ..wound(Motion::Bending, 3.0, Families::Two).fiber.unwrap()
    };
    let of_section = |parameters: &ActuatorParameters<f64>, second: &Fiber<f64>, pressure_pa: f64| {
        let section = Section::with_two_windings(parameters, second, &Default::default()).unwrap();
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        curve.answers[0].equilibrium().expect("an equilibrium").state
    };
    let middle = |parameters, second, options, pressure_pa| {
        let run = run(Subject::single(parameters).with_second_fiber(Some(second)), options, &[pressure_pa]);
        assert_eq!(run.end, End::Finished);
        run.points[0].middle.expect("converged")
    };
    // Hoops are not shortened by the twist: CalculiX has fibers that carry no compression.
    let twisting = wound(Motion::Twisting, 0.0, Families::One);
    let helix = soft(45.0, Families::One, 5e6);
    let options = Options { along: Some(14), bulk_ratio: 1000.0, ..Options::default() };
    let (found, state) = (middle(twisting, helix, options, 20e3), of_section(&twisting, &helix, 20e3));
    hold("twist rate, rad/m", found.twist_rate_rad_per_m, state.twist_rate_rad_per_m, 1e-2);
    hold("axial strain", found.axial_stretch - 1.0, state.axial_stretch - 1.0, 1e-2);
    let alone = thick_wall(twisting, 20e3);
    assert!(alone.axial_stretch - 1.0 > 1.05 * (found.axial_stretch - 1.0), "{alone:?} {found:?}");

    let bending = wound(Motion::Bending, 3.0, Families::Two);
    let pair = soft(40.0, Families::Two, 5e6);
    let options =
        Options { around: Some(16), along: Some(16), bulk_ratio: 1000.0, increment: Some(0.25), ..Options::default() };
    let (found, state) = (middle(bending, pair, options, 20e3), of_section(&bending, &pair, 20e3));
    hold("bend rate, rad/m", found.bend_rate_rad_per_m, state.bend_rates_rad_per_m[0], 1e-2);
    let alone = Section::new(&bending, &Default::default()).unwrap().curve(&[20e3], &EndLoad::default()).unwrap();
    let alone = alone.answers[0].equilibrium().expect("an equilibrium").state.bend_rates_rad_per_m[0];
    assert!(alone > 1.1 * found.bend_rate_rad_per_m, "{alone} {found:?}");
}
