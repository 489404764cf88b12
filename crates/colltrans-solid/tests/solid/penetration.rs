//! Surface distances, signed distances, common parts and depths of polycubes, whose answers are known exactly.
//!
//! A polycube is a union of cells of side 1. Its surface is the list of squares between a cell of it and a cell outside
//! of it. All coordinates are multiples of 1/4, so squared distances of squares and points have no rounding error.

use colltrans_convex::{Pair, Pose};
use colltrans_solid::{Overlap, Solid, SolidPenetration};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use glam::DVec3;

use crate::common::{at, cuboid};

const SIDE: i64 = 4;

/// Cells of side 1, by their lowest corners, and their squares as boxes without thickness.
struct Polycube {
    cells: Vec<[i64; 3]>,
    squares: Vec<[DVec3; 2]>,
    solid: Solid,
}

impl Polycube {
    /// Builds a polycube, or returns `None` if its surface is rejected because two cells share only an edge.
    fn new(cells: Vec<[i64; 3]>) -> Option<Self> {
        let (mut vertices, mut facets, mut squares) = (Vec::new(), Vec::new(), Vec::new());
        for cell in &cells {
            for side in 0..6 {
                let (axis, up) = (side % 3, side / 3);
                let mut beside = *cell;
                beside[axis] += if up == 1 { 1 } else { -1 };
                if cells.contains(&beside) {
                    continue;
                }
                let corner = |i: i64, j: i64| {
                    let mut p = *cell;
                    p[axis] += up as i64;
                    p[(axis + 1) % 3] += i;
                    p[(axis + 2) % 3] += j;
                    DVec3::from_array(p.map(|c| c as f64))
                };
                let mut square = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                squares.push([square[0], square[2]]);
                if up == 0 {
                    square.reverse();
                }
                let first = vertices.len() as u32;
                vertices.extend(square);
                facets.push([first, first + 1, first + 2, first + 3]);
            }
        }
        let solid = Solid::from_mesh(&vertices, &facets).ok()?;
        Some(Self { cells, squares, solid })
    }

    /// Draws some cells of a cube of cells, or the cube with few cells left out.
    fn random(random: &mut Random) -> Self {
        loop {
            let rare = random.one_in(2);
            let mut cells = Vec::new();
            for k in 0..SIDE.pow(3) {
                if random.one_in(8) != rare {
                    cells.push([k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE]);
                }
            }
            if let Some(cube) = Self::new(cells) {
                return cube;
            }
        }
    }

    fn contains(&self, cell: [i64; 3]) -> bool {
        self.cells.contains(&cell)
    }

    /// Returns whether a point that lies on no square is inside.
    fn has_inside(&self, p: DVec3) -> bool {
        self.contains(p.floor().to_array().map(|c| c as i64))
    }
}

/// Returns the squared distance of two boxes, exactly.
fn squared_distance([low, high]: [DVec3; 2], [least, most]: [DVec3; 2]) -> f64 {
    (least - high).max(low - most).max(DVec3::ZERO).length_squared()
}

fn quarters(random: &mut Random, low: i64, high: i64) -> DVec3 {
    random.grid(low, high) / 4.0
}

#[test]
fn signed_distances_of_polycubes_agree_with_squares() {
    let mut seen = [0; 3];
    for seed in 0..cases(200) {
        let mut random = Random::new(seed);
        let cube = Polycube::random(&mut random);
        let there = quarters(&mut random, -8, 8);
        let points: Vec<DVec3> = (0..20).map(|_| quarters(&mut random, -6, 22)).collect();
        let placed: Vec<DVec3> = points.iter().map(|p| *p + there).collect();
        let found = cube.solid.signed_distances(at(there), &placed).expect("distances");
        for (p, found) in points.iter().zip(found) {
            let squares = cube.squares.iter().map(|square| squared_distance([*p; 2], *square));
            let exact = squares.fold(f64::INFINITY, f64::min).sqrt();
            let inside = exact > 0.0 && cube.has_inside(*p);
            let signed = if inside { -exact } else { exact };
            assert_eq!(found.is_inside, inside, "{seed}: {p}");
            assert!(found.lower <= signed && signed <= found.upper, "{seed}: {p} {found:?}");
            assert!(found.upper - found.lower < 1e-12, "{seed}: {p} {found:?}");
            assert!(((found.nearest - there - *p).length() - exact).abs() < 1e-12, "{seed}: {p}");
            seen[if exact == 0.0 { 0 } else { 1 + usize::from(inside) }] += 1;
        }
    }
    assert!(seen.iter().all(|count| *count > cases(100)), "{seen:?}");
}

#[test]
fn surface_distances_of_polycubes_agree_with_squares() {
    let mut nested = 0;
    for seed in 0..cases(400) {
        let mut random = Random::new(seed);
        let outer = Polycube::random(&mut random);
        let half = DVec3::splat(0.125) * random.grid(1, 3);
        let inner = cuboid(-half, half);
        let middle = quarters(&mut random, -4, 20);
        let pair = Pair::new(inner.at(at(middle)), outer.solid.at(Pose::IDENTITY)).expect("a pair");
        let found = pair.surface_distance().expect("a distance");
        let mut least = f64::INFINITY;
        for side in 0..6 {
            let mut ends = [middle - half, middle + half];
            ends[1 - side / 3][side % 3] = ends[side / 3][side % 3];
            let distances = outer.squares.iter().map(|square| squared_distance(ends, *square));
            least = distances.fold(least, f64::min);
        }
        let exact = least.sqrt();
        assert!(found.lower <= exact && exact <= found.upper, "{seed}: {found:?} {exact}");
        assert!(found.upper - found.lower < 1e-12, "{seed}: {found:?}");
        let inside = exact > 0.0 && outer.has_inside(middle);
        let around = exact > 0.0
            && outer.squares.iter().any(|[low, _]| (*low - middle).abs().cmplt(half).all());
        match found.place {
            Some(Overlap::Facets(..)) => assert_eq!(exact, 0.0, "{seed}"),
            Some(Overlap::MovingInside(_)) => assert!(inside, "{seed}"),
            Some(Overlap::FixedInside(_)) => assert!(around, "{seed}"),
            None => assert!(exact > 0.0 && !inside && !around, "{seed}"),
        }
        nested += usize::from(inside);
    }
    assert!(nested > cases(20), "{nested}");
}

#[test]
fn signed_distances_name_the_invalid_point() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let points = [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 0.0)];
    let error = cube.signed_distances(Pose::IDENTITY, &points).expect_err("not a number");
    assert!(error.to_string().starts_with("point 1: "), "{error}");
}
