//! The response of all sections within the bounds, as a polynomial.
//!
//! Chebyshev nodes in the two sizes of the section, the fiber angle and the share of the reach; what is interpolated is the exact model.
//! The search runs on the polynomial and its derivatives. Its error (some 1e-4 of a deformation; more where the cap changes from one
//! bound to another within the box) costs no accuracy of an answer: that is made with a table of the found section alone, whose only
//! variable is the share, and is then asked of the model.

use std::f64::consts::PI;

use super::response::{FIELDS, Section};
use super::task::{Behind, Space, TaskError};

/// Most nodes in the share.
const DEPTH: usize = 12;
/// Nodes in the share while sections are searched.
const SEARCH_DEPTH: usize = 7;
/// Nodes in each variable of the section.
const NODES: usize = 5;

/// The polynomial of one module.
#[derive(Clone, Debug)]
pub(super) struct Table {
    sizes: [usize; 3],
    depth: usize,
    /// Coefficients by section node, field and share.
    coefficients: Vec<f64>,
    /// Distance of the farthest actuator from the module's axis, m.
    reach_m: f64,
    /// Length of the end at the tip, m.
    end_m: f64,
    behind: Behind,
}

/// The response of one section: polynomials in the share, with their derivatives by the section.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    depth: usize,
    /// Value, then the derivatives by the three variables of the section.
    by: [[[f64; DEPTH]; FIELDS]; 4],
}

/// One deformation of one section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) value: [f64; FIELDS],
    /// By the two sizes and the fiber angle, in units of the unit box.
    pub(super) by_section: [[f64; 3]; FIELDS],
    pub(super) by_share: [f64; FIELDS],
}

/// `T_k(2x - 1)` and its derivative by `x`.
fn chebyshev<const N: usize>(x: f64) -> ([f64; N], [f64; N]) {
    let y = 2.0 * x - 1.0;
    let (mut value, mut slope) = ([0.0; N], [0.0; N]);
    value[0] = 1.0;
    if N > 1 {
        (value[1], slope[1]) = (y, 2.0);
    }
    for k in 2..N {
        value[k] = 2.0 * y * value[k - 1] - value[k - 2];
        slope[k] = 4.0 * value[k - 1] + 2.0 * y * slope[k - 1] - slope[k - 2];
    }
    (value, slope)
}

/// Rising nodes in `0..1`: the zeros of `T_n`.
fn nodes(count: usize) -> Vec<f64> {
    (0..count).rev().map(|i| 0.5 + 0.5 * (PI * (i as f64 + 0.5) / count as f64).cos()).collect()
}

/// Values at the nodes to coefficients, along one axis of a tensor of `count` entries that are `stride` apart.
fn transform(values: &mut [f64], count: usize, stride: usize) {
    let mut line = vec![0.0; count];
    for start in (0..values.len()).filter(|index| (index / stride).is_multiple_of(count)) {
        for (k, entry) in line.iter_mut().enumerate() {
            let angle = |i: usize| PI * k as f64 * ((count - 1 - i) as f64 + 0.5) / count as f64;
            let sum: f64 = (0..count).map(|i| values[start + i * stride] * angle(i).cos()).sum();
            *entry = sum * if k == 0 { 1.0 } else { 2.0 } / count as f64;
        }
        line.iter().enumerate().for_each(|(k, entry)| values[start + k * stride] = *entry);
    }
}

impl Table {
    /// The table of all sections within the bounds.
    pub(super) fn new(space: &Space) -> Result<Self, TaskError> {
        Self::with(space, SEARCH_DEPTH)
    }

    /// A table with the most nodes in the share, for bounds that leave one section.
    pub(super) fn fine(space: &Space) -> Result<Self, TaskError> {
        Self::with(space, DEPTH)
    }

    fn with(space: &Space, depth: usize) -> Result<Self, TaskError> {
        let sizes = section_widths(space).map(|width| if width > 0.0 { NODES } else { 1 });
        let shares = nodes(depth);
        let mut values = Vec::with_capacity(sizes.iter().product::<usize>() * FIELDS * depth);
        let along = sizes.map(nodes);
        let bounds = |reason| TaskError::Bounds { place: format!("module {}", space.segment.name), reason };
        let mut sections = Vec::with_capacity(sizes.iter().product());
        for x in &along[0] {
            for y in &along[1] {
                for z in &along[2] {
                    sections.push(Section::analytic(space, &[*x, *y, 0.5, *z]).map_err(bounds)?);
                }
            }
        }
        // One model for all: between two models the polynomial would have a step.
        let by_elements = sections.iter().any(Section::errs);
        for section in sections {
            let section = if by_elements { section.with_elements() } else { Ok(section) };
            let fields = section.and_then(|section| section.fields(&shares)).map_err(bounds)?;
            (0..FIELDS).for_each(|field| values.extend(fields.iter().map(|at| at[field])));
        }
        let inner = FIELDS * depth;
        transform(&mut values, depth, 1);
        transform(&mut values, sizes[2], inner);
        transform(&mut values, sizes[1], inner * sizes[2]);
        transform(&mut values, sizes[0], inner * sizes[2] * sizes[1]);
        Ok(Self {
            sizes,
            depth,
            coefficients: values,
            reach_m: space.reach_m,
            end_m: space.ends_m[1],
            behind: space.behind(),
        })
    }

    /// Distance of the farthest actuator from the module's axis, m.
    pub(super) fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// Length of the end at the tip, m.
    pub(super) fn end_m(&self) -> f64 {
        self.end_m
    }

    /// Its end and joint to the module before it.
    pub(super) fn behind(&self) -> Behind {
        self.behind
    }

    /// The response of the section at a place of its unit box.
    pub(super) fn curve(&self, place: [f64; 3]) -> Curve {
        let basis = place.map(chebyshev::<NODES>);
        let mut by = [[[0.0; DEPTH]; FIELDS]; 4];
        let inner = FIELDS * self.depth;
        let [nx, ny, nz] = self.sizes;
        for x in 0..nx {
            for y in 0..ny {
                for z in 0..nz {
                    let (v, s) = (|i: usize, k: usize| basis[i].0[k], |i: usize, k: usize| basis[i].1[k]);
                    let (xy, zv) = (v(0, x) * v(1, y), v(2, z));
                    let weights = [xy * zv, s(0, x) * v(1, y) * zv, v(0, x) * s(1, y) * zv, xy * s(2, z)];
                    let start = ((x * ny + y) * nz + z) * inner;
                    for (field, line) in self.coefficients[start..start + inner].chunks_exact(self.depth).enumerate() {
                        for (weight, by) in weights.iter().zip(by.iter_mut()) {
                            by[field].iter_mut().zip(line).for_each(|(sum, value)| *sum += weight * value);
                        }
                    }
                }
            }
        }
        Curve { depth: self.depth, by }
    }
}

impl Curve {
    /// The response at a share of the reach.
    pub(super) fn at(&self, share: f64) -> Sample {
        let (value, slope) = chebyshev::<DEPTH>(share);
        let dot = |line: &[f64; DEPTH], basis: &[f64; DEPTH]| (0..self.depth).map(|k| line[k] * basis[k]).sum::<f64>();
        let fields: [usize; FIELDS] = std::array::from_fn(|field| field);
        Sample {
            value: fields.map(|field| dot(&self.by[0][field], &value)),
            by_section: fields.map(|field| [1, 2, 3].map(|axis: usize| dot(&self.by[axis][field], &value))),
            by_share: fields.map(|field| dot(&self.by[0][field], &slope)),
        }
    }
}

/// Widths of the bounds of the two sizes and the fiber angle.
pub(super) fn section_widths(space: &Space) -> [f64; 3] {
    let angle = if space.motion() == fra_model::Motion::Bending { 0.0 } else { space.segment.axis(3)[1] };
    [space.segment.axis(0)[1], space.segment.axis(1)[1], angle]
}
