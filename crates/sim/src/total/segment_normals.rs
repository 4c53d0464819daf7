//! The normals of the segments of cracks at one moment, and what they follow from, each worked out once: many places
//! lie on the same segment, and two segments share a point.

use super::motion::Motion;
use super::probes::{Probes, normal_across};
use fissure_plane::Vector;

/// The normals asked for so far, and at which moment.
#[derive(Debug, Default)]
pub(super) struct SegmentNormals {
    /// Where those of each crack begin.
    first: Vec<usize>,
    /// The moment, and what was found: see [`Probes::segment_normal`].
    found: Vec<(u64, Option<Vector>)>,
    /// The moment, and how far the faces have moved at a point: see [`Probes::mean_at`].
    means: Vec<(u64, Vector)>,
    moment: u64,
}

impl SegmentNormals {
    /// Another moment begins: nothing that was found counts any more.
    pub(super) fn begin(&mut self, probes: &Probes) {
        self.moment += 1;
        self.first.clear();
        let mut count = 0;
        for faces in &probes.faces {
            self.first.push(count);
            count += faces[0].len();
        }
        self.found.resize(count, (0, None));
        self.means.resize(count, (0, Vector::zeros()));
    }

    /// Normal of a segment of a crack now, from below to above; none where it has no length.
    pub(super) fn find(&mut self, (crack, segment): (u32, u32), probes: &Probes, motion: &Motion) -> Option<Vector> {
        let (first, crack, segment) = (self.first[crack as usize], crack as usize, segment as usize);
        if self.found[first + segment].0 != self.moment {
            let faces = &probes.faces[crack];
            let normal = match (faces[0].get(segment), faces[0].get(segment + 1)) {
                (Some(from), Some(to)) => {
                    let way = to.rest - from.rest;
                    let [from, to] = [segment, segment + 1].map(|k| {
                        let slot = &mut self.means[first + k];
                        if slot.0 != self.moment {
                            *slot = (self.moment, Probes::mean_at(faces, k, motion));
                        }
                        slot.1
                    });
                    normal_across(way + (to - from))
                }
                _ => None,
            };
            self.found[first + segment] = (self.moment, normal);
        }
        self.found[first + segment].1
    }
}
