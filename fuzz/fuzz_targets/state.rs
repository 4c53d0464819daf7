#![no_main]

use fissure_tests::fuzz::{Bench, Target};
use std::sync::LazyLock;

static BENCH: LazyLock<Bench> = LazyLock::new(Bench::new);

libfuzzer_sys::fuzz_target!(|input: &[u8]| drop(BENCH.run(Target::State, input)));
