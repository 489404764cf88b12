// The page: a question, its answer, and the view of it.
//
// Data flow: `State` (the question, kept in the address) -> `Engine` (the library, in a worker) -> the answer ->
// `View`, `Shadow`, `Timeline` and the panel. One question is pending at a time; of those that arrive meanwhile only
// the last is sent.

import { onChange } from "./colours";
import { h, named, save, soon } from "./dom";
import type { PageCast, PageCertify } from "./answers";
import { Engine, type Pair, Refused, type Slot, type Take, bytesOf } from "./engine";
import { EXAMPLES, type Part, SLOTS } from "./examples";
import { ACCEPTED } from "./formats";
import { dot, length, placed, sub } from "./math";
import type { AssemblyTab } from "./assembly";
import type { Found } from "./found";
import type { Near, Nearness } from "./near";
import { AnswerPanel, type Picture, type Refusal, type Shown } from "./panel";
import { isShape } from "./primitive";
import { isSolid } from "./share";
import type { Source } from "./placing";
import { Shadow } from "./shadow";
import { IN_FILE, type State, TABS, type Tab, fromExample, fromHash, toHash } from "./state";
import { Timeline, times } from "./time";
import type { Turning } from "./turning";
import { View } from "./view";
import { type Bodies, type Drawn, drawn, forget } from "./view/body";
import { drawable } from "./view/framing";
import type { Tool } from "./view/handles";

/** Maximum number of triangles of both bodies for which the proof is built without a request. */
const PROVED_SOON = 20_000;
/** The example that is an assembly. */
const GEARBOX = "gearbox";
/** The library that has all bodies. */
const ALL = "colltrans_all";
/** Checks whether a body is not in the library of the first answer, which has convex polyhedra alone. */
const needsAll = (file: string, take: Take) => isShape(file) || isSolid(take);

/** Assigns up to two files to the bodies, the first one to the given body. */
function bySlot(files: File[], first: Slot = "moving"): [Slot, File][] {
  const second: Slot = first === "moving" ? "fixed" : "moving";
  return ([[first, files[0]], [second, files[1]]] as const).filter((one): one is [Slot, File] => !!one[1]);
}

/** Checks whether a file is one of an example. */
const isOfExample = (file: string) => Object.values(EXAMPLES).some((e) => e.moving.file === file || e.fixed.file === file);

class Page {
  private state: State = fromHash(location.hash);
  /** The address of the current state. */
  private address = location.hash;
  private answer: PageCast | undefined;
  private error: string | undefined;
  private took = 0;
  /** Milliseconds from the start of the page. */
  private firstAnswer: number | undefined;
  private verdict: Shown["verdict"];
  /** The proof of an answer between solids, with its entries. */
  private solidProof: PageCertify | undefined;
  private proving = 0;
  private readonly refusals: Partial<Record<Slot, Refusal>> = {};
  private engine = new Engine(SLOTS.some((slot) => needsAll(this.state.parts[slot].file, this.state.parts[slot].take)) ? ALL : "colltrans");
  /** The library that has the body of a slot. */
  private readonly placedIn: Record<Slot, Engine | undefined> = { moving: undefined, fixed: undefined };
  /** The library that was used before. */
  private replaced: Engine | undefined;
  private readonly bodies: Bodies = {};
  /** The sources of the bodies. */
  private readonly made: Partial<Record<Slot, Part>> = {};
  /** Created after the first answer, because graphics may take a while to start. */
  private view: View | undefined;
  private readonly shadow = new Shadow();
  private readonly panel: AnswerPanel;
  /** Loaded when their tabs are opened. */
  private found: Found | undefined;
  private turning: Turning | undefined;
  private assembly: AssemblyTab | undefined;
  private readonly opening = new Set<Tab>();
  /** The tab that the additions to the view belong to. */
  private extras: Tab = "answer";
  private readonly time: Timeline;
  /** The last answered question, and the one before, about the same bodies. */
  private last: Pair | undefined;
  private before: Pair | undefined;
  private asking = false;
  private again = false;
  /** The distance of the bodies, loaded on demand. */
  private nearness: Near | undefined;
  private near: Nearness | undefined;
  private nearButton: HTMLElement | undefined;
  private along: HTMLElement | undefined;
  private nearing = false;
  private nearAgain = false;
  private readonly sources: Partial<Record<Slot, Source>> = {};
  /** The bytes of the last file of each slot. */
  private readonly given: Partial<Record<Slot, Source["bytes"]>> = {};
  private loading = 0;
  /** Counts requests for a body; results for an older one are dropped. */
  private readonly turns: Record<Slot, number> = { moving: 0, fixed: 0 };
  /** Counts changes of the bodies; answers about other ones are dropped. */
  private pairs = 0;
  /** Slots whose next body takes the pose of its file instead of the pose in the state. */
  private readonly asInFile: Record<Slot, boolean> = { moving: false, fixed: false };
  /** The body before a rejected one; it is shown again if the rejected file is discarded. */
  private readonly previous: Partial<Record<Slot, { drawn: Drawn; source: Source | undefined }>> = {};
  private tool: Tool = "look";
  private held: Slot = "moving";

  constructor() {
    named("inset").append(this.shadow.element);
    this.panel = new AnswerPanel({
      change: (change) => this.change(change),
      choose: (slot) => this.choose(slot),
      chooseBoth: () => this.chooseBoth(),
      take: (slot, take) => void this.take(slot, take),
      shape: (slot, name) => this.shape(slot, name),
      dismiss: (slot) => this.restore(slot),
      verify: () => void this.verify(),
      copy: (text, what) => void this.copy(text, what),
      save: (how) => void this.save(how),
    });
    named("panel").append(this.panel.element);
    this.time = new Timeline(named("time"), (t) => this.change((state) => (state.tab === "motion" ? (state.motion.time = t) : (state.t = t)), false));
    this.controls();
    this.drops();
  }

  async start() {
    await this.loadBoth();
    // The answer is computed while the view is created.
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    const view = this.makeView();
    if (!view) return;
    view.onDirection = (d) => this.change((state) => (state.direction = d));
    view.onPose = (slot, pose) => this.change((state) => (state.poses[slot] = pose));
    this.view = view;
    this.tools(view);
    this.fit();
    this.show();
  }

  /** Loads the code of a tab. */
  private async openTab(tab: Tab) {
    const { view } = this;
    if (this.opening.has(tab) || (tab !== "assembly" && !view)) return;
    this.opening.add(tab);
    try {
      await tabStyles();
      if (tab === "motion") {
        const { Turning } = await import("./turning");
        this.turning = new Turning({
          view: view!, sources: () => this.sources, change: (change) => this.change(change, false), shown: () => this.show(),
          begin: (name, change) => this.begin(name, change), copy: (text, what) => void this.copy(text, what),
        });
        named("panel").prepend(this.turning.element);
      } else if (tab === "found") {
        const { Found } = await import("./found");
        this.found = new Found({
          view: view!, pair: () => this.pair(), before: () => this.before, sources: () => this.sources, example: (name) => this.begin(name),
          move: (pose) => this.change((state) => (state.poses.moving = pose)), translation: () => this.answer?.record.translation,
          proven: () => (this.answer?.proof && "contact" in this.answer.proof ? this.answer.proof.contact.pairs.map(({ moving, fixed }) => [moving, fixed]) : []),
        });
        named("panel").append(this.found.element);
        this.found.changed();
      } else if (tab === "assembly") {
        const { AssemblyTab } = await import("./assembly");
        this.assembly = new AssemblyTab(() => this.state, () => this.remember(), (text, what) => void this.copy(text, what));
        named("panel").append(this.assembly.panel);
        named("stage").prepend(this.assembly.stage);
        void this.assembly.start();
      }
    } catch (error) {
      this.opening.delete(tab);
      // Do not retry at once.
      this.state.tab = "answer";
      toast(`This part of the page could not be read: ${error instanceof Error ? error.message : String(error)}`);
    }
    this.show();
  }

  /** Creates the view; the answer and the shadows work without it. */
  private makeView(): View | undefined {
    try {
      return new View(named("view"), this.bodies);
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      named("view").append(h("p", { class: "lone", role: "alert" },
        `The three-dimensional view needs WebGL 2, which this browser lacks or has switched off (${why}). The answer, its proof and the shadows work without it.`));
      return undefined;
    }
  }

  private fit(along = false) {
    if (this.state.tab === "motion" && this.turning) this.turning.fit(along);
    else this.view?.fit(this.state, this.answer, along);
  }

  // --- questions

  private pair(): Pair {
    const { poses, direction, graze, solver, start, until, tolerance, ignore } = this.state;
    const narrowing = solver === "cta" ? { start, until: until ?? ("exit" as const) } : {};
    return { moving_pose: poses.moving, fixed_pose: poses.fixed, direction, graze, solver, ...narrowing, tolerance, ignore_overlaps: ignore };
  }

  private change(change: (state: State) => void, asks = true) {
    change(this.state);
    if (asks) {
      this.verdict = undefined;
      void this.ask();
    }
    this.show();
    this.remember();
  }

  private write() {
    history.replaceState(null, "", toHash(this.state));
    this.address = location.hash;
  }

  private readonly remember = (() => {
    let timer = 0;
    return () => {
      clearTimeout(timer);
      timer = window.setTimeout(() => {
        // The address is not ours: a link was followed, and its event is still to come.
        if (location.hash !== this.address) return;
        this.write();
        this.showExample();
      }, 250);
    };
  })();

  private async ask(): Promise<void> {
    if (this.asking) {
      this.again = true;
      return;
    }
    if (!this.bodies.moving || !this.bodies.fixed) {
      this.clearAnswer();
      this.show();
      this.found?.changed();
      return;
    }
    this.asking = true;
    const { pairs } = this;
    try {
      const pair = structuredClone(this.pair());
      await this.bring();
      const { answer, took } = await this.engine.cast(pair);
      if (pairs === this.pairs) this.answered(pair, answer, took);
    } catch (error) {
      if (pairs === this.pairs) [this.answer, this.error] = [undefined, String(error instanceof Error ? error.message : error)];
    }
    this.asking = false;
    if (this.again || pairs !== this.pairs) {
      this.again = false;
      void this.ask();
    }
    this.show();
    this.found?.changed();
    this.proveSoon();
    void this.askNear();
  }

  private answered(pair: Pair, answer: PageCast, took: number) {
    if (JSON.stringify(pair) !== JSON.stringify(this.last)) [this.before, this.last] = [this.last, pair];
    this.firstAnswer ??= performance.now();
    [this.answer, this.took, this.error] = [answer, took, undefined];
  }

  /** Removes the answer when its bodies change. */
  private clearAnswer() {
    clearTimeout(this.proving);
    [this.answer, this.error, this.verdict, this.solidProof, this.near] = [undefined, undefined, undefined, undefined, undefined];
  }

  /** Called when the pair of bodies has changed. */
  private changedPair() {
    this.pairs++;
    this.clearAnswer();
  }

  /** Asks for the distance. As with casts, only the last of several pending questions is sent. */
  private async askNear(): Promise<void> {
    if (this.nearing) {
      this.nearAgain = true;
      return;
    }
    const { moving, fixed } = this.bodies;
    if (!this.state.near || !moving || !fixed) {
      if (this.near) {
        this.near = undefined;
        this.show();
      }
      return;
    }
    this.nearing = true;
    const { pairs } = this;
    try {
      this.nearness ??= new (await import("./near")).Near();
      const near = await this.nearness.ask({ moving: moving.body, fixed: fixed.body }, this.pair());
      if (pairs === this.pairs) this.near = near;
    } catch (error) {
      this.near = undefined;
      toast(`No distance: ${error instanceof Error ? error.message : String(error)}`);
    }
    this.nearing = false;
    if (this.nearAgain || !this.state.near || pairs !== this.pairs) {
      this.nearAgain = false;
      void this.askNear();
    }
    this.show();
  }

  /** Builds the proof between small solids once the question has settled. */
  private proveSoon() {
    this.solidProof = undefined;
    clearTimeout(this.proving);
    const triangles = SLOTS.reduce((sum, slot) => sum + (this.bodies[slot]?.body.facts.triangles ?? 0), 0);
    if (this.answer?.kind !== "solid" || triangles > PROVED_SOON) return;
    this.proving = window.setTimeout(() => this.prove().catch(() => undefined), 250);
  }

  private async prove() {
    const answer = this.answer;
    const { facts } = await this.engine.ask({ do: "certify", ...this.pair() });
    if (answer === this.answer) this.solidProof = facts;
    this.show();
  }

  /** Checks every proof separately: for solids the claims, and the plane if there is one. */
  private async verify() {
    const answer = this.answer;
    if (!answer) return;
    try {
      if (answer.kind === "solid" && !this.solidProof) await this.prove();
      const claims = answer.kind === "solid" ? this.solidProof?.proof : undefined;
      const told: string[] = [];
      for (const proof of [claims, answer.proof]) {
        if (!proof) continue;
        const { facts } = await this.engine.ask({ do: "verify", ...this.pair(), proof });
        if (answer !== this.answer) return;
        if (!facts.holds) throw new Error(facts.because);
        const { start, cover } = claims?.clearance ?? { start: "assumed", cover: "" };
        const entries = cover.length + (typeof start === "object" && "apart" in start ? start.apart.length : 0);
        const what = proof === claims ? `${entries.toLocaleString("en")} entries checked, gap` : "separation" in proof ? "margin" : "gap";
        told.push(`${what} proven ${Number(facts.proven).toExponential(1)}`);
      }
      this.verdict = { holds: true, text: `✓ it holds: ${told.join("; ")}` };
    } catch (error) {
      if (answer !== this.answer) return;
      this.verdict = { holds: false, text: `✗ ${error instanceof Error ? error.message : String(error)}` };
    }
    this.show();
  }

  // --- bodies

  private async loadBoth() {
    [this.answer, this.verdict] = [undefined, undefined];
    await Promise.all(SLOTS.map((slot) => this.loadExample(slot)));
    await this.ask();
  }

  /** Loads a file of `data/` named in the state. */
  private async loadExample(slot: Slot) {
    const turn = ++this.turns[slot];
    const { file, take } = this.state.parts[slot];
    this.asInFile[slot] = false;
    try {
      const url = new URL(`data/${file}`, document.baseURI);
      const known = isOfExample(file);
      // A file of the visitor is still available when an address, or the back button, needs it again.
      const made = this.made[slot];
      if (!known && this.bodies[slot] && made?.file === file && made.take === take) return;
      const shape = isShape(file);
      const response = known && !shape ? await fetch(url) : undefined;
      if (!shape && !response?.ok) throw new Refused(`${file} is not among the examples: choose or drop it again`);
      const bytes = await response?.arrayBuffer();
      if (response) this.given[slot] = async () => (await fetch(url)).arrayBuffer();
      if (turn === this.turns[slot]) await this.load(slot, file, take, bytes);
    } catch (error) {
      if (turn !== this.turns[slot]) return;
      // The previous body does not belong to the question.
      this.remove(slot);
      this.refuse(slot, file, error);
    }
  }

  private async load(slot: Slot, name: string, take: Take, file?: ArrayBuffer) {
    this.waiting(+1);
    if (needsAll(name, take) && this.engine.library !== ALL) [this.replaced, this.engine] = [this.engine, new Engine(ALL)];
    const before = this.placedIn[slot];
    this.placedIn[slot] = this.engine;
    try {
      const body = await this.engine.load(slot, name, take, file).catch((error: unknown) => {
        this.placedIn[slot] = before;
        throw error;
      });
      this.remove(slot);
      [this.last, this.before] = [undefined, undefined];
      this.bodies[slot] = drawn(body);
      this.state.parts[slot] = { file: name, take };
      if (this.asInFile[slot]) {
        this.asInFile[slot] = false;
        this.state.poses[slot] = [...IN_FILE];
        this.state.motion.screw = null;
      }
      this.made[slot] = { file: name, take };
      const bytes = isShape(name) ? async () => new ArrayBuffer(0) : this.given[slot];
      if (bytes) this.sources[slot] = { name, take, bytes };
      delete this.refusals[slot];
    } finally {
      this.waiting(-1);
    }
  }

  /** Loads the bodies that the previous library has into the current one. */
  private async bring() {
    for (const slot of SLOTS) {
      const source = this.sources[slot];
      if (this.placedIn[slot] === this.engine || !source) continue;
      const bytes = await source.bytes();
      // Another body may have been loaded meanwhile.
      if (this.placedIn[slot] === this.engine) continue;
      const before = this.placedIn[slot];
      this.placedIn[slot] = this.engine;
      try {
        await this.engine.load(slot, source.name, source.take, bytes);
      } catch (error) {
        this.placedIn[slot] = before;
        throw error;
      }
    }
    this.replaced?.stop("another library has the bodies");
    this.replaced = undefined;
  }

  private remove(slot: Slot) {
    for (const body of [this.bodies[slot], this.previous[slot]?.drawn]) forget(body);
    delete this.bodies[slot];
    delete this.previous[slot];
    this.changedPair();
  }

  /** Restores the body before a rejected file. */
  private restore(slot: Slot) {
    delete this.refusals[slot];
    const before = this.previous[slot];
    if (before) {
      delete this.previous[slot];
      this.bodies[slot] = before.drawn;
      if (before.source) this.sources[slot] = before.source;
      this.asInFile[slot] = false;
      this.changedPair();
      void this.ask();
    }
    this.show();
  }

  private refuse(slot: Slot, name: string, error: unknown) {
    const { [slot]: drawn } = this.bodies;
    // A large body was dropped to make room for the file.
    if (error instanceof Refused && error.gone) this.remove(slot);
    else if (drawn) {
      // The body no longer belongs to the question, but may be restored.
      this.previous[slot] = { drawn, source: this.sources[slot] };
      delete this.bodies[slot];
      this.changedPair();
    }
    delete this.sources[slot];
    const instead = error instanceof Refused ? error.instead : [];
    const before = this.previous[slot] && this.state.parts[slot].file;
    this.refusals[slot] = { name, message: error instanceof Error ? error.message : String(error), instead, before };
    void this.ask();
    this.show();
    // The message may be far below the place of the drop.
    requestAnimationFrame(() => document.querySelector(".refused")?.scrollIntoView({ block: "nearest" }));
  }

  /** Opens files that the visitor chose or dropped. They take the poses of their files and are loaded together. */
  private async open(files: [Slot, File][]) {
    for (const [slot, file] of files) {
      const turn = ++this.turns[slot];
      const { file: name, take } = this.state.parts[slot];
      // A link to a file of the visitor specifies how it is used and its pose.
      const linked = !this.bodies[slot] && !this.previous[slot] && file.name === name;
      try {
        const bytes = await bytesOf(file);
        if (turn !== this.turns[slot]) continue;
        this.given[slot] = () => bytesOf(file);
        this.asInFile[slot] = !linked;
        await this.load(slot, file.name, linked ? take : "convex", bytes);
      } catch (error) {
        if (turn === this.turns[slot]) this.refuse(slot, file.name, error);
      }
    }
    await this.changedBody();
  }

  /** Replaces a body by one that a name describes, at the same pose. */
  private shape(slot: Slot, name: string) {
    this.turns[slot]++;
    this.asInFile[slot] = false;
    void this.take(slot, "convex", name);
  }

  /** Uses the rejected or current file, or a body of another name, in another way. */
  private async take(slot: Slot, take: Take, name = this.refusals[slot]?.name ?? this.state.parts[slot].file) {
    try {
      // The library may lack a file that another one refused, and another library is without files.
      const isOther = this.placedIn[slot] !== this.engine || (needsAll(name, take) && this.engine.library !== ALL);
      const isFile = !isShape(name) && (this.refusals[slot] || isOther);
      await this.load(slot, name, take, isFile ? await this.given[slot]?.() : undefined);
      await this.changedBody();
    } catch (error) {
      this.refuse(slot, name, error);
    }
  }

  private async changedBody() {
    this.verdict = undefined;
    this.state.t = null;
    await this.ask();
    this.fit();
    this.remember();
  }

  private choose(slot: Slot) {
    const input = h("input", { type: "file", accept: ACCEPTED });
    input.addEventListener("change", () => {
      const file = input.files?.[0];
      if (file) void this.open([[slot, file]]);
    });
    input.click();
  }

  private chooseBoth() {
    const input = h("input", { type: "file", accept: ACCEPTED, multiple: true });
    input.addEventListener("change", () => void this.open(bySlot([...(input.files ?? [])])));
    input.click();
  }

  private waiting(change: number) {
    this.loading += change;
    const wait = named("wait");
    // Fast operations need no message.
    clearTimeout(Number(wait.dataset.timer));
    if (!this.loading) wait.hidden = true;
    else wait.dataset.timer = String(setTimeout(() => {
      wait.textContent = "Reading the mesh";
      wait.hidden = false;
    }, 150));
  }

  // --- output

  private readonly show = soon(() => {
    const { state, answer, view } = this;
    const { moving, fixed } = this.bodies;
    document.body.dataset.tab = state.tab;
    for (const tab of TABS) {
      const element = named(`tab-${tab}`);
      element.setAttribute("aria-selected", String(state.tab === tab));
      element.tabIndex = state.tab === tab ? 0 : -1;
    }
    const isExample = SLOTS.every((slot) => isOfExample(state.parts[slot].file) && !this.refusals[slot]);
    const shown: Shown = { state, isExample, answer, error: this.error, took: this.took, bodies: this.bodies, refusals: this.refusals, solidProof: this.solidProof, near: this.near, verdict: this.verdict };
    this.panel.show(shown);
    if (state.tab !== "answer") void this.openTab(state.tab);
    if (this.extras !== state.tab) view?.clearExtra();
    this.extras = state.tab;
    this.found?.show(state, state.tab === "found");
    if (state.tab !== "motion") this.time.show(times(state, answer, this.pass()));
    view?.setLook(state.tab === "found" ? "ghosts" : state.tab === "motion" ? "resting" : "answer");
    view?.setNear(this.near);
    this.nearButton?.setAttribute("aria-pressed", String(state.near));
    if (this.along) this.along.textContent = state.tab === "motion" ? "Along axis" : "Along d";
    view?.show(state, answer);
    const turned = this.turning?.show(state, state.tab === "motion");
    if (turned) this.time.show(turned);
    const seen = moving && fixed && drawable(state, answer, moving, fixed);
    named("inset").hidden = !seen || state.tab !== "answer";
    if (seen) this.shadow.show(state, { moving, fixed }, answer);
  });

  /** Returns the translation after which the bodies have passed each other. */
  private pass(): number {
    const { moving, fixed } = this.bodies;
    const { poses, direction } = this.state;
    if (!moving || !fixed || !length(direction)) return 1;
    const apart = sub(placed(poses.fixed, fixed.middle), placed(poses.moving, moving.middle));
    const ahead = dot(apart, direction) / length(direction);
    return Math.max(ahead + moving.radius + fixed.radius, 2 * moving.radius) / length(direction);
  }

  // --- controls

  private controls() {
    const select = named<HTMLSelectElement>("example");
    select.append(h("option", { value: "" }, "Choose an example"));
    for (const [name, { title }] of Object.entries(EXAMPLES)) select.append(h("option", { value: name }, title));
    select.append(h("option", { value: GEARBOX }, "A small gearbox (an assembly)"));
    this.showExample();
    select.addEventListener("change", async () => {
      if (!select.value) return;
      if (select.value === GEARBOX) {
        this.change((state) => (state.tab = "assembly"), false);
        void this.assembly?.start();
        return;
      }
      await this.begin(select.value);
    });
    this.tabs();
    named("theme").addEventListener("click", () => {
      const root = document.documentElement;
      const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
      root.dataset.theme = dark ? "light" : "dark";
      this.themed();
    });
    onChange(() => this.themed());
    addEventListener("hashchange", () => {
      this.address = location.hash;
      if (location.hash === toHash(this.state)) return;
      this.state = fromHash(location.hash);
      this.showExample();
      void this.loadBoth().then(() => this.fit());
      this.assembly?.stateChanged();
    });
  }

  /** Loads an example from its initial state. */
  private async begin(example: string, change: (state: State) => void = () => {}) {
    const tab = this.state.tab === "assembly" ? "answer" : this.state.tab;
    this.state = { ...fromExample(example), tab, near: this.state.near, assembly: this.state.assembly };
    change(this.state);
    await this.loadBoth();
    this.fit();
    this.remember();
  }

  /** Selects the example in the list if the question is unchanged; otherwise it can be chosen again. */
  private showExample() {
    const asked = toHash({ ...this.state, t: null, near: false, tab: "answer" });
    const same = Object.keys(EXAMPLES).find((name) => toHash(fromExample(name)) === asked) ?? "";
    const gearbox = this.assembly?.isExample ?? true ? GEARBOX : "";
    named<HTMLSelectElement>("example").value = this.state.tab === "assembly" ? gearbox : same;
  }

  /** Only one tab is in the focus order; arrow keys go to the others. */
  private tabs() {
    const pick = (k: number) => this.change((s) => (s.tab = TABS[k]!), false);
    TABS.forEach((tab, k) => {
      const element = named(`tab-${tab}`);
      element.addEventListener("click", () => pick(k));
      element.addEventListener("keydown", (event) => {
        const last = TABS.length - 1;
        const next = { ArrowRight: k === last ? 0 : k + 1, ArrowLeft: k === 0 ? last : k - 1, Home: 0, End: last }[event.key];
        if (next === undefined) return;
        event.preventDefault();
        pick(next);
        named(`tab-${TABS[next]!}`).focus();
      });
    });
  }

  private themed() {
    this.view?.themeChanged();
    this.assembly?.themeChanged();
    this.show();
  }

  private tools(view: View) {
    const button = (text: string, title: string, press: () => void) => h("button", { title, onclick: press }, text);
    const tools: [Tool, Slot, HTMLButtonElement][] = [
      ["look", "moving", button("Turn view", "Drag turns the view; drag the tip of d to aim", () => pick(0))],
      ["move", "moving", button("Move", "Handles that move the body", () => pick(1))],
      ["turn", "moving", button("Rotate", "Handles that turn the body", () => pick(2))],
    ];
    const who = button("moving", "Which body Move and Rotate act on", () => {
      this.held = this.held === "moving" ? "fixed" : "moving";
      pick(tools.findIndex(([tool]) => tool === this.tool));
    });
    this.nearButton = button("Distance", "Distance of the bodies at their poses, or depth of their overlap", () => {
      this.change((state) => (state.near = !state.near), false);
      void this.askNear();
    });
    const pick = (k: number) => {
      this.tool = tools[k]![0];
      tools.forEach(([, , element], other) => element.setAttribute("aria-pressed", String(other === k)));
      who.textContent = this.held;
      who.hidden = this.tool === "look";
      void view.setTool(this.tool, this.held);
    };
    named("tools").append(
      h("div", { class: "group" }, ...tools.map(([, , element]) => element), who),
      h("div", { class: "group" },
        button("Fit", "Everything into the picture", () => this.fit()),
        (this.along = button("Along d", "Look along the direction, or the axis", () => this.fit(true)))),
      h("div", { class: "group near" }, this.nearButton),
    );
    pick(0);
    addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.tool !== "look") pick(0);
    });
  }

  private drops() {
    const zone = named("drop");
    const halves = [...zone.querySelectorAll<HTMLElement>("[data-slot]")];
    const over = (target: EventTarget | null) => halves.find((half) => half === target);
    addEventListener("dragenter", (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      zone.hidden = false;
      zone.querySelector("p")!.textContent = this.state.tab === "assembly" ? "Drop all parts of an assembly, or a GLB" : "Drop a mesh on the body it replaces";
    });
    addEventListener("dragover", (event) => {
      event.preventDefault();
      halves.forEach((half) => half.classList.toggle("over", half === over(event.target)));
    });
    addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) zone.hidden = true;
    });
    addEventListener("keydown", (event) => {
      if (event.key === "Escape") zone.hidden = true;
    });
    addEventListener("drop", (event) => {
      event.preventDefault();
      zone.hidden = true;
      const files = [...(event.dataTransfer?.files ?? [])];
      if (this.state.tab === "assembly") {
        void this.assembly?.open(files);
        return;
      }
      const first: Slot = (over(event.target)?.dataset.slot as Slot | undefined) ?? "moving";
      const given = bySlot(files, first);
      if (given.length) void this.open(given);
    });
  }

  private async copy(asked: string | undefined, what: string) {
    // The address is updated a little later.
    this.write();
    const text = asked ?? location.href;
    try {
      await navigator.clipboard.writeText(text);
      toast(`${what} is copied`);
    } catch {
      prompt(`${what}:`, text);
    }
  }

  private async save(how: Picture) {
    if (!this.view) return;
    try {
      const blob = how === "png"
        ? await this.view.picture()
        : new Blob([how === "svg" ? this.shadow.source() : await this.view.drawing()], { type: "image/svg+xml" });
      save(blob, { png: "contact.png", svg: "shadows.svg", drawing: "contact.svg" }[how]);
    } catch (error) {
      toast(error instanceof Error ? error.message : String(error));
    }
  }

  /** State for tests. */
  probe() {
    return { assembly: this.assembly?.probe(), turning: this.turning?.probe(), found: this.found?.probe(), engine: this.engine, view: this.view, state: this.state, answer: this.answer, near: this.near?.told, firstAnswer: this.firstAnswer };
  }
}

let styled: Promise<void> | undefined;

/** Loads the styles of the other tabs with the first of them. */
const tabStyles = () => (styled ??= new Promise((resolve, reject) => {
  const link = h("link", { rel: "stylesheet", href: "tabs.css", onload: () => resolve(), onerror: () => {
    styled = undefined;
    reject(new Error("tabs.css"));
  } });
  document.head.append(link);
}));

function toast(text: string) {
  const shown = h("div", { class: "toast", role: "status" }, text);
  document.body.append(shown);
  setTimeout(() => shown.remove(), 1800);
}

function start() {
  try {
    const page = new Page();
    (window as { colltrans?: object }).colltrans = { probe: () => page.probe() };
    page.start().catch((error: unknown) => fail(error));
  } catch (error) {
    fail(error);
  }
}

function fail(error: unknown) {
  const why = error instanceof Error ? error.message : String(error);
  document.querySelector("main")!.replaceChildren(
    h("p", { class: "lone", role: "alert" }, `The page could not be started: ${why}`),
  );
}

start();
