//! How fast the total Lagrangian formulation is, with and without cracks: a table of whole runs.
//!
//!     cargo bench --bench rates                # 250 cells along a side: 2.5e5 particles
//!     cargo bench --bench rates -- 87          # 3e4 particles
//!     cargo bench --bench rates -- 1 crack growing
//!     RAYON_NUM_THREADS=1 cargo bench --bench rates
//!
//! Rates are particles times steps over the time of all threads ("CPU") and over that of a clock ("wall"); "of bulk"
//! compares CPU time with that of the plate without a crack. Rates of a busy machine say nothing: take the best of
//! several.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use fissure_verify::TIMED_PLATES;
use std::time::Duration;

/// How long a plate is timed.
const LEAST_TIME: Duration = Duration::from_secs(2);

fn main() {
    // The size stands alone or first: names begin with numbers too.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let name = words.join(" ");
    let is_name = TIMED_PLATES.iter().any(|plate| plate.name == name);
    let cells = if is_name { None } else { words.first().and_then(|word| word.parse().ok()) };
    let chosen = if cells.is_some() { words[1..].join(" ") } else { name };
    let threads = std::env::var("RAYON_NUM_THREADS").ok().and_then(|count| count.parse().ok()).unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global().unwrap();
    let threads = rayon::current_num_threads();
    println!("{threads} threads, f64, {}\n", fissure_sim::widest_instructions());
    println!("| scene | particles | steps | increments | M/s CPU | M/s wall | of bulk |");
    println!("|---|---|---|---|---|---|---|");
    let mut whole = None;
    for plate in TIMED_PLATES.iter().filter(|plate| chosen.is_empty() || plate.name == chosen) {
        let Some(rate) = plate.time(cells.unwrap_or(250), LEAST_TIME).unwrap() else { continue };
        let (cpu, wall) = (rate.per_second(rate.cpu), rate.per_second(rate.wall));
        let part = 100.0 * cpu / *whole.get_or_insert(cpu);
        println!(
            "| {} | {} | {} | {} | {:.1} | {:.1} | {part:.0} % |",
            plate.name,
            rate.particles,
            rate.steps,
            rate.increments,
            cpu * 1e-6,
            wall * 1e-6
        );
    }
}
