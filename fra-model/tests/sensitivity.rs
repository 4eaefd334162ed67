//! Exact derivatives against values that owe nothing to the code they come from: the equilibrium of stresses, closed forms, and
//! identities that hold for every equilibrium.

mod closed_forms;
mod identities;
mod integrals;
mod misuse;

use crate::common::*;
use fra_model::*;

/// An actuator in an equilibrium.
struct Case {
    p: ActuatorParameters<f64>,
    actuator: Actuator<f64>,
    load: Load<f64>,
    state: State<f64>,
}

impl Case {
    #[track_caller]
    fn new(p: ActuatorParameters<f64>, pressure_pa: f64, force_n: f64, torque_nm: f64) -> Self {
        let actuator = Actuator::new(&p).expect("valid");
        let load = Load { force_n, torque_nm };
        let solution = actuator.forward(pressure_pa, &load).expect("finite");
        assert_eq!(solution.status, Status::Solved, "{p:?} at {pressure_pa} Pa under {load:?}");
        Self { p, actuator, load, state: solution.state }
    }

    #[track_caller]
    fn by(&self, parameter: Parameter) -> State<f64> {
        self.actuator.sensitivity(&self.state, &self.load, parameter).expect("a derivative")
    }

    #[track_caller]
    fn inverse_by(&self, target: Target<f64>, parameter: Parameter) -> State<f64> {
        self.actuator.inverse_sensitivity(&self.state, &self.load, target, parameter).expect("a derivative")
    }

    /// The value of an input.
    fn value(&self, parameter: Parameter) -> f64 {
        let mut p = self.p;
        match parameter {
            Parameter::Pressure => self.state.pressure_pa,
            Parameter::Force => self.load.force_n,
            Parameter::Torque => self.load.torque_nm,
            other => *place(&mut p, other),
        }
    }
}

/// Where a parameter of the geometry or the material stands.
fn place(p: &mut ActuatorParameters<f64>, parameter: Parameter) -> &mut f64 {
    use Parameter::*;
    match (parameter, &mut p.material) {
        (InnerRadius, _) => return &mut p.inner_radius_m,
        (OuterRadius, _) => return &mut p.outer_radius_m,
        (Length, _) => return &mut p.length_m,
        (ShearModulus, Material::NeoHookean { shear_modulus_pa }) => return shear_modulus_pa,
        (YeohC1, Material::Yeoh { c_pa }) => return &mut c_pa[0],
        (YeohC2, Material::Yeoh { c_pa }) => return &mut c_pa[1],
        (YeohC3, Material::Yeoh { c_pa }) => return &mut c_pa[2],
        _ => {}
    }
    let fiber = p.fiber.as_mut().expect("a winding");
    match parameter {
        FiberAngle => &mut fiber.angle_rad,
        FiberModulus => &mut fiber.modulus_pa,
        SheetThickness => &mut fiber.thickness_m,
        WindingRadius => &mut fiber.radius_m,
        other => panic!("{other:?} is not of the geometry or the material"),
    }
}

/// Straight actuators of both laws and of every placement, one and two families, with and without loads; windings within the wall.
fn straight_cases() -> Vec<Case> {
    let mut cases = vec![
        Case::new(tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6)), 25e3, 0.0, 0.0),
        Case::new(tube(Motion::Expansion, 6.0, 9.0, DRAGONSKIN_30), -15e3, 1.5, 0.01),
    ];
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        for placement in [Placement::Sheet, Placement::Layer, Placement::Smeared] {
            for families in [Families::One, Families::Two] {
                for (angle_deg, modulus_pa) in [(8.0, 20e6), (-33.0, 2e6), (62.0, 0.4e6)] {
                    for (pressure_pa, force_n, torque_nm) in
                        [(18e3, 0.0, 0.0), (12e3, 2.0, 0.008), (-6e3, -0.5, -0.004)]
                    {
                        let p = tube(Motion::Twisting, 6.0, 8.0, material);
                        let mut p = wound(p, angle_deg, families, modulus_pa, placement, 0.2);
                        if let Some(fiber) = &mut p.fiber {
                            fiber.radius_m = if placement == Placement::Smeared { 8e-3 } else { 7.4e-3 };
                        }
                        cases.push(Case::new(p, pressure_pa, force_n, torque_nm));
                    }
                }
            }
        }
    }
    cases
}

/// Bends of both laws, with a stated winding and without, with loads; slight ones and several turns.
fn bent_cases() -> Vec<Case> {
    let mut cases = vec![];
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        for (pressure_pa, force_n, torque_nm) in [(40e3, 0.0, 0.0), (20e3, 0.5, 0.01), (60e3, -1.0, -0.005)] {
            let p = tube(Motion::Bending, 6.0, 8.0, material);
            cases.push(Case::new(p, pressure_pa, force_n, torque_nm));
            let mut p = wound(p, 0.0, Families::Two, 0.0, Placement::Sheet, 0.2);
            p.fiber.as_mut().expect("wound").radius_m = 7.3e-3;
            cases.push(Case::new(p, pressure_pa, force_n, torque_nm));
        }
    }
    // Rolled up: several turns.
    for pressure_pa in [80e3, 150e3] {
        let p = tube(Motion::Bending, 5.0, 6.0, neo_hookean(0.1e6));
        cases.insert(1, Case::new(p, pressure_pa, 0.0, 0.0));
    }
    assert!(cases[1].state.bend_angle_rad > 20.0);
    cases
}

/// Bends of both laws with helical windings on the outer face and within the wall, with loads.
fn helical_cases() -> Vec<Case> {
    let mut cases = vec![];
    for material in [neo_hookean(0.2e6), DRAGONSKIN_30] {
        for (pressure_pa, force_n, torque_nm) in [(40e3, 0.0, 0.0), (20e3, 0.5, 0.01), (60e3, -1.0, -0.005)] {
            for (angle_deg, radius_m) in [(17.0, 8e-3), (-7.0, 7.3e-3)] {
                let p = tube(Motion::Bending, 6.0, 8.0, material);
                let mut p = wound(p, angle_deg, Families::Two, 1e9, Placement::Sheet, 0.2);
                p.fiber.as_mut().expect("wound").radius_m = radius_m;
                cases.push(Case::new(p, pressure_pa, force_n, torque_nm));
            }
        }
    }
    cases
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64, what: impl std::fmt::Debug) {
    let error = (found - expected).abs();
    assert!(error <= tolerance, "{found} against {expected}: off by {error:e}, {what:?}");
}
