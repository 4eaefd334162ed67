//! Measurements on a deformed model: sections, and the motion of one against the other.
//!
//! A section is one ring of nodes on the inside and one on the outside of every tube. Between two sections the actuator is taken as
//! bent, twisted and stretched evenly, which it is away from the caps; the mean strains follow from the screw that carries the one
//! section to the other.

use std::collections::HashMap;
use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3, Matrix3x2, Rotation3, UnitQuaternion, Vector2, Vector3};

use super::Mesh;
use super::error::FemError;
use super::plan::{Around, Symmetry};

/// Displacements of nodes, by their index, mm.
pub(crate) type Displacements = HashMap<usize, [f64; 3]>;

/// Strains and sizes between two sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Stretch of the line through the middles of the sections' outlines.
    pub axial_stretch: f64,
    /// Radius of a circle of the area of the outline, m; mean of both sections and of all tubes.
    pub outer_radius_m: f64,
    /// The same of the lumen, m.
    pub inner_radius_m: f64,
    /// Twist per length at rest, rad/m; positive about the axis from the fixed to the free end.
    pub twist_rate_rad_per_m: f64,
    /// Bend per length at rest, rad/m; >= 0.
    pub bend_rate_rad_per_m: f64,
}

impl Rates {
    /// Lumen area and length together, relative to those at rest of the given inner radius.
    pub(crate) fn volume_ratio(&self, inner_radius_m: f64) -> f64 {
        (self.inner_radius_m / inner_radius_m).powi(2) * self.axial_stretch
    }
}

/// One ring of nodes around a tube.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ring {
    pub(crate) nodes: Vec<usize>,
    pub(crate) center: [f64; 2],
    /// At rest, mm.
    pub(crate) radius: f64,
}

/// The rings at one height.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Section {
    pub(crate) height: f64,
    pub(crate) outer: Vec<Ring>,
    pub(crate) inner: Vec<Ring>,
}

/// The sections of a model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gauges {
    /// Around the middle of the length.
    pub(crate) middle: [Section; 2],
    /// At the caps, or from the mirror to the one cap.
    pub(crate) ends: [Section; 2],
    pub(crate) symmetry: Symmetry,
}

/// Pose of a section: axes and middle, and areas by those at rest.
struct Pose {
    axes: Matrix3<f64>,
    middle: Vector3<f64>,
    outer: f64,
    inner: f64,
}

type Pair = (Vector3<f64>, Vector3<f64>);

impl Gauges {
    /// All nodes that are measured, in order, each once.
    pub(crate) fn nodes(&self) -> Vec<usize> {
        let sections = self.middle.iter().chain(&self.ends);
        let rings = sections.flat_map(|section| section.outer.iter().chain(&section.inner));
        let mut nodes: Vec<_> = rings.flat_map(|ring| ring.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The strains in the middle and between the ends.
    pub(crate) fn read(&self, mesh: &Mesh, moved: &Displacements) -> Result<(Rates, Rates), FemError> {
        let middle = self.between(mesh, moved, &self.middle, Vector3::zeros())?;
        let turn = Vector3::new(0.0, middle.bend_rate_rad_per_m, middle.twist_rate_rad_per_m) * 1e-3;
        let ends = self.between(mesh, moved, &self.ends, turn)?;
        Ok((middle, ends))
    }

    /// Strains between two sections. `expected` is the turn per mm, which tells whole turns apart.
    fn between(
        &self,
        mesh: &Mesh,
        moved: &Displacements,
        [low, high]: &[Section; 2],
        expected: Vector3<f64>,
    ) -> Result<Rates, FemError> {
        let (a, b) = (self.pose(mesh, moved, low)?, self.pose(mesh, moved, high)?);
        let length = high.height - low.height;
        let relative = Rotation3::from_matrix_unchecked(a.axes.transpose() * b.axes);
        // By the quaternion: the cosine of a small angle may come out above one.
        let turn = UnitQuaternion::from_rotation_matrix(&relative).scaled_axis();
        let turn = whole_turns(turn, expected * length);
        let along = screw_along(&turn, &(a.axes.transpose() * (b.middle - a.middle)));
        let per_m = 1e3 / length;
        let radius = |ratios: [f64; 2], rings: &[Ring]| {
            let mean = 0.5 * (ratios[0] + ratios[1]);
            rings.first().map_or(f64::NAN, |ring| ring.radius * 1e-3 * mean.sqrt())
        };
        Ok(Rates {
            axial_stretch: along.z / length,
            outer_radius_m: radius([a.outer, b.outer], &low.outer),
            inner_radius_m: radius([a.inner, b.inner], &low.inner),
            twist_rate_rad_per_m: turn.z * per_m,
            bend_rate_rad_per_m: turn.x.hypot(turn.y) * per_m,
        })
    }

    fn pose(&self, mesh: &Mesh, moved: &Displacements, section: &Section) -> Result<Pose, FemError> {
        let unfold = |rings: &[Ring]| -> Result<Vec<Vec<Pair>>, FemError> {
            rings.iter().map(|ring| self.unfold(mesh, moved, ring)).collect()
        };
        let (outer, inner) = (unfold(&section.outer)?, unfold(&section.inner)?);
        let all = || outer.iter().flatten();
        let count = all().count() as f64;
        let rest = all().map(|(rest, _)| rest).sum::<Vector3<f64>>() / count;
        let now = all().map(|(_, now)| now).sum::<Vector3<f64>>() / count;
        let moment: Matrix3x2<f64> = all().map(|(x, y)| (y - now) * (x - rest).xy().transpose()).sum();
        let axes = nearest_axes(&moment);
        let outlines = outer.iter().map(|ring| outline(ring, &axes, &now)).collect::<Vec<_>>();
        let middle = outlines.iter().map(|(_, middle)| middle).sum::<Vector3<f64>>() / outlines.len() as f64;
        let mean = |ratios: Vec<f64>| ratios.iter().sum::<f64>() / ratios.len() as f64;
        let inner = inner.iter().map(|ring| outline(ring, &axes, &now).0).collect();
        Ok(Pose { axes, middle, outer: mean(outlines.iter().map(|(ratio, _)| *ratio).collect()), inner: mean(inner) })
    }

    /// Places at rest and now all around a ring, in the order of the angle at rest.
    fn unfold(&self, mesh: &Mesh, moved: &Displacements, ring: &Ring) -> Result<Vec<Pair>, FemError> {
        let missing = |node: usize| FemError::Garbage {
            file: "the displacements",
            line: 0,
            what: format!("node {} is missing", node + 1),
        };
        let mut pairs = Vec::new();
        for &node in &ring.nodes {
            let rest = Vector3::from(mesh.nodes[node]);
            let shift = moved.get(&node).ok_or_else(|| missing(node))?;
            pairs.push((rest, rest + Vector3::from(*shift)));
        }
        let off_plane = 1e-6 * ring.radius;
        let angle = |(rest, _): &Pair| (rest.y - ring.center[1]).atan2(rest.x - ring.center[0]);
        match self.symmetry.around {
            Around::Whole => {}
            Around::Half => {
                let mirror = |v: &Vector3<f64>| Vector3::new(v.x, -v.y, v.z);
                let others = pairs.iter().filter(|(rest, _)| rest.y > off_plane);
                let others: Vec<_> = others.map(|(rest, now)| (mirror(rest), mirror(now))).collect();
                pairs.extend(others);
            }
            Around::Sector(count) => {
                let sector = TAU / f64::from(count);
                pairs.retain(|pair| angle(pair) < sector * (1.0 - 1e-6));
                let turn = |n: u32| Rotation3::from_axis_angle(&Vector3::z_axis(), sector * f64::from(n));
                let copies = |n| pairs.iter().map(move |(rest, now)| (turn(n) * rest, turn(n) * now));
                pairs = (0..count).flat_map(copies).collect();
            }
        }
        pairs.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        Ok(pairs)
    }
}

/// The orthonormal axes nearest to the columns of a moment, and their normal.
fn nearest_axes(moment: &Matrix3x2<f64>) -> Matrix3<f64> {
    let square: Matrix2<f64> = moment.transpose() * moment;
    // The inverse root of a symmetric 2 x 2 matrix in closed form.
    let root = square.determinant().sqrt();
    let inverse = (square + Matrix2::identity() * root).try_inverse().unwrap_or_else(Matrix2::zeros);
    let scale = (square.trace() + 2.0 * root).sqrt();
    let flat = moment * (inverse * scale);
    let (x, y) = (flat.column(0).into_owned(), flat.column(1).into_owned());
    Matrix3::from_columns(&[x, y, x.cross(&y)])
}

/// Area of a ring by that at rest, and the middle of its outline.
fn outline(ring: &[Pair], axes: &Matrix3<f64>, origin: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let now: Vec<Vector2<f64>> = ring.iter().map(|(_, now)| (axes.transpose() * (now - origin)).xy()).collect();
    let rest: Vec<Vector2<f64>> = ring.iter().map(|(rest, _)| rest.xy()).collect();
    let ((area, middle), (at_rest, _)) = (polygon(&now), polygon(&rest));
    (area / at_rest, origin + axes * Vector3::new(middle.x, middle.y, 0.0))
}

/// Area and middle of a polygon.
fn polygon(points: &[Vector2<f64>]) -> (f64, Vector2<f64>) {
    let origin = points.iter().sum::<Vector2<f64>>() / points.len() as f64;
    let (mut area, mut moment) = (0.0, Vector2::zeros());
    for (n, point) in points.iter().enumerate() {
        let (a, b) = (point - origin, points[(n + 1) % points.len()] - origin);
        let twice = a.x * b.y - a.y * b.x;
        area += 0.5 * twice;
        moment += (a + b) * (twice / 6.0);
    }
    (area, origin + moment / area)
}

/// The same rotation with as many whole turns more or less as bring it next to the expected one.
fn whole_turns(turn: Vector3<f64>, expected: Vector3<f64>) -> Vector3<f64> {
    // The direction of the bend is free, so that only sizes are compared.
    let sizes = |v: &Vector3<f64>| Vector2::new(v.x.hypot(v.y), v.z);
    let angle = turn.norm();
    if angle < 1e-9 {
        return turn;
    }
    let candidates = (-4..=4).map(|n| turn * (1.0 + TAU * f64::from(n) / angle));
    let off = |v: &Vector3<f64>| (sizes(v) - sizes(&expected)).norm();
    candidates.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(turn)
}

/// The translation per unit of a screw that turns by `turn` and moves its start to `end`.
fn screw_along(turn: &Vector3<f64>, end: &Vector3<f64>) -> Vector3<f64> {
    let angle = turn.norm();
    let cross = turn.cross_matrix();
    let factor = if angle < 1e-2 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
    };
    end - cross * end * 0.5 + cross * cross * end * factor
}

#[cfg(test)]
mod tests {
    use fra_model::Segment;

    use super::*;

    /// A model without symmetry: two rings at the heights 0 and 10 mm and the displacements that a segment of the kinematics gives them.
    fn moved(bend: f64, twist: f64, stretch: f64, swelling: f64) -> (Gauges, Mesh, Displacements) {
        let (mut mesh, mut moved) = (Mesh::default(), Displacements::new());
        let mut ring = |height: f64, radius: f64| {
            let segment = Segment { length_m: 10.0 * stretch, bend_angle_rad: bend, twist_rad: twist };
            let pose = segment.pose_at(height / 10.0);
            let nodes = (0..16).map(|n| {
                let (sin, cos) = (TAU * f64::from(n) / 16.0).sin_cos();
                let now = pose * nalgebra::Point3::new(swelling * radius * cos, swelling * radius * sin, 0.0);
                mesh.nodes.push([radius * cos, radius * sin, height]);
                let node = mesh.nodes.len() - 1;
                moved.insert(node, [now.x - radius * cos, now.y - radius * sin, now.z - height]);
                node
            });
            Ring { nodes: nodes.collect(), center: [0.0; 2], radius }
        };
        let mut section = |height| Section { height, outer: vec![ring(height, 8.0)], inner: vec![ring(height, 6.0)] };
        let middle = [section(0.0), section(10.0)];
        let symmetry = Symmetry { around: Around::Whole, half_length: false };
        (Gauges { ends: middle.clone(), middle, symmetry }, mesh, moved)
    }

    #[test]
    fn strains_of_an_exact_screw_are_read_back() {
        for (bend, twist, stretch, swelling) in
            [(0.0, 0.0, 1.0, 1.0), (0.4, 0.0, 1.1, 1.02), (0.0, -1.3, 0.97, 1.3), (0.7, 0.9, 1.25, 0.95)]
        {
            let (gauges, mesh, moved) = moved(bend, twist, stretch, swelling);
            let (rates, ends) = gauges.read(&mesh, &moved).unwrap();
            assert_eq!(format!("{rates:.9?}"), format!("{ends:.9?}"));
            assert!((rates.axial_stretch - stretch).abs() < 1e-12, "{rates:?}");
            assert!((rates.bend_rate_rad_per_m - 100.0 * bend).abs() < 1e-9, "{rates:?}");
            assert!((rates.twist_rate_rad_per_m - 100.0 * twist).abs() < 1e-9, "{rates:?}");
            assert!((rates.outer_radius_m - 8e-3 * swelling).abs() < 1e-12, "{rates:?}");
            assert!((rates.inner_radius_m - 6e-3 * swelling).abs() < 1e-12, "{rates:?}");
        }
    }

    #[test]
    fn whole_turns_are_told_by_the_rate_in_the_middle() {
        let turn = Vector3::new(0.0, 0.0, 0.5);
        assert!((whole_turns(turn, Vector3::new(0.0, 0.0, 6.5)).z - (0.5 + TAU)).abs() < 1e-12);
        assert!((whole_turns(turn, Vector3::new(0.0, 0.0, -5.5)).z - (0.5 - TAU)).abs() < 1e-12);
        assert_eq!(whole_turns(turn, Vector3::new(0.0, 0.0, 0.6)), turn);
    }

    #[test]
    fn node_that_was_not_printed_is_named() {
        let (gauges, mesh, mut moved) = moved(0.1, 0.0, 1.0, 1.0);
        moved.remove(&3);
        assert!(gauges.read(&mesh, &moved).unwrap_err().to_string().contains("node 4 is missing"));
    }
}
