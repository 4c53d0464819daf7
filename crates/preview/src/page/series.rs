//! Curves over time: what tips carry, and where the energy is.

use fissure_scene::{End, Frame, Scene};
use serde::Serialize;
use std::collections::BTreeMap;

/// Curves over time, gathered frame by frame in order.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Series {
    /// Times [s].
    time: Vec<f64>,
    energies: EnergySeries,
    /// By crack and end.
    #[serde(serialize_with = "values")]
    tips: BTreeMap<(u32, End), TipSeries>,
}

/// Energies per thickness [J/m].
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct EnergySeries {
    kinetic: Vec<f64>,
    strain: Vec<f64>,
    external_work: Vec<f64>,
    crack: Vec<f64>,
}

/// What was measured at a tip while it was live.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct TipSeries {
    name: String,
    /// Numbers in the list of times.
    at: Vec<usize>,
    /// K_I [Pa·√m].
    mode_1: Vec<f64>,
    /// K_II [Pa·√m].
    mode_2: Vec<f64>,
    /// K_Ic [Pa·√m].
    fracture_toughness: Vec<f64>,
    /// J [J/m²].
    j_integral: Vec<f64>,
}

impl Series {
    /// Takes up the next frame.
    pub fn add(&mut self, scene: &Scene, frame: &Frame) {
        let at = self.time.len();
        self.time.push(short(frame.time));
        let energies = &mut self.energies;
        energies.kinetic.push(short(frame.energies.kinetic));
        energies.strain.push(short(frame.energies.strain));
        energies.external_work.push(short(frame.energies.external_work));
        energies.crack.push(short(frame.energies.crack));
        for tip in frame.tips.iter().filter(|tip| tip.state.is_live()) {
            let series = self
                .tips
                .entry((tip.crack, tip.end))
                .or_insert_with(|| TipSeries { name: name(scene, tip.crack, tip.end), ..TipSeries::default() });
            series.at.push(at);
            series.mode_1.push(short(tip.mode_1));
            series.mode_2.push(short(tip.mode_2));
            series.fracture_toughness.push(short(tip.fracture_toughness));
            series.j_integral.push(short(tip.j_integral));
        }
    }
}

/// Name of a tip: of the crack as in the scene, or its number if it was born later.
fn name(scene: &Scene, crack: u32, end: End) -> String {
    let end = if end == End::Start { "start" } else { "end" };
    let drawn = scene.cracks.get(crack as usize);
    drawn.map_or_else(|| format!("crack {crack}, {end}"), |drawn| format!("{}, {end}", drawn.name))
}

/// A number with five digits, which is more than a plot shows; nothing that JSON does not know.
fn short(value: f64) -> f64 {
    let value: f64 = format!("{value:.4e}").parse().unwrap_or(0.0);
    if value.is_finite() { value } else { 0.0 }
}

fn values<S: serde::Serializer>(tips: &BTreeMap<(u32, End), TipSeries>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(tips.values())
}
