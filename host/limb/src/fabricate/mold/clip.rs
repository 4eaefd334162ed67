//! A patch of triangles over the unrolled cylinder, and how it is cut along straight lines.

use std::collections::HashMap;

/// A corner over the unrolled cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// Angle about the axis, rad, and height, m.
    pub(super) place: [f64; 2],
    /// Radius, m.
    pub(super) radius_m: f64,
}

/// Triangles between shared corners, counter-clockwise in angle and height.
#[derive(Clone, Debug, Default)]
pub(super) struct Patch {
    pub(super) spots: Vec<Spot>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Coordinates of a spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Angle,
    Height,
}

/// A line of constant angle or height; what is on its side `side` (1 above, -1 below) is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) axis: Axis,
    pub(super) at: f64,
    pub(super) side: f64,
    /// Corners so near to the line are moved onto it, so that no sliver is left beside it.
    pub(super) snap: f64,
}

impl Patch {
    /// What of the patch lies on one side of a line. Corners on the line have exactly its coordinate.
    pub(super) fn cut(mut self, cut: &Cut) -> Self {
        let axis = cut.axis as usize;
        let sides: Vec<i8> = self.spots.iter_mut().map(|spot| cut.classify(&mut spot.place[axis])).collect();
        let mut crossings = HashMap::new();
        let triangles = std::mem::take(&mut self.triangles);
        for triangle in triangles {
            let kinds = triangle.map(|corner| sides[corner as usize]);
            if !kinds.contains(&1) {
                continue;
            }
            if !kinds.contains(&-1) {
                self.triangles.push(triangle);
                continue;
            }
            let mut polygon = Vec::with_capacity(4);
            for corner in 0..3 {
                let next = (corner + 1) % 3;
                if kinds[corner] >= 0 {
                    polygon.push(triangle[corner]);
                }
                if kinds[corner] * kinds[next] < 0 {
                    polygon.push(self.crossing(&mut crossings, [triangle[corner], triangle[next]], cut));
                }
            }
            self.triangles.extend((2..polygon.len()).map(|i| [polygon[0], polygon[i - 1], polygon[i]]));
        }
        self
    }

    /// The corner where an edge crosses the line, the same for both triangles at the edge.
    fn crossing(&mut self, crossings: &mut HashMap<[u32; 2], u32>, edge: [u32; 2], cut: &Cut) -> u32 {
        let edge = [edge[0].min(edge[1]), edge[0].max(edge[1])];
        *crossings.entry(edge).or_insert_with(|| {
            let [a, b] = edge.map(|corner| self.spots[corner as usize]);
            let axis = cut.axis as usize;
            let share = (cut.at - a.place[axis]) / (b.place[axis] - a.place[axis]);
            let between = |a: f64, b: f64| a + (b - a) * share;
            let mut place = [between(a.place[0], b.place[0]), between(a.place[1], b.place[1])];
            place[axis] = cut.at;
            self.spots.push(Spot { place, radius_m: between(a.radius_m, b.radius_m) });
            self.spots.len() as u32 - 1
        })
    }

    /// The patch without corners that no triangle has.
    pub(super) fn compact(self) -> Self {
        let mut numbers = vec![u32::MAX; self.spots.len()];
        let mut spots = Vec::new();
        let triangles = self.triangles.iter().map(|triangle| {
            triangle.map(|corner| {
                let number = &mut numbers[corner as usize];
                if *number == u32::MAX {
                    *number = spots.len() as u32;
                    spots.push(self.spots[corner as usize]);
                }
                *number
            })
        });
        Self { triangles: triangles.collect(), spots }
    }

    /// The corners on a line of constant angle or height, in order along it: coordinate and number.
    pub(super) fn chain(&self, axis: Axis, at: f64) -> Vec<(f64, u32)> {
        let (here, along) = (axis as usize, 1 - axis as usize);
        let on = self.spots.iter().enumerate().filter(|(_, spot)| spot.place[here] == at);
        let mut chain: Vec<_> = on.map(|(number, spot)| (spot.place[along], number as u32)).collect();
        chain.sort_by(|a, b| a.0.total_cmp(&b.0));
        chain
    }
}

impl Cut {
    /// The side of a coordinate: 1 kept, -1 not, 0 on the line, onto which it is then moved.
    fn classify(&self, place: &mut f64) -> i8 {
        let off = self.side * (*place - self.at);
        if off.abs() <= self.snap {
            *place = self.at;
            return 0;
        }
        if off > 0.0 { 1 } else { -1 }
    }
}
