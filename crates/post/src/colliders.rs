//! The colliders as solids.

use crate::boolean::{material, twice_area};
use crate::error::PostError;
use crate::extrude::Extrusion;
use crate::mesh::{Content, Mesh, object_name};
use crate::options::PostOptions;
use crate::slot::Slot;
use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use crate::triangulate::{Division, triangulate};
use fissure_scene::{Collider, ColliderShape, Frame, Point, Pose, Scene, Vector};

/// Corners of the polygon that stands for a disc; off the circle by 0.03 % of the radius.
const DISC_CORNERS: usize = 128;
/// Length of the slab that stands for a half-plane, and its depth, in diagonals of the box around all bodies at rest.
const SLAB: (f64, f64) = (4.0, 0.25);

/// One solid per collider, in the order of the scene, checked.
pub(crate) fn collider_meshes(scene: &Scene, frame: &Frame, options: &PostOptions) -> Result<Vec<Mesh>, PostError> {
    let posed = scene.colliders.iter().zip(&frame.colliders).enumerate();
    posed.map(|(i, (collider, pose))| collider_mesh(scene, frame, i as u32, collider, *pose, options)).collect()
}

fn collider_mesh(
    scene: &Scene,
    frame: &Frame,
    index: u32,
    collider: &Collider,
    pose: Pose,
    options: &PostOptions,
) -> Result<Mesh, PostError> {
    let ring = ring(&collider.shape, pose, scene);
    let turn = nalgebra::Rotation2::new(pose.angle);
    let placed: Vec<Point> = ring.iter().map(|p| pose.position + turn * p.coords).collect();
    let (velocity, spin) = motion(collider, frame.time);
    let grid = Grid::covering(&placed, 0.0);
    let (low, high) = fissure_plane::bounds(&ring);
    grid.check(frame.number, &collider.name, (high - low).amax())?;
    let mut arc = 0.0;
    let mut sources = Vec::with_capacity(ring.len());
    for i in 0..ring.len() {
        let next = (i + 1) % ring.len();
        let carried = |j: usize, arc: f64| {
            let arm = placed[j] - pose.position;
            Carried { arc, ..Carried::within(ring[j], velocity + spin * Vector::new(-arm.y, arm.x)) }
        };
        let start = carried(i, arc);
        arc += (ring[next] - ring[i]).norm();
        let edge = [start, carried(next, arc)];
        sources.push(SourceEdge {
            a: grid.snap(placed[i]),
            b: grid.snap(placed[next]),
            carried: edge,
            slot: Slot::Outside,
        });
    }
    let shapes = material(&sources);
    let extrusion = Extrusion::plain(grid, &sources, options, (low, high));
    let area = 0.5 * shapes.iter().flatten().map(|c| twice_area(c)).sum::<i128>() as f64 * grid.step * grid.step;
    let content = Content::Solid { area, thickness: options.thickness, slack: 0.0 };
    let mut mesh = Mesh::new(object_name(&collider.name, "collider", index), index, content);
    mesh.texture_size = options.uv_in_metres.then_some(extrusion.texture_size);
    for shape in &shapes {
        let cap = triangulate(shape, Division::Plain);
        extrusion.solid(&cap, &extrusion.bevel(&cap), &[], &mut mesh);
    }
    let defect = |defect| PostError::Defect { frame: frame.number, mesh: mesh.name.clone(), defect };
    mesh.check().map_err(defect)?;
    Ok(mesh)
}

/// The outline of a collider in its own frame, counter-clockwise [m].
fn ring(shape: &ColliderShape, pose: Pose, scene: &Scene) -> Vec<Point> {
    match shape {
        ColliderShape::Polygon { ring } => ring.clone(),
        ColliderShape::Box { half_extents: h } => {
            vec![Point::new(-h.x, -h.y), Point::new(h.x, -h.y), Point::new(h.x, h.y), Point::new(-h.x, h.y)]
        }
        ColliderShape::Disc { radius } => (0..DISC_CORNERS)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / DISC_CORNERS as f64).sin_cos();
                Point::new(radius * cos, radius * sin)
            })
            .collect(),
        ColliderShape::HalfPlane { normal } => slab(*normal, pose, scene),
    }
}

/// A box below the surface of a half-plane, in its own frame, below the middle of the scene at rest.
fn slab(normal: Vector, pose: Pose, scene: &Scene) -> Vec<Point> {
    let corners: Vec<Point> = scene.bodies.iter().flat_map(|b| <[Point; 2]>::from(b.region.bounds())).collect();
    let (low, high) = fissure_plane::bounds(&corners);
    let diagonal = (high - low).norm();
    let tangent = Vector::new(normal.y, -normal.x);
    let middle = nalgebra::Rotation2::new(-pose.angle) * (nalgebra::center(&low, &high) - pose.position);
    let foot = tangent * middle.dot(&tangent);
    let (along, down) = (tangent * (0.5 * SLAB.0 * diagonal), normal * (-SLAB.1 * diagonal));
    // tangent × normal points towards the viewer, so this order is counter-clockwise.
    [foot - along + down, foot + along + down, foot + along, foot - along].map(Point::from).to_vec()
}

/// Velocity of the collider's origin [m/s] and its spin [rad/s] at `time`.
fn motion(collider: &Collider, time: f64) -> (Vector, f64) {
    let between = collider.keyframes.windows(2).find(|w| w[0].0 <= time && time < w[1].0);
    between.map_or((Vector::zeros(), 0.0), |w| {
        let duration = w[1].0 - w[0].0;
        ((w[1].1.position - w[0].1.position) / duration, (w[1].1.angle - w[0].1.angle) / duration)
    })
}
