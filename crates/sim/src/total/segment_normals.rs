//! The normals of the segments of cracks at one moment, each worked out once: many places lie on the same.

use super::motion::Motion;
use super::probes::Probes;
use fissure_plane::Vector;

/// The normals asked for so far, and at which moment.
#[derive(Debug, Default)]
pub(super) struct SegmentNormals {
    /// Where those of each crack begin.
    first: Vec<usize>,
    /// The moment, and what was found: see [`Probes::segment_normal`].
    found: Vec<(u64, Option<Vector>)>,
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
    }

    /// Normal of a segment of a crack now, from below to above; none where it has no length.
    pub(super) fn find(&mut self, (crack, segment): (u32, u32), probes: &Probes, motion: &Motion) -> Option<Vector> {
        let slot = &mut self.found[self.first[crack as usize] + segment as usize];
        if slot.0 != self.moment {
            *slot = (self.moment, probes.segment_normal(crack, segment, motion));
        }
        slot.1
    }
}
