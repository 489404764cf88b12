// A cut through a pair of parts in three dimensions: a plane that hides what is in front of it, with the material of both
// parts in the plane.
//
// The stencil buffer counts, for each pixel, the back facets minus the front facets of a part behind the plane. This is
// the winding number of the part in the plane, as in `report/cut.rs`. Six bits count, one part after the other; two bits
// note which parts cover the pixel. Open surfaces have no material.

import {
  AlwaysStencilFunc, BackSide, type BufferGeometry, DecrementWrapStencilOp, DoubleSide, EqualStencilFunc, FrontSide, Group, IncrementWrapStencilOp, Mesh,
  MeshBasicMaterial, NotEqualStencilFunc, Plane, PlaneGeometry, ReplaceStencilOp, type Side, type StencilFunc, type StencilOp, Vector3,
} from "three";
import { h } from "../dom";
import type { Vec } from "../math";
import type { Parts } from "./parts";

/** Bits of the stencil buffer: the count, and the first and the second part. */
const COUNT = 0x3f;
const COVERED = [0x40, 0x80] as const;

/** Distance of the cut from the plane of the section, towards the viewer, as a fraction of the radius. */
const SHIFT = 1e-4;

/** A pair of parts, and the plane of its section. */
interface Pair {
  parts: [number, number];
  /** A point of the plane, its normal, and half the extent of the neighbourhood to show. */
  at: Vec;
  normal: Vec;
  radius: number;
}

/** Checks whether each edge is passed as often in one direction as in the other. */
export function isClosed(triangles: Uint32Array): boolean {
  const open = new Map<number, number>();
  const count = 1 + triangles.reduce((most, v) => Math.max(most, v), 0);
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; k++) {
      const [from, to] = [triangles[t + k]!, triangles[t + (k + 1) % 3]!];
      const key = Math.min(from, to) * count + Math.max(from, to);
      const sum = (open.get(key) ?? 0) + Math.sign(to - from);
      if (sum) open.set(key, sum);
      else open.delete(key);
    }
  }
  return !open.size;
}

export class Section {
  /** A box that switches the cut on, and a slider that moves it along its normal. */
  readonly element: HTMLElement;
  private readonly box = h("input", { type: "checkbox" });
  private readonly slider = h("input", { type: "range", min: -1, max: 1, step: "any", value: 0, "aria-label": "Place of the cut" });
  private readonly plane = new Plane();
  private readonly caps = new Group();
  private readonly sheet = new PlaneGeometry(1, 1);
  /** The sheets in the plane, and the meshes that count facets. */
  private drawn: Mesh<BufferGeometry, MeshBasicMaterial>[] = [];
  private pair: Pair | undefined;

  /** `colours` are those of the first, the second and the common part. `changed` is called when the cut is switched on or off. */
  constructor(private readonly seen: Parts, private readonly colours: readonly [string, string, string], changed: () => void) {
    this.element = h("div", { class: "cut", hidden: true }, h("label", {}, this.box, "Cut"), this.slider);
    seen.renderer.localClippingEnabled = true;
    seen.scene.add(this.caps);
    this.box.addEventListener("change", () => {
      this.place();
      changed();
    });
    this.slider.addEventListener("input", () => this.place());
    // The side of the viewer is hidden.
    seen.orbit.addEventListener("change", () => this.isOn && this.place());
  }

  get isOn(): boolean {
    return this.box.checked && !!this.pair;
  }

  /** Sets the pair, or none. */
  show(pair: Pair | undefined) {
    for (const mesh of this.drawn) {
      mesh.removeFromParent();
      mesh.material.dispose();
    }
    this.drawn = [];
    this.pair = pair;
    this.element.hidden = !pair;
    this.slider.value = "0";
    this.place();
  }

  /** Places the plane, and hides the side of the viewer. */
  private place() {
    const { pair, seen, plane, caps, isOn } = this;
    this.slider.hidden = !isOn;
    for (const mesh of this.drawn) mesh.visible = isOn;
    seen.clip(isOn ? [plane] : []);
    if (isOn && pair) {
      if (!this.drawn.length) this.draw(pair);
      const kept = new Vector3(...pair.normal).normalize();
      const at = new Vector3(...pair.at).addScaledVector(kept, pair.radius * this.slider.valueAsNumber);
      if (kept.dot(seen.camera.position.clone().sub(at)) > 0) kept.negate();
      // Facets in the plane are kept, so that rounding does not cut them into pixels.
      at.addScaledVector(kept, -SHIFT * pair.radius);
      plane.setFromNormalAndCoplanarPoint(kept, at);
      caps.position.copy(at);
      caps.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), kept);
      caps.scale.setScalar(4 * seen.reach);
    }
    seen.render();
  }

  private draw({ parts }: Pair) {
    parts.forEach((part, k) => {
      const shape = this.seen.shape(part);
      if (!shape || !isClosed(shape.triangles)) return;
      const count = (side: Side, op: StencilOp) => {
        const material = new MeshBasicMaterial({
          side, colorWrite: false, depthWrite: false, depthTest: false, clippingPlanes: [this.plane], stencilWrite: true,
          stencilFunc: AlwaysStencilFunc, stencilWriteMask: COUNT, stencilZPass: op,
        });
        this.add(shape.group, new Mesh(shape.geometry, material), 1 + 2 * k);
      };
      count(BackSide, IncrementWrapStencilOp);
      count(FrontSide, DecrementWrapStencilOp);
      // Where the part covers the pixel, its bit replaces the count.
      this.cap(this.colours[k]!, 2 + 2 * k, NotEqualStencilFunc, COVERED[k]!, COUNT, COVERED[k]! | COUNT);
    });
    const both = COVERED[0] | COVERED[1];
    this.cap(this.colours[2], 5, EqualStencilFunc, both, both, 0);
  }

  /** Draws a sheet in the plane where the stencil buffer fits. */
  private cap(color: string, order: number, stencilFunc: StencilFunc, stencilRef: number, stencilFuncMask: number, stencilWriteMask: number) {
    const material = new MeshBasicMaterial({
      color, side: DoubleSide, stencilWrite: true, stencilFunc, stencilRef, stencilFuncMask, stencilWriteMask, stencilZPass: ReplaceStencilOp,
      // A hidden sheet covers the pixel too, so that the counts of the parts do not mix.
      stencilZFail: ReplaceStencilOp,
    });
    this.add(this.caps, new Mesh(this.sheet, material), order);
  }

  private add(group: Group, mesh: Mesh<BufferGeometry, MeshBasicMaterial>, order: number) {
    mesh.renderOrder = order;
    group.add(mesh);
    this.drawn.push(mesh);
  }
}
