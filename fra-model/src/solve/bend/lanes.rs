//! Bends of several actuators, vectorized: each lane integrates one bender.
//!
//! Each bender iterates independently, by the same code as a single one. Integrals with similar numbers of nodes share a register.

use core::array;

use super::Bender;
use super::meet::{Meeting, Met, Turn};
use crate::model::section::{Bent, Digits, EndLoad, MOST_TABLED, Section};
use crate::number::lanes::Lanes;
use crate::number::real::Real;

/// Most benders that are solved together.
pub(crate) const MANY: usize = 256;

/// An integral that is needed.
#[derive(Clone, Copy)]
struct Wanted<'a, T: Real> {
    /// Index of the bender.
    number: usize,
    section: &'a Section<T>,
    k: T,
    digits: Digits,
    nodes: Nodes,
}

/// Numbers of nodes of an integral, sorted by rule, then angles, then radii.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Nodes {
    rule: Rule,
    angles: u8,
    radii: u16,
}

/// Integration rule, which all integrals of a register share.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    Rough,
    /// Equal panels.
    Slight,
    /// Panels that crowd towards the outer face.
    Graded,
    /// More angles than tables have.
    Alone,
}

impl<'a, T: Real> Wanted<'a, T> {
    fn new(number: usize, bender: &'a Bender<T>, k: T, digits: Digits) -> Self {
        let section = &bender.section;
        let angles = section.angles(k, digits);
        let radii = section.radii(k, digits);
        let rule = match (digits, radii) {
            _ if angles > MOST_TABLED => Rule::Alone,
            (Digits::Few, _) => Rule::Rough,
            (Digits::All, Some(_)) => Rule::Slight,
            (Digits::All, None) => Rule::Graded,
        };
        let nodes = Nodes { rule, angles, radii: radii.unwrap_or(0) };
        Self { number, section, k, digits, nodes }
    }
}

/// Computes integrals in any order, and passes each with the index of its bender.
#[inline(always)]
fn integrate<T: Real, V: Lanes<T>>(token: V, wanted: &mut [Wanted<'_, T>], mut pass: impl FnMut(usize, Bent<T>)) {
    wanted.sort_unstable_by_key(|one| one.nodes);
    let mut left = &*wanted;
    while let Some(first) = left.first() {
        let rule = first.nodes.rule;
        let count = left.iter().take(V::COUNT).take_while(|one| one.nodes.rule == rule).count();
        let (group, others) = left.split_at(count);
        left = others;
        if rule == Rule::Alone {
            for Wanted { number, section, k, digits, .. } in group {
                pass(*number, section.sampled(*k, &EndLoad::none(), *digits));
            }
            continue;
        }
        // Spare lanes repeat the last integral.
        let lane = |i: usize| &group[i.min(count - 1)];
        let section = Section::columns(token, array::from_fn(|i| lane(i).section));
        let k = token.load(&array::from_fn(|i| lane(i).k));
        let Bent { moment, slope, .. } = section.bent_hoop(k, first.digits, lane(count).nodes.angles);
        let (mut moments, mut slopes) = (array::from_fn(|i| lane(i).k), array::from_fn(|i| lane(i).k));
        moment.store(&mut moments);
        slope.store(&mut slopes);
        for ((one, moment), slope) in group.iter().zip(moments).zip(slopes) {
            pass(one.number, Bent { k: one.k, moment, slope });
        }
    }
}

/// The integrals of benders at a bend `k` each, passed with the index of the bender; at most [`MANY`].
#[inline(always)]
pub(crate) fn bend_many<T: Real, V: Lanes<T>>(token: V, bends: &[(&Bender<T>, T)], pass: impl FnMut(usize, Bent<T>)) {
    let Some((mut waiting, count)) = waiting(bends, |(_, k)| (*k, Digits::All)) else { return };
    integrate(token, &mut waiting[..count], pass);
}

/// The bends of benders with a moment each, as [`Bender::meet`] finds them from rest, and the numbers of integrals; at most [`MANY`].
#[inline(always)]
pub(crate) fn meet_many<T: Real, V: Lanes<T>>(
    token: V,
    moments: &[(&Bender<T>, T)],
    mut pass: impl FnMut(usize, Option<Met<T>>, u32),
) {
    let begin = |(bender, wanted): &(&Bender<T>, T)| Meeting::new(&bender.straight, T::zero(), *wanted);
    let first = |one: &(&Bender<T>, T)| {
        let meeting = begin(one);
        (meeting.next, meeting.digits())
    };
    let Some((mut waiting, mut count)) = waiting(moments, first) else { return };
    let last = begin(&moments[count - 1]);
    let mut meetings: [_; MANY] = array::from_fn(|i| if i + 1 < count { begin(&moments[i]) } else { last });
    for rounds in 1.. {
        let (mut next, mut left) = (waiting, 0);
        integrate(token, &mut waiting[..count], |number, bent| {
            let meeting = &mut meetings[number];
            match meeting.take(bent) {
                Turn::Again => {
                    next[left] = Wanted::new(number, moments[number].0, meeting.next, meeting.digits());
                    left += 1;
                }
                Turn::Met(met) => pass(number, Some(met), rounds),
                Turn::Lost => pass(number, None, rounds),
            }
        });
        if left == 0 {
            return;
        }
        (waiting, count) = (next, left);
    }
}

/// First integrals of benders, padded with the last one, and their number.
#[inline(always)]
fn waiting<'a, T: Real>(
    benders: &[(&'a Bender<T>, T)],
    first: impl Fn(&(&'a Bender<T>, T)) -> (T, Digits),
) -> Option<([Wanted<'a, T>; MANY], usize)> {
    let count = benders.len().min(MANY);
    let wanted = |i: usize| {
        let (k, digits) = first(&benders[i]);
        Wanted::new(i, benders[i].0, k, digits)
    };
    let last = wanted(count.checked_sub(1)?);
    Some((array::from_fn(|i| if i + 1 < count { wanted(i) } else { last }), count))
}
