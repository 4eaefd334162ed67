//! Force and payload: wrenches of bundles, largest loads, allocation beside another solver.

#[path = "payload/allocation.rs"]
mod allocation;
#[path = "payload/capacity.rs"]
mod capacity;
#[path = "payload/command.rs"]
mod command;
#[path = "payload/common.rs"]
mod common;
#[path = "payload/design.rs"]
mod design;
#[path = "payload/limb.rs"]
mod limb;
#[path = "payload/wrench.rs"]
mod wrench;
