//! Tests of the model, one binary.

mod allocation;
mod blocked;
mod closed_form;
mod common;
mod dimensions;
mod hard_cases;
mod inverse_range;
mod kinematics;
mod limits_and_anchors;
mod oracle;
mod properties;
mod published_and_independent;
mod quantity;
mod sensitivity;
mod series;
mod single_query;
mod stress_integrals;
mod sweep;
mod table;
mod tracker;
mod two_windings;
