//! The console in a browser: a page on the loopback address that shows a limb and moves it.
//!
//! The page moves a limb that may be worn. So the address has a random token, foreign hosts and origins are refused, one page
//! commands and all may vent, and a page that falls silent lets the limb hold.

mod desk;
mod order;
mod server;

pub use order::{Jog, Order};
pub use server::{Console, Site};
