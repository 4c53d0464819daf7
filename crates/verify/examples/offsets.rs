//! Static edge crack over 16 offsets of the tip within a cell: `cargo run --release -p fissure-verify --example offsets -- CELLS`.
#![allow(clippy::print_stdout)]

use fissure_scene::SolverPreset;
use fissure_verify::EdgeCrack;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cells: f64 = std::env::args().nth(1).map_or(Ok(8.0), |s| s.parse())?;
    println!("offset along, across [cells]   K_I error %   K_II/K_I %   sqrt(E'J) error %   steps");
    for across in [0.01, 0.26, 0.51, 0.76] {
        for along in [-0.375, -0.125, 0.125, 0.375] {
            let problem = EdgeCrack { cells, tip_offset: [along, across], ..EdgeCrack::default() };
            let found = problem.run(SolverPreset::Standard)?;
            let error = |k: f64| 100.0 * (k / problem.mode_1() - 1.0);
            println!(
                "{along:7.3} {across:5.2} {:+27.2} {:+12.2} {:+19.2} {:7}",
                error(found.mode_1),
                100.0 * found.mode_2 / found.mode_1,
                error(found.mode_1_of_j),
                found.steps
            );
        }
    }
    Ok(())
}
