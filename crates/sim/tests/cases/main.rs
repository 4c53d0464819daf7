//! What the solver does as its users see it, from a scene to frames, against closed forms, symmetries and scalings.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
mod contour;
mod contract;
mod directing;
mod edges;
mod pieces;
mod plane;
mod pressure;
mod price;
mod scale;
mod singular;
mod updated_solver;
