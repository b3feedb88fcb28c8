//! Grids: the cell of the working area that a robot occupies, as one number on digital outputs.

use std::f64::consts::TAU;
use std::ops::Range;

use elbowroom_spatial::Pose;

/// By how much a range may be longer than a turn, rad.
const ROUNDING: f64 = 1e-9;
/// Digital outputs of a robot.
const CHANNELS: u8 = 64;

/// A division of the working area into numbered cells. The number of the cell that holds the robot's tool centre point, or
/// its joint values, is on digital outputs as a binary number, lowest bit first; 0 is outside of the grid (Romanelli 2011,
/// section 2.2.2: "a quantization of the working area").
///
/// Cells are counted from 1 along the first axis, then along the second one, and so on: cell `1 + i + n₀·(j + n₁·k)` for the
/// places i, j, k on axes with n₀, n₁, n₂ divisions. A grid informs; it holds back no robot.
///
/// ```
/// use elbowroom_monitor::{OutputGrid, OutputGridAxis, GridSpace};
/// use elbowroom_spatial::Pose;
/// let axis = |to: f64, count: u32| OutputGridAxis { from: 0.0, to, count };
/// let grid = OutputGrid {
///     name: "area".into(),
///     space: GridSpace::Tcp { frame_in_world: Pose::IDENTITY },
///     axes: vec![axis(2.0, 4), axis(1.0, 2)],
///     output: 8,
///     hysteresis: 0.001,
/// };
/// assert_eq!(grid.cell_at(&[0.6, 0.7], 0), 1 + 1 + 4 * 1);
/// assert_eq!(grid.channels(), 8..12); // numbers up to 8 take four bits
/// assert_eq!(grid.number_in(6 << 8 | 1), 6);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OutputGrid {
    /// Name, unique among the grids of a robot.
    pub name: String,
    /// What is divided.
    pub space: GridSpace,
    /// The axes in the order of the coordinates: up to three of a point, or one per joint.
    pub axes: Vec<OutputGridAxis>,
    /// The digital output with the lowest bit.
    pub output: u8,
    /// How far beyond its border a cell is left (m or rad); at most half of a cell.
    pub hysteresis: f64,
}

/// What an [`OutputGrid`] divides.
#[derive(Debug, Clone, PartialEq)]
pub enum GridSpace {
    /// The coordinates (m) of the tool centre point in this frame. Axes that the grid does not have are not divided, and
    /// have no ends.
    Tcp {
        /// The frame in the world.
        frame_in_world: Pose,
    },
    /// The values (rad or m) of these independent joints, as indices into `q`. Values of a joint that turns without end
    /// count modulo a turn.
    Joints(Vec<usize>),
}

/// One axis of an [`OutputGrid`]: a range in equal divisions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputGridAxis {
    /// The low end, m or rad.
    pub from: f64,
    /// The high end, m or rad.
    pub to: f64,
    /// Divisions.
    pub count: u32,
}

/// A coordinate on an axis of a grid.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Coordinate {
    /// m or rad.
    pub(crate) at: f64,
    /// A turn, rad, if values that differ by turns are the same; else 0.
    pub(crate) turn: f64,
}

impl OutputGridAxis {
    /// Length of a division, m or rad.
    pub fn step(&self) -> f64 {
        (self.to - self.from) / f64::from(self.count)
    }

    /// The division of a coordinate: the former one as long as the coordinate is at most the hysteresis beyond it.
    fn place(&self, Coordinate { at, turn }: Coordinate, former: Option<u32>, hysteresis: f64) -> Option<u32> {
        let border = |place: u32| self.from + f64::from(place) * self.step();
        let holds = |place: u32, at: f64| at >= border(place) - hysteresis && at <= border(place + 1) + hysteresis;
        let at = if turn > 0.0 { self.from + (at - self.from).rem_euclid(turn) } else { at };
        let stays = |place: &u32| [at, at - turn, at + turn].iter().any(|at| holds(*place, *at));
        if let Some(place) = former.filter(stays) {
            return Some(place);
        }
        let is_within = at >= self.from && at <= self.to;
        is_within.then(|| (((at - self.from) / self.step()) as u32).min(self.count.saturating_sub(1)))
    }
}

impl OutputGrid {
    /// Most cells of a grid.
    pub const MAX_CELLS: u64 = 65_535;

    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.axes.iter().fold(1, |cells, axis| u64::from(axis.count).saturating_mul(cells))
    }

    /// The digital outputs of the number.
    pub fn channels(&self) -> Range<u8> {
        let bits = u64::BITS - self.cells().leading_zeros();
        self.output..self.output.saturating_add(bits as u8)
    }

    /// The number in the digital outputs of a robot with this grid ([`TickReport::outputs`](crate::TickReport)).
    pub fn number_in(&self, outputs: u64) -> u32 {
        let mask = u64::MAX.checked_shr(u64::BITS - self.channels().len() as u32).unwrap_or(0);
        (outputs.checked_shr(self.output.into()).unwrap_or(0) & mask) as u32
    }

    /// The number of the cell at these coordinates (m or rad, one per axis), 0 outside; the `former` cell is left only
    /// beyond its border and the hysteresis. 0 if a coordinate is missing or not a number.
    pub fn cell_at(&self, coordinates: &[f64], former: u32) -> u32 {
        self.cell(coordinates.iter().map(|at| Coordinate { at: *at, turn: 0.0 }), former)
    }

    /// Like [`Self::cell_at`].
    pub(crate) fn cell(&self, mut coordinates: impl Iterator<Item = Coordinate>, former: u32) -> u32 {
        let mut rest = former.checked_sub(1);
        let (mut number, mut stride) = (0_u32, 1_u32);
        for axis in &self.axes {
            let before = rest.and_then(|r| r.checked_rem(axis.count));
            rest = rest.and_then(|r| r.checked_div(axis.count));
            let place = coordinates.next().and_then(|at| axis.place(at, before, self.hysteresis));
            let Some(place) = place else { return 0 };
            number = number.saturating_add(stride.saturating_mul(place));
            stride = stride.saturating_mul(axis.count);
        }
        number.saturating_add(1)
    }

    /// What is wrong with the grid, if something is, for a robot with these independent joints: whether each turns without
    /// end.
    pub(crate) fn problem(&self, joints: &[bool], has_tcp: bool) -> Option<String> {
        if let Some(why) = self.axes.iter().find_map(|axis| self.axis_problem(axis)) {
            return Some(why);
        }
        if self.axes.is_empty() || self.cells() > Self::MAX_CELLS {
            return Some(format!(
                "it has {} axes and {} cells, not 1 to {} cells",
                self.axes.len(),
                self.cells(),
                Self::MAX_CELLS
            ));
        }
        if self.channels().end > CHANNELS {
            let Range { start, end } = self.channels();
            return Some(format!(
                "numbers up to {} take the outputs {start} to {}, and the last is 63",
                self.cells(),
                end - 1
            ));
        }
        self.space_problem(joints, has_tcp)
    }

    fn axis_problem(&self, axis: &OutputGridAxis) -> Option<String> {
        let OutputGridAxis { from, to, count } = axis;
        if !(from.is_finite() && to.is_finite() && from < to && *count > 0) {
            return Some(format!("an axis from {from} to {to} in {count} divisions"));
        }
        let fits = (0.0..=0.5 * axis.step()).contains(&self.hysteresis);
        (!fits).then(|| {
            format!("a hysteresis of {} for cells of {}: at most half of a cell", self.hysteresis, axis.step())
        })
    }

    fn space_problem(&self, turns: &[bool], has_tcp: bool) -> Option<String> {
        match &self.space {
            GridSpace::Tcp { frame_in_world } => {
                if self.axes.len() > 3 {
                    return Some(format!("a point has three coordinates, not {}", self.axes.len()));
                }
                if !frame_in_world.is_finite() {
                    return Some("its frame is not at a finite position".into());
                }
                (!has_tcp).then(|| "the robot has no tool centre point".into())
            }
            GridSpace::Joints(joints) => {
                if joints.len() != self.axes.len() {
                    return Some(format!("{} joints for {} axes", joints.len(), self.axes.len()));
                }
                let dof = turns.len();
                if let Some(j) = joints.iter().find(|j| **j >= dof) {
                    return Some(format!("joint {j} of a robot with {dof} joints"));
                }
                let is_long =
                    |(j, axis): &(&usize, &OutputGridAxis)| turns[**j] && axis.to - axis.from > TAU + ROUNDING;
                let long = joints.iter().zip(&self.axes).find(is_long);
                long.map(|_| {
                    "more than a turn of a joint that turns without end: its values count modulo a turn".into()
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    fn grid(axes: Vec<OutputGridAxis>, hysteresis: f64) -> OutputGrid {
        let space = GridSpace::Tcp { frame_in_world: Pose::IDENTITY };
        OutputGrid { name: "g".into(), space, axes, output: 0, hysteresis }
    }

    /// The cell whose box holds the point, by testing all of them.
    fn by_all_boxes(grid: &OutputGrid, p: &[f64]) -> Vec<u32> {
        let holds = |number: &u32| {
            let mut rest = number - 1;
            grid.axes.iter().zip(p).all(|(axis, x)| {
                let place = f64::from(rest % axis.count);
                rest /= axis.count;
                let low = axis.from + place * axis.step();
                *x >= low - 1e-12 && *x <= low + axis.step() + 1e-12
            })
        };
        (1..=grid.cells() as u32).filter(holds).collect()
    }

    #[test]
    fn the_number_is_that_of_the_cell_that_holds_the_point() {
        let mut random = SplitMix(37);
        for _ in 0..200 {
            let axis = |random: &mut SplitMix| {
                let from = random.between(-2.0, 1.0);
                OutputGridAxis {
                    from,
                    to: from + random.between(0.1, 3.0),
                    count: 1 + (random.between(0.0, 6.0) as u32),
                }
            };
            let grid = grid((0..3).map(|_| axis(&mut random)).collect(), 0.0);
            for _ in 0..50 {
                let p: Vec<f64> = grid.axes.iter().map(|a| random.between(a.from - 0.3, a.to + 0.3)).collect();
                let (found, boxes) = (grid.cell_at(&p, 0), by_all_boxes(&grid, &p));
                assert!(if found == 0 { boxes.is_empty() } else { boxes.contains(&found) }, "{p:?}: {found} {boxes:?}");
            }
        }
    }

    #[test]
    fn a_point_that_trembles_at_a_border_keeps_its_cell_and_leaves_it_beyond_the_hysteresis() {
        let grid = grid(vec![OutputGridAxis { from: 0.0, to: 1.0, count: 2 }], 0.01);
        let mut cell = 0;
        let mut at = |x: f64| {
            cell = grid.cell_at(&[x], cell);
            cell
        };
        assert_eq!([0.49, 0.505, 0.495, 0.511, 0.495, 0.489].map(&mut at), [1, 1, 1, 2, 2, 1]);
        // At the ends, too; and nobody is in a cell before the point has reached it.
        assert_eq!([-0.005, -0.011, -0.005, 0.0].map(&mut at), [1, 0, 0, 1]);
        assert_eq!(at(f64::NAN), 0);
    }

    /// A joint that turns without end trembles where its turns meet, however many it has made.
    #[test]
    fn the_ends_of_a_turn_are_a_border_like_others() {
        let half = std::f64::consts::PI;
        let grid = grid(vec![OutputGridAxis { from: -half, to: half, count: 8 }], 0.01);
        let mut cell = 0;
        let mut at = |x: f64| {
            cell = grid.cell([Coordinate { at: x, turn: TAU }].into_iter(), cell);
            cell
        };
        for turns in [0.0, TAU, -3.0 * TAU] {
            assert_eq!(
                [0.1, half - 0.001, half + 0.005, half + 0.011, half - 0.005].map(|x| at(x + turns)),
                [5, 8, 8, 1, 1]
            );
        }
        let long = OutputGrid { axes: vec![OutputGridAxis { from: -half, to: 3.0 * half, count: 8 }], ..grid };
        let long = OutputGrid { space: GridSpace::Joints(vec![0]), ..long };
        assert!(long.problem(&[true], true).is_some_and(|why| why.contains("more than a turn")));
        assert_eq!(long.problem(&[false], true), None);
    }

    /// A grid that no monitor takes answers something, and does not panic.
    #[test]
    fn impossible_grids_do_not_panic() {
        for (count, axes) in [(0, 1), (0, 3), (u32::MAX, 1), (u32::MAX, 3)] {
            let grid = OutputGrid { output: 40, ..grid(vec![OutputGridAxis { from: 0.0, to: 1.0, count }; axes], 0.0) };
            for former in [0, 1, 77, u32::MAX] {
                grid.cell_at(&[0.9; 3], former);
                grid.cell_at(&[f64::NAN; 2], former);
            }
            grid.number_in(u64::MAX);
            assert!(grid.problem(&[], true).is_some());
        }
    }

    #[test]
    fn each_number_has_its_bits() {
        for count in 1..40 {
            let grid = OutputGrid { output: 20, ..grid(vec![OutputGridAxis { from: 0.0, to: 1.0, count }], 0.0) };
            let bits = grid.channels().len() as u32;
            assert!(u64::from(count) < 1 << bits && u64::from(count) >= 1 << (bits - 1), "{count} in {bits} bits");
            for number in 0..=count {
                assert_eq!(grid.number_in((u64::from(number) << 20) | 3 | (1 << 63)), number);
            }
        }
    }
}
