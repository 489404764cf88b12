//! Sorts facets back to front for painting (painter's algorithm).
//!
//! At each sample of the page, and at points along the longest side of each facet, the covering facets determine which
//! facet must be painted before another. Facets that are visible at none of these points are removed. Facets in a
//! cycle, such as those of intersecting bodies, are cut into four, in at most [`MAX_ROUNDS`] rounds and while they are
//! larger than [`MIN_AREA`]. Cycles that remain are broken at the farthest facet. Facets of the same style are painted
//! consecutively where possible.
//!
//! Source: the sort of Newell, Newell and Sancha (1972), with its tests evaluated at samples.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::Frame;
use crate::grid::{Depth, Grid};

/// A triangle to paint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// The corners: x and y on the page, and the depth as z.
    pub corners: [DVec3; 3],
    /// The index of its style.
    pub style: u32,
    /// Whether it hides what is behind it.
    pub opaque: bool,
}

/// Maximum number of rounds in which facets are cut.
const MAX_ROUNDS: usize = 8;
/// Minimum area of facets that are cut, in square pixels.
const MIN_AREA: f64 = 2.0;
/// Maximum number of points at which a side is sampled.
const MAX_POINTS: f64 = 1e4;

/// Sorts facets back to front. The window begins at (0, 0); facets that are not visible in it are removed. Facets in
/// a cycle are cut, so the result may have more facets. Differences of depth up to the length `slack` are ignored.
pub fn sort_back_to_front(
    mut facets: Vec<Facet>,
    window: Frame,
    depth: Depth,
    slack: f64,
) -> Vec<Facet> {
    let grid = Grid::new(window, 1);
    facets.retain(|facet| facet.corners.iter().all(|corner| corner.is_finite()));
    let mut rules = PaintRules::new(&facets, &grid, depth, slack);
    for _ in 0..MAX_ROUNDS {
        let mut cut = rules.in_cycles();
        for (is_in_cycle, facet) in cut.iter_mut().zip(&facets) {
            *is_in_cycle &= facet.pixel_area() > MIN_AREA;
        }
        if !cut.contains(&true) {
            break;
        }
        let mut finer = Vec::with_capacity(facets.len());
        for (k, facet) in facets.iter().enumerate().filter(|(k, _)| rules.seen[*k]) {
            if cut[k] {
                finer.extend(facet.quarters());
            } else {
                finer.push(*facet);
            }
        }
        facets = finer;
        rules = PaintRules::new(&facets, &grid, depth, slack);
    }
    rules.paint_order(&facets).into_iter().map(|k| facets[k as usize]).collect()
}

impl Facet {
    /// Returns the area in square pixels.
    fn pixel_area(&self) -> f64 {
        let [a, b, c] = self.corners.map(DVec3::truncate);
        (b - a).perp_dot(c - a).abs() / 2.0
    }

    /// Cuts the facet into four at the midpoints of its sides.
    fn quarters(self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            .map(|corners| Self { corners, ..self })
    }

    /// Returns points along its longest side, one pixel apart, without the ends.
    fn longest_side(&self) -> impl Iterator<Item = DVec3> + use<> {
        let [a, b, c] = self.corners;
        let length = |[p, q]: [DVec3; 2]| p.truncate().distance(q.truncate());
        let [mut side, others @ ..] = [[a, b], [b, c], [c, a]];
        for other in others {
            if length(other) > length(side) {
                side = other;
            }
        }
        let count = length(side).ceil().min(MAX_POINTS);
        (0..count as usize).map(move |k| side[0].lerp(side[1], (k as f64 + 0.5) / count))
    }

    /// Returns its depth at a point of the page; `None` unless the point is inside by more than rounding.
    fn depth_inside(&self, at: DVec2) -> Option<f64> {
        let [a, b, c] = self.corners;
        let [p, q, r] = self.corners.map(DVec3::truncate);
        let twice = (q - p).perp_dot(r - p);
        let share = |p: DVec2, q: DVec2| (q - p).perp_dot(at - p) / twice;
        let [u, v, w] = [share(q, r), share(r, p), share(p, q)];
        (u.min(v).min(w) > 1e-6).then_some(u * a.z + v * b.z + w * c.z)
    }
}

/// A facet at a sample, with its depth there.
#[derive(Clone, Copy, Default)]
struct Layer {
    facet: u32,
    depth: f64,
}

/// The layers of all cells, one cell after the other, each from back to front.
struct Layers {
    starts: Vec<usize>,
    all: Vec<Layer>,
}

impl Layers {
    /// Finds the facets that cover each sample.
    fn new(facets: &[Facet], grid: &Grid) -> Self {
        let mut starts = vec![0; grid.len() + 1];
        for facet in facets {
            grid.visit_covered(facet.corners, |cell, _| starts[cell + 1] += 1);
        }
        for cell in 0..grid.len() {
            starts[cell + 1] += starts[cell];
        }
        let mut all = vec![Layer::default(); starts[grid.len()]];
        let mut next = starts.clone();
        for (k, facet) in facets.iter().enumerate() {
            grid.visit_covered(facet.corners, |cell, depth| {
                all[next[cell]] = Layer { facet: k as u32, depth };
                next[cell] += 1;
            });
        }
        for ends in starts.windows(2) {
            all[ends[0]..ends[1]].sort_by(|a, b| a.depth.total_cmp(&b.depth));
        }
        Self { starts, all }
    }

    /// Returns the layers of a cell.
    fn in_cell(&self, cell: usize) -> &[Layer] {
        &self.all[self.starts[cell]..self.starts[cell + 1]]
    }
}

/// Returns the index of the nearest opaque layer; `None` if there is none.
fn front_opaque_layer(layers: &[Layer], facets: &[Facet]) -> Option<usize> {
    layers.iter().rposition(|layer| facets[layer.facet as usize].opaque)
}

/// The visible facets, and pairs of facets of which the first must be painted before the second.
struct PaintRules {
    seen: Vec<bool>,
    before: SortedPairs,
}

impl PaintRules {
    /// Evaluates all samples, and the longest sides of all facets.
    fn new(facets: &[Facet], grid: &Grid, depth: Depth, slack: f64) -> Self {
        let layers = Layers::new(facets, grid);
        let mut rules = Self { seen: vec![false; facets.len()], before: SortedPairs::default() };
        let farther = |a: f64, b: f64| depth.distance_between(a, b) > slack;
        for cell in 0..grid.len() {
            rules.add_cell(layers.in_cell(cell), facets, farther);
        }
        for (k, facet) in facets.iter().enumerate() {
            rules.add_side(k as u32, facet.longest_side(), &layers, (facets, grid), farther);
        }
        let Self { seen, before } = &mut rules;
        // Pairs with a facet that is not visible are removed.
        before.tidy(|[first, then]| seen[*first as usize] && seen[*then as usize]);
        rules
    }

    /// Adds the pairs of neighbouring layers of a cell, and marks visible facets.
    fn add_cell(&mut self, here: &[Layer], facets: &[Facet], farther: impl Fn(f64, f64) -> bool) {
        let front = front_opaque_layer(here, facets);
        for (k, layer) in here.iter().enumerate() {
            let hider = front.filter(|front| k < *front).map(|front| &here[front]);
            if let Some(then) = hider.or_else(|| here.get(k + 1))
                && farther(layer.depth, then.depth)
            {
                self.before.push([layer.facet, then.facet]);
            }
            // A layer that touches the nearest one may be visible next to it.
            if hider.is_none_or(|hider| !farther(layer.depth, hider.depth)) {
                self.seen[layer.facet as usize] = true;
            }
        }
    }

    /// Adds the pairs of a facet and of those in front of it, at points along its longest side. Samples alone miss
    /// a facet that is too thin to cover one, or that is covered only between samples.
    fn add_side(
        &mut self,
        facet: u32,
        side: impl Iterator<Item = DVec3>,
        layers: &Layers,
        (facets, grid): (&[Facet], &Grid),
        farther: impl Fn(f64, f64) -> bool,
    ) {
        for point in side {
            let at = point.truncate();
            if !grid.contains(at) {
                continue;
            }
            let mut hidden = false;
            // A facet that covers the point need not cover the sample of its cell.
            for cell in grid.cells_around(at) {
                let here = layers.in_cell(cell);
                for layer in &here[front_opaque_layer(here, facets).unwrap_or(0)..] {
                    let other = &facets[layer.facet as usize];
                    let is_before = |depth| layer.facet != facet && farther(point.z, depth);
                    if other.depth_inside(at).is_some_and(is_before) {
                        self.before.push([facet, layer.facet]);
                        hidden |= other.opaque;
                    }
                }
            }
            self.seen[facet as usize] |= !hidden;
        }
    }

    /// Returns the facets that are in a cycle, or between cycles.
    fn in_cycles(&self) -> Vec<bool> {
        let mut left = self.seen.clone();
        remove_without_predecessors(&mut left, &self.before.all);
        let mut back: Vec<_> = self.before.all.iter().map(|&[first, then]| [then, first]).collect();
        back.sort_unstable();
        remove_without_predecessors(&mut left, &back);
        left
    }

    /// Returns the visible facets in the order of painting.
    fn paint_order(&self, facets: &[Facet]) -> Vec<u32> {
        let mut waits = predecessor_counts(&self.seen, &self.before.all);
        let near = |k: u32| facets[k as usize].corners.iter().map(|p| p.z).sum::<f64>();
        let mut farthest: Vec<u32> = (0..self.seen.len() as u32).collect();
        farthest.retain(|k| self.seen[*k as usize]);
        farthest.sort_by(|a, b| near(*a).total_cmp(&near(*b)));
        let mut ready = ReadyFacets::default();
        for &k in farthest.iter().rev().filter(|k| waits[**k as usize] == 0) {
            ready.add_facet(k, &facets[k as usize]);
        }
        let mut done = Vec::with_capacity(farthest.len());
        let mut painted = vec![false; facets.len()];
        let mut left = farthest.iter();
        // If no facet is ready, the remaining ones are in a cycle or after one.
        while let Some(k) =
            ready.next_facet(near).or_else(|| left.find(|k| !painted[**k as usize]).copied())
        {
            (painted[k as usize], waits[k as usize]) = (true, u32::MAX);
            done.push(k);
            for &[_, then] in pairs_from(&self.before.all, k) {
                let wait = &mut waits[then as usize];
                // A facet that was painted to break a cycle has no more predecessors.
                if *wait != u32::MAX {
                    *wait -= 1;
                    if *wait == 0 {
                        ready.add_facet(then, &facets[then as usize]);
                    }
                }
            }
        }
        done
    }
}

/// The facets that can be painted next, by style, the farthest last.
#[derive(Default)]
struct ReadyFacets {
    opaque: BTreeMap<u32, Vec<u32>>,
    sheer: BTreeMap<u32, Vec<u32>>,
    style: u32,
}

impl ReadyFacets {
    /// Adds a facet.
    fn add_facet(&mut self, k: u32, facet: &Facet) {
        let pool = if facet.opaque { &mut self.opaque } else { &mut self.sheer };
        pool.entry(facet.style).or_default().push(k);
    }

    /// Removes a facet of the last style. If there is none, selects the style whose next facet is the farthest.
    /// Opaque facets come as early as possible, so that their boundaries are not visible on translucent ones.
    fn next_facet(&mut self, near: impl Fn(u32) -> f64) -> Option<u32> {
        let pool = if self.opaque.is_empty() { &mut self.sheer } else { &mut self.opaque };
        if !pool.contains_key(&self.style) {
            let next = |of: &[u32]| of.last().map_or(f64::INFINITY, |k| near(*k));
            self.style = *pool.iter().min_by(|a, b| next(a.1).total_cmp(&next(b.1)))?.0;
        }
        let same = pool.get_mut(&self.style)?;
        let taken = same.pop();
        if same.is_empty() {
            pool.remove(&self.style);
        }
        taken
    }
}

/// Pairs of numbers. After [`Self::tidy`] they are sorted and unique.
#[derive(Default)]
struct SortedPairs {
    all: Vec<[u32; 2]>,
    tidied: usize,
}

impl SortedPairs {
    /// Adds a pair. Because neighbouring samples yield many duplicates, the pairs are tidied whenever their
    /// number has doubled.
    fn push(&mut self, pair: [u32; 2]) {
        self.all.push(pair);
        if self.all.len() > 2 * self.tidied + (1 << 16) {
            self.tidy(|_| true);
        }
    }

    /// Sorts the pairs, removes duplicates, and keeps those that `kept` selects.
    fn tidy(&mut self, kept: impl Fn(&[u32; 2]) -> bool) {
        self.all.sort_unstable();
        self.all.dedup();
        self.all.retain(kept);
        self.tidied = self.all.len();
    }
}

/// Returns the pairs whose first number is `first`, from sorted pairs.
fn pairs_from(pairs: &[[u32; 2]], first: u32) -> &[[u32; 2]] {
    let start = pairs.partition_point(|pair| pair[0] < first);
    let end = start + pairs[start..].partition_point(|pair| pair[0] == first);
    &pairs[start..end]
}

/// Returns for each facet the number of its predecessors in `left`.
fn predecessor_counts(left: &[bool], before: &[[u32; 2]]) -> Vec<u32> {
    let mut waits = vec![0; left.len()];
    for [first, then] in before {
        waits[*then as usize] += u32::from(left[*first as usize]);
    }
    waits
}

/// Repeatedly removes the facets without predecessors.
fn remove_without_predecessors(left: &mut [bool], before: &[[u32; 2]]) {
    let mut waits = predecessor_counts(left, before);
    let mut ready: Vec<u32> = (0..left.len() as u32).collect();
    ready.retain(|k| left[*k as usize] && waits[*k as usize] == 0);
    while let Some(k) = ready.pop() {
        left[k as usize] = false;
        for &[_, then] in pairs_from(before, k) {
            waits[then as usize] -= 1;
            if left[then as usize] && waits[then as usize] == 0 {
                ready.push(then);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;
    use crate::grid::tests::{WINDOW, cell_centre, depth_at, random_corners};

    fn opaque_facet(corners: [DVec3; 3], style: u32) -> Facet {
        Facet { corners, style, opaque: true }
    }

    fn sorted_facets(facets: &[Facet]) -> Vec<Facet> {
        sort_back_to_front(facets.to_vec(), WINDOW, Depth::Inverse, 1e-9)
    }

    /// Returns a square of two triangles.
    fn square_facets(depth: f64, style: u32, opaque: bool, [x, y, s]: [f64; 3]) -> [Facet; 2] {
        let at = |i: f64, j: f64| DVec3::new(x + i * s, y + j * s, depth);
        let halves = [
            [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)],
            [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        ];
        halves.map(|corners| Facet { corners, style, opaque })
    }

    fn styles_of(facets: &[Facet]) -> Vec<u32> {
        facets.iter().map(|facet| facet.style).collect()
    }

    /// Returns the number of cells in which the style painted last is not that of the nearest facet, and the
    /// number of covered cells.
    fn count_wrong_cells(given: &[Facet], painted: &[Facet]) -> [usize; 2] {
        let grid = Grid::new(WINDOW, 1);
        let [mut last, mut nearest] = [(); 2].map(|()| vec![None; grid.len()]);
        for facet in painted {
            grid.visit_covered(facet.corners, |cell, _| last[cell] = Some(facet.style));
        }
        for (cell, nearest) in nearest.iter_mut().enumerate() {
            let at = cell_centre(cell, &grid);
            let depths = given.iter().filter_map(|f| Some((depth_at(at, f.corners)?, f.style)));
            *nearest = depths.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, style)| style);
        }
        let other = last.iter().zip(&nearest).filter(|(a, b)| a != b).count();
        [other, nearest.iter().flatten().count()]
    }

    /// At each sample the nearest facet is painted last, also if facets intersect.
    #[test]
    fn nearest_facet_is_painted_last() {
        let mut random = Random::new(11);
        let [mut other, mut all] = [0, 0];
        for _ in 0..20 {
            let facets: Vec<Facet> =
                (0..12).map(|k| opaque_facet(random_corners(&mut random), k)).collect();
            let painted = sorted_facets(&facets);
            assert!(painted.len() < 6_000, "{} facets of 12", painted.len());
            let [a, b] = count_wrong_cells(&facets, &painted);
            (other, all) = (other + a, all + b);
        }
        // Cycles of facets as small as samples are broken.
        assert!(200 * other < all, "{other} of {all}");
    }

    /// A translucent facet is painted after the facets behind it and before those in front of it. Hidden facets
    /// are not painted.
    #[test]
    fn translucent_facets_are_painted_back_to_front() {
        let facets = [
            square_facets(3.0, 0, true, [20.0, 10.0, 20.0]),
            square_facets(2.0, 1, false, [10.0, 5.0, 25.0]),
            square_facets(1.0, 2, true, [5.0, 5.0, 20.0]),
            square_facets(0.5, 3, true, [23.0, 12.0, 10.0]),
        ];
        assert_eq!(styles_of(&sorted_facets(&facets.concat())), [2, 2, 1, 1, 0, 0]);
    }

    /// Both are kept, because either may be visible next to the other.
    #[test]
    fn facets_at_equal_depth_are_no_cycle() {
        let pair = |a, b| {
            [
                square_facets(1.0, a, true, [5.0, 5.0, 20.0]),
                square_facets(1.0, b, true, [8.0, 5.0, 20.0]),
            ]
            .concat()
        };
        for facets in [pair(0, 1), pair(0, 0)] {
            let painted = sorted_facets(&facets);
            assert_eq!(painted.len(), 4);
            assert_eq!(sorted_facets(&facets), painted, "the same again");
        }
    }

    /// Three bars that overlap each other cyclically, and two squares that intersect in the middle.
    #[test]
    fn cycles_are_cut() {
        let bar = |style: u32, [from, to]: [DVec3; 2]| {
            let across = (to - from).truncate().perp().normalize() * 4.0;
            let across = across.extend(0.0);
            let halves = [[from, to, to + across], [from, to + across, from + across]];
            halves.map(|corners| opaque_facet(corners, style))
        };
        let v = DVec3::new;
        let around = [v(8.0, 8.0, 1.0), v(50.0, 10.0, 1.0), v(28.0, 36.0, 1.0)];
        let bars: Vec<Facet> = (0..3)
            .flat_map(|k| {
                let [from, to] = [around[k], around[(k + 1) % 3]];
                let beyond = (to - from) * 0.15;
                bar(k as u32, [(from - beyond).with_z(0.5), (to + beyond).with_z(1.5)])
            })
            .collect();
        let mut crossing_range = square_facets(1.0, 0, true, [10.0, 5.0, 30.0]).to_vec();
        crossing_range.extend(square_facets(1.0, 1, true, [10.0, 5.0, 30.0]).map(|mut facet| {
            for corner in &mut facet.corners {
                corner.z = if corner.x > 20.0 { 1.4 } else { 0.7 };
            }
            facet
        }));
        for facets in [bars, crossing_range] {
            let painted = sorted_facets(&facets);
            assert!(painted.len() > facets.len());
            let [other, all] = count_wrong_cells(&facets, &painted);
            assert!(50 * other < all, "{other} of {all}");
        }
    }

    #[test]
    fn edge_on_facet_hides_nothing() {
        let v = DVec3::new;
        let mut facets = square_facets(1.0, 0, true, [5.0, 5.0, 20.0]).to_vec();
        facets.push(opaque_facet([v(6.0, 6.0, 2.0), v(12.0, 12.0, 2.0), v(20.0, 20.0, 2.0)], 1));
        facets.push(opaque_facet([v(7.0, 9.0, 2.0); 3], 2));
        let painted = sorted_facets(&facets);
        assert_eq!(styles_of(&painted)[..2], [0, 0]);
        assert_eq!(count_wrong_cells(&facets[..2], &painted)[0], 0);
    }

    #[test]
    fn non_finite_facets_are_removed() {
        let good = square_facets(1.0, 0, true, [5.0, 5.0, 20.0]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in 0..9 {
                let mut odd = good[0];
                odd.style = 1;
                odd.corners[at / 3][at % 3] = bad;
                assert_eq!(
                    styles_of(&sorted_facets(&[odd, good[0], good[1]])),
                    [0, 0],
                    "{bad} at {at}"
                );
            }
        }
    }

    #[test]
    fn facets_outside_the_page_are_removed() {
        assert!(sorted_facets(&square_facets(1.0, 0, true, [70.0, 5.0, 20.0])).is_empty());
        assert!(sorted_facets(&[]).is_empty());
        let nowhere = Frame { low: DVec2::ZERO, high: DVec2::ZERO };
        let facets = square_facets(1.0, 0, true, [5.0, 5.0, 20.0]).to_vec();
        assert!(sort_back_to_front(facets, nowhere, Depth::Inverse, 0.0).is_empty());
    }

    /// Triangles thinner than samples are visible by their longest sides.
    #[test]
    fn sliver_is_visible_unless_hidden() {
        let v = DVec3::new;
        let sliver = |depth: f64| {
            opaque_facet([v(2.0, 10.3, depth), v(50.0, 10.3, depth), v(20.0, 10.31, depth)], 1)
        };
        let wall = square_facets(1.0, 0, true, [10.0, 5.0, 20.0]);
        assert_eq!(styles_of(&sorted_facets(&[&wall[..], &[sliver(2.0)]].concat())), [0, 0, 1]);
        assert_eq!(styles_of(&sorted_facets(&[&[sliver(0.5)], &wall[..]].concat())), [1, 0, 0]);
        let behind = opaque_facet([v(12.0, 10.3, 0.5), v(28.0, 10.3, 0.5), v(20.0, 10.31, 0.5)], 1);
        assert_eq!(styles_of(&sorted_facets(&[&[behind], &wall[..]].concat())), [0, 0]);
    }

    /// Layers of squares in random order, with several styles.
    #[test]
    fn order_of_20000_triangles_is_correct() {
        let mut random = Random::new(5);
        let mut facets = Vec::new();
        for k in 0..10_000_u32 {
            let (x, y) = (random.range(-5.0, 60.0), random.range(-5.0, 40.0));
            facets.extend(square_facets(random.range(0.5, 1.5), k, k % 3 > 0, [x, y, 4.0]));
        }
        let painted = sorted_facets(&facets);
        assert!(painted.len() < facets.len(), "what nobody sees is left out");
        let opaque: Vec<Facet> = facets.iter().filter(|facet| facet.opaque).copied().collect();
        let last: Vec<Facet> = painted.iter().filter(|facet| facet.opaque).copied().collect();
        assert_eq!(count_wrong_cells(&opaque, &last)[0], 0);
    }
}
