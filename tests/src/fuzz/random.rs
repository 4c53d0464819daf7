//! Random choices that are the same on every machine.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Random choices.
#[derive(Debug)]
pub struct Random(Pcg64);

impl Random {
    /// The choices of one input: `index` of the sequence `seed`. Inputs are independent, so that each can be made again
    /// alone.
    pub fn new(seed: u64, index: u64) -> Self {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8..16].copy_from_slice(&index.to_le_bytes());
        // An increment apart for each seed.
        bytes[16..24].copy_from_slice(&seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).to_le_bytes());
        let mut random = Self(Pcg64::from_seed(bytes));
        // The first numbers of neighbouring states are alike.
        for _ in 0..4 {
            random.bits();
        }
        random
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number below `count`; 0 when that is 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// True once in `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// Evenly distributed from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of `items`, which are some.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// A number that breaks things: extreme, degenerate, or of any size.
    pub fn hostile(&mut self) -> f64 {
        const SPECIAL: [f64; 34] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            2.0,
            0.1,
            1e-3,
            100.0,
            1e-45,
            5e-324,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            3.402_823_5e38,
            1e154,
            1e155,
            1e-200,
            1e200,
            1e-20,
            1e16,
            1e30,
            1e9,
            1e-9,
            1e-12,
            2_147_483_648.0,
            4_294_967_296.0,
            9.223_372_036_854_776e18,
            1e20,
            1e-6,
            1e6,
        ];
        match self.below(4) {
            0 | 1 => *self.pick(&SPECIAL),
            2 => self.signed() * 10.0_f64.powf(40.0 * self.unit() - 20.0),
            _ => f64::from_bits(self.bits()),
        }
    }

    /// A number of everyday size.
    pub fn plain(&mut self) -> f64 {
        let digits = 10.0_f64.powi(self.below(4) as i32);
        (self.signed() * 20.0 * self.unit() * digits).round() / digits
    }

    fn signed(&mut self) -> f64 {
        if self.once_in(2) { -1.0 } else { 1.0 }
    }
}
