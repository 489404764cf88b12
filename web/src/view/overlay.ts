// Words over the picture: its labels, and in a corner the axes of the world as they are seen.

import { type Camera, Vector3 } from "three";
import { h, svg } from "../dom";
import type { Label } from "./shapes";

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
      const at = label.at.clone().project(camera);
      span.hidden = at.z > 1;
      span.className = label.kind;
      span.textContent = label.text;
      span.style.transform = `translate(${((at.x + 1) / 2) * wide}px, ${((1 - at.y) / 2) * high}px) translate(-50%, -50%)`;
    });
    this.placeAxes(camera, note);
  }

  /** Those that point away first. */
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
