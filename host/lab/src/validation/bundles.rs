//! `softlimb-lab bundles`: one bundle of each kind by CalculiX, beside one of its actuators and the model of tubes between plates.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use fra_model::{Actuator, ActuatorParameters, Arrangement, Families, Fiber, Material, Motion, Placement};
use softlimb::cli::{Failure, Outcome, say};
use softlimb_fea::solid::{Ends, Options, Runner, Subject, SymmetryUse, run};
use softlimb_limb::statics::{Bundle, Spring};

/// Actuators of a bundle, inner and outer radius, length, m: plates at both ends alone.
const COUNT: u8 = 3;
const SIZE_M: [f64; 3] = [10e-3, 14e-3, 120e-3];
/// Largest difference of the shares, of the finite elements' own.
const BAR: f64 = 0.03;

/// A kind: name, motion, fiber angle from the hoop, families, places and gauge pressure, Pa.
type Kind = (&'static str, Motion, f64, Families, Arrangement<f64>, f64);

const CIRCLE: Arrangement<f64> = Arrangement::Circle { radius_m: 30e-3 };
const KINDS: [Kind; 3] = [
    ("extension on a circle", Motion::Extension, 3.0, Families::Two, CIRCLE, 20e3),
    ("bending in a row", Motion::Bending, 3.0, Families::Two, Arrangement::Row { spacing_m: 30e-3 }, 4e3),
    ("twisting on a circle", Motion::Twisting, 28.0, Families::One, CIRCLE, 5e3),
];

/// Compare one bundle of each kind with one of its actuators, by CalculiX and by tubes between plates
#[derive(Args)]
#[command(after_help = "Needs CalculiX (Debian, Ubuntu: apt-get install calculix-ccx) and about ten minutes.")]
pub(crate) struct Bundles {
    /// The program
    #[arg(long, value_name = "PATH", default_value = "ccx")]
    ccx: PathBuf,
    /// Elements around a tube and along it, AROUND,ALONG
    #[arg(long, value_name = "N,N", value_delimiter = ',', num_args = 1, default_value = "8,12")]
    mesh: Vec<u32>,
}

/// A deformation of one and of the bundle.
struct Row {
    name: &'static str,
    one: f64,
    all: f64,
    share: f64,
}

impl Row {
    /// Difference of the model's share from that of the finite elements.
    fn off(&self) -> f64 {
        self.share * self.one / self.all - 1.0
    }
}

impl Bundles {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let rows = KINDS.iter().map(|kind| self.row(kind)).collect::<Result<Vec<_>, _>>()?;
        let mut text = String::from(
            "\n| bundle of three | one, CalculiX | bundle, CalculiX | share | share, tubes between plates | difference |\n\
             | --- | --: | --: | --: | --: | --: |\n",
        );
        for row in &rows {
            let Row { name, one, all, share } = row;
            let percent = [100.0 * all / one, 100.0 * share, 100.0 * row.off()];
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "| {name} | {one:.5} | {all:.5} | {:.1} % | {:.1} % | {:+.1} % |",
                percent[0], percent[1], percent[2]
            );
        }
        say(&text)?;
        let within = rows.iter().all(|row| row.off().abs() <= BAR);
        Ok(if within { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn row(&self, (name, motion, angle_deg, families, arrangement, pressure_pa): &Kind) -> Result<Row, Failure> {
        let &[around, along] = &self.mesh[..] else {
            return Err(Failure::wrong_line("--mesh: two numbers are required, AROUND,ALONG"));
        };
        let parameters = parameters(*motion, *angle_deg, *families);
        let options = Options {
            symmetry: SymmetryUse::Whole,
            radial: Some(1),
            around: Some(around),
            along: Some(along),
            bulk_ratio: 1000.0,
            increment: Some(0.5),
            ..Options::default()
        };
        let runner = Runner { ccx: self.ccx.clone(), timeout_s: 3600.0, ..Runner::default() };
        let single = Subject::single(parameters);
        let bundle = Subject { actuators: COUNT, arrangement: *arrangement, ..single };
        let solved = |subject: &Subject| -> Result<f64, Failure> {
            let begin = Instant::now();
            let clock = || begin.elapsed().as_secs_f64();
            let found = run(subject, &options, &[*pressure_pa], &runner, &clock, &mut |_| {})?;
            let ends =
                found.points[0].ends.ok_or_else(|| Failure::new(format!("{name}: CalculiX did not converge")))?;
            Ok(deformation(*motion, &ends))
        };
        let share = share(&parameters, *arrangement, *pressure_pa)
            .ok_or_else(|| Failure::new(format!("{name}: the bundle has no equilibrium")))?;
        Ok(Row { name, one: solved(&single)?, all: solved(&bundle)?, share })
    }
}

fn parameters(motion: Motion, angle_deg: f64, families: Families) -> ActuatorParameters<f64> {
    let [inner_radius_m, outer_radius_m, length_m] = SIZE_M;
    let fiber = Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: outer_radius_m,
    };
    let material = Material::NeoHookean { shear_modulus_pa: 0.223e6 };
    // A scene's bender without a winding is wound at its outer radius.
    let fiber = (motion != Motion::Bending).then_some(fiber);
    ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m, material, fiber }
}

/// Strain, bend or twist between the ends.
fn deformation(motion: Motion, ends: &Ends) -> f64 {
    match motion {
        Motion::Extension | Motion::Expansion => ends.axial_stretch - 1.0,
        Motion::Bending => ends.bend_angle_rad,
        Motion::Twisting => ends.twist_rad,
    }
}

/// The share of its actuators' deformation that the model gives a bundle.
fn share(parameters: &ActuatorParameters<f64>, arrangement: Arrangement<f64>, pressure_pa: f64) -> Option<f64> {
    let spring = Spring::new(&Actuator::new(parameters).ok()?, pressure_pa)?;
    let tubes = arrangement.positions_m(COUNT).map(|place| (place, spring.clone())).collect();
    let (free, tube) = (Bundle::of_springs(parameters.motion, tubes, parameters.length_m)?.free, spring.tangent());
    Some(match parameters.motion {
        Motion::Extension | Motion::Expansion => (free.stretch - 1.0) / (tube.stretch - 1.0),
        Motion::Bending => free.bend_rad_per_m[0] / tube.bend_rad_per_m,
        Motion::Twisting => free.twist_rad_per_m / tube.twist_rad_per_m,
    })
}
