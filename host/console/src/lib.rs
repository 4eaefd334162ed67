//! The console in a browser: a page on the loopback address that shows a limb and moves it.
//!
//! The page moves a limb that may be worn. So the address has a random token, and the server refuses foreign hosts and origins. One
//! page commands, every page can vent, and the limb holds when the page falls silent.

mod desk;
mod order;
mod server;

pub use order::{Jog, Order};
pub use server::{Console, Site};
