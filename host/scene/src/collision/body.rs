//! The body of a limb: pieces of a centre line, each of one radius.

use fra_model::{Link, Segment};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Angle below which the coefficients of the centre line are series.
const SMALL_ANGLE_RAD: f64 = 0.1;

/// One piece of the centre line: an arc of constant curvature and torsion, or a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    start_m: Vector3<f64>,
    length_m: f64,
    radius_m: f64,
    /// Angle of the screw from end to end, rad.
    angle_rad: f64,
    /// Curvature of the line, 1/m.
    curvature_per_m: f64,
    /// Tangent `e` at the start, and `w x e` and `w x (w x e)` with the screw's rotation vector `w`.
    frame: [Vector3<f64>; 3],
    /// Rotation of the cross-section at the start.
    rotation: UnitQuaternion<f64>,
    /// Rotation vector of the screw from end to end, rad.
    turn: Vector3<f64>,
}

impl Piece {
    /// Arc length of its centre line, m.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Distance of its surface from the centre line, m.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// Curvature of its centre line, 1/m; the same everywhere.
    pub fn curvature_per_m(&self) -> f64 {
        self.curvature_per_m
    }

    /// The point of the centre line at a share of its length, 0 to 1, in the frame of the body, m.
    pub fn point_m(&self, share: f64) -> Vector3<f64> {
        self.at(share).0
    }

    /// Pose of the cross-section at a share of its length, 0 to 1: `z` is the tangent of the centre line.
    pub fn pose(&self, share: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_scaled_axis(self.turn * share) * self.rotation;
        Isometry3::from_parts(self.point_m(share).into(), rotation)
    }

    /// Point, m, and unit tangent at a share of the length: the exponential of a share of the screw, applied to the origin.
    pub(super) fn at(&self, share: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [along, across, inwards] = &self.frame;
        if self.angle_rad == 0.0 {
            return (self.start_m + along * (share * self.length_m), *along);
        }
        let [sine, first, second] = coefficients(self.angle_rad * share);
        let square = share * share;
        let path = along * share + across * (square * first) + inwards * (square * share * second);
        let tangent = along + across * (share * sine) + inwards * (square * first);
        (self.start_m + path * self.length_m, tangent)
    }
}

/// `sin(u)/u`, `(1 - cos u)/u^2`, `(u - sin u)/u^3`.
fn coefficients(u: f64) -> [f64; 3] {
    let square = u * u;
    if u < SMALL_ANGLE_RAD {
        let series = |a: f64, b: f64, c: f64, d: f64| a + square * (b + square * (c + square * d));
        return [
            series(1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0),
            series(0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0),
            series(1.0 / 6.0, -1.0 / 120.0, 1.0 / 5040.0, -1.0 / 362_880.0),
        ];
    }
    let (sine, cosine) = u.sin_cos();
    [sine / u, (1.0 - cosine) / square, (u - sine) / (square * u)]
}

/// A limb as a solid: its centre line with a radius along it.
///
/// ```
/// use softlimb_scene::collision::{Body, Shape};
///
/// let mut body = Body::new(&nalgebra::Isometry3::identity());
/// body.rigid(1.0, 0.05);
/// let ball = Shape::sphere([0.3, 0.0, 0.5], 0.1)?;
/// assert!((body.clearance(&ball).unwrap().distance_m - 0.15).abs() < 1e-5);
/// # Ok::<(), softlimb_files::range::OutOfRange>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pieces: Vec<Piece>,
    end: Isometry3<f64>,
}

impl Body {
    /// A body without pieces that is about to grow along the `z` axis of `base`.
    pub fn new(base: &Isometry3<f64>) -> Self {
        Self { pieces: Vec::new(), end: *base }
    }

    /// Removes all pieces and starts again at `base`, in the memory that is already there.
    pub fn restart(&mut self, base: &Isometry3<f64>) {
        self.pieces.clear();
        self.end = *base;
    }

    /// Adds the centre line of a module that bends towards its mount angle (rad), with a radius (m; >= 0) about it.
    pub fn module(&mut self, segment: &Segment<f64>, mount_angle_rad: f64, radius_m: f64) {
        let link = Link { segment: *segment, mount_angle_rad, rigid_length_m: 0.0 };
        let (sine, cosine) = mount_angle_rad.sin_cos();
        let turn = Vector3::new(-sine * segment.bend_angle_rad, cosine * segment.bend_angle_rad, segment.twist_rad);
        self.add(segment.length_m, radius_m, turn, segment.bend_angle_rad);
        self.end *= link.pose();
    }

    /// Adds the centre line of a part whose end is at the exponential of a screw: of a turn (rad) and a shift (m) in the frame of its start.
    pub fn screw(&mut self, turn: &Vector3<f64>, shift: &Vector3<f64>, radius_m: f64) {
        let (rotation, length_m) = (self.end.rotation, shift.norm());
        if length_m > 0.0 {
            let along = shift / length_m;
            let piece = self.piece(rotation * along, length_m, radius_m, rotation * turn, turn.cross(&along).norm());
            self.end.translation.vector = piece.point_m(1.0);
            self.pieces.push(piece);
        }
        self.end.rotation = rotation * UnitQuaternion::from_scaled_axis(*turn);
    }

    /// Adds a body of revolution that hangs upright from the end and leaves the end where it is: how far it reaches above and below the end (m;
    /// >= 0), and its radius (m; >= 0). Its ends are rounded.
    pub fn hanging(&mut self, above_m: f64, below_m: f64, radius_m: f64) {
        let (top_m, bottom_m) = (above_m - radius_m, radius_m - below_m);
        let middle_m = 0.5 * (top_m + bottom_m);
        let (top_m, bottom_m) = (top_m.max(middle_m), bottom_m.min(middle_m));
        let end_m = self.end.translation.vector;
        self.pieces.push(Piece {
            start_m: end_m + Vector3::z() * top_m,
            length_m: top_m - bottom_m,
            radius_m,
            angle_rad: 0.0,
            curvature_per_m: 0.0,
            frame: [-Vector3::z(), Vector3::zeros(), Vector3::zeros()],
            // Its `z` axis points down, as the line does.
            rotation: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
            turn: Vector3::zeros(),
        });
    }

    /// Adds a straight rigid part, as a connector or a tool, of a length (m; >= 0) and a radius (m; >= 0).
    pub fn rigid(&mut self, length_m: f64, radius_m: f64) {
        self.add(length_m, radius_m, Vector3::zeros(), 0.0);
        self.end *= Translation3::new(0.0, 0.0, length_m);
    }

    /// A part of no length has no piece of its own.
    fn add(&mut self, length_m: f64, radius_m: f64, turn: Vector3<f64>, bend_rad: f64) {
        if length_m <= 0.0 {
            return;
        }
        let (along, turn) = (self.end.rotation * Vector3::z(), self.end.rotation * turn);
        self.pieces.push(self.piece(along, length_m, radius_m, turn, bend_rad.abs()));
    }

    /// The piece from the end on with a tangent at its start, and a turn, rad, of which `bend_rad` curves it.
    fn piece(&self, along: Vector3<f64>, length_m: f64, radius_m: f64, turn: Vector3<f64>, bend_rad: f64) -> Piece {
        let across = turn.cross(&along);
        Piece {
            start_m: self.end.translation.vector,
            length_m,
            radius_m,
            angle_rad: turn.norm(),
            curvature_per_m: bend_rad / length_m,
            frame: [along, across, turn.cross(&across)],
            rotation: self.end.rotation,
            turn,
        }
    }

    /// Its pieces from the base outwards. Parts of no length have none.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Pose of its end, where the next piece would start.
    pub fn end(&self) -> &Isometry3<f64> {
        &self.end
    }
}
