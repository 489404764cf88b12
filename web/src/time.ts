// The slider along `t`: from the start over the first contact to the last.

import { h, refill } from "./dom";
import type { PageCast } from "./answers";
import { short } from "./math";
import type { State } from "./state";

export class Timeline {
  private readonly slider = h("input", { type: "range", step: "any", "aria-label": "Where the moving body is shown, along t" });
  private readonly marks = h("div", { class: "marks" });
  private readonly value = h("output");
  private readonly play = h("button", { class: "icon", title: "Play", "aria-label": "Play" }, "▶");
  private range: [number, number] = [0, 1];
  private running = 0;

  constructor(host: HTMLElement, private readonly move: (t: number | null) => void) {
    host.append(this.play, h("div", { class: "track" }, this.marks, this.slider), this.value);
    this.slider.addEventListener("input", () => {
      this.stop();
      this.move(this.slider.valueAsNumber);
    });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.start()));
  }

  show(state: State, answer: PageCast | undefined, pass: number) {
    const { translation: first, exit, outcome } = answer?.record ?? {};
    const ends = [0, first ?? pass, exit ?? first ?? pass];
    const [low, high] = [Math.min(...ends), Math.max(...ends)];
    const more = (high - low || 1) * 0.06;
    this.range = [low < 0 ? low - more : low, high + more];
    this.slider.min = String(this.range[0]);
    this.slider.max = String(this.range[1]);
    const t = state.t ?? 0;
    this.slider.value = String(t);
    this.value.textContent = `t = ${short(t, 5)}`;
    // A thumb's width lies outside of the way of its middle.
    const place = (t: number) => {
      const share = (t - this.range[0]) / (this.range[1] - this.range[0]);
      return `calc(8px + (100% - 16px) * ${share.toFixed(5)})`;
    };
    const mark = (t: number, text: string, kind = "") => [
      h("button", { class: kind, style: `left: ${place(t)}`, onclick: () => this.jump(t) }, text),
      h("i", { class: kind, style: `left: ${place(t)}` }),
    ];
    const parts = [...mark(0, "start", "low")];
    if (first !== undefined) parts.push(...mark(first, outcome === "grazing" ? "touches" : "first contact", "stop"));
    if (first !== undefined && exit !== undefined && exit > first) {
      parts.push(...mark(exit, answer?.kind === "solid" ? "out" : "last contact", "low"));
      parts.push(h("b", { style: `left: ${place(first)}; right: calc(100% - ${place(exit)})` }));
    }
    refill(this.marks, ...parts);
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
