// The assembly tab, loaded on demand: several parts, which of them block which along the arrow, the removal map of a
// part, the disassembly plan, and the pairs that overlap or are too close.
//
// Data flow: files -> the library in a worker (parts, fit, plan, audit) -> `Parts`, `Player`, `Sphere` and `Marker`. Another assembly
// gets another worker, so that the memory of the last one is freed.

import { Group, MeshLambertMaterial, Vector3 } from "three";
import { aim, onPage, rounded } from "./aim";
import type { PageAlong, PageAudit, PageFit, PageParts, PagePlan } from "./answers";
import { MOTION, Marker, wayOut, wayText } from "./assembly/clashes";
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
/** Directions to try first; among equally good ones the first is used. */
const AXES: Vec[] = [[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]];
/** Maximum number of parts for which a plan is computed without a request. */
const SOON = 40;
/** Maximum number of listed clashes. */
const MOST_CLASHES = 200;

export class AssemblyTab {
  readonly panel = h("div", { class: "assembly-panel" });
  readonly stage = h("div", { class: "assembly-stage" });
  private readonly view = h("div", { class: "assembly-view" });
  private readonly head = h("section", { class: "said", "aria-live": "polite" });
  private readonly list = h("div", { class: "parts" });
  private readonly fitCard = h("div");
  private readonly mapCard = h("div");
  private readonly planCard = h("div");
  private readonly clashCard = h("div");
  private readonly within = h("input", { type: "number", step: "any", min: 0, value: 0, "aria-label": "Clearance", inputmode: "decimal" });
  private readonly clashFields = [
    h("label", {}, "Clearance that every pair needs (0: list overlaps and contacts)", this.within),
    h("div", { class: "row" }, h("button", { class: "small main", onclick: () => void this.askAudit() }, "Find clashes")),
  ];
  private readonly fields: HTMLInputElement[];
  private readonly tolerance = h("input", { type: "number", step: "any", min: 0, "aria-label": "Tolerance of the assembly", inputmode: "decimal" });
  private readonly ignore = h("input", { type: "checkbox" });
  private readonly fitFields = [
    h("label", {}, "Tolerance (empty: from the files)", this.tolerance),
    h("label", { style: "display: flex; gap: 8px; align-items: center" }, this.ignore, "Ignore overlaps at the start"),
  ];
  private readonly player = new Player((t) => this.seen?.place(this.moves, t));
  private readonly sphere: Sphere | undefined;
  private readonly seen: Parts | undefined;
  private readonly marker: Marker | undefined;
  private readonly arrow = new Group();
  private engine: Engine;
  private files: { name: string; bytes: ArrayBuffer }[] = [];
  private source = "";
  private facts: PageParts | undefined;
  private fit: PageFit | undefined;
  private along: PageAlong | undefined;
  private map: RemovalMap | undefined;
  private plan: PagePlan | undefined;
  private audit: PageAudit | undefined;
  /** Index of the clash that is shown; -1 for none. */
  private clash = -1;
  private moves: Move[] = [];
  private error = "";
  private busy = "";
  /** Whether slow computations run without a request. */
  private patient = true;
  /** Whether to search for the direction that frees most parts, for files of the visitor. */
  private seeking = false;
  private asking = false;
  private again = false;
  /** Counts assemblies and fits; results for an older one are dropped. */
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
      this.marker = new Marker(this.seen);
      this.player.element.append(this.marker.element);
      this.arrange(this.seen, this.sphere);
    } catch (error) {
      this.view.append(h("p", { class: "lone", role: "alert" },
        `The three-dimensional view needs WebGL 2, which this browser lacks or has switched off (${said(error)}). The results are listed next to it.`));
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
    const ends = () => (this.facts && this.clash < 0 ? { base: new Vector3(), tip: this.tip() } : undefined);
    aim(seen.renderer.domElement, seen.camera, seen.orbit, ends, (way) => this.turnTo(rounded(way, 0.003)));
    sphere.onDirection = (d) => this.turnTo(rounded(d, 1e-4));
    this.stage.append(h("div", { class: "group assembly-tools" },
      h("button", { onclick: () => seen.fit() }, "Fit"),
      h("button", { onclick: () => this.player.set(0), title: "All parts at their places" }, "Assembled")));
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
        h("small", {}, `${names("and")} files, one part each, or GLB; or drop them here. Up to 120 parts and 400,000 triangles; for larger assemblies use the command line.`)),
      card("Direction",
        h("div", { class: "fields" }, h("span", {}, "d"), ...this.fields),
        h("div", { class: "row" },
          axis("+x", [1, 0, 0]), axis("−x", [-1, 0, 0]), axis("+y", [0, 1, 0]), axis("−y", [0, -1, 0]), axis("+z", [0, 0, 1]), axis("−z", [0, 0, -1]))),
      card("Removal map", this.mapCard),
      card("Disassembly plan", this.planCard),
      card("Clashes", this.clashCard),
      card("Fit", this.fitCard),
    ];
  }

  // --- questions

  /** Opens the tab for the first time, or on request, with the files of the example. */
  async start() {
    await this.example();
  }

  /** Whether the example is shown, or about to be. */
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

  /** Builds another assembly from files that the visitor chose or dropped. */
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
        if (turn !== this.turn) return engine.stop("another assembly was requested");
      }
      const { facts, numbers } = await engine.ask({ do: "parts" });
      if (turn !== this.turn) return engine.stop("another assembly was requested");
      // The current assembly stays until the new one has been read.
      this.engine.stop("another assembly was requested");
      this.engine = engine;
      [this.files, this.source, this.facts] = [files, source, facts];
      this.showParts(facts, numbers);
    } catch (error) {
      engine.stop("it was refused");
      // An error of an assembly does not matter once another one is requested.
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

  /** Computes everything again with the chosen tolerance. */
  private async refit() {
    if (!this.facts) return;
    // An address may name a part that does not exist.
    if (this.asked.part !== null && !this.facts.parts[this.asked.part]) this.asked.part = null;
    const turn = ++this.turn;
    [this.fit, this.along, this.map, this.plan, this.audit, this.error] = [undefined, undefined, undefined, undefined, undefined, ""];
    this.pickClash(-1);
    const { tolerance, ignore } = this.asked;
    this.wait("Searching for overlaps and contacts");
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

  /** Turns the arrow to the axis along which most parts, or else most groups, come out; the first of equal ones. */
  private async seek(turn: number) {
    this.seeking = false;
    this.wait("Searching for the direction that frees most parts");
    let most: [number, number] = [-1, -1];
    for (const direction of AXES) {
      const { facts } = await this.engine.ask({ do: "along", direction });
      if (turn !== this.turn || !this.facts) return;
      const [free, groups] = [freeParts(facts).length, properGroups(facts, this.facts).length];
      if (free > most[0] || free === most[0] && groups > most[1]) [most, this.asked.direction] = [[free, groups], direction];
    }
    this.remember();
  }

  /** Computes the blocking graph along the arrow. One question is pending at a time. */
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
    this.wait("Examining all directions");
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
      this.plan = facts;
      if (this.clash < 0) this.playPlan();
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    } finally {
      if (turn === this.turn) this.wait("");
    }
    this.show();
  }

  /** Plays the plan, if there is one. */
  private playPlan() {
    const { plan, facts } = this;
    this.moves = [];
    if (!plan || !facts) return this.player.show([], "");
    const { size, middle, unit: of } = facts;
    const places = new Map(facts.parts.map(({ name }, k) => [name, k]));
    this.moves = plan.plan.map(({ path, back = [] }) => [...path, ...back].map((leg, l) => {
      // The parts of a step leave with the last move of its path.
      const leaves = l === path.length - 1;
      const moved = { parts: leg.parts.map((name) => places.get(name)!), way: times(leg.direction, leg.travel + (leaves ? 0.35 * size : 0)) };
      if (!leg.turn) return moved;
      // Parts are shown relative to the middle of the assembly.
      const { point, axis, aside, phase, turns } = leg.turn, at = sub(point, middle);
      return { ...moved, turn: { own: sub(at, aside), point: at, axis, phase, turns } };
    }));
    this.player.show(
      plan.plan.map(({ parts, path, direction, travel }) => `${parts.join(", ")} ${severally(path)}along ${arrow(direction)}${travel ? `, ${short(travel, 4)} ${of ?? ""}` : ""}`),
      `${facts.parts.length} parts, ${plan.plan.length} steps; point at a part for its name.`);
  }

  /** Finds the pairs that overlap, touch, or are nearer than the clearance. */
  private async askAudit() {
    if (!this.fit) return;
    const turn = this.turn;
    this.wait("Searching for clashes");
    try {
      const { facts } = await this.engine.ask({ do: "audit", within: Math.max(0, this.within.valueAsNumber || 0) });
      if (turn !== this.turn) return;
      this.audit = facts;
      this.pickClash(facts.audit.pairs.length ? 0 : -1);
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    } finally {
      if (turn === this.turn) this.wait("");
    }
  }

  /** Shows a clash with its shortest way out that was found; -1 for the whole assembly and its plan. */
  private pickClash(k: number) {
    const view = this.audit?.views[k];
    if (this.clash >= 0 && !view) this.seen?.fit();
    this.clash = view ? k : -1;
    this.arrow.visible = !view;
    if (view) {
      this.moves = wayOut(view);
      this.player.show(
        this.moves.map(() => wayText(this.name(view.parts[0]))),
        `${view.parts.map((part) => this.name(part)).join(" and ")}; point at a part for its name.`, MOTION);
    } else {
      this.playPlan();
    }
    this.marker?.show(view);
    this.show();
  }

  /** Downloads the printable report of the plan, or that of the clashes. */
  private async report(of: "report" | "clashes") {
    const turn = this.turn;
    this.wait(of === "report" ? "Drawing a page for each step" : "Drawing a section for each pair");
    try {
      const { numbers } = await this.engine.ask({ do: of, title: this.source });
      if (turn !== this.turn) return;
      save(new Blob([numbers], { type: "text/html" }), `${of}.html`);
    } catch (error) {
      if (turn === this.turn) this.refuse(error);
    } finally {
      if (turn === this.turn) this.wait("");
    }
  }

  /** Cancels a slow computation: stops the worker and lets another one read the files. */
  private async giveUp() {
    this.engine.stop("it was cancelled");
    this.patient = false;
    this.asked.part = null;
    if (this.facts) await this.load(this.files, this.source).catch((error: unknown) => this.refuse(error));
    else this.refuse(new Error("It was cancelled."));
  }

  /** Called when the address has changed. */
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
    if (this.clash >= 0) this.pickClash(-1);
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

  // --- output

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
    this.showClashes();
    this.showArrow();
    if (this.clash >= 0) return;
    const { part } = asked;
    const met = part === null ? undefined : this.along?.closures[part];
    this.seen?.fade((k) => (met !== undefined && !met.includes(this.name(k)) ? 0.22 : 1));
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
        : groups.length ? `These groups can leave together: ${groups.slice(0, 3).map((group) => group.join(", ")).join("; ")}.` : "Every part is blocked."),
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
      refill(this.mapCard, h("p", { class: "proof" }, "Pick a part, here or in the view. The sphere then shows its free travel in every direction while all other parts stay."));
      return;
    }
    const name = this.name(part);
    if (!map) {
      refill(this.mapCard, h("p", { class: "proof" }, `${name}: examining all directions.`));
      return;
    }
    const blocked = map.distances.reduce((best, x, k) => (Number.isFinite(x) && x > map.distances[best]! || !Number.isFinite(map.distances[best]!) ? k : best), 0);
    const go = (d: Vec, text: string) => h("button", { class: "small", onclick: () => this.turnTo(rounded(d, 1e-9)) }, text);
    const farthest = map.distances[blocked]!;
    const of = (k: number): Vec => [0, 1, 2].map((c) => map.directions[3 * k + c]!) as Vec;
    refill(this.mapCard,
      h("p", { class: "proof" }, `${name} ${freedom(map)}. In the other directions paler means farther. Click to choose a direction.`),
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
      h("p", { class: "proof" }, `${plan.directions} directions were tested for all parts; each step was checked again, pair by pair.`),
      h("ol", {}, ...rows), ...remains, ...stuck,
      h("div", { class: "row" }, h("button", { class: "small", disabled: !!this.busy, onclick: () => void this.report("report") }, "Download report.html"), h("small", {}, "one page for each step, for printing")));
  }

  private showClashes() {
    const { audit: found, facts } = this;
    if (!facts) return;
    const audit = found?.audit;
    const of = facts.unit ?? "";
    const rows = audit?.pairs.slice(0, MOST_CLASHES).map((pair, k) => h("button", {
      class: `part ${pair.violation ? "overlapping" : ""}`, "aria-pressed": String(k === this.clash), onclick: () => this.pickClash(k === this.clash ? -1 : k),
    }, h("i", { style: `background: ${pair.violation ? palette().normal : "none"}` }), h("strong", {}, pair.parts.join(" · ")), h("span", {}, measure(pair, of)))) ?? [];
    const more = (audit?.pairs.length ?? 0) - rows.length;
    refill(this.clashCard,
      ...this.clashFields,
      ...(audit ? [
        h("p", { class: "proof", id: "clashes-found" }, summary(audit.counts)),
        h("div", { class: "parts" }, ...rows),
        ...(more > 0 ? [h("small", {}, `and ${more} more, which the report lists`)] : []),
        h("div", { class: "row" },
          h("button", { class: "small", disabled: !!this.busy, onclick: () => void this.report("clashes") }, "Download clashes.html"),
          h("button", { class: "small", onclick: () => this.copy(this.asAudit(audit.within), "The command") }, "Copy as command line")),
      ] : []));
  }

  private asAudit(within: number): string {
    const { tolerance } = this.asked;
    return ["colltrans", "audit", quoted(this.source), `--within=${within}`, ...(tolerance === null ? [] : [`--tolerance=${tolerance}`])].join(" ");
  }

  /** Returns the tip of the arrow. */
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

  /** State for tests. */
  probe() {
    const { facts, fit, along, map, plan, audit, clash, engine, busy, error } = this;
    const tip = this.seen && onPage(this.seen.renderer.domElement, this.seen.camera, this.tip());
    return { facts, fit, along, map, plan, audit, clash, engine, busy, error, tip, t: this.player.t };
  }
}

/** Returns the parts that can be removed alone. */
const freeParts = (along: PageAlong) => along.rooms.filter(({ outcome }) => outcome === "free");

/** Returns the groups that come out as one, without single parts and without the whole assembly, which can always be moved. */
const properGroups = (along: PageAlong, { parts }: PageParts) => along.removable.filter(({ length }) => length > 1 && length < parts.length);

/** Returns the pairs that overlap with the tolerance, the deepest six as text, and their number. */
function overlapping(fit: PageFit | undefined): { pairs: string; count: number } {
  const remaining = fit?.overlaps.filter(({ remains }) => remains) ?? [];
  const pairs = remaining.slice(0, 6).map(({ parts, least_tolerance: depth }) => `${parts.join(" and ")}${depth === null ? "" : ` (${short(depth, 3)})`}`);
  return { pairs: `${pairs.join("; ")}${remaining.length > 6 ? "; …" : ""}`, count: remaining.length };
}

type Audit = PageAudit["audit"];

/** Describes the numbers of pairs of an audit. */
function summary({ violations, interfering, contained, touching, near }: Audit["counts"]): string {
  const kinds = [[interfering, "interfering"], [contained, "one inside the other"], [touching, "touching"], [near, "nearer than the clearance"]] as const;
  const each = kinds.filter(([count]) => count).map(([count, what]) => `${count} ${what}`);
  return `${violations || "No"} ${violations === 1 ? "pair violates its" : violations ? "pairs violate their" : "pair violates its"} clearance${each.length ? `: ${each.join(", ")}` : ""}. Click a pair to see it.`;
}

/** Formats the number that ranks a pair. */
function measure({ finding, depth, distance, wall }: Audit["pairs"][number], of: string): string {
  const bounds = depth ?? distance;
  if (!bounds || finding === "touching") return finding;
  const text = ([from, to]: (string | undefined)[]) => `${from === to ? from : `${from} to ${to}`} ${of}`;
  const rounded = (pair: readonly (number | null)[]) => text(pair.map((x) => (x === null ? "?" : short(x, 4))));
  return `${finding === "apart" ? "distance" : finding} ${rounded(bounds)}${wall ? `, wall ${rounded(wall)}` : ""}`;
}

const said = (error: unknown) => (error instanceof Error ? error.message : String(error));

/** Describes the parts that block a part. */
function blockers(along: PageAlong, part: number, name: string): string {
  const met = along.meetings.filter(({ moving }) => moving === name).sort((a, b) => a.distance - b.distance);
  if (!met.length) return "Nothing blocks it.";
  const each = met.map(({ fixed, outcome, distance }) => `${fixed} ${outcome === "overlapping" ? "(overlap)" : `after ${short(distance, 4)}`}`).join(", ");
  return `Blocked by: ${each}. With all parts that must move along: ${along.closures[part]!.length} parts, in full in the view.`;
}

function freedom({ free_share, exactly, regions, isolated: { length: single } }: RemovalMap): string {
  const unknown = exactly?.undecided_share ?? 0;
  const proven = exactly ? (unknown > 0 ? `, which is proven but for ${short(100 * unknown, 2)} %` : ", which is proven") : ", as sampled";
  // Regions that are too small to be visible are drawn as dots.
  const share = regions.length > 0 && `is free in ${short(100 * free_share, 3)} % of all directions (green)${proven}`;
  const arcs = exactly?.arcs?.length ?? 0;
  const several = (count: number, what: string) => `${count} ${what}${count > 1 ? "s" : ""}`;
  const tight = [single > 0 && `in ${several(single, "single direction")} (dots)`, arcs > 0 && `along ${several(arcs, "arc")} (lines)`].filter(Boolean);
  const alone = tight.length > 0 && `${tight.join(" and ")}, a tight fit`;
  if (share) return alone ? `${share}, and ${alone}` : share;
  if (alone) return `is free only ${alone}${proven}`;
  return exactly ? `is free in no direction${proven}` : "is free in no tested direction";
}

/** Formats a direction for display: an axis by name. */
function arrow(d: Vec): string {
  const names = ["x", "y", "z"].flatMap((name, k) => (Math.abs(Math.abs(d[k]!) / length(d) - 1) < 1e-12 ? [`${d[k]! > 0 ? "+" : "−"}${name}`] : []));
  return names[0] ?? `(${shown(d)})`;
}

/** Describes the moves before the last one, if a path has several. */
const severally = (path: { travel: number; turn?: { turns: number } }[]) => {
  const { turn, travel } = path[0]!;
  if (turn && !travel) return `turned by ${short(360 * turn.turns, 4)}°, then `;
  if (turn) return `unscrewed, ${short(Math.abs(turn.turns), 3)} turns, then `;
  return path.length > 1 ? `in ${path.length} moves, the last ` : "";
};
