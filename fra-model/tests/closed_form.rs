//! The closed-form solver against continuation, over the whole domain.
//!
//! Both solve the same equations, but continuation follows the branch in small steps of the volume, without a certificate.

use crate::common::*;
use fra_model::*;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn one_in(&mut self, n: u64) -> bool {
        self.next().is_multiple_of(n)
    }
}

/// Inner radius 1-20 mm, wall 0.005-4 times it, angles over the closed quarter turn with the special ones, modulus ratio 0.1-1e6.
fn actuator(random: &mut Random, families: Families) -> ActuatorParameters<f64> {
    let inner = random.uniform(1.0, 20.0);
    let wall = inner * 10.0_f64.powf(random.uniform(-2.3, 0.602));
    let neutral = 0.5_f64.sqrt().atan().to_degrees();
    let special = [0.0, 1e-3, neutral, 90.0 - neutral, 89.999, 90.0];
    let angle = if random.one_in(5) { special[random.next() as usize % 6] } else { random.uniform(0.0, 90.0) };
    let mu = 10.0_f64.powf(random.uniform(3.0, 6.0));
    let p = tube(Motion::Extension, inner, inner + wall, neo_hookean(mu));
    if random.one_in(12) {
        return p;
    }
    let modulus = mu * 10.0_f64.powf(random.uniform(-1.0, 6.0));
    let mut p = wound(p, angle, families, modulus, Placement::Sheet, wall * random.uniform(0.02, 0.2));
    let fiber = p.fiber.as_mut().unwrap();
    if random.one_in(2) {
        fiber.radius_m = random.uniform(p.inner_radius_m, p.outer_radius_m);
    }
    if random.one_in(4) {
        fiber.angle_rad = -fiber.angle_rad;
    }
    p
}

/// One query: an actuator, a pressure from vacuum to beyond the limit of a bare tube, and a load or none.
struct Case {
    actuator: Actuator<f64>,
    search: Actuator<f64>,
    pressure_pa: f64,
    load: Load<f64>,
}

fn case(random: &mut Random, families: Families, loaded: bool) -> Case {
    let p = actuator(random, families);
    let actuator = Actuator::new(&p).unwrap();
    let mu = p.material.shear_modulus_pa();
    let limit = mu * (p.outer_radius_m / p.inner_radius_m).ln();
    let area = p.outer_radius_m.powi(2) - p.inner_radius_m.powi(2);
    let force_n = random.uniform(-0.2, 0.5) * mu * area;
    let torque_nm = random.uniform(-0.1, 0.1) * mu * area * p.outer_radius_m;
    let torque_nm = if random.one_in(2) { torque_nm } else { 0.0 };
    let load = if loaded { Load { force_n, torque_nm } } else { Load::none() };
    Case { search: actuator.by_search(), actuator, pressure_pa: limit * random.uniform(-0.5, 1.5), load }
}

/// Largest difference of the strains, over the largest strain.
fn difference(a: &State<f64>, b: &State<f64>) -> f64 {
    let scale = b.axial_strain.abs().max(b.volume_strain.abs());
    let twist = (a.twist_rad - b.twist_rad).abs() * b.inner_radius_m / 0.1;
    (a.axial_strain - b.axial_strain).abs().max((a.volume_strain - b.volume_strain).abs()).max(twist) / scale
}

/// Whether the closed-form solver gave the answer: continuation takes more work.
fn is_closed_form(a: &Solution<f64>, search: &Solution<f64>) -> bool {
    a.iterations < search.iterations && a.iterations <= 25
}

#[test]
fn forward_answers_are_those_of_the_search() {
    for (families, loaded, usual) in [
        (Families::Two, false, 0.97),
        (Families::One, false, 0.97),
        (Families::Two, true, 0.45),
        (Families::One, true, 0.97),
    ] {
        let mut random = Random(1);
        let (mut solved, mut direct) = (0.0, 0.0);
        for _ in 0..samples(8000) {
            let case = case(&mut random, families, loaded);
            let a = case.actuator.forward(case.pressure_pa, &case.load).unwrap();
            let b = case.search.forward(case.pressure_pa, &case.load).unwrap();
            let name =
                || format!("{:?} {} {:?}\n{a:?}\n{b:?}", case.actuator.parameters(), case.pressure_pa, case.load);
            assert_eq!(a.status, b.status, "{}", name());
            if b.status == Status::Solved {
                // Close below a limit point rounding is magnified by the compliance.
                assert!(difference(&a.state, &b.state) < 1e-9, "{}", name());
                let compliance = relative(a.state.compliance_m3_per_pa, b.state.compliance_m3_per_pa);
                assert!(compliance < 2e-9, "{compliance} {}", name());
                solved += 1.0;
                direct += f64::from(u8::from(is_closed_form(&a, &b)));
            }
        }
        assert!(direct > usual * solved, "{families:?} {loaded}: {direct} of {solved} answers need no search");
    }
}

#[test]
fn inverse_answers_are_those_of_the_search() {
    for (families, loaded) in
        [(Families::Two, false), (Families::One, false), (Families::Two, true), (Families::One, true)]
    {
        let mut random = Random(2);
        let mut direct = 0;
        for _ in 0..samples(1500) {
            let case = case(&mut random, families, loaded);
            let state = case.actuator.forward(case.pressure_pa, &case.load).unwrap().state;
            let targets = [
                Target::AxialStretch(state.axial_stretch),
                Target::OuterRadius(state.outer_radius_m),
                Target::InnerRadius(state.inner_radius_m),
                Target::Twist(state.twist_rad),
            ];
            let target = targets[random.next() as usize % 4];
            let a = case.actuator.inverse(target, &case.load).unwrap();
            let b = case.search.inverse(target, &case.load).unwrap();
            let name = || format!("{:?} {target:?} {:?}\n{a:?}\n{b:?}", case.actuator.parameters(), case.load);
            assert_eq!(a.status, b.status, "{}", name());
            if b.status == Status::Solved {
                let mu = case.actuator.parameters().material.shear_modulus_pa();
                let off = (a.state.pressure_pa - b.state.pressure_pa).abs();
                assert!(off < 1e-7 * b.state.pressure_pa.abs() + 1e-10 * mu, "{off} {}", name());
                direct += u32::from(is_closed_form(&a, &b));
            }
        }
        assert!(direct > samples(1500) / 10, "{families:?} {loaded}: {direct} answers need no search");
    }
}

#[test]
fn warm_start_leads_where_the_search_from_it_leads() {
    for families in [Families::Two, Families::One] {
        let mut random = Random(3);
        for _ in 0..samples(3000) {
            let loaded = random.one_in(2);
            let case = case(&mut random, families, loaded);
            let start = case.search.forward(case.pressure_pa, &case.load).unwrap();
            let there = case.search.forward(case.pressure_pa * 1.01, &case.load).unwrap();
            if start.status != Status::Solved || there.status != Status::Solved {
                continue;
            }
            let a = case.actuator.forward_from(&start.state, case.pressure_pa * 1.01, &case.load).unwrap();
            assert_eq!(a.status, Status::Solved);
            assert!(difference(&a.state, &there.state) < 1e-9, "{:?}\n{a:?}\n{there:?}", case.actuator.parameters());
            let target = Target::OuterRadius(there.state.outer_radius_m);
            let a = case.actuator.inverse_near(&start.state, target, &case.load, 200).unwrap();
            let b = case.search.inverse_near(&start.state, target, &case.load, 20_000).unwrap();
            if a.status == Status::Solved && b.status == Status::Solved {
                let difference = difference(&a.state, &b.state);
                assert!(difference < 1e-6, "{difference} {:?} {target:?}\n{a:?}\n{b:?}", case.actuator.parameters());
            }
        }
    }
}

/// The pressures of an expansion actuator around its limit point, ever closer: the certificate must not reach across.
#[test]
fn closed_form_solver_ends_before_a_limit_point() {
    for angle_deg in [75.0, 80.0, 90.0] {
        for ratio in [0.3, 0.5, 1.0, 3.0] {
            let p = tube(Motion::Expansion, 6.0, 8.0, neo_hookean(0.2e6));
            let p = wound(p, angle_deg, Families::Two, ratio * 0.2e6, Placement::Smeared, 0.1);
            let mut p = p;
            p.fiber.as_mut().unwrap().placement = Placement::Sheet;
            let actuator = Actuator::new(&p).unwrap();
            let beyond = actuator.by_search().forward(0.2e6, &Load::none()).unwrap();
            let Some(limit) = beyond.limit_pressure_pa else { continue };
            for share in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6] {
                let below = actuator.forward(limit * (1.0 - share), &Load::none()).unwrap();
                let above = actuator.forward(limit * (1.0 + share), &Load::none()).unwrap();
                assert_eq!((below.status, above.status), (Status::Solved, Status::NoSolution), "{angle_deg} {ratio}");
                assert!(below.state.volume_strain < beyond.state.volume_strain);
            }
        }
    }
}

/// The closed forms of `P` and of the axial force solved in forty digits, the compliance by differences of 1e-15 of `P/mu1`. The last
/// correction turns the tension of a stiff winding at the neutral angle much farther than its size tells.
#[test]
fn stiff_winding_at_the_neutral_angle_keeps_the_digits_of_its_compliance() {
    let p =
        tube(Motion::Extension, 1.112_691_244_450_349_1, 1.307_682_897_739_274_3, neo_hookean(4_670.704_468_813_208));
    let mut p = wound(p, 0.0, Families::Two, 137_044_823.790_661_87, Placement::Sheet, 3.253_431_308_104_583e-2);
    p.fiber.as_mut().unwrap().angle_rad = 0.615_479_708_670_387_4;
    let state = Actuator::new(&p).unwrap().forward(936.052_720_895_769_3, &Load::none()).unwrap().state;
    let (compliance, volume_strain) = (8.861_152_773_168_474e-14, 2.132_386_182_810_562e-4);
    println!(
        "{:e} {:e}",
        relative(state.compliance_m3_per_pa, compliance),
        relative(state.volume_strain, volume_strain)
    );
    assert!(relative(state.compliance_m3_per_pa, compliance) < 1e-14, "{state:?}");
    assert!(relative(state.volume_strain, volume_strain) < 1e-14, "{state:?}");
}

/// The states differ by rounding alone, which the condition number magnifies; the compliance by little more.
#[test]
fn answers_differ_from_those_of_the_search_by_rounding() {
    for families in [Families::Two, Families::One] {
        let mut random = Random(6);
        let mut compared = 0;
        for _ in 0..samples(400) {
            let case = case(&mut random, families, false);
            let a = case.actuator.forward(case.pressure_pa, &case.load).unwrap();
            let b = case.search.forward(case.pressure_pa, &case.load).unwrap();
            if b.status != Status::Solved || !is_closed_form(&a, &b) {
                continue;
            }
            let name = || format!("{:?} {}\n{a:?}\n{b:?}", case.actuator.parameters(), case.pressure_pa);
            let condition = case.actuator.condition(&b.state, &case.load).unwrap();
            let off = difference(&a.state, &b.state);
            assert!(off <= 4.0 * f64::EPSILON * condition, "{off} {condition} {}", name());
            let slope = relative(a.state.compliance_m3_per_pa, b.state.compliance_m3_per_pa);
            assert!(slope <= 1e-9 + 10.0 * f64::EPSILON * condition, "{slope} {condition} {}", name());
            compare_in_single_precision(&case, condition);
            compared += 1;
        }
        assert!(8 * compared > 5 * samples(400), "{compared}");
    }
}

/// In single precision the search itself is off for stiff fibers: the same numbers in double precision are the reference.
fn compare_in_single_precision(case: &Case, condition: f64) {
    let narrow = single(case.actuator.parameters());
    let pressure = case.pressure_pa as f32;
    let (Ok(one), Ok(wide)) = (Actuator::new(&narrow), Actuator::new(&widened(&narrow))) else { return };
    let a = one.forward(pressure, &Load::none()).unwrap();
    let b = wide.by_search().forward(pressure.into(), &Load::none()).unwrap();
    if a.status == Status::Solved && b.status == Status::Solved {
        let slope = relative(a.state.compliance_m3_per_pa.into(), b.state.compliance_m3_per_pa);
        let rounding = f64::from(f32::EPSILON) * condition;
        assert!(slope <= 1e-5 + 10.0 * rounding, "{slope} {condition} {narrow:?}\n{a:?}\n{b:?}");
    }
}

/// Single precision against double: what rounding of the parameters and of the answer does, and no more.
#[test]
fn single_precision_loses_only_what_the_problem_magnifies() {
    let mut random = Random(4);
    let mut errors = Vec::new();
    for _ in 0..samples(4000) {
        let p = actuator(&mut random, Families::Two);
        let one = single(&p);
        // The same numbers in double precision.
        let same = widened(&one);
        let limit = p.material.shear_modulus_pa() * (p.outer_radius_m / p.inner_radius_m).ln();
        let pressure = (limit * random.uniform(0.01, 0.5)) as f32;
        let (Ok(narrow), Ok(wide)) = (Actuator::new(&one), Actuator::new(&same)) else { continue };
        let a = narrow.forward(pressure, &Load::none()).unwrap();
        let b = wide.forward(f64::from(pressure), &Load::none()).unwrap();
        if a.status == Status::Solved && b.status == Status::Solved {
            errors.push(difference(&State::combine([&a.state], |[v]: [f32; 1]| f64::from(v)), &b.state));
        }
    }
    errors.sort_by(f64::total_cmp);
    let (median, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    let enough = 8 * errors.len() > 7 * samples(4000) as usize;
    assert!(enough && median < 2e-7 && worst < 2e-5, "{} {median} {worst}", errors.len());
}

fn widened(p: &ActuatorParameters<f32>) -> ActuatorParameters<f64> {
    p.map(f64::from)
}

/// A float and nothing else: the plainest lanes.
#[derive(Clone, Copy)]
struct Single(f64);

macro_rules! operator {
    ($trait:ident, $method:ident, $sign:tt) => {
        impl std::ops::$trait for Single {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0 $sign other.0)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl std::ops::Neg for Single {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Arithmetic for Single {
    fn of(self, value: f64) -> Self {
        Self(value)
    }
    fn is_single(self) -> bool {
        false
    }
    fn is_at_most(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn atanh_over(self, s2: Self) -> Self {
        atanh_series(s2)
    }
    fn magnitude(self) -> Self {
        Self(self.0.abs())
    }
    fn root(self) -> Self {
        Self(self.0.sqrt())
    }
    fn least(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
}

impl Lanes<f64> for Single {
    const COUNT: usize = 1;
    fn load(self, values: &[f64; LANES]) -> Self {
        Self(values[0])
    }
    fn store(self, values: &mut [f64; LANES]) {
        values[0] = self.0;
    }
}

#[test]
fn many_at_once_are_answered_as_one_by_one() {
    let mut random = Random(5);
    for families in [Families::Two, Families::One] {
        let cases: Vec<_> = (0..samples(8000)).map(|_| case(&mut random, families, false)).collect();
        let actuators: Vec<_> = cases.iter().map(|case| case.actuator).collect();
        let pressures: Vec<_> = cases.iter().map(|case| case.pressure_pa).collect();
        let blank = actuators[0].forward(0.0, &Load::none()).unwrap();
        let mut solutions = vec![blank; cases.len()];
        forward_many(Single(0.0), &actuators, &pressures, &mut solutions).unwrap();
        for (case, a) in cases.iter().zip(&solutions) {
            let b = case.actuator.forward(case.pressure_pa, &Load::none()).unwrap();
            assert_eq!(a.status, b.status);
            assert_eq!((a.state.pressure_pa, a.limit_pressure_pa), (b.state.pressure_pa, b.limit_pressure_pa));
            let off = difference(&a.state, &b.state);
            assert!(a.status != Status::Solved || off < 1e-9, "{off} {:?}\n{a:?}\n{b:?}", case.actuator.parameters());
        }
        assert!(forward_many(Single(0.0), &actuators[..1], &[f64::NAN], &mut solutions).is_err());
        // Few of those that are solved need the search.
        let direct = solutions.iter().zip(&cases).filter(|(a, case)| {
            let b = case.search.forward(case.pressure_pa, &Load::none()).unwrap();
            a.status == Status::Solved && is_closed_form(a, &b)
        });
        assert!(2 * direct.count() > cases.len());
    }
}
