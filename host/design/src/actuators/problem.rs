//! A design problem, checked: segments, what they shall do in each phase, and the bounds of what can be made.

use fra_model::{
    Actuator, ActuatorParameters, Families, Fiber, InvalidParameter, Material, Motion, Placement, State, Target,
};

/// Most phases and segments of a problem: far beyond a limb, and a bound on what a file can make the solver do.
pub(super) const MOST: usize = 1000;

/// Which two of inner radius, wall and outer radius are bounded; the third follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sizes {
    /// Inner radius `R_i` and wall `R_o - R_i`.
    InnerAndWall,
    /// Inner and outer radius.
    InnerAndOuter,
    /// Outer radius and wall.
    OuterAndWall,
}

impl Sizes {
    /// Names of the two, as in a problem file.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::InnerAndWall => ["inner_radius_m", "wall_m"],
            Self::InnerAndOuter => ["inner_radius_m", "outer_radius_m"],
            Self::OuterAndWall => ["outer_radius_m", "wall_m"],
        }
    }

    /// `[R_i, R_o]` of the two. Linear, so that its columns are the values at `[1, 0]` and `[0, 1]`.
    pub(super) fn radii(self, [a, b]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::InnerAndWall => [a, a + b],
            Self::InnerAndOuter => [a, b],
            Self::OuterAndWall => [a - b, a],
        }
    }
}

/// The least and the largest value of a dimension; equal where it is given.
pub type Bounds = [f64; 2];

/// What is bounded in the geometry of one segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeometryBounds {
    /// Which two sizes of the section `sizes_m` are.
    pub sizes: Sizes,
    /// Bounds of these two, m; > 0, and such that the wall is positive in the whole box.
    pub sizes_m: [Bounds; 2],
    /// Bounds of the length `L`, m; > 0.
    pub length_m: Bounds,
    /// Bounds of the fiber angle, rad from the hoop, within `-pi/2..=pi/2`; unused for a bender without a winding.
    pub angle_rad: Bounds,
}

impl GeometryBounds {
    /// The least wall within the bounds, m.
    pub(super) fn thinnest_m(&self) -> f64 {
        let [a, b] = self.sizes_m;
        match self.sizes {
            Sizes::InnerAndWall | Sizes::OuterAndWall => b[0],
            Sizes::InnerAndOuter => b[0] - a[1],
        }
    }
}

/// The winding of a segment, but for its angle; of a bender two families in a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// One or two families.
    pub families: Families,
    /// `mu2` of each family, Pa; >= 0.
    pub modulus_pa: f64,
    /// A sheet, a layer or smeared.
    pub placement: Placement,
    /// Thickness of a sheet or a layer, m; > 0, that of a layer at most the thinnest wall within the bounds. A layer is below `R_o`.
    pub thickness_m: f64,
    /// Place of a sheet in the wall: 0 at `R_i`, 1 at `R_o`.
    pub wall_share: f64,
}

impl Winding {
    /// Winding radius of a wall, as in [`Fiber`], m.
    pub(crate) fn radius_m(&self, inner_radius_m: f64, outer_radius_m: f64) -> f64 {
        match self.placement {
            // Rounding must not take it out of the thinnest wall.
            Placement::Layer => (outer_radius_m - self.thickness_m).max(inner_radius_m),
            Placement::Sheet => outer_radius_m - (1.0 - self.wall_share) * (outer_radius_m - inner_radius_m),
            Placement::Smeared => outer_radius_m,
        }
    }

    /// The fibers of a geometry, at an angle from the hoop, rad.
    pub(crate) fn fiber(&self, geometry: &Geometry, angle_rad: f64) -> Fiber<f64> {
        Fiber {
            angle_rad,
            families: self.families,
            modulus_pa: self.modulus_pa,
            placement: self.placement,
            thickness_m: self.thickness_m,
            radius_m: self.radius_m(geometry.inner_radius_m, geometry.outer_radius_m),
        }
    }

    /// Derivatives of the winding radius by `R_i` and `R_o`; `None` where it has no effect.
    pub(crate) fn radius_slopes(&self) -> Option<[f64; 2]> {
        match self.placement {
            Placement::Layer => Some([0.0, 1.0]),
            Placement::Sheet => Some([1.0 - self.wall_share, self.wall_share]),
            Placement::Smeared => None,
        }
    }
}

/// What a segment shall do in one phase: one term of eq. (14).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Length `l`, m; outer radius `r_o`, m; bend angle, rad; or twist, rad: as the motion is.
    pub value: f64,
    /// Weight of the squared difference, 1/m2 or 1/rad2; >= 0.
    pub weight: f64,
}

/// One segment: a bundle of equal actuators, of which one is designed.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: String,
    /// Its motion.
    pub motion: Motion,
    /// The elastomer.
    pub material: Material<f64>,
    /// The winding of the analytic model; `None` for a bender that it winds as a hoop.
    pub winding: Option<Winding>,
    /// The winding of a bender by finite elements of its section, which follow any; `None` where the analytic model has the last word.
    pub section: Option<Winding>,
    /// A second winding that is given, and its angle from the hoop, rad. Of a bender finite elements alone have it.
    pub second: Option<(Winding, f64)>,
    /// Bounds of the geometry.
    pub bounds: GeometryBounds,
    /// Highest gauge pressure, Pa; > 0. The lowest is 0.
    pub pressure_max_pa: f64,
    /// Share of the limit pressure that stays unused, `0..1`.
    pub limit_margin: f64,
    /// The goal of each phase; `None` where the segment may do what it likes.
    pub goals: Vec<Option<Goal>>,
    /// Weight of the squared pressure of each phase, 1/Pa2; >= 0: its share of the effort.
    pub effort_per_pa2: f64,
}

/// A design problem, eq. (14) with bounds. [`Problem::read`] makes one from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub(super) segments: Vec<Segment>,
    pub(super) shared_pressure: bool,
}

/// The geometry of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// `R_i`, m.
    pub inner_radius_m: f64,
    /// `R_o`, m.
    pub outer_radius_m: f64,
    /// `L`, m.
    pub length_m: f64,
    /// Fiber angle, rad from the hoop; 0 for a bender without a winding.
    pub angle_rad: f64,
}

impl Problem {
    /// A problem of segments whose numbers have been checked, each with as many goals.
    pub(crate) fn new(segments: Vec<Segment>, shared_pressure: bool) -> Self {
        Self { segments, shared_pressure }
    }

    /// The segments, from the base outwards.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Whether all segments are on one supply line.
    pub fn shared_pressure(&self) -> bool {
        self.shared_pressure
    }

    /// Number of phases.
    pub fn phases(&self) -> usize {
        self.segments.first().map_or(0, |segment| segment.goals.len())
    }
}

impl Segment {
    /// Whether its bend rises with every pressure: walls that do not soften have no limit point (`docs/explanation/model.md`, section 5).
    pub(crate) fn bends_without_limit(&self) -> bool {
        let stiffens = match self.material {
            Material::NeoHookean { .. } => true,
            Material::Yeoh { c_pa } => c_pa[1] >= 0.0 && c_pa[2] >= 0.0,
        };
        self.motion == Motion::Bending && stiffens
    }

    /// Number of design variables of the geometry: the angle of a bending actuator's winding is one if it is free.
    pub(super) fn dimensions(&self) -> usize {
        let [low, high] = self.bounds.angle_rad;
        let is_kept = self.motion == Motion::Bending && (self.winding.is_none() || low == high);
        if is_kept { 3 } else { 4 }
    }

    /// Least value and width of each variable.
    pub(crate) fn axis(&self, index: usize) -> Bounds {
        let [low, high] = match index {
            0 | 1 => self.bounds.sizes_m[index],
            2 => self.bounds.length_m,
            _ => self.bounds.angle_rad,
        };
        [low, high - low]
    }

    /// Name of a variable, as in a problem file.
    pub(super) fn axis_name(&self, index: usize) -> &'static str {
        match index {
            0 | 1 => self.bounds.sizes.names()[index],
            2 => "length_m",
            _ => "angle_deg",
        }
    }

    /// The geometry at a place of the unit box, whose ends are the bounds to the digit.
    pub(crate) fn geometry(&self, place: &[f64]) -> Geometry {
        let at = |index: usize| {
            let [low, width] = self.axis(index);
            if place[index] == 1.0 { self.highest(index) } else { low + place[index] * width }
        };
        let [inner_radius_m, outer_radius_m] = self.bounds.sizes.radii([at(0), at(1)]);
        // A bender keeps the angle of its winding, if it has one that counts.
        let own_rad = self.winding.map_or(0.0, |_| self.bounds.angle_rad[0]);
        let angle_rad = if self.dimensions() > 3 { at(3) } else { own_rad };
        Geometry { inner_radius_m, outer_radius_m, length_m: at(2), angle_rad }
    }

    fn highest(&self, index: usize) -> f64 {
        match index {
            0 | 1 => self.bounds.sizes_m[index][1],
            2 => self.bounds.length_m[1],
            _ => self.bounds.angle_rad[1],
        }
    }

    /// The actuator of a geometry by the analytic model, with its first winding.
    pub fn parameters(&self, geometry: &Geometry) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion: self.motion,
            inner_radius_m: geometry.inner_radius_m,
            outer_radius_m: geometry.outer_radius_m,
            length_m: geometry.length_m,
            material: self.material,
            fiber: self.winding.map(|winding| winding.fiber(geometry, geometry.angle_rad)),
        }
    }

    /// The actuator of a geometry as finite elements of its section have it, and its second winding; `None` where they are not to.
    pub fn by_section(&self, geometry: &Geometry) -> Option<(ActuatorParameters<f64>, Option<Fiber<f64>>)> {
        let section = self.section?;
        let fiber = Some(section.fiber(geometry, self.first_angle_rad(geometry)));
        Some((ActuatorParameters { fiber, ..self.parameters(geometry) }, self.second_fiber(geometry)))
    }

    /// Angles of both windings from the hoop, rad; empty where there are no two.
    pub fn windings_rad(&self, geometry: &Geometry) -> Vec<f64> {
        self.second.map_or_else(Vec::new, |(_, second_rad)| vec![self.first_angle_rad(geometry), second_rad])
    }

    /// The analytic model of a bend that it takes for hoops has no angle.
    fn first_angle_rad(&self, geometry: &Geometry) -> f64 {
        if self.winding.is_some() { geometry.angle_rad } else { self.bounds.angle_rad[0] }
    }

    fn second_fiber(&self, geometry: &Geometry) -> Option<Fiber<f64>> {
        self.second.map(|(winding, angle_rad)| winding.fiber(geometry, angle_rad))
    }

    /// The actuator of a geometry by the analytic model, of a bender without its second winding.
    ///
    /// # Errors
    /// [`InvalidParameter`] of a geometry that the model refuses.
    pub fn actuator(&self, geometry: &Geometry) -> Result<Actuator<f64>, InvalidParameter<f64>> {
        let actuator = Actuator::new(&self.parameters(geometry))?;
        match self.second_fiber(geometry).filter(|_| self.motion != Motion::Bending) {
            Some(second) => actuator.with_second_fiber(&second),
            None => Ok(actuator),
        }
    }

    /// What eq. (14) compares: length, outer radius, bend angle or twist of a state, m or rad.
    pub fn measure(&self, state: &State<f64>, length_m: f64) -> f64 {
        match self.motion {
            Motion::Extension => state.axial_stretch * length_m,
            Motion::Expansion => state.outer_radius_m,
            Motion::Bending => state.bend_angle_rad,
            Motion::Twisting => state.twist_rad,
        }
    }

    /// A goal as the inverse model takes it; `None` for one that no deformation has.
    pub(super) fn target(&self, value: f64, length_m: f64) -> Option<Target<f64>> {
        match self.motion {
            Motion::Extension => (value > 0.0).then_some(Target::AxialStretch(value / length_m)),
            Motion::Expansion => (value > 0.0).then_some(Target::OuterRadius(value)),
            Motion::Bending => (value >= 0.0).then_some(Target::BendAngle(value)),
            Motion::Twisting => Some(Target::Twist(value)),
        }
    }
}
