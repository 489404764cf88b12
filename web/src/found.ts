// How the answer was found: the paper's figures, from the library's recording of a search.
//
// Left of it, in the view, the bodies are translucent and show the two sections of the step that is
// looked at, the moving one's where it starts and where it touches the other.

import { BufferGeometry, DoubleSide, Line, LineBasicMaterial, LineLoop, Mesh, MeshBasicMaterial, Vector3 } from "three";
import type { PageSearch } from "./answers";
import { palette } from "./colours";
import { h, refill, svg } from "./dom";
import type { Engine, Pair } from "./engine";
import { Graph, type Grid } from "./found/graph";
import { type Minimisation, below, minimisation, portals } from "./found/recording";
import { type Vec, add, cross, dot, hull, length, placed, short, sub, times, unit } from "./math";
import type { State } from "./state";
import type { View } from "./view";
import type { Drawn } from "./view/body";

type Two = [number, number];
const GRID = 44;
const SIZE = 340;

/** The two sections of a step, in the world, at the start. */
interface Sections {
  moving: Vec[];
  fixed: Vec[];
  /** In multiples of the direction. */
  phi: number;
}

export class Found {
  readonly element = h("div", { class: "found" });
  private readonly head = h("section", { class: "said" });
  private readonly graph = new Graph();
  private readonly steps = h("div", { class: "row steps", role: "group", "aria-label": "Steps" });
  private readonly told = h("p", { class: "proof" });
  private readonly planar = svg("svg", { class: "figure", viewBox: `0 0 ${SIZE} 230`, role: "img", "aria-label": "Both sections in the shadow plane" });
  private readonly portalSteps = h("div", { class: "row steps", role: "group", "aria-label": "Portals" });
  private readonly portalPicture = svg("svg", { class: "figure", viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", "aria-label": "M seen along d" });
  private readonly portalTold = h("p", { class: "proof" });
  private readonly tracker = h("p", { class: "proof" });
  private readonly near = h("p", { class: "proof" });
  private readonly from = h("select", { "aria-label": "Where the minimisation starts" });
  private readonly body: HTMLElement;
  private visible = false;
  private stale = true;
  private asked = 0;
  private found: Minimisation | undefined;
  private refined: ReturnType<typeof portals>;
  private grid: Grid | undefined;
  private step = 0;
  private portal = 0;
  private sections: Sections | undefined;

  constructor(
    private readonly engine: Engine,
    private readonly view: View,
    private readonly pair: () => Pair,
    /** The question before. */
    private readonly before: () => Pair | undefined,
  ) {
    this.from.append(h("option", { value: "center" }, "from the centre, as in the paper"), h("option", { value: "guess" }, "from where ellipsoids would meet"), h("option", { value: "region" }, "in N(p), around the last solution"));
    this.from.addEventListener("change", () => this.refresh());
    this.graph.onStep = (step) => this.pick(step);
    this.body = h("div", { style: "display: contents" },
      h("section", { class: "card" },
        h("h3", {}, "Minimisation over pairs of sections"),
        h("p", { class: "proof" }, "Cut both bodies by a plane each, at the levels x and y. How far the one section can move until it meets the other is φ(x, y): a convex function, and its least value is the answer."),
        this.from, this.graph.element, this.steps, this.told),
      h("section", { class: "card" },
        h("h3", {}, "The planar problem of this step"),
        h("p", { class: "proof" }, "Both sections, seen along d. The lowest point that their shadows have in common is where they touch."),
        this.planar),
      h("section", { class: "card" },
        h("h3", {}, "Portal refinement"),
        h("p", { class: "proof" }, "All differences of points of the two bodies, seen along d. The line of the motion is the cross; a portal is a triangle around it, and each step exchanges a corner for a deeper one."),
        this.portalPicture, this.portalSteps, this.portalTold),
      h("section", { class: "card" }, h("h3", {}, "From the last answer"), this.tracker, this.near));
    this.element.append(this.head, this.body);
  }

  /** There is another answer. */
  changed() {
    this.stale = true;
    if (this.visible) this.refresh();
  }

  show(_state: State, visible: boolean) {
    const opened = visible && !this.visible;
    this.visible = visible;
    this.element.hidden = !visible;
    if (opened && this.stale) this.refresh();
    if (visible) this.draw();
    else this.view.clearExtra();
  }

  private bodies(): [Drawn, Drawn] | undefined {
    const [moving, fixed] = [this.view.bodyOf("moving"), this.view.bodyOf("fixed")];
    const convex = moving?.body.facts.kind === "convex" && fixed?.body.facts.kind === "convex";
    return convex ? [moving!, fixed!] : undefined;
  }

  private async refresh() {
    const turn = ++this.asked;
    this.stale = false;
    const bodies = this.bodies();
    this.body.hidden = !bodies;
    if (!bodies) {
      if (!this.view.bodyOf("moving") || !this.view.bodyOf("fixed")) this.say("No search", "A body is missing: give it in the first tab.");
      else this.say("Only between convex bodies", "Searches between parts that are not convex go through trees of boxes; there is no picture of it here yet.");
      return;
    }
    try {
      const pair = this.pair();
      const from: Partial<Pair> = this.from.value === "guess" ? { start: "ellipsoids", until: 0.2 } : {};
      const sections = await this.engine.ask({ do: "search", ...pair, solver: "cta", ...from, after: this.before() });
      const refined = await this.engine.ask({ do: "search", ...pair, solver: "portal", after: this.before() });
      if (turn !== this.asked) return;
      const [first, second] = [sections.facts, refined.facts];
      this.found = this.from.value === "region" ? within(first) : minimisation(first.events);
      this.refined = portals(second.events);
      this.grid = undefined;
      this.step = Math.min(this.step, Math.max(0, (this.found?.steps.length ?? 1) - 1));
      this.portal = Math.max(0, (this.refined?.steps.length ?? 1) - 1);
      this.tellWork(first, second);
      this.tellTracker(second);
      this.tellNear(first);
      await this.sectionsOf();
      this.draw();
      if (this.found) await this.gridOf(turn, this.found);
    } catch (error) {
      this.say("No search", error instanceof Error ? error.message : String(error));
    }
  }

  private say(headline: string, sentence: string) {
    this.head.replaceChildren(h("h2", {}, headline), h("p", {}, sentence));
  }

  private tellWork(cta: PageSearch, portal: PageSearch) {
    const bodies = this.bodies()!;
    const [p, q] = bodies.map((body) => body.body.facts.vertices) as Two;
    this.say(
      "Two ways to one proof",
      `The bodies have ${p} and ${q} vertices, their difference up to ${(p * q).toLocaleString("en")}, and it is never built. ` +
        `The collision translation algorithm solved ${count(cta.steps.planar_problems, "planar problem")}, portal refinement computed ${count(portal.steps.supports, "supporting plane")}.`,
    );
  }

  private tellTracker({ steps, tracked }: PageSearch) {
    if (!tracked) {
      this.tracker.textContent = "Change the question a little (drag the arrow, or move a body): a tracker then starts from the answer before.";
      return;
    }
    const from = { features: "the features that touched then", region: "the region around the last solution", scratch: "nothing: too much has changed" }[tracked.steps.started_from ?? "scratch"];
    this.tracker.textContent =
      `Asked after the question before this one, a tracker starts from ${from}: ${count(tracked.steps.supports, "supporting plane")} and ` +
      `${count(tracked.steps.pivots, "portal")}, instead of ${steps.supports} and ${steps.pivots}. The proof is made anew, so it is as tight as any.`;
  }

  /** What the neighbourhood of the last solution saves. */
  private tellNear({ steps, region }: PageSearch) {
    const l = length(this.pair().direction);
    if (!region) {
      this.near.textContent = region === null ? "The question before had no contact: there is no p, and no neighbourhood N(p)." : "";
      return;
    }
    const [all, near] = [steps.planar_problems, region.steps.planar_problems];
    const saved = all > near ? `${all - near} of ${all} are saved` : "nothing is saved";
    this.near.textContent =
      `The algorithm itself can look first where the last solution p was: in the square N(p) around its pair of levels, whose half-side δ = ${short(region.delta, 3)} ` +
      `is how far the contact points have moved apart across d${l === 1 ? "" : " (a length)"}. There it solved ${count(near, "planar problem")}, from scratch ${all}: ${saved}.`;
  }

  // --- the minimisation

  private async gridOf(turn: number, found: Minimisation) {
    const levels = ([low, high]: Two) => Array.from({ length: GRID }, (_, k) => low + ((k + 0.5) / GRID) * (high - low));
    const { numbers } = await this.engine.ask({
      do: "levels", ...this.pair(), moving_axis: found.axes[0], fixed_axis: found.axes[1],
      moving_levels: levels(found.ranges[0]), fixed_levels: levels(found.ranges[1]),
    });
    if (turn !== this.asked) return;
    this.grid = { count: GRID, values: new Float64Array(numbers, 0, GRID * GRID) };
    this.draw();
  }

  /** The two sections of the step. */
  private async sectionsOf() {
    this.sections = undefined;
    const { found } = this;
    const step = found?.steps[this.step];
    if (!found || !step) return;
    const { facts, numbers } = await this.engine.ask({
      do: "levels", ...this.pair(), moving_axis: found.axes[0], fixed_axis: found.axes[1],
      moving_levels: [step.levels[0]], fixed_levels: [step.levels[1]],
    });
    const all = new Float64Array(numbers);
    const corners = (from: number, count: number): Vec[] =>
      Array.from({ length: count }, (_, k) => [all[from + 3 * k]!, all[from + 3 * k + 1]!, all[from + 3 * k + 2]!]);
    const count = facts.moving[0] ?? 0;
    this.sections = { phi: all[0]!, moving: corners(1, count), fixed: corners(1 + 3 * count, facts.fixed[0] ?? 0) };
  }

  private pick(step: number) {
    if (step === this.step) return;
    this.step = step;
    void this.sectionsOf().then(() => this.draw());
  }

  private draw() {
    if (!this.visible || !this.bodies()) return;
    const { found } = this;
    const buttons = (count: number, now: number, pick: (k: number) => void) =>
      Array.from({ length: count }, (_, k) =>
        h("button", { class: "small", "aria-pressed": String(k === now), onclick: () => pick(k) }, String(k + 1)));
    if (found) {
      this.graph.show(found, this.grid, this.step);
      refill(this.steps, ...buttons(found.steps.length, this.step, (k) => this.pick(k)));
      this.tellStep(found);
    } else {
      this.told.textContent = this.from.value === "guess"
        ? "Portal refinement began where the ellipsoids would meet, and no planar problem was needed."
        : this.from.value === "region"
          ? "There is no solution before this one: change the question a little (drag the arrow, or move a body), and look again."
          : "Bodies without a volume have no sections to speak of.";
    }
    for (const part of [this.graph.element, this.steps, this.planar.parentElement!]) part.hidden = !found;
    this.drawPlanar();
    this.drawPortals();
    refill(this.portalSteps, ...buttons(this.refined?.steps.length ?? 0, this.portal, (k) => {
      this.portal = k;
      this.draw();
    }));
    this.drawInView();
  }

  private tellStep(found: Minimisation) {
    const step = found.steps[this.step];
    if (!step) return;
    const l = length(this.pair().direction);
    const where = `At x = ${short(step.levels[0], 4)}, y = ${short(step.levels[1], 4)}`;
    const cut = step.cut
      ? ` Proven by now: ${Number.isFinite(step.cut.upper) && step.cut.upper !== null ? `between ${short(step.cut.lower / l, 7)} and ${short(step.cut.upper / l, 7)}` : `at least ${short(step.cut.lower / l, 7)}`}; what lies behind the cut, pale, is left out.`
      : "";
    this.told.textContent = step.meets
      ? `${where} the sections meet at t = ${short(step.value / l, 7)}. Within the cell where the same features touch, φ is linear and goes down to ${short(step.shifted / l, 7)} (the cell shift).${cut}`
      : `${where} the sections miss each other by ${short(step.value, 4)}; the cut keeps the side where they come closer.${cut}`;
  }

  /** Both sections in the shadow plane: `h` up, `g` to the right. */
  private drawPlanar() {
    const { planar, sections, found } = this;
    const colours = palette();
    planar.replaceChildren();
    if (!sections || !found || sections.moving.length < 2 || sections.fixed.length < 2) return;
    const d = unit(this.pair().direction);
    const [a, b] = found.axes;
    const c = sub(times(a, 1 / dot(a, d)), times(b, 1 / dot(b, d)));
    const [up, right] = [unit(c), unit(cross(d, c))];
    const flat = (v: Vec): Two => [dot(v, right), dot(v, up)];
    const [p, q] = [hull(sections.moving.map(flat)), hull(sections.fixed.map(flat))];
    const all = [...p, ...q];
    const [lowX, highX] = [Math.min(...all.map(([x]) => x)), Math.max(...all.map(([x]) => x))];
    const [lowY, highY] = [Math.min(...all.map(([, y]) => y)), Math.max(...all.map(([, y]) => y))];
    const scale = Math.min((SIZE - 40) / (highX - lowX || 1), 190 / (highY - lowY || 1));
    const place = ([x, y]: Two): Two => [SIZE / 2 + (x - (lowX + highX) / 2) * scale, 115 - (y - (lowY + highY) / 2) * scale];
    const points = (polygon: Two[]) => polygon.map((v) => place(v).map((x) => x.toFixed(1)).join(",")).join(" ");
    planar.append(
      svg("polygon", { points: points(q), fill: colours.fixed, "fill-opacity": 0.65, stroke: colours.text, "stroke-width": 1.2 }),
      svg("polygon", { points: points(p), fill: colours.moving, "fill-opacity": 0.55, stroke: colours.text, "stroke-width": 1.2 }));
    const common = intersection(p, q);
    const lowest = common.reduce<Two | undefined>((best, v) => (!best || v[1] < best[1] ? v : best), undefined);
    if (lowest) {
      const [x, y] = place(lowest);
      planar.append(
        svg("polygon", { points: points(common), fill: colours.plane, "fill-opacity": 0.35, stroke: "none" }),
        svg("line", { x1: 6, x2: SIZE - 6, y1: y, y2: y, stroke: colours.normal, "stroke-width": 1.2, "stroke-dasharray": "5 4" }),
        svg("circle", { cx: x, cy: y, r: 5, fill: colours.normal, stroke: "#fff", "stroke-width": 1.5 }));
    }
    planar.append(
      svg("text", { x: 6, y: 14, "font-size": 12, fill: colours.text }, "↑ h"),
      svg("text", { x: SIZE - 6, y: 224, "font-size": 12, fill: colours.text, "text-anchor": "end" }, lowest ? "ψ: the least h in common" : "nothing in common: the sections never meet"));
  }

  // --- portal refinement

  private drawPortals() {
    const { portalPicture: picture, refined } = this;
    const colours = palette();
    picture.replaceChildren();
    const bodies = this.bodies();
    if (!refined || !bodies) return;
    const { frame, steps, loose } = refined;
    const pair = this.pair();
    const shadow = (body: Drawn, pose: Pair["moving_pose"]) => {
      const { vertices } = body.body;
      const flat: Two[] = [];
      for (let k = 0; k < vertices.length; k += 3) {
        const v = placed(pose, [vertices[k]!, vertices[k + 1]!, vertices[k + 2]!]);
        flat.push([dot(v, frame[0]), dot(v, frame[1])]);
      }
      return hull(flat);
    };
    const [p, q] = [shadow(bodies[0], pair.moving_pose), shadow(bodies[1], pair.fixed_pose)];
    const thin = (all: Two[]) => all.filter((_, k) => k % Math.ceil(all.length / 120) === 0);
    const rim = hull(thin(q).flatMap(([x, y]) => thin(p).map(([u, v]): Two => [x - u, y - v])));
    const all: Two[] = [...rim, [0, 0]];
    const [lowX, highX] = [Math.min(...all.map(([x]) => x)), Math.max(...all.map(([x]) => x))];
    const [lowY, highY] = [Math.min(...all.map(([, y]) => y)), Math.max(...all.map(([, y]) => y))];
    const scale = (SIZE - 30) / Math.max(highX - lowX, highY - lowY, 1e-300);
    const place = ([x, y]: Two | Vec): Two => [SIZE / 2 + (x - (lowX + highX) / 2) * scale, SIZE / 2 - (y - (lowY + highY) / 2) * scale];
    const points = (polygon: (Two | Vec)[]) => polygon.map((v) => place([v[0], v[1]]).map((x) => x.toFixed(1)).join(",")).join(" ");
    picture.append(svg("polygon", { points: points(rim), fill: colours.grid, "fill-opacity": 0.5, stroke: colours.text, "stroke-width": 1.2 }));
    steps.slice(0, this.portal + 1).forEach(({ portal }, k) => {
      const now = k === this.portal;
      picture.append(svg("polygon", {
        points: points(portal), fill: colours.moving, "fill-opacity": now ? 0.45 : 0.08,
        stroke: now ? colours.movingMark : colours.moving, "stroke-width": now ? 2.2 : 1, "stroke-dasharray": now ? "none" : "4 3",
      }));
    });
    for (const v of [...loose, ...(steps[this.portal]?.supports ?? [])]) {
      const [x, y] = place(v);
      picture.append(svg("circle", { cx: x, cy: y, r: 4, fill: colours.fixedMark, stroke: "#fff", "stroke-width": 1 }));
    }
    const [x, y] = place([0, 0]);
    picture.append(
      svg("path", { d: `M${x - 9} ${y}H${x + 9}M${x} ${y - 9}V${y + 9}`, stroke: colours.normal, "stroke-width": 2.5 }),
      svg("text", { x: 8, y: 16, "font-size": 12, fill: colours.text }, "M along d"));
    const heights = steps[this.portal]?.portal.map((v) => short(v[2], 4));
    this.portalTold.textContent = heights
      ? `Portal ${this.portal + 1} of ${steps.length}: its corners are at heights ${heights.join(", ")} along d; the orange points are the supports computed for it.`
      : "No portal: the line misses the difference, and a direction was found that separates.";
  }

  // --- in the view

  private drawInView() {
    const { view, sections } = this;
    view.clearExtra();
    if (!sections) {
      view.render();
      return;
    }
    const colours = palette();
    const d = this.pair().direction;
    const show = (corners: Vec[], colour: string, opacity: number) => {
      if (corners.length < 2) return;
      const at = corners.map((v) => view.toScene(v));
      const triangles: Vector3[] = [];
      for (let k = 1; k + 1 < at.length; k++) triangles.push(at[0]!, at[k]!, at[k + 1]!);
      const sheet = new MeshBasicMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, depthWrite: false });
      const line = new LineLoop(new BufferGeometry().setFromPoints(at), new LineBasicMaterial({ color: colour }));
      view.extra.add(new Mesh(new BufferGeometry().setFromPoints(triangles), sheet), line);
    };
    show(sections.fixed, colours.fixedMark, 0.6);
    show(sections.moving, colours.movingMark, 0.6);
    if (Number.isFinite(sections.phi)) {
      const moved = sections.moving.map((v) => add(v, times(d, sections.phi)));
      show(moved, colours.movingMark, 0.35);
      for (const k of [0, Math.floor(sections.moving.length / 2)]) {
        const ends = [sections.moving[k]!, moved[k]!].map((v) => view.toScene(v));
        view.extra.add(new Line(new BufferGeometry().setFromPoints(ends), new LineBasicMaterial({ color: colours.movingMark, transparent: true, opacity: 0.5 })));
      }
    }
    view.render();
  }
}

const count = (n: number, what: string) => `${n} ${what}${n === 1 ? "" : "s"}`;

/** The minimisation in the neighbourhood of the last solution. */
function within({ region }: PageSearch): Minimisation | undefined {
  const found = region ? minimisation(region.events) : undefined;
  if (found && region) found.square = { center: region.center, half: region.half };
  return found;
}

/** The common part of two convex polygons, both counter-clockwise. */
function intersection(p: Two[], q: Two[]): Two[] {
  let left = p;
  q.forEach((a, k) => {
    const b = q[(k + 1) % q.length]!;
    left = below(left, [b[1] - a[1], a[0] - b[0]], a, 0);
  });
  return left;
}
