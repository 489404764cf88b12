// The search behind an answer: the paper's figures, animated from the library's recording of a search.
//
// Data flow: the question, in a library of its own -> `found/recording` (steps, portals, moments) -> `found/player`
// (current moment) -> `found/graph`, `found/bounds`, `found/planar`, `found/refinement` next to the view, and
// `found/parts` in it. `found/examples` lists examples, `found/motion` plays the incremental case.

import type { PageSearch } from "./answers";
import { h, refill } from "./dom";
import { Engine, type Pair, type Slot } from "./engine";
import { Bounds } from "./found/bounds";
import { LOOKS, type Look } from "./found/examples";
import { Graph, type Grid, type Window } from "./found/graph";
import { Motion } from "./found/motion";
import { drawPortal, drawSections } from "./found/parts";
import { Planar, section } from "./found/planar";
import { Player } from "./found/player";
import { type Minimisation, type Moment, type Step, type Two, between, least, minimisation, mix, moments, portals } from "./found/recording";
import { Refinement } from "./found/refinement";
import { type Pose, length, short } from "./math";
import { Placing, type Source } from "./placing";
import type { State } from "./state";
import type { View } from "./view";
import type { Drawn } from "./view/body";

const GRID = 44;

/** The functions of the page that this tab uses. */
export interface Around {
  view: View;
  pair(): Pair;
  /** Returns the previous question. */
  before(): Pair | undefined;
  sources(): Partial<Record<Slot, Source>>;
  /** Loads an example; resolves when it has been answered. */
  example(name: string): Promise<void>;
  move(pose: Pose): void;
  /** Returns the translation of the answer. */
  translation(): number | undefined;
  /** Returns the pairs of vertices in the proof of the answer. */
  proven(): Two[];
}

export class Found {
  readonly element = h("div", { class: "found" });
  private readonly engine = new Engine("colltrans_found");
  private readonly placing = new Placing(this.engine);
  private readonly head = h("section", { class: "said" });
  private readonly looks = h("select", { "aria-label": "Example of a search" });
  private readonly caption = h("p", { class: "proof caption" });
  private readonly player = new Player();
  private readonly graph = new Graph();
  private readonly bounds = new Bounds();
  private readonly planar = new Planar();
  private readonly refinement = new Refinement();
  private readonly motion = new Motion();
  private readonly steps = h("div", { class: "row steps", role: "group", "aria-label": "Steps" });
  private readonly told = h("p", { class: "proof told" });
  private readonly portalSteps = h("div", { class: "row steps", role: "group", "aria-label": "Portals" });
  private readonly portalTold = h("p", { class: "proof" });
  private readonly tracker = h("p", { class: "proof" });
  private readonly near = h("p", { class: "proof" });
  private readonly from = h("select", { "aria-label": "Where the search starts" });
  private readonly body: HTMLElement;
  private readonly levelsCard: HTMLElement;
  private visible = false;
  private stale = true;
  private asked = 0;
  private search: PageSearch | undefined;
  private found: Minimisation | undefined;
  private refined: ReturnType<typeof portals>;
  private moments: Moment[] = [];
  private look: Look | undefined;
  private readonly grids = new Map<string, Grid | "asked">();
  /** Callbacks that wait for a search to be shown. */
  private waiting: (() => void)[] = [];

  constructor(private readonly around: Around) {
    for (const [value, text] of [["center", "The paper’s algorithm, from the centre"], ["ellipsoids", "The paper’s algorithm, from where ellipsoids meet"], ["region", "The paper’s algorithm, in N(p) around the last solution"], ["portal", "Portal refinement alone, as auto does"]] as const) this.from.append(h("option", { value }, text));
    this.from.addEventListener("change", () => this.refresh());
    this.looks.append(h("option", { value: "" }, "The current question"), ...LOOKS.map(({ name }, k) => h("option", { value: k }, name)));
    this.looks.addEventListener("change", () => void this.choose(LOOKS[Number(this.looks.value)]));
    this.player.onChange = () => this.draw();
    this.graph.onStep = (step) => this.pick(step);
    this.bounds.onStep = (step) => this.pick(step);
    this.graph.onFollow = () => this.draw();
    this.motion.begin = () => this.beginMotion();
    this.motion.move = async (pose) => {
      const shown = new Promise<void>((resolve) => this.waiting.push(resolve));
      this.around.move(pose);
      await shown;
    };
    this.levelsCard = h("section", { class: "card" },
      h("h3", {}, "Minimisation over pairs of sections"),
      h("p", { class: "proof" }, "Cut both bodies by a plane each: their sections, at the levels x and y. How far along d the one can move until it meets the other is φ(x, y), a translation t in multiples of d. φ is convex, and its least value is the answer; in each cell of its mark, the map below, the same features touch."),
      this.graph.element, this.steps, this.told,
      h("h3", {}, "Proven bounds, step by step"), this.bounds.element);
    this.body = h("div", { style: "display: contents" },
      h("section", { class: "card" }, h("label", {}, "Look at ", this.looks), this.caption, this.from),
      this.player.element, this.levelsCard,
      h("section", { class: "card" },
        h("h3", {}, "The planar problem of this step"),
        h("p", { class: "proof" }, "Both sections, seen along d. The lowest point that their shadows have in common is where they touch."),
        this.planar.element),
      h("section", { class: "card" },
        h("h3", {}, "Portal refinement"),
        h("p", { class: "proof" }, "All differences of points of the two bodies, M, seen along d. The line of the motion is the cross; a portal is a triangle around it, and each step exchanges a corner for a deeper one. It begins with the face of M that the minimisation has found, and makes the proof."),
        this.refinement.element, this.portalSteps, this.portalTold),
      this.motion.element, words(),
      h("section", { class: "card" }, h("h3", {}, "From the last answer"), this.tracker, this.near));
    this.element.append(this.head, this.body);
  }

  /** Called when there is another answer. */
  changed() {
    this.stale = true;
    if (this.visible) void this.refresh();
  }

  show(_state: State, visible: boolean) {
    const opened = visible && !this.visible;
    this.visible = visible;
    this.element.hidden = !visible;
    if (opened && this.stale) void this.refresh();
    if (visible) this.draw();
    else this.player.stop();
  }

  private bodies(): [Drawn, Drawn] | undefined {
    const { view } = this.around;
    const [moving, fixed] = [view.bodyOf("moving"), view.bodyOf("fixed")];
    const sections = [moving, fixed].every((drawn) => drawn?.body.facts.kind === "convex" && !drawn.body.facts.radius);
    return sections ? [moving!, fixed!] : undefined;
  }

  /** Shows one of the examples. */
  private async choose(look: Look | undefined) {
    this.look = look;
    this.caption.textContent = look ? `${look.figure ? `The paper, ${look.figure}. ` : ""}${look.text}` : "";
    if (!look) return;
    this.from.value = look.start === "region" ? "region" : "center";
    this.graph.choose(!!look.surface);
    this.graph.follows = !look.whole;
    this.stale = true;
    this.element.setAttribute("aria-busy", "true");
    const shown = new Promise<void>((resolve) => this.waiting.push(resolve));
    await this.around.example(look.example);
    if (this.stale) await this.refresh();
    await shown;
    if (look.start === "region") this.motion.element.querySelector("button")!.click();
  }

  private async refresh() {
    const turn = ++this.asked;
    this.stale = false;
    this.element.setAttribute("aria-busy", "true");
    const bodies = this.bodies();
    this.body.hidden = !bodies;
    const { moving, fixed } = this.around.sources();
    if (!bodies || !moving || !fixed) {
      if (!this.around.view.bodyOf("moving") || !this.around.view.bodyOf("fixed")) this.say("No search", "A body is missing: give it in the first tab.");
      else this.say("Only between convex polyhedra", "Searches between parts that are not convex go through trees of boxes, and those between rounded bodies through distances; there is no picture of them here yet.");
      return this.shown();
    }
    try {
      const pair = structuredClone(this.around.pair());
      const start = this.from.value;
      const after = this.around.before();
      await this.placing.place({ moving, fixed });
      const by = start === "portal" ? { solver: "portal" } : { solver: "cta", start: start === "ellipsoids" ? start : "center", until: "exit" };
      const { facts } = await this.engine.ask({ do: "search", ...pair, ...by, after });
      // A newer search is pending.
      if (turn !== this.asked) return;
      const events = start === "region" ? facts.region?.events : facts.events;
      this.search = facts;
      this.found = events && minimisation(events);
      if (this.found && start === "region" && facts.region) this.found.square = { center: facts.region.center as Two, half: facts.region.half };
      this.refined = events && portals(events);
      this.moments = moments(this.found, this.refined);
      this.grids.clear();
      this.player.reset(this.moments.length, this.begins());
      this.tellWork((start === "region" && facts.region) || facts);
      this.tellTracker(facts);
      if (facts.region) this.motion.count(facts.region.steps.planar_problems, facts.steps.planar_problems);
      this.draw();
    } catch (error) {
      if (turn !== this.asked) return;
      this.say("No search", error instanceof Error ? error.message : String(error));
    }
    this.shown();
  }

  private shown() {
    this.element.removeAttribute("aria-busy");
    for (const resolve of this.waiting.splice(0)) resolve();
  }

  /** Returns the initial time. */
  private begins(): number {
    const after = (is: (moment: Moment) => boolean) => this.moments.findIndex(is) + 1;
    const steps = this.found?.steps ?? [];
    // The whole minimisation.
    if (this.motion.isPlaying) return this.moments.filter((one) => one.kind !== "portal").length;
    const { at = "first shift", touch } = this.look ?? {};
    const step = touch ? Math.max(0, steps.findIndex((one) => one.touch === touch)) : 0;
    const of = (k: number, ...kinds: Moment["kind"][]) => kinds.map((kind) => after((one) => one.kind === kind && "step" in one && one.step === k)).find((found) => found > 0);
    switch (at) {
      case "start": return Math.min(1, this.moments.length);
      case "first touch": return of(step, "touch") ?? 0;
      case "second step": return of(1, "shift", "touch") ?? of(0, "touch") ?? 0;
      case "end": return of(steps.length - 1, "solved", "cut", "touch") ?? this.moments.length;
      default: return of(0, "cut", "solved", "shift", "touch") ?? this.moments.length;
    }
  }

  /** State for tests. */
  probe() {
    const { engine, found, refined, moments, player, graph } = this;
    return { engine, found, refined, moments, at: player.at, follows: graph.follows };
  }

  private say(headline: string, sentence: string) {
    this.head.replaceChildren(h("h2", {}, headline), h("p", {}, sentence));
  }

  private tellWork({ steps }: Pick<PageSearch, "steps">) {
    const [p, q] = this.bodies()!.map((body) => body.body.facts.vertices) as Two;
    const size = `The bodies have ${p.toLocaleString("en")} and ${q.toLocaleString("en")} vertices, their difference up to ${(p * q).toLocaleString("en")}, and it is never built.`;
    const portalsOnly = this.from.value === "portal" || !steps.planar_problems;
    this.say(
      portalsOnly ? "By portals" : `${count(steps.planar_problems, "planar problem")}, ${count(steps.pivots, "portal")}`,
      portalsOnly ? `${size} Portal refinement computed ${count(steps.supports, "supporting plane")} and went through ${count(steps.pivots, "portal")}.`
        : `${size} The collision translation algorithm solved ${count(steps.planar_problems, "planar problem")}; then ${count(steps.pivots, "portal")} and ${count(steps.supports, "supporting plane")} made the proof.`,
    );
  }

  private tellTracker({ steps, tracked, region }: PageSearch) {
    this.tracker.textContent = tracked
      ? `Asked after the question before this one, a tracker starts from ${{ difference: "the faces of the bodies' difference", features: "the features that touched then", region: "the region around the last solution", scratch: "nothing: too much has changed" }[tracked.started_from ?? "scratch"]}: ` +
        `${count(tracked.supports, "supporting plane")} and ${count(tracked.pivots, "portal")}, instead of ${steps.supports} and ${steps.pivots}. The proof is built from scratch, so it is as tight as any.`
      : "Change the question a little (drag the arrow, or move a body): a tracker then starts from the answer before.";
    if (!region) {
      this.near.textContent = tracked && this.from.value !== "portal" ? "The question before had no contact: there is no p, and no neighbourhood N(p)." : "";
      return;
    }
    const [all, near] = [steps.planar_problems, region.steps.planar_problems];
    const saved = all > near ? `${all - near} of ${all} are saved` : "nothing is saved";
    this.near.textContent =
      `The algorithm itself can look first where the last solution p was: in the square N(p) around its pair of levels, whose half-side δ = ${short(region.delta, 3)} ` +
      `is how far the contact points have moved apart across d${length(this.around.pair().direction) === 1 ? "" : " (a length)"}. There it solved ${count(near, "planar problem")}, from scratch ${all}: ${saved}.`;
  }

  private beginMotion() {
    const bodies = this.bodies();
    if (!bodies) return undefined;
    this.from.value = "region";
    const { moving_pose: pose, direction } = this.around.pair();
    return { pose: [...pose] as Pose, direction, radius: bodies[0].radius };
  }

  // --- pictures

  /** Jumps to the end of a step: its planar problem and everything before it. */
  private pick(step: number) {
    const of = (kind: Moment["kind"]) => this.moments.findIndex((one) => one.kind === kind && "step" in one && one.step === step) + 1;
    const at = of("cut") || of("solved") || of("shift") || of("touch");
    if (at && this.step !== step) this.player.go(at);
  }

  /** The current step. */
  private get step(): number {
    const moment = this.moments[this.player.now[0]];
    return moment && "step" in moment ? moment.step : Math.max(0, (this.found?.steps.length ?? 1) - 1);
  }

  private draw() {
    const bodies = this.bodies();
    if (!this.visible || !bodies) return;
    const { found, refined, moments, player } = this;
    const [at, over] = player.now;
    const moment = moments[at];
    const pair = this.around.pair();
    const unit = length(pair.direction);
    const { step } = this;
    for (const part of [this.levelsCard, this.planar.element.parentElement!]) part.hidden = !found;
    this.around.view.clearExtra();
    if (found && moment) this.drawStep(found, found.steps[step], moment, ease(over), bodies, pair);
    const buttons = (count: number, now: number, pick: (k: number) => void) =>
      Array.from({ length: count }, (_, k) => h("button", { class: "small", "aria-pressed": String(k === now), onclick: () => pick(k) }, String(k + 1)));
    if (found) {
      refill(this.steps, ...buttons(found.steps.length, step, (k) => this.pick(k)));
      this.told.textContent = this.tellStep(found.steps[step], unit);
      this.bounds.show(found, step, this.around.translation(), unit);
    }
    const portal = moment?.kind === "portal" ? moment.portal : -1;
    this.refinement.element.parentElement!.hidden = !refined;
    if (refined) {
      this.portalTold.textContent = this.refinement.show(refined, portal, bodies, pair);
      const first = moments.findIndex((one) => one.kind === "portal");
      refill(this.portalSteps, ...buttons(refined.steps.length, portal, (k) => player.go(first + k + 1)));
      const t = this.around.translation();
      const proven = portal === refined.steps.length - 1 ? this.around.proven() : [];
      if (portal >= 0 && t !== undefined) drawPortal(this.around.view, refined.steps[portal]!, proven, bodies, pair, t);
    }
    player.say(this.tellMoment(moment));
    this.around.view.render();
  }

  private drawStep(found: Minimisation, one: Step | undefined, moment: Moment, over: number, bodies: [Drawn, Drawn], pair: Pair) {
    if (!one) return;
    const unit = length(pair.direction);
    const k = found.steps.indexOf(one);
    const before = found.steps[k - 1];
    const { kind } = moment;
    const come = kind === "sections" ? over : 1;
    const shift = kind === "sections" || kind === "touch" ? 0 : kind === "shift" ? over : 1;
    const cut = kind === "cut" ? over : kind === "solved" ? 0 : kind === "portal" ? 1 : 0;
    // The sections move from the end of the last step.
    const levels = between(between(before?.best ?? one.levels, one.levels, come), one.meets ? one.best : one.levels, shift);
    const touches = kind === "touch" ? over : kind === "sections" ? 0 : 1;
    const t = one.meets ? (touches * mix(one.value, one.shifted, shift)) / unit : 0;
    const [a, b] = found.axes;
    const [moving, fixed] = [section(bodies[0].body, pair.moving_pose, a, levels[0]), section(bodies[1].body, pair.fixed_pose, b, levels[1])];
    if (kind !== "portal") drawSections(this.around.view, { moving, fixed, t }, pair.direction);
    this.planar.show([moving, fixed], found.axes, pair.direction, one.meets && touches === 1);
    const [old, now] = [this.window(found, k - 1), this.window(found, k)];
    const window: Window = come < 1 ? [between(old[0], now[0], come), between(old[1], now[1], come)] : now;
    const grids = [this.grid(found, old, pair), this.grid(found, now, pair)].filter((grid) => grid !== undefined);
    this.graph.show({ found, step: k, shift, cut, window, grids });
  }

  /** Returns the window of levels that is shown at a step. */
  private window({ steps, ranges: [[a, b], [c, d]] }: Minimisation, step: number): Window {
    const all: Window = [[a, c], [b, d]];
    const region = steps[Math.max(step, 0)]?.region;
    if (!this.graph.follows || !region?.length) return all;
    const side = (k: 0 | 1): Two => {
      const [low, high] = [Math.min(...region.map((p) => p[k])), Math.max(...region.map((p) => p[k]))];
      const room = Math.max(0.08 * (high - low), 1e-7 * (all[1][k] - all[0][k]));
      return [Math.max(low - room, all[0][k]), Math.min(high + room, all[1][k])];
    };
    const [x, y] = [side(0), side(1)];
    return [[x[0], y[0]], [x[1], y[1]]];
  }

  /** Returns the values over a window, once they have been computed. */
  private grid(found: Minimisation, window: Window, pair: Pair): Grid | undefined {
    const key = window.join();
    const known = this.grids.get(key);
    if (known) return known === "asked" ? undefined : known;
    this.grids.set(key, "asked");
    const levels = (k: 0 | 1) => Array.from({ length: GRID }, (_, i) => mix(window[0][k], window[1][k], (i + 0.5) / GRID));
    const question = { do: "levels" as const, ...structuredClone(pair), moving_axis: found.axes[0], fixed_axis: found.axes[1], moving_levels: levels(0), fixed_levels: levels(1) };
    this.engine.ask(question).then(({ numbers }) => {
      if (found !== this.found) return;
      this.grids.set(key, { window, count: GRID, values: new Float64Array(numbers, 0, GRID * GRID) });
      this.draw();
    }, () => undefined);
    return undefined;
  }

  // --- texts

  private tellStep(step: Step | undefined, unit: number): string {
    if (!step) return "";
    const where = `At x = ${short(step.levels[0], 4)}, y = ${short(step.levels[1], 4)}`;
    const cut = step.cut
      ? ` Proven by now: ${Number.isFinite(step.cut.upper) ? `between ${short(step.cut.lower / unit, 7)} and ${short(step.cut.upper / unit, 7)}` : `at least ${short(step.cut.lower / unit, 7)}`}; what lies behind the cut is left out.`
      : step.solved ? " The features that touch at q solve the problem: the search ends." : "";
    return step.meets
      ? `${where} the sections meet at t = ${short(step.value / unit, 7)}, by ${step.touch === "edges" ? "two edges" : "a corner inside the other section"}. Within the cell where the same features touch, φ is linear and goes down to ${short(step.shifted / unit, 7)} (the cell shift, from c to q).${cut}`
      : `${where} the sections miss each other by ${short(step.value, 4)}; the cut keeps the side where they come closer.${cut}`;
  }

  private tellMoment(moment: Moment | undefined): string {
    if (!moment) {
      return this.from.value === "region" ? "There is no solution before this one: change the question a little (drag the arrow, or move a body), and look again."
        : !this.search ? "The search goes on."
          : this.search.events.length ? "No planar problem was needed, and no portal was reached." : "Bodies without a volume have no sections.";
    }
    if (moment.kind === "portal") {
      const { found } = this;
      if (moment.portal || !found) return `Portal ${moment.portal + 1}: three points of M around the line of the motion.`;
      return found.steps.at(-1)?.solved ? "Hand-over: the features found name a face of M. One portal checks with exact signs that the line passes it; its plane and points are the proof."
        : "Hand-over: the minimisation has ended, and portal refinement goes on from the normal of its lower bound, with exact signs.";
    }
    const step = this.found!.steps[moment.step]!;
    const name = `Step ${moment.step + 1} of ${this.found!.steps.length}`;
    const best = least(this.found!);
    switch (moment.kind) {
      case "sections": return `${name}: both bodies are cut at c${moment.step ? ", the centroid of the region that is left" : this.found!.square ? " = p, the last solution" : ", the centre of all levels"}.`;
      case "touch": return step.meets ? `${name}: the moving section goes along d until it touches the other one.` : `${name}: the sections never meet; a line lies between their shadows.`;
      case "shift": return `${name}: within its cell the contact slides down to q${best && step.best[0] === best.at[0] && step.best[1] === best.at[1] ? ", the least value of all" : ""}.`;
      case "cut": return `${name}: the region behind the cut line cannot contain the minimum, and is cut off.`;
      default: return `${name}: q solves the problem, because the features that touch there have a common normal that supports both bodies.`;
    }
  }
}

/** Eases an animation at both ends. */
const ease = (s: number) => s * s * (3 - 2 * s);

const count = (n: number, what: string) => `${n} ${what}${n === 1 ? "" : "s"}`;

/** Lists the symbols with links to further reading. */
function words(): HTMLElement {
  const rows: [string, string][] = [
    ["d, t", "the direction of the motion; how far the moving body has gone, in multiples of d"],
    ["section", "what a plane across an axis cuts out of a body; its level, x or y, says where the plane is"],
    ["φ(x, y)", "the t at which the sections at the levels x and y touch: a convex function, whose least value is the answer"],
    ["drum", "the part of a body between the levels of neighbouring vertices, where its section keeps its shape"],
    ["mark", "the map of all cells: in each the same features touch, and φ is linear"],
    ["M", "in the plane of levels, the region that is left"],
    ["M = Q − P", "where portals are told, the difference of both bodies"],
  ];
  const link = (href: string, text: string) => h("a", { href, target: "_blank", rel: "noopener" }, text);
  return h("details", { class: "card words", open: true }, h("summary", {}, "Words, the paper, the source"),
    h("div", {}, h("dl", {}, ...rows.flatMap(([name, what]) => [h("dt", {}, name), h("dd", {}, what)])),
      h("p", { class: "proof" }, "The paper: C. Mirolo, S. Carpin, E. Pagello, “Incremental Convex Minimization for Computing Collision Translations of Convex Polyhedra”, IEEE Transactions on Robotics 23(3), 2007 (",
        link("https://search.crossref.org/?q=Incremental+Convex+Minimization+for+Computing+Collision+Translations+of+Convex+Polyhedra", "its entry, with the DOI"), "). ",
        link("paper.md", "The paper line by line, and this library"), "; the source: ", link("source/minimise.rs", "the minimisation"), ", ", link("source/cell.rs", "cells"), ", ", link("source/region.rs", "the region"), ".")));
}
