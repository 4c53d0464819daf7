//! Curves: what tips carry, what supports exert, and where the energy is.

use fissure_scene::{End, Frame, Scene, Support};
use serde::Serialize;
use std::collections::BTreeMap;

/// Curves, gathered frame by frame in order; finer ones where there are [tables](Series::take_up) of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Series {
    pub(super) energies: EnergySeries,
    /// By crack and end.
    #[serde(serialize_with = "values")]
    pub(super) tips: BTreeMap<(u32, End), TipSeries>,
    /// By support and axis.
    #[serde(serialize_with = "values")]
    pub(super) supports: BTreeMap<(usize, usize), SupportSeries>,
}

/// Energies per thickness [J/m] at times [s].
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct EnergySeries {
    pub(super) time: Vec<f64>,
    pub(super) kinetic: Vec<f64>,
    pub(super) strain: Vec<f64>,
    pub(super) external_work: Vec<f64>,
    pub(super) crack: Vec<f64>,
    /// Empty where it is not known.
    pub(super) damping: Vec<f64>,
    /// What is left of the budget; empty where it is not known.
    pub(super) rest: Vec<f64>,
}

/// What was measured at a tip while it was live.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct TipSeries {
    pub(super) name: String,
    /// [s].
    pub(super) time: Vec<f64>,
    /// Of the crack at rest [m].
    pub(super) length: Vec<f64>,
    /// K_I [Pa·√m].
    pub(super) mode_1: Vec<f64>,
    /// K_II [Pa·√m].
    pub(super) mode_2: Vec<f64>,
    /// K_Ic [Pa·√m].
    pub(super) fracture_toughness: Vec<f64>,
    /// J [J/m²].
    pub(super) j_integral: Vec<f64>,
    /// J by radius, the narrowest first; empty where it is not known.
    pub(super) contours: Vec<ContourSeries>,
}

/// J of a tip over one radius.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct ContourSeries {
    /// The radius in cells.
    pub(super) cells: f64,
    pub(super) time: Vec<f64>,
    /// Over the disc, with inertia [J/m²].
    pub(super) domain: Vec<f64>,
    /// Over the circle alone [J/m²].
    pub(super) contour: Vec<f64>,
}

/// Force of a support over the way along which it moves the material.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct SupportSeries {
    pub(super) name: String,
    /// [s].
    pub(super) time: Vec<f64>,
    /// [m].
    pub(super) displacement: Vec<f64>,
    /// [N/m].
    pub(super) force: Vec<f64>,
}

impl Series {
    /// Takes up the next frame.
    pub fn add(&mut self, scene: &Scene, frame: &Frame) {
        let time = short(frame.time);
        let energies = &mut self.energies;
        energies.time.push(time);
        energies.kinetic.push(short(frame.energies.kinetic));
        energies.strain.push(short(frame.energies.strain));
        energies.external_work.push(short(frame.energies.external_work));
        energies.crack.push(short(frame.energies.crack));
        for tip in frame.tips.iter().filter(|tip| tip.state.is_live()) {
            let series =
                self.tips.entry((tip.crack, tip.end)).or_insert_with(|| TipSeries::of(scene, tip.crack, tip.end));
            series.time.push(time);
            series.length.push(short(tip.length));
            series.mode_1.push(short(tip.mode_1));
            series.mode_2.push(short(tip.mode_2));
            series.fracture_toughness.push(short(tip.fracture_toughness));
            series.j_integral.push(short(tip.j_integral));
        }
        for (index, (support, record)) in scene.supports.iter().zip(&frame.supports).enumerate() {
            let way = support.displacement(frame.time);
            for axis in moved_axes(support) {
                let series = self.support(index, axis);
                series.time.push(time);
                series.displacement.push(short(way[axis]));
                series.force.push(short(record.force[axis]));
            }
        }
    }

    /// The curve of a support along an axis.
    pub(super) fn support(&mut self, index: usize, axis: usize) -> &mut SupportSeries {
        let name = || format!("support {index}, {}", ["x", "y"][axis]);
        self.supports.entry((index, axis)).or_insert_with(|| SupportSeries { name: name(), ..SupportSeries::default() })
    }
}

impl TipSeries {
    /// The empty curves of a tip.
    pub(super) fn of(scene: &Scene, crack: u32, end: End) -> Self {
        Self { name: name(scene, crack, end), ..Self::default() }
    }
}

/// The axes along which a support moves the material: there is no load over displacement of one that holds still.
pub(super) fn moved_axes(support: &Support) -> impl Iterator<Item = usize> + use<> {
    let velocity = support.velocity;
    (0..2).filter(move |&axis| velocity[axis].is_some_and(|v| v != 0.0))
}

/// Name of a tip: of the crack as in the scene, or its number if it was born later.
fn name(scene: &Scene, crack: u32, end: End) -> String {
    let end = if end == End::Start { "start" } else { "end" };
    let drawn = scene.cracks.get(crack as usize);
    drawn.map_or_else(|| format!("crack {crack}, {end}"), |drawn| format!("{}, {end}", drawn.name))
}

/// A number with five digits, which is more than a plot shows; nothing that JSON does not know.
pub(super) fn short(value: f64) -> f64 {
    let value: f64 = format!("{value:.4e}").parse().unwrap_or(0.0);
    if value.is_finite() { value } else { 0.0 }
}

fn values<K, V: Serialize, S: serde::Serializer>(curves: &BTreeMap<K, V>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(curves.values())
}
