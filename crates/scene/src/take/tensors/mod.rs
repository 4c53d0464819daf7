//! A frame as safetensors: what each tensor is called, its shape and type.
//!
//! What particles are at rest is in a file of its own, for all frames that have the same: `particles.id`, `.body`,
//! `.rest` and `.mass`. A frame that has others holds these itself.
//!
//! `n` particles; `k` rings with `m` points in all, `offset[i]..offset[i + 1]` those of ring `i`; likewise cracks; `t`
//! tips; `c` colliders. Numbers are little-endian, matrices row by row.
//!
//! | tensor | shape, type | |
//! |---|---|---|
//! | `frame.number`, `frame.time` | [1] i64, f64 | |
//! | `particles.id`, `.body`, `.piece` | \[n\] u32 | |
//! | `particles.mass` | \[n\] f64 | kg/m; not in versions before 5 |
//! | `particles.rest`, `.position`, `.velocity` | [n, 2] f64 | m, m, m/s |
//! | `particles.deformation_gradient`, `.cauchy_stress` | [n, 2, 2] f64 | –, Pa |
//! | `outlines.body`, `.ring`; `.offset` | \[k\] u32; [k + 1] i64 | |
//! | `outlines.rest`, `.position`, `.velocity` | [m, 2] f64 | |
//! | `cracks.crack`, `.body`; `.offset` | as for outlines | |
//! | `cracks.ends` | [k, 2] i64 | start and end: -1 tip, -2 mouth, else the crack it ends on |
//! | `cracks.rest`, `.above`, `.below`, `.above_velocity`, `.below_velocity` | [m, 2] f64 | |
//! | `cracks.formed_time`, `.formed_mode_1` | \[m\] f64 | s, Pa·√m; not in versions before 5 |
//! | `tips.crack`, `.end`, `.state` | \[t\] u32 | end: 0 start, 1 end; state: order of [`TipState`] |
//! | `tips.position`, and the other fields of [`TipRecord`] | [t, 2], \[t\] f64 | |
//! | `tips.radius_shrunk` | \[t\] u8 | 0 or 1 |
//! | `energies.kinetic`, `.strain`, `.external_work`, `.crack` | [1] f64 | J/m |
//! | `colliders.position`, `.angle` | [c, 2], \[c\] f64 | m, rad |

mod at_rest;
mod error;
mod read;
mod write;

pub use at_rest::ParticlesAtRest;
pub use error::FrameFileError;
pub use read::frame_from_bytes;
pub use write::frame_to_bytes;

use crate::frame::{TipRecord, TipState};

/// What the file of a frame says it is.
const FRAME_FORMAT: &str = "fissure-frame 2";
/// What the file of the particles at rest says it is.
const AT_REST_FORMAT: &str = "fissure-particles 1";
/// What both begin with, in every version.
const OURS: &str = "fissure-";

/// Order in which tip states are numbered.
const STATES: [TipState; 6] = [
    TipState::Resting,
    TipState::Growing,
    TipState::Arrested,
    TipState::LeftBody,
    TipState::MetCrack,
    TipState::GuideEnded,
];

/// The fields of a tip that are one number each, in the order in which [`tip_numbers`] gives them.
const TIP_NUMBERS: [&str; 10] = [
    "direction",
    "j_integral",
    "mode_1",
    "mode_2",
    "kink_angle",
    "equivalent",
    "fracture_toughness",
    "speed",
    "length",
    "contour_radius",
];

fn tip_numbers(t: &TipRecord) -> [f64; 10] {
    [
        t.direction,
        t.j_integral,
        t.mode_1,
        t.mode_2,
        t.kink_angle,
        t.equivalent,
        t.fracture_toughness,
        t.speed,
        t.length,
        t.contour_radius,
    ]
}

/// Whether the bytes say that they are of a take, of whatever version, whole or not: the first entry of the header of a
/// safetensors file is what the file is.
pub(super) fn is_ours(bytes: &[u8]) -> bool {
    let start = format!("{{\"__metadata__\":{{\"format\":\"{OURS}");
    bytes.get(8..).is_some_and(|header| header.starts_with(start.as_bytes()))
}
