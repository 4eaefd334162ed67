//! One random straight actuator of a sweep, its load and pressures, and what the oracle says about every answer.

use fra_model::*;

use super::condition::{condition, condition_of_limit};
use super::number::Number;
use super::path::{End, Follower, Path, Point};
use super::polish::{largest, polish, solve};
use super::sample::{Random, convert, straight};
use super::scalar::Scalar;
use super::tally::{LIMIT_PRESSURE, ROUNDINGS, Rules, Tally, Verdict, rated, unusable};
use super::wall::{FORCE, PRESSURE, Rule, TORQUE, Tube};

/// Largest load, in units of `pi R_i^2 mu1` and `pi R_i^3 mu1`.
const LARGEST_LOAD: f64 = 1e4;

/// One straight actuator with its load, the oracle's view of it and its branch.
struct Subject<'a, T: Scalar> {
    actuator: Actuator<T>,
    load: Load<T>,
    tube: Tube,
    rules: &'a Rules,
}

impl<'a, T: Scalar> Subject<'a, T> {
    fn new(random: &mut Random, rules: &'a Rules) -> Self {
        let parameters = convert(&straight(random), T::rounded);
        let exact = convert(&parameters, T::exact);
        let mut tube = Tube::new(&exact, 0.0, &Load { force_n: 0.0, torque_nm: 1.0 });
        let mut load = Load::none();
        let area = std::f64::consts::PI * exact.inner_radius_m.powi(2);
        if random.chance(0.5) {
            let [by_force, by_torque] = compliances(&tube, &rules.rough);
            let mut size = |compliance: f64, unit: f64| {
                let strain = random.log_between(1e-3, 0.5) * random.sign();
                let most = LARGEST_LOAD * tube.mu1();
                let wanted = random.chance(0.7);
                T::rounded(if wanted { (strain / compliance).clamp(-most, most) * unit } else { 0.0 })
            };
            load.force_n = size(by_force, area);
            load.torque_nm = size(by_torque, area * exact.inner_radius_m);
        }
        tube = Tube::new(&exact, 0.0, &Load { force_n: load.force_n.exact(), torque_nm: load.torque_nm.exact() });
        // Within a rounding of a right angle the fibers are meant to be axial.
        tube.axial = exact.fiber.is_some_and(|f| f.angle_rad.cos().abs() <= T::EPSILON);
        Self { actuator: Actuator::new(&parameters).expect("a sane actuator"), load, tube, rules }
    }

    fn forward(&self, pressure: f64) -> Solution<T> {
        self.actuator.forward(T::rounded(pressure), &self.load).expect("finite")
    }

    /// Polishes a state under a pressure, in pairs where the scalar can tell.
    fn polished(&self, pressure: f64, state: [f64; 3]) -> Option<[f64; 3]> {
        let mut tube = self.tube.clone();
        tube.inputs[PRESSURE] = pressure;
        let exact = (T::EPSILON < 1e-10).then_some(&self.rules.exact);
        Some(polish(&tube, &self.rules.fine, exact, state)?.map(Number::value))
    }

    /// The state under the load alone, or why there is none. `None`: so far from rest that no actuator gets there.
    fn loaded(&self) -> Option<Result<[f64; 3], End>> {
        let inputs = &self.tube.inputs;
        if inputs[FORCE] == 0.0 && inputs[TORQUE] == 0.0 {
            return Some(Ok([0.0; 3]));
        }
        let follower = Follower::of_load(&self.tube, [&self.rules.rough, &self.rules.fine]);
        let near = |p: &Point| p.state[0].abs() < 0.7 && p.state[1] > -0.9 && p.state[1] < 5.0;
        let start = follower.start([0.0; 3], 0.0, true)?;
        let path = follower.follow(start, &|p| p.at < 1.0 && near(p));
        if path.end != End::Reached {
            return Some(Err(path.end));
        }
        let reached = path.points.last().is_some_and(|p| p.at >= 1.0);
        reached.then(|| follower.state_at(&path, 1.0).and_then(|s| self.polished(0.0, s)).ok_or(End::Stuck))
    }

    /// Compares one answer with the branch that leads there.
    fn judge(&self, follower: &Follower, path: &Path, pressure: f64) -> Verdict {
        let solution = self.forward(pressure);
        if let Some(verdict) = unusable(&solution) {
            return verdict;
        }
        let Some(last) = path.points.last() else { return Verdict::OracleStuck };
        let beyond = pressure.abs() > last.at.abs();
        let rounding = match path.end {
            End::Fold => {
                let condition = condition_of_limit(&self.tube, &self.rules.fine, last.state, last.direction(), last.at);
                (ROUNDINGS * T::EPSILON * condition).max(LIMIT_PRESSURE)
            }
            _ => LIMIT_PRESSURE,
        };
        let at_limit = path.end != End::Reached && (pressure / last.at - 1.0).abs() <= rounding;
        match solution.status {
            Status::NoSolution if !beyond && !at_limit => Verdict::FalseRefusal,
            Status::NoSolution => {
                let limit = solution.limit_pressure_pa.map_or(f64::NAN, T::exact);
                let right = (limit / last.at - 1.0).abs() <= rounding;
                if right { Verdict::Refused } else { Verdict::WrongLimit }
            }
            // So close to the limit that a rounding of the inputs decides.
            _ if at_limit && beyond => Verdict::Refused,
            _ if beyond => Verdict::OtherBranch(f64::INFINITY),
            _ => self.compare(follower, path, pressure, &solution.state).unwrap_or(Verdict::OracleStuck),
        }
    }

    fn compare(&self, follower: &Follower, path: &Path, pressure: f64, state: &State<T>) -> Option<Verdict> {
        let reference = self.polished(pressure, follower.state_at(path, pressure)?)?;
        let p = self.actuator.parameters();
        let g = state.twist_rad.exact() * p.inner_radius_m.exact() / p.length_m.exact();
        let found = [state.axial_strain.exact(), state.volume_strain.exact(), g];
        let size = largest(&reference);
        let error = largest(&std::array::from_fn::<f64, 3, _>(|i| found[i] - reference[i]));
        if size == 0.0 {
            return Some(if error == 0.0 { Verdict::Solved(0.0) } else { Verdict::OtherBranch(error) });
        }
        let mut tube = self.tube.clone();
        tube.inputs[PRESSURE] = pressure;
        let condition = condition(&tube, &self.rules.rough, reference)?;
        Some(rated(error / size, T::EPSILON * condition))
    }
}

/// `de/d(N/pi R_i^2)` and `dg/d(M/pi R_i^3)` of the unloaded tube, 1/Pa.
fn compliances(tube: &Tube, rule: &Rule) -> [f64; 2] {
    let (_, slopes) = tube.linearised(rule, [0.0; 3]);
    let mut matrix = [[0.0; 4]; 4];
    (0..3).for_each(|i| matrix[i][..3].copy_from_slice(&slopes[i]));
    matrix[3][3] = 1.0;
    [0, 2].map(|i| solve(matrix, std::array::from_fn(|j| f64::from(u8::from(i == j)))).map_or(1.0, |x| x[i]))
}

/// Five pressures between the ends of the branch and beyond them.
fn pressures(random: &mut Random, up: &Path, down: &Path) -> [f64; 5] {
    let end = |path: &Path| path.points.last().map_or(0.0, |p| p.at);
    let ends = |path: &Path| path.end != End::Reached;
    let (top, bottom) = (end(up), end(down));
    let tiny = random.sign() * random.log_between(1e-3, 1e2);
    let near = 10f64.powf(random.between(-6.0, 0.0));
    let beyond = 1.0 + 10f64.powf(random.between(-5.5, 0.5));
    [
        if random.chance(0.2) { 0.0 } else { tiny.clamp(0.5 * bottom, 0.5 * top) },
        random.unit() * top,
        top * (1.0 - near),
        if ends(up) { top * beyond } else { top * random.unit().powi(3) },
        if ends(down) && random.chance(0.3) { bottom * beyond } else { bottom * random.unit() },
    ]
}

/// Asks one actuator at five pressures.
pub(crate) fn sweep_straight<T: Scalar>(random: &mut Random, rules: &Rules, tally: &mut Tally, name: &str) {
    let subject = Subject::<T>::new(random, rules);
    let p = subject.actuator.parameters();
    let kind = (p.motion, p.fiber.map(|f| f.placement));
    let describe = |pressure: f64| format!("{name} {} at {pressure:e} Pa, {:?}, {p:?}", T::NAME, subject.load);
    let rest = match subject.loaded() {
        None => return tally.skip(),
        Some(Ok(rest)) => rest,
        Some(Err(end)) => {
            let refused = subject.forward(0.0).status == Status::NoSolution;
            let verdict = match end {
                End::Stuck => Verdict::OracleStuck,
                _ if refused => Verdict::Refused,
                _ => Verdict::OtherBranch(f64::INFINITY),
            };
            return tally.add(kind, verdict, || describe(0.0));
        }
    };
    let follower = Follower::of_pressure(&subject.tube, [&rules.rough, &rules.fine]);
    let (most, largest) = (random.log_between(0.03, 30.0), subject.tube.mu1() * random.log_between(0.01, 30.0));
    let (least, lowest) = (random.between(0.01, 0.95), -1e5 * random.log_between(1e-3, 1.0));
    let follow = |up: bool| {
        let volume = |p: &Point| (1.0 + p.state[1]) / (1.0 + rest[1]);
        let start = follower.start(rest, 0.0, up)?;
        let inside =
            |p: &Point| if up { volume(p) < 1.0 + most && p.at < largest } else { volume(p) > least && p.at > lowest };
        Some(follower.follow(start, &inside))
    };
    let (Some(up), Some(down)) = (follow(true), follow(false)) else {
        return tally.add(kind, Verdict::OracleStuck, || describe(0.0));
    };
    for pressure in pressures(random, &up, &down).map(|p| T::rounded(p).exact()) {
        let path = if pressure >= 0.0 { &up } else { &down };
        let end = path.points.last().map_or(0.0, |p| p.at);
        if path.end == End::Reached && pressure.abs() > end.abs() {
            // Rounding put it past the last point the oracle knows.
            tally.skip();
            continue;
        }
        let verdict =
            if path.end == End::Stuck { Verdict::OracleStuck } else { subject.judge(&follower, path, pressure) };
        tally.add(kind, verdict, || describe(pressure));
    }
}
