// The removal map of a group: its free travel in every direction, on a sphere that turns with the view and can be
// clicked. Free regions are drawn with exact borders if these are known.

import { type Camera, Vector3 } from "three";
import type { PageMap } from "../answers";
import { palette } from "../colours";
import { h } from "../dom";
import { type Vec, dot, unit } from "../math";

export interface RemovalMap extends Omit<PageMap, "directions" | "triangles"> {
  /** Three numbers for each direction. */
  directions: Float32Array;
  /** The free travel; infinite if nothing blocks. */
  distances: Float32Array;
  /** Corners are indices of directions. */
  triangles: Uint32Array;
}

const SIZE = 300;
const RADIUS = SIZE / 2 - 8;
/** Number of segments in which a side is drawn. */
const SIDE = 6;

const green = (dark: boolean) => (dark ? "#35d6a6" : "#12a37c");

export class Sphere {
  readonly canvas = h("canvas", {
    width: 2 * SIZE, height: 2 * SIZE, class: "sphere", tabindex: 0, role: "img",
    "aria-label": "Removal map: click for a direction, arrow keys turn the one that is chosen",
  });
  private map: RemovalMap | undefined;
  /** The largest finite travel. */
  private farthest = 1;
  private chosen: Vec = [0, 0, 1];
  private right: Vec = [1, 0, 0];
  private up: Vec = [0, 0, 1];
  private towards: Vec = [0, -1, 0];
  onDirection: (direction: Vec) => void = () => {};

  constructor(private readonly camera: Camera) {
    this.canvas.addEventListener("click", (event) => {
      const box = this.canvas.getBoundingClientRect();
      const x = (((event.clientX - box.left) / box.width) * SIZE - SIZE / 2) / RADIUS;
      const y = (SIZE / 2 - ((event.clientY - box.top) / box.height) * SIZE) / RADIUS;
      const flat = x * x + y * y;
      if (flat < 1) this.onDirection(this.near(this.sum(x, y, Math.sqrt(1 - flat))));
    });
    this.canvas.addEventListener("keydown", (event) => {
      const by: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      const turn = by[event.key];
      if (!turn) return;
      event.preventDefault();
      const step = event.shiftKey ? 0.02 : 0.1;
      const [x, y] = turn;
      // Set at once, because the next key may come before the next frame.
      this.chosen = unit([0, 1, 2].map((k) => this.chosen[k]! + step * (x * this.right[k]! + y * this.up[k]!)) as Vec);
      this.onDirection(this.chosen);
    });
  }

  private sum(x: number, y: number, z: number): Vec {
    return [0, 1, 2].map((k) => x * this.right[k]! + y * this.up[k]! + z * this.towards[k]!) as Vec;
  }

  /** Snaps to an isolated direction that a click nearly hits. */
  private near(d: Vec): Vec {
    const close = this.map?.isolated.filter((v) => dot(v, d) > 0.996);
    return close?.sort((a, b) => dot(b, d) - dot(a, d))[0] ?? d;
  }

  show(map: RemovalMap | undefined, chosen: Vec) {
    if (map && map !== this.map) this.farthest = map.distances.reduce((best, x) => (Number.isFinite(x) ? Math.max(best, x) : best), 0) || map.size;
    [this.map, this.chosen] = [map, unit(chosen)];
    this.draw();
  }

  /** Draws the sphere for the current camera. */
  draw() {
    const { map } = this;
    const axis = (x: number, y: number, z: number): Vec => new Vector3(x, y, z).applyQuaternion(this.camera.quaternion).toArray() as Vec;
    [this.right, this.up, this.towards] = [axis(1, 0, 0), axis(0, 1, 0), axis(0, 0, 1)];
    const context = this.canvas.getContext("2d")!;
    context.setTransform(2, 0, 0, 2, 0, 0);
    context.clearRect(0, 0, SIZE, SIZE);
    if (!map) return;
    const colours = palette();
    const { directions, distances, triangles } = map;
    const [r, u, f] = [this.right, this.up, this.towards];
    const count = distances.length;
    const flat = new Float32Array(3 * count);
    for (let k = 0; k < count; k++) {
      const [x, y, z] = [directions[3 * k]!, directions[3 * k + 1]!, directions[3 * k + 2]!];
      flat[3 * k] = SIZE / 2 + RADIUS * (x * r[0] + y * r[1] + z * r[2]);
      flat[3 * k + 1] = SIZE / 2 - RADIUS * (x * u[0] + y * u[1] + z * u[2]);
      flat[3 * k + 2] = x * f[0] + y * f[1] + z * f[2];
    }
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!];
      if (flat[3 * a + 2]! + flat[3 * b + 2]! + flat[3 * c + 2]! < -0.1) continue;
      context.fillStyle = context.strokeStyle = this.tint([a, b, c].map((k) => distances[k]!), colours.dark, !!map.exactly);
      context.lineWidth = 0.6;
      context.beginPath();
      context.moveTo(flat[3 * a]!, flat[3 * a + 1]!);
      context.lineTo(flat[3 * b]!, flat[3 * b + 1]!);
      context.lineTo(flat[3 * c]!, flat[3 * c + 1]!);
      context.closePath();
      context.fill();
      context.stroke();
    }
    context.fillStyle = context.strokeStyle = green(colours.dark);
    for (const { pieces } of map.exactly?.regions ?? []) for (const corners of pieces) this.fill(context, corners);
    for (const { along } of map.exactly?.arcs ?? []) this.line(context, along);
    context.strokeStyle = colours.text;
    context.lineWidth = 1;
    context.beginPath();
    context.arc(SIZE / 2, SIZE / 2, RADIUS, 0, 2 * Math.PI);
    context.stroke();
    for (const d of map.isolated) this.dot(context, d, 5, colours.plane, colours.text);
    this.dot(context, this.chosen, 7, "rgba(0,0,0,0)", colours.normal, 3);
    // Legible on light and dark ground, and next to a dot.
    [context.fillStyle, context.strokeStyle, context.lineWidth] = ["#fff", "rgba(0,0,0,0.65)", 3];
    context.lineJoin = "round";
    context.font = "12px sans-serif";
    for (const [name, d] of [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]] as [string, Vec][]) {
      const at = this.place(d);
      if (at[2] <= 0.05) continue;
      context.strokeText(name, at[0] + 9, at[1] + 12);
      context.fillText(name, at[0] + 9, at[1] + 12);
    }
  }

  /** Draws the visible part of an arc, given by directions along it. */
  private line(context: CanvasRenderingContext2D, along: Vec[]) {
    context.lineWidth = 3;
    context.beginPath();
    let last = false;
    for (const [k, a] of along.entries()) {
      const b = along[k + 1] ?? a;
      for (let j = 0; j < 4 * SIDE; j++) {
        const [x, y, z] = this.place(unit(a.map((x, i) => x + ((b[i]! - x) * j) / (4 * SIDE)) as Vec));
        if (z >= 0) context[last ? "lineTo" : "moveTo"](x, y);
        last = z >= 0;
      }
    }
    context.stroke();
  }

  /** Draws the visible part of a convex piece, whose sides are parts of great circles. */
  private fill(context: CanvasRenderingContext2D, corners: Vec[]) {
    const outline = corners.flatMap((a, k) => {
      const b = corners[(k + 1) % corners.length]!;
      return Array.from({ length: SIDE }, (_, j) => this.place(unit(a.map((x, i) => x + ((b[i]! - x) * j) / SIDE) as Vec)));
    });
    if (outline.every(([, , z]) => z < 0)) return;
    context.beginPath();
    for (const [x, y, z] of outline) {
      // Points behind the sphere are moved to its outline.
      const s = z < 0 ? RADIUS / (Math.hypot(x - SIZE / 2, y - SIZE / 2) || 1) : 1;
      context.lineTo(SIZE / 2 + s * (x - SIZE / 2), SIZE / 2 + s * (y - SIZE / 2));
    }
    context.closePath();
    context.fill();
    context.stroke();
  }

  private place(d: Vec): Vec {
    return [SIZE / 2 + RADIUS * dot(d, this.right), SIZE / 2 - RADIUS * dot(d, this.up), dot(d, this.towards)];
  }

  /** Draws a dot; pale if it is behind the sphere. */
  private dot(context: CanvasRenderingContext2D, d: Vec, radius: number, fill: string, line: string, width = 1.2) {
    const [x, y, z] = this.place(d);
    context.globalAlpha = z < 0 ? 0.35 : 1;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    [context.fillStyle, context.strokeStyle, context.lineWidth] = [fill, line, width];
    context.fill();
    context.stroke();
    context.globalAlpha = 1;
  }

  /** Returns a colour: green if all corners are free and no exact borders are known, otherwise lighter for larger travel. */
  private tint(far: number[], dark: boolean, exact: boolean): string {
    const free = far.filter((x) => x === Infinity).length;
    if (free === far.length && !exact) return green(dark);
    const blocked = far.filter(Number.isFinite);
    const mean = blocked.length ? blocked.reduce((sum, x) => sum + x, 0) / blocked.length : this.farthest;
    const s = Math.sqrt(Math.min(1, mean / this.farthest));
    return `hsl(28 ${dark ? 30 : 45}% ${dark ? 18 + 40 * s : 34 + 48 * s}%)`;
  }
}
