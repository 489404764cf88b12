// The assemblies' part of the page, read when it is asked for: several parts, who stops whom along
// the arrow, the removal map of one of them, and how everything comes apart.
//
// Data flow: files -> the library in a worker of its own (parts, fit, plan) -> `Parts`, `Player`
// and `Sphere`. Another assembly takes another worker, so that what the last one held is given back.

import { Group, MeshLambertMaterial, Vector3 } from "three";
import { aim, onPage, rounded } from "./aim";
import type { PageAlong, PageFit, PageParts, PagePlan } from "./answers";
import { type Move, Parts, tint } from "./assembly/parts";
import { Player } from "./assembly/player";
import { type RemovalMap, Sphere } from "./assembly/sphere";
import { palette } from "./colours";
import { h, refill, save, soon } from "./dom";
import { Engine, bytesOf } from "./engine";
import { ACCEPTED, names } from "./formats";
import { type Vec, length, short, shown, sub, times, unit } from "./math";
import { quoted } from "./share";
import type { State } from "./state";
import { above, ball, clear, rod } from "./view/shapes";

const GEARBOX = [
  "bearing_ball_0", "bearing_ball_1", "bearing_ball_2", "bearing_ball_3", "bearing_inner", "bearing_outer", "bolt_0", "bolt_1",
  "bolt_2", "bolt_3", "cover", "gear", "housing", "rear_bush", "shaft", "spacer",
].map((name) => `gearbox_small/${name}.off`);
const EXAMPLE = "gearbox_small";
/** Directions to begin with, of equal ones the first. */
const AXES: Vec[] = [[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]];
/** What is planned without being asked to. */
const SOON = 40;

export class AssemblyTab {
  readonly panel = h("div", { class: "assembly-panel" });
  readonly stage = h("div", { class: "assembly-stage" });
  private readonly view = h("div", { class: "assembly-view" });
  private readonly head = h("section", { class: "said", "aria-live": "polite" });
  private readonly list = h("div", { class: "parts" });
  private readonly fitCard = h("div");
  private readonly mapCard = h("div");
  private readonly planCard = h("div");
  private readonly fields: HTMLInputElement[];
  private readonly tolerance = h("input", { type: "number", step: "any", min: 0, "aria-label": "Tolerance of the assembly", inputmode: "decimal" });
  private readonly ignore = h("input", { type: "checkbox" });
  private readonly fitFields = [
    h("label", {}, "Tolerance (empty: from the files)", this.tolerance),
    h("label", { style: "display: flex; gap: 8px; align-items: center" }, this.ignore, "What overlaps at the start does not block"),
  ];
  private readonly player = new Player((t) => this.seen?.place(this.moves, t));
  private readonly sphere: Sphere | undefined;
  private readonly seen: Parts | undefined;
  private readonly arrow = new Group();
  private engine: Engine;
  private files: { name: string; bytes: ArrayBuffer }[] = [];
  private source = "";
  private facts: PageParts | undefined;
  private fit: PageFit | undefined;
  private along: PageAlong | undefined;
  private map: RemovalMap | undefined;
  private plan: PagePlan | undefined;
  private moves: Move[] = [];
  private error = "";
  private busy = "";
  /** Whether what may take long is done without being asked for. */
  private patient = true;
  /** Whether the direction that frees most is looked for: of files that somebody gave. */
  private seeking = false;
  private asking = false;
  private again = false;
  /** Counts assemblies and fits: what comes for an older one is of no use. */
  private turn = 0;

  constructor(
    private readonly state: () => State,
    private readonly remember: () => void,
    private readonly copy: (text: string, what: string) => void,
  ) {
    this.engine = new Engine("colltrans_assembly");
    this.stage.append(this.view, this.player.element);
    this.player.show([], "");
    const number = (k: number) => {
      const input = h("input", { type: "number", step: "any", "aria-label": `Direction ${"xyz"[k]} of the assembly`, inputmode: "decimal" });
      input.addEventListener("input", () => {
        if (!Number.isFinite(input.valueAsNumber)) return;
        const d = [...this.asked.direction] as Vec;
        d[k] = input.valueAsNumber;
        this.turnTo(d);
      });
      return input;
    };
    this.fields = [0, 1, 2].map(number);
    this.tolerance.addEventListener("change", () => {
      this.asked.tolerance = this.tolerance.value === "" ? null : Math.max(0, this.tolerance.valueAsNumber);
      void this.refit();
    });
    this.ignore.addEventListener("change", () => {
      this.asked.ignore = this.ignore.checked;
      void this.refit();
    });
    try {
      this.seen = new Parts(this.view);
      this.sphere = new Sphere(this.seen.camera);
      this.arrange(this.seen, this.sphere);
    } catch (error) {
      this.view.append(h("p", { class: "lone", role: "alert" },
        `The view in three dimensions draws with WebGL 2, which this browser does not have, or has switched off (${said(error)}). What is found is told beside it.`));
    }
    this.panel.append(...this.cards());
  }

  private get asked() {
    return this.state().assembly;
  }

  private arrange(seen: Parts, sphere: Sphere) {
    seen.scene.add(this.arrow);
    seen.onClick = (part) => this.pick(part < 0 ? null : part);
    seen.onRender = () => sphere.draw();
    const ends = () => (this.facts ? { base: new Vector3(), tip: this.tip() } : undefined);
    aim(seen.renderer.domElement, seen.camera, seen.orbit, ends, (way) => this.turnTo(rounded(way, 0.003)));
    sphere.onDirection = (d) => this.turnTo(rounded(d, 1e-4));
    this.stage.append(h("div", { class: "group assembly-tools" },
      h("button", { onclick: () => seen.fit() }, "Fit"),
      h("button", { onclick: () => this.player.set(0), title: "All parts where they belong" }, "Assembled")));
  }

  private cards(): HTMLElement[] {
    const card = (title: string, ...content: HTMLElement[]) =>
      h("details", { class: "card", open: true }, h("summary", {}, title), h("div", {}, ...content));
    const axis = (text: string, d: Vec) => h("button", { class: "small", onclick: () => this.turnTo(d) }, text);
    return [
      this.head,
      card("Parts", this.list,
        h("div", { class: "row" },
          h("button", { class: "small", onclick: () => this.choose() }, "Choose files…"),
          h("button", { class: "small", onclick: () => { this.seeking = true; void this.example(); } }, "Small gearbox")),
        h("small", {}, `${names("and")} files, one part each, or GLB; or drop them here. Up to 120 parts and 400,000 triangles: beyond that, the command line.`)),
      card("Direction",
        h("div", { class: "fields" }, h("span", {}, "d"), ...this.fields),
        h("div", { class: "row" },
          axis("+x", [1, 0, 0]), axis("−x", [-1, 0, 0]), axis("+y", [0, 1, 0]), axis("−y", [0, -1, 0]), axis("+z", [0, 0, 1]), axis("−z", [0, 0, -1]))),
      card("Removal map", this.mapCard),
      card("How it comes apart", this.planCard),
      card("Fit", this.fitCard),
    ];
  }

  // --- what is asked

  /** Shown for the first time, or asked for: with the files of the example. */
  async start() {
    await this.example();
  }

  /** Or about to be. */
  get isExample(): boolean {
    return !this.source || this.source === EXAMPLE;
  }

  private async example() {
    this.patient = true;
    this.asked.tolerance ??= 0.1;
    try {
      const files = await Promise.all(GEARBOX.map(async (file) => {
        const response = await fetch(new URL(`data/${file}`, document.baseURI));
        if (!response.ok) throw new Error(`${file}: ${response.status} ${response.statusText}`);
        return { name: file.split("/").at(-1)!, bytes: await response.arrayBuffer() };
      }));
      await this.load(files, EXAMPLE);
    } catch (error) {
      this.refuse(error);
    }
  }

  /** Files that somebody chose or dropped make another assembly. */
  async open(files: File[]) {
    if (!files.length) return;
    this.patient = true;
    this.asked.tolerance = null;
    this.asked.part = null;
    this.seeking = true;
    try {
      const sorted = files.sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
      const read = await Promise.all(sorted.map(async (file) => ({ name: file.name, bytes: await bytesOf(file) })));
      await this.load(read, read.length === 1 ? read[0]!.name : "FOLDER");
    } catch (error) {
      this.refuse(error);
    }
  }

  private choose() {
    const input = h("input", { type: "file", multiple: true, accept: `${ACCEPTED},.glb` });
    input.addEventListener("change", () => void this.open([...(input.files ?? [])]));
    input.click();
  }

  private async load(files: { name: string; bytes: ArrayBuffer }[], source: string) {
    const turn = ++this.turn;
    const engine = new Engine("colltrans_assembly");
    this.wait("Reading the parts");
    try {
      for (const { name, bytes } of files) {
        await engine.ask({ do: "add", name }, bytes.slice(0));
        if (turn !== this.turn) return engine.stop("another assembly was asked for");
      }
      const { facts, numbers } = await engine.ask({ do: "parts" });
      if (turn !== this.turn) return engine.stop("another assembly was asked for");
      // What is there stays until the new one is read.
      this.engine.stop("another assembly was asked for");
      this.engine = engine;
      [this.files, this.source, this.facts] = [files, source, facts];
      this.showParts(facts, numbers);
    } catch (error) {
      engine.stop("it was refused");
      // What is wrong with it is of no use once another one is asked for.
      if (turn !== this.turn) return;
      throw error;
    } finally {
      if (turn === this.turn) this.wait("");
    }
    await this.refit();
  }

  private showParts(facts: PageParts, numbers: ArrayBuffer) {
    let at = 0;
    const parts = facts.parts.map(({ name, vertices, triangles }, k) => {
      const part = { name, colour: tint(k), vertices: new Float32Array(numbers, at, 3 * vertices!), triangles: new Uint32Array(numbers, at + 12 * vertices!, 3 * triangles!) };
      at += 12 * (vertices! + triangles!);
      return part;
    });
    this.moves = [];
    this.seen?.show(parts, facts.size);
  }

  /** Everything again, with the tolerance that is asked for. */
  private async refit() {
    if (!this.facts) return;
    // An address may name a part that is not there.
    if (this.asked.part !== null && !this.facts.parts[this.asked.part]) this.asked.part = null;
    const turn = ++this.turn;
    [this.fit, this.along, this.map, this.plan, this.moves, this.error] = [undefined, undefined, undefined, undefined, [], ""];
    this.player.show([], "");
    const { tolerance, ignore } = this.asked;
    this.wait("Looking for overlaps and contacts");
    this.remember();
    try {
      const { facts } = await this.engine.ask({ do: "fit", tolerance, ignore_overlaps: ignore });
      if (turn !== this.turn) return;
      this.fit = facts;
      if (this.seeking) await this.seek(turn);
      if (turn !== this.turn) return;
      this.wait("");
      await this.ask();
      if (turn !== this.turn || !this.patient) return;
      if (this.asked.part !== null) await this.askMap();
      if (turn === this.turn && this.facts.parts.length <= SOON) await this.askPlan();
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    }
  }

  /** Turns the arrow to the axis along which most parts, or else most groups, come out; of equal ones to the first. */
  private async seek(turn: number) {
    this.seeking = false;
    this.wait("Looking for the direction that frees most");
    let most: [number, number] = [-1, -1];
    for (const direction of AXES) {
      const { facts } = await this.engine.ask({ do: "along", direction });
      if (turn !== this.turn || !this.facts) return;
      const [free, groups] = [freeParts(facts).length, properGroups(facts, this.facts).length];
      if (free > most[0] || free === most[0] && groups > most[1]) [most, this.asked.direction] = [[free, groups], direction];
    }
    this.remember();
  }

  /** Who stops whom along the arrow. One question is on its way at a time. */
  private async ask(): Promise<void> {
    if (!this.fit) return;
    if (this.asking) {
      this.again = true;
      return;
    }
    const turn = this.turn;
    this.asking = true;
    try {
      const { facts } = await this.engine.ask({ do: "along", direction: this.asked.direction });
      if (turn === this.turn) [this.along, this.error] = [facts, ""];
    } catch (error) {
      if (turn === this.turn) [this.along, this.error] = [undefined, said(error)];
    }
    this.asking = false;
    if (this.again) {
      this.again = false;
      await this.ask();
    }
    this.show();
  }

  private async askMap() {
    const part = this.asked.part;
    if (!this.fit || part === null || !this.facts?.parts[part]) return;
    const turn = this.turn;
    this.wait("Looking in all directions");
    try {
      const { facts, numbers } = await this.engine.ask({ do: "map", group: [part] });
      if (turn !== this.turn || this.asked.part !== part) return;
      const [n, t] = [facts.directions as number, facts.triangles as number];
      this.map = {
        ...facts, directions: new Float32Array(numbers, 0, 3 * n), distances: new Float32Array(numbers, 12 * n, n),
        triangles: new Uint32Array(numbers, 16 * n, 3 * t),
      };
    } finally {
      if (turn === this.turn) this.wait("");
    }
    this.show();
  }

  private async askPlan() {
    const turn = this.turn;
    this.wait("Planning");
    try {
      const { facts } = await this.engine.ask({ do: "plan" });
      if (turn !== this.turn || !this.facts) return;
      const plan = (this.plan = facts);
      const { size, middle, unit: of } = this.facts;
      const places = new Map(this.facts.parts.map(({ name }, k) => [name, k]));
      this.moves = plan.plan.map(({ path, back = [] }) => [...path, ...back].map((leg, l) => {
        // With the last move of its path a step leaves.
        const leaves = l === path.length - 1;
        const moved = { parts: leg.parts.map((name) => places.get(name)!), way: times(leg.direction, leg.travel + (leaves ? 0.35 * size : 0)) };
        if (!leg.turn) return moved;
        // Parts are shown about their middle.
        const { point, axis, aside, phase, turns } = leg.turn, at = sub(point, middle);
        return { ...moved, turn: { own: sub(at, aside), point: at, axis, phase, turns } };
      }));
      this.player.show(
        plan.plan.map(({ parts, path, direction, travel }) => `${parts.join(", ")} ${severally(path)}along ${arrow(direction)}${travel ? `, ${short(travel, 4)} ${of ?? ""}` : ""}`),
        `${this.facts.parts.length} parts, ${plan.plan.length} steps; point at a part for its name.`);
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    } finally {
      if (turn === this.turn) this.wait("");
    }
    this.show();
  }

  /** What is printed for the workshop, as a file. */
  private async report() {
    const turn = this.turn;
    this.wait("Drawing a page for each step");
    try {
      const { numbers } = await this.engine.ask({ do: "report", title: this.source });
      if (turn !== this.turn) return;
      save(new Blob([numbers], { type: "text/html" }), "report.html");
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    } finally {
      if (turn === this.turn) this.wait("");
    }
  }

  /** What takes too long is given up: the worker goes, and another one reads the files again. */
  private async giveUp() {
    this.engine.stop("it was given up");
    this.patient = false;
    this.asked.part = null;
    if (this.facts) await this.load(this.files, this.source).catch((error: unknown) => this.refuse(error));
    else this.refuse(new Error("It was given up."));
  }

  /** The address has changed. */
  stateChanged() {
    if (this.facts) void this.refit();
  }

  private turnTo(d: Vec) {
    this.asked.direction = d;
    void this.ask();
    this.show();
    this.remember();
  }

  private pick(part: number | null) {
    this.asked.part = part;
    this.map = undefined;
    this.show();
    this.remember();
    if (part !== null) this.askMap().catch((error: unknown) => this.refuse(error));
  }

  private refuse(error: unknown) {
    this.busy = "";
    this.error = said(error);
    this.show();
  }

  private wait(what: string) {
    this.busy = what;
    this.show();
  }

  // --- what is shown

  private name(part: number): string {
    return this.facts?.parts[part]?.name ?? "?";
  }

  readonly show = soon(() => {
    const { asked, facts } = this;
    this.fields.forEach((input, k) => {
      if (input !== document.activeElement) input.value = String(asked.direction[k]);
    });
    this.showHead();
    if (facts) this.showList(facts);
    this.showFit();
    this.showMap();
    this.showPlan();
    this.showArrow();
    const { part } = asked;
    const met = part === null ? undefined : this.along?.closures[part];
    this.seen?.fade((k) => met !== undefined && !met.includes(this.name(k)));
  });

  themeChanged() {
    this.show();
  }

  private showHead() {
    const { along, error, busy, facts, fit } = this;
    const wait = busy && h("p", { class: "took busy", role: "status" }, `${busy} `, h("button", { class: "small", onclick: () => void this.giveUp() }, "Stop"));
    if (error) {
      this.head.className = "said care";
      refill(this.head, h("h2", {}, "No answer"), h("p", { role: "alert" }, error));
      return;
    }
    if (!along || !facts) {
      this.head.className = "said";
      refill(this.head, h("h2", {}, "…"), ...(wait ? [wait] : []));
      return;
    }
    const free = freeParts(along);
    const groups = properGroups(along, facts);
    const { pairs, count } = overlapping(fit);
    this.head.className = `said ${count ? "care" : free.length || groups.length ? "free" : "stop"}`;
    refill(this.head,
      h("h2", { id: "assembly-headline" }, free.length ? `${free.length} of ${facts.parts.length} parts come out along d` : "No part comes out alone along d"),
      ...(count ? [h("p", { id: "assembly-overlaps" }, `${count} ${count > 1 ? "pairs overlap" : "pair overlaps"} with this tolerance, and ${count > 1 ? "each moves" : "moves"} as one: ${pairs}. The tolerance is set under Fit.`)] : []),
      h("p", {}, free.length
        ? `${free.map(({ part }) => part).join(", ")}.`
        : groups.length ? `As they are, these can leave together: ${groups.slice(0, 3).map((group) => group.join(", ")).join("; ")}.` : "Everything is in the way of something."),
      ...(wait ? [wait] : []));
  }

  private showList(facts: PageParts) {
    const { along, asked } = this;
    const rows = facts.parts.map(({ name, defects, shells }, k) => {
      const room = along?.rooms[k];
      const told = !room ? "" : room.outcome === "free" ? "free"
        : room.outcome === "overlapping" ? `overlaps ${room.by}`
        : `${short(room.distance!, 4)}, then ${room.by}`;
      const colour = `rgb(${tint(k).map((c) => Math.round(255 * c)).join(" ")})`;
      const picked = asked.part === k;
      const more = picked && along ? blockers(along, k, name) : "";
      return h("button", {
        class: `part ${room?.outcome ?? ""}`, "aria-pressed": String(picked), title: [...(shells ? ["not closed"] : []), ...(defects ?? [])].join("; "),
        onclick: () => this.pick(picked ? null : k), onpointerenter: () => this.seen?.light(k), onpointerleave: () => this.seen?.light(-1),
      }, h("i", { style: `background: ${colour}` }), h("strong", {}, name), h("span", {}, told), more && h("small", {}, more));
    });
    refill(this.list, ...rows);
  }

  private showFit() {
    const { fit } = this;
    if (this.tolerance !== document.activeElement) this.tolerance.value = this.asked.tolerance === null ? "" : String(this.asked.tolerance);
    this.ignore.checked = this.asked.ignore;
    const { pairs, count } = overlapping(fit);
    refill(this.fitCard,
      ...this.fitFields,
      h("small", {}, !fit ? "" : `${fit.liaisons.length} pairs touch, ${fit.overlaps.length} overlap as the files have them, ${count} with a tolerance of ${short(fit.tolerance, 3)}.`),
      ...(count ? [h("small", {}, `Overlapping, and so moving as one: ${pairs}.`)] : []),
      ...(fit?.suggested_tolerance && fit.suggested_tolerance > fit.tolerance
        ? [h("div", { class: "row" }, h("button", { class: "small main", onclick: () => { this.asked.tolerance = fit.suggested_tolerance; void this.refit(); } }, `Use ${fit.suggested_tolerance}`), h("small", {}, "no pair overlaps with it"))]
        : []),
      h("div", { class: "row" }, h("button", { class: "small", onclick: () => this.copy(this.asCommand(), "The command") }, "Copy as command line")));
  }

  private asCommand(): string {
    const { direction, tolerance, part, ignore } = this.asked;
    const words = ["colltrans", "assembly", quoted(this.source), `--direction=${direction.join(",")}`];
    if (tolerance !== null) words.push(`--tolerance=${tolerance}`);
    if (ignore) words.push("--ignore-overlaps");
    if (part !== null) words.push(`--map=${quoted(this.name(part))}`);
    return [...words, "-o", "out"].join(" ");
  }

  private showMap() {
    const { map, sphere } = this;
    const { part, direction } = this.asked;
    sphere?.show(map, direction);
    if (part === null || !this.facts) {
      refill(this.mapCard, h("p", { class: "proof" }, "Pick a part, here or in the view: the sphere then shows how far it can go in every direction, against all others where they are."));
      return;
    }
    const name = this.name(part);
    if (!map) {
      refill(this.mapCard, h("p", { class: "proof" }, `${name}: looking in all directions.`));
      return;
    }
    const blocked = map.distances.reduce((best, x, k) => (Number.isFinite(x) && x > map.distances[best]! || !Number.isFinite(map.distances[best]!) ? k : best), 0);
    const go = (d: Vec, text: string) => h("button", { class: "small", onclick: () => this.turnTo(rounded(d, 1e-9)) }, text);
    const farthest = map.distances[blocked]!;
    const of = (k: number): Vec => [0, 1, 2].map((c) => map.directions[3 * k + c]!) as Vec;
    refill(this.mapCard,
      h("p", { class: "proof" }, `${name} ${freedom(map)}. The paler the rest, the farther it can go. Click for a direction.`),
      ...(sphere ? [sphere.canvas] : []),
      h("div", { class: "row" },
        ...map.regions.slice(0, 4).map(({ center, solid_angle }) => go(center, `middle of ${short((100 * solid_angle) / (4 * Math.PI), 2)} %`)),
        ...map.isolated.slice(0, 6).map((d) => go(d, arrow(d))),
        ...(map.regions.length || map.isolated.length || !Number.isFinite(farthest) ? [] : [go(of(blocked), `farthest: ${short(farthest, 3)}`)])));
  }

  private showPlan() {
    const { plan, facts } = this;
    if (!facts) return;
    if (!plan) {
      refill(this.planCard, h("div", { class: "row" }, h("button", { class: "small main", disabled: !!this.busy || !this.fit, onclick: () => void this.askPlan() }, "Plan the disassembly")));
      return;
    }
    const rows = plan.stages.map(({ takes, steps: [first, last] }) => {
      const { path, direction, within, surfaces } = plan.plan[first]!;
      const own = plan.plan.slice(first, last + 1).some((step) => step.direction.some((c, k) => c !== direction[k]));
      return h("li", { value: first + 1 }, h("button", { class: "link", onclick: () => this.player.go(last + 1) },
        `${within === undefined ? "" : `of step ${within + 1}: `}${takes} ${severally(path)}along ${own ? "their own ways" : arrow(direction)}`),
        ...(surfaces ? [h("small", {}, ` rests on an open surface: ${surfaces.join(", ")}`)] : []));
    });
    const remains = plan.last.length ? [h("p", { class: "proof" }, `What remains: ${plan.last.join(", ")}.`)] : [];
    const stuck = plan.stuck.map(({ parts, because }) => h("p", { class: "proof" }, `${parts.join(", ")}: ${because}`));
    refill(this.planCard,
      h("p", { class: "proof" }, `${plan.directions} directions were asked for all parts; each step was checked again, pair by pair.`),
      h("ol", {}, ...rows), ...remains, ...stuck,
      h("div", { class: "row" }, h("button", { class: "small", disabled: !!this.busy, onclick: () => void this.report() }, "Download report.html"), h("small", {}, "a page for each step, to be printed")));
  }

  /** The tip of the arrow. */
  private tip(): Vector3 {
    return new Vector3(...times(unit(this.asked.direction), 0.62 * (this.facts?.size ?? 1)));
  }

  private showArrow() {
    const { arrow: group, facts, seen } = this;
    if (!seen || !facts) return;
    const [tip, width, colour] = [this.tip(), 0.006 * facts.size, palette().way];
    clear(group);
    const look = { color: colour, emissive: colour, emissiveIntensity: 0.35 };
    group.add(rod(new Vector3(), tip, colour, width), ball(tip, 3.4 * width, new MeshLambertMaterial(look)));
    above(group);
    seen.render();
  }

  /** For tests. */
  probe() {
    const { facts, fit, along, map, plan, engine, busy, error } = this;
    const tip = this.seen && onPage(this.seen.renderer.domElement, this.seen.camera, this.tip());
    return { facts, fit, along, map, plan, engine, busy, error, tip, t: this.player.t };
  }
}

/** The parts that come out alone. */
const freeParts = (along: PageAlong) => along.rooms.filter(({ outcome }) => outcome === "free");

/** The groups that come out as one, without single parts and without the whole: all parts together always can. */
const properGroups = (along: PageAlong, { parts }: PageParts) => along.removable.filter(({ length }) => length > 1 && length < parts.length);

/** The pairs that overlap with the tolerance, the deepest six in words, and how many there are. */
function overlapping(fit: PageFit | undefined): { pairs: string; count: number } {
  const remaining = fit?.overlaps.filter(({ remains }) => remains) ?? [];
  const pairs = remaining.slice(0, 6).map(({ parts, least_tolerance: depth }) => `${parts.join(" and ")}${depth === null ? "" : ` (${short(depth, 3)})`}`);
  return { pairs: `${pairs.join("; ")}${remaining.length > 6 ? "; …" : ""}`, count: remaining.length };
}

const said = (error: unknown) => (error instanceof Error ? error.message : String(error));

/** What is in the way of a part. */
function blockers(along: PageAlong, part: number, name: string): string {
  const met = along.meetings.filter(({ moving }) => moving === name).sort((a, b) => a.distance - b.distance);
  if (!met.length) return "Nothing is in its way.";
  const each = met.map(({ fixed, outcome, distance }) => `${fixed} ${outcome === "overlapping" ? "(overlap)" : `after ${short(distance, 4)}`}`).join(", ");
  return `In its way: ${each}. With all that has to come along: ${along.closures[part]!.length} parts, in full in the view.`;
}

function freedom({ free_share, exactly, regions, isolated: { length: single } }: RemovalMap): string {
  const unknown = exactly?.undecided_share ?? 0;
  const proven = exactly ? (unknown > 0 ? `, which is proven but for ${short(100 * unknown, 2)} %` : ", which is proven") : ", as sampled";
  // Regions that are too small to be seen are dots.
  const share = regions.length > 0 && `is free in ${short(100 * free_share, 3)} % of all directions (green)${proven}`;
  const arcs = exactly?.arcs?.length ?? 0;
  const several = (count: number, what: string) => `${count} ${what}${count > 1 ? "s" : ""}`;
  const tight = [single > 0 && `in ${several(single, "single direction")} (dots)`, arcs > 0 && `along ${several(arcs, "arc")} (lines)`].filter(Boolean);
  const alone = tight.length > 0 && `${tight.join(" and ")}, a tight fit`;
  if (share) return alone ? `${share}, and ${alone}` : share;
  if (alone) return `is free only ${alone}${proven}`;
  return exactly ? `is free in no direction${proven}` : "is free in no direction that was looked at";
}

/** A direction for people: an axis by name. */
function arrow(d: Vec): string {
  const names = ["x", "y", "z"].flatMap((name, k) => (Math.abs(Math.abs(d[k]!) / length(d) - 1) < 1e-12 ? [`${d[k]! > 0 ? "+" : "−"}${name}`] : []));
  return names[0] ?? `(${shown(d)})`;
}

/** Before where a step leads to, if it has more moves than one. */
const severally = (path: { travel: number; turn?: { turns: number } }[]) => {
  const { turn, travel } = path[0]!;
  if (turn && !travel) return `turned by ${short(360 * turn.turns, 4)}°, then `;
  if (turn) return `unscrewed, ${short(Math.abs(turn.turns), 3)} turns, then `;
  return path.length > 1 ? `in ${path.length} moves, the last ` : "";
};
