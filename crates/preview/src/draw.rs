//! A frame as a picture.

use crate::cap_field::CapField;
use crate::layout::Layout;
use crate::options::PreviewOptions;
use crate::picture::{EncodeError, Picture, paint};
use crate::projection::Projection;
use crate::raster::Raster;
use crate::rims::rims;
use crate::survey::Survey;
use crate::{crack_lines, inclusions, legend, tip_marks};
use fissure_post::{FrameMeshes, Mesh, Slot};
use fissure_scene::{Curve, Frame, HeldParticles, Part, ParticleFrame, Scene};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use tiny_skia::{LineCap, LineJoin, PathBuilder, Stroke, Transform};

/// Pixels of the raster for one of the picture, each way.
const SAMPLES: usize = 2;
/// Where light comes from, seen from the eye: right, up, towards it.
const LIGHT: [f64; 3] = [-0.3, 0.5, 1.0];
/// Share of the light that comes from everywhere.
const AMBIENT: f64 = 0.45;
/// A triangle whose normal leans away from the front by less than this share lies in a front face.
const FRONT: f64 = 0.999;

/// How much goes into a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// All of it.
    Full,
    /// Frame and time only, for a small picture among others.
    Tile,
}

/// Draws a frame. `meshes` are those that are made of it, of the parts [`Part::Cracked`] and [`Part::Collider`].
/// All pictures of one survey, one thickness, one set of options and one detail have one size.
///
/// # Errors
/// When there is no memory for so many pixels.
pub fn draw_frame(
    scene: &Scene,
    frame: &Frame,
    meshes: &FrameMeshes,
    survey: &Survey,
    options: &PreviewOptions,
    detail: Detail,
) -> Result<Picture, EncodeError> {
    let thickness = scene.output.thickness;
    let layout = Layout::new(survey, thickness, options, detail);
    let solids: Vec<&Mesh> = of_part(meshes, Part::Cracked).collect();
    let colliders: Vec<&Mesh> = of_part(meshes, Part::Collider).collect();
    let field = CapField::new(frame, scene.particle_spacing, options.coloring, survey.scale());
    let field = field.filter(|_| is_in_place(scene, frame));
    let mut picture = surfaces(&solids, &colliders, field.as_ref(), &layout, options)?;
    let z = 0.5 * thickness;
    lines(&mut picture, scene, frame, meshes, &layout, options, z);
    let cover = |picture: &mut Picture, from: f64, to: f64| {
        let strip = tiny_skia::Rect::from_ltrb(0.0, from as f32, layout.width as f32, to as f32);
        if let Some(strip) = strip {
            picture.pixels.fill_rect(strip, &paint(options.theme.background()), Transform::identity(), None);
        }
    };
    cover(&mut picture, 0.0, layout.header);
    match detail {
        Detail::Full => {
            cover(&mut picture, f64::from(layout.height) - layout.footer, f64::from(layout.height));
            let has_tips = tip_marks::are_labelled(&frame.tips);
            if is_in_place(scene, frame) {
                tip_marks::draw(&mut picture, &frame.tips, z, &layout, options.theme);
            } else {
                let tips = tip_marks::moved(frame, &meshes.moves);
                tip_marks::draw(&mut picture, &tips, z, &layout, options.theme);
            }
            legend::header(&mut picture, scene, frame, &layout, options);
            legend::footer(&mut picture, survey, &layout, options, Some(solids.len()), has_tips);
        }
        Detail::Tile => legend::caption(&mut picture, frame, &layout, options),
    }
    Ok(picture)
}

fn of_part(meshes: &FrameMeshes, part: Part) -> impl Iterator<Item = &Mesh> {
    meshes.parts.iter().filter(move |(known, _)| *known == part).flat_map(|(_, meshes)| meshes)
}

/// Whether the meshes lie where the material is, so that what the frame tells can be drawn over them: fragments only
/// are moved away from the middle of their body.
fn is_in_place(scene: &Scene, frame: &Frame) -> bool {
    let is_still = |curve: &Curve| curve.value(frame.time) == 0.0;
    scene.output.explode.as_ref().is_none_or(is_still) || are_whole(&frame.particles)
}

/// Whether no body has two fragments with a particle in them.
fn are_whole(particles: &ParticleFrame) -> bool {
    let mut pieces = BTreeMap::new();
    let mut is_first = |(body, piece): (&u32, &u32)| pieces.entry(*body).or_insert(*piece) == piece;
    particles.body.iter().zip(&particles.piece).all(&mut is_first)
}

/// Solids and colliders, lit.
fn surfaces(
    solids: &[&Mesh],
    colliders: &[&Mesh],
    field: Option<&CapField>,
    layout: &Layout,
    options: &PreviewOptions,
) -> Result<Picture, EncodeError> {
    let theme = options.theme;
    let (width, height) = (SAMPLES * layout.width as usize, SAMPLES * layout.height as usize);
    let mut raster = Raster::new(width, height, theme.background());
    let projection = layout.projection.enlarged(SAMPLES as f64);
    for mesh in colliders {
        fill(&mut raster, mesh, [theme.collider(); 2], None, &projection);
    }
    for mesh in solids {
        // Colours that measure something stand out from grey walls.
        let outside = if field.is_some() { theme.collider() } else { theme.fragment(mesh.piece) };
        fill(&mut raster, mesh, [outside, theme.wall()], field, &projection);
    }
    Picture::reduced(&raster, SAMPLES)
}

/// Fills the triangles of a mesh that face the eye, each slot in its colour, front faces in that of `field`.
fn fill(raster: &mut Raster, mesh: &Mesh, colors: [[u8; 3]; 2], field: Option<&CapField>, projection: &Projection) {
    let light = Vector3::from(LIGHT).normalize();
    for slot in Slot::ALL {
        let color = colors[slot as usize];
        for triangle in mesh.slot(slot) {
            let corners = triangle.map(|i| mesh.vertices[i as usize].position);
            let [a, b, c] = corners.map(Vector3::from);
            let normal = (b - a).cross(&(c - a)).normalize();
            let seen = projection.axes.direction(normal);
            // The others turn away; solids are closed.
            let is_seen = seen.z > 0.0;
            if !is_seen {
                continue;
            }
            let brightness = AMBIENT + (1.0 - AMBIENT) * seen.dot(&light).max(0.0);
            let shaded = |color: [u8; 3]| color.map(|channel| (f64::from(channel) * brightness).round() as u8);
            let plain = shaded(color);
            let pixels = corners.map(|corner| projection.pixel(corner));
            match field.filter(|_| normal.z > FRONT) {
                Some(field) => raster.fill(pixels, |pixel| field.color(projection.plane(pixel, a.z)).unwrap_or(plain)),
                None => raster.fill(pixels, |_| plain),
            }
        }
    }
}

/// Edges of front faces, closed cracks and inclusions, over the surfaces.
fn lines(
    picture: &mut Picture,
    scene: &Scene,
    frame: &Frame,
    meshes: &FrameMeshes,
    layout: &Layout,
    options: &PreviewOptions,
    z: f64,
) {
    let (projection, theme) = (&layout.projection, options.theme);
    let (mut outer, mut cracks) = (PathBuilder::new(), PathBuilder::new());
    for rim in of_part(meshes, Part::Cracked).flat_map(rims) {
        let path = if rim.slot == Slot::Inside { &mut cracks } else { &mut outer };
        let [[x, y, _], [to_x, to_y, _]] = rim.ends.map(|end| projection.pixel(end));
        path.move_to(x as f32, y as f32);
        path.line_to(to_x as f32, to_y as f32);
    }
    let mut inclusions = None;
    if is_in_place(scene, frame) {
        frame.cracks.iter().for_each(|crack| crack_lines::add(&mut cracks, crack, z, projection));
        // They are moved by the particles beside them.
        if scene.take.particles == HeldParticles::Full {
            inclusions = inclusions::edges(scene, frame, z, projection);
        }
    } else {
        crack_lines::add_moved(&mut cracks, frame, &meshes.moves, z, projection);
    }
    let width = (0.09 * layout.letters) as f32;
    let drawn = [(outer.finish(), theme.edge()), (inclusions, theme.inclusion()), (cracks.finish(), theme.crack())];
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    for (path, color) in drawn {
        if let Some(path) = path {
            picture.pixels.stroke_path(&path, &paint(color), &stroke, Transform::identity(), None);
        }
    }
}
