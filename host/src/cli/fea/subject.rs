//! Which actuator becomes a model, and how.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::super::Failure;
use super::super::shared::{about, above_zero, quantity};
use crate::query as eval;
use softlimb_fea::solid::{FemError, FiberModel, Model, Options, Subject, SymmetryUse};
use softlimb_files::range::OutOfRange;
use softlimb_scene as scene;
use softlimb_scene::{Module, Quantity, Scene};

/// Arguments that `export` and `run` share.
#[derive(Args)]
pub(super) struct Arguments {
    /// The scene file; or NAME.json with one actuator and its highest pressure: a forward question as `eval --batch` takes it
    #[arg(value_name = "SCENE|ACTUATOR")]
    file: PathBuf,
    /// The module whose actuator is modelled [default: the first]
    #[arg(long, value_name = "NAME")]
    module: Option<String>,
    /// Model all actuators of the module side by side, with the connector that joins their ends
    #[arg(long)]
    bundle: bool,
    /// Highest gauge pressure, above 0, at most 100000 kPa [default: the module's]
    #[arg(long, value_name = "KPA", value_parser = above_zero("kPa", 1e5))]
    pressure: Option<Quantity>,
    /// Number of pressures, evenly up to the highest
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=200))]
    points: u16,
    /// Fibers as a material or as threads [default: threads with --spacing, else smeared]
    #[arg(long, value_enum)]
    fibers: Option<Fibers>,
    /// Thickness of the layer that represents a sheet of smeared fibers, mm [default: a fiftieth of the wall, at most 0.05]
    #[arg(long, value_name = "MM", value_parser = above_zero("mm", 1e3))]
    layer: Option<Quantity>,
    /// Distance between neighbouring threads of one family, mm; rounded to whole threads [default: 3/4 of the wall]
    #[arg(long, value_name = "MM", value_parser = above_zero("mm", 1e4))]
    spacing: Option<Quantity>,
    /// Elements through the wall, 1 to 12 [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=12))]
    radial: Option<u32>,
    /// Elements around the circle, 8 to 96, even [default: 24]
    #[arg(long, value_name = "N", value_parser = |text: &str| even(text, 8..=96))]
    around: Option<u32>,
    /// Elements along the whole length, 4 to 800, even [default: by wall, radius and threads]
    #[arg(long, value_name = "N", value_parser = |text: &str| even(text, 4..=800))]
    along: Option<u32>,
    /// Model the whole actuator where symmetry would allow a part
    #[arg(long)]
    whole: bool,
    /// Bulk modulus over shear modulus, 100 to 10000
    #[arg(long, value_name = "RATIO", default_value = "2000", value_parser = quantity("1", 100.0, 1e4))]
    bulk_ratio: Quantity,
    /// Largest share of the load in one increment, 0.001 to 0.5 [default: 0.05 for twisting, else 0.1]
    #[arg(long, value_name = "SHARE", value_parser = quantity("1", 0.001, 0.5))]
    increment: Option<Quantity>,
    /// Refuse meshes of more nodes than this, 100 to 400000
    #[arg(long, value_name = "N", default_value_t = Options::default().nodes_max,
        value_parser = clap::value_parser!(u32).range(100..=400_000))]
    nodes_max: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Fibers {
    /// A material with fiber directions
    Smeared,
    /// Trusses along the threads
    Threads,
}

/// Subject of the arguments.
pub(super) struct Asked {
    /// `<scene>-<module>`, or the name of the actuator's file.
    pub(super) name: String,
    pub(super) subject: Subject,
    pub(super) options: Options,
    pub(super) pressures_pa: Vec<f64>,
}

impl Arguments {
    pub(super) fn read(&self) -> Result<Asked, Failure> {
        let fibers = self.fibers()?;
        let is_actuator = self.file.extension().is_some_and(|extension| extension == "json");
        let (name, subject, pressure_max_pa) = if is_actuator { self.of_file()? } else { self.of_scene()? };
        let highest = self.pressure.as_ref().map_or(pressure_max_pa, Quantity::si);
        let points = u32::from(self.points);
        let pressures_pa = (1..=points).map(|n| highest * f64::from(n) / f64::from(points)).collect();
        Ok(Asked { name, subject, options: self.options(fibers), pressures_pa })
    }

    /// Name, subject and highest pressure, of a scene's module.
    fn of_scene(&self) -> Result<(String, Subject, f64), Failure> {
        let scene = scene::load(&self.file)?;
        scene.require_no_segments("`fea`")?;
        let module = self.module(&scene)?;
        let single = Subject::single(module.made_actuator()).with_second_fiber(module.second_fiber.map(|fiber| *fiber));
        let bundle = Subject { actuators: module.actuators, arrangement: module.arrangement, ..single };
        let (subject, part) = if self.bundle { (bundle, "-bundle") } else { (single, "") };
        Ok((format!("{}-{}{part}", scene.name(), file_name(&module.name)), subject, *module.pressure_max_pa))
    }

    /// The same of an actuator alone.
    fn of_file(&self) -> Result<(String, Subject, f64), Failure> {
        if self.bundle || self.module.is_some() {
            return Err(Failure::wrong_line(
                "--module and --bundle are for a scene: an actuator's file has one actuator",
            ));
        }
        let about = about(&self.file);
        let json = std::fs::read(&self.file).map_err(|error| about(&error))?;
        let ((parameters, second_fiber), pressure_max_pa) = eval::actuator(&json).map_err(|error| about(&error))?;
        let name = file_name(&self.file.file_stem().unwrap_or_default().to_string_lossy());
        Ok((name, Subject::single(parameters).with_second_fiber(second_fiber), pressure_max_pa))
    }

    fn module<'a>(&self, scene: &'a Scene) -> Result<&'a Module, Failure> {
        let Some(name) = &self.module else { return Ok(&scene.modules()[0]) };
        let known = || scene.modules().iter().map(|module| module.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = scene.modules().iter().find(|module| *module.name == *name);
        found.ok_or_else(|| Failure::new(format!("the scene has no module `{name}`, only {}", known())))
    }

    /// Model of the fibers: a layer has no threads, threads have no layer.
    fn fibers(&self) -> Result<FiberModel, Failure> {
        let metres = |length: &Option<Quantity>| length.as_ref().map(Quantity::si);
        let refused = |what: &str, fibers: &str, other: &str| {
            Err(Failure::wrong_line(format!("{what} is for {fibers}: it cannot be used with {other}")))
        };
        match (self.fibers, &self.layer, &self.spacing) {
            (_, Some(_), Some(_)) => refused("--layer", "smeared fibers", "--spacing"),
            (Some(Fibers::Smeared), _, Some(_)) => refused("--spacing", "threads", "--fibers smeared"),
            (Some(Fibers::Threads), Some(_), _) => refused("--layer", "smeared fibers", "--fibers threads"),
            (Some(Fibers::Threads), ..) | (None, _, Some(_)) => {
                Ok(FiberModel::Threads { spacing_m: metres(&self.spacing) })
            }
            _ => Ok(FiberModel::Smeared { layer_m: metres(&self.layer) }),
        }
    }

    fn options(&self, fibers: FiberModel) -> Options {
        Options {
            fibers,
            symmetry: if self.whole { SymmetryUse::Whole } else { SymmetryUse::Auto },
            radial: self.radial,
            around: self.around,
            along: self.along,
            bulk_ratio: self.bulk_ratio.si(),
            increment: self.increment.as_ref().map(Quantity::si),
            nodes_max: self.nodes_max,
            all_nodes: false,
        }
    }

    /// An error of the model in the words of the command line.
    pub(super) fn refused(&self, error: FemError) -> Failure {
        match (&error, &self.layer, &self.spacing) {
            (FemError::Invalid(OutOfRange { field: "layer_mm", allowed, .. }), Some(typed), _) => {
                Failure::new(format!("--layer {typed} is not allowed: {allowed}"))
            }
            (FemError::Invalid(OutOfRange { field: "spacing_mm", allowed, .. }), _, Some(typed)) => {
                Failure::new(format!("--spacing {typed} is not allowed: {allowed}"))
            }
            (FemError::TooFine { nodes, allowed }, ..) => Failure::new(format!(
                "the mesh would have about {nodes} nodes, and --nodes-max allows {allowed}: make it coarser with --radial, --around and \
                 --along, or allow more"
            )),
            (FemError::NoSheet, ..) => Failure::new(format!("--fibers threads: {error}")),
            _ => Failure::new(&error),
        }
    }
}

/// Reads an even number of a range, both ends included.
fn even(text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let number = text.parse::<u32>().map_err(|error| error.to_string())?;
    if range.contains(&number) && number.is_multiple_of(2) {
        return Ok(number);
    }
    Err(format!("{number} is not an even number of {} to {}", range.start(), range.end()))
}

/// A name as part of a file's: letters, digits, `-`, `_`; anything else becomes `_`.
fn file_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    name.chars().map(plain).collect()
}

/// Description of a model, in a line.
pub(super) fn describe(model: &Model) -> String {
    use softlimb_fea::solid::Around;
    let around = match model.symmetry().around {
        Around::Whole => "all around".to_owned(),
        Around::Half => "half the section".to_owned(),
        Around::Sector(count) => format!("a sector of 1/{count}"),
    };
    let length = if model.symmetry().half_length { "half the length" } else { "the whole length" };
    let threads = model.thread_spacing_m().map_or(String::new(), |m| format!(", threads {:.3} mm apart", m * 1e3));
    format!("{} nodes, {} elements: {around}, {length}{threads}", model.nodes(), model.mesh().elements.len())
}
