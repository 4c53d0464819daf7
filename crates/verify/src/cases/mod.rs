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
pub(crate) mod drawn_kinks;
pub(crate) mod edge_crack;
pub(crate) mod free_flight;
pub(crate) mod hertz;
pub(crate) mod impacted_notch;
pub(crate) mod incline;
pub(crate) mod kink_angles;
pub(crate) mod moving_crack;
pub(crate) mod slanted_crack;
pub(crate) mod spinning_disc;
pub(crate) mod step_load;
mod stepped_plate;
pub(crate) mod strip;
pub(crate) mod three_holes;
pub(crate) mod transfers;
pub(crate) mod two_discs;
pub(crate) mod wedge;
