// Bodies that turn: their first contact about a hinge or along a screw, queried from a library of its own; handles in
// the view, and a slider over time.
//
// Data flow: `State` -> the question, if it has changed -> the record of the library, described and drawn. Dragging a
// handle, or editing a field, changes the state.

import type { PageMotion } from "./answers";
import { h, refill } from "./dom";
import { Engine, type Slot } from "./engine";
import { numberField } from "./field";
import { placed, type Vec } from "./math";
import { Placing, type Source } from "./placing";
import type { Screw, State } from "./state";
import type { Times } from "./time";
import { EXAMPLES } from "./turning/examples";
import { Grips } from "./turning/grips";
import { draw, seen, side } from "./turning/picture";
import { RADIANS, hinge } from "./turning/screw";
import { asCommand } from "./turning/share";
import { gone, judged, say, solids } from "./turning/words";
import type { View } from "./view";
import type { Drawn } from "./view/body";

const KINDS = ["Hinge", "Screw", "Slide"] as const;
/** Angle of a hinge that was a slide before. */
const USUAL_ANGLE = 90;

/** The functions of the page that this tab uses. */
export interface Around {
  view: View;
  sources(): Partial<Record<Slot, Source>>;
  change(change: (state: State) => void): void;
  /** Called when the view must be redrawn. */
  shown(): void;
  /** Loads another pair of bodies, with other changes of the state. */
  begin(example: string, change: (state: State) => void): Promise<void>;
  copy(text: string | undefined, what: string): void;
}

export class Turning {
  readonly element = h("div", { class: "turning" });
  private readonly engine = new Engine("colltrans_motion");
  private readonly placing = new Placing(this.engine);
  private readonly grips: Grips;
  private readonly said = h("section", { class: "said", "aria-live": "polite" });
  private readonly facts = h("dl");
  private readonly factsCard = h("section", { class: "card" }, this.facts);
  private readonly proof = h("p", { class: "proof" });
  private readonly verdict = h("span", { role: "status" });
  private readonly examples = h("select", { "aria-label": "A motion to look at" });
  private readonly kinds: HTMLButtonElement[];
  private readonly movers: HTMLButtonElement[];
  private readonly angle: HTMLElement;
  private readonly rise: HTMLElement;
  private readonly fields: { input: HTMLInputElement; read: (screw: Screw, state: State) => number | null }[] = [];
  private state: State | undefined;
  private screw: Screw | undefined;
  private answer: PageMotion | undefined;
  private error: string | undefined;
  private took = 0;
  private verdictSaid: { holds: boolean; text: string } | undefined;
  /** The last question, and the sources that it was about. */
  private asked: [text: string, moving: Source | undefined, fixed: Source | undefined] = ["", undefined, undefined];
  private asking = false;
  private fitted = false;

  constructor(private readonly around: Around) {
    this.grips = new Grips(around.view);
    this.grips.onScrew = (screw) => this.set(() => screw);
    this.kinds = KINDS.map((kind) => h("button", {
      class: "small",
      onclick: () => this.set(({ angle, rise, ...axis }) => ({
        ...axis, angle: kind === "Slide" ? 0 : angle || USUAL_ANGLE, rise: kind === "Hinge" ? 0 : rise || this.usualRise(),
      })),
    }, kind));
    this.movers = (["moving", "fixed"] as Slot[]).map((slot) => h("button", {
      class: "small",
      // Only a motion that the page chose for the other body is replaced.
      onclick: () => this.around.change((state) => {
        state.motion.body = slot;
        state.motion.screw ??= this.screw ?? null;
      }),
    }, slot === "moving" ? "The moving body" : "The fixed one"));
    const vector = (name: string, of: "point" | "axis") => h("div", { class: "fields" }, h("span", {}, name.toLowerCase()),
      ...["x", "y", "z"].map((letter, k) => this.number(`${name} ${letter}`, (screw) => screw[of][k]!, (screw, x) => (screw[of][k] = x))));
    const axis = (text: string, d: Vec) => h("button", { class: "small", onclick: () => this.set((screw) => ({ ...screw, axis: [...d] })) }, text);
    this.angle = h("label", {}, "Angle, in degrees", this.number("Angle", (screw) => screw.angle, (screw, x) => (screw.angle = x)));
    this.rise = h("label", {}, "Rise", this.number("Rise", (screw) => screw.rise, (screw, x) => (screw.rise = x)));
    this.examples.append(h("option", { value: "" }, "The bodies as they are"), ...Object.entries(EXAMPLES).map(([name, { title }]) => h("option", { value: name }, title)));
    this.examples.addEventListener("change", () => void this.choose(this.examples.value));
    this.element.append(
      this.said, this.factsCard,
      h("section", { class: "card" }, h("h3", {}, "Motion"),
        h("label", {}, "Look at ", this.examples),
        h("div", { class: "row", role: "group", "aria-label": "Kind of motion" }, ...this.kinds),
        h("div", { class: "row", role: "group", "aria-label": "Which body moves" }, ...this.movers),
        vector("Point", "point"), vector("Axis", "axis"),
        h("div", { class: "row" }, axis("x", [1, 0, 0]), axis("y", [0, 1, 0]), axis("z", [0, 0, 1]),
          h("button", { class: "small", onclick: () => this.set((screw) => ({ ...screw, angle: -screw.angle || 0, rise: -screw.rise || 0 })) }, "the other way")),
        h("div", { class: "fields", style: "grid-template-columns: 1fr 1fr" },
          this.angle, this.rise),
        h("div", { class: "fields", style: "grid-template-columns: 1fr 1fr; align-items: end" },
          h("label", {}, "Minimum gap", this.number("Minimum gap", (_, { motion }) => motion.minGap, (_, x, { motion }) => (motion.minGap = Math.max(0, x)))),
          h("label", { title: "Depth by which convex bodies may overlap. Both solids are shrunk by half of it; the default follows from the files" }, "Tolerance (may be empty)",
            this.number("Tolerance of motions", (_, { tolerance }) => tolerance, (_, x, state) => (state.tolerance = Math.max(0, x)), (state) => (state.tolerance = null)))),
        h("small", { style: "color: var(--soft)" }, "In the view drag the axis, its tip, the end of the way, or the rise. Positive angles turn counter-clockwise as seen against the axis.")),
      h("section", { class: "card" }, h("h3", {}, "Proof"), this.proof,
        h("div", { class: "row" }, h("button", { class: "small main", onclick: () => void this.prove() }, "Verify"), this.verdict)),
      h("section", { class: "card" }, h("h3", {}, "Share"),
        h("div", { class: "row" },
          h("button", { class: "small", onclick: () => this.around.copy(undefined, "The link") }, "Copy link"),
          h("button", { class: "small", onclick: () => this.state && this.screw && this.around.copy(asCommand(this.state, this.screw), "The command") }, "Copy as command line"))));
  }

  private number(name: string, read: (screw: Screw, state: State) => number | null, write: (screw: Screw, x: number, state: State) => void, empty?: (state: State) => void): HTMLInputElement {
    const input = numberField(name, (x) => {
      if (x === undefined) {
        if (empty) this.around.change(empty);
      } else this.set((screw, state) => {
        const next = structuredClone(screw);
        write(next, x, state);
        return next;
      });
    });
    input.addEventListener("blur", () => this.around.shown());
    this.fields.push({ input, read });
    return input;
  }

  /** Sets another screw. */
  private set(change: (screw: Screw, state: State) => Screw) {
    this.around.change((state) => {
      const screw = state.motion.screw ?? this.screw;
      if (screw) state.motion.screw = this.screw = change(screw, state);
    });
    // So that handles stay under the pointer.
    if (this.state) this.draw();
  }

  private usualRise(): number {
    const radius = this.bodies()?.moving.radius ?? 1;
    return Number(radius.toPrecision(2));
  }

  private bodies(): Record<Slot, Drawn> | undefined {
    const { view } = this.around;
    const [moving, fixed] = [view.bodyOf("moving"), view.bodyOf("fixed")];
    return moving && fixed && { moving, fixed };
  }

  private async choose(name: string) {
    const example = EXAMPLES[name];
    if (!example) return;
    const { moving, fixed, screw } = structuredClone(example);
    this.fitted = true;
    await this.around.begin(example.pair, (state) => {
      state.poses = { moving, fixed };
      state.motion = { screw, body: "moving", minGap: 0, time: 0 };
    });
    this.examples.value = name;
  }

  /** Fits everything into the picture. */
  fit(along = false) {
    const bodies = this.bodies();
    if (!bodies || !this.state || !this.screw) return;
    this.around.view.aimAt(seen(this.state, this.screw, bodies), side(this.screw, along));
    this.around.shown();
  }

  /** Returns the marks of the slider if this tab is visible. */
  show(state: State, visible: boolean): Times | undefined {
    this.element.hidden = !visible;
    this.state = state;
    if (!visible) {
      this.grips.grips = [];
      return undefined;
    }
    const bodies = this.bodies();
    const { screw, body } = state.motion;
    this.screw = screw ?? (bodies && hinge(state.poses, bodies, body));
    if (bodies && !this.fitted) {
      this.fitted = true;
      this.fit();
    }
    // Highlights use the numbers of the bodies that the question was about.
    const { moving, fixed } = this.around.sources();
    if (moving !== this.asked[1] || fixed !== this.asked[2]) this.answer = undefined;
    void this.ask();
    this.tell();
    this.draw();
    return this.times();
  }

  private times(): Times {
    const { time } = this.state!.motion;
    const marks: Times["marks"] = [{ t: 0, text: "start", kind: "low" }];
    const { time: met, outcome } = this.answer?.record ?? {};
    if (met) marks.push({ t: met.lower, text: outcome === "grazing" ? "touches" : outcome === "undecided" ? "proven free" : "first contact", kind: "stop" });
    marks.push({ t: 1, text: "end", kind: "low" });
    const { screw } = this;
    return { range: [0, 1], at: time, text: screw ? gone(screw.angle ? { ...screw, rise: 0 } : screw, time) : "", marks };
  }

  private question(state: State, { point, axis, angle, rise }: Screw) {
    const turn = { point, axis, angle: angle * RADIANS };
    const { poses, tolerance, motion: { body, minGap } } = state;
    const motion = rise ? { screw: { ...turn, rise } } : { turn };
    return { moving_pose: poses.moving, fixed_pose: poses.fixed, [`${body}_motion`]: motion, min_gap: minGap, tolerance };
  }

  /** Sends a question. One is pending at a time; then the current question is sent. */
  private async ask(): Promise<void> {
    const { state, screw } = this;
    const { moving, fixed } = this.around.sources();
    if (this.asking || !state || !screw || !moving || !fixed || !this.bodies()) return;
    const question = structuredClone(this.question(state, screw));
    const text = JSON.stringify(question);
    const [last, ...sources] = this.asked;
    if (text === last && sources[0] === moving && sources[1] === fixed) return;
    this.asked = [text, moving, fixed];
    this.asking = true;
    this.element.setAttribute("aria-busy", "true");
    this.verdictSaid = undefined;
    try {
      await this.placing.place({ moving, fixed });
      const { facts, took } = await this.engine.ask({ ...question, do: "motion" });
      [this.answer, this.took, this.error] = [facts, took, undefined];
    } catch (error) {
      [this.answer, this.error] = [undefined, error instanceof Error ? error.message : String(error)];
    }
    this.asking = false;
    this.element.removeAttribute("aria-busy");
    this.around.shown();
  }

  /** Builds the proof and checks it. */
  private async prove() {
    const { answer, asked: [text] } = this;
    if (!answer || !text) return;
    this.verdictSaid = { holds: true, text: "…" };
    this.around.shown();
    let verdict: { holds: boolean; text: string };
    try {
      const { facts } = await this.engine.ask({ ...(JSON.parse(text) as object), do: "prove" });
      verdict = judged(facts, answer.kind === "convex");
    } catch (error) {
      verdict = { holds: false, text: `✗ ${error instanceof Error ? error.message : String(error)}` };
    }
    // Another question may have been sent meanwhile.
    if (answer !== this.answer) return;
    this.verdictSaid = verdict;
    this.around.shown();
  }

  private tell() {
    const { state, screw, answer, error, took } = this;
    if (!state) return;
    const missing = !this.bodies();
    const said = error || missing
      ? { kind: "care", headline: "No answer", sentence: error ?? "A body is missing.", rows: [] as [string, string][] }
      : answer && screw ? say(answer, screw, state)
      : { kind: "", headline: "…", sentence: "Reading.", rows: [] as [string, string][] };
    this.said.className = `said ${said.kind}`;
    refill(this.said, h("h2", {}, said.headline), h("p", {}, said.sentence), answer && h("p", { class: "took" }, `${took < 0.1 ? "less than 0.1" : Number(took.toPrecision(2))} ms in this browser`));
    this.factsCard.hidden = !said.rows.length;
    refill(this.facts, ...said.rows.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
    this.proof.textContent = solids(state)
      ? "A list of entries that covers all pairs of facets at all times, built on request. Each entry is a division, or a plane that separates two parts for a time."
      : "Planes between the bodies, each at a time with the gap that it leaves: two of them prove the times between them. The last entry is the depth of the overlap at the upper bound.";
    this.verdict.className = this.verdictSaid ? `verdict ${this.verdictSaid.holds ? "yes" : "no"}` : "";
    this.verdict.textContent = this.verdictSaid?.text ?? "";
    if (!screw) return;
    for (const { input, read } of this.fields) {
      if (input === document.activeElement) continue;
      const value = read(screw, state);
      input.value = value === null ? "" : String(value);
    }
    const kind = screw.rise === 0 ? "Hinge" : screw.angle === 0 ? "Slide" : "Screw";
    this.kinds.forEach((button, k) => button.setAttribute("aria-pressed", String(KINDS[k] === kind)));
    this.movers.forEach((button, k) => button.setAttribute("aria-pressed", String((k === 1) === (state.motion.body === "fixed"))));
    this.angle.hidden = kind === "Slide";
    this.rise.hidden = kind === "Hinge";
    const example = EXAMPLES[this.examples.value];
    if (example && JSON.stringify(["moving", example.moving, example.fixed, example.screw]) !== JSON.stringify([state.motion.body, state.poses.moving, state.poses.fixed, state.motion.screw])) this.examples.value = "";
  }

  private draw() {
    const { state, screw, answer } = this;
    const bodies = this.bodies();
    const { view } = this.around;
    view.clearExtra();
    if (!state || !screw || !bodies || !drawable(state, screw)) {
      this.grips.grips = [];
      return view.render();
    }
    this.grips.screw = screw;
    this.grips.grips = draw(view, state, screw, answer, bodies);
    view.render();
  }

  /** State for tests. */
  probe() {
    const { engine, answer, screw, asking, state } = this;
    const question = state && screw && this.question(state, screw);
    return { engine, answer, screw, asking, question, grip: (name: "point" | "axis" | "angle" | "rise") => this.grips.onPage(name) };
  }
}

/** Checks whether the numbers fit single precision. */
function drawable({ poses }: State, { point, axis, angle, rise }: Screw): boolean {
  return [...point, ...axis, angle, rise, ...poses.moving, ...poses.fixed, ...placed(poses.moving, point)].every((x) => Math.abs(x) < 1e20);
}
