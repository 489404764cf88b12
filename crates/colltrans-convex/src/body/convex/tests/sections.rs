use glam::{DVec2, DVec3};

use super::bodies::{Random, cone, cuboid, ellipsoid, prism};
use crate::body::ConvexPolyhedron;
use crate::body::convex::sections::{
    ChainSearch, SectionIndex, Turn, next_clockwise, next_counter_clockwise,
};

fn test_bodies() -> Vec<ConvexPolyhedron> {
    vec![
        cuboid(DVec3::ZERO, DVec3::ONE),
        cuboid(DVec3::new(5.0, -3.0, 100.0), DVec3::new(1.0, 2.0, 3.0)),
        ellipsoid(8, DVec3::ONE),
        ellipsoid(500, DVec3::new(1.4, 0.6, 1.0)),
        ellipsoid(500, DVec3::new(1000.0, 1.0, 1.0)),
        ellipsoid(500, DVec3::new(1000.0, 1000.0, 1.0)),
        prism(1000, DVec3::ONE),
        prism(5, DVec3::new(1.0, 1.0, 1e-3)),
        cone(300, DVec3::new(1.0, 2.0, 3.0)),
    ]
}

/// Returns levels between the vertices, and levels of vertices.
fn levels(body: &ConvexPolyhedron, axis: DVec3, random: &mut Random) -> Vec<f64> {
    let of_vertices: Vec<f64> = body.vertices().iter().map(|&v| axis.dot(v)).collect();
    let low = of_vertices.iter().copied().fold(f64::INFINITY, f64::min);
    let high = of_vertices.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut levels = vec![low];
    for _ in 0..20 {
        levels.push(random.within(low, high));
        levels.push(of_vertices[random.index(of_vertices.len())]);
    }
    levels.retain(|&x| x < high);
    levels
}

/// Returns all half-edges that cross level `x` upwards.
fn crossing_edges(body: &ConvexPolyhedron, axis: DVec3, x: f64) -> Vec<u32> {
    let topology = body.topology();
    let above = |v: u32| axis.dot(body.vertices()[v as usize]) > x;
    let half_edges = 0..topology.half_edges().len() as u32;
    half_edges.filter(|&h| !above(topology.origin(h)) && above(topology.target(h))).collect()
}

#[test]
fn section_walk_visits_each_crossing_edge_once() {
    let mut random = Random(1);
    for body in test_bodies() {
        let topology = body.topology();
        for axis in crate::body::convex::sections::AXES {
            for x in levels(&body, axis, &mut random) {
                let above = |v: u32| axis.dot(body.vertices()[v as usize]) > x;
                let expected = crossing_edges(&body, axis, x);
                let mut visited = vec![expected[0]];
                loop {
                    let last = visited[visited.len() - 1];
                    let next = next_counter_clockwise(topology, last, above);
                    assert_eq!(next_clockwise(topology, next, above), last);
                    if next == visited[0] {
                        break;
                    }
                    visited.push(next);
                    assert!(visited.len() <= expected.len());
                }
                visited.sort_unstable();
                assert_eq!(visited, expected);
            }
        }
    }
}

#[test]
fn section_walk_is_counter_clockwise_seen_from_axis_tip() {
    for body in test_bodies() {
        for axis in crate::body::convex::sections::AXES {
            let centre = body.vertices().iter().sum::<DVec3>() / body.vertices().len() as f64;
            let x = axis.dot(centre);
            let above = |v: u32| axis.dot(body.vertices()[v as usize]) > x;
            let point = |h: u32| {
                let low = body.vertices()[body.topology().origin(h) as usize];
                let high = body.vertices()[body.topology().target(h) as usize];
                low + (high - low) * ((x - axis.dot(low)) / axis.dot(high - low)) - centre
            };
            let first = crossing_edges(&body, axis, x)[0];
            let mut doubled_area = 0.0;
            let mut up = first;
            loop {
                let next = next_counter_clockwise(body.topology(), up, above);
                doubled_area += axis.dot(point(up).cross(point(next)));
                up = next;
                if up == first {
                    break;
                }
            }
            assert!(doubled_area > 0.0);
        }
    }
}

#[test]
fn snapshot_entries_are_ordered_and_equally_spaced_in_linear_space() {
    let mut random = Random(2);
    for body in test_bodies() {
        let topology = body.topology();
        let index = SectionIndex::build(body.vertices(), topology);
        let per_vertex = index.heap_bytes() as f64 / body.vertices().len() as f64;
        assert!(body.vertices().len() < 100 || per_vertex < 95.0, "{per_vertex} bytes per vertex");
        for (i, axis) in crate::body::convex::sections::AXES.into_iter().enumerate() {
            let sections = index.axis(i);
            for x in levels(&body, axis, &mut random) {
                let (level, entries) = sections.snapshot_for_test(x);
                assert!(level <= x);
                let above = |v: u32| axis.dot(body.vertices()[v as usize]) > level;
                let mut strides = Vec::new();
                let mut stride = 0;
                let mut up = entries[0];
                for k in 0..crossing_edges(&body, axis, level).len() {
                    if up == entries[(strides.len() + 1) % entries.len()] && k > 0 {
                        strides.push(stride);
                        stride = 0;
                    }
                    up = next_counter_clockwise(topology, up, above);
                    stride += 1;
                }
                // All entries were found in order, and the walk is back at its start.
                assert_eq!((strides.len() + 1, up), (entries.len(), entries[0]));
                assert!(strides.iter().all(|&other| other == strides[0] && other >= stride));
            }
        }
    }
}

#[test]
fn snapshot_extremes_match_scan() {
    let mut random = Random(3);
    for body in test_bodies() {
        let index = SectionIndex::build(body.vertices(), body.topology());
        for (i, axis) in crate::body::convex::sections::AXES.into_iter().enumerate() {
            for x in levels(&body, axis, &mut random) {
                let constants = DVec2::new(random.signed(), random.signed());
                let map = index.axis(i).map([random.unit(), random.unit()], constants);
                let snapshot = index.axis(i).snapshot_below(&map, x);
                let height = |i: usize| snapshot.extrapolated_point(i).x;
                let heights: Vec<f64> = (0..snapshot.len()).map(height).collect();
                let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
                let greatest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                // Positions are rounded to f32. Therefore points next to the extreme may deviate from a convex
                // polygon.
                let size = body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
                assert!(height(snapshot.extreme_entry(1.0)) <= least + 1e-5 * size);
                assert!(height(snapshot.extreme_entry(-1.0)) >= greatest - 1e-5 * size);
            }
        }
    }
}

#[test]
fn snapshot_points_lie_on_section_halfway_to_next_vertex() {
    let mut random = Random(4);
    for body in test_bodies() {
        let index = SectionIndex::build(body.vertices(), body.topology());
        let size = body.vertices().iter().map(|v| v.length()).fold(0.0, f64::max);
        for (i, axis) in crate::body::convex::sections::AXES.into_iter().enumerate() {
            for x in levels(&body, axis, &mut random) {
                let (level, entries) = index.axis(i).snapshot_for_test(x);
                let covectors = [random.unit(), random.unit()];
                let constants = DVec2::new(random.signed(), random.signed());
                let map = index.axis(i).map(covectors, constants);
                let above = body.vertices().iter().map(|v| axis.dot(*v)).filter(|&l| l > level);
                let next = above.fold(f64::INFINITY, f64::min);
                // Between levels that differ only by rounding, edges have no points.
                if next - level < 1e-6 * size {
                    continue;
                }
                let halfway = f64::midpoint(level, next);
                let snapshot = index.axis(i).snapshot_below(&map, halfway);
                for (k, up) in entries.into_iter().enumerate() {
                    let ends = [body.topology().origin(up), body.topology().target(up)];
                    let [low, high] = ends.map(|v| body.vertices()[v as usize]);
                    let share = (halfway - axis.dot(low)) / axis.dot(high - low);
                    let point = low + (high - low) * share;
                    let expected = constants + DVec2::from_array(covectors.map(|c| c.dot(point)));
                    assert!((snapshot.extrapolated_point(k) - expected).length() < 1e-5 * size);
                }
            }
        }
    }
}

/// Returns the section at a level, counter-clockwise.
fn section_ring(body: &ConvexPolyhedron, axis: DVec3, x: f64) -> Vec<u32> {
    let above = |v: u32| axis.dot(body.vertices()[v as usize]) > x;
    let first = crossing_edges(body, axis, x)[0];
    let next = |&up: &u32| Some(next_counter_clockwise(body.topology(), up, above));
    let rest = std::iter::successors(next(&first), next).take_while(|&up| up != first);
    std::iter::once(first).chain(rest).collect()
}

#[test]
fn chain_searches_match_section_walks() {
    let mut random = Random(5);
    for body in test_bodies() {
        let index = SectionIndex::with_chains(body.vertices(), body.topology());
        for (i, axis) in crate::body::convex::sections::AXES.into_iter().enumerate() {
            for x in levels(&body, axis, &mut random) {
                let ring = section_ring(&body, axis, x);
                let search = ChainSearch {
                    chains: index.axis(i).chains().expect("chains"),
                    topology: body.topology(),
                    x,
                    level: |v| axis.dot(body.vertices()[v as usize]),
                    count: |_| {},
                };
                // From any edge, the search finds an edge that crosses the level.
                let any = random.index(body.topology().half_edges().len()) as u32;
                assert!(ring.contains(&search.any_crossing_edge(any).expect("an edge")));
                for _ in 0..20 {
                    let (from, many) = (random.index(ring.len()), random.index(ring.len()));
                    for turn in [Turn::CounterClockwise, Turn::Clockwise] {
                        let step = if turn == Turn::Clockwise { ring.len() - 1 } else { 1 };
                        let at = |k: usize| ring[(from + k * step) % ring.len()];
                        let held: Vec<u32> = (0..=many).map(at).collect();
                        let found = search.last_while(at(0), turn, |up| held.contains(&up));
                        assert_eq!(found, Some(at(many)), "{turn:?}, {many} of {}", ring.len());
                    }
                }
            }
        }
    }
}
