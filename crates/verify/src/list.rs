//! The list of cases.

use crate::case::Case;
use crate::cases;

/// All cases, in the order of the printed table.
pub const CASES: &[Case] = &[
    cases::edge_crack::CASE,
    cases::center_crack::CASE,
    cases::double_notch::CASE,
    cases::slanted_crack::CASE,
    cases::drawn_kinks::CASE,
    cases::closed_crack::CASE,
    cases::pressed_crack::CASE,
    cases::double_cantilever::CASE,
    cases::crack_pairs::CASE,
    cases::step_load::CASE,
    cases::moving_crack::CASE,
    cases::crack_motion::CASE,
    cases::strip::CASE,
    cases::impacted_notch::CASE,
    cases::branching_plate::CASE,
    cases::mirrored_branching::CASE,
    cases::pull_price::CASE,
    cases::turned_notch::CASE,
    cases::dropped_disc::CASE,
    cases::kink_angles::CASE,
    cases::shear_notch::CASE,
    cases::wing_cracks::CASE,
    cases::three_holes::CASE,
    cases::cantilever::CASE,
    cases::bar_wave::CASE,
    cases::bar_between_supports::CASE,
    cases::thick_ring::CASE,
    cases::spinning_disc::CASE,
    cases::ringing_plate::CASE,
    cases::free_flight::FLIGHT,
    cases::free_flight::TURNS,
    cases::cantilever_growth::CASE,
    cases::transfers::CASE,
    cases::two_discs::CASE,
    cases::hertz::CASE,
    cases::incline::CASE,
    cases::wedge::CASE,
];

/// The case of a name.
pub fn find(name: &str) -> Option<&'static Case> {
    CASES.iter().find(|c| c.name == name)
}
