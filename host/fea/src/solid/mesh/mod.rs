//! Structured meshes of quadratic elements. Lengths are in mm, as in the decks.

pub(crate) mod grid;
pub(crate) mod plate;
pub(crate) mod quality;
pub(crate) mod shape;
pub(crate) mod tube;

/// Shape of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// C3D20R, 20 nodes.
    Brick,
    /// C3D15, 15 nodes.
    Wedge,
}

/// Material of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// Elastomer.
    Wall,
    /// Elastomer with fibers, or where `Wall` lies in the same place fibers alone.
    Layer,
    /// An end cap.
    Cap,
    /// The connector that joins a bundle's caps.
    Plate,
}

/// One element of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Its shape.
    pub kind: Kind,
    /// Its material.
    pub part: Part,
    /// Indices of its nodes, in the order of a deck.
    pub nodes: Vec<usize>,
}

/// Nodes and elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Places of the nodes, mm.
    pub nodes: Vec<[f64; 3]>,
    /// The elements.
    pub elements: Vec<Element>,
}

/// A face of an element, 1 to 6 as a deck counts them.
pub(crate) type Face = (usize, u8);

/// Node and weight pairs that say where in an element a point lies.
pub(crate) type Weights = Vec<(usize, f64)>;

impl Mesh {
    /// The place that weighted nodes make.
    pub(crate) fn place(&self, weights: &[(usize, f64)]) -> [f64; 3] {
        std::array::from_fn(|axis| weights.iter().map(|&(node, weight)| weight * self.nodes[node][axis]).sum())
    }

    /// Weights of the nodes of a brick for a point in natural coordinates, without those that are zero.
    pub(crate) fn weights(&self, element: usize, at: [f64; 3]) -> Weights {
        let nodes = &self.elements[element].nodes;
        let pairs = nodes.iter().copied().zip(shape::brick(at));
        pairs.filter(|(_, weight)| weight.abs() > 1e-14).collect()
    }
}
