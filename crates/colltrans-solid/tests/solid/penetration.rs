//! Surface distances, signed distances, common parts and depths of polycubes, whose answers are known exactly.
//!
//! A polycube is a union of cells of side 1. Its surface is the list of squares between a cell of it and a cell outside
//! of it. All coordinates are multiples of 1/4, so squared distances of squares and points have no rounding error.

use std::f64::consts::TAU;

use colltrans_convex::{ConvexPolyhedron, Pair, Pose};
use colltrans_solid::{
    AsSolid, CommonPart, InnerPair, Overlap, Relation, Solid, SolidDepth, SolidPenetration,
    VolumeOptions,
};
use colltrans_testkit::cases;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{block, extruded, ring};
use glam::{DQuat, DVec3};

use crate::common::{at, cuboid, solid};

const SIDE: i64 = 4;

/// Cells of side 1, by their lowest corners, and their squares as boxes without thickness.
pub(crate) struct Polycube {
    cells: Vec<[i64; 3]>,
    squares: Vec<[DVec3; 2]>,
    pub(crate) solid: Solid,
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
    pub(crate) fn random(random: &mut Random) -> Self {
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
    pub(crate) fn has_inside(&self, p: DVec3) -> bool {
        self.contains(p.floor().to_array().map(|c| c as i64))
    }
}

/// Returns the squared distance of two boxes, exactly.
fn squared_distance([low, high]: [DVec3; 2], [least, most]: [DVec3; 2]) -> f64 {
    (least - high).max(low - most).max(DVec3::ZERO).length_squared()
}

pub(crate) fn quarters(random: &mut Random, low: i64, high: i64) -> DVec3 {
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

impl Polycube {
    /// Returns the solid, or in half of the cases the union of its cells, which has facets inside.
    pub(crate) fn drawn_solid(&self, random: &mut Random) -> Solid {
        if random.one_in(2) {
            return self.solid.clone();
        }
        let cubes: Vec<Solid> = self.lows().map(|low| cuboid(low, low + 1.0)).collect();
        Solid::from_pieces(&cubes).expect("closed pieces")
    }

    /// Returns the lowest corners of the cells.
    pub(crate) fn lows(&self) -> impl Iterator<Item = DVec3> {
        self.cells.iter().map(|cell| DVec3::from_array(cell.map(|c| c as f64)))
    }

    /// Returns the exact volume that boxes around the cells of another polycube have in common with this one. The boxes
    /// exceed the cells by `margin`, and are disjoint only without a margin.
    pub(crate) fn common_volumes(&self, low: DVec3, margin: f64) -> f64 {
        let common = |own: DVec3| (own + 1.0).min(low + 1.0 + margin) - own.max(low - margin);
        self.lows().map(|own| common(own).max(DVec3::ZERO).element_product()).sum()
    }

    /// Checks whether this polycube contains another one with its surface.
    fn contains_strictly(&self, other: &Self, by: DVec3) -> bool {
        let full = 1.25_f64.powi(3);
        other.lows().all(|low| self.common_volumes(low + by, 0.125) == full)
    }
}

#[test]
fn common_parts_of_polycubes_agree_with_cells() {
    let mut seen = [0; 5];
    for seed in 0..cases(400) {
        let mut random = Random::new(seed);
        let fixed = Polycube::random(&mut random);
        let small = random.one_in(3);
        let moving = if small {
            let cells = vec![[0, 0, 0], [1, 0, 0]];
            Polycube::new(cells).expect("a bar")
        } else {
            Polycube::random(&mut random)
        };
        let by = if small && random.one_in(2) {
            random.grid(0, 3)
        } else if small {
            quarters(&mut random, -8, 16)
        } else {
            quarters(&mut random, -18, 18)
        };
        let solids = [moving.drawn_solid(&mut random), fixed.drawn_solid(&mut random)];
        let pair = Pair::new(solids[0].at(at(by)), solids[1].at(Pose::IDENTITY)).expect("a pair");
        let found = pair.common_part(VolumeOptions::default()).expect("a common part");
        let exact: f64 = moving.lows().map(|low| fixed.common_volumes(low + by, 0.0)).sum();
        assert!(found.volume[0] <= exact && exact <= found.volume[1], "{seed}: {exact} {found:?}");
        assert!(found.is_accurate, "{seed}: {exact} {found:?}");
        let touch = moving.lows().any(|p| {
            let p = p + by;
            fixed.lows().any(|q| squared_distance([p, p + 1.0], [q, q + 1.0]) == 0.0)
        });
        let whole = [moving.cells.len() as f64 == exact, fixed.cells.len() as f64 == exact];
        let strict = [fixed.contains_strictly(&moving, by), moving.contains_strictly(&fixed, -by)];
        let are_plain = solids[0].report().shells.len() < 3 && solids[1].report().shells.len() < 3;
        let is_right = match found.relation {
            Relation::Disjoint => !touch,
            Relation::Touching(_) => touch && exact == 0.0,
            Relation::Crossing(_) | Relation::PartlyContained(_) => {
                exact > 0.0 && !(are_plain && (strict[0] || strict[1]))
            }
            Relation::MovingContained => whole[0],
            Relation::FixedContained => whole[1],
            _ => false,
        };
        assert!(is_right, "{seed}: {exact} {touch} {whole:?} {strict:?} {found:?}");
        assert_eq!(found.point.is_some(), exact > 0.0, "{seed}: {found:?}");
        if let (Some(point), Some(bounds)) = (found.point, found.bounds) {
            assert!(moving.has_inside(point - by) && fixed.has_inside(point), "{seed}: {point}");
            for low in moving.lows().map(|low| low + by) {
                for other in fixed.lows() {
                    let (low, high) = (low.max(other), (low + 1.0).min(other + 1.0));
                    if low.cmplt(high).all() {
                        let inner = bounds.low.cmple(low).all() && high.cmple(bounds.high).all();
                        assert!(inner, "{seed}: {bounds:?}");
                    }
                }
            }
        }
        seen[match found.relation {
            Relation::Disjoint => 0,
            Relation::Touching(_) => 1,
            Relation::Crossing(_) => 2,
            Relation::MovingContained => 3,
            _ => 4,
        }] += 1;
    }
    assert!(seen[..3].iter().all(|count| *count > 0), "{seen:?}");
}

#[test]
fn nested_bodies_are_told_from_crossing_ones() {
    let mut seen = [0; 5];
    for seed in 0..cases(600) {
        let mut random = Random::new(seed);
        // A cube of cells with one cavity, of one or two cells.
        let cavity = [[1, 1, 1], [if random.one_in(2) { 1 } else { 2 }, 1, 1]];
        let cells = (0..SIDE.pow(3)).map(|k| [k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE]);
        let outer = Polycube::new(cells.filter(|cell| !cavity.contains(cell)).collect());
        let outer = outer.expect("a cube with a cavity");
        let half = DVec3::splat(0.125) * random.grid(1, 9);
        let middle =
            if random.one_in(2) { DVec3::new(1.5, 1.5, 1.5) } else { quarters(&mut random, 0, 16) };
        let [low, high] = [middle - half, middle + half];
        let inner = cuboid(low, high);
        let exact: f64 = outer
            .lows()
            .map(|cell| (high.min(cell + 1.0) - low.max(cell)).max(DVec3::ZERO).element_product())
            .sum();
        let mut ends = (0..6).map(|side| {
            let mut ends = [low, high];
            ends[1 - side / 3][side % 3] = ends[side / 3][side % 3];
            ends
        });
        let touch = ends.any(|end| outer.squares.iter().any(|s| squared_distance(end, *s) == 0.0));
        let is_whole = exact == (high - low).element_product();
        let solids = [&inner, &outer.solid];
        for moving in 0..2 {
            let [first, second] = [solids[moving], solids[1 - moving]];
            let pair = Pair::new(first.at(Pose::IDENTITY), second.at(Pose::IDENTITY));
            let pair = pair.expect("a pair");
            let found = pair.common_part(VolumeOptions::default()).expect("a common part");
            let contained =
                [Relation::MovingContained, Relation::FixedContained][moving] == found.relation;
            let is_right = match found.relation {
                Relation::Disjoint => exact == 0.0 && !touch,
                Relation::Touching(_) => exact == 0.0 && touch,
                Relation::Crossing(_) => exact > 0.0 && touch,
                Relation::PartlyContained(_) => exact > 0.0 && !is_whole && !touch,
                _ => contained && is_whole,
            };
            assert!(is_right, "{seed}: {exact} {touch} {is_whole} {found:?}");
            assert!(
                found.volume[0] <= exact && exact <= found.volume[1],
                "{seed}: {exact} {found:?}"
            );
            assert!(found.is_accurate, "{seed}: {exact} {found:?}");
            seen[match found.relation {
                Relation::Disjoint => 0,
                Relation::Touching(_) => 1,
                Relation::Crossing(_) => 2,
                Relation::PartlyContained(_) => 3,
                _ => 4,
            }] += 1;
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}

/// The rotation and the translation are rounded: coordinates below 2 have errors below 16 roundoffs, a relative error
/// of the volume below `1e-8`.
#[test]
fn volume_of_thin_plates_is_that_of_their_overlap() {
    let thickness = 2.0_f64.powi(-20);
    for seed in 0..cases(20) {
        let mut random = Random::new(seed);
        let rotation = random.rotation();
        let plate = cuboid([0.0; 3], [1.0, 1.0, thickness]);
        let shift = DVec3::new(random.range(-0.5, 0.5), random.range(-0.5, 0.5), 0.5 * thickness);
        let poses =
            [rotation * shift, DVec3::ZERO].map(|at| Pose::new(rotation, at).expect("a pose"));
        let pair = Pair::new(plate.at(poses[0]), plate.at(poses[1])).expect("a pair");
        let found = pair.common_part(VolumeOptions::default()).expect("a common part");
        let exact = (1.0 - shift.x.abs()) * (1.0 - shift.y.abs()) * 0.5 * thickness;
        assert!(found.volume[0] <= exact * (1.0 + 1e-8), "{seed}: {exact} {found:?}");
        assert!(exact * (1.0 - 1e-8) <= found.volume[1], "{seed}: {exact} {found:?}");
        assert!(found.is_accurate, "{seed}: {exact} {found:?}");
    }
}

#[test]
fn few_cells_are_stated() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let turn = Pose::new(Random::new(1).rotation(), DVec3::splat(0.5)).expect("a pose");
    let pair = Pair::new(cube.at(turn), cube.at(Pose::IDENTITY)).expect("a pair");
    let mut last = [0.0, f64::INFINITY];
    for max_cells in [1, 10, 100, 1000] {
        let found = pair
            .common_part(VolumeOptions::default().with_accuracy(0.0).with_max_cells(max_cells))
            .expect("an answer");
        assert_eq!(found.cells, max_cells);
        assert!(!found.is_accurate);
        assert!(last[0] <= found.volume[1] && found.volume[0] <= last[1], "{found:?}");
        last = found.volume;
    }
    assert!(last[1] < 1.05 * last[0], "{last:?}");
}

#[test]
fn volumes_on_both_sides_of_a_plane_add_up() {
    for seed in 0..cases(24) {
        let mut random = Random::new(seed);
        let body = Polycube::random(&mut random);
        let turn = Pose::new(random.rotation(), random.vector()).expect("a pose");
        let is_small = body.cells.len() < 20;
        let solid = if is_small { body.drawn_solid(&mut random) } else { body.solid.clone() };
        let high = random.range(-3.0, 3.0);
        let parts = [(-20.0, high), (high, 20.0)].map(|(low, high)| {
            let half = cuboid([-20.0, -20.0, low], [20.0, 20.0, high]);
            let pair = Pair::new(solid.at(turn), half.at(Pose::IDENTITY)).expect("a pair");
            pair.common_part(VolumeOptions::default()).expect("a common part")
        });
        let [lower, upper] = [0, 1].map(|k| parts[0].volume[k] + parts[1].volume[k]);
        let exact = body.cells.len() as f64;
        assert!(lower <= exact && exact <= upper, "{seed}: {exact} {parts:?}");
        assert!(parts.iter().all(|part| part.is_accurate), "{seed}: {parts:?}");
    }
}

/// Returns the exact square of the depth of polycubes. The displacements after which two cells share interior points
/// form an open cube. The planes of all cubes divide space into boxes, rectangles, segments and points. The depth is
/// the distance of the nearest of these that no cube contains.
pub(crate) fn exact_squared_depth(moving: &Polycube, fixed: &Polycube, by: DVec3) -> f64 {
    let mut centers: Vec<DVec3> =
        moving.lows().flat_map(|p| fixed.lows().map(move |q| q - p - by)).collect();
    centers.sort_by(|p, q| p.to_array().partial_cmp(&q.to_array()).expect("finite"));
    centers.dedup();
    let ranges = [0, 1, 2].map(|axis| {
        let mut planes: Vec<f64> =
            centers.iter().flat_map(|c| [c[axis] - 1.0, c[axis] + 1.0]).collect();
        planes.sort_by(f64::total_cmp);
        planes.dedup();
        let mut ranges = vec![[f64::NEG_INFINITY, planes[0]]];
        for pair in planes.windows(2) {
            ranges.extend([[pair[0]; 2], [pair[0], pair[1]]]);
        }
        let last = planes[planes.len() - 1];
        ranges.extend([[last; 2], [last, f64::INFINITY]]);
        ranges
    });
    let mut best = f64::INFINITY;
    for x in &ranges[0] {
        for y in &ranges[1] {
            for z in &ranges[2] {
                let low = DVec3::new(x[0], y[0], z[0]);
                let high = DVec3::new(x[1], y[1], z[1]);
                let square = squared_distance([DVec3::ZERO; 2], [low, high]);
                let is_covered = |c: &DVec3| {
                    (*c - 1.0).cmple(low).all()
                        && high.cmple(*c + 1.0).all()
                        && (0..3).all(|k| low[k] < high[k] || (low[k] - c[k]).abs() < 1.0)
                };
                if square < best && !centers.iter().any(is_covered) {
                    best = square;
                }
            }
        }
    }
    best
}

/// Checks that the convex bodies of a depth lie in the placed polycubes.
fn check_inner_pair(found: &SolidDepth, bodies: [(&Polycube, DVec3); 2]) {
    assert!(found.inner.is_none_or(|inner| inner.depth() <= found.lower), "{found:?}");
    for (k, (cube, by)) in bodies.into_iter().enumerate() {
        match found.inner {
            Some(InnerPair::Balls { center, radii }) => {
                let (at, square) = (center - by, radii[k].powi(2));
                let near = |s: &[DVec3; 2]| squared_distance([at; 2], *s) < square;
                assert!(cube.has_inside(at) && !cube.squares.iter().any(near), "{found:?}");
            }
            Some(InnerPair::Boxes { moving, fixed }) => {
                let inner = [moving, fixed][k];
                let full = inner.side_lengths().element_product();
                let (low, high) = (inner.low - by, inner.high - by);
                let within = |cell: DVec3| high.min(cell + 1.0) - low.max(cell);
                let parts = cube.lows().map(|c| within(c).max(DVec3::ZERO).element_product());
                assert!(parts.sum::<f64>() > full * (1.0 - 1e-12), "{found:?}");
            }
            _ => assert_eq!((found.lower, found.inner), (0.0, None)),
        }
    }
}

/// Checks whether the interiors have a common point after the translation of a depth.
fn overlap_after(pair: &Pair<Solid>, found: &SolidDepth) -> bool {
    let [moving, fixed] = [pair.bodies.moving_placed(), pair.bodies.fixed_placed()];
    let away = moving.pose.translation() + found.translation;
    let pose = moving.pose.with_translation(away).expect("a pose");
    let apart = Pair::new(moving.body.at(pose), fixed).expect("a pair");
    let common = apart.common_part(VolumeOptions::default()).expect("a common part");
    !matches!(common.relation, Relation::Disjoint | Relation::Touching(_))
}

#[test]
fn depths_of_polycubes_contain_the_exact_ones() {
    let (mut overlaps, mut exact_upper, mut exact_lower) = (0, 0, 0);
    for seed in 0..cases(200) {
        let mut random = Random::new(seed);
        let [moving, fixed] = [(); 2].map(|()| {
            if random.one_in(4) {
                let cells = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]);
                return Polycube::new(cells.filter(|cell| *cell != [1; 3]).collect());
            }
            let cells = (0..2 + random.index(6)).fold(vec![[0, 0, 0]], |mut cells, _| {
                let mut next = cells[random.index(cells.len())];
                next[random.index(3)] += if random.one_in(2) { 1 } else { -1 };
                if !cells.contains(&next) {
                    cells.push(next);
                }
                cells
            });
            Polycube::new(cells)
        });
        let (Some(moving), Some(fixed)) = (moving, fixed) else { continue };
        let by = quarters(&mut random, -8, 8);
        let solids = [moving.drawn_solid(&mut random), fixed.drawn_solid(&mut random)];
        let pair = Pair::new(solids[0].at(at(by)), solids[1].at(Pose::IDENTITY)).expect("a pair");
        let found = pair.depth().expect("a depth");
        let exact = exact_squared_depth(&moving, &fixed, by).sqrt();
        assert!(found.lower <= exact, "{seed}: {exact} {found:?}");
        assert!(exact <= found.upper, "{seed}: {exact} {found:?}");
        assert_eq!(found.upper > 0.0, exact > 0.0, "{seed}: {exact} {found:?}");
        assert!(!overlap_after(&pair, &found), "{seed}: {found:?}");
        check_inner_pair(&found, [(&moving, by), (&fixed, DVec3::ZERO)]);
        overlaps += usize::from(exact > 0.0);
        exact_upper += usize::from(exact > 0.0 && found.upper < exact + 1e-9);
        exact_lower += usize::from(exact > 0.0 && found.lower > 0.98 * exact);
    }
    // The bounds are proven. How close they are is measured.
    assert!(overlaps > cases(50), "{overlaps}");
    assert!(10 * exact_upper > 9 * overlaps, "{exact_upper} of {overlaps}");
    assert!(2 * exact_lower > overlaps, "{exact_lower} of {overlaps}");
}

#[test]
fn depths_of_convex_bodies_lie_within_the_bounds_of_unions() {
    let mut overlaps = 0;
    for seed in 0..cases(80) {
        let mut random = Random::new(seed);
        let hulls = [(); 2].map(|()| {
            if random.one_in(3) {
                let thin = DVec3::new(1.0, 1.0, 0.001);
                return ConvexPolyhedron::cuboid(-thin, thin).expect("a plate");
            }
            let points: Vec<DVec3> = (0..10).map(|_| random.vector()).collect();
            ConvexPolyhedron::from_points(&points).expect("a hull")
        });
        let place = Pose::new(random.rotation(), random.vector()).expect("a pose");
        let convex = Pair::new(hulls[0].at(place), hulls[1].at(Pose::IDENTITY)).expect("a pair");
        let exact = convex.depth().expect("a depth");
        let [a, b] = hulls.each_ref().map(|hull| Solid::from_convex(hull).expect("a solid"));
        // The second piece does not change the union, but such a solid does not count as convex.
        let [c, d] = [&a, &b].map(|solid| Solid::from_pieces([solid, solid]).expect("a union"));
        for [moving, fixed] in [[&a, &b], [&c, &d], [&a, &d]] {
            let pair = Pair::new(moving.at(place), fixed.at(Pose::IDENTITY)).expect("a pair");
            let found = pair.depth().expect("a depth");
            assert!(found.lower <= exact.upper, "{seed}: {exact:?} {found:?}");
            assert!(exact.lower <= found.upper, "{seed}: {exact:?} {found:?}");
            assert!(!overlap_after(&pair, &found), "{seed}: {found:?}");
            if moving.report().shells.len() + fixed.report().shells.len() == 2 {
                assert!(found.upper - found.lower < 1e-9, "{seed}: {found:?}");
            }
        }
        overlaps += usize::from(exact.lower > 0.0);
    }
    assert!(overlaps > cases(20), "{overlaps}");
}

/// Returns the pair of two bodies in the world.
fn pair<'a>(moving: &'a Solid, fixed: &'a Solid) -> Pair<'a, Solid> {
    Pair::new(moving.at(Pose::IDENTITY), fixed.at(Pose::IDENTITY)).expect("a pair")
}

fn common(pair: &Pair<Solid>) -> CommonPart {
    pair.common_part(VolumeOptions::default()).expect("a common part")
}

/// Builds a box with a cavity.
pub(crate) fn hollow([low, high]: [[f64; 3]; 2], cavity: [[f64; 3]; 2]) -> Solid {
    solid(&block(low, high).joined(&block(cavity[0], cavity[1]).reversed()))
}

pub(crate) fn square_sheet(half: f64) -> Solid {
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let corners = corners.map(|[x, y]| DVec3::new(5.0 + x, 5.0 + y, 5.0));
    Solid::from_open_mesh(&corners, &[[0, 1, 2, 3]]).expect("a sheet")
}

#[test]
fn a_body_in_a_filled_cavity_overlaps_the_filling() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let wall = hollow([[-1.0; 3], [2.0; 3]], [[0.0; 3], [1.0; 3]]);
    let filled = Solid::from_pieces([&wall, &cuboid([-0.5; 3], [1.5; 3])]).expect("two pieces");
    for both in [pair(&cube, &filled), pair(&filled, &cube)] {
        let found = common(&both);
        assert!(found.volume[0] <= 1.0 && 1.0 <= found.volume[1] && found.is_accurate, "{found:?}");
        assert!(found.point.is_some());
        let depth = both.depth().expect("a depth");
        assert!(depth.lower <= 2.0 && 2.0 <= depth.upper, "{depth:?}");
        assert!(depth.lower > 0.9 && depth.upper < 2.0 + 1e-9, "{depth:?}");
    }
}

#[test]
fn shells_that_bound_no_material_do_not_hide_containment() {
    let outer = cuboid([0.0; 3], [10.0; 3]);
    let inner = cuboid([3.0; 3], [7.0; 3]);
    let cavity = [[4.0; 3], [6.0; 3]];
    let with_piece = Solid::from_pieces([&outer, &cuboid(cavity[0], cavity[1])]).expect("pieces");
    let with_sheet = Solid::from_pieces([&outer, &square_sheet(1.0)]).expect("pieces");
    let wall = hollow([[0.0; 3], [10.0; 3]], cavity);
    let filled = Solid::from_pieces([&wall, &cuboid([2.0; 3], [8.0; 3])]).expect("pieces");
    for outer in [&with_piece, &with_sheet, &filled] {
        assert_eq!(common(&pair(&inner, outer)).relation, Relation::MovingContained);
        assert_eq!(common(&pair(outer, &inner)).relation, Relation::FixedContained);
    }
    let found = common(&pair(&inner, &wall));
    assert!(matches!(found.relation, Relation::PartlyContained(_)), "{found:?}");
    assert!(found.volume[0] <= 56.0 && 56.0 <= found.volume[1], "{found:?}");
}

#[test]
fn a_pin_too_large_for_its_hole_is_as_deep_as_the_layer_is_thick() {
    // The cubes of the search are a hundred times as large as the layer.
    let hole: Vec<DVec3> = ring(32, 1.0, 0.0).collect();
    let sleeve = block([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]);
    let sleeve = solid(&sleeve.joined(&extruded(&hole, [-0.5, 0.5]).reversed()));
    for (radius, angle) in [(1.001, 0.0), (1.01, 0.05), (1.000_01, 0.0)] {
        let turned = DQuat::from_rotation_z(angle);
        let pin: Vec<DVec3> = ring(32, radius, 0.0).map(|p| turned * p).collect();
        let pin = solid(&extruded(&pin, [-0.4, 0.4]));
        let thickness = (radius - 1.0) * (TAU / 64.0).cos();
        for both in [pair(&pin, &sleeve), pair(&sleeve, &pin)] {
            let depth = both.depth().expect("a depth");
            assert!(depth.lower > 0.9 * thickness, "{depth:?}, {thickness}");
            let Some(InnerPair::Balls { center, radii }) = depth.inner else {
                continue;
            };
            for (body, radius) in [both.moving(), both.fixed()].into_iter().zip(radii) {
                let below = body.signed_distances(Pose::IDENTITY, &[center]).expect("a point");
                assert!(below[0].upper <= -radius, "{below:?}, {radius}");
            }
        }
    }
}

#[test]
fn bodies_without_interior_have_no_depth() {
    let cube = cuboid([0.0; 3], [10.0; 3]);
    let ends = [DVec3::new(5.0, 5.0, -5.0), DVec3::new(5.0, 5.0, 5.0)];
    let segment = ConvexPolyhedron::from_points(&ends).expect("a segment");
    let segment = segment.as_surface().expect("a facet without area").clone();
    for thin in [square_sheet(9.0), segment] {
        for both in [pair(&thin, &cube), pair(&cube, &thin)] {
            let found = common(&both);
            assert!(matches!(found.relation, Relation::Crossing(_)), "{found:?}");
            assert_eq!(found.volume[0], 0.0);
            let depth = both.depth().expect("a depth");
            assert_eq!((depth.bounds(), depth.direction), ([0.0; 2], DVec3::ZERO));
        }
    }
}

#[test]
fn a_thin_rotated_plate_inside_has_its_own_volume() {
    let cube = cuboid([-2.0; 3], [2.0; 3]);
    for seed in 0..cases(20) {
        let mut random = Random::new(seed);
        let thickness = random.pick(&[1e-3, 1e-6]);
        let plate = cuboid([0.0; 3], [1.0, 1.0, thickness]);
        let pose = Pose::new(random.rotation(), DVec3::splat(0.1)).expect("a pose");
        let both = Pair::new(plate.at(pose), cube.at(Pose::IDENTITY)).expect("a pair");
        let found = common(&both);
        assert_eq!(found.relation, Relation::MovingContained);
        assert!(found.is_accurate && found.point.is_some(), "{found:?}");
        assert!(found.volume[0] <= thickness && thickness <= found.volume[1], "{found:?}");
        let bounds = found.bounds.expect("a box");
        for corner in plate.vertices().iter().map(|v| pose.transform_point(*v)) {
            assert!(bounds.low.cmple(corner).all() && corner.cmple(bounds.high).all());
        }
    }
}

#[test]
fn bounds_hold_with_few_cells() {
    for seed in 0..cases(100) {
        let mut random = Random::new(seed);
        let (moving, fixed) = (Polycube::random(&mut random), Polycube::random(&mut random));
        let by = quarters(&mut random, -8, 8);
        let exact: f64 = moving.lows().map(|low| fixed.common_volumes(low + by, 0.0)).sum();
        let both = Pair::new(moving.solid.at(at(by)), fixed.solid.at(Pose::IDENTITY));
        let both = both.expect("a pair");
        for max_cells in [1, 2, 10, 100] {
            let options = VolumeOptions::default().with_max_cells(max_cells);
            let found = both.common_part(options).expect("a common part");
            assert!(found.cells <= max_cells);
            assert!(found.volume[0] <= exact && exact <= found.volume[1], "{seed}: {found:?}");
        }
    }
}

#[test]
fn answers_far_from_the_origin_are_those_near_it() {
    let far = DVec3::new(1e6, -3e6, 2e6);
    for seed in 0..cases(60) {
        let mut random = Random::new(seed);
        let (moving, fixed) = (Polycube::random(&mut random), Polycube::random(&mut random));
        let by = quarters(&mut random, -8, 8);
        let [near, away] = [DVec3::ZERO, far].map(|far| {
            let both = Pair::new(moving.solid.at(at(by + far)), fixed.solid.at(at(far)));
            let both = both.expect("a pair");
            let (common, depth) = (common(&both), both.depth().expect("a depth"));
            assert!(!overlap_after(&both, &depth), "{seed}: {depth:?}");
            (common, depth)
        });
        assert_eq!(near.0.relation, away.0.relation, "{seed}");
        assert_eq!(near.0.volume, away.0.volume, "{seed}");
        assert_eq!(near.0.point.is_some(), away.0.point.is_some(), "{seed}");
        let exact = exact_squared_depth(&moving, &fixed, by).sqrt();
        assert!(away.1.lower <= exact && exact <= away.1.upper, "{seed}: {exact} {:?}", away.1);
    }
}

#[test]
fn depths_of_rounded_solids_add_the_radii() {
    let [a, b] = [cuboid([0.0; 3], [2.0; 3]), cuboid([0.0; 3], [4.0; 3])];
    let round = |solid: &Solid, radius: f64| solid.clone().rounded(radius).expect("a radius");
    for (shift, exact) in [(4.25, 0.5), (4.75, 0.0), (3.5, 1.25), (2.0, 2.75)] {
        let (moving, fixed) = (round(&a, 0.25), round(&b, 0.5));
        let there = at(DVec3::new(shift, 1.0, 1.0));
        let both = Pair::new(moving.at(there), fixed.at(Pose::IDENTITY)).expect("a pair");
        let found = both.depth().expect("a depth");
        assert!(found.lower <= exact && exact <= found.upper, "{shift}: {found:?}");
        assert!(found.upper <= exact + 1e-9 && found.lower >= 0.6 * exact - 1e-9, "{found:?}");
        let common = both.common_part(VolumeOptions::default());
        assert!(common.is_err_and(|e| e.to_string().contains("radius")));
    }
}

#[test]
fn depth_of_a_rounded_body_at_a_plain_one_needs_an_interior() {
    let round = cuboid([0.0; 3], [2.0; 3]).rounded(0.5).expect("a radius");
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let square = ConvexPolyhedron::from_points(&corners.map(|[x, y]| DVec3::new(x, y, 0.0)));
    let square = square.expect("a square").as_solid().expect("two sides").clone();
    let below = cuboid([0.0, 0.0, -1.0], [2.0, 2.0, 0.0]);
    let above = at(DVec3::Z * 0.2);
    for (plain, depth) in [(&square, 0.0), (&below, 0.3)] {
        let both = Pair::new(round.at(above), plain.at(Pose::IDENTITY)).expect("a pair");
        let turned = Pair::new(plain.at(Pose::IDENTITY), round.at(above)).expect("a pair");
        for both in [both, turned] {
            let found = both.depth().expect("a depth");
            assert!(found.lower <= depth && depth <= found.upper, "{found:?}");
            assert!(found.lower >= depth - 1e-12, "{found:?}");
        }
    }
    // Only the open shell is near.
    let mesh = block([0.0, 0.0, -9.0], [2.0, 2.0, -8.0]);
    let sheet = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
    let vertices: Vec<DVec3> = mesh.vertices.iter().copied().chain(sheet).collect();
    let first = mesh.vertices.len() as u32;
    let mut facets = mesh.faces.clone();
    facets.push((first..first + 4).collect());
    let mixed = Solid::from_open_mesh(&vertices, &facets).expect("an open body");
    let both = Pair::new(round.at(above), mixed.at(Pose::IDENTITY)).expect("a pair");
    assert_eq!(both.depth().expect("a depth").lower, 0.0);
}

/// The top of the plate dips below its bottom near the middle, by less than the tolerance of convexity.
#[test]
fn volume_of_a_contained_plate_that_crosses_itself_is_that_inside() {
    let ring = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let at_height = |z: f64| ring.map(|[x, y]| DVec3::new(x, y, z));
    let vertices: Vec<DVec3> = [at_height(0.0), at_height(1e-11)]
        .concat()
        .into_iter()
        .chain([DVec3::Z * -1.5e-11])
        .collect();
    let mut facets: Vec<Vec<u32>> = vec![vec![0, 2, 1], vec![0, 3, 2]];
    for k in 0..4 {
        let next = (k + 1) % 4;
        facets.push(vec![k, next, next + 4, k + 4]);
        facets.push(vec![k + 4, next + 4, 8]);
    }
    let plate = Solid::from_mesh(&vertices, &facets).expect("a plate");
    let found = common(&pair(&plate, &cuboid([-1.0; 3], [1.0; 3])));
    let exact = 3.466_666_666_666_667e-12;
    assert!(found.volume[0] <= exact && exact <= found.volume[1], "{found:?}");
}

#[test]
fn boxes_inside_thin_bodies_far_away_are_not_reversed() {
    let far = Pose::from_translation(DVec3::new(1e12, 1e12, 0.0)).expect("a pose");
    let rod = cuboid([-5e-5, -5e-5, 0.0], [5e-5, 5e-5, 40.0]);
    let slab = block([-100.0, -100.0, -15.0], [100.0, 100.0, 15.0]);
    let slab = solid(&slab.joined(&block([300.0; 3], [301.0; 3])));
    let both = Pair::new(rod.at(far), slab.at(far)).expect("a pair");
    let found = both.depth().expect("a depth");
    if let Some(InnerPair::Boxes { moving, fixed }) = found.inner {
        assert!(moving.low.cmplt(moving.high).all() && fixed.low.cmplt(fixed.high).all());
    }
    assert!(0.0 <= found.lower && found.lower <= 15.0 && found.upper >= 15.0 - 1e-9, "{found:?}");
}

/// A prism around the z axis whose radius at corner `k` and angle are given, from height 0 to `height`.
fn star(radii: &[f64], height: f64) -> Solid {
    let count = radii.len();
    let corner = |k: usize, z: f64| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        DVec3::new(radii[k] * angle.cos(), radii[k] * angle.sin(), z)
    };
    let vertices: Vec<DVec3> =
        [0.0, height].iter().flat_map(|&z| (0..count).map(move |k| corner(k, z))).collect();
    let n = count as u32;
    let mut facets: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    facets.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    Solid::from_mesh(&vertices, &facets).expect("a prism")
}

/// Returns the area of the intersection of two rings of triangles around the origin, at equal angles.
fn common_area(first: &[f64], second: &[f64]) -> f64 {
    let count = first.len();
    let step = std::f64::consts::TAU / count as f64;
    // Along a ray between two corners the radius of the chord is `sin(step) / (sin(step - t) / r + sin(t) / s)`.
    let inverse = |radii: &[f64], k: usize, t: f64| {
        ((step - t).sin() / radii[k] + t.sin() / radii[(k + 1) % count]) / step.sin()
    };
    let parts = 20_000;
    let area = |k: usize| -> f64 {
        let at = |j: usize| {
            let t = step * (j as f64 + 0.5) / f64::from(parts);
            0.5 * inverse(first, k, t).max(inverse(second, k, t)).powi(-2)
        };
        (0..parts as usize).map(at).sum::<f64>() * step / f64::from(parts)
    };
    (0..count).map(area).sum()
}

/// The common part of two stars at one place is a prism. Its top and bottom are flat contacts of both bodies.
#[test]
fn volume_of_stars_with_common_planes_is_that_of_their_section() {
    for seed in 0..cases(40) {
        let mut random = Random::new(seed);
        let count = 5 + random.index(30);
        let radii = [0, 1].map(|_| (0..count).map(|_| random.range(0.5, 1.0)).collect::<Vec<_>>());
        let height = random.pick(&[1.0, 1e-3, 1e-7]);
        let [a, b] = [star(&radii[0], height), star(&radii[1], height)];
        let pose = Pose::new(random.rotation(), random.vector()).expect("a pose");
        let found = common(&Pair::new(a.at(pose), b.at(pose)).expect("a pair"));
        let exact = height * common_area(&radii[0], &radii[1]);
        let [lower, upper] = found.volume;
        assert!(
            lower <= exact * (1.0 + 1e-6) && exact * (1.0 - 1e-6) <= upper,
            "{seed}: {exact} {found:?}"
        );
        // Rounding errors are relative to the size of the bodies, not to their thickness.
        let is_close = upper - lower <= 1e-4 * lower;
        assert!(is_close || height < 1e-6, "{seed}: {exact} {found:?}");
    }
}

/// Stars whose corners are nearly on a circle have slivers as facets of the top and the bottom.
#[test]
fn volumes_of_slivers_agree_with_those_of_both_parts() {
    for seed in 0..cases(20) {
        let mut random = Random::new(seed);
        let radii: Vec<f64> = (0..60).map(|_| 1.0 + random.range(0.0, 1e-9)).collect();
        let whole = star(&radii, 1.0);
        let pose = Pose::new(random.rotation(), random.vector() * 1e3).expect("a pose");
        let cut = random.range(0.1, 0.9);
        let parts = [(-5.0, cut), (cut, 5.0)].map(|(low, high)| {
            let half = cuboid([-5.0, -5.0, low], [5.0, 5.0, high]);
            common(&Pair::new(whole.at(pose), half.at(pose)).expect("a pair")).volume
        });
        let [least, most] = whole.volume_bounds().expect("closed");
        let [lower, upper] = [0, 1].map(|k| parts[0][k] + parts[1][k]);
        assert!(lower <= most && least <= upper && upper - lower < 1e-5, "{seed}: {parts:?}");
    }
}

/// A bipyramid whose base runs around its axis twice bends outwards at each edge, but has the winding number 2.
#[test]
fn volume_of_a_bipyramid_over_a_star_polygon_counts_each_point_once() {
    for corners in [11, 21, 41_u32] {
        let at = |k: u32| {
            let angle = f64::from(k) / f64::from(corners) * std::f64::consts::TAU;
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        };
        let vertices: Vec<DVec3> = (0..corners).map(at).chain([DVec3::Z, DVec3::NEG_Z]).collect();
        let next = |k: u32| (k + 2) % corners;
        let facets: Vec<[u32; 3]> =
            (0..corners).flat_map(|k| [[k, next(k), corners], [next(k), k, corners + 1]]).collect();
        let double = Solid::from_mesh(&vertices, &facets).expect("a closed surface");
        let hull = ConvexPolyhedron::from_points(&vertices).expect("a hull");
        assert!(double.volume() > 1.5 * hull.volume());
        for room in [cuboid([-3.0; 3], [3.0; 3]), cuboid([-2.8, -1.5, 0.1], [0.2, 1.5, 0.9])] {
            let most = common(&pair(hull.as_solid().expect("a solid"), &room)).volume[1];
            let [lower, upper] = common(&pair(&double, &room)).volume;
            assert!(lower <= most && lower <= upper, "{corners}: {lower} {upper} {most}");
        }
        // The outline of the star has corners at two radii.
        let [step, turn] = [1.0, 2.0].map(|k| k * std::f64::consts::PI / f64::from(corners));
        let exact = 2.0 / 3.0 * f64::from(corners) * step.sin() * turn.cos() / step.cos();
        let [lower, upper] = common(&pair(&double, &cuboid([-3.0; 3], [3.0; 3]))).volume;
        let is_right = lower <= exact * (1.0 + 1e-12) && exact * (1.0 - 1e-12) <= upper;
        assert!(is_right && upper - lower < 1e-6, "{corners}: {lower} {exact} {upper}");
    }
}

/// Overlapping pieces have the winding number 2, and an open shell has none.
#[test]
fn volumes_of_unions_and_open_bodies_count_each_point_once() {
    let low = block([0.0; 3], [2.0, 2.0, 2.0]);
    let other = block([1.0, 0.5, 0.5], [3.0, 1.5, 1.5]);
    let pieces = solid(&low.clone().joined(&other));
    let room = cuboid([0.25, -1.0, -1.0], [2.5, 3.0, 3.0]);
    let found = common(&pair(&pieces, &room));
    assert!(found.volume[0] <= 7.5 && 7.5 <= found.volume[1] && found.is_accurate, "{found:?}");
    let sheet = [[0.5, 0.5], [4.0, 0.5], [4.0, 4.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let vertices: Vec<DVec3> = low.vertices.iter().copied().chain(sheet).collect();
    let first = low.vertices.len() as u32;
    let mut facets = low.faces.clone();
    facets.push((first..first + 3).collect());
    let open = Solid::from_open_mesh(&vertices, &facets).expect("an open body");
    let found = common(&pair(&open, &room));
    assert!(found.volume[0] <= 7.0 && 7.0 <= found.volume[1] && found.is_accurate, "{found:?}");
}

/// Three pieces overlap each other, and two of them touch along a face. The volume of their union in a box follows by
/// inclusion and exclusion. The rotation is rounded.
#[test]
fn volumes_of_pieces_that_overlap_and_touch_are_close() {
    let boxes = [
        [[0.0, 0.0, 0.0], [3.0, 2.0, 2.0]],
        [[1.0, 0.5, -1.0], [2.0, 3.0, 1.0]],
        [[0.5, 1.0, 0.5], [4.0, 2.5, 1.5]],
        [[3.0, 0.0, 0.0], [4.0, 2.0, 2.0]],
    ];
    let pieces = boxes.map(|[low, high]| cuboid(low, high));
    let union = Solid::from_pieces(&pieces).expect("pieces");
    for seed in 0..cases(20) {
        let mut random = Random::new(seed);
        let [p, q] = [0, 1].map(|_| quarters(&mut random, -4, 16));
        let room = [p.min(q) - 0.25, p.max(q) + 0.25];
        let exact: f64 = (1..16_u32)
            .map(|chosen| {
                let chosen_boxes = boxes.iter().zip(0..).filter(|(_, k)| chosen >> k & 1 == 1);
                let [low, high] = chosen_boxes.fold(room, |[low, high], ([from, to], _)| {
                    [low.max(DVec3::from_array(*from)), high.min(DVec3::from_array(*to))]
                });
                let volume = (high - low).max(DVec3::ZERO).element_product();
                if chosen.count_ones() % 2 == 1 { volume } else { -volume }
            })
            .sum();
        let room = cuboid(room[0], room[1]);
        let pose = Pose::new(random.rotation(), random.vector()).expect("a pose");
        for pose in [Pose::IDENTITY, pose] {
            for [a, b] in [[&union, &room], [&room, &union]] {
                let both = Pair::new(a.at(pose), b.at(pose)).expect("a pair");
                let found = common(&both);
                let [lower, upper] = found.volume;
                let is_right = lower <= exact + 1e-12 && exact - 1e-12 <= upper;
                assert!(is_right, "{seed}: {exact} {found:?}");
                let is_close = upper - lower <= 1e-5 * exact || exact == 0.0;
                assert!(is_close, "{seed}: {exact} {found:?}");
            }
        }
    }
}

#[test]
fn volume_of_crossed_thin_plates_of_equal_pieces_is_that_of_single_ones() {
    let plate = cuboid([-1.0, -0.7, -0.001], [1.0, 0.7, 0.001]);
    let double = Solid::from_pieces([&plate, &plate]).expect("two pieces");
    for seed in 0..cases(8) {
        let mut random = Random::new(seed);
        let poses =
            [0, 1].map(|_| Pose::new(random.rotation(), random.vector() * 0.2).expect("a pose"));
        let of = |body: &Solid| {
            common(&Pair::new(body.at(poses[0]), body.at(poses[1])).expect("a pair"))
        };
        let (single, double) = (of(&plate), of(&double));
        let close =
            |found: &CommonPart| found.volume[1] - found.volume[0] <= 0.01 * found.volume[0];
        assert!(close(&single) && close(&double), "{seed}: {single:?} {double:?}");
        let [one, two] = [single.volume, double.volume];
        assert!(one[0] <= two[1] && two[0] <= one[1], "{seed}: {single:?} {double:?}");
    }
}

#[test]
fn volume_of_a_rotated_cube_with_tiny_coordinates_is_bounded() {
    // A corner of the rotated cube has a component below the smallest magnitude, which is set to 0.
    let s = 2.0_f64.powi(-199);
    let cube = cuboid(DVec3::splat(-s), DVec3::splat(s));
    let half = cuboid(DVec3::new(-8.0, -8.0, 0.0) * s, DVec3::splat(8.0) * s);
    let turned = Pose::new(DQuat::from_rotation_z(30.0_f64.to_radians()), DVec3::ZERO);
    let both = Pair::new(cube.at(turned.expect("a pose")), half.at(Pose::IDENTITY));
    let [lower, upper] = common(&both.expect("a pair")).volume;
    let exact = 4.0 * s.powi(3);
    assert!(lower <= exact && exact <= upper, "{} {}", lower / exact, upper / exact);
}

#[test]
fn volume_of_parts_that_are_flush_along_an_oblique_plane_is_close() {
    // The roof over the square has a face with the normal (4, 0, 3), in the plane of a face of a larger roof.
    let roof = |size: f64| {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 4.0]];
        let points = [0.0, size].map(|y| corners.map(|[x, _, z]| DVec3::new(x, y, z)));
        ConvexPolyhedron::from_points(&points.concat()).expect("a prism")
    };
    let low = ConvexPolyhedron::cuboid(DVec3::new(-1.0, 0.0, -2.0), DVec3::new(1.0, 5.0, 1.0));
    let low = low.expect("a box");
    let first = Solid::from_pieces([&roof(4.0), &low]).expect("a solid");
    let second = Solid::from_pieces([&roof(2.0)]).expect("a solid");
    let exact = 12.0;
    for y in [0.0, 0.5, 1.0] {
        let pose = Pose::from_translation(DVec3::new(0.0, y, 0.0)).expect("a pose");
        let both = Pair::new(second.at(pose), first.at(Pose::IDENTITY)).expect("a pair");
        let [lower, upper] = common(&both).volume;
        assert!(lower <= exact && exact <= upper, "{y}: {lower} {upper}");
        assert!(upper - lower <= 1e-6 * exact, "{y}: {lower} {upper}");
    }
}
