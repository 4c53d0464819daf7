//! A page to turn a run about: one file that needs no network.

mod packed_frame;
mod series;
mod table_series;

pub use packed_frame::PackedFrame;
pub use series::Series;
pub use table_series::{Table, TableError};

use crate::origin::TOOL;
use crate::theme::Theme;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fissure_scene::Scene;
use serde::Serialize;

/// Bytes of meshes on a page at most, before they become text: what a browser opens in seconds.
const MESH_BYTES: usize = 24_000_000;

const HTML: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const THREE: &str = include_str!("../../../../assets/three/three.bundle.min.js");

/// A page as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// The bytes of the HTML file.
    pub html: String,
    /// Frames with meshes on it.
    pub shown: usize,
    /// Frames there are; some are left out where all would be too much for a browser.
    pub of: usize,
}

/// What the page is told besides the meshes.
#[derive(Serialize)]
struct Facts<'a> {
    name: &'a str,
    scene_hash: &'a str,
    tool: &'a str,
    dark: bool,
    /// Frames per second at which it is played.
    playback: f64,
    /// How far a vertex may be from where it is [m].
    rounding: f64,
    frames: Vec<FrameFacts>,
    all_frames: usize,
    series: &'a Series,
}

/// What the page is told of a frame.
#[derive(Serialize)]
struct FrameFacts {
    number: i64,
    time: f64,
    triangles: usize,
}

/// Makes the page of the frames of a run, in order; of every second, third or further frame if the meshes of all would
/// take more than 24 MB. The first and the last are always there, and the curves are those of all frames.
///
/// # Errors
/// When the numbers cannot be written as JSON.
pub fn page(scene: &Scene, frames: &[PackedFrame], series: &Series, theme: Theme) -> Result<Page, serde_json::Error> {
    let shown = thinned(frames);
    let facts = Facts {
        name: &scene.name,
        scene_hash: &scene.hash,
        tool: TOOL,
        dark: theme == Theme::Dark,
        playback: scene.frames.playback,
        rounding: shown.iter().map(|frame| frame.rounding).fold(0.0, f64::max),
        frames: shown.iter().map(|f| FrameFacts { number: f.number, time: f.time, triangles: f.triangles }).collect(),
        all_frames: frames.len(),
        series,
    };
    let meshes: Vec<String> = shown.iter().map(|frame| STANDARD.encode(&frame.bytes)).collect();
    let parts = [
        ("{{name}}", escaped(&scene.name)),
        ("{{tool}}", TOOL.to_owned()),
        ("{{style}}", STYLE.to_owned()),
        ("{{three}}", THREE.to_owned()),
        ("{{facts}}", json(&facts)?),
        ("{{meshes}}", json(&meshes)?),
        ("{{script}}", SCRIPT.to_owned()),
    ];
    Ok(Page { html: filled(HTML, &parts), shown: shown.len(), of: frames.len() })
}

/// The frames that fit: every n-th and the last.
fn thinned(frames: &[PackedFrame]) -> Vec<&PackedFrame> {
    let bytes: usize = frames.iter().map(|frame| frame.bytes.len()).sum();
    let stride = bytes.div_ceil(MESH_BYTES).max(1);
    let last = frames.len().saturating_sub(1);
    frames.iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last).map(|(_, frame)| frame).collect()
}

/// JSON that can stand in a script of a page: nothing in it ends that.
fn json(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

/// Text that can stand between the tags of a page.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The page with its parts in their places, in the order in which they come; what a part holds is left as it is.
fn filled(html: &str, parts: &[(&str, String)]) -> String {
    let (mut text, mut rest) = (String::new(), html);
    while let Some((at, (mark, part))) =
        parts.iter().filter_map(|part| Some((rest.find(part.0)?, part))).min_by_key(|(at, _)| *at)
    {
        text += &rest[..at];
        text += part;
        rest = &rest[at + mark.len()..];
    }
    text + rest
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn frame(number: i64, bytes: usize) -> PackedFrame {
        PackedFrame { number, time: 0.0, triangles: 0, rounding: 0.0, bytes: vec![0; bytes] }
    }

    #[test]
    fn what_is_too_much_for_a_browser_is_thinned_and_keeps_its_ends() {
        let few: Vec<PackedFrame> = (1..=40).map(|number| frame(number, 500_000)).collect();
        assert_eq!(thinned(&few).len(), 40);
        let many: Vec<PackedFrame> = (1..=100).map(|number| frame(number, 700_000)).collect();
        let shown = thinned(&many);
        assert!(shown.iter().map(|frame| frame.bytes.len()).sum::<usize>() < MESH_BYTES + 700_000);
        assert_eq!((shown[0].number, shown[1].number, shown[shown.len() - 1].number), (1, 4, 100));
        assert!(thinned(&[]).is_empty());
    }

    #[test]
    fn names_cannot_break_out_of_the_page() {
        let evil = "</script><script>alert(1)</script>{{three}}";
        assert!(!json(&evil).unwrap().contains('<') && !escaped(evil).contains('<'));
        let parts = [("{{a}}", "1{{b}}".to_owned()), ("{{b}}", "2".to_owned())];
        assert_eq!(filled("x{{a}}y{{b}}z{{c}}", &parts), "x1{{b}}y2z{{c}}");
    }
}
