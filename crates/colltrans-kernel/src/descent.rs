//! Down two trees of boxes at once.
//!
//! A pair of nodes stands for all pairs of what is below them. [`node_to_split`] is which node of a pair is replaced by its
//! children, by the same rule in every search and every proof. [`best_first`] splits the pair with the least bound next, and
//! goes straight down until something is found, because what is found bounds what has to be kept.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Returns which of two nodes is split: the larger one, the first of equal ones, but never a leaf; `None` of two leaves.
#[inline]
pub fn node_to_split(are_leaves: [bool; 2], size: impl Fn(usize) -> f64) -> Option<usize> {
    match are_leaves {
        [true, true] => None,
        [false, true] => Some(0),
        [true, false] => Some(1),
        [false, false] => Some(usize::from(size(0) < size(1))),
    }
}

/// Returns a pair with another node in the place of the first (0) or the second one (1).
#[inline]
#[must_use]
pub fn replaced<T>(mut pair: [T; 2], which: usize, node: T) -> [T; 2] {
    pair[which] = node;
    pair
}

/// The nodes of a tree that a search has come to, and what the leaves among them hold: each is in many pairs.
#[derive(Debug, Clone)]
pub struct Seen<V, I> {
    views: Vec<V>,
    /// Where the children of each view are among the views, or what it holds among the items, and how many; once they have
    /// been asked for.
    parts: Vec<Option<[u32; 2]>>,
    items: Vec<I>,
}

impl<V, I> Default for Seen<V, I> {
    fn default() -> Self {
        Self { views: Vec::new(), parts: Vec::new(), items: Vec::new() }
    }
}

impl<V, I> Seen<V, I> {
    /// Forgets all but the root.
    #[inline]
    pub fn start(&mut self, root: V) {
        self.views.clear();
        self.parts.clear();
        self.items.clear();
        self.push(root);
    }

    #[inline]
    fn push(&mut self, view: V) {
        self.views.push(view);
        self.parts.push(None);
    }

    /// Returns a view by its number.
    #[inline]
    pub fn view(&self, at: u32) -> &V {
        &self.views[at as usize]
    }

    /// Returns the numbers of the two children of a view, each of which is made when they are first asked for.
    #[inline]
    pub fn children(&mut self, at: u32, mut child: impl FnMut(&V, usize) -> V) -> [u32; 2] {
        let first = self.parts[at as usize].map_or(self.views.len() as u32, |[first, _]| first);
        if self.parts[at as usize].is_none() {
            for k in 0..2 {
                let view = child(self.view(at), k);
                self.push(view);
            }
            self.parts[at as usize] = Some([first, 2]);
        }
        [first, first + 1]
    }

    /// Returns which of the items a leaf holds; they are made when they are first asked for.
    #[inline]
    pub fn leaf<J: Iterator<Item = I>>(
        &mut self,
        at: u32,
        items: impl FnOnce(&V) -> J,
    ) -> Range<usize> {
        let [first, count] = self.parts[at as usize].unwrap_or_else(|| {
            let first = self.items.len();
            self.items.extend(items(&self.views[at as usize]));
            let parts = [first as u32, (self.items.len() - first) as u32];
            self.parts[at as usize] = Some(parts);
            parts
        });
        first as usize..(first + count) as usize
    }

    /// Returns one of the items.
    #[inline]
    pub fn item(&self, at: usize) -> &I {
        &self.items[at]
    }

    /// Returns some of the items.
    #[inline]
    pub fn items(&self, range: Range<usize>) -> &[I] {
        &self.items[range]
    }
}

/// A pair in the queue of a search: the least bound comes first, the newest first among equals.
#[derive(Debug, Clone, Copy)]
pub struct Entry<R = ()> {
    /// What nothing below the pair is less than.
    pub bound: f64,
    /// How many pairs came before.
    pub number: u32,
    /// Why that is the bound, if it is to be told.
    pub reason: R,
    /// Positions among what has been seen.
    pub views: [u32; 2],
}

impl<R> Ord for Entry<R> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

impl<R> PartialOrd for Entry<R> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<R> PartialEq for Entry<R> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<R> Eq for Entry<R> {}

/// The pairs of a search, and what it has found.
pub trait Pairs {
    /// Why a bound is one.
    type Reason: Copy;

    /// Whether of two children with the same bound the first one goes on; else the second one does.
    const FIRST_OF_EQUALS: bool;

    /// Returns the bound from which on pairs are of no interest.
    fn limit(&self) -> f64;

    /// Checks whether something has been found.
    fn is_found(&self) -> bool;

    /// Checks whether what has been found will do.
    fn is_enough(&self) -> bool {
        false
    }

    /// Returns the bound of a pair; `None` if the pair is of no interest.
    fn bound(&mut self, views: [u32; 2]) -> Option<(f64, Self::Reason)>;

    /// Returns the two pairs that a pair is split into; of two leaves looks at what they hold, and returns `None`.
    fn split(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]>;

    /// Takes leave of a pair whose bound is not below the limit.
    fn dismiss(&mut self, entry: &Entry<Self::Reason>);
}

/// Searches both trees from their roots on, until no bound is below the limit.
#[inline]
pub fn best_first<P: Pairs>(pairs: &mut P, queue: &mut BinaryHeap<Entry<P::Reason>>) {
    queue.clear();
    let mut number = 0;
    let mut judge = |pairs: &mut P, views: [u32; 2]| {
        number += 1;
        pairs.bound(views).map(|(bound, reason)| Entry { bound, number, reason, views })
    };
    let mut next = judge(pairs, [0, 0]);
    while let Some(entry) = next.take().or_else(|| queue.pop()) {
        if entry.bound >= pairs.limit() {
            // As are all others: it is the least, or else the limit is below all bounds.
            pairs.dismiss(&entry);
            for rest in queue.drain() {
                pairs.dismiss(&rest);
            }
            return;
        }
        let Some(parts) = pairs.split(entry.views) else {
            if pairs.is_enough() {
                return;
            }
            continue;
        };
        next = match parts.map(|views| judge(pairs, views)) {
            [Some(x), Some(y)] => {
                // The better child goes on without a detour through the queue.
                let is_first = x.bound < y.bound || P::FIRST_OF_EQUALS && x.bound == y.bound;
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

    /// The nearest of two sorted lists of numbers: a view is a range of either list.
    #[derive(Default)]
    struct Nearest {
        lists: [Vec<f64>; 2],
        seen: [Seen<Range<usize>, f64>; 2],
        found: Option<f64>,
        judged: usize,
    }

    impl Pairs for Nearest {
        type Reason = ();
        const FIRST_OF_EQUALS: bool = true;

        fn limit(&self) -> f64 {
            self.found.unwrap_or(f64::INFINITY)
        }

        fn is_found(&self) -> bool {
            self.found.is_some()
        }

        fn bound(&mut self, views: [u32; 2]) -> Option<(f64, ())> {
            self.judged += 1;
            let [p, q] = [0, 1].map(|k| &self.lists[k][self.seen[k].view(views[k]).clone()]);
            let bound = (q[0] - p[p.len() - 1]).max(p[0] - q[q.len() - 1]).max(0.0);
            (bound < self.limit()).then_some((bound, ()))
        }

        fn split(&mut self, views: [u32; 2]) -> Option<[[u32; 2]; 2]> {
            let lengths = [0, 1].map(|k| self.seen[k].view(views[k]).len());
            let Some(which) = node_to_split(lengths.map(|n| n == 1), |k| lengths[k] as f64) else {
                let [x, y] = [0, 1].map(|k| {
                    let (list, seen) = (&self.lists[k], &mut self.seen[k]);
                    let held = seen.leaf(views[k], |range| list[range.clone()].iter().copied());
                    seen.items(held)[0]
                });
                self.found = Some(self.limit().min((x - y).abs()));
                return None;
            };
            let parts = self.seen[which].children(views[which], |range, k| {
                let middle = range.start + range.len() / 2;
                [range.start..middle, middle..range.end][k].clone()
            });
            Some(parts.map(|part| replaced(views, which, part)))
        }

        fn dismiss(&mut self, entry: &Entry) {
            assert!(entry.bound >= self.limit());
        }
    }

    #[test]
    fn best_first_finds_the_nearest_without_judging_all_pairs() {
        let lists = [(0.618_033_988_75, 150), (0.414_213_562_37, 110)].map(|(factor, count)| {
            let mut list: Vec<f64> = (1..=count).map(|k| (f64::from(k) * factor).fract()).collect();
            list.sort_by(f64::total_cmp);
            list
        });
        let pairs = lists[0].iter().flat_map(|x| lists[1].iter().map(move |y| (x - y).abs()));
        let brute = pairs.reduce(f64::min);
        let mut search = Nearest { lists, ..Nearest::default() };
        for k in 0..2 {
            search.seen[k].start(0..search.lists[k].len());
        }
        best_first(&mut search, &mut BinaryHeap::new());
        assert_eq!(search.found, brute);
        assert!(search.judged < 150 * 110 / 4, "{} pairs", search.judged);
    }

    #[test]
    fn larger_node_is_split_and_never_a_leaf() {
        let split = |are_leaves, sizes: [f64; 2]| node_to_split(are_leaves, |k| sizes[k]);
        let inner = [[1.0, 1.0], [1.0, 2.0]].map(|sizes| split([false; 2], sizes));
        let leaves = [[false, true], [true, false], [true; 2]].map(|leaf| split(leaf, [1.0, 1.0]));
        assert_eq!((inner, leaves), ([Some(0), Some(1)], [Some(0), Some(1), None]));
    }
}
