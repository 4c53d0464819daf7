//! Pictures of a take, for looking at a run without another program: a [`Picture`] per frame ([`draw_frame`]), a
//! contact sheet of some of them ([`contact_sheet`]), an [`Animation`], and a [`Page`] to turn the meshes about in a
//! browser.
//!
//! What is drawn are the meshes that `fissure-post` makes of a frame, seen in parallel projection, so that lengths in
//! the plane of the drawing keep their scale ([`View`]). Over them go what meshes do not show: cracks that are closed,
//! the live tips with their stress intensity, the time and a legend.
//!
//! A picture is drawn in two layers. `raster` fills triangles with a depth buffer, at twice the resolution; lines and
//! letters come on top at full resolution, smooth ([`tiny_skia`]). Lines lie in the front face of the solids, and as
//! these are seen from the front, nothing can hide that.
//!
//! All pictures of a sequence share one scale of length and one of colour: a [`Survey`] of the frames comes first.
//! The same frames give the same bytes.

mod animation;
mod cap_field;
mod coloring;
mod crack_lines;
mod draw;
mod inclusions;
mod layout;
mod legend;
mod lettering;
mod options;
mod origin;
mod page;
mod picture;
mod projection;
mod quantity;
mod raster;
mod rims;
mod sheet;
mod survey;
mod theme;
mod tip_marks;

pub use animation::{Animation, EncodedFrame};
pub use coloring::Coloring;
pub use draw::{Detail, draw_frame};
pub use options::{PreviewOptions, SIZES};
pub use origin::{Kind, is_ours};
pub use page::{PackedFrame, Page, Series, Table, TableError, page};
pub use picture::{EncodeError, Picture};
pub use projection::View;
pub use sheet::{SHEET_FRAMES, contact_sheet, sheet_frames, tile_options};
pub use survey::Survey;
pub use theme::Theme;
