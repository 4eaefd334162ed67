//! One kind of actuator, ready to be made: its winding, its layers, and whether a workshop can make it.

use std::f64::consts::PI;

use fra_model::{ActuatorParameters, Motion, Placement};

use super::winding::winding_radius_m;
use super::{FabricateError, Settings, Thread, Winding};
use crate::{Limb, LimbModule};
use softlimb_scene::{Module, Scene, SceneError, Span};

/// Width of the open top of a groove over that of its floor, for a depth of one width.
const FLARE: f64 = 1.0;
/// Distance of threads, in walls, up to which they do what a sheet does.
pub(super) const CLOSE: f64 = 0.75;
/// Thinnest layer that is cast over a winding without a remark, m.
const COVER_MIN_M: f64 = 5e-4;

/// One of the equal actuators of a module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Copy {
    /// Its channel.
    pub channel: usize,
    /// Where its axis meets the connector, m, from the limb's axis; the first number towards the limb's up.
    pub place_m: [f64; 2],
}

/// The groove that the mold leaves for the thread: a trapezoid, measured across.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Groove {
    /// Depth, m.
    pub depth_m: f64,
    /// Width of its floor, m: the thread's diameter.
    pub floor_m: f64,
    /// Width at the surface, m.
    pub top_m: f64,
}

/// A second winding, laid on the first cast without a groove.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondWinding {
    /// Its thread.
    pub thread: Thread,
    /// How it is wound.
    pub winding: Winding,
}

/// The place of a segment on the tube that it is a part of. All segments are cast at once, with their shells end to end on one core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeSegment {
    /// Its number, from 1 at the base.
    pub number: usize,
    /// Segments of the tube.
    pub count: usize,
    /// Its distance from the near end of the tube, m.
    pub start_m: f64,
    /// Length of the tube, m.
    pub tube_m: f64,
}

/// The actuators of one module, all made alike, or one segment of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Name of the module; of a segment with its number behind a point.
    pub name: String,
    /// The segment it is; `None` of an actuator that is wound alike along its length.
    pub segment: Option<TubeSegment>,
    /// The actuators it stands for.
    pub copies: Vec<Copy>,
    /// Their parameters.
    pub parameters: ActuatorParameters<f64>,
    /// The thread: the scene's, or the workshop's where the scene states none.
    pub thread: Thread,
    /// Density of the elastomer, kg/m3.
    pub density_kg_per_m3: f64,
    /// Largest gauge pressure in the chamber, Pa.
    pub pressure_max_pa: f64,
    /// Length of the connector behind the module, m.
    pub connector_m: f64,
    /// Direction of bending about the limb's axis, from the limb's up, rad.
    pub mount_angle_rad: f64,
    /// How it is wound.
    pub winding: Winding,
    /// The winding over it, of an actuator that is wound twice.
    pub second: Option<SecondWinding>,
    /// The groove of the first cast.
    pub groove: Groove,
    /// Outer radius of the first cast, which carries the groove, m.
    pub cast_radius_m: f64,
    /// What speaks against it without forbidding it.
    pub warnings: Vec<String>,
}

impl Piece {
    /// Length of the whole tube, m.
    pub fn tube_m(&self) -> f64 {
        self.segment.map_or(self.parameters.length_m, |segment| segment.tube_m)
    }

    /// Whether core, base, caps and plates of the tube are among its parts: of a series among those of the first segment.
    pub fn has_ends(&self) -> bool {
        self.segment.is_none_or(|segment| segment.number == 1)
    }

    /// Wall, m.
    pub fn wall_m(&self) -> f64 {
        self.parameters.outer_radius_m - self.parameters.inner_radius_m
    }

    /// Its windings, each with a word for the names of its files.
    pub fn windings(&self) -> impl Iterator<Item = (&'static str, &Winding)> {
        let second = self.second.iter().map(|second| ("second-thread", &second.winding));
        std::iter::once(("thread", &self.winding)).chain(second)
    }

    /// Elastomer below the groove, m.
    pub fn below_groove_m(&self) -> f64 {
        self.cast_radius_m - self.groove.depth_m - self.parameters.inner_radius_m
    }

    /// Thickness of the second cast over the winding, m; 0 where the thread lies on the surface.
    pub fn cover_m(&self) -> f64 {
        self.parameters.outer_radius_m - self.cast_radius_m
    }

    /// Elastomer of one actuator, m3.
    pub fn elastomer_m3(&self) -> f64 {
        self.ring_m3(self.parameters.inner_radius_m, self.parameters.outer_radius_m)
    }

    /// Elastomer of its second cast, m3.
    pub fn cover_m3(&self) -> f64 {
        self.ring_m3(self.cast_radius_m, self.parameters.outer_radius_m)
    }

    /// Volume of its chamber at rest, m3.
    pub fn chamber_m3(&self) -> f64 {
        self.ring_m3(0.0, self.parameters.inner_radius_m)
    }

    fn ring_m3(&self, inner_m: f64, outer_m: f64) -> f64 {
        PI * (outer_m - inner_m) * (outer_m + inner_m) * self.parameters.length_m
    }
}

/// How the actuators of every module of a scene are made, in the order of the modules.
///
/// # Errors
/// [`FabricateError::Invalid`] for the settings; [`FabricateError::Scene`] at the line of the first module that cannot be made with them, or
/// that [`Limb::new`] refuses.
pub fn plan(scene: &Scene, settings: &Settings) -> Result<Vec<Piece>, FabricateError> {
    settings.check()?;
    // Bundles that hold each other are not worth a mold.
    let limb = Limb::new(scene)?;
    let mut first_channel = 0;
    let mut pieces = Vec::new();
    for (module, built) in scene.modules().iter().zip(limb.modules()) {
        let copies = copies(module, first_channel);
        first_channel += usize::from(module.actuators);
        let first = pieces.len();
        if module.segments.is_empty() {
            pieces.push(piece(scene, module, copies, settings)?);
        } else {
            pieces.extend(segments(scene, module, &copies, settings)?);
        }
        pieces[first].warnings.extend(beyond_limit(built));
    }
    Ok(pieces)
}

/// The segments of a module's actuator, from the base on.
fn segments(scene: &Scene, module: &Module, copies: &[Copy], settings: &Settings) -> Result<Vec<Piece>, SceneError> {
    let count = module.segments.len();
    let mut start_m = 0.0;
    let of = |(index, alone): (usize, Module)| {
        let mut piece = piece(scene, &alone, copies.to_vec(), settings)?;
        let number = index + 1;
        piece.name = format!("{}.{number}", *module.name);
        piece.segment = Some(TubeSegment { number, count, start_m, tube_m: *module.length_m });
        start_m += *alone.length_m;
        Ok(piece)
    };
    let alone = module.segment_modules();
    let pieces: Vec<Piece> = alone.iter().cloned().enumerate().map(of).collect::<Result<_, _>>()?;
    // Their shells stand on each other in either cast.
    let covered = |piece: &Piece| piece.cover_m() > 1e-9;
    let mut others = pieces.iter().zip(&alone);
    match others.find(|(piece, _)| covered(piece) != covered(&pieces[0])) {
        None => Ok(pieces),
        Some((_, module)) => Err(Refusal { scene, module }.cover()),
    }
}

/// The warning about a pressure that the wall does not carry.
fn beyond_limit(module: &LimbModule) -> Option<String> {
    let [limit, most] = [module.curve.limit_point_pa()?, module.pressure_max_pa].map(|pressure_pa| 1e-3 * pressure_pa);
    Some(format!(
        "its wall has a limit point at {limit:.2} kPa, below `pressure_max` of {most:.2} kPa: beyond it the actuator bursts or grows without bound"
    ))
}

/// The workshop with the thread that the scene states.
pub(super) fn with_thread_of(module: &Module, settings: &Settings) -> Settings {
    let stated = module.thread.map(|thread| Thread { stiffness_n: thread.stiffness_n, diameter_m: thread.diameter_m });
    Settings { thread: stated.unwrap_or(settings.thread), ..*settings }
}

fn copies(module: &Module, first_channel: usize) -> Vec<Copy> {
    let (sin, cos) = module.mount_angle_rad.sin_cos();
    let place = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let copy = |(index, at)| Copy { channel: first_channel + index, place_m: place(at) };
    module.positions_m().into_iter().enumerate().map(copy).collect()
}

fn piece(scene: &Scene, module: &Module, copies: Vec<Copy>, workshop: &Settings) -> Result<Piece, SceneError> {
    let parameters = module.made_actuator();
    let settings = &with_thread_of(module, workshop);
    let refuse = Refusal { scene, module };
    let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
    // A wall of exactly the least thickness passes however its radii were rounded.
    if wall_m < settings.wall_min_m * (1.0 - 1e-9) {
        return Err(refuse.wall(wall_m, settings.wall_min_m));
    }
    let sheet = parameters.fiber.is_none_or(|fiber| fiber.placement == Placement::Sheet);
    if !sheet && parameters.motion != Motion::Bending {
        return Err(refuse.placement(refuse.winding_span()));
    }
    let (cast_radius_m, groove) = groove(&parameters, settings.thread.diameter_m);
    if cast_radius_m - groove.depth_m <= parameters.inner_radius_m {
        return Err(refuse.groove(&parameters, settings));
    }
    let starts = module.thread.map(|thread| thread.starts);
    let mut winding = Winding::new(&parameters, settings, starts, *module.pressure_max_pa);
    if winding.spacing_m() <= groove.top_m {
        return Err(refuse.spacing(&winding, groove));
    }
    let second = second(&refuse, &winding, cast_radius_m, workshop)?;
    if second.is_some() {
        winding.worth = winding.worth.map(|_| Err(WOUND_TWICE.to_owned()));
    }
    let mut piece = Piece {
        name: module.name.to_string(),
        segment: None,
        copies,
        parameters,
        thread: settings.thread,
        density_kg_per_m3: module.density_kg_per_m3,
        pressure_max_pa: *module.pressure_max_pa,
        connector_m: scene.limb().connector_length_m,
        mount_angle_rad: module.mount_angle_rad,
        winding,
        second,
        groove,
        cast_radius_m,
        warnings: Vec::new(),
    };
    piece.warnings = warnings(&piece, settings);
    Ok(piece)
}

/// Why the threads of an actuator are not compared with sheets.
const WOUND_TWICE: &str = "the actuator has two windings";

/// The second winding of a module, on the first cast or over its winding.
fn second(
    refuse: &Refusal<'_>,
    first: &Winding,
    cast_radius_m: f64,
    workshop: &Settings,
) -> Result<Option<SecondWinding>, SceneError> {
    let module = refuse.module;
    let Some(fiber) = module.second_fiber else { return Ok(None) };
    if fiber.placement != Placement::Sheet {
        return Err(refuse.placement(fiber.span));
    }
    let stated = module.second_thread;
    let thread = stated.map(|thread| Thread { stiffness_n: thread.stiffness_n, diameter_m: thread.diameter_m });
    let settings = Settings { thread: thread.unwrap_or(workshop.thread), ..*workshop };
    let diameter_m = settings.thread.diameter_m;
    let parameters = ActuatorParameters { fiber: Some(*fiber), ..module.made_actuator() };
    let mut winding = Winding::new(&parameters, &settings, stated.map(|thread| thread.starts), *module.pressure_max_pa);
    winding.worth = winding.worth.map(|_| Err(WOUND_TWICE.to_owned()));
    let [low_m, high_m] = [first.radius_m, cast_radius_m + 0.5 * diameter_m];
    if !(low_m - 1e-9..=high_m + 1e-9).contains(&winding.radius_m) {
        let [at, low, high] = [winding.radius_m, low_m, high_m].map(|radius_m| 1e3 * radius_m);
        let label = format!("its thread at {at:.3} mm does not lie on the first cast");
        let help = format!("name the inner winding first, and wind the second at {low:.3} to {high:.3} mm");
        return Err(refuse.at(fiber.span, "this winding cannot be wound", &label, &help));
    }
    if winding.spacing_m() <= diameter_m {
        let [apart, thick] = [winding.spacing_m(), diameter_m].map(|length_m| 1e3 * length_m);
        let label = format!("threads of one hand would be {apart:.3} mm apart, and are {thick:.3} mm thick");
        let help = "a steeper angle, a larger `--spacing`, or a thinner or stiffer `--thread`";
        return Err(refuse.at(fiber.span, "this winding cannot be wound", &label, help));
    }
    Ok(Some(SecondWinding { thread: settings.thread, winding }))
}

/// The first cast's radius and the groove that puts the thread's centre line on the winding radius: flush with the surface, or halfway out of
/// it where the winding is the outer surface.
pub(super) fn groove(parameters: &ActuatorParameters<f64>, diameter_m: f64) -> (f64, Groove) {
    let winding_m = winding_radius_m(parameters);
    let cast_m = (winding_m + 0.5 * diameter_m).min(parameters.outer_radius_m);
    let depth_m = cast_m - (winding_m - 0.5 * diameter_m);
    (cast_m, Groove { depth_m, floor_m: diameter_m, top_m: diameter_m + FLARE * depth_m })
}

fn warnings(piece: &Piece, settings: &Settings) -> Vec<String> {
    let mut warnings = of_winding(piece, &piece.winding);
    if let Some(second) = &piece.second {
        warnings.extend(of_winding(piece, &second.winding).into_iter().map(|text| format!("second winding: {text}")));
    }
    warnings.extend(of_casts(piece, settings));
    warnings
}

fn of_winding(piece: &Piece, winding: &Winding) -> Vec<String> {
    let mut warnings = winding.remarks.clone();
    let between_m = if winding.is_hoop { winding.turn_spacing_m() } else { winding.spacing_m() };
    if between_m > CLOSE * piece.wall_m() {
        warnings.push(format!(
            "threads are {:.2} mm apart, more than {CLOSE} of the wall of {:.2} mm: the wall bulges between them, and they do not do what the \
             scene's sheet does",
            between_m * 1e3,
            piece.wall_m() * 1e3
        ));
    }
    if let Some(Err(reason)) = &winding.worth {
        warnings.push(format!(
            "the stiffness of the thread was not compared with the scene's sheet: {reason}. The winding is drawn as stated"
        ));
    }
    warnings
}

fn of_casts(piece: &Piece, settings: &Settings) -> Vec<String> {
    let mut warnings = Vec::new();
    let floor_m = piece.below_groove_m();
    if floor_m < settings.wall_min_m * (1.0 - 1e-9) {
        warnings.push(format!(
            "the groove leaves {:.2} mm of wall, less than the {:.2} mm that can be cast",
            floor_m * 1e3,
            settings.wall_min_m * 1e3
        ));
    }
    let cover_m = piece.cover_m();
    if cover_m > 1e-9 && cover_m < COVER_MIN_M {
        warnings.push(format!("the cover over the thread is {:.2} mm thin", cover_m * 1e3));
    }
    warnings
}

/// Refusals of one module, at its lines.
struct Refusal<'a> {
    scene: &'a Scene,
    module: &'a Module,
}

impl Refusal<'_> {
    fn at(&self, span: Span, title: &str, label: &str, help: &str) -> SceneError {
        self.scene.diagnostic(span, title, label, Some(help))
    }

    /// The winding's name in the module, or the module where it has none.
    fn winding_span(&self) -> Span {
        self.module.fiber.as_ref().map_or(self.module.span, |fiber| fiber.span)
    }

    fn wall(&self, wall_m: f64, least_m: f64) -> SceneError {
        let label =
            format!("this leaves a wall of {:.3} mm; at least {:.3} mm can be cast", wall_m * 1e3, least_m * 1e3);
        let least_outer = (*self.module.inner_radius_m + least_m) * 1e3;
        let help = format!("an outer radius from {least_outer:.3} mm on, or another `--wall-min`");
        self.at(self.module.outer_radius_m.span, "the wall is too thin to be cast", &label, &help)
    }

    fn cover(&self) -> SceneError {
        let help = "give the windings of all segments a `radius` below the surface, or none";
        let label = "of this segment and the first, one thread lies on the surface and one under a cover";
        self.at(self.module.span, "these segments cannot be cast together", label, help)
    }

    fn placement(&self, span: Span) -> SceneError {
        let help =
            "threads lie on one radius: `placement = \"sheet\"`, with a `modulus` and `thickness` that stand for them";
        self.at(span, "this winding cannot be wound", "it fills a layer or the whole wall", help)
    }

    fn groove(&self, parameters: &ActuatorParameters<f64>, settings: &Settings) -> SceneError {
        let (radius_m, diameter_m) = (winding_radius_m(parameters), settings.thread.diameter_m);
        let label = format!(
            "the thread of {:.3} mm on the radius {:.3} mm reaches the chamber",
            diameter_m * 1e3,
            radius_m * 1e3
        );
        let least = (parameters.inner_radius_m + 0.5 * diameter_m) * 1e3;
        let help = format!("a winding `radius` above {least:.3} mm, or a thinner `--thread`");
        self.at(self.winding_span(), "the groove for the thread is deeper than the wall", &label, &help)
    }

    fn spacing(&self, winding: &Winding, groove: Groove) -> SceneError {
        let label = format!(
            "threads of one hand would be {:.3} mm apart; their grooves are {:.3} mm wide",
            winding.spacing_m() * 1e3,
            groove.top_m * 1e3
        );
        let help = format!(
            "more than {:.3} mm: a steeper angle, a larger `--spacing`, or a thinner or stiffer `--thread`",
            groove.top_m * 1e3
        );
        self.at(self.winding_span(), "this winding cannot be wound", &label, &help)
    }
}
