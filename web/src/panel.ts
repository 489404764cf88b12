// The texts and the controls next to the view.

import { h, refill, svg } from "./dom";
import type { Certificate, PageCast, PageCertify, PageConvex } from "./answers";
import { MOST_MIB, type Slot, type Start, type Take } from "./engine";
import { numberField } from "./field";
import { names } from "./formats";
import { type Vec, length, short } from "./math";
import type { Nearness } from "./near";
import { described, isRound, isShape, shapeForm } from "./primitive";
import { asCommand } from "./share";
import { IN_FILE, type Solver, type State } from "./state";
import type { Drawn } from "./view/body";
import { say } from "./words";

/** The view as pixels, the shadows, or the view as a drawing. */
export type Picture = "png" | "svg" | "drawing";

/** The reason why a file was rejected, and other ways to use it. */
export interface Refusal {
  name: string;
  message: string;
  instead: Take[];
  /** The file of the previous body, if it can be restored. */
  before: string | undefined;
}

export interface Shown {
  state: State;
  /** Whether both bodies are those of an example. */
  isExample: boolean;
  answer: PageCast | undefined;
  /** The reason why there is no answer. */
  error: string | undefined;
  /** Time in milliseconds. */
  took: number;
  bodies: Partial<Record<Slot, Drawn>>;
  refusals: Partial<Record<Slot, Refusal>>;
  /** The proof of an answer between solids, once it has been built. */
  solidProof: PageCertify | undefined;
  /** The distance of the bodies at their poses, if it is shown. */
  near: Nearness | undefined;
  /** The result of the check of the proof. */
  verdict: { holds: boolean; text: string } | undefined;
}

export interface Actions {
  change(change: (state: State) => void): void;
  choose(slot: Slot): void;
  /** Lets the visitor choose the files of both bodies. */
  chooseBoth(): void;
  take(slot: Slot, take: Take): void;
  /** Uses a body that a name describes. */
  shape(slot: Slot, name: string): void;
  dismiss(slot: Slot): void;
  verify(): void;
  /** Copies a text; `undefined` stands for the address. */
  copy(text: string | undefined, what: string): void;
  save(how: Picture): void;
}

const TAKEN: Record<Take, string> = {
  convex: "as it is", hull: "its convex hull", solid: "as a solid", open: "as an open scan",
};
const OFFER: Record<Take, string> = {
  convex: "As it is", hull: "Take the hull", solid: "As a solid", open: "As an open scan",
};

export class AnswerPanel {
  readonly element = h("div", { class: "panel-parts", style: "display: contents" });
  /** The invitation to drop parts, next to the example with which the page opens. */
  private readonly invitation: HTMLElement;
  private readonly said = h("section", { class: "said", "aria-live": "polite" });
  private readonly facts = h("dl");
  private readonly proof = h("div");
  private readonly verdict = h("span", { role: "status" });
  private readonly proofCard: HTMLDetailsElement;
  private readonly parts = h("div");
  private readonly fields: { input: HTMLInputElement; read: (state: State) => number | null }[] = [];
  private readonly solver = h("select", { "aria-label": "Solver" });
  /** Start and end of the paper's algorithm. */
  private readonly start = h("select", { "aria-label": "Where the algorithm starts" });
  private readonly narrowing: HTMLElement;
  private readonly graze: HTMLElement;
  private readonly solvers = h("label", { style: "grid-column: span 2" }, "Solver", this.solver);
  private readonly solid: HTMLElement;
  private readonly ignore = h("input", { type: "checkbox" });
  private readonly check: HTMLButtonElement;
  private readonly command = h("button", { class: "small" }, "Copy as command line");
  private readonly known = new Map<string, string>();
  private now: Shown | undefined;

  constructor(private readonly act: Actions) {
    this.check = h("button", { class: "small main", onclick: () => act.verify() }, "Verify");
    for (const [value, text] of [["auto", "auto"], ["portal", "portal refinement"], ["cta", "collision translation algorithm"]]) {
      this.solver.append(h("option", { value: value! }, text!));
    }
    this.solver.addEventListener("change", () => act.change((s) => (s.solver = this.solver.value as Solver)));
    this.start.append(h("option", { value: "center" }, "the centre of all levels"), h("option", { value: "ellipsoids" }, "where ellipsoids meet"));
    this.start.addEventListener("change", () => act.change((s) => (s.start = this.start.value as Start)));
    this.narrowing = h(
      "div", { class: "fields", style: "grid-template-columns: 1fr 1fr; align-items: end" },
      h("label", {}, "It starts at", this.start),
      h("label", { title: "A fraction of the extent of both bodies along d. When the bounds differ by at most this, the algorithm ends and portal refinement continues" },
        "Gap at which it ends (empty: its own end)", this.number("Gap at which the algorithm ends", (s) => s.until, (s, x) => (s.until = Math.max(0, x)), (s) => (s.until = null))),
    );
    this.ignore.addEventListener("change", () => act.change((s) => (s.ignore = this.ignore.checked)));
    this.graze = h(
      "div", { class: "fields", style: "grid-template-columns: 1fr 1fr 1fr; align-items: end" },
      h("label", {}, "Graze tolerance", this.number("Graze tolerance", (s) => s.graze, (s, x) => (s.graze = Math.max(0, x)))),
      this.solvers,
    );
    this.solid = h(
      "div", {},
      h("div", { class: "fields", style: "grid-template-columns: 1fr 1fr" },
        h("label", {}, "Tolerance (empty: from the files)", this.number("Tolerance", (s) => s.tolerance, (s, x) => (s.tolerance = Math.max(0, x)), (s) => (s.tolerance = null)))),
      h("label", { style: "display: flex; gap: 8px; align-items: center; margin-top: 8px" }, this.ignore, "Ignore overlaps at the start"),
    );
    this.proofCard = this.card("Proof", true, this.proof, h("div", { class: "row" }, this.check, this.verdict));
    const bodies = this.card("Bodies", true, this.parts, shapeForm((slot, name) => act.shape(slot, name)));
    bodies.classList.add("bodies");
    this.invitation = h("section", { class: "card invitation" },
      h("h2", {}, "Drop your two parts here"),
      h("p", {}, `${names("or")}: the first one moves until it meets the second one. Nothing leaves this browser. Until then, this is an example.`),
      h("button", { class: "small main", onclick: () => act.chooseBoth() }, "Choose two files…"));
    this.element.append(
      this.invitation,
      this.said,
      h("section", { class: "card" }, this.facts),
      this.proofCard,
      bodies,
      this.card("Question", true, this.question()),
      this.card("Share", false, this.share()),
    );
  }

  private card(title: string, open: boolean, ...content: HTMLElement[]): HTMLDetailsElement {
    return h("details", { class: "card", open }, h("summary", {}, title), h("div", {}, ...content));
  }

  private number(
    name: string, read: (state: State) => number | null,
    write: (state: State, x: number) => void, empty?: (state: State) => void,
  ): HTMLInputElement {
    const input = numberField(name, (x) => {
      if (x !== undefined) this.act.change((state) => write(state, x));
      else if (empty) this.act.change(empty);
    });
    input.addEventListener("blur", () => this.now && this.show(this.now));
    this.fields.push({ input, read });
    return input;
  }

  private question(): HTMLElement {
    const axis = (text: string, d: Vec) =>
      h("button", { class: "small", onclick: () => this.act.change((s) => (s.direction = [...d])) }, text);
    const direction = h("div", { class: "fields" }, h("span", {}, "d"),
      ...["x", "y", "z"].map((name, k) => this.number(`Direction ${name}`, (s) => s.direction[k]!, (s, x) => (s.direction[k] = x))));
    const pose = (slot: Slot) => [
      h("div", { class: "fields" }, h("span", {}, slot === "moving" ? "Moving" : "Fixed"),
        ...["x", "y", "z"].map((name, k) => this.number(`${slot} position ${name}`, (s) => s.poses[slot][k]!, (s, x) => (s.poses[slot][k] = x)))),
      h("div", { class: "fields four" }, h("span", { title: "A unit quaternion, x y z w" }, "turn"),
        ...["x", "y", "z", "w"].map((name, k) =>
          this.number(`${slot} quaternion ${name}`, (s) => s.poses[slot][3 + k]!, (s, x) => {
            s.poses[slot][3 + k] = x;
            const q = s.poses[slot];
            const l = Math.hypot(q[3], q[4], q[5], q[6]);
            if (l > 0 && Math.abs(l - 1) > 1e-9) for (let i = 3; i < 7; i++) q[i]! /= l;
            if (l === 0) q[6] = 1;
          }))),
    ];
    return h("div", { style: "display: flex; flex-direction: column; gap: 10px" },
      direction,
      h("div", { class: "row" },
        axis("+x", [1, 0, 0]), axis("−x", [-1, 0, 0]), axis("+y", [0, 1, 0]), axis("−y", [0, -1, 0]), axis("+z", [0, 0, 1]), axis("−z", [0, 0, -1]),
        h("button", { class: "small", onclick: () => this.act.change((s) => (s.direction = s.direction.map((x) => -x || 0) as Vec)) }, "turn round"),
        h("button", { class: "small", title: "Then t is a length", onclick: () => this.act.change((s) => {
          const l = length(s.direction);
          if (l > 0) s.direction = s.direction.map((x) => x / l) as Vec;
        }) }, "length 1")),
      ...pose("moving"), ...pose("fixed"),
      h("div", { class: "row" }, h("button", { class: "small", title: "Both bodies at the coordinates of their files", onclick: () => this.act.change((s) => (s.poses = { moving: [...IN_FILE], fixed: [...IN_FILE] })) }, "as in the files")),
      this.graze, this.narrowing, this.solid,
      h("small", { style: "color: var(--soft)" }, "Lengths are in the unit of the files; t counts in multiples of d. In a field the keys ↑ and ↓ change the number, with Shift by ten times as much."),
    );
  }

  private share(): HTMLElement {
    const copy = (text: (state: State) => string | undefined | Promise<string>, what: string) => async () =>
      this.now && this.act.copy(await text(this.now.state), what);
    this.command.addEventListener("click", copy(asCommand, "The command"));
    return h("div", { style: "display: flex; flex-direction: column; gap: 10px" },
      h("div", { class: "row" },
        h("button", { class: "small", onclick: copy(() => undefined, "The link") }, "Copy link"),
        this.command,
        h("button", { class: "small", onclick: copy(async (state) => (await import("./programs")).asRust(state), "The program") }, "Copy as Rust"),
        h("button", { class: "small", onclick: copy(async (state) => (await import("./programs")).asPython(state), "The program") }, "Copy as Python")),
      h("div", { class: "row" },
        h("button", { class: "small", onclick: () => this.act.save("png") }, "Save the view (PNG)"),
        h("button", { class: "small", onclick: () => this.act.save("svg") }, "Save the shadows (SVG)"),
        h("button", { class: "small", onclick: () => this.act.save("drawing") }, "Save the view (SVG)")),
      h("small", { style: "color: var(--soft)" }, "No data leave this browser. A link contains the question; files other than the examples must be opened again."),
    );
  }

  show(shown: Shown) {
    this.now = shown;
    const { state, answer, error } = shown;
    this.invitation.hidden = !shown.isExample;
    this.showSaid(shown);
    for (const { input, read } of this.fields) {
      if (input === document.activeElement) continue;
      const value = read(state);
      input.value = value === null ? "" : String(value);
    }
    this.solver.value = state.solver;
    this.ignore.checked = state.ignore;
    const solids = Object.values(shown.bodies).some((body) => body?.body.facts.kind === "solid");
    this.graze.hidden = solids;
    this.start.value = state.start;
    // Contacts of rounded bodies have one solver.
    const round = hasRound(state);
    this.solvers.hidden = round;
    this.narrowing.hidden = solids || round || state.solver !== "cta";
    this.solid.hidden = !solids;
    this.command.disabled = asCommand(state) === undefined;
    this.command.title = this.command.disabled ? "The command cannot combine a hull with a part that is not convex" : "";
    this.showParts(shown);
    this.facts.parentElement!.hidden = !answer || !!error;
    this.proofCard.hidden = !answer || !!error;
    if (answer && !error) {
      const rows = [...(shown.near?.rows ?? []), ...say(answer, state).rows];
      this.facts.replaceChildren(...rows.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
      this.showProof(answer, shown);
    }
  }

  /** Checks whether a value has changed. Unchanged elements are kept, so that a click on them is not lost. */
  private fresh(what: string, value: unknown): boolean {
    const text = JSON.stringify(value);
    const changed = this.known.get(what) !== text;
    this.known.set(what, text);
    return changed;
  }

  private showSaid({ state, answer, error, took, bodies, refusals, near }: Shown) {
    const missing = (["moving", "fixed"] as const).flatMap((slot) => (bodies[slot] ? [] : refusals[slot]?.message ?? []));
    if (error) {
      this.said.className = "said care";
      this.said.replaceChildren(h("h2", {}, "No answer"), h("p", {}, error));
    } else if (missing.length) {
      this.said.className = "said care";
      this.said.replaceChildren(h("h2", {}, "No answer"), ...missing.map((message) => h("p", {}, message)));
    } else if (!answer) {
      this.said.className = "said";
      this.said.replaceChildren(h("h2", {}, "…"), h("p", {}, "Reading."));
    } else {
      const { kind, headline, sentence } = say(answer, state);
      const { translation, outcome } = answer.record;
      const steps = answer.kind === "convex" && answer.record.steps;
      const work = steps
        ? `${counts([[steps.planar_problems, "planar problem"], [steps.supports, "supporting plane"], [steps.pivots, "portal"]])}; `
        : "";
      this.said.className = `said ${kind}`;
      this.said.replaceChildren(
        h("h2", { id: "headline" }, headline), h("p", {}, sentence), ...(near ? [h("p", { id: "near" }, near.sentence)] : []),
        h("p", { class: "took" }, `${work}${took < 0.1 ? "less than 0.1" : short(took, 2)} ms in this browser`),
      );
      this.said.dataset.t = String(translation ?? "");
      this.said.dataset.outcome = outcome;
    }
  }

  private showParts({ state, bodies, refusals }: Shown) {
    const mover = state.tab === "motion" ? state.motion.body : "moving";
    if (!this.fresh("parts", [mover, state.parts, bodies.moving?.body.facts, bodies.fixed?.body.facts, refusals])) return;
    const rows = (["moving", "fixed"] as const).map((slot) => {
      const facts = bodies[slot]?.body.facts;
      const refusal = refusals[slot];
      const { file, take } = state.parts[slot];
      const named = facts ? file : refusal?.name ?? file;
      const count = facts && isShape(file) ? described(file, facts.radius) : facts &&
        `${facts.vertices.toLocaleString("en")} vertices, ${(facts.kind === "solid" ? facts.triangles : facts.faces).toLocaleString("en")} ${facts.kind === "solid" ? "triangles" : "faces"}, taken ${TAKEN[take]}`;
      return h("div", { class: "body" },
        h("span", { class: `swatch ${slot}` }),
        h("strong", { title: named }, named.split("/").at(-1)!),
        h("button", { class: "small", onclick: () => this.act.choose(slot), "aria-label": `Choose a file for the ${slot} body` }, "Choose…"),
        h("small", {}, `${slot === mover ? "moves" : "stays"}${count ? `; ${count}` : ""}`),
        ...(facts?.notes ?? []).map((note) => h("small", {}, note)),
        refusal && h("div", { class: "refused", role: "alert" }, refusal.message,
          h("div", { class: "row" },
            ...refusal.instead.map((how) => h("button", { class: "small main", onclick: () => this.act.take(slot, how) }, OFFER[how])),
            refusal.before && h("button", { class: "small", title: `Back to ${refusal.before}`, onclick: () => this.act.dismiss(slot) }, "Leave it"))),
      );
    });
    refill(this.parts, ...rows, h("small", { style: "color: var(--soft)" }, `${names("or")}, up to ${MOST_MIB} MiB; or drop files on the view.`));
  }

  private showProof(answer: PageCast, shown: Shown) {
    const { verdict } = shown;
    if (!this.fresh("proof", [answer, verdict, shown.solidProof?.claims])) return;
    this.verdict.className = verdict ? `verdict ${verdict.holds ? "yes" : "no"}` : "";
    this.verdict.textContent = verdict?.text ?? "";
    if (answer.kind === "convex") return refill(this.proof, ...convexProof(answer.proof, hasRound(shown.state)));
    void import("./proofs").then(({ solidProof }) => {
      if (this.now?.answer === answer) refill(this.proof, ...solidProof(answer, this.now, bounds));
    });
  }
}

/** Checks whether a body is rounded. */
const hasRound = ({ parts }: State) => isRound(parts.moving.file) || isRound(parts.fixed.file);

/** Describes the proof between convex bodies, of which one may be rounded. */
function convexProof(of: PageConvex["proof"], round: boolean): Element[] {
  const text = (...children: (string | HTMLElement | null)[]) => h("p", { class: "proof" }, ...children);
  if ("separation" in of) return [text("A plane parallel to d separates the bodies: the moving body is on one side, the fixed body on the other.")];
  const proof = of.contact;
  const upper = proof.upper === null ? undefined : String(proof.upper);
  return [
    bounds(proof),
    text("The green plane proves that there is no contact before ", h("b", {}, String(proof.lower)),
      upper ? `; ${round ? "points of the two triangles, between vertices of the cores, are at most both radii apart" : "the two triangles share a point"}, which proves that there is a contact by ` : ".",
      upper ? h("b", {}, upper) : null,
      upper ? `. The gap of ${short(proof.upper! - proof.lower, 2)} is rounding.` : ""),
  ];
}

/** Draws both bounds on a line that shows only their gap, and the part that rounding alone can cause. */
function bounds(proof: Pick<Certificate, "lower" | "upper" | "rounding">): SVGSVGElement {
  const upper = proof.upper ?? proof.lower + proof.rounding;
  const width = Math.max(upper - proof.lower, proof.rounding, Number.MIN_VALUE);
  const x = (t: number) => 8 + (300 * (t - proof.lower)) / width;
  const picture = svg("svg", { class: "bounds", viewBox: "0 0 320 44", role: "img", "aria-label": "Lower and upper bound" });
  picture.append(
    svg("line", { x1: 8, x2: 308, y1: 22, y2: 22, stroke: "var(--line)", "stroke-width": 6, "stroke-linecap": "round" }),
    svg("line", { x1: x(proof.lower), x2: x(upper), y1: 22, y2: 22, stroke: "var(--free)", "stroke-width": 6, "stroke-linecap": "round" }),
    svg("text", { x: 8, y: 11 }, "lower"),
    svg("text", { x: Math.max(80, x(upper)), y: 11, "text-anchor": "end" }, proof.upper === null ? "" : "upper"),
    svg("text", { x: 308, y: 40, "text-anchor": "end" }, `rounding alone: ${short(proof.rounding, 2)}`),
  );
  return picture;
}

/** Lists the counts that are not zero. */
const counts = (all: [number, string][]) =>
  all.filter(([n]) => n > 0).map(([n, what]) => `${n} ${what}${n === 1 ? "" : "s"}`).join(", ");
