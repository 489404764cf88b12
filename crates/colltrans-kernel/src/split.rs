//! How the boxes of a node are parted in two: up to 16 bins along each axis and the surface-area heuristic;
//! halves by count where that finds nothing.

use glam::DVec3;

use super::Aabb;

const BINS: usize = 16;
/// More boxes than this are weighed by as many of them.
const SAMPLE: usize = 1 << 12;

/// What has a box.
pub trait Boxed {
    /// Its box.
    fn bounds(&self) -> &Aabb;
    /// What tells it from others with the same box.
    fn number(&self) -> u32;

    /// Twice the middle.
    #[inline]
    fn center(&self) -> DVec3 {
        self.bounds().low + self.bounds().high
    }
}

/// What is tried.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// Both children get so many items.
    pub least: usize,
    /// Only across the longest way between centres: a third of the work.
    pub longest: bool,
}

/// Puts the items of the first child in front; how many they are.
#[inline]
pub fn split<T: Boxed>(items: &mut [T], rule: Rule) -> usize {
    let least = rule.least;
    let centers = Aabb::of_points(items.iter().map(Boxed::center));
    if let Some((axis, bin)) = cheapest(items, &centers, rule) {
        let key = Binning::new(&centers, axis, items.len());
        let middle = partition(items, |item| key.bin(item) <= bin);
        if middle >= least && middle + least <= items.len() {
            return middle;
        }
    }
    halve(items, &centers)
}

/// The same by count, across the longest way between centres.
#[inline]
pub fn halve<T: Boxed>(items: &mut [T], centers: &Aabb) -> usize {
    let axis = centers.size().max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let (x, y) = (a.center()[axis], b.center()[axis]);
        x.total_cmp(&y).then(a.number().cmp(&b.number()))
    });
    middle
}

/// Moves the items that `belongs` to the front; how many they are.
#[inline]
fn partition<T>(items: &mut [T], belongs: impl Fn(&T) -> bool) -> usize {
    let mut middle = 0;
    for k in 0..items.len() {
        if belongs(&items[k]) {
            items.swap(middle, k);
            middle += 1;
        }
    }
    middle
}

/// Intervals of the centres along an axis.
struct Binning {
    axis: usize,
    low: f64,
    scale: f64,
    last: usize,
}

impl Binning {
    /// For so many items: few need few.
    #[inline]
    fn new(centers: &Aabb, axis: usize, items: usize) -> Self {
        let bins = items.clamp(4, BINS);
        let scale = bins as f64 / centers.size()[axis];
        Self { axis, low: centers.low[axis], scale, last: bins - 1 }
    }

    #[inline]
    fn bin(&self, item: &impl Boxed) -> usize {
        // Out of range, or not a number where all centres are one, ends at either end.
        (((item.center()[self.axis] - self.low) * self.scale) as usize).min(self.last)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    #[inline]
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.join(&other.bounds), count: self.count + other.count }
    }

    /// Half the surface of the box times the count.
    #[inline]
    fn cost(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.bounds.half_area() * self.count as f64 }
    }
}

/// The axis and the last bin of the first child for which the surface-area heuristic is least; of many
/// items a share is looked at.
#[inline]
fn cheapest<T: Boxed>(items: &[T], centers: &Aabb, rule: Rule) -> Option<(usize, usize)> {
    let step = items.len().div_ceil(SAMPLE);
    let counted = items.len().div_ceil(step);
    let least = (rule.least * counted).div_ceil(items.len());
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let is_asked = !rule.longest || axis == centers.size().max_position();
        if !is_asked || centers.high[axis] <= centers.low[axis] {
            continue;
        }
        let binning = Binning::new(centers, axis, items.len());
        let mut bins = [Bin::EMPTY; BINS];
        for item in items.iter().step_by(step) {
            let bin = &mut bins[binning.bin(item)];
            *bin = bin.join(Bin { bounds: *item.bounds(), count: 1 });
        }
        let mut behind = [0.0; BINS];
        let mut all = Bin::EMPTY;
        for k in (1..=binning.last).rev() {
            all = all.join(bins[k]);
            behind[k] = all.cost();
        }
        let mut front = Bin::EMPTY;
        for k in 0..binning.last {
            front = front.join(bins[k]);
            let cost = front.cost() + behind[k + 1];
            let both = (least..=counted - least).contains(&front.count) && behind[k + 1] > 0.0;
            if both && best.is_none_or(|b| cost < b.0) {
                best = Some((cost, axis, k));
            }
        }
    }
    best.map(|(_, axis, bin)| (axis, bin))
}
