//! Straight flaws scattered at random, apart from each other and from everything else.

use fissure_plane::{Point, Region, Vector, bounds, segment_distance};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use sha2::{Digest, Sha256};

/// What flaws to scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flaws {
    /// Most of them.
    pub(crate) count: usize,
    /// Mean length [m].
    pub(crate) length: f64,
    /// Half the range of lengths, as a part of the mean.
    pub(crate) length_spread: f64,
    /// Middle of the range of directions [rad].
    pub(crate) angle: f64,
    /// Half the range of directions [rad].
    pub(crate) angle_spread: f64,
    /// Least distance from rings, lines and other flaws [m]; above 0.
    pub(crate) margin: f64,
    /// Stands for one arrangement.
    pub(crate) seed: u64,
    /// Makes several sets of flaws of one seed independent.
    pub(crate) stream: u64,
}

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flaw {
    /// Index of the region it lies in.
    pub(crate) region: usize,
    pub(crate) ends: [Point; 2],
}

/// Darts thrown for one flaw before the plate counts as full.
const MOST_DARTS: usize = 10_000;

/// Comparisons of darts with obstacles before the plate counts as full: they take about a second.
const MOST_COMPARISONS: usize = 500_000_000;

/// Throws darts until there are as many flaws as asked for, or none fits any more.
///
/// Centres lie in one of `regions` and, if given, in one of `within`; flaws keep their margin from the rings of
/// `regions`, from `lines` and from each other. A larger count gives the same flaws and more. Nothing here depends on
/// the machine: integers and IEEE arithmetic, sine and cosine from a library of its own.
pub(crate) fn scatter(flaws: &Flaws, regions: &[&Region], within: Option<&[Region]>, lines: &[&[Point]]) -> Vec<Flaw> {
    let mut random = Random::new(flaws.seed, flaws.stream);
    let target: Vec<&Region> = within.map_or_else(|| regions.to_vec(), |shapes| shapes.iter().collect());
    let corners: Vec<Point> = target.iter().flat_map(|r| r.exterior.iter().copied()).collect();
    let (low, high) = bounds(&corners);
    let mut obstacles: Vec<[Point; 2]> = lines.iter().flat_map(|line| line.windows(2)).map(|w| [w[0], w[1]]).collect();
    for ring in regions.iter().flat_map(|r| r.rings()) {
        obstacles.extend((0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]));
    }
    let mut placed = Vec::new();
    let mut comparisons_left = MOST_COMPARISONS;
    while placed.len() < flaws.count {
        let dart = || {
            let center = Point::new(random.between(low.x, high.x), random.between(low.y, high.y));
            let half = 0.5 * flaws.length * (1.0 + flaws.length_spread * random.between(-1.0, 1.0));
            let (sine, cosine) = libm::sincos(flaws.angle + flaws.angle_spread * random.between(-1.0, 1.0));
            let region = regions.iter().position(|r| r.contains(center))?;
            if within.is_some_and(|shapes| !shapes.iter().any(|s| s.contains(center))) {
                return None;
            }
            let arm = half * Vector::new(cosine, sine);
            let ends = [center - arm, center + arm];
            is_clear(ends, &obstacles, flaws.margin).then_some(Flaw { region, ends })
        };
        let most_darts = MOST_DARTS.min(comparisons_left / obstacles.len().max(1));
        let mut darts = std::iter::repeat_with(dart).take(most_darts).enumerate();
        let Some((missed, flaw)) = darts.find_map(|(missed, flaw)| Some((missed, flaw?))) else { break };
        comparisons_left -= (missed + 1) * obstacles.len();
        obstacles.push(flaw.ends);
        placed.push(flaw);
    }
    placed
}

/// Whether a segment keeps `margin` from all `obstacles`.
fn is_clear([a, b]: [Point; 2], obstacles: &[[Point; 2]], margin: f64) -> bool {
    let (low, high) = (a.inf(&b), a.sup(&b));
    obstacles.iter().all(|[c, d]| {
        let (gap_above, gap_below) = (c.inf(d) - high, low - c.sup(d));
        gap_above.sup(&gap_below).max() >= margin || segment_distance(a, b, *c, *d) >= margin
    })
}

/// Numbers that are the same on every machine.
struct Random(Pcg64);

impl Random {
    fn new(seed: u64, stream: u64) -> Self {
        let digest = Sha256::new().chain_update(seed.to_le_bytes()).chain_update(stream.to_le_bytes()).finalize();
        Self(Pcg64::from_seed(digest.into()))
    }

    /// Evenly distributed from `low` to below `high`.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + unit * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FLAWS: Flaws = Flaws {
        count: 40,
        length: 0.5,
        length_spread: 0.4,
        angle: 0.0,
        angle_spread: std::f64::consts::FRAC_PI_2,
        margin: 0.1,
        seed: 1,
        stream: 0,
    };

    fn points(list: &[[f64; 2]]) -> Vec<Point> {
        list.iter().map(|&p| Point::from(p)).collect()
    }

    /// A plate of 10 x 6 m with a square hole of 2 m, and a bar beside it.
    fn bodies() -> [Region; 2] {
        let hole = points(&[[4.0, 2.0], [4.0, 4.0], [6.0, 4.0], [6.0, 2.0]]);
        let plate = points(&[[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [0.0, 6.0]]);
        let bar = points(&[[10.0, 0.0], [12.0, 0.0], [12.0, 6.0], [10.0, 6.0]]);
        [Region { exterior: plate, holes: vec![hole] }, Region { exterior: bar, holes: Vec::new() }]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Truth: brute force. Points along each flaw keep the margin from points along everything else, less what
        /// sampling misses.
        #[test]
        fn flaws_keep_their_distance(seed in any::<u64>(), margin in 0.05_f64..0.3, angle in -3.0_f64..3.0, spread in 0.0_f64..0.3) {
            let bodies = bodies();
            let regions: Vec<&Region> = bodies.iter().collect();
            let line = points(&[[0.0, 5.0], [3.0, 5.0]]);
            let flaws = Flaws { seed, margin, angle, angle_spread: spread, ..FLAWS };
            let placed = scatter(&flaws, &regions, None, &[&line]);
            prop_assert_eq!(placed.len(), flaws.count);
            let sampled = |a: Point, b: Point| (0..=20).map(move |i| a + (b - a) * (f64::from(i) / 20.0));
            let edge = |a: Point, b: Point| (0..=400).map(move |i| a + (b - a) * (f64::from(i) / 400.0));
            let mut rest: Vec<Point> = line.windows(2).flat_map(|w| edge(w[0], w[1])).collect();
            for ring in regions.iter().flat_map(|r| r.rings()) {
                rest.extend((0..ring.len()).flat_map(|i| edge(ring[i], ring[(i + 1) % ring.len()])));
            }
            for flaw in &placed {
                let [a, b] = flaw.ends;
                prop_assert!(((b - a).norm() / 0.5 - 1.0).abs() <= 0.4 + 1e-12);
                let turn = ((b - a).y.atan2((b - a).x) - angle + 0.5 * std::f64::consts::PI)
                    .rem_euclid(std::f64::consts::PI) - 0.5 * std::f64::consts::PI;
                prop_assert!(turn.abs() <= spread + 1e-9, "{} {}", turn, spread);
                for p in sampled(a, b) {
                    prop_assert!(regions[flaw.region].contains(p));
                    prop_assert!(rest.iter().all(|q| (p - q).norm() >= margin - 1e-9));
                }
                rest.extend(sampled(a, b));
            }
        }

        /// Truth: the number of the seed is all that decides; more flaws leave the ones before where they are.
        #[test]
        fn one_seed_is_one_arrangement(seed in any::<u64>(), other in any::<u64>(), fewer in 1_usize..40) {
            prop_assume!(seed != other);
            let bodies = bodies();
            let regions: Vec<&Region> = bodies.iter().collect();
            let with = |flaws: Flaws| scatter(&flaws, &regions, None, &[]);
            let all = with(Flaws { seed, ..FLAWS });
            prop_assert_eq!(&with(Flaws { seed, ..FLAWS }), &all);
            prop_assert_eq!(&with(Flaws { seed, count: fewer, ..FLAWS })[..], &all[..fewer]);
            prop_assert_ne!(&with(Flaws { seed: other, ..FLAWS }), &all);
            prop_assert_ne!(&with(Flaws { seed, stream: 1, ..FLAWS }), &all);
        }
    }

    /// Truth: the same darts in Python (hashlib, PCG64 from its paper, math.sin), to all digits: every machine gives
    /// these.
    #[test]
    fn arrangements_never_change() {
        let bodies = bodies();
        let regions: Vec<&Region> = bodies.iter().collect();
        let placed = scatter(&Flaws { count: 2, ..FLAWS }, &regions, None, &[]);
        let ends: Vec<[f64; 2]> = placed.iter().flat_map(|f| f.ends).map(|p| [p.x, p.y]).collect();
        let first = [[2.235036768907366, 4.913724461521988], [2.698594493838128, 4.823557041629864]];
        let second = [[2.699626402084987, 5.638621818702941], [2.8430090604930243, 5.137710108450184]];
        assert_eq!(ends, [first, second].concat());
    }

    /// Truth: flaws along x in a strip one margin and a half wide lie end to end, so no more than strip / (length +
    /// margin) fit.
    #[test]
    fn a_full_strip_ends_the_search() {
        let strip = Region { exterior: points(&[[0.0, 0.0], [7.0, 0.0], [7.0, 0.25], [0.0, 0.25]]), holes: Vec::new() };
        let flaws = Flaws { length_spread: 0.0, angle_spread: 0.0, ..FLAWS };
        let placed = scatter(&flaws, &[&strip], None, &[]);
        assert!((5..=11).contains(&placed.len()), "{}", placed.len());
        // Only in the left part, by their centres.
        let left = [Region { exterior: points(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]), holes: Vec::new() }];
        let placed = scatter(&flaws, &[&strip], Some(&left), &[]);
        assert!(!placed.is_empty() && placed.iter().all(|f| nalgebra::center(&f.ends[0], &f.ends[1]).x < 2.0));
    }
}
