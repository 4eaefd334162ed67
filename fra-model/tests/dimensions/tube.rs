//! Section 3: extension, expansion and twisting, as stresses and as the gradient of an energy.

use super::*;

/// A tube in a shape `l`, `V`, `Phi`.
#[derive(Clone, Copy)]
pub(super) struct Tube<'a> {
    pub(super) p: &'a ActuatorParameters<f64>,
    pub(super) length: Length,
    pub(super) volume: Volume,
    pub(super) twist: Angle,
}

impl<'a> Tube<'a> {
    pub(super) fn at(p: &'a ActuatorParameters<f64>, state: &State<f64>) -> Self {
        let length = m(p.length_m) * state.axial_stretch;
        Self {
            p,
            length,
            volume: PI * m(state.inner_radius_m) * m(state.inner_radius_m) * length,
            twist: rad(state.twist_rad),
        }
    }

    pub(super) fn stretch(&self) -> Ratio {
        self.length / m(self.p.length_m)
    }

    pub(super) fn tau(&self) -> ReciprocalLength {
        self.twist / m(self.p.length_m)
    }

    pub(super) fn mu2(&self) -> Pressure {
        pa(self.p.fiber.map_or(0.0, |fiber| fiber.modulus_pa))
    }

    /// Winding radius and thickness of a sheet.
    pub(super) fn sheet(&self) -> Option<(Length, Length)> {
        let fiber = self.p.fiber.filter(|fiber| fiber.placement == Placement::Sheet)?;
        Some((m(fiber.radius_m), m(fiber.thickness_m)))
    }

    /// Signed angles of the fiber families.
    pub(super) fn fiber_angles(&self) -> Vec<Angle> {
        let two = |fiber: Fiber<f64>| (fiber.families == Families::Two).then_some(rad(-fiber.angle_rad));
        self.p.fiber.map_or(vec![], |fiber| [Some(rad(fiber.angle_rad)), two(fiber)].into_iter().flatten().collect())
    }

    /// `r^2 = r_i^2 + (R^2 - R_i^2)/lambda`, with `V = pi r_i^2 l`.
    pub(super) fn eq_1_radius(&self, radius: Length) -> Length {
        let inner = m(self.p.inner_radius_m);
        let inner_deformed_square: Area = self.volume / (PI * self.length);
        (inner_deformed_square + (radius * radius - inner * inner) / self.stretch()).sqrt()
    }

    pub(super) fn eq_1_gradient(&self, radius: Length) -> Tensor {
        let (r, lambda, zero) = (self.eq_1_radius(radius), self.stretch(), 0.0 * ONE);
        [[radius / (r * lambda), zero, zero], [zero, r / radius, r * self.tau()], [zero, zero, lambda]]
    }

    /// (8) and its neighbours, elastomer: `s_tt - s_rr`, `s_zz - s_rr`, `s_tz`.
    pub(super) fn eq_8_elastomer(&self, radius: Length) -> [Pressure; 3] {
        let (r, lambda, tau) = (self.eq_1_radius(radius), self.stretch(), self.tau());
        let modulus = elastomer_modulus(&self.p.material, i1(&self.eq_1_gradient(radius)));
        let radial: Ratio = radius * radius / (r * r * lambda * lambda);
        let hoop: Ratio = r * r / (radius * radius) + r * r * tau * tau;
        [modulus * (hoop - radial), modulus * (lambda * lambda - radial), modulus * (r * tau * lambda)]
    }

    /// The same of the fibers.
    pub(super) fn eq_8_fibers(&self, radius: Length) -> [Pressure; 3] {
        let (r, lambda) = (self.eq_1_radius(radius), self.stretch());
        self.fiber_angles().iter().fold([pa(0.0); 3], |sum, angle| {
            let hoop: Ratio = angle.cos() * r / radius + angle.sin() * (r * self.tau());
            let axial: Ratio = angle.sin() * lambda;
            let stress = 2.0 * self.mu2() * (hoop * hoop + axial * axial - ONE);
            [sum[0] + stress * hoop * hoop, sum[1] + stress * axial * axial, sum[2] + stress * hoop * axial]
        })
    }

    /// Sum of `f(R, dR, stresses)` over the wall; a sheet is one layer of its thickness.
    pub(super) fn integral<D>(&self, f: impl Fn(Length, Length, [Pressure; 3]) -> Q<D>) -> Q<D>
    where
        D: Dimension<Kind = dyn uom::Kind> + ?Sized,
    {
        let (inner, width) = (m(self.p.inner_radius_m), m(self.p.outer_radius_m - self.p.inner_radius_m));
        let wall = mean(PANELS, |share| {
            let radius = inner + width * share;
            let (mut stress, fibers) = (self.eq_8_elastomer(radius), self.eq_8_fibers(radius));
            if self.sheet().is_none() {
                stress = [0, 1, 2].map(|i| stress[i] + fibers[i]);
            }
            f(radius, width, stress)
        });
        self.sheet().map_or(wall, |(radius, thickness)| wall + f(radius, thickness, self.eq_8_fibers(radius)))
    }

    /// `P = int (s_tt - s_rr) R dR/(R^2 - R_i^2 + lambda r_i^2)`.
    pub(super) fn eq_7_pressure(&self) -> Pressure {
        let inner = m(self.p.inner_radius_m);
        let inner_deformed = self.eq_1_radius(inner);
        let offset: Area = self.stretch() * inner_deformed * inner_deformed - inner * inner;
        self.integral(|radius, dr, [hoop, _, _]| hoop * radius * dr / (radius * radius + offset))
    }

    /// `N_ext = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, with `r dr = R dR/lambda`.
    pub(super) fn eq_9_force(&self) -> Force {
        self.integral(|radius, dr, [hoop, axial, _]| PI * (2.0 * axial - hoop) * radius * dr / self.stretch())
    }

    /// `M_ext = 2 pi int s_tz r^2 dr`.
    pub(super) fn torque(&self) -> Torque {
        let moment: Energy = self.integral(|radius, dr, [_, _, shear]| {
            TAU * shear * self.eq_1_radius(radius) * radius * dr / self.stretch()
        });
        moment.into()
    }

    /// `U = L int 2 pi R W dR`, with the energy per area of a sheet.
    pub(super) fn energy(&self) -> Energy {
        let (inner, width) = (m(self.p.inner_radius_m), m(self.p.outer_radius_m - self.p.inner_radius_m));
        let length = m(self.p.length_m);
        let sum = |f: Tensor, energy: &dyn Fn(Ratio) -> Pressure| {
            self.fiber_angles().iter().fold(pa(0.0), |sum, &angle| sum + energy(i4(&f, angle)))
        };
        let wall: Energy = mean(PANELS, |share| {
            let radius = inner + width * share;
            let f = self.eq_1_gradient(radius);
            let fibers = sum(f, &|i4| eq_3_fiber(self.mu2(), i4));
            let smeared = if self.sheet().is_none() { fibers } else { pa(0.0) };
            TAU * radius * width * length * (elastomer_energy(&self.p.material, i1(&f)) + smeared)
        });
        let Some((radius, thickness)) = self.sheet() else { return wall };
        let f = self.eq_1_gradient(radius);
        let area: Area = TAU * radius * length;
        self.fiber_angles().iter().fold(wall, |sum, &a| sum + area * sheet_energy(thickness, self.mu2(), i4(&f, a)))
    }

    /// `P = dU/dV`, `N_ext = dU/dl`, `M_ext = dU/dPhi`.
    pub(super) fn energy_gradient(&self) -> (Pressure, Force, Torque) {
        let (volume, length, twist) = (self.volume * STEP, self.length * STEP, rad(STEP));
        let pressure = change(|k| Self { volume: self.volume + volume * k, ..*self }.energy()) / volume;
        let force = change(|k| Self { length: self.length + length * k, ..*self }.energy()) / length;
        let torque: Energy = change(|k| Self { twist: self.twist + twist * k, ..*self }.energy()) / twist;
        (pressure, force, torque.into())
    }
}

/// One stiff family that twists, under force and torque; two soft families smeared through a Yeoh wall.
pub(super) fn examples() -> [(ActuatorParameters<f64>, f64, Load<f64>); 2] {
    let sheet = tube(Motion::Twisting, 10.0, 14.0, neo_hookean(0.22e6));
    let sheet = wound(sheet, 28.0, Families::One, 361e6, Placement::Sheet, 0.178);
    let smeared = tube(Motion::Extension, 6.0, 8.0, DRAGONSKIN_30);
    let smeared = wound(smeared, 20.0, Families::Two, 1e6, Placement::Smeared, 0.0);
    [(sheet, 30e3, Load { force_n: 3.0, torque_nm: 0.01 }), (smeared, 24e3, Load { force_n: -0.5, torque_nm: 0.004 })]
}

pub(super) fn solved(p: &ActuatorParameters<f64>, pressure_pa: f64, load: Load<f64>) -> State<f64> {
    let solution = solve_loaded(p, pressure_pa, load);
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    solution.state
}

/// What a solved state has to balance, against what was applied.
#[track_caller]
pub(super) fn balanced(p: &ActuatorParameters<f64>, applied: (f64, Load<f64>), found: (Pressure, Force, Torque)) {
    let (pressure_pa, Load { force_n, torque_nm }) = applied;
    // A share of the shear modulus; over the section; over the section at its radius. Differences of the energy of a stiff sheet
    // leave a tenth of it, the integrals less.
    let (pressure, outer) = (pa(p.material.shear_modulus_pa()) * 2e-9, m(p.outer_radius_m));
    let force: Force = PI * outer * outer * pressure;
    close(found.0, pa(pressure_pa), pressure);
    close(found.1, Force::new::<newton>(force_n), force);
    close(found.2, Torque::new::<newton_meter>(torque_nm), Torque::from(force * outer));
}

#[test]
fn pressure_force_and_torque_are_integrals_of_the_stresses() {
    for (p, pressure_pa, load) in examples() {
        let shape = solved(&p, pressure_pa, load);
        let tube = Tube::at(&p, &shape);
        balanced(&p, (pressure_pa, load), (tube.eq_7_pressure(), tube.eq_9_force(), tube.torque()));
    }
}

#[test]
fn pressure_force_and_torque_are_the_gradient_of_the_energy() {
    for (p, pressure_pa, load) in examples() {
        let shape = solved(&p, pressure_pa, load);
        balanced(&p, (pressure_pa, load), Tube::at(&p, &shape).energy_gradient());
    }
}

#[test]
fn radii_volume_and_compliance_are_those_of_the_radius_map() {
    for (p, pressure_pa, load) in examples() {
        let state = solved(&p, pressure_pa, load);
        let tube = Tube::at(&p, &state);
        close(tube.eq_1_radius(m(p.outer_radius_m)), m(state.outer_radius_m), m(1e-15));
        close(tube.volume, Volume::new::<cubic_meter>(state.volume_m3), tube.volume * 1e-13);
        let step = pa(10.0);
        let volume = |k: f64| Tube::at(&p, &solved(&p, pressure_pa + k * step.get::<pascal>(), load)).volume;
        let compliance = change(volume) / step;
        let expected = Volume::new::<cubic_meter>(state.compliance_m3_per_pa) / pa(1.0);
        close(compliance, expected, expected * 1e-7);
    }
}
