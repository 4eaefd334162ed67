//! Tests of the controller, one binary.

mod after_crash;
mod batches;
mod board;
mod closed_loop;
mod common;
mod configuration;
mod enumeration;
mod faults;
mod link_errors;
mod link_loss;
mod manual;
mod outputs;
mod plain_loops;
mod pressure_tracking;
mod sessions;
mod spec;
mod spec_limits;
mod states;
mod tables;
