//! A fence: upright walls along a polygon, with openings, as one solid.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use elbowroom_proximity::tessellate::tessellate;
use elbowroom_proximity::{Cuboid, MeshError, Shape, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_vision::{Point2, polygon};

/// The shortest wall, m.
const SHORTEST_M: f64 = 1e-3;
/// Largest distance of the ends of a gate from the line of its wall, m.
const OFF_LINE_M: f64 = 0.01;

/// How far the parts of walls overlap, m: solids that share an edge would count as an open surface.
const OVERLAP_M: f64 = 1e-6;

/// Walls along the edges of a polygon, outside of it. What is within the polygon is free.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fence {
    /// Corners in the world, x and y, m, in either direction.
    pub corners: Vec<Point2>,
    /// Height of the lower edge, m.
    pub floor_m: f64,
    /// Height of the walls, m.
    pub height_m: f64,
    /// Thickness of the walls, m.
    pub thickness_m: f64,
    /// Openings.
    pub gates: Vec<Gate>,
}

/// A part of a wall of a fence: between, below or above gates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FenceWall {
    /// Its solid.
    pub solid: Cuboid,
    /// Pose of the solid's centre in the world.
    pub in_world: Pose,
    /// Horizontal direction in the world, of length 1, from the inside of the fence through the wall.
    pub outwards: Vec3,
}

/// An opening in a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gate {
    /// Its ends, on the line of the wall, m.
    pub ends: [Point2; 2],
    /// Its lower and upper edge in the world, m.
    pub heights_m: [f64; 2],
}

/// Why a fence cannot be built. Corners and walls count from 1; wall N leads from corner N to the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FenceError {
    Short(usize),
    Crossing(usize, usize),
    /// The corner.
    Narrow(usize),
    Thick(usize),
    /// `off_m`: distance of an end from the nearest wall, m.
    GateOffLine {
        gate: usize,
        off_m: f64,
    },
    GateWithoutSize(usize),
    GatesOverlap(usize, usize),
    Mesh(MeshError),
}

impl fmt::Display for FenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(wall) => write!(f, "wall {wall} is shorter than 1 mm"),
            Self::Crossing(a, b) => write!(f, "walls {a} and {b} cross each other"),
            Self::Narrow(corner) => {
                write!(f, "at corner {corner} it turns back by more than a right angle: its walls would reach into it")
            }
            Self::Thick(wall) => {
                write!(f, "wall {wall} is thicker than the room outside: it would reach into the fence elsewhere")
            }
            Self::GateOffLine { gate, off_m } => {
                write!(f, "gate {gate} is on no wall: an end is {off_m:.3} m away from the nearest")
            }
            Self::GateWithoutSize(gate) => write!(f, "gate {gate} has no width or no height within its wall"),
            Self::GatesOverlap(a, b) => write!(f, "gates {a} and {b} overlap"),
            Self::Mesh(e) => write!(f, "{e}"),
        }
    }
}

impl From<MeshError> for FenceError {
    fn from(e: MeshError) -> Self {
        Self::Mesh(e)
    }
}

/// A wall: from a corner in a direction, with its outer normal.
#[derive(Debug, Clone, Copy)]
struct Wall {
    from: Point2,
    along: Point2,
    outwards: Point2,
    length_m: f64,
}

impl Wall {
    fn point(&self, along_m: f64, outwards_m: f64) -> Point2 {
        self.from + self.along * along_m + self.outwards * outwards_m
    }

    fn ends(&self) -> (Point2, Point2) {
        (self.point(0.0, 0.0), self.point(self.length_m, 0.0))
    }

    /// Distances of a point along the wall and from its line.
    fn place(&self, p: Point2) -> (f64, f64) {
        ((p - self.from).dot(self.along), (p - self.from).dot(self.outwards))
    }
}

/// A part of a wall: from where to where along it, and its heights, m.
#[derive(Debug, Clone, Copy)]
struct Panel {
    along_m: [f64; 2],
    heights_m: [f64; 2],
}

impl Fence {
    /// The walls as boxes: one for each part between, below and above gates.
    ///
    /// # Errors
    /// [`FenceError`]: walls that cross or would reach into the fence, and gates that are not in a wall.
    pub fn boxes(&self) -> Result<Vec<FenceWall>, FenceError> {
        let walls = self.walls()?;
        let gates = self.gates_of(&walls)?;
        let of_wall = |(index, wall): (usize, &Wall)| -> Vec<_> {
            self.panels(&walls, index, &gates[index]).iter().map(|panel| self.solid(wall, panel)).collect()
        };
        Ok(walls.iter().enumerate().flat_map(of_wall).collect())
    }

    fn walls(&self) -> Result<Vec<Wall>, FenceError> {
        let mut corners = self.corners.clone();
        // The fence is on the left of its walls; corners keep their numbers if they run the other way.
        let runs_clockwise = polygon::area(&corners) < 0.0;
        if runs_clockwise {
            corners[1..].reverse();
        }
        let count = corners.len();
        let number = |index: usize| if runs_clockwise { (count - index - 1) % count + 1 } else { index + 1 };
        let mut walls = Vec::with_capacity(count);
        for (index, (from, to)) in polygon::edges(&corners).enumerate() {
            let length_m = (to - from).length();
            if length_m < SHORTEST_M {
                return Err(FenceError::Short(number(index)));
            }
            let along = (to - from) * (1.0 / length_m);
            walls.push(Wall { from, along, outwards: Point2::new(along.y, -along.x), length_m });
        }
        if let Some((i, j)) = polygon::first_crossing(&corners) {
            let (i, j) = (number(i), number(j));
            return Err(FenceError::Crossing(i.min(j), i.max(j)));
        }
        for index in 0..count {
            let (before, wall) = (&walls[(index + count - 1) % count], &walls[index]);
            let turns_right = before.along.cross(wall.along) <= 0.0;
            if turns_right && before.along.dot(wall.along) < -1e-9 {
                return Err(FenceError::Narrow(if runs_clockwise { (count - index) % count + 1 } else { index + 1 }));
            }
        }
        match (0..count).find(|index| self.reaches_inside(&corners, &walls, *index)) {
            Some(index) => Err(FenceError::Thick(number(index))),
            None => Ok(walls),
        }
    }

    /// Whether the outer side of a wall is within the fence at another place.
    fn reaches_inside(&self, corners: &[Point2], walls: &[Wall], index: usize) -> bool {
        let (wall, count) = (&walls[index], walls.len());
        let outer = Wall { from: wall.point(0.0, self.thickness_m), ..*wall };
        let is_apart = |j: &usize| *j != index && (*j + 1) % count != index && (index + 1) % count != *j;
        [OVERLAP_M, wall.length_m - OVERLAP_M]
            .iter()
            .any(|along_m| polygon::contains(corners, outer.point(*along_m, 0.0)))
            || (0..count).filter(is_apart).any(|j| polygon::segments_intersect(outer.ends(), walls[j].ends()))
    }

    /// The gates of each wall as panels, in the order along the wall.
    fn gates_of(&self, walls: &[Wall]) -> Result<Vec<Vec<Panel>>, FenceError> {
        let mut found: Vec<Vec<(usize, Panel)>> = vec![Vec::new(); walls.len()];
        for (index, gate) in self.gates.iter().enumerate() {
            let off = |wall: &Wall| {
                let off = |end: Point2| {
                    let (along, across) = wall.place(end);
                    across.abs().max(-along).max(along - wall.length_m)
                };
                off(gate.ends[0]).max(off(gate.ends[1]))
            };
            let nearest = (0..walls.len()).min_by(|a, b| off(&walls[*a]).total_cmp(&off(&walls[*b]))).unwrap_or(0);
            let off_m = off(&walls[nearest]);
            if !(off_m <= OFF_LINE_M) {
                return Err(FenceError::GateOffLine { gate: index + 1, off_m });
            }
            let wall = &walls[nearest];
            let [a, b] = gate.ends.map(|end| wall.place(end).0.clamp(0.0, wall.length_m));
            let [bottom, top] = gate.heights_m.map(|z| z.clamp(self.floor_m, self.floor_m + self.height_m));
            if (a - b).abs() < SHORTEST_M || top - bottom < SHORTEST_M {
                return Err(FenceError::GateWithoutSize(index + 1));
            }
            found[nearest].push((index + 1, Panel { along_m: [a.min(b), a.max(b)], heights_m: [bottom, top] }));
        }
        for gates in &mut found {
            gates.sort_by(|a, b| a.1.along_m[0].total_cmp(&b.1.along_m[0]));
            if let Some(pair) = gates.windows(2).find(|pair| pair[0].1.along_m[1] > pair[1].1.along_m[0]) {
                let (a, b) = (pair[0].0, pair[1].0);
                return Err(FenceError::GatesOverlap(a.min(b), a.max(b)));
            }
        }
        Ok(found.into_iter().map(|gates| gates.into_iter().map(|(_, panel)| panel).collect()).collect())
    }

    /// The parts of a wall that its gates leave.
    fn panels(&self, walls: &[Wall], index: usize, gates: &[Panel]) -> Vec<Panel> {
        let whole = [self.floor_m, self.floor_m + self.height_m];
        let mut panels = Vec::new();
        let mut at = 0.0;
        for gate in gates {
            panels.push(Panel { along_m: [at, gate.along_m[0]], heights_m: whole });
            panels.push(Panel { heights_m: [whole[0], gate.heights_m[0]], ..*gate });
            panels.push(Panel { heights_m: [gate.heights_m[1], whole[1]], ..*gate });
            at = gate.along_m[1];
        }
        panels.push(Panel { along_m: [at, self.end(walls, index)], heights_m: whole });
        let has_size = |[from, to]: [f64; 2]| to - from > 1e-9;
        panels.retain(|panel| has_size(panel.along_m) && has_size(panel.heights_m));
        panels
    }

    /// Where a wall ends, m: it closes the notch outside of a corner at which the fence turns inwards.
    fn end(&self, walls: &[Wall], index: usize) -> f64 {
        let (wall, after) = (&walls[index], &walls[(index + 1) % walls.len()]);
        let turn = wall.along.cross(after.along).atan2(wall.along.dot(after.along));
        let notch_m = self.thickness_m * turn.clamp(0.0, FRAC_PI_2).sin();
        // A little more than up to the corner of the next wall: see `OVERLAP_M`.
        wall.length_m + 1.01 * notch_m
    }

    fn solid(&self, wall: &Wall, panel: &Panel) -> FenceWall {
        let middle = wall.point(0.5 * (panel.along_m[0] + panel.along_m[1]), 0.5 * self.thickness_m);
        let length_m = panel.along_m[1] - panel.along_m[0] + 2.0 * OVERLAP_M;
        let size = Vec3::new(length_m, self.thickness_m, panel.heights_m[1] - panel.heights_m[0]);
        let at = Vec3::new(middle.x, middle.y, 0.5 * (panel.heights_m[0] + panel.heights_m[1]));
        let rotation = Rotation::from_rpy(0.0, 0.0, wall.along.y.atan2(wall.along.x));
        FenceWall {
            solid: Cuboid { half_extents: size * 0.5 },
            in_world: Pose::new(rotation, at),
            outwards: Vec3::new(wall.outwards.x, wall.outwards.y, 0.0),
        }
    }
}

/// The walls as one mesh in the world.
///
/// # Errors
/// [`MeshError`] if there are none, or if they are too large.
pub(crate) fn mesh_of_walls(walls: &[FenceWall]) -> Result<TriMesh, MeshError> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for FenceWall { solid, in_world, .. } in walls {
        let first = vertices.len() as u32;
        let (corners, sides) = tessellate(&Shape::Cuboid(*solid), 1e-3);
        vertices.extend(corners.into_iter().map(|corner| in_world.transform_point(corner)));
        triangles.extend(sides.iter().map(|side| side.map(|i| i + first)));
    }
    TriMesh::new(vertices, triangles)
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::{Sphere, separation};
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    fn corners(list: &[(f64, f64)]) -> Vec<Point2> {
        list.iter().map(|(x, y)| Point2::new(*x, *y)).collect()
    }

    fn fence(list: &[(f64, f64)]) -> Fence {
        Fence { corners: corners(list), floor_m: 0.0, height_m: 2.0, thickness_m: 0.05, gates: Vec::new() }
    }

    /// An L, and the same the other way round.
    const L: [(f64, f64); 6] = [(-2.0, -2.0), (2.0, -2.0), (2.0, 0.0), (0.0, 0.0), (0.0, 2.0), (-2.0, 2.0)];

    fn mesh_of(fence: &Fence) -> Result<TriMesh, FenceError> {
        Ok(mesh_of_walls(&fence.boxes()?)?)
    }

    fn distance(mesh: &TriMesh, p: Vec3) -> f64 {
        let wall = Shape::Mesh(mesh.clone().into());
        let point = Shape::Sphere(Sphere { radius: 0.0 });
        separation(&point, &Pose::from_translation(p), &wall, &Pose::IDENTITY).distance
    }

    /// Distance from the lines of the polygon, at a height between floor and top.
    fn to_lines(corners: &[Point2], p: Point2) -> f64 {
        let to_edge = |(a, b): (Point2, Point2)| {
            let along = b - a;
            let share = ((p - a).dot(along) / along.dot(along)).clamp(0.0, 1.0);
            (p - a - along * share).length()
        };
        polygon::edges(corners).map(to_edge).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn inside_the_distance_is_that_from_the_lines_and_walls_are_outside() {
        let mut random = SplitMix(5);
        for reversed in [false, true] {
            let mut fence = fence(&L);
            if reversed {
                fence.corners.reverse();
            }
            let mesh = mesh_of(&fence).unwrap();
            assert!(mesh.report().closed && !mesh.report().inside_out);
            for _ in 0..2_000 {
                let p = Point2::new(random.between(-2.3, 2.3), random.between(-2.3, 2.3));
                let (found, exact) = (distance(&mesh, Vec3::new(p.x, p.y, 1.0)), to_lines(&fence.corners, p));
                if polygon::contains(&fence.corners, p) {
                    assert!((found - exact).abs() < 2e-6, "{p:?}: {found} {exact}");
                } else if exact < 0.05 {
                    assert!(found <= 1e-12, "{p:?} is within a wall: {found}");
                }
            }
            assert!((distance(&mesh, Vec3::new(-1.0, -1.0, 2.5)) - 1.0_f64.hypot(0.5)).abs() < 2e-6);
        }
    }

    #[test]
    fn every_part_of_a_wall_knows_which_side_is_inside() {
        for reversed in [false, true] {
            let mut fence = fence(&L);
            if reversed {
                fence.corners.reverse();
            }
            let ends = [Point2::new(2.0, -0.5), Point2::new(2.0, -1.5)];
            fence.gates = vec![Gate { ends, heights_m: [0.8, 1.4] }];
            let walls = fence.boxes().unwrap();
            assert_eq!(walls.len(), 6 + 3);
            for FenceWall { in_world, outwards, .. } in walls {
                let beside = |metres: f64| {
                    let p = in_world.translation + outwards * metres;
                    polygon::contains(&fence.corners, Point2::new(p.x, p.y))
                };
                assert!(beside(-0.1) && !beside(0.1) && (outwards.length() - 1.0).abs() < 1e-12, "{in_world:?}");
            }
        }
    }

    #[test]
    fn gates_are_open_and_the_rest_of_their_wall_is_not() {
        let ends = [Point2::new(2.0, -0.5), Point2::new(2.0, -1.5)];
        let gates = vec![Gate { ends, heights_m: [0.8, 1.4] }];
        let mesh = mesh_of(&Fence { gates, ..fence(&L) }).unwrap();
        let at = |y: f64, z: f64| distance(&mesh, Vec3::new(2.02, y, z));
        assert!((at(-1.0, 1.1) - 0.3).abs() < 2e-6);
        assert!([(-1.0, 0.7), (-1.0, 1.5), (-0.4, 1.1), (-1.6, 1.1)].iter().all(|(y, z)| at(*y, *z) <= 0.0));
        // From corner to corner, floor to top: no wall is left.
        let ends = [Point2::new(2.0, 0.0), Point2::new(2.0, -2.0)];
        let open = mesh_of(&Fence { gates: vec![Gate { ends, heights_m: [-1.0, 9.0] }], ..fence(&L) }).unwrap();
        assert!(distance(&open, Vec3::new(2.02, -1.0, 1.0)) > 0.9);
    }

    #[test]
    fn what_is_no_fence_is_refused_by_number() {
        let wrong = |list: &[(f64, f64)]| mesh_of(&fence(list)).unwrap_err();
        assert_eq!(wrong(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)]), FenceError::Short(2));
        let bow = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)];
        assert_eq!(wrong(&bow), FenceError::Crossing(1, 3));
        // A spike that comes in from outside with 37 degrees.
        let spike = [(-2.0, 0.0), (-0.3, 0.0), (0.0, 1.0), (0.3, 0.0), (2.0, 0.0), (2.0, 2.0), (-2.0, 2.0)];
        assert_eq!(wrong(&spike), FenceError::Narrow(3));
        let reversed: Vec<_> = spike.iter().rev().copied().collect();
        assert_eq!(wrong(&reversed), FenceError::Narrow(5));
        // A slot of 80 mm between two halves.
        let slot = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.04, 1.0), (1.04, 0.5), (0.96, 0.5), (0.96, 1.0), (0.0, 1.0)];
        assert!(mesh_of(&fence(&slot)).is_ok());
        assert!(matches!(mesh_of(&Fence { thickness_m: 0.1, ..fence(&slot) }), Err(FenceError::Thick(_))));
        let gate = |from: (f64, f64), to: (f64, f64)| Gate {
            ends: [Point2::new(from.0, from.1), Point2::new(to.0, to.1)],
            heights_m: [0.0, 2.0],
        };
        let with = |gates: Vec<Gate>| mesh_of(&Fence { gates, ..fence(&L) }).unwrap_err();
        let far = with(vec![gate((2.3, -0.5), (2.3, -1.5))]);
        assert!(matches!(far, FenceError::GateOffLine { gate: 1, off_m } if (off_m - 0.3).abs() < 1e-9), "{far:?}");
        assert_eq!(with(vec![gate((2.0, -1.0), (2.0, -1.0))]), FenceError::GateWithoutSize(1));
        let two = vec![gate((2.0, -0.5), (2.0, -1.5)), gate((2.0, -1.4), (2.0, -1.9))];
        assert_eq!(with(two), FenceError::GatesOverlap(1, 2));
        assert!(matches!(wrong(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]), FenceError::Narrow(_) | FenceError::Thick(_)));
    }
}
