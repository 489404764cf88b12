//! Triangles and volumes against exact distances of their corners' hulls.

use colltrans_testkit::oracle::distance::distance;
use colltrans_testkit::oracle::exact::Vector;
use colltrans_testkit::random::Random;
use glam::{DMat3, DVec3};

use super::obb::Obb;
use super::rss::{Rectangle, Rss};
use super::tree::{Content, Tree};
use super::triangle::{self, Triangle};
use super::{Scale, frame};

fn exactly(a: &[DVec3], b: &[DVec3]) -> f64 {
    let exact = |points: &[DVec3]| points.iter().map(|p| Vector::new(*p)).collect::<Vec<_>>();
    distance(&exact(a), &exact(b)).to_f64()
}

fn scale(a: &[DVec3], b: &[DVec3]) -> Scale {
    let reach = |points: &[DVec3]| points.iter().map(|p| p.length()).fold(0.0, f64::max);
    Scale::new(reach(a) + reach(b))
}

fn random(rng: &mut Random) -> Triangle {
    [0; 3].map(|_| rng.vector())
}

/// Returns a triangle that is a needle: along an edge, at a corner, or a segment up to rounding.
fn sliver(rng: &mut Random) -> Triangle {
    let (start, end) = (rng.vector(), rng.vector());
    let at = rng.pick(&[0.0, 0.3, 0.5, 1.0]);
    let width = rng.pick(&[0.0, 1e-3, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15]);
    [start, end, start.lerp(end, at) + rng.vector() * width]
}

/// Returns two triangles in a difficult configuration.
fn pair(rng: &mut Random) -> (Triangle, Triangle) {
    let (mut a, mut b) = match rng.int(0, 3) {
        0 => (random(rng), random(rng)),
        1 => (sliver(rng), sliver(rng)),
        2 => (sliver(rng), random(rng)),
        _ => ([0; 3].map(|_| rng.grid(-2, 2)), [0; 3].map(|_| rng.grid(-2, 2))),
    };
    match rng.int(0, 11) {
        // A segment, a point.
        9 => b[1] = b[0],
        10 => b = [b[0]; 3],
        // A point beyond the sharp corner of a needle.
        11 => {
            a[2] = a[1] + rng.vector() * rng.pick(&[1e-3, 1e-6, 1e-8]);
            b = [a[0] - (a[1] - a[0]) * rng.pick(&[1e-6, 1e-9, 1e-12]); 3];
        }
        0 => b[0] = a[1],
        1 => (b[0], b[1]) = (a[1], a[2]),
        // Parallel planes, or the same one.
        2 => b = a.map(|p| p + DVec3::Z * rng.pick(&[0.0, 1e-9, 0.5])),
        3 => {
            let height = rng.pick(&[0.0, 1e-12, 0.25]);
            a = a.map(|p| p.with_z(0.0));
            b = b.map(|p| p.with_z(height));
        }
        // Parallel edges, nearly parallel ones.
        4 => b[1] = b[0] + (a[1] - a[0]) * rng.pick(&[0.5, 1.0, -2.0]),
        5 => b[1] = b[0] + (a[1] - a[0]) + rng.vector() * rng.pick(&[1e-4, 1e-8, 1e-12]),
        // A corner on the face, near it, on an edge.
        6 => b[2] = (a[0] + a[1] + a[2]) / 3.0 + rng.vector() * rng.pick(&[0.0, 1e-8, 1e-13]),
        7 => b[2] = a[0].midpoint(a[1]),
        _ => {}
    }
    let shift = rng.vector() * rng.pick(&[0.0, 0.0, 1.0, 10.0]);
    b = b.map(|p| p + shift);
    (a, b)
}

#[test]
fn distance_of_triangles_is_exact() {
    let mut rng = Random::new(1);
    for case in 0..20_000 {
        let (a, b) = pair(&mut rng);
        let scale = scale(&a, &b);
        let exact = exactly(&a, &b);
        let found = triangle::nearest_of_triangles(&a, &b, scale);
        let error = (found.squared.sqrt() - exact).abs();
        assert!(
            error <= 0.125 * scale.noise(),
            "{case}: {found:?}, exactly {exact:e}: {a:?} {b:?}"
        );
        let between = (found.on_a.distance(found.on_b) - exact).abs();
        assert!(between <= 0.25 * scale.noise(), "{case}: {found:?}, exactly {exact:e}");
        for (point, t) in [(found.on_a, a), (found.on_b, b)] {
            let off = exactly(&[point], &t);
            assert!(off <= 0.25 * scale.noise(), "{case}: {off:e} off: {found:?} {a:?} {b:?}");
        }
    }
}

#[test]
fn intersection_of_triangles_is_exact() {
    let mut rng = Random::new(2);
    let mut counts = [0; 2];
    for case in 0..20_000 {
        let (a, b) = pair(&mut rng);
        let scale = scale(&a, &b);
        let exact = exactly(&a, &b);
        let found = triangle::triangles_intersect(&a, &b, scale);
        if exact == 0.0 || exact > 2.0 * scale.noise() {
            assert_eq!(found, exact == 0.0, "{case}: {exact:e} {a:?} {b:?}");
            counts[usize::from(found)] += 1;
        }
    }
    assert!(counts.iter().all(|n| *n > 2_000), "{counts:?}");
}

fn cloud(rng: &mut Random) -> Vec<Triangle> {
    let stretch = DVec3::from_array([0; 3].map(|_| rng.pick(&[1.0, 1.0, 0.3, 1e-3, 0.0])));
    let turn = DMat3::from_quat(rng.rotation());
    let at = rng.vector() * rng.pick(&[0.0, 1.0, 3.0]);
    let count = rng.int(1, 6);
    let mut one = || match rng.int(0, 2) {
        0 => sliver(rng),
        _ => random(rng),
    };
    (0..count).map(|_| one().map(|p| turn * (p * stretch) + at)).collect()
}

fn axes(triangles: &[Triangle]) -> DMat3 {
    match triangles {
        [one] => frame::of_triangle(one),
        many => frame::of_points(many.as_flattened()),
    }
}

fn along(axes: DMat3, triangles: &[Triangle]) -> Vec<DVec3> {
    triangles.iter().flatten().map(|p| axes.transpose() * *p).collect()
}

fn rectangle(rss: &Rss) -> Rectangle {
    let sides = [rss.axes.x_axis, rss.axes.y_axis];
    Rectangle { sides, center: rss.center, half: rss.half }
}

fn corners(rss: &Rss) -> [DVec3; 4] {
    [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, y)| {
        rss.center + rss.axes.x_axis * (x * rss.half[0]) + rss.axes.y_axis * (y * rss.half[1])
    })
}

#[test]
fn axes_are_orthonormal_and_sorted() {
    let mut rng = Random::new(3);
    for _ in 0..5_000 {
        let triangles = cloud(&mut rng);
        let axes = axes(&triangles);
        let product = axes.transpose() * axes - DMat3::IDENTITY;
        assert!(product.to_cols_array().iter().all(|x| x.abs() < 8.0 * f64::EPSILON));
        if triangles.len() > 1 {
            let points = along(axes, &triangles);
            let mean = points.iter().sum::<DVec3>() / points.len() as f64;
            let spread: DVec3 = points.iter().map(|p| (*p - mean) * (*p - mean)).sum();
            // Where all points are the same, the spread is that of rounding.
            let slack = 1e-12 * spread.x + 1e3 * f64::EPSILON * f64::EPSILON;
            assert!(spread.x + slack >= spread.y && spread.y + slack >= spread.z, "{spread}");
            let mixed: f64 = points.iter().map(|p| (p.x - mean.x) * (p.y - mean.y)).sum();
            assert!(mixed.abs() <= slack + f64::EPSILON, "{mixed}");
        }
    }
}

#[test]
fn swept_spheres_contain_their_triangles_and_bound_distances_from_below() {
    let mut rng = Random::new(4);
    let (mut tight, mut apart) = (0, 0);
    for case in 0..4_000 {
        let sets = [cloud(&mut rng), cloud(&mut rng)];
        let [a, b] = [0, 1].map(|i| {
            let axes = axes(&sets[i]);
            Rss::fit(axes, &along(axes, &sets[i]))
        });
        let scale = scale(sets[0].as_flattened(), sets[1].as_flattened());
        for (rss, set) in [(&a, &sets[0]), (&b, &sets[1])] {
            for p in set.iter().flatten() {
                let off = exactly(&[*p], &corners(rss));
                assert!(off <= rss.radius + 0.125 * scale.noise(), "{case}: {off:e} {rss:?}");
            }
        }
        let bound = a.gap(&rectangle(&b), b.radius) - scale.noise();
        let pairs = sets[0].iter().flat_map(|s| sets[1].iter().map(move |t| (s, t)));
        let truth = pairs.map(|(s, t)| exactly(s, t)).fold(f64::INFINITY, f64::min);
        assert!(bound <= truth, "{case}: {bound:e}, exactly {truth:e}: {a:?} {b:?}");
        apart += u64::from(truth > 0.1);
        tight += u64::from(truth > 0.1 && bound > 0.5 * truth);
    }
    assert!(tight * 2 > apart, "{tight} of {apart}");
}

/// Returns random and aligned rectangles, also degenerate ones.
fn rectangles(rng: &mut Random) -> [Rss; 2] {
    let aligned = rng.one_in(3);
    let first = DMat3::from_quat(rng.rotation());
    [0, 1].map(|_| {
        let axes = if aligned { first } else { DMat3::from_quat(rng.rotation()) };
        let half = [0; 2].map(|_| rng.pick(&[0.0, 1e-3, 0.5, 0.5, 1.0]));
        Rss { axes, center: axes * (rng.grid(-3, 3) * 0.5), half, radius: 0.0 }
    })
}

#[test]
fn gap_of_rectangles_is_exact() {
    let mut rng = Random::new(5);
    for case in 0..20_000 {
        let [a, b] = rectangles(&mut rng);
        let (p, q) = (corners(&a), corners(&b));
        let scale = scale(&p, &q);
        let (gap, exact) = (a.gap(&rectangle(&b), 0.0), exactly(&p, &q));
        assert!(gap <= exact + 0.5 * scale.noise(), "{case}: {gap:e} {exact:e} {a:?} {b:?}");
        // A direction that is wrong by noise / distance costs as much times a side.
        let loss = scale.noise() * (1.0 + 1.0 / exact.max(f64::MIN_POSITIVE));
        assert!(gap >= exact - 0.5 * loss, "{case}: {gap:e} {exact:e} {a:?} {b:?}");
    }
}

#[test]
fn boxes_contain_their_triangles_and_are_clear_only_if_apart() {
    let mut rng = Random::new(6);
    let mut counts = [0; 2];
    for case in 0..10_000 {
        let sets = [cloud(&mut rng), cloud(&mut rng)];
        let [(a_axes, a), (b_axes, b)] = [0, 1].map(|i| {
            let axes = axes(&sets[i]);
            (axes, Obb::fit(axes, &along(axes, &sets[i])))
        });
        let noise = scale(sets[0].as_flattened(), sets[1].as_flattened()).noise();
        for p in sets[0].iter().flatten() {
            let over = (a_axes.transpose() * (*p - a.center)).abs() - a.half;
            assert!(over.max_element() <= 0.125 * noise, "{case}: {over}");
        }
        let corners = |axes: DMat3, obb: &Obb| {
            let sign = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let corner = |i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2));
            (0..8).map(|i| obb.center + axes * (corner(i) * obb.half)).collect::<Vec<_>>()
        };
        let exact = exactly(&corners(a_axes, &a), &corners(b_axes, &b));
        let clear = a.is_clear_of(&a_axes, &b, b.center, b_axes, noise);
        assert!(exact > 0.0 || !clear, "{case}: {a:?} {b:?}");
        assert!(exact < 1e-6 || clear, "{case}: {exact:e}: {a:?} {b:?}");
        counts[usize::from(clear)] += 1;
    }
    assert!(counts.iter().all(|n| *n > 1_000), "{counts:?}");
}

/// Sizes that grow by a constant factor leave one triangle on one side of every mean.
#[test]
fn trees_are_shallow_and_complete_for_every_input() {
    let mut rng = Random::new(7);
    let mut random = || rng.vector();
    let (even, same) = (random(), random());
    let at = |i: u32| DVec3::X * 2_f64.powi(i as i32 % 300 - 150);
    let sets: [&dyn Fn(u32) -> DVec3; 3] = [&at, &|_| same, &|i| even * f64::from(i)];
    for (count, set) in [1, 2, 7, 300, 5_000].iter().flat_map(|n| sets.iter().map(move |s| (*n, s)))
    {
        let triangle = |i| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| set(i) + p * 1e-60);
        let (tree, mut order) = Tree::build(count, triangle);
        assert_eq!((tree.nodes.len(), tree.boxes.len()), (2 * count - 1, 2 * count - 1));
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..count as u32));
        // log_(8/7) of the count.
        assert!(tree.levels as f64 <= 2.0 + (count as f64).ln() / (8.0_f64 / 7.0).ln());
        let leaves = tree.nodes.iter().filter_map(|n| match n.content {
            Content::Leaf(i) => Some(i),
            Content::Inner(_) => None,
        });
        assert!(leaves.eq(0..count as u32), "in preorder");
    }
}
