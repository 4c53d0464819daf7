//! From a frame to meshes.

use crate::colliders::collider_meshes;
use crate::cracked::{Cracked, cracked_meshes, whole_meshes};
use crate::error::PostError;
use crate::faces::face_meshes;
use crate::formats::Shot;
use crate::mesh::Mesh;
use crate::options::PostOptions;
use crate::particles::particle_meshes;
use crate::provenance::Provenance;
use fissure_scene::{Frame, Part, Scene, UpAxis, Vector};
use std::collections::BTreeMap;

/// The meshes of one frame, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameMeshes {
    /// Where they come from.
    pub provenance: Provenance,
    /// Up axis of formats that do not fix it.
    pub up: UpAxis,
    /// Thickness of solids [m].
    pub thickness: f64,
    /// How wide edges between walls of cracks and caps are bevelled [m]; 0: not at all.
    pub bevel: f64,
    /// How far walls of cracks are moved to be rough, at most [m]; 0: not at all.
    pub roughness: f64,
    /// How far fragments are shown from where they are, by body and number [m]; those that are where they are left out.
    pub moves: BTreeMap<(u32, u32), Vector>,
    /// Meshes of each part that was asked for, in that order.
    pub parts: Vec<(Part, Vec<Mesh>)>,
}

impl FrameMeshes {
    /// Each part as it is written; `scene` and `frame` are what these meshes were made of.
    pub fn shots<'a>(&'a self, scene: &'a Scene, frame: &'a Frame) -> impl Iterator<Item = Shot<'a>> {
        let shot = move |(part, objects): &'a (Part, Vec<Mesh>)| Shot {
            part: *part,
            objects,
            provenance: &self.provenance,
            up: self.up,
            thickness: self.thickness,
            scene,
            frame,
        };
        self.parts.iter().map(shot)
    }
}

/// Makes the meshes of one frame, and checks that each solid is one. Deterministic; frames may be processed in any
/// order on any thread.
///
/// # Errors
/// See [`PostError`]; all name the frame.
pub fn post_frame(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<FrameMeshes, PostError> {
    options.check()?;
    let inconsistent = |fault| PostError::Inconsistent { frame: frame.number, fault };
    frame.check_within(scene.bodies.len()).map_err(inconsistent)?;
    let (mut parts, mut moved) = (Vec::with_capacity(options.parts.len()), BTreeMap::new());
    for &part in &options.parts {
        let meshes = match part {
            Part::Cracked => {
                let Cracked { meshes, moves } = cracked_meshes(scene, frame, options)?;
                moved = moves;
                meshes
            }
            Part::Body => whole_meshes(scene, frame, options)?,
            Part::Faces => face_meshes(scene, frame, options),
            Part::Collider => collider_meshes(scene, frame, options)?,
            Part::Particles => particle_meshes(scene, frame),
        };
        parts.push((part, meshes));
    }
    let PostOptions { up, thickness, bevel, .. } = *options;
    let roughness = options.roughness.map_or(0.0, |roughness| roughness.amplitude);
    Ok(FrameMeshes { provenance: Provenance::new(scene, frame), up, thickness, bevel, roughness, moves: moved, parts })
}
