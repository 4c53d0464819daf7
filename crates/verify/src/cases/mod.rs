//! One file per case: setup, reference, source.

pub(crate) mod bar_wave;
pub(crate) mod branching_plate;
pub(crate) mod cantilever;
pub(crate) mod cantilever_growth;
pub(crate) mod center_crack;
pub(crate) mod closed_crack;
pub(crate) mod crack_motion;
pub(crate) mod crack_pairs;
pub(crate) mod double_cantilever;
pub(crate) mod edge_crack;
pub(crate) mod free_flight;
pub(crate) mod impacted_notch;
pub(crate) mod kink_angles;
pub(crate) mod moving_crack;
pub(crate) mod slanted_crack;
pub(crate) mod spinning_disc;
pub(crate) mod step_load;
mod stepped_plate;
pub(crate) mod strip;
pub(crate) mod three_holes;
pub(crate) mod transfers;

/// Kinetic energy at rest, as a part of the strain energy: from 1e-8 on, K_I of edge cracks changes by less than 1e-3.
const REST: f64 = 1e-8;
/// Steps to rest at most; long beams need the most.
const MOST_STEPS: u64 = 50_000;

/// Places of a tip within a cell, along and across the crack, in cells: 16, or the 4 on their diagonal.
pub(crate) fn offsets(all: bool) -> Vec<[f64; 2]> {
    let (along, across) = ([-0.375, -0.125, 0.125, 0.375], [0.01, 0.26, 0.51, 0.76]);
    if all {
        across.iter().flat_map(|&y| along.iter().map(move |&x| [x, y])).collect()
    } else {
        along.iter().zip(across).map(|(&x, y)| [x, y]).collect()
    }
}
