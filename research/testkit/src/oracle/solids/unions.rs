//! Judges unions of pieces that overlap, with facets that lie on each other or within other pieces.
//!
//! A piece is a box of unit cubes, in some cases with a cavity. The union is the set of the cubes of its pieces. The exact
//! motion, contact, common part and depth are those of the cubes.

use std::collections::BTreeSet;

use colltrans::solid::SolidCast;
use colltrans::{Pair, Pose, Solid};
use glam::{DMat3, DVec3};

use super::cells::{Cells, motion};
use super::depth::{self, Exact};
use super::exactly;
use super::settings::{AGREEMENT, judge_motion, way};
use crate::oracle::exact::Vector;
use crate::oracle::scene::size;
use crate::random::Random;
use crate::tally::Tally;

/// The families: a box, a union, or a body that fills a cavity, against a union.
pub const FAMILIES: [&str; 3] = ["boxes", "unions", "fillings"];
/// Columns of the campaign.
pub const COLUMNS: &[&str] = depth::COLUMNS;

/// Number of cubes along a side of the grid of a union.
const SIDE: i64 = 5;

/// A box of cubes, and its cavity.
struct Piece {
    ends: [[i64; 3]; 2],
    cavity: Option<[[i64; 3]; 2]>,
}

impl Piece {
    fn random(random: &mut Random) -> Self {
        let is_hollow = random.one_in(2);
        let least = if is_hollow { 3 } else { 1 };
        let ends = random_box(random, [[0; 3], [SIDE; 3]], least);
        let within = [ends[0].map(|c| c + 1), ends[1].map(|c| c - 1)];
        Self { ends, cavity: is_hollow.then(|| random_box(random, within, 1)) }
    }

    fn cells(&self) -> Cells {
        let [x, y, z] = [0, 1, 2].map(|k| self.ends[0][k]..self.ends[1][k]);
        let is_left_out = |cell: [i64; 3]| {
            let contains =
                |[low, high]: [[i64; 3]; 2]| (0..3).all(|k| low[k] <= cell[k] && cell[k] < high[k]);
            self.cavity.is_some_and(contains)
        };
        let cells = x.flat_map(|x| {
            let z = z.clone();
            y.clone().flat_map(move |y| z.clone().map(move |z| [x, y, z]))
        });
        Cells(cells.filter(|c| !is_left_out(*c)).map(|c| c.map(|c| c as i32)).collect())
    }
}

/// Draws a box within a box, whose sides are at least `least`.
fn random_box(random: &mut Random, [low, high]: [[i64; 3]; 2], least: i64) -> [[i64; 3]; 2] {
    let lows = [0, 1, 2].map(|k| random.int(low[k], high[k] - least));
    [lows, [0, 1, 2].map(|k| random.int(lows[k] + least, high[k]))]
}

/// Builds the union of pieces, and its cubes.
fn union(pieces: &[Cells], random: &mut Random) -> Result<(Solid, Cells), String> {
    let mut solids = Vec::new();
    for piece in pieces {
        let (vertices, facets) = piece.surface(DMat3::IDENTITY, random);
        solids.push(Solid::from_mesh(&vertices, &facets).map_err(|e| e.to_string())?);
    }
    let all: BTreeSet<[i32; 3]> = pieces.iter().flat_map(|piece| piece.0.iter().copied()).collect();
    Ok((Solid::from_pieces(&solids).map_err(|e| e.to_string())?, Cells(all)))
}

/// Draws a setting of a family, computes the answers, and judges them.
///
/// # Errors
/// A description of the first disagreement.
pub fn examine(family: &str, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let random = &mut Random::stream(seed, &[family.len() as u64, 0x0410]);
    let pieces: Vec<Piece> = (0..random.int(2, 4)).map(|_| Piece::random(random)).collect();
    let cavity = pieces.iter().find_map(|piece| piece.cavity);
    let moving = match family {
        "unions" => (0..2).map(|_| Piece::random(random).cells()).collect(),
        "boxes" | "fillings" => {
            let ends = match cavity.filter(|_| family == "fillings") {
                Some(cavity) => cavity,
                None => random_box(random, [[0; 3], [SIDE; 3]], 1),
            };
            vec![Piece { ends, cavity: None }.cells()]
        }
        _ => return Err(format!("unknown family {family}")),
    };
    tally.count("settings");
    let fixed: Vec<Cells> = pieces.iter().map(Piece::cells).collect();
    let bodies = [union(&moving, random)?, union(&fixed, random)?];
    let [moving, fixed] = if random.one_in(2) { [0, 1] } else { [1, 0] }.map(|k| &bodies[k]);
    let by = match random.int(0, 3) {
        0 => random.grid(-4, 4) * 4.0,
        1 => random.grid(-16, 16),
        _ => DVec3::ZERO,
    };
    let pose = |by: DVec3| Pose::from_translation(by).map_err(|e| e.to_string());
    let poses = [pose(by / 4.0)?, pose(DVec3::ZERO)?];
    let direction = way(random);
    let cast = exactly([&moving.0, &fixed.0], poses, direction)?;
    let offset = Vector::new(-by / 4.0);
    let identity = [DMat3::IDENTITY; 2];
    let along = |way: DVec3| motion((&moving.1, &fixed.1), identity, &offset, way);
    let size = size([moving.0.vertices(), fixed.0.vertices()], poses.each_ref());
    let tolerance = AGREEMENT * 16.0 * f64::EPSILON * size / direction.length();
    let expected = along(direction);
    if cast.overlaps() != expected.overlaps {
        return Err(format!("overlaps: {}", cast.overlaps()));
    }
    judge_motion(&cast, &expected, along(-direction).exit.as_ref(), tolerance, false)?;
    let exact = Exact { moving: &moving.1, fixed: &fixed.1, by: by.to_array().map(|c| c as i64) };
    let meets = cast.intersects().map_err(|e| e.to_string())?.meets;
    if meets != exact.touch() {
        return Err(format!("intersects: {meets}"));
    }
    let pair = Pair::new(moving.0.at(poses[0]), fixed.0.at(poses[1])).map_err(|e| e.to_string())?;
    exact.judge(&pair, 0.0, false, tally)
}
