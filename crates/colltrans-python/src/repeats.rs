//! Groups of rows with the same bodies and rotations. Large groups are answered with the faces of their
//! Minkowski difference.
//!
//! The grouping depends on the rows alone, so the bits of the answers do not depend on the threads. They depend
//! on the order of rows only if more than [`MOST_GROUPS`] groups are large enough: of equally large groups, those
//! with the earlier first rows are then chosen. The first thread that needs the data of a group computes them.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::OnceLock;

use colltrans::glam::DVec3;
use colltrans::{
    Cast, Clearance, ContactRange, ConvexPolyhedron, DirectionMap, FixedRotations, Outcome, Pose,
    QueryError,
};

use crate::rows::{Bodies, Table};

/// Maximum number of groups that use faces, because faces take some 100 KB per group. The largest groups are
/// chosen.
const MOST_GROUPS: usize = 256;

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
    /// Groups `n` rows. Only rows that `is_asked` accepts are grouped.
    pub(crate) fn find(
        n: usize,
        bodies: &[Bodies<'a>; 2],
        poses: &[Table<'a>; 2],
        directions: &Table<'_>,
        is_asked: impl Fn(usize) -> bool,
    ) -> Self {
        let mut groups: Vec<Group<'a>> = Vec::new();
        let mut by_key: HashMap<u64, Vec<u32>> = HashMap::new();
        let mut of_row = vec![NONE; n];
        let same_rotations = |a: usize, b: usize| {
            poses.iter().all(|table| {
                let bits = |row| table.rotation(row).map(f64::to_bits);
                bits(a).eq(bits(b))
            })
        };
        for row in (0..n).filter(|row| is_asked(*row)) {
            let convex = |k: usize| bodies[k].get(row).and_then(|body| body.convex());
            let (Ok(moving), Ok(fixed)) = (convex(0), convex(1)) else { continue };
            let pair = [moving, fixed];
            let is_one = |group: &Group<'a>| {
                (0..2).all(|k| std::ptr::eq(group.bodies[k], pair[k]))
                    && same_rotations(group.first, row)
            };
            let last = row.checked_sub(1).map_or(NONE, |before| of_row[before]);
            let direction = directions.vector(row);
            let known = if last != NONE && is_one(&groups[last as usize]) {
                last
            } else {
                let mut hasher = DefaultHasher::new();
                pair.map(std::ptr::from_ref).hash(&mut hasher);
                for number in poses.iter().flat_map(|table| table.rotation(row)) {
                    number.to_bits().hash(&mut hasher);
                }
                let alike = by_key.entry(hasher.finish()).or_default();
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
    fn keep_those_that_pay(&mut self, poses: &[Table<'a>; 2]) {
        let pays = |group: &&mut Group<'a>| {
            let [moving, fixed] = group.bodies;
            FixedRotations::break_even_casts(moving, fixed).is_some_and(|rows| group.rows >= rows)
        };
        let mut paying: Vec<&mut Group<'a>> = self.groups.iter_mut().filter(pays).collect();
        paying.sort_by_key(|group| (std::cmp::Reverse(group.rows), group.first));
        for group in paying.into_iter().take(MOST_GROUPS) {
            let [moving, fixed] = [0, 1].map(|k| poses[k].pose(group.first));
            group.poses = moving.ok().zip(fixed.ok()).map(|(moving, fixed)| [moving, fixed]);
        }
        if self.groups.iter().all(|group| group.poses.is_none()) {
            *self = Self { of_row: Vec::new(), groups: Vec::new() };
        }
    }
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
