// An answer as text.

import type { Feature, PageCast, PageConvex, PageSolid } from "./answers";
import { type Slot, plane, touch } from "./engine";
import { length, short, shown } from "./math";
import { isRound } from "./primitive";
import type { State } from "./state";

export interface Said {
  /** The kind of message, shown by a colour and a sign. */
  kind: "stop" | "free" | "care";
  headline: string;
  sentence: string;
  rows: [string, string][];
}

/** Describes a feature, with the vertex numbers of its file. */
export function feature(of: { kind: Feature["kind"]; vertices: readonly number[] }): string {
  const { length } = of.vertices;
  const list = length > 8 ? `${of.vertices.slice(0, 8).join(" ")} … (${length} in all)` : of.vertices.join(" ");
  if (of.kind === "vertex") return `vertex ${list}`;
  return of.kind === "edge" ? `edge ${of.vertices.join("–")}` : `face of vertices ${list}`;
}

/** Describes the feature of a body in contact. That of a rounded body is a feature of its core. */
export function met(of: { kind: string }, slot: Slot, state: State): string {
  const [what, body] = [of.kind === "edge" ? "an edge" : `a ${of.kind}`, slot === "moving" ? "the moving body" : "the fixed one"];
  return isRound(state.parts[slot].file) ? `${body} (at ${what} of its core)` : `${what} of ${body}`;
}

/** Formats a number without exceeding a limit: with a few digits if they do not exceed it, otherwise a dozen, rounded down. */
function within(x: number, limit: number): string {
  const text = short(x);
  if (Number(text.replace("−", "-")) <= limit) return text;
  const step = 10 ** (Math.floor(Math.log10(Math.abs(limit))) - 11);
  return short(Math.floor(limit / step) * step, 12);
}

/** Formats a translation up to a limit, and as a length if that is another number. */
function way(t: number, limit: number, state: State): string {
  const l = length(state.direction);
  const far = within(t, limit);
  return Math.abs(l - 1) < 1e-12 ? far : `${far} d, a length of ${within(t * l, limit * l * (1 - 1e-15))}`;
}

const proven = (bounds: readonly (number | null)[] | null | undefined) =>
  (bounds ?? []).map((x) => (x === null ? "?" : short(x, 15))).join(" to ");

export function say(answer: PageCast, state: State): Said {
  return answer.kind === "convex" ? convex(answer, state) : solid(answer, state);
}

function convex(answer: PageConvex, state: State): Said {
  const { record, clearance } = answer;
  const [first, between] = [touch(answer), plane(answer)];
  if (!first) {
    return {
      kind: "free",
      headline: "They never meet",
      sentence: `The bodies pass each other along d; the gap between their shadows is at least ${short(between?.margin ?? 0)} wide.`,
      rows: [["margin", short(between?.margin ?? 0, 12)], ["plane's normal", shown(between?.normal ?? [0, 0, 0])]],
    };
  }
  const rows: [string, string][] = [
    ["first contact t", short(first.t, 12)],
    ["proven", proven(record.translation_bounds)],
    ["last contact t", short(record.exit ?? first.t, 12)],
    ["proven", proven(record.exit_bounds)],
    ["length", short(first.t * length(state.direction), 12)],
    ["normal n", shown(first.normal)],
    ["point", first.point.map((x) => short(x, 7)).join(", ")],
    ["moving", feature(first.features.moving)],
    ["fixed", feature(first.features.fixed)],
  ];
  const meeting = `${met(first.features.moving, "moving", state)} meets ${met(first.features.fixed, "fixed", state)}`;
  if (record.outcome === "grazing") {
    return {
      kind: "care",
      headline: "The bodies slide along each other",
      sentence:
        `Their shadows overlap by ${short(record.overlap ?? 0)}, at most the graze tolerance, so nothing blocks. ` +
        `If the overlap were real, they would touch at t = ${short(first.t)}.`,
      rows: [["sideways overlap", short(record.overlap ?? 0, 6)], ...rows],
    };
  }
  if (clearance.outcome === "behind") {
    return {
      kind: "free",
      headline: "The contact is behind the body",
      sentence: `Nothing stops the moving body ahead; the bodies meet from t = ${short(first.t)} to ${short(record.exit ?? first.t)}.`,
      rows,
    };
  }
  if (clearance.outcome === "overlapping") {
    return {
      kind: "care",
      headline: "They overlap now",
      sentence: `The bodies meet from t = ${short(first.t)}, behind, to ${short(record.exit ?? 0)}, ahead, where they part.`,
      rows,
    };
  }
  return {
    kind: "stop",
    headline: `Contact at t = ${short(first.t)}`,
    sentence: `Free for ${way(first.t, clearance.distance ?? first.t, state)}; then ${meeting}.`,
    rows,
  };
}

function solid(answer: PageSolid, state: State): Said {
  const { tolerance: used = 0, exit_bounds: [, gone] = [0, 0], surfaces = [], ...record } = answer.record;
  const tolerance: [string, string] = ["tolerance", short(used, 3)];
  const exit: [string, string][] = gone === null || gone <= 0 ? [] : [["no contact after t", String(gone)]];
  const open: [string, string][] = surfaces.length ? [["open surface", `${surfaces.join(" and ")}: blocks from both sides, including its boundary`]] : [];
  const [first, margin] = [touch(answer), plane(answer)?.margin];
  if (record.outcome === "free") {
    return {
      kind: "free",
      headline: "Nothing stops it",
      sentence: margin
        ? `The moving body can move without limit: a plane parallel to d separates the bodies, with a gap of at least ${short(margin)}.`
        : "The moving body can move without limit.",
      rows: [...(margin ? [["margin", short(margin, 9)] as [string, string]] : []), ...exit, tolerance, ...open],
    };
  }
  if (!first) {
    const depth = record.start_overlaps?.[0].least_tolerance ?? null;
    return {
      kind: "care",
      headline: "The bodies overlap at the start",
      sentence:
        depth === null
          ? surfaces.length
            ? "A surface passes through the other body; no tolerance frees it."
            : "One body is inside the other, deeper than any tolerance reaches."
          : depth < used
          ? `With a tolerance of ${short(depth)} they would not: one of ${short(used)} is more than the bodies are thick, and turns them inside out.`
          : `With a tolerance of ${short(depth)} they would not: that is how deep they are in each other.`,
      rows: [...(depth === null ? [] : [["depth", short(depth, 9)] as [string, string]]), ...exit, tolerance, ...open],
    };
  }
  const shrunk = record.offset_distance_bounds?.[0] ?? first.t;
  return {
    kind: "stop",
    headline: `Blocked at t = ${within(Math.max(first.t, 0), shrunk)}`,
    sentence: `Free for ${way(Math.max(first.t, 0), shrunk, state)}; then ${met(first.features.moving, "moving", state)} meets ${met(first.features.fixed, "fixed", state)}.`,
    rows: [
      ["safe for t up to", String(record.distance)],
      ["t, nominal bodies", short(first.t, 12)],
      ["proven", proven(record.translation_bounds)],
      ["t, bodies shrunk", short(record.offset_distance ?? first.t, 12)],
      ["proven", proven(record.offset_distance_bounds)],
      ...exit,
      ["normal n", shown(first.normal)],
      ["point", first.point.map((x) => short(x, 7)).join(", ")],
      ["moving", feature(first.features.moving)],
      ["fixed", feature(first.features.fixed)],
      tolerance,
      ...open,
    ],
  };
}
