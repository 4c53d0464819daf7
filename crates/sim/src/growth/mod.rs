//! When and where a crack grows, and how it ends.
//!
//! A tip begins to grow when K_eq in its direction reaches the toughness; K_I and K_II are scaled so that they agree
//! with J. In the total formulation it then slides through its increment as far as the energy it releases pays for, so
//! that its speed follows from the energy balance; in the updated formulation it jumps by whole increments. A limit
//! keeps it below a fraction of c_R. Direction: maximum hoop stress, a guide, or a blend of both; a guide with a
//! schedule also says when. Close to a ring or another crack nothing can be measured: a tip that slides goes straight
//! on through the last ligament and pays for it, one that jumps or comes from rest breaks it at once. Both end exactly
//! there.

mod advance;
mod barrier;
mod branching;
mod criterion;
mod heading;
mod increment;
mod load;
mod seeking;
mod speed;

pub(crate) use advance::Advance;
pub(crate) use barrier::is_free;
pub(crate) use branching::branches;
pub(crate) use heading::heading;
pub(crate) use increment::next_increment;
pub(crate) use load::{Cost, assess, cost, critical_release, toughness_ahead, toughness_everywhere, wants_to_grow};
pub(crate) use speed::speed_limit;
