//! Support points of bodies whose faces or vertices have many neighbours, compared with a scan of every vertex.

use std::cell::Cell;
use std::f64::consts::TAU;

use glam::DVec3;

use super::bodies::{Random, cone, prism};
use crate::body::ConvexPolyhedron;
use crate::body::convex::fan::{AboveQuery, cyclic_maximum};

/// Builds a frustum over a polygon with its corners on an ellipse, most of them close together.
fn crowded_frustum(around: usize, random: &mut Random) -> ConvexPolyhedron {
    let mut angles: Vec<f64> =
        (0..around).map(|_| random.within(0.0, 1.0).powi(8) * 0.999 * TAU).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| *a - *b < 1e-3 / around as f64);
    let ring = |radius: f64, z: f64| {
        let point = move |a: &f64| DVec3::new(3.0 * radius * a.cos(), radius * a.sin(), z);
        angles.iter().map(point).collect::<Vec<_>>()
    };
    ConvexPolyhedron::from_points(&[ring(1.0, -1.0), ring(0.7, 1.0)].concat()).unwrap()
}

/// Returns a direction: any, across the axis, along it, or near it. Near the axis, a small change of the direction
/// moves the support point around the whole base.
fn sample_direction(random: &mut Random, k: usize) -> DVec3 {
    let lateral = random.unit().with_z(0.0);
    let up = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    match k / 2 % 4 {
        0 => random.unit(),
        1 => lateral,
        2 => DVec3::Z * up,
        _ => lateral * 10_f64.powf(random.within(-12.0, 0.0)) + DVec3::Z * up,
    }
}

#[test]
fn support_point_on_rims_is_farthest_vertex() {
    let mut random = Random(41);
    let scales = [DVec3::ONE, DVec3::new(1.0, 4.0, 0.01), DVec3::new(0.1, 0.2, 30.0)];
    let mut bodies = Vec::new();
    for around in [24, 33, 100, 1_500] {
        bodies.extend(scales.map(|scale| prism(around, scale)));
        bodies.extend(scales.map(|scale| cone(around, scale)));
        bodies.push(crowded_frustum(around, &mut random));
    }
    for (i, body) in bodies.iter().enumerate() {
        let vertices = body.vertices();
        let size = vertices.iter().fold(DVec3::ZERO, |m, v| m.max(v.abs()));
        for k in 0..400 {
            let d = sample_direction(&mut random, k);
            let farthest = vertices.iter().map(|v| d.dot(*v)).fold(f64::NEG_INFINITY, f64::max);
            let near = random.index(vertices.len()) as u32;
            for found in [body.support(d).0, body.support_point_from(d, near)] {
                let short = farthest - d.dot(vertices[found as usize]);
                // Corners are rounded. Therefore coordinates along the boundary may deviate by this amount.
                let rounding = 64.0 * f64::EPSILON * d.abs().dot(size);
                assert!(
                    short <= rounding,
                    "body {i}, along {d}: shortfall {short:e}, tolerated {rounding:e}"
                );
            }
        }
    }
}

/// The fan visits every neighbour above the level of a query. The cones are round, flat, tall, rounded at the base
/// or far from the origin. For steep tips, it visits only a few neighbours more.
#[test]
fn fan_visits_all_neighbours_above_level() {
    let mut random = Random(43);
    let mut asked = 0;
    // Visits and queries at steep tips, for base corners rounded by 0 and by increasing amounts.
    let mut few = [[0; 2]; 4];
    for around in [40, 300, 3_000] {
        for height in [1e-6, 1e-2, 1.0, 50.0] {
            for (rounding, few) in [0.0, 1e-15, 1e-7, 1e-4].into_iter().zip(&mut few) {
                let far = [0.0, 1e6][random.index(2)];
                let rim = |k: usize| {
                    let angle = k as f64 / around as f64 * TAU;
                    let radius = 1.0 - rounding * random.within(0.0, 1.0);
                    let z = 1e-2 * height * rounding * random.within(0.0, 1.0);
                    DVec3::new(far + 1.3 * radius * angle.cos(), radius * angle.sin(), z)
                };
                let mut points: Vec<DVec3> = (0..around).map(rim).collect();
                points.push(DVec3::new(far + 0.1, 0.2, height));
                let body = ConvexPolyhedron::from_points(&points).unwrap();
                let apex = body.support(DVec3::Z).0;
                let neighbours = body.neighbours(apex);
                if neighbours.len() <= super::super::fan::MAX_SCANNED_NEIGHBOURS {
                    continue;
                }
                let here = body.vertices()[apex as usize];
                for k in 0..60 {
                    // Planes through two neighbours, or near one.
                    let edge = |w: u32| body.vertices()[w as usize] - here;
                    let at = random.index(neighbours.len());
                    let [a, b] = [at, at + 1].map(|k| edge(neighbours[k % neighbours.len()]));
                    let tilt = random.unit() * 10_f64.powf(random.within(-17.0, -3.0));
                    let normal = (b.cross(a).normalize() + tilt * f64::from(k % 3)).normalize();
                    let least = -[0.0, 1e-15, 1e-9, 1e-3][random.index(4)];
                    let above = AboveQuery { normal, length: 1.0, here, least, reach: 60.0 + far };
                    let mut seen = Vec::new();
                    let fan = body.support.fan_of_vertex(apex);
                    let mut look = |w: u32| {
                        seen.push(w);
                        true
                    };
                    assert!(fan.visit_above(&body.vertices, &body.topology, &above, &mut look));
                    let is_above = |w: &&u32| normal.dot(edge(**w)) > least;
                    for w in neighbours.iter().filter(is_above) {
                        assert!(seen.contains(w), "{around}, {height}, {rounding}: {w}");
                        asked += 1;
                    }
                    if height >= 1.0 && least > -1e-9 {
                        few[0] += seen.len();
                        few[1] += 1;
                    }
                    assert!(seen.len() <= neighbours.len() + 1, "{} visits", seen.len());
                }
            }
        }
    }
    assert!(asked > 1_000, "only {asked} neighbours above the level");
    println!("{asked} neighbours above; visits and queries {few:?}");
    for [looks, planes] in few {
        assert!(looks < 16 * planes, "{looks} visits for {planes} queries");
    }
}

/// The search finds the maximum from every start, with a number of evaluations that is logarithmic in its distance.
#[test]
fn greatest_near_finds_maximum_from_any_start() {
    let mut random = Random(44);
    for count in [33, 34, 100, 4_097] {
        for _ in 0..200 {
            let [top, near] = [0, 1].map(|_| random.index(count));
            let bent = random.within(0.2, 5.0);
            let looks = Cell::new(0);
            let away = |i: usize| i.abs_diff(top).min(count - i.abs_diff(top));
            let value = |i: usize| {
                looks.set(looks.get() + 1);
                -(away(i) as f64 / count as f64).powf(bent)
            };
            assert_eq!(cyclic_maximum(count, near, value), top, "of {count} from {near}");
            let looks = looks.get();
            let most = 3 + 8 * (away(near) as f64 + 1.0).log2() as usize;
            assert!(looks <= most, "{looks} evaluations at distance {}", away(near));
        }
    }
}
