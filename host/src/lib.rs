//! softlimb on the host: from a scene file to a recorded and reported run.
//!
//! The rooms, in the order a datum passes them: [`scene`] reads the file, [`design`] builds the limb, [`motion`] plans its
//! setpoints past what stands in the way ([`obstacle`]), [`simulate`] and [`link`] bring them to a device, [`run`] leads the way, [`record`] keeps what happened, [`report`] shows it. [`eval`] asks
//! the actuator model alone, [`many`] for many actuators at once; [`table`] turns it into what a device looks up; [`calibrate`] fits it to measurements; [`bench`] measures it; [`cli`] is the command line.
//! Finite elements judge it: [`section`] of the section, [`meridian`] of ends and threads, [`fem`] in three dimensions by CalculiX; [`validation`] puts
//! them side by side. [`payload`] says what a limb can push, carry and hold, [`trials`] how well it hits its targets, [`workspace`] where its tip can be, [`statics`] what weight does to it, [`weighing`] what hangs on it, [`tolerance`] what fabrication does. [`range`] is what they refuse numbers with.

pub mod bench;
pub mod calibrate;
pub mod cli;
mod csv;
pub mod design;
mod elastomer;
pub mod eval;
pub mod fabricate;
pub mod fem;
#[cfg(test)]
mod hyper_dual;
pub mod link;
pub mod many;
mod marked;
pub mod meridian;
pub mod motion;
pub mod obstacle;
pub mod payload;
mod quadrilateral;
pub mod range;
pub mod record;
pub mod report;
pub mod run;
pub mod scene;
pub mod section;
pub mod simulate;
mod spacing;
pub mod statics;
pub mod table;
pub mod tolerance;
pub mod track;
pub mod trials;
pub mod validation;
pub mod weighing;
pub mod workspace;
