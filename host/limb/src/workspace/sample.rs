//! Samples of the box: points of low discrepancy, or random ones for comparison, the same on any number of threads.

use std::thread;

use super::space::Workspace;
use softlimb_numerics::{Kronecker, uniform_at};

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

/// A number in `0..1` by seed, sample and axis.
pub(super) fn random(seed: u64, index: usize, axis: usize) -> f64 {
    uniform_at(seed, (index * 32 + axis) as u64)
}

/// Tips of `count` samples, m, on as many threads as asked for (at least one). Samples depend on the seed and their number alone.
pub fn sample(space: &Workspace<'_>, points: Points, count: usize, seed: u64, threads: usize) -> Vec<[f64; 3]> {
    run(space, &shares(space.axes().len(), points, seed), count, threads)
}

/// Shares of the highest pressures by sample and axis.
pub(super) fn shares(axes: usize, points: Points, seed: u64) -> impl Fn(usize, usize) -> f64 + Sync {
    let sequence = Kronecker::new(axes, seed);
    let even = move |index, axis| sequence.coordinate(index, axis);
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
