//! A round plate with a socket and a hole for each actuator.
//!
//! Each actuator has the part of the plate that is nearer to its axis than to any other. It is convex, so that the strip between a hole in it and
//! its edge is divided by angles about the axis. Neighbours share the corners of their common edge.

use std::f64::consts::TAU;

use super::super::path::step_rad;
use super::mesh::Mesh;

/// Points nearer to each other than this are one, m.
const SAME_M: f64 = 1e-8;

/// A plate from `z = 0` up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plate {
    pub(super) radius_m: f64,
    pub(super) thickness_m: f64,
    /// Axes of the actuators, m.
    pub(super) axes_m: Vec<[f64; 2]>,
    /// Radius and depth of the sockets below; `None` for none.
    pub(super) socket_m: Option<[f64; 2]>,
    /// Radius of the holes, m.
    pub(super) hole_m: f64,
}

/// Points of the plane with their numbers.
#[derive(Default)]
struct Places {
    points: Vec<[f64; 2]>,
}

impl Places {
    /// The number of a point, known or new.
    fn number(&mut self, point: [f64; 2]) -> usize {
        let near = |known: &[f64; 2]| (known[0] - point[0]).hypot(known[1] - point[1]) < SAME_M;
        self.points.iter().position(near).unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }
}

/// A closed line about an axis: angles and numbers, by rising angle; the first again at the end, once around.
type Loop = Vec<(f64, usize)>;

impl Plate {
    pub(super) fn mesh(&self, chord_m: f64) -> Mesh {
        let mut places = Places::default();
        let cells: Vec<Loop> = (0..self.axes_m.len()).map(|index| self.cell(index, chord_m, &mut places)).collect();
        let edge = places.points.len();
        let mut circle = |axis: [f64; 2], radius_m: f64| -> Loop {
            let sides = (TAU / step_rad(radius_m, chord_m)).ceil().max(12.0) as usize;
            let angle = |side: usize| TAU * side as f64 / sides as f64;
            let first = places.points.len();
            places.points.extend((0..sides).map(|side| {
                let (sin, cos) = angle(side).sin_cos();
                [axis[0] + radius_m * cos, axis[1] + radius_m * sin]
            }));
            (0..=sides).map(|side| (angle(side), first + side % sides)).collect()
        };
        let holes: Vec<Loop> = self.axes_m.iter().map(|axis| circle(*axis, self.hole_m)).collect();
        let sockets: Option<Vec<Loop>> =
            self.socket_m.map(|[radius_m, _]| self.axes_m.iter().map(|axis| circle(*axis, radius_m)).collect());
        let mut solid = Solid { points: &places.points, mesh: Mesh::default(), layers: Vec::new() };
        let depth_m = self.socket_m.map_or(0.0, |[_, depth_m]| depth_m);
        let [bottom, floor, top] = [0.0, depth_m, self.thickness_m].map(|height_m| solid.layer(height_m));
        for (index, cell) in cells.iter().enumerate() {
            solid.strip((&holes[index], top), (cell, top));
            let below = sockets.as_ref().map_or(&holes[index], |sockets| &sockets[index]);
            solid.strip((cell, bottom), (below, bottom));
            match &sockets {
                Some(sockets) => {
                    solid.strip((&sockets[index], bottom), (&sockets[index], floor));
                    solid.strip((&sockets[index], floor), (&holes[index], floor));
                    solid.strip((&holes[index], floor), (&holes[index], top));
                }
                None => solid.strip((&holes[index], bottom), (&holes[index], top)),
            }
        }
        // The edges of the plate are those of one cell alone.
        let edges = || cells.iter().flat_map(|cell| cell.windows(2).map(|pair| [pair[0].1, pair[1].1]));
        let known: std::collections::HashSet<[usize; 2]> = edges().collect();
        for [from, to] in edges().filter(|[from, to]| !known.contains(&[*to, *from])) {
            debug_assert!(from < edge && to < edge);
            solid.strip((&vec![(0.0, from), (1.0, to)], top), (&vec![(0.0, from), (1.0, to)], bottom));
        }
        solid.mesh
    }

    /// The edge of the part of an actuator, counter-clockwise, with corners no further apart than the plate's own.
    fn cell(&self, index: usize, chord_m: f64, places: &mut Places) -> Loop {
        let axis = self.axes_m[index];
        let sides = (TAU / step_rad(self.radius_m, chord_m)).ceil().max(24.0) as usize;
        let part_m = TAU * self.radius_m / sides as f64;
        let mut edge: Vec<[f64; 2]> = (0..sides)
            .map(|side| {
                let (sin, cos) = (TAU * side as f64 / sides as f64).sin_cos();
                [self.radius_m * cos, self.radius_m * sin]
            })
            .collect();
        for other in self.axes_m.iter().filter(|other| **other != axis) {
            let way = [other[0] - axis[0], other[1] - axis[1]];
            let middle = [0.5 * (other[0] + axis[0]), 0.5 * (other[1] + axis[1])];
            edge = nearer(&edge, |point| way[0] * (point[0] - middle[0]) + way[1] * (point[1] - middle[1]));
        }
        let corners = edge.len();
        let mut numbers: Vec<usize> = Vec::new();
        for corner in 0..corners {
            let [from, to] = [edge[corner], edge[(corner + 1) % corners]];
            let parts = ((to[0] - from[0]).hypot(to[1] - from[1]) / part_m).ceil().max(1.0) as usize;
            for part in 0..parts {
                let share = part as f64 / parts as f64;
                let number = places.number([0, 1].map(|i: usize| from[i] + (to[i] - from[i]) * share));
                if numbers.last() != Some(&number) {
                    numbers.push(number);
                }
            }
        }
        numbers.dedup();
        if numbers.len() > 1 && numbers.first() == numbers.last() {
            numbers.pop();
        }
        let angle = |number: usize| {
            let [x, y] = places.points[number];
            (y - axis[1]).atan2(x - axis[0]).rem_euclid(TAU)
        };
        let mut line: Loop = numbers.into_iter().map(|number| (angle(number), number)).collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        line.push((line[0].0 + TAU, line[0].1));
        line
    }
}

/// The part of a convex line where a function of the place is not positive.
fn nearer(edge: &[[f64; 2]], side: impl Fn(&[f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for (index, from) in edge.iter().enumerate() {
        let to = &edge[(index + 1) % edge.len()];
        let [a, b] = [side(from), side(to)];
        if a <= 0.0 {
            kept.push(*from);
        }
        if a * b < 0.0 {
            let share = a / (a - b);
            kept.push([0, 1].map(|i: usize| from[i] + (to[i] - from[i]) * share));
        }
    }
    kept
}

/// Points of the plane at several heights.
struct Solid<'a> {
    points: &'a [[f64; 2]],
    mesh: Mesh,
    /// Height, and the number of each point there once it is used.
    layers: Vec<(f64, Vec<Option<u32>>)>,
}

impl Solid<'_> {
    fn layer(&mut self, height_m: f64) -> usize {
        self.layers.push((height_m, vec![None; self.points.len()]));
        self.layers.len() - 1
    }

    fn corner(&mut self, layer: usize, number: usize) -> u32 {
        let (height_m, known) = &mut self.layers[layer];
        let [x, y] = self.points[number];
        *known[number].get_or_insert_with(|| self.mesh.add([x, y, *height_m]))
    }

    /// Triangles between two lines by rising coordinate; their normal is that of (from one line to the other) x (along the lines).
    fn strip(&mut self, (from, here): (&Loop, usize), (to, there): (&Loop, usize)) {
        let (mut a, mut b) = (0, 0);
        while a + 1 < from.len() || b + 1 < to.len() {
            let along_from = b + 1 == to.len() || (a + 1 < from.len() && from[a + 1].0 <= to[b + 1].0);
            let last = if along_from { (here, from[a + 1].1) } else { (there, to[b + 1].1) };
            let corners = [(here, from[a].1), (there, to[b].1), last];
            let triangle = corners.map(|(layer, number)| self.corner(layer, number));
            self.mesh.triangles.push(triangle);
            if along_from { a += 1 } else { b += 1 }
        }
    }
}
