//! What is written around a picture.

use crate::layout::Layout;
use crate::lettering::{self, Anchor};
use crate::options::PreviewOptions;
use crate::picture::{Picture, paint};
use crate::quantity::{quantity, round_below, short_quantity};
use crate::survey::Survey;
use fissure_scene::{Frame, Scene};
use tiny_skia::{PathBuilder, Rect, Stroke, Transform};

/// Width of the scale of colours, as a share of the picture.
const SCALE: f64 = 0.22;

/// The line above the scene: its name at the left, frame and time at the right.
pub(crate) fn header(picture: &mut Picture, scene: &Scene, frame: &Frame, layout: &Layout, options: &PreviewOptions) {
    let (size, ink) = (layout.letters, options.theme.ink());
    let (edge, line) = (0.9 * size, 1.5 * size);
    lettering::write(picture, &scene.name, size, [edge, line], Anchor::Left, ink);
    let right = f64::from(layout.width) - edge;
    lettering::write(picture, &moment(frame), size, [right, line], Anchor::Right, ink);
}

/// The line above a tile of a sheet.
pub(crate) fn caption(picture: &mut Picture, frame: &Frame, layout: &Layout, options: &PreviewOptions) {
    let size = layout.letters;
    lettering::write(picture, &moment(frame), size, [0.6 * size, 1.3 * size], Anchor::Left, options.theme.ink());
}

/// Frame and time.
fn moment(frame: &Frame) -> String {
    format!("frame {} · {}", frame.number, quantity(frame.time, "s"))
}

/// The line below the scene: the scale of lengths at the left, what colours mean at the right, and between them what
/// numbers at tips are, where there are some.
pub(crate) fn footer(
    picture: &mut Picture,
    survey: &Survey,
    layout: &Layout,
    options: &PreviewOptions,
    fragments: Option<usize>,
    has_tips: bool,
) {
    let (size, ink) = (layout.letters, options.theme.ink());
    let (edge, line) = (0.9 * size, f64::from(layout.height) - 1.1 * size);
    let end = scale_bar(picture, layout, options, [edge, line]);
    let right = f64::from(layout.width) - edge;
    let begin = match options.coloring.quantity() {
        Some((name, unit)) => color_scale(picture, survey, layout, options, (name, unit), [right, line]),
        None => {
            let text = fragments.map_or("colour: fragment".to_owned(), |count| match count {
                1 => "1 fragment".to_owned(),
                count => format!("{count} fragments"),
            });
            lettering::write(picture, &text, size, [right, line], Anchor::Right, ink);
            right - lettering::width(&text, size)
        }
    };
    let text = "at tips: KI in MPa√m";
    let room = begin - end - 3.0 * size;
    if has_tips && lettering::width(text, size) < room {
        lettering::write(picture, text, size, [end + 1.5 * size, line], Anchor::Left, options.theme.tip());
    }
}

/// A bar of a round length, which is written beside it; gives where it ends.
fn scale_bar(picture: &mut Picture, layout: &Layout, options: &PreviewOptions, [x, y]: [f64; 2]) -> f64 {
    let (size, ink) = (layout.letters, options.theme.ink());
    // Across the picture lengths in the drawing's x are shortened by the turn of the view.
    let scale = layout.projection.scale * options.view.yaw.cos();
    let length = round_below(0.16 * f64::from(layout.width) / scale);
    let (end, tick) = (x + length * scale, 0.35 * size);
    let mut path = PathBuilder::new();
    let middle = y - 0.3 * size;
    for [from, to] in [
        [[x, middle], [end, middle]],
        [[x, middle - tick], [x, middle + tick]],
        [[end, middle - tick], [end, middle + tick]],
    ] {
        path.move_to(from[0] as f32, from[1] as f32);
        path.line_to(to[0] as f32, to[1] as f32);
    }
    if let Some(path) = path.finish() {
        let stroke = Stroke { width: (0.12 * size) as f32, ..Stroke::default() };
        picture.pixels.stroke_path(&path, &paint(ink), &stroke, Transform::identity(), None);
    }
    let text = short_quantity(length, "m");
    lettering::write(picture, &text, size, [end + 0.6 * size, y], Anchor::Left, ink);
    end + 0.6 * size + lettering::width(&text, size)
}

/// The scale of colours with its ends, to the left of a place; gives where it begins.
fn color_scale(
    picture: &mut Picture,
    survey: &Survey,
    layout: &Layout,
    options: &PreviewOptions,
    (name, unit): (&str, &str),
    [right, y]: [f64; 2],
) -> f64 {
    let (size, ink) = (layout.letters, options.theme.ink());
    let [low, high] = survey.scale();
    let text = short_quantity(high, unit);
    lettering::write(picture, &text, size, [right, y], Anchor::Right, ink);
    let end = right - lettering::width(&text, size) - 0.5 * size;
    let begin = (end - SCALE * f64::from(layout.width)).round();
    let pixels = (end - begin).max(1.0);
    for column in 0..pixels as u32 {
        let x = begin + f64::from(column);
        let color = options.coloring.color((f64::from(column) + 0.5) / pixels);
        if let Some(bar) = Rect::from_xywh(x as f32, (y - 0.85 * size) as f32, 1.0, (0.95 * size) as f32) {
            picture.pixels.fill_rect(bar, &paint(color), Transform::identity(), None);
        }
    }
    let text = format!("{name}  {}", short_quantity(low, unit));
    let place = begin - 0.5 * size;
    lettering::write(picture, &text, size, [place, y], Anchor::Right, ink);
    place - lettering::width(&text, size)
}
