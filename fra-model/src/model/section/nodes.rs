//! Nodes of the integrals over a bent section: angles around it and radii through the wall, as many as the bend takes.
//!
//! Around the section the midpoint rule converges geometrically: the deformed radius is a function of `x = cos(phi_c) k/(1+k)` that is
//! analytic up to a nearest singularity `1/x_s`, and `n` angles on half a turn leave an error of about `(x/2 x_s)^2n`. Through the wall
//! Gauss's rule does, in a variable near `ln R` that takes no logarithm: `R^2 = R_m^2 ((1 + s t)/(1 - s t))^4`, `-1 < t < 1`. How many of
//! either are enough is a table of bends and walls, `section/tests.rs` compares it with many more.

use core::f64::consts::FRAC_1_SQRT_2;

use crate::number::arithmetic::Arithmetic;
use crate::number::scalar::Scalar;

const GAUSS_3: [(f64, f64); 3] = [
    (0.0, 0.888_888_888_888_888_8),
    (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
    (-0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
];
const GAUSS_4: [(f64, f64); 4] = [
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];
const GAUSS_5: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
];
const GAUSS_6: [(f64, f64); 6] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
    (-0.932_469_514_203_152, 0.171_324_492_379_170_36),
];
const GAUSS_7: [(f64, f64); 7] = [
    (0.0, 0.417_959_183_673_469_4),
    (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
    (-0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
    (0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
    (-0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
    (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    (-0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
];
const GAUSS_8: [(f64, f64); 8] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (-0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (-0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (-0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    (-0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];
const GAUSS_10: [(f64, f64); 10] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (-0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (-0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (-0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (-0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
    (-0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Most nodes of a rule.
const NODES: usize = 10;

/// Nodes of a panel, and the ratio of its radii up to which they are enough. The largest serves thicker walls in several panels.
const RADII_DOUBLE: [(u8, f64); 5] = [(5, 1.09), (6, 1.22), (7, 1.35), (8, 1.64), (10, 2.28)];
const RADII_SINGLE: [(u8, f64); 4] = [(3, 1.15), (4, 1.38), (5, 1.85), (6, 2.3)];
const RADII_ROUGH: [(u8, f64); 1] = [(3, 1.45)];

/// Bends beyond which the panels crowd towards the outer face, and their nodes.
const UNGRADED_UNTIL: f64 = 0.3;
const GRADED_DOUBLE: u8 = 10;
const GRADED_SINGLE: u8 = 5;
/// Largest ratio of the squared radii of such a panel, and the most panels.
const WIDEST: f64 = 2.7;
const GRADED_PANELS: u8 = 60;

/// Cosine and sine of the first half of `n` equal angles on half a turn, `pi (2j+1)/(2n)`.
const ANGLES_2: [(f64, f64); 1] = [(FRAC_1_SQRT_2, FRAC_1_SQRT_2)];
const ANGLES_4: [(f64, f64); 2] =
    [(0.923_879_532_511_286_7, 0.382_683_432_365_089_8), (0.382_683_432_365_089_8, 0.923_879_532_511_286_7)];
const ANGLES_6: [(f64, f64); 3] = [
    (0.965_925_826_289_068_3, 0.258_819_045_102_520_74),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (0.258_819_045_102_520_74, 0.965_925_826_289_068_3),
];
const ANGLES_8: [(f64, f64); 4] = [
    (0.980_785_280_403_230_4, 0.195_090_322_016_128_28),
    (0.831_469_612_302_545_2, 0.555_570_233_019_602_2),
    (0.555_570_233_019_602_2, 0.831_469_612_302_545_2),
    (0.195_090_322_016_128_28, 0.980_785_280_403_230_4),
];
const ANGLES_10: [(f64, f64); 5] = [
    (0.987_688_340_595_137_8, 0.156_434_465_040_230_87),
    (0.891_006_524_188_367_9, 0.453_990_499_739_546_8),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
    (0.453_990_499_739_546_8, 0.891_006_524_188_367_9),
    (0.156_434_465_040_230_87, 0.987_688_340_595_137_8),
];
const ANGLES_12: [(f64, f64); 6] = [
    (0.991_444_861_373_810_4, 0.130_526_192_220_051_6),
    (0.923_879_532_511_286_7, 0.382_683_432_365_089_8),
    (0.793_353_340_291_235_2, 0.608_761_429_008_720_7),
    (0.608_761_429_008_720_7, 0.793_353_340_291_235_2),
    (0.382_683_432_365_089_8, 0.923_879_532_511_286_7),
    (0.130_526_192_220_051_6, 0.991_444_861_373_810_4),
];
const ANGLES_16: [(f64, f64); 8] = [
    (0.995_184_726_672_196_9, 0.098_017_140_329_560_6),
    (0.956_940_335_732_208_8, 0.290_284_677_254_462_4),
    (0.881_921_264_348_355, 0.471_396_736_825_997_64),
    (0.773_010_453_362_737, 0.634_393_284_163_645_5),
    (0.634_393_284_163_645_5, 0.773_010_453_362_737),
    (0.471_396_736_825_997_64, 0.881_921_264_348_355),
    (0.290_284_677_254_462_4, 0.956_940_335_732_208_8),
    (0.098_017_140_329_560_6, 0.995_184_726_672_196_9),
];

/// Angles on half a turn, and the nearness `x/x_s` of the singularity up to which they are enough.
pub(super) const NEAR_DOUBLE: [(u8, f64); 9] =
    [(2, 0.0), (4, 4e-3), (6, 0.05), (8, 0.13), (10, 0.26), (12, 0.37), (16, 0.58), (32, 0.85), (64, 0.95)];
pub(super) const NEAR_SINGLE: [(u8, f64); 5] = [(2, 0.0), (4, 0.09), (6, 0.27), (8, 0.6), (12, 0.8)];
pub(super) const NEAR_ROUGH: [(u8, f64); 2] = [(2, 2e-3), (4, 0.3)];

/// Required accuracy of an integral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Digits {
    /// Those of the scalar.
    All,
    /// Enough for a first guess.
    Few,
}

/// The wall in units of the outer radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall<S> {
    /// `rho_i^2`.
    pub(super) inner2: S,
    /// `R_o/R_i - 1`, which a thin wall needs by itself.
    pub(super) excess: S,
}

/// The first entry of a table that is enough; none where none is.
#[inline(always)]
pub(super) fn enough<S: Arithmetic, const N: usize>(table: [(u8, f64); N], measure: S) -> Option<u8> {
    table.into_iter().find(|(_, until)| measure.is_at_most(measure.of(*until))).map(|(count, _)| count)
}

/// Number of angles of a bend, by the nearness of its singularity.
pub(super) fn angles<S: Arithmetic>(near: S, digits: Digits) -> u8 {
    match digits {
        Digits::Few => enough(NEAR_ROUGH, near).unwrap_or(6),
        Digits::All if near.is_single() => enough(NEAR_SINGLE, near).unwrap_or(32),
        Digits::All => enough(NEAR_DOUBLE, near).unwrap_or(128),
    }
}

/// The panels of a wall that a bend takes, one after the other, and the rule of Gauss in each.
pub(super) struct Panels<S> {
    rule: [(S, S); NODES],
    count: usize,
    way: Way<S>,
}

/// Equal panels: their number, the nodes of each, the ratio of its radii, and that less one.
struct Equal<S> {
    panels: u16,
    nodes: u8,
    ratio: S,
    excess: S,
}

/// How panels follow each other.
enum Way<S> {
    /// Equal ones from the inner face: how many are left, inner end of the next, ratio of its radii and that squared, and what `Panel::new` takes.
    Equal {
        left: u16,
        from: S,
        ratio: S,
        square: S,
        excess: S,
        root: S,
    },
    /// Towards the inner face, no wider than their distance from a singularity beyond the outer face, in `ln R`. Ratios of squared radii, less one:
    /// to the inner face, and to the fold.
    Graded {
        round: u8,
        left: S,
        away: S,
        to: S,
    },
    Done,
}

/// One panel, in the variable of the rule.
pub(super) struct Panel<S> {
    middle: S,
    spread: S,
    scale: S,
}

impl<S: Arithmetic> Wall<S> {
    pub(super) fn new(inner_m: S, outer_m: S) -> Self {
        let inner = inner_m / outer_m;
        Self { inner2: inner * inner, excess: (outer_m - inner_m) / inner_m }
    }

    /// Calls `f(rho^2, weight)` at the nodes for `int d(rho^2)` that a bend takes; `fold` is where in `rho^2` its map folds.
    pub(super) fn for_each(&self, k: S, fold: impl FnOnce() -> S, digits: Digits, mut f: impl FnMut(S, S)) {
        let mut panels = self.panels(k, fold, digits);
        while let Some(panel) = panels.next() {
            for &(t, weight) in panels.rule() {
                let (square, weight) = panel.node(t, weight);
                f(square, weight);
            }
        }
    }

    /// The panels that a bend takes; `fold` is where in `rho^2` its map folds.
    #[inline(always)]
    pub(super) fn panels(&self, k: S, fold: impl FnOnce() -> S, digits: Digits) -> Panels<S> {
        if takes_equal_panels(k, digits) { self.in_equal_panels(digits) } else { self.towards_the_outer_face(fold()) }
    }

    /// Number of nodes of equal panels; `None` for a bend that takes others.
    pub(super) fn radii(&self, k: S, digits: Digits) -> Option<u16> {
        let equal = takes_equal_panels(k, digits).then(|| self.equal(digits));
        equal.map(|Equal { panels, nodes, .. }| panels * u16::from(nodes))
    }

    #[inline(always)]
    fn in_equal_panels(&self, digits: Digits) -> Panels<S> {
        let Equal { panels, nodes, ratio, excess } = self.equal(digits);
        let (excess, _) = half_power(excess);
        let (excess, root) = half_power(excess);
        let way = Way::Equal { left: panels, from: self.inner2, ratio, square: ratio * ratio, excess, root };
        Panels { rule: rule(ratio, nodes), count: usize::from(nodes), way }
    }

    #[inline(always)]
    fn equal(&self, digits: Digits) -> Equal<S> {
        let one = self.excess.of(1.0);
        let (mut ratio, mut panels, mut excess) = (one + self.excess, 1_u16, self.excess);
        let single = one.is_single();
        let most = match digits {
            Digits::Few => RADII_ROUGH[RADII_ROUGH.len() - 1],
            Digits::All if single => RADII_SINGLE[RADII_SINGLE.len() - 1],
            Digits::All => RADII_DOUBLE[RADII_DOUBLE.len() - 1],
        };
        while !ratio.is_at_most(one.of(most.1)) && panels < 1 << 10 {
            (excess, ratio) = half_power(excess);
            panels *= 2;
        }
        let nodes = match digits {
            Digits::Few => most.0,
            Digits::All if single => enough(RADII_SINGLE, ratio).unwrap_or(most.0),
            Digits::All => enough(RADII_DOUBLE, ratio).unwrap_or(most.0),
        };
        Equal { panels, nodes, ratio, excess }
    }

    #[inline(always)]
    fn towards_the_outer_face(&self, fold: S) -> Panels<S> {
        let one = self.excess.of(1.0);
        let nodes = if one.is_single() { GRADED_SINGLE } else { GRADED_DOUBLE };
        let (rule, count) = (rule(one, nodes), usize::from(nodes));
        let left = self.excess * (self.excess + one.of(2.0));
        Panels { rule, count, way: Way::Graded { round: 0, left, away: fold - one, to: one } }
    }
}

#[inline(always)]
fn takes_equal_panels<S: Arithmetic>(k: S, digits: Digits) -> bool {
    k.is_at_most(k.of(UNGRADED_UNTIL)) || digits == Digits::Few
}

impl<S: Arithmetic> Panels<S> {
    /// Nodes between -1 and 1 with their weights.
    #[inline(always)]
    pub(super) fn rule(&self) -> &[(S, S)] {
        &self.rule[..self.count]
    }

    /// The next panel.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<Panel<S>> {
        match &mut self.way {
            Way::Equal { left: 0, .. } | Way::Done => None,
            Way::Equal { left, from, ratio, square, excess, root } => {
                let middle = *from * *ratio;
                (*left, *from) = (*left - 1, *from * *square);
                Some(Panel::new(middle, *excess, *root))
            }
            Way::Graded { round, left, away, to } => {
                let one = left.of(1.0);
                let widest = half_power(*away).0.least(one.of(WIDEST - 1.0));
                *round += 1;
                let last = *round == GRADED_PANELS || left.is_at_most(widest);
                // Other lanes may have reached their inner face already.
                let excess = if last { *left } else { left.least(widest) };
                let ratio = one + excess;
                let (half, root) = half_power(excess);
                let (quarter, _) = half_power(half);
                let (eighth, root8) = half_power(quarter);
                let from = *to / ratio;
                let panel = Panel::new(from * root, eighth, root8);
                if last {
                    self.way = Way::Done;
                } else {
                    (*to, *left, *away) = (from, (*left - excess) / ratio, *away * ratio + excess);
                }
                Some(panel)
            }
        }
    }
}

/// `(sqrt(1 + x) - 1, sqrt(1 + x))`.
#[inline(always)]
fn half_power<S: Arithmetic>(x: S) -> (S, S) {
    let one = x.of(1.0);
    let root = (one + x).root();
    (x / (one + root), root)
}

impl<S: Arithmetic> Panel<S> {
    /// Around `middle`, with ends that are `middle` over and times the fourth power of `root`, which is one and `excess`.
    #[inline(always)]
    fn new(middle: S, excess: S, root: S) -> Self {
        let spread = excess / (root.of(1.0) + root);
        Self { middle, spread, scale: spread.of(8.0) * spread }
    }

    /// `rho^2` at a node of the rule, and its weight for `int d(rho^2)`.
    #[inline(always)]
    pub(super) fn node(&self, t: S, weight: S) -> (S, S) {
        let one = t.of(1.0);
        let (above, below) = (one + self.spread * t, one - self.spread * t);
        let inverse = one / (above * below);
        let ratio = above * above * inverse;
        let square = ratio * ratio;
        let x = self.middle * square * square;
        (x, self.scale * weight * x * inverse)
    }
}

/// A rule of Gauss.
#[inline(always)]
fn rule<S: Arithmetic>(one: S, nodes: u8) -> [(S, S); NODES] {
    match nodes {
        3 => padded(one, GAUSS_3),
        4 => padded(one, GAUSS_4),
        5 => padded(one, GAUSS_5),
        6 => padded(one, GAUSS_6),
        7 => padded(one, GAUSS_7),
        8 => padded(one, GAUSS_8),
        _ => padded(one, GAUSS_10),
    }
}

/// Most angles of a table.
pub(crate) const MOST_TABLED: u8 = 16;

/// Cosines and sines of the first `count / 2` of `count` angles; `count` is 2, 4, 6, 8, 10, 12 or 16. The rest of the array is padding.
#[inline(always)]
pub(super) fn tabled<S: Arithmetic>(one: S, count: u8) -> [(S, S); MOST_TABLED as usize / 2] {
    match count {
        2 => padded(one, ANGLES_2),
        4 => padded(one, ANGLES_4),
        6 => padded(one, ANGLES_6),
        8 => padded(one, ANGLES_8),
        10 => padded(one, ANGLES_10),
        12 => padded(one, ANGLES_12),
        _ => padded(one, ANGLES_16),
    }
}

/// A table in the scalar, converted while its entries are still constants of the source, and padded with its last entry.
#[inline(always)]
fn padded<S: Arithmetic, const N: usize, const M: usize>(one: S, table: [(f64, f64); N]) -> [(S, S); M] {
    let table = table.map(|(a, b)| (one.of(a), one.of(b)));
    core::array::from_fn(|i| table[i.min(N - 1)])
}

/// The first half of `2 N` equal angles on half a turn.
pub(super) fn equal_angles<T: Scalar, const N: usize>() -> [(T, T); N] {
    let half_step = T::constant(core::f64::consts::PI / (4 * N) as f64);
    let mut odd = -T::one();
    core::array::from_fn(|_| {
        odd += T::constant(2.0);
        let angle = odd * half_step;
        (angle.cos(), angle.sin())
    })
}
