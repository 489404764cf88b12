//! Groups of rows with the same bodies and rotations. Large groups are answered with the faces of their
//! Minkowski difference.
//!
//! All threads first count the rows by a hash of the bodies and rotations. Only rows with a hash that occurs often
//! are compared and grouped, so that rows with distinct rotations cost one hash each and no memory but the count.
//!
//! The grouping depends on the rows alone, so the bits of the answers do not depend on the threads. They depend
//! on the order of rows only if more than [`MOST_GROUPS`] groups are large enough: of equally large groups, those
//! with the earlier first rows are then chosen. The first thread that needs the data of a group computes them.

use std::collections::HashMap;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

use colltrans::glam::DVec3;
use colltrans::{
    Cast, Clearance, ContactRange, ConvexPolyhedron, DirectionMap, FixedRotations, Outcome, Pose,
    QueryError,
};

use crate::rows::{Bodies, Poses, Table};

/// Maximum number of groups that use faces, because faces take some 100 KB per group. The largest groups are
/// chosen.
const MOST_GROUPS: usize = 256;

/// Number of rows below which no group saves time; less than all [`FixedRotations::break_even_casts`].
const MIN_ROWS: usize = 256;
/// Mean number of rows with the same hash, if all rotations are distinct.
const ROWS_PER_HASH: usize = 16;
/// Minimum number of rows that a thread counts.
const MIN_THREAD_ROWS: usize = 1 << 14;

/// The group of each row, if it has one.
pub(crate) struct Repeats<'a> {
    of_row: Vec<u32>,
    groups: Vec<Group<'a>>,
}

/// Marks a row without a group.
const NONE: u32 = u32::MAX;

/// Rows with the same bodies and rotations.
struct Group<'a> {
    bodies: [&'a ConvexPolyhedron; 2],
    first: usize,
    rows: usize,
    /// The direction of all rows, if it is the same.
    direction: Option<DVec3>,
    poses: Option<[Pose; 2]>,
    rotations: OnceLock<FixedRotations<'a>>,
}

impl<'a> Repeats<'a> {
    /// Groups `n` rows, on at most `threads` threads. Only rows that `is_asked` accepts are grouped.
    pub(crate) fn find(
        n: usize,
        bodies: &[Bodies<'a>; 2],
        poses: &[Poses<'a>; 2],
        directions: &Table<'_>,
        threads: usize,
        is_asked: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let rows = Rows { bodies, poses };
        let hashes = frequent_hashes(n, threads, |row| is_asked(row).then(|| rows.hash(row)));
        let mut groups: Vec<Group<'a>> = Vec::new();
        let mut by_hash: HashMap<u32, Vec<u32>> = HashMap::new();
        // The hash of a row is replaced by its group.
        let mut of_row = hashes;
        for row in 0..of_row.len() {
            let hash = std::mem::replace(&mut of_row[row], NONE);
            let Some(pair) = rows.pair(row).filter(|_| hash != NONE) else { continue };
            let is_one = |group: &Group<'a>| {
                (0..2).all(|k| std::ptr::eq(group.bodies[k], pair[k]))
                    && rows.have_same_rotations(group.first, row)
            };
            let last = row.checked_sub(1).map_or(NONE, |before| of_row[before]);
            let direction = directions.vector(row);
            let known = if last != NONE && is_one(&groups[last as usize]) {
                last
            } else {
                let alike = by_hash.entry(hash).or_default();
                let known = alike.iter().copied().find(|group| is_one(&groups[*group as usize]));
                known.unwrap_or_else(|| {
                    alike.push(groups.len() as u32);
                    groups.push(Group {
                        bodies: pair,
                        first: row,
                        rows: 0,
                        direction: Some(direction),
                        poses: None,
                        rotations: OnceLock::new(),
                    });
                    groups.len() as u32 - 1
                })
            };
            let group = &mut groups[known as usize];
            group.rows += 1;
            group.direction = group.direction.filter(|known| *known == direction);
            of_row[row] = known;
        }
        let mut repeats = Self { of_row, groups };
        repeats.keep_those_that_pay(poses);
        repeats
    }

    /// Sets the poses of the groups for which faces save time. The other groups have no poses.
    fn keep_those_that_pay(&mut self, poses: &[Poses<'a>; 2]) {
        let pays = |group: &&mut Group<'a>| {
            let [moving, fixed] = group.bodies;
            FixedRotations::break_even_casts(moving, fixed).is_some_and(|rows| group.rows >= rows)
        };
        let mut paying: Vec<&mut Group<'a>> = self.groups.iter_mut().filter(pays).collect();
        paying.sort_by_key(|group| (std::cmp::Reverse(group.rows), group.first));
        for group in paying.into_iter().take(MOST_GROUPS) {
            let [moving, fixed] = [0, 1].map(|k| poses[k].get(group.first));
            group.poses = moving.ok().zip(fixed.ok()).map(|(moving, fixed)| [moving, fixed]);
        }
        if self.groups.iter().all(|group| group.poses.is_none()) {
            *self = Self { of_row: Vec::new(), groups: Vec::new() };
        }
    }
}

/// The bodies and rotations of all rows.
struct Rows<'r, 'a> {
    bodies: &'r [Bodies<'a>; 2],
    poses: &'r [Poses<'a>; 2],
}

impl<'a> Rows<'_, 'a> {
    /// Returns the bodies of a row; `None` unless both are convex.
    fn pair(&self, row: usize) -> Option<[&'a ConvexPolyhedron; 2]> {
        let convex = |k: usize| self.bodies[k].get(row).and_then(|body| body.convex()).ok();
        Some([convex(0)?, convex(1)?])
    }

    /// Checks whether the rotations of two rows have the same bits.
    fn have_same_rotations(&self, a: usize, b: usize) -> bool {
        self.poses.iter().all(|poses| {
            let bits = |row| poses.table.rotation(row).map(f64::to_bits);
            bits(a).eq(bits(b))
        })
    }

    /// Returns a hash of the bodies and rotations that differ between rows.
    fn hash(&self, row: usize) -> u32 {
        let bodies =
            self.bodies.iter().filter_map(|side| side.index.map(|index| index[row] as u64));
        let several =
            self.poses.iter().map(|poses| &poses.table).filter(|table| !table.is_single());
        let rotations = several.flat_map(|table| table.rotation(row)).map(f64::to_bits);
        // Multiplication moves differences to higher bits only, so they are moved back in between.
        let mixed = bodies.chain(rotations).fold(0, |hash: u64, bits| {
            let mixed = (hash ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed ^ (mixed >> 32)
        });
        mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32) as u32
    }
}

/// Returns for each row its hash, or [`NONE`] if fewer than [`MIN_ROWS`] rows have a hash with the same last bits.
/// Returns an empty list if this is so for all rows.
fn frequent_hashes(
    n: usize,
    threads: usize,
    hash: impl Fn(usize) -> Option<u32> + Sync,
) -> Vec<u32> {
    if n < MIN_ROWS {
        return Vec::new();
    }
    let count = (n / ROWS_PER_HASH).next_power_of_two().min(1 << 31);
    let counts: Vec<AtomicU32> = std::iter::repeat_with(AtomicU32::default).take(count).collect();
    let mut hashes = vec![NONE; n];
    let chunk = n.div_ceil(threads.max(1)).max(MIN_THREAD_ROWS);
    let count_rows = |first: usize, part: &mut [u32]| {
        // Rows in succession with the same hash are counted together, so that threads seldom meet at a count.
        let (mut last, mut run) = (NONE, 0);
        let add = |hash: u32, run: u32| {
            counts.get(hash as usize).map(|count| count.fetch_add(run, Ordering::Relaxed))
        };
        for (place, row) in part.iter_mut().zip(first..) {
            *place = hash(row).map_or(NONE, |hash| hash & (count as u32 - 1));
            if *place != last {
                add(last, run);
                (last, run) = (*place, 0);
            }
            run += 1;
        }
        add(last, run);
    };
    std::thread::scope(|scope| {
        let mut parts = hashes.chunks_mut(chunk).enumerate();
        let own = parts.next();
        for (k, part) in parts {
            let count_rows = &count_rows;
            scope.spawn(move || count_rows(k * chunk, part));
        }
        if let Some((_, part)) = own {
            count_rows(0, part);
        }
    });
    let is_frequent = |count: &AtomicU32| count.load(Ordering::Relaxed) as usize >= MIN_ROWS;
    if !counts.iter().any(is_frequent) {
        return Vec::new();
    }
    for hash in &mut hashes {
        if !counts.get(*hash as usize).is_some_and(is_frequent) {
            *hash = NONE;
        }
    }
    hashes
}

/// The method that answers a row.
pub(crate) enum RowAnswerer<'m, 'r, 'a> {
    Cast,
    Rotations(&'m FixedRotations<'a>),
    Approach(&'m DirectionMap<'r, 'a>),
}

/// The groups, with an approach map for each group that has a single direction.
pub(crate) struct RowAnswerers<'r, 'a> {
    repeats: &'r Repeats<'a>,
    maps: Vec<OnceLock<Option<DirectionMap<'r, 'a>>>>,
}

impl<'r, 'a> RowAnswerers<'r, 'a> {
    pub(crate) fn new(repeats: &'r Repeats<'a>) -> Self {
        Self { repeats, maps: repeats.groups.iter().map(|_| OnceLock::new()).collect() }
    }

    pub(crate) fn for_row(&self, row: usize) -> RowAnswerer<'_, 'r, 'a> {
        let Some(which) = self.repeats.of_row.get(row).filter(|which| **which != NONE) else {
            return RowAnswerer::Cast;
        };
        let group = &self.repeats.groups[*which as usize];
        let Some(poses) = group.poses else { return RowAnswerer::Cast };
        let [moving, fixed] = group.bodies;
        let rotations = group
            .rotations
            .get_or_init(|| FixedRotations::new(moving.at(poses[0]), fixed.at(poses[1])));
        let map = self.maps[*which as usize]
            .get_or_init(|| group.direction.and_then(|along| rotations.for_direction(along).ok()));
        map.as_ref().map_or(RowAnswerer::Rotations(rotations), RowAnswerer::Approach)
    }
}

impl<'a> RowAnswerer<'_, '_, 'a> {
    pub(crate) fn first_contact(&self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        match self {
            Self::Cast => cast.first_contact(),
            Self::Rotations(rotations) => rotations.first_contact(cast),
            Self::Approach(approach) => approach.first_contact(cast),
        }
    }

    pub(crate) fn contact_range(&self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        match self {
            Self::Cast => cast.contact_range(),
            Self::Rotations(rotations) => rotations.contact_range(cast),
            Self::Approach(approach) => approach.contact_range(cast),
        }
    }

    pub(crate) fn clearance(&self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        match self {
            Self::Cast => cast.clearance(),
            Self::Rotations(rotations) => rotations.clearance(cast),
            Self::Approach(approach) => approach.clearance(cast),
        }
    }
}
