//! The box of pressures and the way from it to the tip.

use std::ops::Range;

use fra_model::{Link, Motion, Segment};
use nalgebra::Point3;
use pulp::{Arch, Simd, WithSimd};
use thiserror::Error;

use super::lanes::{LANES, Pack};
use super::module::{Module, ModuleTable};
use super::single;
use crate::statics::Bundle;
use crate::{Limb, LimbModule};

/// Points of a module's centre line in a picture.
const LINE_POINTS: usize = 12;

/// Most pressures of a box: the channels of a device.
pub(super) const AXES_MAX: usize = 27;

/// What is free to choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// A pressure for each drive, a module or an actuator of a steering one: what setpoints of a scene can ask for.
    Modules,
    /// A pressure for each actuator of extending and expanding modules, which thereby bend; one for each other module.
    Actuators,
}

/// One pressure of the box.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Index of its module.
    pub module: usize,
    /// The channels it drives.
    pub channels: Range<usize>,
    /// Its highest gauge pressure, Pa; the lowest is 0, since no rig here has a vacuum.
    pub pressure_max_pa: f64,
    /// Whether it ends before the pressure that the scene allows: at the actuator's limit point, or where the tubes of a twisting bundle lean
    /// over by 60 degrees.
    pub ends_at_limit: bool,
}

/// Why there is no workspace.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum WorkspaceError {
    /// The model has no answer at some pressure of a module's range.
    #[error("module `{0}`: the model has no equilibrium at some pressure of its range")]
    Module(String),
    /// A limb has at most 27 channels.
    #[error("the limb has {0} pressures to choose; at most 27 are looked at")]
    TooMany(usize),
}

/// A limb whose tip can be asked for often: as a function of shares, 0 to 1, of the highest pressures.
#[derive(Clone, Debug)]
pub struct Workspace<'a> {
    limb: &'a Limb,
    command: Command,
    /// What has one winding along its length; the segments of a series share their axes.
    modules: Vec<Module>,
    single: Vec<single::Module>,
    /// The first axis of each.
    starts: Vec<usize>,
    axes: Vec<Axis>,
}

impl<'a> Workspace<'a> {
    /// Prepares a limb.
    ///
    /// # Errors
    /// [`WorkspaceError`], as its variants say.
    pub fn new(limb: &'a Limb, command: Command) -> Result<Self, WorkspaceError> {
        let (mut modules, mut single, mut starts, mut axes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (index, module) in limb.modules().iter().enumerate() {
            let pressure_max_pa = module.curve.pressure_max_pa();
            let ends_at_limit = pressure_max_pa < module.reference_max_pa * (1.0 - 1e-9);
            let each = each(module, command);
            let start = axes.len();
            for part in module.parts() {
                let none = || WorkspaceError::Module(part.name.clone());
                let made = Module::new(part, pressure_max_pa, each).ok_or_else(none)?;
                single.push(single::Module::new(&made.parts()).ok_or_else(none)?);
                starts.push(start);
                modules.push(made);
            }
            let count = if each { module.channels.len() } else { 1 };
            let width = module.channels.len() / count;
            axes.extend(module.channels.clone().step_by(width).map(|first| Axis {
                module: index,
                channels: first..first + width,
                pressure_max_pa,
                ends_at_limit,
            }));
        }
        if axes.len() > AXES_MAX {
            return Err(WorkspaceError::TooMany(axes.len()));
        }
        Ok(Self { limb, command, modules, single, starts, axes })
    }

    /// The pressures, in the order of the channels.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Where the limb starts, m.
    pub fn base(&self) -> [f64; 3] {
        self.limb.base().translation.vector.into()
    }

    /// Largest relative error of the polynomials of a module: length, angles, stiffness.
    pub fn error(&self) -> f64 {
        self.modules.iter().map(|module| module.error).fold(0.0, f64::max)
    }

    /// The tip by the polynomials, m. Missing shares are 0.
    pub fn tip(&self, shares: &[f64]) -> [f64; 3] {
        let mut tip = [[0.0; 3]];
        self.tips(1, |_, axis| shares.get(axis).copied().unwrap_or(0.0), &mut tip);
        tip[0]
    }

    /// Tips of `count` samples, at most as many as there is room for; `share` is told the sample and the axis.
    pub(super) fn tips(&self, count: usize, share: impl Fn(usize, usize) -> f64, tips: &mut [[f64; 3]]) {
        Arch::new().dispatch(Batch { space: self, count, share, tips });
    }

    /// The tip by the model itself, m; `None` where it has no equilibrium.
    pub fn tip_by_the_model(&self, shares: &[f64]) -> Option<[f64; 3]> {
        let links = self.links_by_the_model(shares)?;
        let pose = links.iter().fold(*self.limb.base(), |pose, link| pose * link.pose());
        Some((pose * Point3::origin()).coords.into())
    }

    /// The centre line by the model itself, m, at a gauge pressure of each axis, Pa; `None` where it has no equilibrium.
    pub fn line_by_the_model(&self, pressures_pa: &[f64]) -> Option<Vec<[f64; 3]>> {
        let axes = self.axes.iter().zip(pressures_pa);
        let shares: Vec<f64> = axes.map(|(axis, pressure_pa)| pressure_pa / axis.pressure_max_pa).collect();
        let mut pose = *self.limb.base();
        let mut line_m = vec![pose.translation.vector.into()];
        for link in self.links_by_the_model(&shares)? {
            let along = (1..=LINE_POINTS).map(|step| pose * link.pose_at(step as f64 / LINE_POINTS as f64));
            line_m.extend(along.map(|at| <[f64; 3]>::from(at.translation.vector)));
            pose *= link.pose();
            line_m.push(pose.translation.vector.into());
        }
        Some(line_m)
    }

    /// The modules by the model itself.
    fn links_by_the_model(&self, shares: &[f64]) -> Option<Vec<Link<f64>>> {
        let links = |(index, module): (usize, &'a LimbModule)| {
            let own = self.axes.iter().zip(shares).filter(|(axis, _)| axis.module == index);
            let pressures: Vec<f64> = own
                .flat_map(|(axis, share)| std::iter::repeat_n(share * axis.pressure_max_pa, axis.channels.len()))
                .collect();
            module.parts().iter().map(move |part| free_link(part, &pressures))
        };
        self.limb.modules().iter().enumerate().flat_map(links).collect()
    }

    /// The modules in single precision, each with its first axis.
    pub(super) fn single(&self) -> impl DoubleEndedIterator<Item = (&single::Module, usize)> {
        self.single.iter().zip(self.starts.iter().copied())
    }

    /// The limb.
    pub(super) fn limb(&self) -> &Limb {
        self.limb
    }

    /// The polynomials of the modules, of a series those of its segments.
    pub fn tables(&self) -> Vec<ModuleTable> {
        self.modules.iter().zip(&self.starts).map(|(module, start)| module.table(*start)).collect()
    }

    /// Rotation of the limb's start: its rows.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let rotation = self.limb.base().rotation.to_rotation_matrix();
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| rotation.matrix()[(row, column)]))
    }

    /// What is free to choose.
    pub fn command(&self) -> Command {
        self.command
    }

    #[inline(always)]
    fn tip_of<S: Simd>(&self, zero: Pack<S>, shares: &[Pack<S>; AXES_MAX]) -> [Pack<S>; 3] {
        let mut point = [zero; 3];
        for (module, start) in self.modules.iter().zip(&self.starts).rev() {
            point = module.carry(&shares[*start..start + module.axes()], point);
        }
        let [x, y, z] = point;
        let (m, origin) = (self.rotation(), self.limb.base().translation.vector);
        let mut tip = [zero; 3];
        for i in 0..3 {
            tip[i] = zero.same(origin[i]) + zero.same(m[i][0]) * x + zero.same(m[i][1]) * y + zero.same(m[i][2]) * z;
        }
        tip
    }
}

fn each(module: &LimbModule, command: Command) -> bool {
    // Only straight actuators bend by unequal pressures.
    let straight = module.parts().iter().all(|part| matches!(part.motion, Motion::Extension | Motion::Expansion));
    module.is_steering() || command == Command::Actuators && straight && module.channels.len() > 1
}

/// A module, rigid parts included, by its bundle.
fn free_link(module: &LimbModule, pressures_pa: &[f64]) -> Option<Link<f64>> {
    let free = Bundle::new(module, pressures_pa, module.bays())?.free;
    let [x, y] = free.bend_rad_per_m;
    let azimuth_rad = y.atan2(x);
    let segment = Segment {
        length_m: module.length_m() * free.stretch,
        bend_angle_rad: module.length_m() * x.hypot(y),
        twist_rad: module.length_m() * free.twist_rad_per_m,
    };
    Some(Link {
        segment,
        mount_angle_rad: module.mount_angle_rad() + azimuth_rad,
        rigid_length_m: module.rigid_length_m(),
    })
}

struct Batch<'a, 'b, F> {
    space: &'b Workspace<'a>,
    count: usize,
    share: F,
    tips: &'b mut [[f64; 3]],
}

impl<F: Fn(usize, usize) -> f64> WithSimd for Batch<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let axes = self.space.axes.len();
        let zero = Pack::all(simd, 0.0);
        let mut shares = [zero; AXES_MAX];
        for (group, tips) in self.tips[..self.count].chunks_mut(Pack::<S>::COUNT).enumerate() {
            for (axis, pack) in shares[..axes].iter_mut().enumerate() {
                let mut values = [0.0; LANES];
                for (lane, share) in values[..Pack::<S>::COUNT].iter_mut().enumerate() {
                    *share = (self.share)(group * Pack::<S>::COUNT + lane, axis);
                }
                *pack = Pack::load(simd, &values);
            }
            let [x, y, z] = self.space.tip_of(zero, &shares);
            let (x, y, z) = (x.store(), y.store(), z.store());
            for (lane, tip) in tips.iter_mut().enumerate() {
                *tip = [x[lane], y[lane], z[lane]];
            }
        }
    }
}
