//! The limb in one configuration, and how any of its points moves with every variable.

use fra_model::Segment;
use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};

use super::arc::Arc;
use super::response::{FIELDS, RADIUS};
use super::task::Task;
use softlimb_scene::collision::Body;

/// What moves one module: two sizes of the section, fiber angle, length, mount angle, and its share at two way-points.
pub(super) const COLUMNS: usize = 7;
/// Index of the mount angle.
pub(super) const MOUNT: usize = 4;

/// The shape of one module: length of its centre line (m), bend and twist (rad), radius of its body (m), pressure (Pa); with derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bundle {
    pub(super) value: [f64; FIELDS],
    pub(super) by: [[f64; COLUMNS]; FIELDS],
    pub(super) mount_angle_rad: f64,
    /// Its derivative by its variable.
    pub(super) by_mount: f64,
    /// Lengths of the rigid parts behind it, m: connector and tool.
    pub(super) rigid_m: [f64; 2],
}

/// One module in its place.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    bundle: Bundle,
    start: Vector3<f64>,
    axis: Vector3<f64>,
    /// Frame at the start, turned by the mount angle.
    frame: Matrix3<f64>,
    /// Derivatives of the end and turns of what follows, in the task's frame.
    by: [Vector3<f64>; 3],
    turn: [Vector3<f64>; 2],
    pub(super) end: Vector3<f64>,
    pub(super) end_axis: Vector3<f64>,
}

/// A point of the body.
#[derive(Clone, Copy, Debug)]
pub(super) enum On {
    /// On the centre line of the module, at a share of its length.
    Module(f64),
    /// On the rigid part behind it.
    Rigid,
}

/// All modules in their places.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub(super) joints: Vec<Joint>,
    pub(super) tip: Vector3<f64>,
    pub(super) tip_axis: Vector3<f64>,
}

impl Chain {
    pub(super) fn place(&mut self, base: &Isometry3<f64>, bundles: impl Iterator<Item = Bundle>) {
        self.joints.clear();
        let mut start = base.translation.vector;
        let mut rotation: Matrix3<f64> = base.rotation.to_rotation_matrix().into_inner();
        for bundle in bundles {
            let [length, bend, twist, ..] = bundle.value;
            let arc = Arc::new(length, bend, twist);
            let mount = Rotation3::from_axis_angle(&Vector3::z_axis(), bundle.mount_angle_rad).into_inner();
            let frame = rotation * mount;
            let end = start + frame * arc.point;
            let axis = rotation.column(2).into_owned();
            rotation = frame * arc.rotation * mount.transpose();
            let end_axis = rotation.column(2).into_owned();
            self.joints.push(Joint {
                bundle,
                start,
                axis,
                frame,
                by: arc.by.map(|by| frame * by),
                turn: arc.turn.map(|turn| frame * turn),
                end,
                end_axis,
            });
            start = end + end_axis * bundle.rigid_m.iter().sum::<f64>();
        }
        (self.tip, self.tip_axis) = (start, rotation.column(2).into_owned());
    }

    /// The solid that the limb is, by its own kinematics: segments and mount angles, not the places found here.
    pub(super) fn body(&self, task: &Task, start: &Isometry3<f64>) -> Body {
        let mut body = Body::new(start);
        for joint in &self.joints {
            let [length_m, bend_angle_rad, twist_rad, radius, _] = joint.bundle.value;
            let segment = Segment { length_m, bend_angle_rad, twist_rad };
            body.module(&segment, joint.bundle.mount_angle_rad, radius);
            let [connector_m, tool_m] = joint.bundle.rigid_m;
            body.rigid(connector_m, task.connector_m[1]);
            body.rigid(tool_m, task.tool_m[1]);
        }
        body
    }

    /// How fast a point of module `index` moves along `normal` with every variable: `COLUMNS` of each module, added to `row`.
    pub(super) fn row(&self, index: usize, on: On, point: &Vector3<f64>, normal: &Vector3<f64>, row: &mut [f64]) {
        for (joint, columns) in self.joints[..index].iter().zip(row.chunks_exact_mut(COLUMNS)) {
            joint.behind(point, normal, columns);
        }
        let (joint, columns) = (&self.joints[index], &mut row[index * COLUMNS..(index + 1) * COLUMNS]);
        match on {
            On::Rigid => joint.behind(point, normal, columns),
            On::Module(share) => joint.within(share, point, normal, columns),
        }
    }

    /// How fast the component of the tip's axis along `normal` changes with every variable.
    pub(super) fn axis_row(&self, normal: &Vector3<f64>, row: &mut [f64]) {
        let turned = self.tip_axis.cross(normal);
        for (joint, columns) in self.joints.iter().zip(row.chunks_exact_mut(COLUMNS)) {
            let rates = [0.0, joint.turn[0].dot(&turned), joint.turn[1].dot(&turned)];
            joint.spread(rates, (joint.axis - joint.end_axis).dot(&turned), columns);
        }
    }
}

impl Joint {
    /// Radius of the body of the module, m, and its derivatives.
    pub(super) fn radius(&self) -> (f64, &[f64; COLUMNS]) {
        (self.bundle.value[RADIUS], &self.bundle.by[RADIUS])
    }

    /// The derivatives of one of its [`values`](Self::values).
    pub(super) fn slopes(&self, field: usize) -> &[f64; COLUMNS] {
        &self.bundle.by[field]
    }

    /// Length of the centre line (m), bend and twist (rad), radius of the body (m), and pressure (Pa).
    pub(super) fn values(&self) -> &[f64; FIELDS] {
        &self.bundle.value
    }

    /// Length of the centre line of the module and of the rigid parts behind it, m.
    pub(super) fn lengths(&self) -> [f64; 2] {
        [self.bundle.value[0], self.bundle.rigid_m.iter().sum()]
    }

    /// Lengths of the rigid parts behind it, m: connector and tool.
    pub(super) fn rigid_m(&self) -> [f64; 2] {
        self.bundle.rigid_m
    }

    /// The point of the centre line at a share of its length.
    pub(super) fn point(&self, share: f64) -> Vector3<f64> {
        let [length, bend, twist, ..] = self.bundle.value;
        self.start + self.frame * super::arc::point(length * share, bend * share, twist * share)
    }

    /// A point that the end of this module carries.
    fn behind(&self, point: &Vector3<f64>, normal: &Vector3<f64>, columns: &mut [f64]) {
        let lever = (point - self.end).cross(normal);
        let rates = [
            self.by[0].dot(normal),
            self.by[1].dot(normal) + self.turn[0].dot(&lever),
            self.by[2].dot(normal) + self.turn[1].dot(&lever),
        ];
        let mount = self.axis.dot(&(point - self.start).cross(normal)) - self.end_axis.dot(&lever);
        self.spread(rates, mount, columns);
    }

    /// A point of this module's own centre line.
    fn within(&self, share: f64, point: &Vector3<f64>, normal: &Vector3<f64>, columns: &mut [f64]) {
        let [length, bend, twist, ..] = self.bundle.value;
        let arc = Arc::new(length * share, bend * share, twist * share);
        let local = self.frame.tr_mul(normal);
        let rates = arc.by.map(|by| share * by.dot(&local));
        self.spread(rates, self.axis.dot(&(point - self.start).cross(normal)), columns);
    }

    fn spread(&self, rates: [f64; 3], mount: f64, columns: &mut [f64]) {
        for (rate, by) in rates.iter().zip(&self.bundle.by) {
            columns.iter_mut().zip(by).for_each(|(sum, by)| *sum += rate * by);
        }
        columns[MOUNT] += mount * self.bundle.by_mount;
    }
}
