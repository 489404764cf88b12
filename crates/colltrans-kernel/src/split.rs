//! Splits the items of a node of a bounding volume tree: binned surface-area heuristic (Wald, "On fast
//! construction of SAH-based bounding volume hierarchies", 2007).
//!
//! Each axis has up to 16 bins. If no split between bins is accepted, the items are split at the median.

use glam::DVec3;

use super::Aabb;

/// Maximum number of bins along an axis.
const MAX_BINS: usize = 16;
/// Number of items above which the heuristic evaluates a sample, which has between half this number and this
/// number of items.
const SAMPLE_SIZE: usize = 1 << 12;

/// An item with a box.
pub trait Boxed {
    /// Returns the box of the item.
    fn bounds(&self) -> &Aabb;
    /// Returns the number of the item, which orders items with equal centres.
    fn number(&self) -> u32;

    /// Returns twice the centre of the box.
    #[inline]
    fn doubled_center(&self) -> DVec3 {
        self.bounds().low + self.bounds().high
    }
}

/// Constraints for a split.
#[derive(Debug, Clone, Copy)]
pub struct SplitRule {
    /// Minimum number of items of each child.
    pub min_items: usize,
    /// Whether only the axis of the largest extent of the centres is evaluated, a third of the work.
    pub only_longest_axis: bool,
}

/// Partitions the items so that those of the first child come first, and returns their number.
#[inline]
pub fn split_items<T: Boxed>(items: &mut [T], rule: SplitRule) -> usize {
    let centers = Aabb::from_points(items.iter().map(Boxed::doubled_center));
    split_items_within(items, &centers, rule)
}

/// Partitions the items like [`split_items`]. `centers` is the box of the centres, as [`Boxed::doubled_center`] returns
/// them.
#[inline]
pub fn split_items_within<T: Boxed>(items: &mut [T], centers: &Aabb, rule: SplitRule) -> usize {
    let least = rule.min_items;
    if let Some((axis, bin)) = least_cost_split(items, centers, rule) {
        let key = Binning::new(centers, axis, items.len());
        let middle = move_to_front(items, |item| key.bin_of(item) <= bin);
        if middle >= least && middle + least <= items.len() {
            return middle;
        }
    }
    split_at_median(items, centers)
}

/// Partitions the items at the median along the axis of the largest extent of the centres, and returns the
/// number of items in front. `centers` is the box of the centres, as [`Boxed::doubled_center`] returns them.
#[inline]
pub fn split_at_median<T: Boxed>(items: &mut [T], centers: &Aabb) -> usize {
    let axis = centers.side_lengths().max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let (x, y) = (a.doubled_center()[axis], b.doubled_center()[axis]);
        x.total_cmp(&y).then(a.number().cmp(&b.number()))
    });
    middle
}

/// Moves the items for which `belongs` is true to the front, and returns their number.
#[inline]
fn move_to_front<T>(items: &mut [T], belongs: impl Fn(&T) -> bool) -> usize {
    let mut middle = 0;
    for k in 0..items.len() {
        if belongs(&items[k]) {
            items.swap(middle, k);
            middle += 1;
        }
    }
    middle
}

/// The bins of the centres along an axis.
struct Binning {
    axis: usize,
    low: f64,
    scale: f64,
    last: usize,
}

impl Binning {
    /// Returns the bins for a number of items. Few items get fewer bins, at least 4.
    #[inline]
    fn new(centers: &Aabb, axis: usize, items: usize) -> Self {
        let bins = items.clamp(4, MAX_BINS);
        let scale = bins as f64 / centers.side_lengths()[axis];
        Self { axis, low: centers.low[axis], scale, last: bins - 1 }
    }

    #[inline]
    fn bin_of(&self, item: &impl Boxed) -> usize {
        // Values out of range, or NaN if all centres are equal, go to the first or the last bin.
        (((item.doubled_center()[self.axis] - self.low) * self.scale) as usize).min(self.last)
    }
}

/// The box and the number of the items of consecutive bins.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    #[inline]
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(&other.bounds), count: self.count + other.count }
    }

    /// Returns half the surface area of the box times the number of items.
    #[inline]
    fn weighted_area(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.bounds.half_area() * self.count as f64 }
    }
}

/// Finds the axis and the last bin of the first child with the least cost by the surface-area heuristic. For
/// many items, evaluates a sample. `None` if no split satisfies the rule and gives the second child a box of
/// positive area.
#[inline]
fn least_cost_split<T: Boxed>(
    items: &[T],
    centers: &Aabb,
    rule: SplitRule,
) -> Option<(usize, usize)> {
    let step = items.len().div_ceil(SAMPLE_SIZE);
    let counted = items.len().div_ceil(step);
    let least = (rule.min_items * counted).div_ceil(items.len());
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let is_evaluated = !rule.only_longest_axis || axis == centers.side_lengths().max_position();
        if !is_evaluated || centers.high[axis] <= centers.low[axis] {
            continue;
        }
        let binning = Binning::new(centers, axis, items.len());
        let mut bins = [Bin::EMPTY; MAX_BINS];
        for item in items.iter().step_by(step) {
            let bin = &mut bins[binning.bin_of(item)];
            *bin = bin.join(Bin { bounds: *item.bounds(), count: 1 });
        }
        let mut costs_behind = [0.0; MAX_BINS];
        let mut all = Bin::EMPTY;
        for k in (1..=binning.last).rev() {
            all = all.join(bins[k]);
            costs_behind[k] = all.weighted_area();
        }
        let mut front = Bin::EMPTY;
        for k in 0..binning.last {
            front = front.join(bins[k]);
            let cost = front.weighted_area() + costs_behind[k + 1];
            let is_valid =
                (least..=counted - least).contains(&front.count) && costs_behind[k + 1] > 0.0;
            if is_valid && best.is_none_or(|b| cost < b.0) {
                best = Some((cost, axis, k));
            }
        }
    }
    best.map(|(_, axis, bin)| (axis, bin))
}
