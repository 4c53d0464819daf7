//! A wedge that is driven into the mouth of a crack between two beams, wherever the mouth lies on the grid.
//!
//! Arms of 6 mm, crack of 25 mm, wedge of 6° to either side at 10 m/s, a material that does not break. Reference:
//! symmetry. Both arms are opened by the same, K_I > 0 and K_II = 0. The crack lies at 5 heights within a cell: on a
//! row of nodes and midway both arms have the same particles; elsewhere one has up to a quarter of a cell more than the
//! other, which with 6 cells makes 13 % of its stiffness. Cells are counted through one arm.

use crate::case::{Case, Options};
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{BoxSide, Collider, ColliderShape, Contact, PlaneState, Point, Pose, Selection, Vector};
use fissure_sim::SimulationError;

pub(crate) const CASE: Case =
    Case::new("wedge", "modes of a crack that a wedge opens", ("through one arm", 6.0), compute);

const ARM: f64 = 0.006;
const LENGTH: f64 = 0.1;
/// [s]; the wedge has gone in by 9 mm.
const TIME: f64 = 0.001;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = ARM / options.cells_or(CASE.cells.1);
    for height in [0.0, 0.13, 0.25, 0.5, 0.8] {
        let of = format!("mouth at {height} cells");
        tally.say(&of);
        let y = height * cell_size;
        // [%]. What lies elsewhere on the grid has its mouth at other heights.
        let is_even = tally.is_natural() && (2.0 * height).fract() == 0.0;
        let uneven = if is_even { 1e-6 } else { 15.0 };
        // The grid is counted from the lower edge, which does not move with the crack.
        let body = rectangle((0.0, -ARM), (LENGTH, (2.0 * height * cell_size) + ARM));
        let ring = [[0.0, 0.0], [0.014, -0.0015], [0.03, -0.0015], [0.03, 0.0015], [0.014, 0.0015]];
        let pose = |x: f64| Pose { position: Point::new(x, y), angle: 0.0 };
        let mut problem =
            Problem::new("wedge", body, material(2.3e9, 0.33, 1500.0, 1e30), PlaneState::Strain, cell_size)
                .crack(&[(LENGTH, y), (0.75 * LENGTH, y)], [false, true])
                .support(Selection::Edge { side: BoxSide::Left, bodies: None }, [Some(0.0); 2])
                .until(TIME, 4);
        problem.scene.colliders.push(Collider {
            name: "wedge".into(),
            shape: ColliderShape::Polygon { ring: ring.map(Point::from).to_vec() },
            keyframes: vec![(0.0, pose(LENGTH + 0.001)), (TIME, pose(LENGTH - 0.009))],
            contact: Contact::Separate,
            friction: 0.0,
        });
        let mut placed = tally.set_up(&problem)?;
        tally.run_frames(&mut placed, |_| ())?;
        let frame = placed.now().frame();
        let (tip, crack) = (&frame.tips[0], &frame.cracks[0]);
        // From the line of the crack, at the mouth.
        let moved = [&crack.above, &crack.below].map(|face| (face[0] - crack.rest[0]).dot(&Vector::y()));
        let opened = moved.map(f64::abs);
        let parted = moved[0] * moved[1] < 0.0;
        let difference = 100.0 * (opened[0] - opened[1]).abs() / opened[0].max(opened[1]);
        let difference = if parted { difference } else { f64::INFINITY };
        tally.bound(format!("difference of the arms, {of}"), "%", difference, Expected::AtMost(uneven));
        tally.bound(format!("K_I, {of}"), "Pa√m", tip.mode_1, Expected::AtLeast(1e5));
        let mode_2 = 100.0 * (tip.mode_2 / tip.mode_1).abs();
        tally.bound(format!("|K_II|/K_I, {of}"), "%", mode_2, Expected::AtMost(uneven));
    }
    Ok(())
}
