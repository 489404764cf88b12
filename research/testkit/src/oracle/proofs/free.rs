//! Proofs of free directions.
//!
//! The truth is evaluated along some directions of the cells, including their corners. The facets that block a
//! direction are found among all pairs, exactly.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use colltrans::ProofFile;
use colltrans::removal::directions::{FreeDirections, FreeOptions};
use colltrans::solid::StartOverlap;
use glam::DVec3;
use serde_json::{Value, json};

use super::file::{Bodies, indices};
use super::mutants::with;
use super::solids::{of_cubes, surface};
use super::{CheckerKind, Claim, Kind};
use crate::oracle::exact::Ratio;
use crate::oracle::solids::facets::{FacetJudge, Triangle};
use crate::random::Random;

/// Free directions.
pub const FREE: Kind = Kind {
    name: "free-directions",
    focus: STATEMENT,
    draw_proof: base,
    claims,
    to_limits: worst,
    find_falsehood: falsehood,
    is_marginal: |_| false,
};

const STATEMENT: &str = "/statement/free_directions";
const CELLS: &str = "/statement/free_directions/cells";

/// Maximum number of facets of both bodies.
const MOST_FACETS: usize = 60;

/// Maximum number of cells of each kind for which a file is judged along a direction.
const DIRECTIONS: usize = 8;

fn base(seed: u64) -> Option<String> {
    let ([a, b], poses, _) = of_cubes(seed)?;
    if a.triangles().len() + b.triangles().len() > MOST_FACETS {
        return None;
    }
    let random = &mut Random::stream(seed, &[0xf4ee]);
    let start = if random.one_in(3) { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let tolerance = random.pick(&[Some(0.0), Some(0.0), Some(1e-3), None]);
    let options = FreeOptions::DEFAULT
        .with_tolerance(tolerance)
        .with_start_overlap(start)
        .with_depth(random.pick(&[0, 1, 2, 50]))
        .with_looks(random.pick(&[1_000, 30_000]));
    let free = FreeDirections::compute(&a.at(poses[0]), &b.at(poses[1]), options).ok()?;
    let text = ProofFile::of_free_directions(&free, [&[&a], &[&b]]).ok()?.to_json();
    (text.len() < 60_000).then_some(text)
}

/// Returns no claims, because the statements of cells have no numbers.
fn claims(_: &Value) -> Vec<Claim> {
    Vec::new()
}

/// Strengthens the statement of a cell, a box or a vertex.
fn worst(file: &mut Value, random: &mut Random) {
    let Some(cells) = file.pointer(CELLS).and_then(Value::as_array) else { return };
    if cells.is_empty() {
        return;
    }
    if random.one_in(5) {
        return move_number(file, random);
    }
    let leaves: Vec<usize> = (0..cells.len()).filter(|k| cells[*k].is_object()).collect();
    let k = leaves[random.index(leaves.len())];
    let pairs = |of: &Value| -> Vec<Value> {
        let list = |name| of.get(name).and_then(Value::as_array).cloned();
        let blocked = of.get("blocked").map(|pair| vec![pair.clone()]);
        blocked.or_else(|| list("open")).or_else(|| list("undecided")).unwrap_or_default()
    };
    let (mine, other) = (pairs(&cells[k]), pairs(&cells[leaves[random.index(leaves.len())]]));
    let mut fewer = mine.clone();
    if !fewer.is_empty() {
        fewer.remove(random.index(fewer.len()));
    }
    let more: Vec<Value> = mine.iter().chain(&other).cloned().collect();
    let cell = match random.index(8) {
        0 => json!({ "open": fewer }),
        1 => json!({ "undecided": more }),
        2 => json!({ "open": more }),
        3 => json!({ "open": mine }),
        4 => match other.first().or(mine.first()) {
            Some(pair) => json!({ "blocked": pair }),
            None => json!({ "inner": [0, 0] }),
        },
        5 => cells[leaves[random.index(leaves.len())]].clone(),
        6 => json!({ "inner": [random.index(3), random.index(3)] }),
        // Replaces a cut cell by a single one with the statement of its first quarter.
        _ => {
            let mut joined = cells.clone();
            let cut = (0..cells.len().saturating_sub(4))
                .filter(|k| cells[*k] == "cut" && cells[k + 1..=k + 4].iter().all(Value::is_object))
                .nth(random.index(4));
            if let Some(cut) = cut {
                let kept = joined[cut + 1 + random.index(4)].clone();
                joined.splice(cut..=cut + 4, [kept]);
                *file = with(file, CELLS, Some(Value::from(joined)));
            }
            return;
        }
    };
    *file = with(file, &format!("{CELLS}/{k}"), Some(cell));
}

/// Moves an end of a box, or a coordinate of a shrunk body.
fn move_number(file: &mut Value, random: &mut Random) {
    let is_length = |at: &&String| {
        let inside = at.strip_prefix(STATEMENT).unwrap_or("");
        inside.starts_with("/boxes") || inside.starts_with("/shrunk")
    };
    let all = super::mutants::pointers(file);
    let numbers: Vec<&String> = all
        .iter()
        .filter(is_length)
        .filter(|at| file.pointer(at).is_some_and(Value::is_f64))
        .collect();
    if numbers.is_empty() {
        return;
    }
    let at = numbers[random.index(numbers.len())];
    let x = file.pointer(at).and_then(Value::as_f64).unwrap_or(0.0);
    let x = super::mutants::other_number(x, random);
    *file = with(file, at, Some(super::mutants::number(x)));
}

/// A cell of directions of a proof: `s e_k + u e_(k+1) + v e_(k+2)`, with `u` and `v` starting at `-1 + 2 at /
/// 2^depth`.
#[derive(Debug, Clone, Copy)]
struct Square {
    side: usize,
    depth: i32,
    at: [f64; 2],
}

impl Square {
    /// Returns the direction at fractions of its sides.
    fn direction(self, across: [f64; 2]) -> DVec3 {
        let place = |k: usize| (self.at[k] + across[k]) * 2.0_f64.powi(1 - self.depth) - 1.0;
        let mut d = [0.0; 3];
        let k = self.side / 2;
        d[k] = if self.side % 2 == 1 { -1.0 } else { 1.0 };
        d[(k + 1) % 3] = place(0);
        d[(k + 2) % 3] = place(1);
        DVec3::from_array(d)
    }

    fn quarters(self) -> [Self; 4] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|by| {
            let at = [0, 1].map(|k| 2.0 * self.at[k] + by[k]);
            Self { depth: self.depth + 1, at, ..self }
        })
    }
}

/// Returns every cell that is not cut, with its statement; `None` if the cells do not cover the sphere.
fn leaves(cells: &[Value]) -> Option<Vec<(Square, &Value)>> {
    let mut stack: Vec<Square> =
        (0..6).rev().map(|side| Square { side, depth: 0, at: [0.0; 2] }).collect();
    let mut found = Vec::new();
    for said in cells {
        let square = stack.pop()?;
        if said == "cut" {
            stack.extend(square.quarters().into_iter().rev());
        } else {
            found.push((square, said));
        }
    }
    stack.is_empty().then_some(found)
}

fn falsehood(file: &Value, _: CheckerKind) -> Option<String> {
    let Some(bodies) = shrunk(file).as_ref().and_then(Bodies::read) else {
        return Some("invalid bodies".into());
    };
    let cells = file.pointer(CELLS).and_then(Value::as_array).and_then(|cells| leaves(cells));
    let Some(mut leaves) = cells else { return Some("the cells do not cover the sphere".into()) };
    let surfaces = [0, 1].map(|k| surface(&bodies, k));
    // A file is judged along the same directions each time, with equal numbers in cells of each kind.
    let mut hasher = DefaultHasher::new();
    file.to_string().hash(&mut hasher);
    let random = &mut Random::stream(hasher.finish(), &[0xd14]);
    for k in (1..leaves.len()).rev() {
        leaves.swap(k, random.index(k + 1));
    }
    let mut judged: BTreeMap<String, usize> = BTreeMap::new();
    leaves.into_iter().find_map(|(square, said)| {
        let kind = said.as_object()?.keys().next()?.clone();
        let count = judged.entry(kind).or_default();
        *count += 1;
        let mut share = || {
            let inside = f64::from(random.int(1, 63) as i32) / 64.0;
            random.pick(&[0.0, 1.0, inside, inside])
        };
        let d = square.direction([share(), share()]);
        (*count <= DIRECTIONS).then(|| false_cell(&surfaces, said, d)).flatten()
    })
}

/// Returns the false statement of a cell along one of its directions; `None` if it is true. An undecided cell
/// claims only the directions that pairs of facets of these bodies block.
fn false_cell(surfaces: &[Vec<Triangle>; 2], said: &Value, d: DVec3) -> Option<String> {
    let judge = FacetJudge::new(d);
    // Facets that intersect at the start do not block.
    let blocks = |f: &Triangle, g: &Triangle| {
        let gaps = judge.gaps(f, g);
        let crosses = gaps.range.as_ref().is_some_and(|range| range[0] < Ratio::from_f64(0.0));
        !crosses && gaps.contribution().is_some()
    };
    let is_blocked = |pair: &Value| {
        let pair = indices(pair).unwrap_or_default();
        let facet = |k: usize| surfaces[k].get(*pair.get(k)?);
        matches!((facet(0), facet(1)), (Some(f), Some(g)) if blocks(f, g))
    };
    let claimed = match said.get("open") {
        Some(pairs) => pairs.as_array().is_some_and(|pairs| pairs.iter().any(is_blocked)),
        None if said.get("undecided").is_some() => return None,
        None => true,
    };
    let truth = surfaces[0].iter().any(|f| surfaces[1].iter().any(|g| blocks(f, g)));
    let word = if truth { "blocked" } else { "free" };
    (claimed != truth).then(|| format!("{d:?} is {word}, and {said} says otherwise"))
}

/// Returns the file with its bodies replaced by their shrunk form.
fn shrunk(file: &Value) -> Option<Value> {
    let Some(sides) = file.pointer(&format!("{STATEMENT}/shrunk")).filter(|of| !of.is_null())
    else {
        return Some(file.clone());
    };
    let mut file = file.clone();
    let sides = sides.clone();
    for k in 0..2 {
        let body = file.pointer(&format!("/placement/poses/{k}/body"))?.as_u64()?;
        let vertices = sides.get(k)?.as_array()?;
        let mut from = 0;
        for piece in file.pointer_mut(&format!("/bodies/{body}/pieces"))?.as_array_mut()? {
            let count = piece.get("vertices")?.as_array()?.len();
            piece["vertices"] = Value::from(vertices.get(from..from + count)?.to_vec());
            from += count;
        }
    }
    Some(file)
}
