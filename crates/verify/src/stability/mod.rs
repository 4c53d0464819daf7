//! Where the method fails: maps of two parameters, each cell one small run.
//!
//! A cell is an error, or a part of an energy, or the message with which the solver has stopped. Maps go to both sides
//! of what works.

mod impacts;
mod neighbours;
mod plates;
mod step_limits;
mod time_steps;
mod toughness_jumps;
mod transfers;

use fissure_sim::SimulationError;

/// A parameter of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// What it is, with its unit.
    pub label: &'static str,
    /// Its values, in the order of the map.
    pub values: &'static [f64],
    /// What they are called; empty: numbers.
    pub words: &'static [&'static str],
}

/// A map of two parameters.
#[derive(Debug, Clone, Copy)]
pub struct StabilityMap {
    /// Short name, as in tables.
    pub name: &'static str,
    /// What is shown.
    pub title: &'static str,
    /// What goes along.
    pub across: Parameter,
    /// What goes upwards.
    pub up: Parameter,
    /// Values [–] from which on the next colour holds; rising.
    pub limits: [f64; 6],
    run: fn(f64, f64) -> Result<f64, SimulationError>,
}

/// All maps.
pub const STABILITY_MAPS: [StabilityMap; 16] = [
    plates::CRACK_LENGTH,
    plates::LIGAMENT,
    plates::TURN,
    plates::POISSON_RATIO,
    plates::PARTICLES_PER_CELL,
    plates::LENGTHS,
    neighbours::NEAR_THINGS,
    neighbours::PRESSED,
    toughness_jumps::TOUGHNESS_JUMPS,
    time_steps::TOTAL,
    time_steps::UPDATED,
    step_limits::REAL_LIMIT,
    step_limits::MANY_STEPS,
    transfers::RINGING,
    transfers::STRETCHED,
    impacts::IMPACTS,
];

/// Colours of maps of errors, as parts of one: blue below 1 %, red from 20 % on.
const ERRORS: [f64; 6] = [0.005, 0.01, 0.02, 0.05, 0.1, 0.2];

impl StabilityMap {
    /// The value [–] at one place of the map.
    ///
    /// # Errors
    /// When the solver stops: that is what the map shows there.
    pub fn value(&self, across: f64, up: f64) -> Result<f64, SimulationError> {
        (self.run)(across, up)
    }
}

impl Parameter {
    const fn numbers(label: &'static str, values: &'static [f64]) -> Self {
        Self { label, values, words: &[] }
    }

    /// Values 0, 1, 2 ... with names.
    const fn choices(label: &'static str, words: &'static [&'static str]) -> Self {
        const COUNT: [f64; 6] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        Self { label, values: COUNT.split_at(words.len()).0, words }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(name: &str) -> StabilityMap {
        STABILITY_MAPS.into_iter().find(|map| map.name == name).unwrap_or(STABILITY_MAPS[0])
    }

    /// Truth: Tada's formula. Bounds are what was measured, with a margin; what is said to fail fails.
    #[test]
    fn maps_show_what_is_said_of_them() {
        for (name, across, up, low, high) in [
            ("crack-length", 4.0, 0.25, 0.0, 0.012),
            ("crack-length", 2.0, 0.25, 0.02, 0.2),
            ("ligament", 10.0, 0.5, 0.0, 0.01),
            ("ligament", 2.0, 0.5, 0.05, 0.25),
            ("turn", 30.0, 8.0, 0.0, 0.015),
            ("poisson-ratio", 0.45, 1.0, 0.0, 0.02),
            ("poisson-ratio", 0.499, 1.0, 0.1, 0.4),
            ("poisson-ratio", 0.4999, 0.0, 0.0, 0.01),
            ("particles", 1.0, 1.0, 0.03, 0.15),
            ("particles", 3.0, 1.0, 0.0, 0.015),
            ("time-step-total", 0.99, 2.0, 0.0, 0.015),
            ("time-step-updated", 0.99, 2.0, 0.0, 0.04),
            ("impacts", 0.3, 2.0, 0.0, 0.06),
            ("near-things", 3.0, 0.0, 0.0, 0.01),
            ("near-things", 1.0, 0.0, 0.1, 0.5),
            ("near-things", 4.0, 4.0, 0.0, 0.015),
            ("near-things", 5.0, 5.0, 0.0, 0.02),
            ("near-things", 2.0, 5.0, 0.05, 0.3),
            ("pressed", 0.3, 3.0, 0.0, 0.035),
            ("toughness-jump", 1.05, 50.0, 0.0, 0.1),
            ("toughness-jump", 1.6, 40.0, 0.0, 0.1),
            ("toughness-jump", 1.4, 60.0, 0.0, 0.1),
            ("toughness-jump", 2.0, 60.0, 0.0, 0.1),
            ("toughness-jump", 2.0, 90.0, 0.0, 0.1),
            ("toughness-jump", 3.0, 90.0, 0.0, 0.1),
            ("toughness-jump", 1.3, 40.0, 0.8, 1.5),
            ("real-limit", 2.0, 1.0, 0.0, 0.05),
            ("ringing", 2.0, 2.0, 0.0, 0.06),
            ("ringing", 3.0, 2.0, 0.06, 0.3),
            ("stretched", 1.25, 2.0, 0.0, 0.05),
            ("stretched", 2.0, 3.0, 0.0, 0.02),
            ("many-steps", 1e4, 0.0, 0.0, 1e-3),
        ] {
            let found = map(name).value(across, up).unwrap_or(f64::NAN);
            assert!((low..=high).contains(&found), "{name} at {across}, {up}: {found}");
        }
    }

    /// Truth: similarity. Lengths alone change nothing, to rounding.
    #[test]
    fn lengths_do_not_matter() {
        let errors = [1e-6, 1.0, 1e6].map(|length| map("lengths").value(length, 4.0).unwrap_or(f64::NAN));
        assert!(errors.iter().all(|error| (error - errors[1]).abs() < 1e-9), "{errors:?}");
    }

    /// What is beyond the limit is refused by name, and what leaves the range of a formulation too.
    #[test]
    fn what_fails_says_so() {
        for (name, across, up) in [("time-step-total", 1.01, 0.0), ("time-step-updated", 1.01, 0.0)] {
            let found = map(name).value(across, up);
            assert!(matches!(found, Err(SimulationError::TimeStepTooLarge { .. })), "{name}: {found:?}");
        }
        let found = map("impacts").value(1.22, 2.0);
        assert!(matches!(found, Err(SimulationError::OutOfRange { .. })), "{found:?}");
    }
}
