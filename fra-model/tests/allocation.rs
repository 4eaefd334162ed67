//! Allocation of pressures against the enumeration of all sets of active limits, which shares no step with it.

use fra_model::{Allocated, Allocation, AllocationStatus};

const REGULARISER: f64 = 1e-6;

/// A stream of numbers in -1 to 1 (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A bundle: forces per pressure of some 1e-4 m2, arms of some cm.
struct Case {
    columns: Vec<[f64; 6]>,
    limits: Vec<[f64; 2]>,
    weights: [f64; 6],
}

const WEIGHTS: [f64; 6] = [1.0, 1.0, 1.0, 20.0, 20.0, 20.0];

impl Case {
    fn random(numbers: &mut Numbers, count: usize) -> Self {
        let column = |n: &mut Numbers| [0; 6].map(|_| n.next()).map(|x| x * 4e-4);
        let columns = (0..count).map(|_| column(numbers)).map(|mut c| {
            c[3..].iter_mut().for_each(|m| *m *= 0.05);
            c
        });
        Self { columns: columns.collect(), limits: vec![[0.0, 1e5]; count], weights: WEIGHTS }
    }

    fn prepared(&self) -> Allocation<f64, 6, 27> {
        Allocation::new(&self.columns, &self.limits, &self.weights, REGULARISER).unwrap()
    }

    /// `W J (upper - lower)`, `W (w - J lower)` and the scale of the regulariser.
    fn weighted(&self, wrench: &[f64; 6]) -> (Vec<[f64; 6]>, [f64; 6], f64) {
        let mut rest = *wrench;
        let pairs = self.columns.iter().zip(&self.limits);
        let columns: Vec<[f64; 6]> = pairs
            .map(|(column, [low, high])| {
                (0..6).for_each(|r| rest[r] -= column[r] * low);
                std::array::from_fn(|r| self.weights[r] * column[r] * (high - low))
            })
            .collect();
        let scale = columns.iter().map(|c| dot(c, c)).fold(0.0, f64::max);
        (columns, std::array::from_fn(|r| self.weights[r] * rest[r]), if scale > 0.0 { scale } else { 1.0 })
    }

    /// The objective of the problem as it is stated, at pressures.
    fn objective(&self, wrench: &[f64; 6], pressures: &[f64]) -> f64 {
        let share = |(p, [low, high]): (&f64, &[f64; 2])| if high > low { (p - low) / (high - low) } else { 0.0 };
        let shares: Vec<f64> = pressures.iter().zip(&self.limits).map(share).collect();
        let (columns, wanted, scale) = self.weighted(wrench);
        value(&columns, &wanted, scale, &shares)
    }

    /// The least objective: every pressure at its lower limit, at its upper one, or free.
    fn enumerated(&self, wrench: &[f64; 6]) -> f64 {
        let (columns, wanted, scale) = self.weighted(wrench);
        let count = columns.len();
        let mut least = f64::INFINITY;
        for code in 0..3_u32.pow(count as u32) {
            let kind = |i: usize| code / 3_u32.pow(i as u32) % 3;
            let free: Vec<usize> = (0..count).filter(|i| kind(*i) == 2).collect();
            let mut shares: Vec<f64> = (0..count).map(|i| f64::from(u8::from(kind(i) == 1))).collect();
            let left: [f64; 6] =
                std::array::from_fn(|r| wanted[r] - (0..count).map(|i| columns[i][r] * shares[i]).sum::<f64>());
            let ridge = |i: usize, j: usize| if i == j { scale * REGULARISER } else { 0.0 };
            let row = |i: &usize| {
                let normal = free.iter().map(|j| dot(&columns[*i], &columns[*j]) + ridge(*i, *j));
                normal.chain([dot(&columns[*i], &left)]).collect()
            };
            let found = eliminated(free.iter().map(row).collect());
            free.iter().zip(found).for_each(|(i, x)| shares[*i] = x);
            if shares.iter().all(|x| (-1e-12..=1.0 + 1e-12).contains(x)) {
                least = least.min(value(&columns, &wanted, scale, &shares));
            }
        }
        least
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn value(columns: &[[f64; 6]], wanted: &[f64; 6], scale: f64, shares: &[f64]) -> f64 {
    let miss = |r: usize| columns.iter().zip(shares).map(|(c, s)| c[r] * s).sum::<f64>() - wanted[r];
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    0.5 * squares(&mut (0..6).map(miss)) + 0.5 * scale * REGULARISER * squares(&mut shares.iter().copied())
}

/// The solution of linear equations, rows with the right side last, by elimination with pivots.
fn eliminated(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for i in 0..count {
        let pivot = (i..count).max_by(|a, b| rows[*a][i].abs().total_cmp(&rows[*b][i].abs())).unwrap();
        rows.swap(i, pivot);
        let pivot = rows[i].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
        }
    }
    (0..count).map(|i| rows[i][count] / rows[i][i]).collect()
}

fn well(found: &Allocated<f64, 6, 27>) {
    assert_eq!(found.status, AllocationStatus::Solved);
    assert!(found.residual <= 1e-9, "residual {}", found.residual);
}

/// Wrenches inside of what a case can do, at its edge and far beyond.
fn wrench(case: &Case, numbers: &mut Numbers) -> [f64; 6] {
    let size = [0.3, 1.0, 3.0, 100.0][(numbers.next().abs() * 4.0) as usize % 4];
    let mut wrench = [0.0; 6];
    for column in &case.columns {
        let p = 1e5 * size * 0.5 * (1.0 + numbers.next());
        wrench.iter_mut().zip(column).for_each(|(w, c)| *w += c * p);
    }
    wrench
}

#[test]
fn solution_is_the_best_among_all_sets_of_active_limits() {
    let mut numbers = Numbers(1);
    for round in 0..120 {
        let mut case = Case::random(&mut numbers, 1 + round % 6);
        if round % 4 == 3 {
            case.limits.iter_mut().for_each(|[low, _]| *low = -2e4);
        }
        let wrench = wrench(&case, &mut numbers);
        let found = case.prepared().solve(&wrench);
        well(&found);
        let (value, least) =
            (case.objective(&wrench, &found.pressures_pa[..case.columns.len()]), case.enumerated(&wrench));
        assert!((value - least).abs() <= 1e-9 * (1.0 + least), "round {round}: {value} against {least}");
        for (p, [low, high]) in found.pressures_pa.iter().zip(&case.limits) {
            assert!((*low..=*high).contains(p), "{p} Pa");
        }
    }
}

#[test]
fn equal_and_colinear_actuators_share_equally() {
    // Three at one point along one axis: rank one, and the regulariser's answer is the symmetric one.
    let case =
        Case { columns: vec![[0.0, 0.0, 3e-4, 0.0, 0.0, 0.0]; 3], limits: vec![[0.0, 1e5]; 3], weights: WEIGHTS };
    let found = case.prepared().solve(&[0.0, 0.0, 45.0, 0.0, 0.0, 0.0]);
    well(&found);
    for p in &found.pressures_pa[..3] {
        assert!((p - found.pressures_pa[0]).abs() < 1e-3 && (p - 5e4).abs() < 0.1, "{p} Pa");
    }
    assert!((found.wrench[2] - 45.0).abs() < 1e-4);
    // What they cannot do is left alone.
    let found = case.prepared().solve(&[7.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    well(&found);
    assert_eq!(found.pressures_pa, [0.0; 27]);
}

#[test]
fn zero_all_and_ties() {
    let mut numbers = Numbers(5);
    for count in [1, 3, 9, 18, 27] {
        let case = Case::random(&mut numbers, count);
        let prepared = case.prepared();
        let none = prepared.solve(&[0.0; 6]);
        well(&none);
        assert_eq!(none.pressures_pa, [0.0; 27], "zero target");
        assert_eq!(none.at_lower.count_ones() as usize, count);
    }
    // Twelve actuators along one axis: the wrench of all at their limit, to the last digit, and beyond.
    let case =
        Case { columns: vec![[0.0, 0.0, 3e-4, 0.0, 0.0, 0.0]; 12], limits: vec![[0.0, 1e5]; 12], weights: WEIGHTS };
    for (share, all) in [(1.0, false), (1.0 + 1e-3, true), (1e6, true)] {
        let found = case.prepared().solve(&[0.0, 0.0, 360.0 * share, 0.0, 0.0, 0.0]);
        well(&found);
        assert_eq!(found.at_upper.count_ones() == 12, all, "{share}");
        assert!(found.pressures_pa[..12].iter().all(|p| (p - 1e5).abs() < 0.1 && *p <= 1e5));
    }
    // A limit that is also where the pressure would be: the gradient there vanishes.
    let case = Case {
        columns: vec![[3e-4, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 3e-4, 0.0, 0.0, 0.0, 0.0]],
        limits: vec![[0.0, 1e5], [2e4, 2e4]],
        weights: WEIGHTS,
    };
    let found = case.prepared().solve(&[30.0 * (1.0 + 1e-6), 0.0, 0.0, 0.0, 0.0, 0.0]);
    well(&found);
    assert!((found.pressures_pa[0] - 1e5).abs() < 1e-3);
    assert_eq!(found.pressures_pa[1], 2e4, "limits that leave no choice");
}

#[test]
fn problems_of_many_equal_columns_end() {
    let mut numbers = Numbers(9);
    let mut most = 0;
    for round in 0..600 {
        let count = 2 + round % 26;
        // Columns of small whole numbers: many are equal, opposite or multiples of each other.
        let columns = (0..count).map(|_| [0; 6].map(|_| (numbers.next() * 2.5).trunc() * 1e-4)).collect();
        let case = Case { columns, limits: vec![[0.0, 1e5]; count], weights: [1.0; 6] };
        let wrench = [0; 6].map(|_| (numbers.next() * 9.0).trunc() * 5.0);
        let prepared = case.prepared();
        let found = prepared.solve(&wrench);
        well(&found);
        let mut start = [0.0; 27];
        start.iter_mut().for_each(|p| *p = if numbers.next() > 0.0 { 1e5 } else { 0.0 });
        let again = prepared.solve_from(&start, &wrench);
        well(&again);
        let [one, other] = [&found, &again].map(|f| case.objective(&wrench, &f.pressures_pa[..count]));
        assert!((one - other).abs() <= 1e-9 * (1.0 + one), "from another corner: {one} and {other}");
        most = most.max(found.iterations).max(again.iterations);
    }
    assert!(most <= 60, "{most} steps");
}

#[test]
fn trajectory_is_followed_through_saturation_with_few_steps() {
    let mut numbers = Numbers(21);
    for count in [9, 18, 27] {
        let case = Case::random(&mut numbers, count);
        let prepared = case.prepared();
        let (mut pressures, mut steps, mut saturated) = ([0.0; 27], 0, 0);
        for tick in 0..1000 {
            let t = f64::from(tick) * 1e-3;
            let wrench = [0, 1, 2, 3, 4, 5].map(|row| {
                let size = if row < 3 { 60.0 } else { 3.0 };
                size * (std::f64::consts::TAU * (0.5 + 0.3 * row as f64) * t + row as f64).sin()
            });
            let found = prepared.solve_from(&pressures, &wrench);
            well(&found);
            if tick % 100 == 0 {
                let cold = prepared.solve(&wrench);
                let [one, other] = [&found, &cold].map(|f| case.objective(&wrench, &f.pressures_pa[..count]));
                assert!((one - other).abs() <= 1e-9 * (1.0 + one), "warm {one}, cold {other}");
            }
            pressures = found.pressures_pa;
            steps += found.iterations;
            saturated += found.at_upper.count_ones();
        }
        assert!(saturated > 0, "nothing was at its limit");
        assert!(steps < 2 * 1000, "{count}: {steps} steps in 1000 ticks");
    }
}

#[test]
fn values_that_are_not_finite_have_a_status() {
    let case = Case::random(&mut Numbers(3), 9);
    let prepared = case.prepared();
    let mut start = [0.0; 27];
    start[..9].fill(3e4);
    for bad in [f64::NAN, f64::INFINITY] {
        let found = prepared.solve_from(&start, &[1.0, bad, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(found.status, AllocationStatus::NotFinite);
        assert!(
            found.pressures_pa.iter().zip(&start).all(|(p, s)| (p - s).abs() < 1e-9),
            "the pressures it began with"
        );
    }
    start[2] = f64::NAN;
    well(&prepared.solve_from(&start, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
}

#[test]
fn questions_that_make_no_sense_are_refused() {
    type Small = Allocation<f64, 6, 3>;
    let (column, limit) = ([1e-4; 6], [0.0, 1e5]);
    let refused = |columns: &[[f64; 6]], limits: &[[f64; 2]], weights: &[f64; 6], regulariser: f64| {
        Small::new(columns, limits, weights, regulariser).unwrap_err().field
    };
    assert_eq!(refused(&[], &[], &WEIGHTS, 1e-6), "columns");
    assert_eq!(refused(&[column; 4], &[limit; 4], &WEIGHTS, 1e-6), "columns");
    assert_eq!(refused(&[[f64::NAN; 6]], &[limit], &WEIGHTS, 1e-6), "columns");
    assert_eq!(refused(&[column], &[limit; 2], &WEIGHTS, 1e-6), "limits_pa");
    assert_eq!(refused(&[column], &[[1.0, 0.0]], &WEIGHTS, 1e-6), "limits_pa");
    assert_eq!(refused(&[column], &[[0.0, f64::INFINITY]], &WEIGHTS, 1e-6), "limits_pa");
    assert_eq!(refused(&[column], &[limit], &[-1.0; 6], 1e-6), "weights");
    assert_eq!(refused(&[column], &[limit], &WEIGHTS, 0.0), "regulariser");
    assert_eq!(refused(&[column], &[limit], &WEIGHTS, f64::NAN), "regulariser");
    let long = [column; 33];
    assert!(
        Allocation::<f64, 6, 40>::new(&long, &[limit; 33], &WEIGHTS, 1e-6).is_err(),
        "more than an active set has bits"
    );
}

#[test]
fn single_precision_finds_the_same() {
    let mut numbers = Numbers(33);
    let regulariser = 1e-3;
    for round in 0..300 {
        let count = 1 + round % 27;
        let case = Case::random(&mut numbers, count);
        let wrench = wrench(&case, &mut numbers);
        let double = Allocation::<f64, 6, 27>::new(&case.columns, &case.limits, &WEIGHTS, regulariser).unwrap();
        let columns: Vec<_> = case.columns.iter().map(|c| c.map(|x| x as f32)).collect();
        let limits: Vec<_> = case.limits.iter().map(|l| l.map(|x| x as f32)).collect();
        let single =
            Allocation::<f32, 6, 27>::new(&columns, &limits, &WEIGHTS.map(|x| x as f32), regulariser as f32).unwrap();
        let (exact, found) = (double.solve(&wrench), single.solve(&wrench.map(|x| x as f32)));
        assert_eq!(found.status, AllocationStatus::Solved, "round {round}: residual {}", found.residual);
        let values =
            [exact.pressures_pa, found.pressures_pa.map(f64::from)].map(|p| case.objective(&wrench, &p[..count]));
        assert!((values[0] - values[1]).abs() <= 2e-3 * (1.0 + values[0]), "round {round}: {values:?}");
    }
}

#[test]
fn one_pressure_lies_between_its_best_and_its_reference() {
    // Closed form: with h = |WJ range|^2, s = (s* + rho r)/(1 + rho).
    let (rho, force_n_per_pa) = (0.25, 3e-4);
    let one = Allocation::<f64, 1, 2>::new(&[[force_n_per_pa]], &[[1e4, 9e4]], &[2.0], rho).unwrap();
    for (best_pa, reference_pa) in [(3e4, 7e4), (8e4, 2e4), (5e4, 1e4)] {
        let found = one.towards(&[reference_pa]).unwrap().solve(&[force_n_per_pa * best_pa]);
        let expected_pa = (best_pa + rho * reference_pa) / (1.0 + rho);
        assert!((found.pressures_pa[0] - expected_pa).abs() < 1e-8, "{} {expected_pa}", found.pressures_pa[0]);
    }
}

#[test]
fn equal_actuators_keep_the_differences_of_their_references() {
    // The sum of three equal columns decides the force. By symmetry each moves from its reference by the same pressure.
    let (references, force_n_per_pa) = ([2e4, 5e4, 3e4], 1e-4);
    let three = Allocation::<f64, 1, 3>::new(&[[force_n_per_pa]; 3], &[[0.0, 1e5]; 3], &[1.0], 1e-6).unwrap();
    let found = three.towards(&references).unwrap().solve(&[force_n_per_pa * 1.6e5]);
    // rho leaves a share of some 1e-6 of the sum.
    for (pressure, reference) in found.pressures_pa.iter().zip(references) {
        assert!((pressure - (reference + 2e4)).abs() < 0.1, "{:?}", found.pressures_pa);
    }
    let same = three.towards(&[0.0; 3]).unwrap().solve(&[12.0]);
    assert_eq!(same, three.solve(&[12.0]), "references at the lower limits change no bit");
}

#[test]
fn references_beyond_the_limits_are_refused() {
    let two = Allocation::<f64, 1, 2>::new(&[[1e-4], [2e-4]], &[[0.0, 1e5], [1e4, 1e4]], &[1.0], 1e-6).unwrap();
    for wrong in [&[1e4][..], &[1e4, 2e4], &[-1.0, 1e4], &[f64::NAN, 1e4]] {
        let error = two.towards(wrong).unwrap_err().to_string();
        assert!(error.contains("references_pa"), "{error}");
    }
    assert_eq!(two.towards(&[1e5, 1e4]).unwrap().solve(&[3.0]).pressures_pa[1], 1e4);
}
