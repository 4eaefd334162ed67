//! Force against pressure of bundles designed for wanted pushes, as the paper's Fig. 10: a module's bundle held at its rest length, its
//! sizes, angle and circle found by eq. (18) around those of the scene.

use fra_model::{Actuator, ActuatorParameters, Families, Motion, Placement};
use nalgebra::Vector3;

use crate::actuators::Winding;
use crate::bundle::{Answer, Attachment, Budget, ForceProblem, Place, Sample, Tube, search};
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet, span};
use softlimb_limb::LimbModule;
use softlimb_limb::payload::{Bundle, Hold, Mounted, PayloadError};

/// The wanted pushes as shares of that of the scene's own bundle at its highest pressure.
const SHARES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// How far sizes may be off those of the scene.
const AROUND: f64 = 0.2;
/// Points of a curve.
const POINTS: usize = 21;
/// Area of the picture and its width with its frame, px.
const AREA: [f64; 2] = [700.0, 340.0];
const ROOM: f64 = 800.0;
/// Strokes of the designs.
const STROKES: [Stroke; 4] = [Stroke::Solid, Stroke::Dashed, Stroke::DashDotted, Stroke::Dotted];
const CAPTION: &str = "Four designs of one bundle by eq. (18). Wanted: the push that the design problem asks for. A dot: the pressure at \
                       which the design reaches it.";

/// One design and what it pushes with.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockedDesign {
    /// The wanted push along the axis, N.
    pub wanted_n: f64,
    /// The design by eq. (18).
    pub answer: Answer,
    /// Gauge pressure of all actuators, Pa, and push, N.
    pub curve: Vec<[f64; 2]>,
    /// What the printed Jacobian would say at the highest pressure, `n P pi R_i^2`, N.
    pub printed_n: f64,
}

/// Four designs of a straight module's bundle; `None` for a module that bends or has no thread.
///
/// # Errors
/// As [`search`](crate::bundle::search()) and [`Bundle::wrench`].
pub fn blocked_designs(module: &LimbModule) -> Result<Option<Vec<BlockedDesign>>, PayloadError> {
    let parameters = *module.actuator.parameters();
    let straight = parameters.motion != Motion::Bending;
    let Some(fiber) = parameters.fiber.filter(|_| straight) else { return Ok(None) };
    let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
    let winding = Winding {
        families: fiber.families,
        modulus_pa: fiber.modulus_pa,
        placement: fiber.placement,
        thickness_m: match fiber.placement {
            Placement::Layer => parameters.outer_radius_m - fiber.radius_m,
            Placement::Sheet | Placement::Smeared => fiber.thickness_m,
        },
        wall_share: 1.0 - (parameters.outer_radius_m - fiber.radius_m) / wall_m,
    };
    let most = module.reference_max_pa.min(module.curve.pressure_max_pa());
    let count = module.channels.len();
    let own = bundle(&parameters, count)?.wrench(&vec![most; count])?[2];
    let angle = fiber.angle_rad;
    let around = |value: f64| [value * (1.0 - AROUND), value * (1.0 + AROUND)];
    let positions_m = module.positions_m();
    let tube = Tube {
        material: parameters.material,
        winding,
        mirrored: false,
        inner_radius_m: around(parameters.inner_radius_m),
        wall_m: match fiber.placement {
            Placement::Layer => around(wall_m).map(|wall_m| wall_m.max(winding.thickness_m)),
            Placement::Sheet | Placement::Smeared => around(wall_m),
        },
        length_m: [parameters.length_m; 2],
        angle_rad: [angle - 0.05, angle + 0.05],
        pressure_max_pa: most,
    };
    let attachment = |i: usize| Attachment {
        name: format!("{} {}", module.name, i + 1),
        tube: tube.clone(),
        place: Place::Cartesian { x_m: [positions_m[i][0]; 2], y_m: [positions_m[i][1]; 2] },
        height_m: [0.0; 2],
        slopes: [[0.0; 2]; 2],
    };
    let design = |share: f64| {
        let wanted_n = share * own;
        let twist = if fiber.families == Families::One { 0.0 } else { 20.0 };
        let problem = ForceProblem {
            shared: true,
            actuators: (0..count).map(attachment).collect(),
            samples: vec![Sample { wrench: [0.0, 0.0, wanted_n, 0.0, 0.0, 0.0], held_length_m: None }],
            force_per_n: 1.0,
            torque_per_nm: twist,
            effort: 0.0,
            reference_pressure_pa: None,
        };
        let answer = search(&problem, &Budget::default())?;
        let found = &answer.actuators[0];
        let mut made = parameters;
        (made.inner_radius_m, made.outer_radius_m) = (found.inner_radius_m, found.outer_radius_m);
        let radius_m = winding.radius_m(found.inner_radius_m, found.outer_radius_m);
        made.fiber = Some(fra_model::Fiber { angle_rad: found.angle_deg.to_radians(), radius_m, ..fiber });
        let bundle = bundle(&made, count)?;
        let point = |index: usize| {
            let pressure = most * index as f64 / (POINTS - 1) as f64;
            Ok([pressure, bundle.wrench(&vec![pressure; count])?[2]])
        };
        let curve = (0..POINTS).map(point).collect::<Result<_, PayloadError>>()?;
        let printed_n = count as f64 * most * std::f64::consts::PI * made.inner_radius_m.powi(2);
        Ok(BlockedDesign { wanted_n, answer, curve, printed_n })
    };
    SHARES.into_iter().map(design).collect::<Result<_, PayloadError>>().map(Some)
}

/// Actuators side by side at their rest length.
fn bundle(parameters: &ActuatorParameters<f64>, count: usize) -> Result<Bundle, PayloadError> {
    let actuator = Actuator::new(parameters)?;
    let hold = Hold::Straight { axial_stretch: 1.0, twist_rad: 0.0 };
    let one = |_| Mounted::new("actuator", actuator, hold, Vector3::zeros(), Vector3::z());
    Ok(Bundle { actuators: (0..count).map(one).collect::<Result<_, _>>()?, ..Bundle::default() })
}

/// The curves as a document that stands by itself.
pub fn picture(name: &str, designs: &[BlockedDesign]) -> String {
    let curves: Vec<Vec<[f64; 2]>> =
        designs.iter().map(|design| design.curve.iter().map(|[pa, n]| [pa * 1e-3, *n]).collect()).collect();
    let (mut series, mut notes, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    let one = |color, stroke, points| Series { label: String::new(), color, stroke, points };
    for (index, (design, points)) in designs.iter().zip(&curves).enumerate() {
        let (color, stroke) = (Color::nth(index), STROKES[index % STROKES.len()]);
        let letter = char::from(b'A' + index as u8);
        let wanted = points.last().map(|end| vec![[points[0][0], design.wanted_n], [end[0], design.wanted_n]]);
        let reached: Vec<[f64; 2]> = crossing(points, design.wanted_n).into_iter().collect();
        let note = |at: [f64; 2], text: String| Note { at, text, meaning: String::new() };
        notes.extend(reached.iter().map(|at| note(*at, letter.to_string())));
        ends.extend(points.last().map(|end| note(*end, letter.to_string())));
        notes.push(note([points[0][0], design.wanted_n], format!("{:.0} N required of {letter}", design.wanted_n)));
        series.push(one(Color::Faint, Stroke::Solid, wanted.unwrap_or_default()));
        series.push(Series { label: format!("design {letter}"), ..one(color, stroke, points.clone()) });
        series.push(one(color, Stroke::Dots, reached));
    }
    // The highest first: it has the place above.
    ends.sort_by(|a, b| b.at[1].total_cmp(&a.at[1]));
    notes.extend(ends);
    let along = |axis: usize| span(series.iter().flat_map(|one| &one.points).map(|point| point[axis]));
    let (x, y) = (along(0), along(1));
    let chart = Chart {
        title: format!("{name}: push at rest length"),
        area: AREA,
        x: Axis { label: "gauge pressure, kPa".into(), range: x, ticks: Ticks::Round },
        y: Axis { label: "push of the bundle, N".into(), range: y, ticks: Ticks::Round },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    };
    sheet(&[vec![chart]], ROOM, CAPTION)
}

/// The point at which a rising curve reaches a value.
fn crossing(points: &[[f64; 2]], value: f64) -> Option<[f64; 2]> {
    points.windows(2).find_map(|ends| {
        let [[from, low], [to, high]] = [ends[0], ends[1]];
        let share = (value - low) / (high - low);
        (0.0..=1.0).contains(&share).then_some([from + share * (to - from), value])
    })
}
