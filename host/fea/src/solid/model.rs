//! Mesh, ties, loads and gauges of one deck.

use std::ops::Range;

use super::gauge::Gauges;
use super::mesh::tube::Tube;
use super::mesh::{Face, Mesh};
use super::parts::{Elastomers, Hold, Trusses, connect, gauges, holds, places, trusses, warnings};
use super::plan::{Around, Plan, Symmetry};
use super::ties::Ties;
use super::{FemError, Options, Subject};

/// Everything a deck says before its first step.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) mesh: Mesh,
    pub(crate) plan: Plan,
    pub(crate) holds: Vec<Hold>,
    pub(crate) ties: Ties,
    pub(crate) trusses: Vec<Trusses>,
    /// Faces that the air presses on.
    pub(crate) lumen: Vec<Face>,
    pub(crate) elastomers: Elastomers,
    pub(crate) gauges: Gauges,
    /// The elements of each tube and its axis, mm.
    pub(crate) tubes: Vec<(Range<usize>, [f64; 2])>,
    /// Whether all nodes are printed.
    pub(crate) all_nodes: bool,
    warnings: Vec<String>,
}

impl Model {
    /// Builds the model of one actuator or of a bundle.
    ///
    /// # Errors
    /// [`FemError::Invalid`] or [`FemError::Parameters`] with field, value and range; [`FemError::NoSheet`]; [`FemError::TooFine`].
    pub fn new(subject: &Subject, options: &Options) -> Result<Self, FemError> {
        let plan = Plan::new(subject, options)?;
        let estimate = plan.grid.nodes_estimate() * usize::from(subject.actuators);
        if estimate > options.nodes_max as usize {
            return Err(FemError::TooFine { nodes: estimate, allowed: options.nodes_max });
        }
        let overlay = plan.smeared.is_some_and(|smeared| smeared.overlay);
        let (mut mesh, mut ties, mut ranges) = (Mesh::default(), Ties::default(), Vec::new());
        let places = places(subject);
        let add = |center: &[f64; 2]| {
            let first = mesh.elements.len();
            let tube = Tube::add(&mut mesh, plan.grid.clone(), *center, overlay);
            ranges.push((first..mesh.elements.len(), *center));
            tube
        };
        let tubes: Vec<Tube> = places.iter().map(add).collect();
        if let Around::Sector(count) = plan.symmetry.around {
            ties.repeat(&tubes[0], count, plan.symmetry.half_length);
        }
        let mut all = Vec::<Trusses>::new();
        for group in tubes.iter().flat_map(|tube| trusses(&plan, tube, &mut mesh, &mut ties)) {
            match all.iter_mut().find(|other| other.name == group.name) {
                Some(other) => other.pairs.extend(group.pairs),
                None => all.push(group),
            }
        }
        if tubes.len() > 1 {
            connect(&mut mesh, &mut ties, &tubes, subject);
        }
        Ok(Self {
            gauges: gauges(&plan, &tubes, &places),
            lumen: tubes.iter().flat_map(|tube| tube.lumen_faces(&mesh)).collect(),
            holds: tubes.iter().flat_map(|tube| holds(&plan, tube)).collect(),
            elastomers: Elastomers::new(subject, options, plan.smeared),
            warnings: warnings(&plan, subject),
            trusses: all,
            tubes: ranges,
            all_nodes: options.all_nodes,
            mesh,
            plan,
            ties,
        })
    }

    /// Nodes whose displacements are printed, in order.
    pub(crate) fn printed(&self) -> Vec<usize> {
        if self.all_nodes { (0..self.nodes()).collect() } else { self.gauges.nodes() }
    }

    /// Largest share of the load in one increment.
    pub(crate) fn increment(&self) -> f64 {
        self.plan.increment
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.mesh.nodes.len()
    }

    /// The mesh, mm.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The symmetry it uses.
    pub fn symmetry(&self) -> Symmetry {
        self.plan.symmetry
    }

    /// Distance between neighbouring threads of one family of the first winding, m; `None` where fibers are smeared.
    pub fn thread_spacing_m(&self) -> Option<f64> {
        self.plan.threads.first().map(|threads| threads.winding.spacing_mm * 1e-3)
    }

    /// Limits of the figures.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}
