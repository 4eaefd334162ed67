//! An actuator's memory: properties of its loops and the sizes of its effects.

use softlimb_body::{Curve, Effects, Memory, MemoryParameters};
use softlimb_numerics::Random;

const RANGE_PA: f64 = 100e3;
const RANGE: f64 = 0.4;

/// A curve that stiffens first and softens then, as those of elastomers do.
fn curve() -> Curve {
    let point = |k: i32| {
        let x = f64::from(k) / 20.0;
        [RANGE * x, RANGE_PA * (1.3 * x - 0.6 * x * x + 0.3 * x * x * x)]
    };
    Curve::rising(&(0..=20).map(point).collect::<Vec<_>>()).unwrap()
}

/// An actuator without load.
struct Actuator {
    curve: Curve,
    memory: Memory,
    deformation: f64,
}

impl Actuator {
    fn new(effects: Effects) -> Self {
        Self::of(MemoryParameters::default().with(effects))
    }

    fn of(parameters: MemoryParameters) -> Self {
        let curve = curve();
        Self { memory: Memory::new(&curve, parameters), curve, deformation: 0.0 }
    }

    fn pressure_pa(&self, deformation: f64, span_s: f64) -> f64 {
        self.curve.at(deformation) + self.memory.excess_pa(&self.curve, deformation, span_s)
    }

    /// Deforms it, and gives the pressure that it then has, Pa.
    fn to(&mut self, deformation: f64, span_s: f64) -> f64 {
        let pressure_pa = self.pressure_pa(deformation, span_s);
        self.memory.advance(&self.curve, deformation, span_s);
        self.deformation = deformation;
        pressure_pa
    }

    /// Inflates it, by bisection.
    fn inflate(&mut self, pressure_pa: f64, span_s: f64) -> f64 {
        let (mut low, mut high) = (-0.5 * RANGE, 2.0 * RANGE);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.pressure_pa(middle, span_s) < pressure_pa { low = middle } else { high = middle }
        }
        self.to(0.5 * (low + high), span_s);
        self.deformation
    }

    /// A ramp of pressure in `steps` steps.
    fn ramp(&mut self, from_pa: f64, to_pa: f64, steps: u32, span_s: f64) -> Vec<f64> {
        let at = |step: u32| from_pa + (to_pa - from_pa) * f64::from(step) / f64::from(steps);
        (1..=steps).map(|step| self.inflate(at(step), span_s / f64::from(steps))).collect()
    }
}

const HYSTERESIS: Effects = Effects { hysteresis: true, ..Effects::NONE };

#[test]
fn small_loop_wipes_itself_out() {
    let (mut plain, mut looped) = (Actuator::new(HYSTERESIS), Actuator::new(HYSTERESIS));
    for target in [0.3, 0.1, 0.25] {
        plain.to(target * RANGE / 0.4, 1.0);
        looped.to(target * RANGE / 0.4, 1.0);
    }
    // A loop within the last branch, and on along the branch.
    looped.to(0.2, 1.0);
    looped.to(0.25, 1.0);
    for target in [0.27, 0.35, 0.0] {
        let [a, b] = [&mut plain, &mut looped].map(|actuator| actuator.to(target, 1.0));
        assert!((a - b).abs() < 1e-9 * RANGE_PA, "{target}: {a} beside {b}");
    }
}

#[test]
fn loops_between_the_same_deformations_are_congruent() {
    let loop_after = |history: &[f64]| {
        let mut actuator = Actuator::new(HYSTERESIS);
        history.iter().for_each(|target| {
            actuator.to(*target, 1.0);
        });
        actuator.to(0.12, 1.0);
        let path: Vec<f64> = (0..=40).map(|k| 0.12 + 0.06 * (1.0 - (f64::from(k) / 20.0 - 1.0).abs())).collect();
        let mut found: Vec<f64> = path.iter().map(|q| actuator.to(*q, 1.0) - curve().at(*q)).collect();
        let first = found[0];
        found.iter_mut().for_each(|value| *value -= first);
        found
    };
    // Both arrive at the lower end on a falling branch.
    let (a, b) = (loop_after(&[0.4]), loop_after(&[0.3, 0.0, 0.2]));
    let far = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(a.iter().copied().fold(0.0, f64::max) > 1e-3 * RANGE_PA, "there is a loop");
    assert!(far < 1e-9 * RANGE_PA, "{far} Pa apart");
}

/// Work taken per loop in the pair of pressure and deformation, whose product stands for energy.
#[test]
fn closed_paths_of_pressure_take_work() {
    let mut random = Random::new(5, 0);
    for trial in 0..200 {
        let mut actuator = Actuator::of(MemoryParameters::drawn(9, trial));
        let mut targets: Vec<f64> = (0..6).map(|_| RANGE_PA * random.uniform()).collect();
        targets.push(0.0);
        let (mut work, mut pressure_pa) = (0.0, 0.0);
        let span_s = 0.05 + 5.0 * random.uniform();
        // The elastic energy at both ends of the path counts too.
        let mut last = 0.0;
        let mut go = |actuator: &mut Actuator, to_pa: f64| {
            for step in 1..=100 {
                let next_pa = pressure_pa + (to_pa - pressure_pa) * f64::from(step) / 100.0;
                let before_pa = pressure_pa + (to_pa - pressure_pa) * f64::from(step - 1) / 100.0;
                let q = actuator.inflate(next_pa, span_s / 100.0);
                work += 0.5 * (next_pa + before_pa) * (q - last);
                last = q;
            }
            pressure_pa = to_pa;
        };
        for target in targets {
            go(&mut actuator, target);
        }
        assert!(work > 0.0, "path {trial} gives {:e} of the range's work", -work / (RANGE * RANGE_PA));
    }
}

/// Widest distance of rising and falling branch in pressure at one deformation, of the range.
fn loop_width(actuator: &mut Actuator, low: f64, high: f64) -> f64 {
    let at = |step: usize| low + (high - low) * step as f64 / 200.0;
    (0..=200).for_each(|step| {
        actuator.to(at(step), 1e3);
    });
    (0..=200).rev().for_each(|step| {
        actuator.to(at(step), 1e3);
    });
    let up: Vec<f64> = (0..=200).map(|step| actuator.to(at(step), 1e3)).collect();
    let down: Vec<f64> = (0..=200).rev().map(|step| actuator.to(at(step), 1e3)).collect();
    up.iter().zip(down.iter().rev()).map(|(up, down)| up - down).fold(0.0, f64::max) / RANGE_PA
}

#[test]
fn loop_has_the_stated_width() {
    let whole = loop_width(&mut Actuator::new(HYSTERESIS), 0.0, RANGE);
    assert!((0.05..0.10).contains(&whole), "{whole} of range");
    // The loop of a cycle over a fifth of the range is a few per cent of that fifth, as in rubber.
    let small = loop_width(&mut Actuator::new(HYSTERESIS), 0.4 * RANGE, 0.6 * RANGE);
    assert!((0.02..0.05).contains(&(small / 0.2)), "{} of its range", small / 0.2);
}

#[test]
fn pressure_held_for_ten_minutes_creeps_as_stated() {
    let mut actuator = Actuator::new(Effects { creep: true, ..Effects::NONE });
    actuator.ramp(0.0, 0.8 * RANGE_PA, 50, 0.5);
    let early = actuator.inflate(0.8 * RANGE_PA, 1.0);
    (0..600).for_each(|_| {
        actuator.inflate(0.8 * RANGE_PA, 1.0);
    });
    let creep = actuator.deformation / early - 1.0;
    assert!((0.03..0.08).contains(&creep), "{creep}");
}

#[test]
fn sine_has_the_stated_loss_factor() {
    for frequency_hz in [0.3, 1.0, 5.0] {
        let mut actuator = Actuator::new(Effects { creep: true, ..Effects::NONE });
        let (steps, cycles) = (400, 12);
        let [mut sine, mut cosine] = [0.0; 2];
        let (middle, amplitude) = (0.2, 0.004);
        for step in 0..steps * cycles {
            let phase = std::f64::consts::TAU * f64::from(step % steps) / f64::from(steps);
            let pressure_pa = actuator.to(middle + amplitude * phase.sin(), 1.0 / (frequency_hz * f64::from(steps)));
            if step >= steps * (cycles - 1) {
                sine += pressure_pa * phase.sin();
                cosine += pressure_pa * phase.cos();
            }
        }
        let loss = cosine / sine;
        assert!((0.03..0.06).contains(&loss), "{frequency_hz} Hz: {loss}");
    }
}

#[test]
fn first_cycles_soften_the_wall_as_stated() {
    let mut actuator = Actuator::new(Effects { softening: true, ..Effects::NONE });
    let peak_pa = 0.9 * RANGE_PA;
    let mut peaks = Vec::new();
    for _ in 0..20 {
        actuator.ramp(0.0, peak_pa, 50, 1.0);
        peaks.push(actuator.deformation);
        actuator.ramp(peak_pa, 0.0, 50, 1.0);
    }
    let whole = peaks[19] / peaks[0] - 1.0;
    assert!((0.04..0.10).contains(&whole), "the peak grows by {whole}");
    let share = (peaks[3] - peaks[0]) / (peaks[19] - peaks[0]);
    assert!(share > 0.7, "{share} of it within three cycles");
    assert!(peaks.is_sorted(), "{peaks:?}");
}

#[test]
fn memory_without_effects_is_the_elastic_curve() {
    let mut actuator = Actuator::new(Effects::NONE);
    for q in [0.1, 0.3, 0.05, 0.2] {
        assert_eq!(actuator.to(q, 0.01), curve().at(q));
    }
}

#[test]
fn same_path_gives_the_same_bits() {
    let path = || {
        let mut actuator = Actuator::of(MemoryParameters::drawn(3, 1));
        (0..200)
            .map(|k| actuator.inflate(RANGE_PA * f64::from(k * 37 % 100) / 100.0, 0.02).to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(path(), path());
}
