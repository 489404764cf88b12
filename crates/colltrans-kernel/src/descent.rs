//! Simultaneous descent of two bounding volume trees.
//!
//! A pair of nodes represents all pairs of items below the two nodes. [`node_to_split`] selects the node of a
//! pair that is replaced by its children. Searches and proofs over two trees use this rule; the search for
//! self-intersections has its own.
//!
//! [`best_first`] splits the pair with the least bound next. Until it has a first result, it continues with
//! the better child of the last pair, because a result limits the number of pairs in the queue.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Selects the node to split: the larger of two inner nodes (the first of equal ones), or the only inner
/// node. Returns `None` for two leaves.
#[inline]
pub fn node_to_split(are_leaves: [bool; 2], size: impl Fn(usize) -> f64) -> Option<usize> {
    match are_leaves {
        [true, true] => None,
        [false, true] => Some(0),
        [true, false] => Some(1),
        [false, false] => Some(usize::from(size(0) < size(1))),
    }
}

/// Returns `pair` with `node` in place of the first (0) or the second element (1).
#[inline]
#[must_use]
pub fn pair_with_node<T>(mut pair: [T; 2], which: usize, node: T) -> [T; 2] {
    pair[which] = node;
    pair
}

/// The nodes of one tree that a search has visited, each with data computed by the search (a *view*), and the
/// items of the visited leaves. Both are cached, because a node occurs in many pairs.
#[derive(Debug, Clone)]
pub struct VisitedNodes<V, I> {
    views: Vec<V>,
    /// For each view, `[first, count]` of its children in `views`, or of its items in `items`; `None` before
    /// the first request.
    ranges: Vec<Option<[u32; 2]>>,
    items: Vec<I>,
}

impl<V, I> Default for VisitedNodes<V, I> {
    fn default() -> Self {
        Self { views: Vec::new(), ranges: Vec::new(), items: Vec::new() }
    }
}

impl<V, I> VisitedNodes<V, I> {
    /// Clears the cache and stores the view of the root, as number 0.
    #[inline]
    pub fn reset_to_root(&mut self, root: V) {
        self.views.clear();
        self.ranges.clear();
        self.items.clear();
        self.push(root);
    }

    #[inline]
    fn push(&mut self, view: V) {
        self.views.push(view);
        self.ranges.push(None);
    }

    /// Returns the view with this number.
    #[inline]
    pub fn view(&self, at: u32) -> &V {
        &self.views[at as usize]
    }

    /// Returns the numbers of the two children of a view. The first call computes both views by
    /// `child(parent, 0)` and `child(parent, 1)`.
    #[inline]
    pub fn children(&mut self, at: u32, mut child: impl FnMut(&V, usize) -> V) -> [u32; 2] {
        let first = self.ranges[at as usize].map_or(self.views.len() as u32, |[first, _]| first);
        if self.ranges[at as usize].is_none() {
            for k in 0..2 {
                let view = child(self.view(at), k);
                self.push(view);
            }
            self.ranges[at as usize] = Some([first, 2]);
        }
        [first, first + 1]
    }

    /// Returns the range of the items of a leaf in the cache. The first call computes the items.
    #[inline]
    pub fn leaf_items<J: Iterator<Item = I>>(
        &mut self,
        at: u32,
        items: impl FnOnce(&V) -> J,
    ) -> Range<usize> {
        let [first, count] = self.ranges[at as usize].unwrap_or_else(|| {
            let first = self.items.len();
            self.items.extend(items(&self.views[at as usize]));
            let range = [first as u32, (self.items.len() - first) as u32];
            self.ranges[at as usize] = Some(range);
            range
        });
        first as usize..(first + count) as usize
    }

    /// Returns the item at a position in the cache.
    #[inline]
    pub fn cached_item(&self, at: usize) -> &I {
        &self.items[at]
    }

    /// Returns the items at a range of positions in the cache.
    #[inline]
    pub fn cached_items(&self, range: Range<usize>) -> &[I] {
        &self.items[range]
    }
}

/// A pair in the queue of a search. The least bound has the highest priority, and among equal bounds the
/// newest pair.
#[derive(Debug, Clone, Copy)]
pub struct QueuedPair<R = ()> {
    /// Lower bound for all pairs of items below this pair of nodes.
    pub bound: f64,
    /// Number of pairs for which the search had requested a bound, including this pair.
    pub number: u32,
    /// The reason for the bound, which a proof states.
    pub reason: R,
    /// Numbers of the two views in [`VisitedNodes`], one for each tree.
    pub views: [u32; 2],
}

impl<R> Ord for QueuedPair<R> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

impl<R> PartialOrd for QueuedPair<R> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<R> PartialEq for QueuedPair<R> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<R> Eq for QueuedPair<R> {}

/// The interface of a problem that [`best_first`] solves: bounds, splits and the result.
pub trait PairSearch {
    /// The reason for a bound.
    type Reason: Copy;

    /// Of two children with equal bounds, the search continues with the first if this is true, else with the
    /// second.
    const PREFERS_FIRST_OF_EQUALS: bool;

    /// Returns the limit. Pairs whose bound is not below the limit are skipped.
    fn bound_limit(&self) -> f64;

    /// Checks whether the search has a result.
    fn is_found(&self) -> bool;

    /// Checks whether the result is sufficient, so that the search can stop.
    fn is_sufficient(&self) -> bool {
        false
    }

    /// Returns the bound of a pair with its reason; `None` if the pair can be skipped. Every bound that is
    /// returned must be below the limit.
    fn lower_bound(&mut self, views: [u32; 2]) -> Option<(f64, Self::Reason)>;

    /// Returns the two pairs into which a pair is split. For two leaves, examines their items and returns
    /// `None`.
    fn split_pair(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]>;

    /// Records a pair that is skipped, because its bound is not below the limit.
    fn skip_pair(&mut self, entry: &QueuedPair<Self::Reason>);
}

/// Searches both trees from the pair of their roots, the views 0 of both. Stops when no remaining pair has a
/// bound below the limit, or when the result is sufficient after two leaves were examined.
#[inline]
pub fn best_first<P: PairSearch>(pairs: &mut P, queue: &mut BinaryHeap<QueuedPair<P::Reason>>) {
    queue.clear();
    let mut number = 0;
    let mut bounded_entry = |pairs: &mut P, views: [u32; 2]| {
        number += 1;
        pairs.lower_bound(views).map(|(bound, reason)| QueuedPair { bound, number, reason, views })
    };
    let mut next = bounded_entry(pairs, [0, 0]);
    while let Some(entry) = next.take().or_else(|| queue.pop()) {
        if entry.bound >= pairs.bound_limit() {
            // All other pairs can be skipped too, because this bound is the least. A child that is continued
            // without a result may have a larger bound, but `PairSearch::lower_bound` returned it below the limit.
            pairs.skip_pair(&entry);
            for rest in queue.drain() {
                pairs.skip_pair(&rest);
            }
            return;
        }
        let Some(children) = pairs.split_pair(entry.views) else {
            if pairs.is_sufficient() {
                return;
            }
            continue;
        };
        next = match children.map(|views| bounded_entry(pairs, views)) {
            [Some(x), Some(y)] => {
                // The search continues with the better child without pushing it to the queue.
                let is_first =
                    x.bound < y.bound || P::PREFERS_FIRST_OF_EQUALS && x.bound == y.bound;
                let (better, other) = if is_first { (x, y) } else { (y, x) };
                queue.push(other);
                Some(better)
            }
            [x, y] => x.or(y),
        };
        if let (true, Some(child), Some(top)) = (pairs.is_found(), next, queue.peek())
            && top.bound < child.bound
        {
            queue.push(child);
            next = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches the least distance of two sorted lists of numbers. A view is a range of one list.
    #[derive(Default)]
    struct Nearest {
        lists: [Vec<f64>; 2],
        seen: [VisitedNodes<Range<usize>, f64>; 2],
        found: Option<f64>,
        bound_calls: usize,
    }

    impl PairSearch for Nearest {
        type Reason = ();
        const PREFERS_FIRST_OF_EQUALS: bool = true;

        fn bound_limit(&self) -> f64 {
            self.found.unwrap_or(f64::INFINITY)
        }

        fn is_found(&self) -> bool {
            self.found.is_some()
        }

        fn lower_bound(&mut self, views: [u32; 2]) -> Option<(f64, ())> {
            self.bound_calls += 1;
            let [p, q] = [0, 1].map(|k| &self.lists[k][self.seen[k].view(views[k]).clone()]);
            let bound = (q[0] - p[p.len() - 1]).max(p[0] - q[q.len() - 1]).max(0.0);
            (bound < self.bound_limit()).then_some((bound, ()))
        }

        fn split_pair(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]> {
            let lengths = [0, 1].map(|k| self.seen[k].view(views[k]).len());
            let Some(which) = node_to_split(lengths.map(|n| n == 1), |k| lengths[k] as f64) else {
                let [x, y] = [0, 1].map(|k| {
                    let (list, seen) = (&self.lists[k], &mut self.seen[k]);
                    let held =
                        seen.leaf_items(views[k], |range| list[range.clone()].iter().copied());
                    seen.cached_items(held)[0]
                });
                self.found = Some(self.bound_limit().min((x - y).abs()));
                return None;
            };
            let children = self.seen[which].children(views[which], |range, k| {
                let middle = range.start + range.len() / 2;
                [range.start..middle, middle..range.end][k].clone()
            });
            Some(children.map(|child| pair_with_node(views, which, child)))
        }

        fn skip_pair(&mut self, entry: &QueuedPair) {
            assert!(entry.bound >= self.bound_limit());
        }
    }

    #[test]
    fn best_first_finds_nearest_pair_without_bounding_all_pairs() {
        let lists = [(0.618_033_988_75, 150), (0.414_213_562_37, 110)].map(|(factor, count)| {
            let mut list: Vec<f64> = (1..=count).map(|k| (f64::from(k) * factor).fract()).collect();
            list.sort_by(f64::total_cmp);
            list
        });
        let pairs = lists[0].iter().flat_map(|x| lists[1].iter().map(move |y| (x - y).abs()));
        let brute = pairs.reduce(f64::min);
        let mut search = Nearest { lists, ..Nearest::default() };
        for k in 0..2 {
            search.seen[k].reset_to_root(0..search.lists[k].len());
        }
        best_first(&mut search, &mut BinaryHeap::new());
        assert_eq!(search.found, brute);
        assert!(search.bound_calls < 150 * 110 / 4, "{} pairs", search.bound_calls);
    }

    #[test]
    fn node_to_split_is_the_larger_inner_node() {
        let split = |are_leaves, sizes: [f64; 2]| node_to_split(are_leaves, |k| sizes[k]);
        let inner = [[1.0, 1.0], [1.0, 2.0]].map(|sizes| split([false; 2], sizes));
        let leaves = [[false, true], [true, false], [true; 2]].map(|leaf| split(leaf, [1.0, 1.0]));
        assert_eq!((inner, leaves), ([Some(0), Some(1)], [Some(0), Some(1), None]));
    }
}
