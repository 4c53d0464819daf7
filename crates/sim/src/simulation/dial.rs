//! The other way round than an estimate: the particle spacing that is right enough, or fast enough.

use super::{Estimate, Simulation};
use crate::SimulationError;
use crate::foresight;
use crate::formulation;
use crate::material::elastic::Elastic;
use fissure_scene::{Scene, Wish};

/// Why a wish is not to be had.
#[derive(Debug, thiserror::Error)]
pub enum DialError {
    /// There is no K.
    #[error(
        "no tip waits for its K, so that there is none to be accurate: ask for a time instead, or for a particle spacing"
    )]
    NoTip,
    /// Nothing that was measured is as accurate.
    #[error(
        "K within {:.2} % is more than was ever measured to hold: ask for {:.2} % or more",
        100.0 * asked,
        100.0 * least
    )]
    TooAccurate {
        /// What was asked for [–].
        asked: f64,
        /// The least that there is [–].
        least: f64,
    },
    /// Even the coarsest particles that the bodies hold together with take longer.
    #[error(
        "{budget:.2} s are not enough: the coarsest particles take {least:.2} s; leave out frames, or shorten the time that is shown"
    )]
    TooShort {
        /// What was asked for [s].
        budget: f64,
        /// What the coarsest take [s].
        least: f64,
    },
    /// The scene cannot be simulated at all.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// Particles along the larger side of the box around all bodies: the fewest and the most that are tried.
const SIDE: [f64; 2] = [12.0, 8192.0];
/// Halvings of the range of spacings, in powers.
const HALVINGS: u32 = 40;
/// Guesses at the spacing for a time. It goes with about the third power of the resolution: three are enough.
const GUESSES: u32 = 12;
/// A guess is right when it comes so near to the time from below.
const NEAR_ENOUGH: f64 = 0.93;

impl Simulation {
    /// The particle spacing [m] at which `scene` is as `wish` says, cells being as many times larger as they are: the
    /// coarsest that is accurate enough, or the finest that is fast enough. `seconds`: what a run of an estimate takes
    /// in all [s].
    ///
    /// # Errors
    /// [`DialError`]
    pub fn spacing_for(
        scene: &Scene,
        wish: Wish,
        seconds: &dyn Fn(&Scene, &Estimate) -> f64,
    ) -> Result<f64, DialError> {
        let spacing = match wish {
            Wish::Accuracy(error) => accurate(scene, error)?,
            Wish::Budget(budget) => fast(scene, budget, seconds)?,
        };
        Ok(rounded_down(spacing))
    }
}

/// `scene` with particles `spacing` [m] apart.
fn at_spacing(scene: &Scene, spacing: f64) -> Scene {
    let cell_size = scene.cell_size * spacing / scene.particle_spacing;
    Scene { particle_spacing: spacing, cell_size, ..scene.clone() }
}

/// The finest and the coarsest spacing that are tried [m].
fn range(scene: &Scene) -> [f64; 2] {
    let corners: Vec<_> = scene.bodies.iter().flat_map(|body| body.region.exterior.iter().copied()).collect();
    let (low, high) = fissure_plane::bounds(&corners);
    let side = (high - low).amax();
    [side / SIDE[1], side / SIDE[0]]
}

fn accurate(scene: &Scene, asked: f64) -> Result<f64, DialError> {
    let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
    let formulation = formulation::choose(scene, &elastic).formulation;
    let error = |spacing: f64| {
        foresight::accuracy(&at_spacing(scene, spacing), &elastic, formulation).map(|accuracy| accuracy.error)
    };
    let [mut fine, mut coarse] = range(scene);
    let least = error(fine).ok_or(DialError::NoTip)?;
    if least > asked {
        return Err(DialError::TooAccurate { asked, least });
    }
    for _ in 0..HALVINGS {
        let middle = (fine * coarse).sqrt();
        if error(middle).is_some_and(|error| error <= asked) {
            fine = middle;
        } else {
            coarse = middle;
        }
    }
    Ok(fine)
}

fn fast(scene: &Scene, budget: f64, seconds: &dyn Fn(&Scene, &Estimate) -> f64) -> Result<f64, DialError> {
    let [finest, coarsest] = range(scene);
    let taken = |spacing: f64| {
        let scene = at_spacing(scene, spacing);
        Simulation::estimate(&scene).map(|estimate| seconds(&scene, &estimate))
    };
    // From the coarse side, where an estimate costs little: what is finer than the answer is hardly ever laid out.
    let mut spacing = coarsest;
    let mut first_error = None;
    let mut known: Option<(f64, f64)> = None;
    let mut too_fine = 0.0_f64;
    for _ in 0..GUESSES {
        match taken(spacing) {
            Ok(time) if time <= budget => {
                known = Some((spacing, time));
                if time > NEAR_ENOUGH * budget {
                    break;
                }
                // Half a per cent short of the time, so that it is met from below.
                let wanted = spacing * (time / (0.985 * budget)).cbrt().max(0.2);
                spacing = if wanted > too_fine { wanted } else { (spacing * too_fine).sqrt() };
            }
            Ok(time) => {
                too_fine = too_fine.max(spacing);
                match known {
                    Some((coarser, _)) => spacing = (spacing * coarser).sqrt(),
                    None => return Err(DialError::TooShort { budget, least: time }),
                }
            }
            // Too coarse for what is narrow, or too fine for the memory.
            Err(error) => match known {
                Some((coarser, _)) => {
                    too_fine = too_fine.max(spacing);
                    spacing = (spacing * coarser).sqrt();
                }
                None => {
                    first_error.get_or_insert(error);
                    spacing *= 0.7;
                }
            },
        }
        if spacing < finest {
            break;
        }
    }
    match (known, first_error) {
        (Some((spacing, _)), _) => Ok(spacing),
        (None, Some(error)) => Err(error.into()),
        (None, None) => Ok(coarsest),
    }
}

/// A spacing of three digits that is no larger.
fn rounded_down(spacing: f64) -> f64 {
    let unit = 10_f64.powf(spacing.log10().floor() - 2.0);
    let rounded: f64 = format!("{:.2e}", (spacing / unit).floor() * unit).parse().unwrap_or(spacing);
    if rounded > 0.0 { rounded } else { spacing }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use fissure_scene::{Formulation, Kernel};

    fn plate(side: f64) -> Scene {
        let mut scene = free_body(rectangle([0.0, 0.0], [side, side]), side / 64.0);
        (scene.solver.formulation, scene.solver.kernel) = (Formulation::Total, Kernel::Bilinear);
        add_crack(&mut scene, &[[0.0, 0.5 * side], [0.3 * side, 0.5 * side]]);
        scene.cracks[0].end_live = true;
        (scene.frames.last, scene.frames.rate) = (20, 20.0);
        scene
    }

    /// Truth: the estimates themselves. At the spacing that is chosen they say what was asked for, at a slightly larger
    /// or smaller one they no longer do.
    #[test]
    fn wishes_come_true_and_no_more() {
        for side in [1e-3, 1.0, 700.0] {
            let scene = plate(side);
            let seconds = |_: &Scene, estimate: &Estimate| estimate.seconds;
            for wanted in [0.015, 0.04, 0.1] {
                let spacing = Simulation::spacing_for(&scene, Wish::Accuracy(wanted), &seconds).unwrap();
                let error =
                    |by: f64| Simulation::estimate(&at_spacing(&scene, by * spacing)).unwrap().accuracy.unwrap().error;
                assert!(
                    error(1.0) <= wanted && error(1.03) > wanted,
                    "{side} {wanted}: {} {}",
                    error(1.0),
                    error(1.03)
                );
            }
            let least = Simulation::estimate(&at_spacing(&scene, side / 12.0)).unwrap().seconds;
            for budget in [least + 0.1, 5.0 * least + 2.0] {
                let spacing = Simulation::spacing_for(&scene, Wish::Budget(budget), &seconds).unwrap();
                let taken = Simulation::estimate(&at_spacing(&scene, spacing)).unwrap().seconds;
                assert!(taken < 1.05 * budget && taken > 0.7 * budget, "{side} {budget}: {taken}");
            }
        }
    }

    /// What is not to be had is told with what is.
    #[test]
    fn wishes_out_of_reach_are_told() {
        let mut scene = plate(1.0);
        let seconds = |_: &Scene, estimate: &Estimate| estimate.seconds;
        let wish = |scene: &Scene, wish| Simulation::spacing_for(scene, wish, &seconds);
        assert!(matches!(wish(&scene, Wish::Accuracy(1e-4)), Err(DialError::TooAccurate { .. })));
        assert!(matches!(wish(&scene, Wish::Budget(1e-6)), Err(DialError::TooShort { .. })));
        scene.cracks.clear();
        assert!(matches!(wish(&scene, Wish::Accuracy(0.02)), Err(DialError::NoTip)));
    }
}
