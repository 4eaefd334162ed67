//! Physics without a solver: the cross section of a bend, quadrature through the wall, places in a bundle, the pose of a limb.

pub(crate) mod arrangement;
pub(crate) mod limb;
pub(crate) mod quadrature;
pub(crate) mod section;
