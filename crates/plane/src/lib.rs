//! Geometry of the plane: [`Point`]s, polylines, rings and [`Region`]s of them, and predicates with exact signs.
//!
//! This crate promises that which side of a line a point is on, whether two segments touch, and whether a region
//! contains a point are decided exactly, whatever the coordinates ([`orientation`]). Lengths and areas are rounded as
//! any sum is.
//!
//! It reads no file and knows no scene. The solver asks it for every pair of a particle and a node near a crack, so it
//! is compiled for speed and its small functions may be inlined into the caller.
//!
//! The crate `geo` is the truth of the tests, on coordinates that meet often, and not part of the build. It would do
//! for areas, distances and the crossings of segments, but all that is asked here is asked of rings that are lists of
//! points, by edge: the place nearest to a point with its ring, its edge and the bits of a corner; the place where
//! lines cross or run back; a point on an edge told to one side only. `geo` wants closed copies of each ring, says that
//! a polygon is not valid and not where, and tells points on an edge to no side. It would also bring a second
//! `i_overlay` to every build of the solver.
//!
//! ```
//! use fissure_plane::{Point, Region, find_crossing, segments_touch};
//!
//! let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)];
//! let plate = Region { exterior: corners.map(|(x, y)| Point::new(x, y)).to_vec(), holes: Vec::new() };
//! assert_eq!(plate.area(), 2.0);
//! assert!(plate.contains(Point::new(1.0, 0.5)));
//! assert_eq!(plate.nearest(Point::new(1.0, 3.0)).map(|on| on.point), Some(Point::new(1.0, 1.0)));
//!
//! let [a, b, c, d] = [plate.exterior[0], plate.exterior[2], plate.exterior[1], plate.exterior[3]];
//! assert!(segments_touch(a, b, c, d));
//! assert_eq!(find_crossing(&[&[a, b], &[c, d]], false), Some(Point::new(1.0, 0.5)));
//! ```

mod crossing;
mod narrow;
mod outlook;
mod point;
mod polyline;
mod predicate;
mod region;
mod ring;
mod rows;
mod segment;

pub use crossing::find_crossing;
pub use narrow::{NarrowKind, NarrowPlace, narrow_places};
pub use outlook::Outlook;
pub use point::{Matrix, Point, Vector, bounds};
pub use polyline::{polyline_length, simplified};
pub use predicate::{is_left_of, orientation, segments_touch};
pub use region::{Region, RingPlace};
pub use ring::{circle_ring, clean_ring, oriented, signed_area};
pub use rows::RingRows;
pub use segment::{distance_to_segment, nearest_on_segment, segment_distance};
