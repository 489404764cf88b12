// Labels over the picture, and in a corner the axes of the world.

import { type Camera, Vector3 } from "three";
import { h, svg } from "../dom";
import type { Label } from "./shapes";

/** Distance of a label from its object, in pixels. */
const AWAY = 18;

/** Returns the centre of a label on the page; undefined if it is behind the eye. */
export function placeOf({ start, end }: Label, camera: Camera, wide: number, high: number): [number, number] | undefined {
  const at = end.clone().project(camera);
  if (at.z > 1) return undefined;
  const from = start.clone().project(camera);
  const [x, y] = [((at.x + 1) / 2) * wide, ((1 - at.y) / 2) * high];
  const [u, v] = [((at.x - from.x) / 2) * wide, ((from.y - at.y) / 2) * high];
  // An arrow that points to the eye has its label above.
  const l = Math.hypot(u, v);
  return l > 4 ? [x + (AWAY * u) / l, y + (AWAY * v) / l] : [x, y - AWAY];
}

export class Overlay {
  private readonly labels = h("div", { class: "labels", "aria-hidden": "true" });
  private readonly axes = svg("svg", { class: "axes", viewBox: "-40 -40 80 96", "aria-hidden": "true" });

  constructor(private readonly host: HTMLElement) {
    host.append(this.axes, this.labels);
  }

  place(camera: Camera, labels: Label[], note: string) {
    const { clientWidth: wide, clientHeight: high } = this.host;
    while (this.labels.children.length < labels.length) this.labels.append(h("span"));
    [...this.labels.children].forEach((element, k) => {
      const span = element as HTMLElement;
      const label = labels[k];
      span.hidden = !label;
      if (!label) return;
      const at = placeOf(label, camera, wide, high);
      span.hidden = !at;
      span.className = label.kind;
      span.textContent = label.text;
      if (at) span.style.transform = `translate(${at[0]}px, ${at[1]}px) translate(-50%, -50%)`;
    });
    this.placeAxes(camera, note);
  }

  /** Axes that point away come first. */
  private placeAxes(camera: Camera, note: string) {
    const turn = camera.quaternion.clone().invert();
    const axes = [["x", 1, 0, 0], ["y", 0, 1, 0], ["z", 0, 0, 1]] as const;
    const seen = axes.map(([name, x, y, z]) => ({ name, at: new Vector3(x, y, z).applyQuaternion(turn) }));
    seen.sort((a, b) => a.at.z - b.at.z);
    this.axes.replaceChildren(
      ...seen.flatMap(({ name, at }) => [
        svg("line", { x1: 0, y1: 0, x2: 24 * at.x, y2: -24 * at.y }),
        svg("text", { x: 33 * at.x, y: -33 * at.y + 4 }, name),
      ]),
      svg("text", { x: 0, y: 52 }, note),
    );
  }
}
