//! Force and payload: wrenches of bundles, largest loads, allocation beside another solver.

mod allocation;
mod capacity;
mod carried;
mod common;
mod limb;
mod steering;
mod wrench;
