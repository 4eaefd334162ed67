//! Samples of the box: points of low discrepancy, or random ones for comparison, the same on any number of threads.

use std::thread;

use super::space::Workspace;

/// Samples that a thread takes at a time.
const PIECE: usize = 4096;
/// Ends of the share of each axis that goes to the inside of the box; the rest lies on its faces.
const FACES: [f64; 2] = [1.0 / 6.0, 5.0 / 6.0];

/// How the box is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// Low discrepancy, a third of each coordinate at its ends: for pictures, since most of a workspace's surface comes from there.
    Faces,
    /// Low discrepancy, even over the box.
    Even,
    /// Independent random numbers, even over the box.
    Random,
}

/// Points of low discrepancy: multiples of powers of the root of `x^(d+1) = x + 1`, from an offset by seed.
pub(super) struct Sequence {
    pub(super) offsets: Vec<f64>,
    pub(super) steps: Vec<f64>,
}

impl Sequence {
    pub(super) fn new(axes: usize, seed: u64) -> Self {
        let mut root = 1.5_f64;
        for _ in 0..60 {
            root = (1.0 + root).powf(1.0 / (axes as f64 + 1.0));
        }
        let steps = (0..axes).map(|axis| root.powi(-(axis as i32 + 1))).collect();
        let offsets = (0..axes).map(|axis| if seed == 0 { 0.5 } else { random(seed, 0, axis) }).collect();
        Self { offsets, steps }
    }
}

/// Their coordinates by number and axis.
pub(super) fn kronecker(axes: usize, seed: u64) -> impl Fn(usize, usize) -> f64 + Sync {
    let Sequence { offsets, steps } = Sequence::new(axes, seed);
    move |index, axis| {
        let place = offsets[axis] + (index as f64 + 1.0) * steps[axis];
        place - place.floor()
    }
}

/// A number of 0 to 1 by seed, sample and axis: the mixing function of SplitMix64.
pub(super) fn random(seed: u64, index: usize, axis: usize) -> f64 {
    let mut z = seed.wrapping_add((index as u64 * 32 + axis as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Tips of `count` samples, m, on as many threads as asked for (at least one). Samples depend on the seed and their number alone.
pub fn sample(space: &Workspace<'_>, points: Points, count: usize, seed: u64, threads: usize) -> Vec<[f64; 3]> {
    run(space, &shares(space.axes().len(), points, seed), count, threads)
}

/// Shares of the highest pressures by sample and axis.
pub(super) fn shares(axes: usize, points: Points, seed: u64) -> impl Fn(usize, usize) -> f64 + Sync {
    let even = kronecker(axes, seed);
    let [low, high] = FACES;
    move |index, axis| match points {
        Points::Even => even(index, axis),
        Points::Random => random(seed, index, axis),
        Points::Faces => ((even(index, axis) - low) / (high - low)).clamp(0.0, 1.0),
    }
}

fn run(
    space: &Workspace<'_>,
    share: &(impl Fn(usize, usize) -> f64 + Sync),
    count: usize,
    threads: usize,
) -> Vec<[f64; 3]> {
    in_parts(count, threads, |first, tips| {
        space.tips(tips.len(), |index, axis| share(first + index, axis), tips);
    })
}

/// `count` points, filled in parts by as many threads; `fill` is told with which number its part begins, a multiple of a power of two.
pub(super) fn in_parts<T: Copy + Default + Send>(
    count: usize,
    threads: usize,
    fill: impl Fn(usize, &mut [[T; 3]]) + Sync,
) -> Vec<[T; 3]> {
    let mut points = vec![[T::default(); 3]; count];
    let threads = threads.clamp(1, count.div_ceil(PIECE).max(1));
    let length = count.div_ceil(threads).next_multiple_of(PIECE).max(1);
    thread::scope(|scope| {
        for (part, points) in points.chunks_mut(length).enumerate() {
            let fill = &fill;
            let mut fill = move || fill(part * length, points);
            if threads == 1 {
                fill();
            } else {
                scope.spawn(fill);
            }
        }
    });
    points
}
