//! The mesh of a wall's half-plane, and the numbers of its unknowns.

/// Lines of a structured mesh of nine-node rectangles, in units of the inner radius.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    /// Radii of the corners, from the lumen outwards.
    pub(super) radii: Vec<f64>,
    /// Axial places of the corners, from the plane of symmetry to the end.
    pub(super) places: Vec<f64>,
}

/// Boundary at the end of the mesh; at its start the wall is the mirror image of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EndOfWall {
    /// Bonded to a rigid cap, which moves along the axis and turns about it.
    Bonded,
    /// Another plane of symmetry, which moves along the axis.
    Mirror,
}

/// The unknowns at a node: change of the radius, turn about the axis, shift along it.
pub(super) const FIELDS: usize = 3;
/// Nodes of an element.
pub(super) const NODES: usize = 9;
/// Pressures of an element.
pub(super) const PRESSURES: usize = 3;

/// Which number each unknown has, if it is not fixed.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) count: usize,
    /// Largest distance of two numbers in one element.
    pub(super) reach: usize,
    nodes: Vec<[Option<usize>; FIELDS]>,
    pressures: Vec<usize>,
    across: usize,
    /// The shift of the end, and its turn where it may.
    pub(super) shift: usize,
    pub(super) turn: Option<usize>,
}

impl Mesh {
    pub(super) fn elements(&self) -> [usize; 2] {
        [self.radii.len() - 1, self.places.len() - 1]
    }

    /// Numbers the unknowns from line to line along the axis; `twists` where the wall may turn.
    pub(super) fn numbers(&self, end: EndOfWall, twists: bool) -> Numbers {
        let [across, along] = self.elements();
        let (lines, per_line) = (2 * along + 1, 2 * across + 1);
        let mut nodes = vec![[None; FIELDS]; lines * per_line];
        let mut pressures = vec![0; across * along];
        let mut count = 0;
        let mut next = || {
            count += 1;
            count - 1
        };
        for line in 0..lines - 1 {
            for node in &mut nodes[line * per_line..(line + 1) * per_line] {
                let moves = line > 0;
                *node = [Some(next()), (moves && twists).then(&mut next), moves.then(&mut next)];
            }
            if line % 2 == 1 {
                for element in 0..across {
                    pressures[line / 2 * across + element] = next();
                    next();
                    next();
                }
            }
        }
        let shift = next();
        let turn = (twists && end == EndOfWall::Bonded).then(&mut next);
        for node in &mut nodes[(lines - 1) * per_line..] {
            *node = [(end == EndOfWall::Mirror).then(&mut next), turn, Some(shift)];
        }
        let mut numbers = Numbers { count, reach: 0, nodes, pressures, across, shift, turn };
        let spans = (0..along).flat_map(|j| (0..across).map(move |i| [i, j])).map(|element| {
            let used = numbers.of_element(element);
            let (least, most) = used.iter().flatten().fold((usize::MAX, 0), |(a, b), n| (a.min(*n), b.max(*n)));
            most - least
        });
        numbers.reach = spans.max().unwrap_or(0);
        numbers
    }
}

impl Numbers {
    /// The unknowns of an element: three fields of each node, nodes from the lumen outwards and then along the axis, then the pressures.
    pub(super) fn of_element(&self, [i, j]: [usize; 2]) -> [Option<usize>; NODES * FIELDS + PRESSURES] {
        let mut used = [None; NODES * FIELDS + PRESSURES];
        for node in 0..NODES {
            let place = (2 * j + node / 3) * (2 * self.across + 1) + 2 * i + node % 3;
            used[node * FIELDS..][..FIELDS].copy_from_slice(&self.nodes[place]);
        }
        let first = self.pressures[j * self.across + i];
        for k in 0..PRESSURES {
            used[NODES * FIELDS + k] = Some(first + k);
        }
        used
    }
}
