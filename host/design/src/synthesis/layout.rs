//! Where each variable stands among those of the search, all of which go from 0 to 1.

use std::f64::consts::{PI, TAU};

use fra_model::Motion;

use super::chain::MOUNT;
use super::table::section_widths;
use super::task::Space;

/// Variables of a module that all way-points have in common: two sizes, fiber angle, length, mount angle.
pub(super) const FIXED: usize = 5;

/// The variables of a limb.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Index of each common variable; `None` where the bounds leave no choice.
    pub(super) common: Vec<[Option<usize>; FIXED]>,
    /// Least value and width of length and mount angle of each module.
    axes: Vec<[[f64; 2]; 2]>,
    free_mount: Vec<bool>,
    /// Number of common variables.
    pub(super) shared: usize,
    modules: usize,
    way_points: usize,
}

impl Layout {
    pub(super) fn new(spaces: &[&Space], way_points: usize) -> Self {
        let mut layout = Self {
            common: Vec::new(),
            axes: Vec::new(),
            free_mount: Vec::new(),
            shared: 0,
            modules: spaces.len(),
            way_points,
        };
        for space in spaces {
            let [low, high] = space.mount_angle_rad;
            let free = high - low >= TAU;
            // A free angle may go past a full turn, so that no descent ends at a bound that is not there.
            let middle = 0.5 * (low + high);
            let mount = if free { [middle - TAU, 2.0 * TAU] } else { [low, high - low] };
            let [x, y, z] = section_widths(space);
            let length = space.segment.axis(2);
            let turns = if space.motion() == Motion::Bending { mount[1] } else { 0.0 };
            // A segment shares the sizes of the section, and the turn of the first that bends.
            let before = layout.common.last().copied().filter(|_| space.joined);
            let turned = before.and_then(|before| before[MOUNT]);
            let known = [before.map(|before| before[0]), before.map(|before| before[1]), None, None, turned.map(Some)];
            let widths = [x, y, z, length[1], turns].into_iter().zip(known);
            let mut common = [None; FIXED];
            for (own, (width, known)) in common.iter_mut().zip(widths) {
                *own = known.unwrap_or_else(|| {
                    let index = layout.shared;
                    layout.shared += usize::from(width > 0.0);
                    (width > 0.0).then_some(index)
                });
            }
            layout.common.push(common);
            layout.axes.push([length, mount]);
            layout.free_mount.push(free);
        }
        layout
    }

    /// Number of variables.
    pub(super) fn width(&self) -> usize {
        self.shared + self.modules * self.way_points
    }

    /// Index of the share of a module at a way-point.
    pub(super) fn share(&self, way_point: usize, module: usize) -> usize {
        self.shared + way_point * self.modules + module
    }

    /// Place of a module's section in its unit box.
    pub(super) fn section(&self, place: &[f64], module: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis: usize| self.common[module][axis].map_or(0.5, |index| place[index]))
    }

    /// Length (m) and mount angle (rad) of a module, each with its derivative by the variable.
    pub(super) fn length_and_mount(&self, place: &[f64], module: usize) -> [[f64; 2]; 2] {
        [3, MOUNT].map(|slot: usize| {
            let [low, width] = self.axes[module][slot - 3];
            self.common[module][slot].map_or([low, 0.0], |index| [low + place[index] * width, width])
        })
    }

    /// The mount angle as an answer names it: within half a turn where it is free, rad.
    pub(super) fn mount_angle_rad(&self, place: &[f64], module: usize) -> f64 {
        let angle = self.length_and_mount(place, module)[1][0];
        if self.free_mount[module] && self.common[module][MOUNT].is_some() {
            angle - TAU * ((angle + PI) / TAU).floor()
        } else {
            angle
        }
    }

    /// A mount angle that is free goes round the half turn in the middle of its range.
    pub(super) fn wrap(&self, place: &mut [f64]) {
        for (slots, free) in self.common.iter().zip(&self.free_mount) {
            if let Some(index) = slots[MOUNT].filter(|_| *free) {
                while place[index] < 0.25 {
                    place[index] += 0.5;
                }
                while place[index] > 0.75 {
                    place[index] -= 0.5;
                }
            }
        }
    }
}
