//! An STL file as a printer reads it: corners are the same where their numbers are.

use std::collections::HashMap;

/// What was read.
pub(crate) struct Surface {
    /// Corners, mm.
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[usize; 3]>,
    normals: Vec<[f64; 3]>,
}

impl Surface {
    pub(crate) fn read(bytes: &[u8]) -> Self {
        assert!(!bytes.starts_with(b"solid"), "looks like an ASCII file");
        let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
        assert_eq!(bytes.len(), 84 + 50 * count);
        let mut surface = Self { points: Vec::new(), triangles: Vec::new(), normals: Vec::new() };
        let mut known: HashMap<[u32; 3], usize> = HashMap::new();
        for record in bytes[84..].chunks(50) {
            let word = |at: usize| u32::from_le_bytes(record[4 * at..4 * at + 4].try_into().unwrap());
            let vector = |at: usize| [word(at), word(at + 1), word(at + 2)];
            let value = |bits: [u32; 3]| bits.map(|bits| f64::from(f32::from_bits(bits)));
            surface.normals.push(value(vector(0)));
            surface.triangles.push([3, 6, 9].map(|at| {
                *known.entry(vector(at)).or_insert_with(|| {
                    surface.points.push(value(vector(at)));
                    surface.points.len() - 1
                })
            }));
            assert_eq!(record[48..], [0, 0]);
        }
        surface
    }

    /// Every edge belongs to two triangles that run along it in opposite directions, the surface is one piece with so many holes through it, no
    /// triangle is without area, and normals are those of the corners' order.
    pub(crate) fn assert_closed(&self, what: &str, holes: usize) {
        let mut edges: HashMap<[usize; 2], u32> = HashMap::new();
        for [a, b, c] in &self.triangles {
            assert!(a != b && b != c && c != a, "{what}: a triangle of two corners");
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        for ([a, b], count) in &edges {
            assert_eq!(*count, 1, "{what}: an edge is used twice in one direction, at {:?}", self.points[*a]);
            assert!(edges.contains_key(&[*b, *a]), "{what}: an open edge at {:?}", self.points[*a]);
        }
        let used: std::collections::HashSet<_> = self.triangles.iter().flatten().collect();
        let euler = used.len() as i64 - edges.len() as i64 / 2 + self.triangles.len() as i64;
        let expected = 2 - 2 * holes as i64;
        assert_eq!(euler, expected, "{what}: Euler's characteristic of a ball is 2, and 2 less for each hole");
        for (index, [a, b, c]) in self.triangles.iter().enumerate() {
            let [a, b, c] = [a, b, c].map(|corner| self.points[*corner]);
            let cross = cross(minus(b, a), minus(c, a));
            let length = dot(cross, cross).sqrt();
            assert!(length > 0.0, "{what}: a triangle without area at {a:?}");
            // Corners are rounded to seven digits, which turns slivers.
            if length > 1e-2 {
                assert!(dot(self.normals[index], cross) > 0.999 * length, "{what}: a wrong normal at {a:?}");
            }
        }
    }

    /// Volume, mm3, as the sum of prisms below the triangles.
    pub(crate) fn volume(&self) -> f64 {
        let prism = |[a, b, c]: [[f64; 3]; 3]| {
            let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            area * (a[2] + b[2] + c[2]) / 3.0
        };
        self.triangles.iter().map(|corners| prism(corners.map(|corner| self.points[corner]))).sum()
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
