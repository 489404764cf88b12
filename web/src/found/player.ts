// The slider over the moments of a search, and its playback.

import { h } from "../dom";

/** Duration of a moment in milliseconds. */
const PACE = 1100;

export class Player {
  readonly element: HTMLElement;
  private readonly slider = h("input", { type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": "Where in the search" });
  private readonly button = h("button", { class: "small main play" }, "Play");
  private readonly told = h("p", { class: "now", "aria-live": "polite" });
  private playing = 0;
  /** Position, from 0 to the number of moments. */
  at = 0;
  private count = 0;
  onChange: () => void = () => {};

  constructor() {
    const step = (text: string, label: string, way: number) =>
      h("button", { class: "small", "aria-label": label, onclick: () => this.go(way > 0 ? Math.min(Math.floor(this.at + 1e-9) + 1, this.count) : Math.max(Math.ceil(this.at - 1e-9) - 1, 0)) }, text);
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    this.slider.addEventListener("input", () => this.go(this.slider.valueAsNumber));
    this.element = h("section", { class: "card player" },
      h("div", { class: "row" }, step("‹", "One back", -1), this.button, step("›", "One on", +1), this.slider), this.told);
  }

  /** Starts another search with `count` moments. */
  reset(count: number, at: number) {
    this.stop();
    this.count = count;
    this.slider.max = String(count);
    this.set(at);
  }

  /** Returns the current moment and its progress. */
  get now(): [number, number] {
    const moment = Math.max(0, Math.min(this.count, Math.ceil(this.at)) - 1);
    return [moment, Math.min(1, this.at - moment)];
  }

  say(text: string) {
    if (this.told.textContent !== text) this.told.textContent = text;
  }

  go(at: number) {
    this.stop();
    this.set(at);
    this.onChange();
  }

  play() {
    if (this.at >= this.count) this.set(0);
    this.button.textContent = "Pause";
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    let last = performance.now();
    const frame = (now: number) => {
      // Without an animation the moments are shown one after the other.
      const over = (now - last) / PACE;
      if (!still || over >= 1) {
        this.set(Math.min(still ? Math.floor(this.at + 1e-9) + 1 : this.at + over, this.count));
        last = now;
        this.onChange();
      }
      if (this.at >= this.count) this.stop();
      else this.playing = requestAnimationFrame(frame);
    };
    this.playing = requestAnimationFrame(frame);
  }

  stop() {
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.button.textContent = "Play";
  }

  private set(at: number) {
    this.at = at;
    this.slider.value = String(at);
    this.slider.setAttribute("aria-valuetext", `moment ${Math.ceil(at)} of ${this.count}`);
  }
}
