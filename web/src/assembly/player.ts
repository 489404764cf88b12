// The slider over the steps of a plan, with a description of each step, or over another motion.

import { h } from "../dom";

export class Player {
  readonly element: HTMLElement;
  private readonly slider = h("input", { type: "range", min: 0, max: 1, step: "any", value: 0 });
  private readonly play = h("button", { "aria-label": "Play", title: "Play" }, "▶");
  private readonly said = h("output");
  private readonly controls: (HTMLButtonElement | HTMLInputElement)[];
  private steps: string[] = [];
  private idle = "";
  private isPlan = true;
  private running = 0;

  /** `move` shows a position: the number of finished steps, with a fraction for the current one. */
  constructor(private readonly move: (t: number) => void) {
    const jump = (by: 1 | -1) => () => {
      const t = this.t;
      this.go(Math.min(this.steps.length, Math.max(0, by > 0 ? Math.floor(t) + 1 : Math.ceil(t) - 1)));
    };
    this.controls = [this.play, h("button", { "aria-label": "Step back", onclick: jump(-1) }, "‹"), h("button", { "aria-label": "Step on", onclick: jump(1) }, "›"), this.slider];
    this.element = h("div", { class: "bar" }, ...this.controls, this.said);
    this.slider.addEventListener("input", () => {
      this.stop();
      this.place();
    });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.start()));
  }

  /** Shows another plan: the descriptions of its steps, and the text before the first one. `motion` names another motion. */
  show(steps: string[], idle: string, motion?: string) {
    this.stop();
    [this.steps, this.idle, this.isPlan] = [steps, idle, motion === undefined];
    this.slider.setAttribute("aria-label", motion ?? "Steps of the plan");
    this.slider.max = String(Math.max(steps.length, 1e-9));
    this.slider.value = "0";
    for (const control of this.controls) control.disabled = !steps.length;
    this.place();
  }

  get t(): number {
    return this.steps.length ? this.slider.valueAsNumber : 0;
  }

  /** Jumps to a position. */
  set(t: number) {
    this.stop();
    this.slider.value = String(t);
    this.place();
  }

  private place() {
    const step = this.steps[Math.min(this.steps.length, Math.ceil(this.t)) - 1];
    const count = this.isPlan ? `Step ${Math.ceil(this.t)} of ${this.steps.length}: ` : "";
    this.said.textContent = step ? count + step : this.idle;
    this.move(this.t);
  }

  /** Animates to a step. */
  go(t: number, ms = Math.min(1800, this.lasts(t))) {
    this.stop();
    const from = this.t;
    const began = performance.now();
    const move = (now: number) => {
      const share = Math.min(1, Math.max(0, now - began) / ms);
      this.slider.value = String(from + (t - from) * share);
      this.place();
      this.running = share < 1 ? requestAnimationFrame(move) : 0;
      if (!this.running) this.play.textContent = "▶";
    };
    this.running = requestAnimationFrame(move);
  }

  /** Returns the duration of an animation to a step in milliseconds, with time for every step in between. */
  private lasts(t: number): number {
    return 900 * Math.max(Math.abs(t - this.t), 0.3);
  }

  private start() {
    const end = this.steps.length;
    if (this.t >= end) this.slider.value = "0";
    this.go(end, this.lasts(end));
    this.play.textContent = "❚❚";
  }

  private stop() {
    cancelAnimationFrame(this.running);
    this.running = 0;
    this.play.textContent = "▶";
  }
}
