//! Supply lines with wide bounds and targets that contradict each other.

use softlimb_design::actuators::kinds::wide_line;
use softlimb_design::actuators::{Budget, solve};

use crate::design::common::objective;

#[test]
fn least_objective_of_a_wide_line_is_found() {
    // By another method: exact derivatives, and pressures as shares of the least cap of all segments.
    for (seed, least) in
        [(3, 33562.61244831), (6, 656868.97398073), (7, 61243.76794992), (8, 820362.16842716), (10, 12511.09178179)]
    {
        let problem = wide_line(seed);
        let answer = solve(&problem, &Budget::default()).expect("an answer");
        let gap = objective(&problem, &answer) / least - 1.0;
        assert!(gap <= 1e-6, "{seed}: {gap:e} above {least}");
        assert_eq!(answer.disagreeing_starts(), None, "{seed}");
    }
}

#[test]
fn least_objective_is_found_where_random_starts_seldom_find_it() {
    // By 3 x 400 random starts and hops of the search without a grid, of which the default found these in 8 to 19 of 20 seeds.
    for (seed, least) in [(2, 426879.4586), (4, 1393134.3800), (16, 1053395.7834), (19, 313214.9207), (22, 49428.1344)]
    {
        let problem = wide_line(seed);
        let answer = solve(&problem, &Budget { seed: 5, ..Budget::default() }).expect("an answer");
        let gap = objective(&problem, &answer) / least - 1.0;
        assert!(gap <= 1e-6, "{seed}: {gap:e} above {least}");
    }
}

#[test]
fn least_objective_is_found_at_other_pressures_of_about_the_same_ratios() {
    // By 3 x 400 starts of the search that did not scale pressures. Its default ended 8e-4 and 7e-3 above with these seeds, at pressures
    // 3.1 times as high and 0.8 times, without a warning.
    for (problem, least, seeds) in [(28, 3921.7706, [1, 3]), (61, 13280.6131, [4, 5])] {
        let line = wide_line(problem);
        for seed in seeds {
            let answer = solve(&line, &Budget { seed, ..Budget::default() }).expect("an answer");
            let gap = objective(&line, &answer) / least - 1.0;
            assert!(gap.abs() <= 1e-6, "{problem}, {seed}: {gap:e} above {least}");
        }
    }
}

#[test]
fn search_goes_on_where_evaluations_take_few_model_solves() {
    // By 3 x 400 starts. A search that ended after 2500 evaluations was 5e-4, 2e-4 and 8e-4 above with these seeds.
    for (problem, least, seeds) in [(57, 19214.0746, &[1, 18][..]), (28, 3921.7706, &[13])] {
        let line = wide_line(problem);
        for &seed in seeds {
            let answer = solve(&line, &Budget { seed, ..Budget::default() }).expect("an answer");
            let gap = objective(&line, &answer) / least - 1.0;
            assert!(gap.abs() <= 1e-6, "{problem}, {seed}: {gap:e} above {least}");
        }
    }
}

#[test]
fn least_objective_is_found_on_the_edge_where_a_limit_point_vanishes() {
    // By nested one-dimensional searches: fiber angle by halving to where the limit point vanishes, wall by halving to the highest
    // pressure, the second segment's radius by golden sections, compass search over the other radius and the radii of the phases.
    let problem = wide_line(12);
    for seed in 1..=3 {
        let answer = solve(&problem, &Budget { seed, ..Budget::default() }).expect("an answer");
        let gap = objective(&problem, &answer) / 0.9344443643 - 1.0;
        assert!(gap.abs() <= 1e-6, "{seed}: {gap:e}");
    }
}

#[test]
fn plateau_of_an_edge_is_taken_where_it_is_better() {
    // By 3 x 400 random starts and hops of the search without edges: a tenth worse.
    let problem = wide_line(21);
    let answer = solve(&problem, &Budget { seed: 5, ..Budget::default() }).expect("an answer");
    assert!(objective(&problem, &answer) < 0.92 * 1413197.4781, "{}", answer.objective);
}
