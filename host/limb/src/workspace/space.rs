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
    /// Its polynomials are those of one arc.
    #[error(
        "module `{0}` has several segments, and the workspace takes modules of one: `check` and `run` take segments"
    )]
    Segments(String),
    /// A limb has at most 27 channels.
    #[error("the limb has {0} pressures to choose; at most 27 are looked at")]
    TooMany(usize),
}

/// A limb whose tip can be asked for often: as a function of shares, 0 to 1, of the highest pressures.
#[derive(Clone, Debug)]
pub struct Workspace<'a> {
    limb: &'a Limb,
    command: Command,
    modules: Vec<Module>,
    single: Vec<single::Module>,
    axes: Vec<Axis>,
}

impl<'a> Workspace<'a> {
    /// Prepares a limb.
    ///
    /// # Errors
    /// [`WorkspaceError`], as its variants say.
    pub fn new(limb: &'a Limb, command: Command) -> Result<Self, WorkspaceError> {
        let (mut modules, mut single, mut axes) = (Vec::new(), Vec::new(), Vec::new());
        for (index, module) in limb.modules().iter().enumerate() {
            if module.is_series() {
                return Err(WorkspaceError::Segments(module.name.clone()));
            }
            let pressure_max_pa = module.curve.pressure_max_pa();
            let ends_at_limit = pressure_max_pa < module.reference_max_pa * (1.0 - 1e-9);
            let made = Module::new(module, pressure_max_pa, each(module, command));
            let made = made.ok_or_else(|| WorkspaceError::Module(module.name.clone()))?;
            let width = module.channels.len() / made.axes();
            for axis in 0..made.axes() {
                let start = module.channels.start + axis * width;
                axes.push(Axis { module: index, channels: start..start + width, pressure_max_pa, ends_at_limit });
            }
            let picture = single::Module::new(&made.parts());
            single.push(picture.ok_or_else(|| WorkspaceError::Module(module.name.clone()))?);
            modules.push(made);
        }
        if axes.len() > AXES_MAX {
            return Err(WorkspaceError::TooMany(axes.len()));
        }
        Ok(Self { limb, command, modules, single, axes })
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
        let link = |(index, module): (usize, &LimbModule)| {
            let own = self.axes.iter().zip(shares).filter(|(axis, _)| axis.module == index);
            let pressures: Vec<f64> = own
                .flat_map(|(axis, share)| std::iter::repeat_n(share * axis.pressure_max_pa, axis.channels.len()))
                .collect();
            free_link(module, &pressures)
        };
        self.limb.modules().iter().enumerate().map(link).collect()
    }

    /// The modules in single precision.
    pub(super) fn single(&self) -> &[single::Module] {
        &self.single
    }

    /// The polynomials of the modules.
    pub fn tables(&self) -> Vec<ModuleTable> {
        self.modules.iter().map(Module::table).collect()
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
        let mut end = self.axes.len();
        for module in self.modules.iter().rev() {
            let start = end - module.axes();
            point = module.carry(&shares[start..end], point);
            end = start;
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
    let straight = matches!(module.motion, Motion::Extension | Motion::Expansion);
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
