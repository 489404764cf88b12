//! Precedence of steps: the partial order of a plan, its reverse for assembly, and tables of both.

use serde_json::{Value, json};

use super::{HandlingTimes, Plan, Step};
use crate::csv::{Cell, Table};
use crate::matrix::ContactMatrix;
use crate::part::Assembly;

/// Maximum number of alternatives that are listed for a part.
const MAX_WAYS: usize = 16;

impl Plan {
    /// Returns the steps in rounds. Each step waits for a step of the round before, so the steps of one round are
    /// independent.
    pub fn parallel_rounds(&self) -> Vec<Vec<usize>> {
        let mut round = vec![0; self.steps.len()];
        let mut rounds: Vec<Vec<usize>> = Vec::new();
        for (k, step) in self.steps.iter().enumerate() {
            round[k] = step.predecessors.iter().map(|&before| round[before] + 1).max().unwrap_or(0);
            if rounds.len() <= round[k] {
                rounds.push(Vec::new());
            }
            rounds[round[k]].push(k);
        }
        rounds
    }

    /// Returns the assembly sequence: the steps in reverse order, each with the indices in this list of its
    /// predecessors.
    ///
    /// A group is put together before it is inserted. Each move is valid in reverse by the same proof; parts that a
    /// step unscrews are screwed in.
    pub fn assembly_sequence(&self) -> Vec<(usize, Vec<usize>)> {
        let last = self.steps.len().saturating_sub(1);
        let mut before = vec![Vec::new(); self.steps.len()];
        for (k, step) in self.steps.iter().enumerate().rev() {
            for &earlier in &step.predecessors {
                before[earlier].push(last - k);
            }
        }
        before.into_iter().enumerate().rev().collect()
    }

    /// Returns the steps as CSV, numbered from 1. The columns are the parts, direction, travel, turns, number of
    /// moves, enclosing step, preceding steps, round, and seconds. If there are fasteners, further columns have the
    /// kind and the size of a single one, the length, turns and pitch of its unscrewing, its tool, and the parts in the
    /// way of it.
    pub fn to_csv(&self, assembly: &Assembly, times: &HandlingTimes) -> String {
        let mut heads = vec![
            "step",
            "parts",
            "direction_x",
            "direction_y",
            "direction_z",
            "travel",
            "turns",
            "moves",
            "within",
            "after",
            "round",
            "seconds",
        ];
        let has_fasteners = !self.fasteners.is_empty();
        if has_fasteners {
            heads.extend(FASTENER_COLUMNS);
        }
        let mut table = Table::new(&heads);
        let seconds = times.step_seconds(self);
        let rounds = self.parallel_rounds();
        let numbers = |steps: &[usize]| {
            steps.iter().map(|k| (k + 1).to_string()).collect::<Vec<_>>().join(" ")
        };
        let in_the_way = |step: &Step| {
            let reach = step.tool.as_ref();
            reach.map_or_else(String::new, |reach| assembly.part_names(&reach.blockers).join("; "))
        };
        let blockers: Vec<String> = self.steps.iter().map(in_the_way).collect();
        for (k, step) in self.steps.iter().enumerate() {
            let round = rounds.iter().position(|round| round.contains(&k)).unwrap_or(0);
            let parts = assembly.part_names(&step.parts).join("; ");
            let (within, after) =
                (step.group_step.map_or(Vec::new(), |w| vec![w]), &step.predecessors);
            let (within, after) = (numbers(&within), numbers(after));
            let mut cells = vec![
                Cell::Number((k + 1) as f64),
                Cell::Text(&parts),
                Cell::Number(step.direction.x),
                Cell::Number(step.direction.y),
                Cell::Number(step.direction.z),
                Cell::Number(step.travel.value),
                Cell::Number(step.first_turn().map_or(0.0, |turn| turn.turns)),
                Cell::Number(step.path.len() as f64),
                Cell::Text(&within),
                Cell::Text(&after),
                Cell::Number((round + 1) as f64),
                Cell::Number(seconds[k]),
            ];
            if has_fasteners {
                let fastener = match step.parts[..] {
                    [part] => self.fasteners.get(part),
                    _ => None,
                };
                cells.push(Cell::Text(fastener.map_or("", |f| f.kind.name())));
                cells.push(Cell::Text(fastener.map_or("", |f| &f.designation)));
                cells.extend(match step.unscrewing {
                    Some(own) => [own.length, own.turns(), own.pitch].map(Cell::Number),
                    None => [Cell::Text(""); 3],
                });
                cells.push(Cell::Text(step.tool.as_ref().map_or("", |reach| &reach.tool)));
                cells.push(Cell::Text(&blockers[k]));
            }
            table.push_row(&cells);
        }
        table.into_text()
    }
}

/// Names of the columns of fasteners.
const FASTENER_COLUMNS: [&str; 7] = [
    "fastener",
    "size",
    "unscrew_length",
    "unscrew_turns",
    "unscrew_pitch",
    "tool",
    "tool_blocked_by",
];

/// Returns the precedence of all parts as an AND/OR graph, along the directions of a matrix.
///
/// A part can leave if for one of its alternatives (OR) all parts that it lists (AND) have left or leave with it.
/// Alternatives that contain another one or a fixed part are omitted, and fixed parts have no entry. At most 16
/// alternatives are listed for a part. Interlocked parts, and the parts of a subassembly, list each other and leave
/// as a group.
pub fn precedence_graph(assembly: &Assembly, matrix: &ContactMatrix) -> Value {
    let parts = assembly.parts();
    let constraints = assembly.constraints();
    let order = constraints.order_arcs(&vec![true; parts.len()]);
    let mut graph = serde_json::Map::new();
    for (part, of) in parts.iter().enumerate().filter(|(_, of)| !of.is_fixed()) {
        let mut ways: Vec<(Vec<usize>, usize)> = Vec::new();
        let before = || order.iter().filter(|arc| arc.0 == part).map(|arc| arc.1);
        for (k, &d) in matrix.directions().iter().enumerate() {
            let mut met: Vec<usize> =
                matrix.contacts_of_part(k, part).iter().map(|m| m.fixed).chain(before()).collect();
            met.sort_unstable();
            met.dedup();
            if constraints.allows_direction(&[part], d)
                && !met.iter().any(|&by| parts[by].is_fixed())
            {
                ways.push((met, k));
            }
        }
        ways.sort_by_key(|(met, k)| (met.len(), *k));
        let mut least: Vec<(Vec<usize>, usize)> = Vec::new();
        for (met, k) in ways {
            let holds = |(known, _): &(Vec<usize>, usize)| known.iter().all(|x| met.contains(x));
            if least.len() < MAX_WAYS && !least.iter().any(holds) {
                least.push((met, k));
            }
        }
        let way = |(met, k): &(Vec<usize>, usize)| json!({ "direction": matrix.directions()[*k].to_array(), "and": assembly.part_names(met) });
        graph.insert(
            of.name().to_owned(),
            json!({ "or": least.iter().map(way).collect::<Value>() }),
        );
    }
    Value::Object(graph)
}
