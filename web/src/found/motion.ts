// The incremental case as a motion: the moving body goes around a small circle, and each search starts at the last solution.

import { palette } from "../colours";
import { h, refill, svg } from "../dom";
import { type Pose, type Vec, add, lateral, times, unit } from "../math";

/** Number of places on the circle. */
const PLACES = 24;
const [WIDE, HIGH] = [340, 126];

export class Motion {
  readonly element: HTMLElement;
  private readonly button = h("button", { class: "small main" }, "Play a motion");
  private readonly picture = svg("svg", { class: "figure", viewBox: `0 0 ${WIDE} ${HIGH}`, role: "img", "aria-label": "Planar problems at each place" });
  private readonly said = h("p", { class: "proof" });
  private counts: { near: number; all: number }[] = [];
  private stopped: (() => void) | undefined;
  /** Starts the motion: returns the pose of the body, the direction, and the size of the body. */
  begin: () => { pose: Pose; direction: Vec; radius: number } | undefined = () => undefined;
  /** Moves the body; resolves when the search has been shown. */
  move: (pose: Pose) => Promise<void> = async () => {};

  constructor() {
    this.button.addEventListener("click", () => (this.stopped ? this.stopped() : void this.play()));
    this.element = h("section", { class: "card" }, h("h3", {}, "A motion, from one solution to the next"),
      h("p", { class: "proof" }, "The moving body goes around a small circle across d. Each search begins at the last solution p, in its square N(p), which is as wide as the contact points have moved apart."),
      h("div", { class: "row" }, this.button), this.picture, this.said);
    this.picture.style.display = "none";
  }

  /** Adds the counts of a place: planar problems in `N(p)`, and from the centre. */
  count(near: number, all: number) {
    if (this.stopped) this.counts.push({ near, all });
  }

  get isPlaying(): boolean {
    return !!this.stopped;
  }

  private async play() {
    const from = this.begin();
    if (!from) return;
    let goes = true;
    this.stopped = () => (goes = false);
    [this.counts, this.button.textContent] = [[], "Stop"];
    this.picture.style.display = "";
    const [right, up] = lateral(unit(from.direction));
    try {
      for (let k = 1; k <= PLACES && goes; k++) {
        const angle = (2 * Math.PI * k) / PLACES;
        const off = add(times(right, 0.12 * from.radius * (Math.cos(angle) - 1)), times(up, 0.12 * from.radius * Math.sin(angle)));
        const [x, y, z] = add([from.pose[0], from.pose[1], from.pose[2]], off);
        const pose: Pose = k === PLACES ? from.pose : [x, y, z, from.pose[3], from.pose[4], from.pose[5], from.pose[6]];
        const began = performance.now();
        await this.move(pose);
        this.draw();
        await new Promise((resolve) => setTimeout(resolve, Math.max(0, 350 - (performance.now() - began))));
      }
    } finally {
      [this.stopped, this.button.textContent] = [undefined, "Play a motion"];
    }
  }

  /** Draws bars of both counts. */
  draw() {
    const colours = palette();
    const most = Math.max(1, ...this.counts.map(({ near, all }) => Math.max(near, all)));
    const wide = (WIDE - 20) / PLACES;
    const tall = (n: number) => (n / most) * (HIGH - 50);
    const bars = this.counts.flatMap(({ near, all }, k) =>
      ([[all, colours.grid, 0], [near, colours.fixedMark, wide * 0.42]] as const).map(([n, fill, aside]) =>
        svg("rect", { x: 10 + k * wide + aside, y: HIGH - 10 - tall(n), width: wide * 0.42, height: tall(n), fill })));
    refill(this.picture, ...bars,
      svg("text", { x: 10, y: 14, "font-size": 12, fill: colours.text }, `planar problems at each place, at most ${most}`),
      svg("rect", { x: 10, y: 22, width: 9, height: 9, fill: colours.grid }), svg("text", { x: 23, y: 31, "font-size": 12, fill: colours.text }, "centre"),
      svg("rect", { x: 80, y: 22, width: 9, height: 9, fill: colours.fixedMark }), svg("text", { x: 93, y: 31, "font-size": 12, fill: colours.text, "font-style": "italic" }, "N(p)"));
    const sum = (of: "near" | "all") => this.counts.reduce((total, one) => total + one[of], 0);
    this.said.textContent = `${this.counts.length} places: ${sum("near")} planar problems in N(p), ${sum("all")} from the centre.`;
  }
}
