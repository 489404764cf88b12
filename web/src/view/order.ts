// In which order facets are drawn so that the nearer covers the farther.
//
// At each sample of the page the facets that cover it tell who is to be drawn before whom; facets that
// are seen at none are left out. Facets that go in a circle, as those of bodies that stand in each
// other, are cut in four until they do not; the last circles are pixels wide and are cut open where the
// farthest is. Facets of one style are drawn one after the other where they can be.
//
// Source: the sort of Newell, Newell and Sancha (1972), its questions being asked of samples.

import { type Corners, type Point, cover } from "./depths";

export interface Facet {
  corners: Corners;
  style: string;
  opaque: boolean;
}

const ROUNDS = 8;
/** Facets of a smaller area are not cut: pixels. */
const SMALL = 2;

/** `slack`: lengths along the view that are no difference. */
export function ordered(facets: Facet[], wide: number, high: number, slack: number): Facet[] {
  let all = facets;
  for (let round = 0; ; round++) {
    const { seen, after, before } = constraints(all, wide, high, slack);
    const circles = round < ROUNDS ? inCircles(seen, after, before) : new Set<number>();
    const cut = new Set([...circles].filter((k) => area(all[k]!.corners) > SMALL));
    if (!cut.size) return sorted(all, seen, after, before).map((k) => all[k]!);
    all = seen.flatMap((k) => (cut.has(k) ? quarters(all[k]!) : [all[k]!]));
  }
}

/** The facets that are seen somewhere; whom each is drawn before, and how many before it. */
interface Constraints {
  seen: number[];
  after: Map<number, Set<number>>;
  before: Map<number, number>;
}

function constraints(facets: Facet[], wide: number, high: number, slack: number): Constraints {
  const layers = new Map<number, { facet: number; z: number }[]>();
  facets.forEach(({ corners }, facet) => {
    cover(corners, 1, wide, high, (cell, q) => {
      const here = layers.get(cell);
      if (here) here.push({ facet, z: 1 / q });
      else layers.set(cell, [{ facet, z: 1 / q }]);
    });
  });
  const seen = new Set<number>();
  const after = new Map<number, Set<number>>();
  const before = new Map<number, number>();
  const rule = (first: { facet: number; z: number }, then: { facet: number; z: number }) => {
    if (first.z - then.z <= slack) return;
    let rules = after.get(first.facet);
    if (!rules) after.set(first.facet, (rules = new Set()));
    if (rules.has(then.facet)) return;
    rules.add(then.facet);
    before.set(then.facet, (before.get(then.facet) ?? 0) + 1);
  };
  for (const [cell, here] of layers) {
    here.sort((a, b) => b.z - a.z);
    const front = here.findLastIndex(({ facet }) => facets[facet]!.opaque);
    here.forEach((layer, k) => {
      if (k < front) rule(layer, here[front]!);
      else if (here[k + 1]) rule(layer, here[k + 1]!);
      // What touches the nearest may be seen beside it.
      if (k >= front || layer.z - here[front]!.z <= slack) seen.add(layer.facet);
    });
    layers.set(cell, here.slice(Math.max(0, front)));
  }
  facets.forEach(({ corners }, facet) => {
    for (const p of longestSide(corners)) {
      const z = 1 / p.q;
      let hidden = false;
      for (const { facet: other } of (p.x >= 0 && p.x < wide && layers.get(Math.floor(p.y) * wide + Math.floor(p.x))) || []) {
        const q = other === facet ? undefined : inside(facets[other]!.corners, p);
        if (q === undefined) continue;
        rule({ facet, z }, { facet: other, z: 1 / q });
        hidden ||= facets[other]!.opaque && z - 1 / q > slack;
      }
      if (!hidden) seen.add(facet);
    }
  });
  // Rules with those that are left out are none.
  for (const [first, rules] of after) {
    if (seen.has(first)) continue;
    for (const then of rules) before.set(then, before.get(then)! - 1);
    after.delete(first);
  }
  for (const rules of after.values()) for (const then of rules) if (!seen.has(then)) rules.delete(then);
  return { seen: [...seen].sort((a, b) => a - b), after, before };
}

/** Those that neither come before nor after all circles. */
function inCircles(seen: number[], after: Map<number, Set<number>>, before: Map<number, number>): Set<number> {
  const left = new Set(seen);
  const back = new Map<number, number[]>();
  for (const [first, rules] of after) for (const then of rules) back.set(then, [...(back.get(then) ?? []), first]);
  const trim = (next: (k: number) => Iterable<number>, count: (k: number) => number) => {
    const waits = new Map([...left].map((k) => [k, count(k)]));
    const ready = [...left].filter((k) => !waits.get(k));
    for (let k = ready.pop(); k !== undefined; k = ready.pop()) {
      left.delete(k);
      for (const then of next(k)) {
        if (!left.has(then)) continue;
        waits.set(then, waits.get(then)! - 1);
        if (!waits.get(then)) ready.push(then);
      }
    }
  };
  trim((k) => after.get(k) ?? [], (k) => before.get(k) ?? 0);
  trim((k) => back.get(k) ?? [], (k) => [...(after.get(k) ?? [])].filter((then) => left.has(then)).length);
  return left;
}

function sorted(facets: Facet[], seen: number[], after: Map<number, Set<number>>, before: Map<number, number>): number[] {
  const waits = new Map(seen.map((k) => [k, before.get(k) ?? 0]));
  const near = (k: number) => facets[k]!.corners.reduce((sum, { q }) => sum + q, 0);
  const byDistance = seen.slice().sort((a, b) => near(a) - near(b));
  // Opaque ones as early as can be: their rims are not to be seen on what is translucent.
  const [opaque, sheer] = [new Map<string, number[]>(), new Map<string, number[]>()];
  const put = (k: number) => {
    const pool = facets[k]!.opaque ? opaque : sheer;
    const { style } = facets[k]!;
    const same = pool.get(style);
    if (same) same.push(k);
    else pool.set(style, [k]);
  };
  const drawn = new Set<number>();
  byDistance.filter((k) => !waits.get(k)).reverse().forEach(put);
  let [style, next] = ["", 0];
  while (drawn.size < seen.length) {
    if (!opaque.size && !sheer.size) {
      // A circle.
      while (drawn.has(byDistance[next]!)) next++;
      put(byDistance[next]!);
    }
    const pool = opaque.size ? opaque : sheer;
    if (!pool.has(style)) style = [...pool].reduce((best, one) => (near(one[1].at(-1)!) < near(best[1].at(-1)!) ? one : best))[0];
    const same = pool.get(style)!;
    const k = same.pop()!;
    if (!same.length) pool.delete(style);
    drawn.add(k);
    for (const then of after.get(k) ?? []) {
      waits.set(then, waits.get(then)! - 1);
      if (!waits.get(then) && !drawn.has(then)) put(then);
    }
  }
  return [...drawn];
}

/** Points along it, a pixel apart; none of its ends. */
function longestSide([a, b, c]: Corners): Point[] {
  const length = ([p, r]: [Point, Point]) => Math.hypot(r.x - p.x, r.y - p.y);
  const side = ([[a, b], [b, c], [c, a]] as [Point, Point][]).reduce((best, one) => (length(one) > length(best) ? one : best));
  const count = Math.min(1e4, Math.ceil(length(side)));
  const [p, r] = side;
  return Array.from({ length: count }, (_, k) => {
    const s = (k + 0.5) / count;
    return { x: p.x + s * (r.x - p.x), y: p.y + s * (r.y - p.y), q: p.q + s * (r.q - p.q) };
  });
}

/** The q of a triangle at a point of the page that is inside it, by more than rounding. */
function inside([a, b, c]: Corners, { x, y }: Point): number | undefined {
  const twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const share = (p: Point, r: Point) => ((r.x - p.x) * (y - p.y) - (r.y - p.y) * (x - p.x)) / twice;
  const [u, v, w] = [share(b, c), share(c, a), share(a, b)];
  return Math.min(u, v, w) > 1e-6 ? u * a.q + v * b.q + w * c.q : undefined;
}

/** On the page. */
function area([a, b, c]: Corners): number {
  return Math.abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
}

function quarters(facet: Facet): Facet[] {
  const [a, b, c] = facet.corners;
  const half = (p: Point, r: Point): Point => ({ x: (p.x + r.x) / 2, y: (p.y + r.y) / 2, q: (p.q + r.q) / 2 });
  const [ab, bc, ca] = [half(a, b), half(b, c), half(c, a)];
  return ([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] as Corners[]).map((corners) => ({ ...facet, corners }));
}
