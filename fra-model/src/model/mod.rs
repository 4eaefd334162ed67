//! Physics: the strain energy of the straight wall, the cross section of a bend, the pose of a limb.

pub(crate) mod energy;
pub(crate) mod limb;
mod quadrature;
pub(crate) mod section;
