// The slider along a path: from the start through the first contact to the last, or to the end of a motion.

import { h, refill } from "./dom";
import type { PageCast } from "./answers";
import { short } from "./math";
import type { State } from "./state";

/** The marks of a path. */
export interface Times {
  range: [number, number];
  at: number;
  text: string;
  marks: { t: number; text: string; kind: "low" | "stop" }[];
  /** The range in which the bodies overlap. */
  span?: [number, number] | undefined;
}

/** Returns the marks of a translation. `pass` is where the bodies have passed each other. */
export function times(state: State, answer: PageCast | undefined, pass: number): Times {
  const { translation: first, exit, outcome } = answer?.record ?? {};
  const ends = [0, first ?? pass, exit ?? first ?? pass];
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const more = (high - low || 1) * 0.06;
  const at = state.t ?? 0;
  const marks: Times["marks"] = [{ t: 0, text: "start", kind: "low" }];
  if (first !== undefined) marks.push({ t: first, text: outcome === "grazing" ? "touches" : "first contact", kind: "stop" });
  const span: Times["span"] = first !== undefined && exit !== undefined && exit > first ? [first, exit] : undefined;
  if (span) marks.push({ t: span[1], text: answer?.kind === "solid" ? "out" : "last contact", kind: "low" });
  return { range: [low < 0 ? low - more : low, high + more], at, text: `t = ${short(at, 5)}`, marks, span };
}

export class Timeline {
  private readonly slider = h("input", { type: "range", step: "any", "aria-label": "Where the moving body is shown, along t" });
  private readonly marks = h("div", { class: "marks" });
  private readonly value = h("output");
  private readonly play = h("button", { class: "icon", title: "Play", "aria-label": "Play" }, "▶");
  private range: [number, number] = [0, 1];
  private running = 0;

  constructor(host: HTMLElement, private readonly move: (t: number) => void) {
    host.append(this.play, h("div", { class: "track" }, this.marks, this.slider), this.value);
    this.slider.addEventListener("input", () => {
      this.stop();
      this.move(this.slider.valueAsNumber);
    });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.start()));
  }

  show({ range, at, text, marks, span }: Times) {
    const [low, high] = (this.range = range);
    this.slider.min = String(low);
    this.slider.max = String(high);
    this.slider.value = String(at);
    this.value.textContent = text;
    // The middle of the thumb stays half its width inside the track.
    const place = (t: number) => `calc(8px + (100% - 16px) * ${((t - low) / (high - low)).toFixed(5)})`;
    refill(this.marks,
      ...marks.flatMap(({ t, text, kind }) => [
        h("button", { class: kind, style: `left: ${place(t)}`, onclick: () => this.jump(t) }, text),
        h("i", { class: kind, style: `left: ${place(t)}` }),
      ]),
      span && h("b", { style: `left: ${place(span[0])}; right: calc(100% - ${place(span[1])})` }));
  }

  private jump(t: number) {
    this.stop();
    this.move(t);
  }

  private start() {
    const [low, high] = this.range;
    let from: number | undefined;
    const began = this.slider.valueAsNumber >= high - (high - low) * 0.02 ? low : this.slider.valueAsNumber;
    this.play.textContent = "❚❚";
    const step = (now: number) => {
      from ??= now;
      const t = began + ((now - from) / 3500) * (high - low);
      this.move(Math.min(t, high));
      if (t < high) this.running = requestAnimationFrame(step);
      else this.stop();
    };
    this.running = requestAnimationFrame(step);
  }

  private stop() {
    cancelAnimationFrame(this.running);
    this.running = 0;
    this.play.textContent = "▶";
  }
}
