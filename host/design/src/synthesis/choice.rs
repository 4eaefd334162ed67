//! The choice of motions and their order: every order is searched, or left out for a reason, and the best limbs are compared.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use serde::{Deserialize, Serialize};

use super::candidate::{CLEAR_M, Candidate, REACHED_M};
use super::order::Order;
use super::prune::{longest, pruned};
use super::task::{MOST_MODULES, Space, Task, TaskError, count};
use super::variant::Variant;
use softlimb_numerics::Random;

/// Most orders that are looked at.
const MOST_ORDERS: usize = 10_000;

/// What to choose from, and how long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choosing {
    /// Least and largest number of modules.
    pub modules: [usize; 2],
    /// Seed. The answer depends on it, but not on the number of threads.
    pub seed: u64,
    /// Evaluations that an order gets for its first limb; half of it for each of those that are lighter, clearer or need less pressure.
    pub evaluations: usize,
    /// Threads; at least 1.
    pub threads: usize,
}

impl Default for Choosing {
    fn default() -> Self {
        Self { modules: [1, 3], seed: 1, evaluations: 3000, threads: 2 }
    }
}

/// What became of one order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was not searched, for this reason.
    LeftOut(String),
    /// The limbs that were found: first the one that does the task best.
    Found(Vec<Candidate>),
}

/// One order of modules.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Searched {
    /// Its number among all orders.
    pub number: usize,
    /// Indices into what was to choose from, from the base outwards.
    pub order: Vec<usize>,
    /// What became of it.
    pub outcome: Outcome,
}

/// A choice, finished or not; to be saved, and given to [`choose`] to go on with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// What the search was about, as a number.
    pub fingerprint: u64,
    /// Number of all orders.
    pub total: usize,
    /// The orders that are done, by number.
    pub searched: Vec<Searched>,
}

impl Choice {
    /// Whether every order is done.
    pub fn finished(&self) -> bool {
        self.total > 0 && self.searched.len() == self.total
    }

    /// The limbs that no other one is better than in every respect: tip error, highest pressure, mass, spare clearance, air used. Tip errors
    /// of a micrometre and directions of 1e-5 rad count as none. The smallest error first, then the lightest.
    pub fn pareto(&self) -> Vec<&Candidate> {
        let found = self.searched.iter().filter_map(|searched| match &searched.outcome {
            Outcome::Found(candidates) => Some(candidates),
            Outcome::LeftOut(_) => None,
        });
        let all: Vec<(&Candidate, [f64; 5])> = found.flatten().map(|limb| (limb, costs(limb))).collect();
        let mut best: Vec<_> = all
            .iter()
            .enumerate()
            .filter(|(index, (_, cost))| {
                // Of equal ones the first stays.
                !all.iter()
                    .enumerate()
                    .any(|(other, (_, than))| dominates(than, cost) || (other < *index && than == cost))
            })
            .map(|(_, entry)| entry)
            .collect();
        best.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then(a.1[2].total_cmp(&b.1[2])));
        best.into_iter().map(|(limb, _)| *limb).collect()
    }
}

/// What shall be small: error (m), pressure (Pa), mass (kg), missing clearance (m), air (m3).
pub(super) fn costs(limb: &Candidate) -> [f64; 5] {
    let figures = &limb.figures;
    let error = figures.tip_error_rms_m + 0.1 * figures.direction_error_max_rad;
    let reached = figures.tip_error_max_m <= REACHED_M && figures.direction_error_max_rad <= 1e-5;
    // What is kept within its tolerance is kept; more is better.
    let spare = figures.spare_clearance_m.unwrap_or(0.0);
    let spare = if (-CLEAR_M..0.0).contains(&spare) { 0.0 } else { spare };
    [if reached { 0.0 } else { error }, figures.pressure_max_pa, figures.mass_kg, -spare, figures.air_m3]
}

/// Whether one is at least as good in everything and better in something.
fn dominates(one: &[f64; 5], other: &[f64; 5]) -> bool {
    one.iter().zip(other).all(|(a, b)| a <= b) && one != other
}

/// All orders, the short ones first.
fn orders(kinds: usize, [least, most]: [usize; 2]) -> Vec<Vec<usize>> {
    let mut all = Vec::new();
    for length in least..=most {
        for number in 0..kinds.pow(length as u32) {
            all.push((0..length).map(|place| number / kinds.pow((length - 1 - place) as u32) % kinds).collect());
        }
    }
    all
}

/// FNV-1a of everything that the answer depends on.
fn fingerprint(task: &Task, kinds: &[Space], choosing: &Choosing) -> u64 {
    let Choosing { modules, seed, evaluations, threads: _ } = choosing;
    let text = format!("{task:?} {kinds:?} {modules:?} {seed} {evaluations}");
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Searches all orders of the given kinds of modules that `so_far` does not hold yet.
///
/// `observe` is told the choice after every order, to show or save it, and answers whether to go on.
///
/// # Errors
/// [`TaskError`], as [`design`](super::design), and where `so_far` is that of another task or other options. [`Choice::default`] belongs to any.
pub fn choose(
    task: &Task,
    kinds: &[Space],
    choosing: &Choosing,
    so_far: Choice,
    observe: &(dyn Fn(&Choice) -> bool + Sync),
) -> Result<Choice, TaskError> {
    task.check()?;
    kinds.iter().try_for_each(Space::check)?;
    kinds.iter().try_for_each(|kind| kind.check_joint(None))?;
    let [least, most] = choosing.modules;
    count("kinds of modules", kinds.len(), 1..=16)?;
    count("modules", least, 1..=MOST_MODULES)?;
    count("modules", most, least..=MOST_MODULES)?;
    count("threads", choosing.threads, 1..=64)?;
    count("orders", (least..=most).map(|length| kinds.len().pow(length as u32)).sum(), 1..=MOST_ORDERS)?;
    let fingerprint = fingerprint(task, kinds, choosing);
    let fresh = so_far == Choice::default();
    if !fresh && so_far.fingerprint != fingerprint {
        return Err(TaskError::OtherSearch);
    }
    let orders = orders(kinds.len(), choosing.modules);
    let variants = Variant::all(task, kinds)?;
    let longest: Vec<f64> = kinds.iter().zip(&variants[0].tables).map(|(space, table)| longest(space, table)).collect();
    let search = Search { task, kinds, choosing, variants: &variants, longest_m: &longest };
    let choice = Choice { fingerprint, total: orders.len(), ..so_far };
    let done: Vec<usize> = choice.searched.iter().map(|searched| searched.number).collect();
    let waiting: Vec<usize> = (0..orders.len()).filter(|number| !done.contains(number)).collect();
    let (next, choice, go_on) = (AtomicUsize::new(0), Mutex::new(choice), AtomicBool::new(true));
    let work = || -> Result<(), TaskError> {
        while go_on.load(Ordering::Relaxed) {
            let Some(number) = waiting.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let searched = search.order(*number, &orders[*number])?;
            let mut choice = choice.lock().expect("no panic while it is held");
            let at = choice.searched.partition_point(|other| other.number < *number);
            choice.searched.insert(at, searched);
            if !observe(&choice) {
                go_on.store(false, Ordering::Relaxed);
            }
        }
        Ok(())
    };
    thread::scope(|scope| {
        let others: Vec<_> = (1..choosing.threads).map(|_| scope.spawn(work)).collect();
        let own = work();
        others.into_iter().map(|other| other.join().expect("a search does not panic")).fold(own, Result::and)
    })?;
    Ok(choice.into_inner().expect("no panic while it was held"))
}

/// What all orders have in common.
struct Search<'a> {
    task: &'a Task,
    kinds: &'a [Space],
    choosing: &'a Choosing,
    variants: &'a [Variant],
    longest_m: &'a [f64],
}

impl Search<'_> {
    fn order(&self, number: usize, order: &[usize]) -> Result<Searched, TaskError> {
        let spaces: Vec<&Space> = order.iter().map(|index| &self.kinds[*index]).collect();
        let longest: Vec<f64> = order.iter().map(|index| self.longest_m[*index]).collect();
        let outcome = match pruned(self.task, &spaces, &longest) {
            Some(reason) => Outcome::LeftOut(reason),
            None => Outcome::Found(self.limbs(number, order)?),
        };
        Ok(Searched { number, order: order.to_vec(), outcome })
    }

    /// The limb that does the task best; where it does it, those that are better in another respect too.
    fn limbs(&self, number: usize, order: &[usize]) -> Result<Vec<Candidate>, TaskError> {
        let mut limbs: Vec<Candidate> = Vec::new();
        for (index, variant) in self.variants.iter().enumerate() {
            // A stream of its own for every search, so that no order depends on what was searched before it.
            let mut random = Random::new(self.choosing.seed, (number * self.variants.len() + index) as u64);
            let search = Order {
                task: &variant.task,
                spaces: order.iter().map(|index| &variant.spaces[*index]).collect(),
                tables: order.iter().map(|index| &variant.tables[*index]).collect(),
            };
            let evaluations = if index == 0 { self.choosing.evaluations } else { self.choosing.evaluations / 2 };
            let found = search.nearest(&mut random, evaluations)?;
            let does_it = found.does_it();
            if index == 0 || does_it {
                limbs.push(variant.as_asked(found));
            }
            if index == 0 && !does_it {
                break;
            }
        }
        Ok(limbs)
    }
}
