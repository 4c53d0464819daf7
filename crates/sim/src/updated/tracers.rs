//! The rings of the bodies: how their vertices move with the material (thesis 3.1.7), and with the faces of cracks
//! where these mouth.

use super::faces::Faces;
use super::material_velocity::MaterialVelocity;
use super::tracer::Tracer;
use crate::crack::cracks::{Cracks, TipId};
use crate::threads::prelude::*;
use fissure_scene::{OutlineFrame, Vector};

impl Faces {
    /// Doubles the outline where a crack mouths at it: the two new vertices are the end points of the faces.
    pub(super) fn open_mouth(&mut self, cracks: &Cracks, id: TipId, cell_size: f64) {
        let place = cracks.position(id);
        let face = |face| Tracer { face: Some((id, face)), ..Tracer::at_rest(place) };
        self.outlines.open_mouth(place, id.end, [face(0), face(1)], cell_size);
    }

    /// Goes where the outlines of `frames` are: vertices are known by their rest positions, those at mouths by the
    /// crack faces they end.
    pub(super) fn set_outlines(&mut self, frames: &[OutlineFrame]) {
        for (ring, frame) in self.outlines.rings_mut().zip(frames) {
            for tracer in ring {
                if let Some((id, face)) = tracer.face {
                    (tracer.position, tracer.velocity) = self.cracks[id.crack].face_end(id.end, face);
                } else if let Some(k) = frame.rest.iter().position(|&p| p == tracer.rest) {
                    tracer.position = frame.position[k];
                    tracer.velocity = frame.velocity[k];
                }
            }
        }
    }

    /// Moves the vertices of outlines with the material they belong to.
    pub(super) fn advance_outlines(&mut self, material: &MaterialVelocity<'_>, time_step: f64) {
        // The ends of crack faces move with these; out of all material a vertex goes on as it went.
        let velocity = |t: &Tracer| match t.face {
            Some(_) => None,
            None => Some(material.at(t.position, t.position).unwrap_or(t.velocity)),
        };
        let of_ring = |ring: &[Tracer]| ring.par_iter().with_min_len(256).map(velocity).collect();
        let velocities: Vec<Vec<Option<Vector>>> = self.outlines.rings().map(of_ring).collect();
        for (t, velocity) in self.outlines.vertices_mut().zip(velocities.into_iter().flatten()) {
            if let Some(velocity) = velocity {
                t.velocity = velocity;
                t.position += velocity * time_step;
            }
        }
    }
}
