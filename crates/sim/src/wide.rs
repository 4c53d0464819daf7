//! Loops over numbers side by side, in the widest instructions that the machine has: chosen by `pulp` as the program
//! runs with the feature `wide`, those that the build is for without it.
//!
//! Results are the same to the last bit. Each number goes through the same operations however many go at once; square
//! roots and quotients are rounded correctly by all instructions (IEEE 754); and a product and a sum are rounded one by
//! one, because Rust never makes one fused operation of two.

/// A loop that is compiled once for each width.
///
/// `run`, and all that it calls in the loop, must be `#[inline(always)]`: what is not inlined is compiled for the
/// narrowest instructions.
pub(crate) trait Loop {
    /// What it gives.
    type Output;

    /// Goes through all of it.
    fn run(self) -> Self::Output;
}

/// Runs a loop in the widest instructions there are.
#[cfg(feature = "wide")]
pub(crate) fn run_widest<L: Loop>(numbers: L) -> L::Output {
    pulp::Arch::new().dispatch(Compiled(numbers))
}

/// Runs a loop in the instructions that the build is for.
#[cfg(not(feature = "wide"))]
pub(crate) fn run_widest<L: Loop>(numbers: L) -> L::Output {
    numbers.run()
}

/// The widest instructions that the machine has: what the rows of a step are computed with.
pub fn widest_instructions() -> &'static str {
    #[cfg(all(feature = "wide", target_arch = "x86_64"))]
    match pulp::Arch::new() {
        pulp::Arch::V4(_) => return "AVX-512",
        pulp::Arch::V3(_) => return "AVX2",
        _ => (),
    }
    if cfg!(target_arch = "x86_64") { "SSE2" } else { "those of the build" }
}

/// A loop as `pulp` takes it.
#[cfg(feature = "wide")]
struct Compiled<L>(L);

#[cfg(feature = "wide")]
impl<L: Loop> pulp::WithSimd for Compiled<L> {
    type Output = L::Output;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> L::Output {
        self.0.run()
    }
}

/// What a loop gives in each of the instructions that the machine has, by their names.
#[cfg(test)]
pub(crate) fn run_in_all<L: Loop>(mut make: impl FnMut() -> L) -> Vec<(&'static str, L::Output)> {
    #[allow(unused_mut)]
    let mut found = vec![("the build's", make().run())];
    #[cfg(all(feature = "wide", target_arch = "x86_64"))]
    {
        use pulp::x86::{V3, V4};
        found.extend(V3::try_new().map(|v3| ("AVX2", pulp::Arch::V3(v3).dispatch(Compiled(make())))));
        found.extend(V4::try_new().map(|v4| ("AVX-512", pulp::Arch::V4(v4).dispatch(Compiled(make())))));
    }
    found
}
