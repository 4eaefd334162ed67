//! The analytic model beside finite elements: pressure against deformation as in Fig. 6 of the paper.
//!
//! Every [`Case`] goes to the analytic model, of the finite elements of its section, and of CalculiX if there is one.
//! All figures are those of mid-length, turned into an actuator's by its length, so that end caps do not enter. `docs/evidence/validation.md`
//! says where the analytic model is off, and why.

mod case;
mod compare;
mod picture;
mod study;
mod table;
mod tsv;

pub use case::{Case, label};
pub use compare::{Comparison, Row, Solid, compare, section_curve};
pub use picture::picture;
pub use study::{Progress, Study, StudyError, study};
pub use table::percent;
pub use tsv::TsvError;
