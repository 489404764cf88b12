// The parts of an assembly in three dimensions, relative to its middle.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, Object3D, PerspectiveCamera, type Plane, Quaternion, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { casterAt } from "../aim";
import { h, soon } from "../dom";
import type { Vec } from "../math";

export interface Part {
  name: string;
  colour: Vec;
  /** Relative to the middle of the assembly. */
  vertices: Float32Array;
  triangles: Uint32Array;
}

/** Consecutive moves, each of parts that move together. `way` is their displacement in the picture. */
export type Move = { parts: number[]; way: Vec; turn?: Turn }[];

/** A rotation about an axis during a move: the part is shifted by `own`, so that its axis is on `point`. Angles are in turns. */
export type Turn = { own: Vec; point: Vec; axis: Vec; phase: number; turns: number };

/** Returns a colour for each part, spread by the golden angle. In a report parts of one shape share a colour. */
export function tint(part: number): Vec {
  const hue = (part * 0.381966011250105 + 0.58) % 1;
  const channel = (shift: number) => {
    const ramp = Math.min(1, Math.max(0, Math.abs(((hue + shift) % 1) * 6 - 3) - 1));
    return 0.4 + 0.48 * ramp;
  };
  return [channel(0), channel(2 / 3), channel(1 / 3)];
}

export class Parts {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(30, 1, 0.01, 1e4);
  readonly renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true, stencil: true });
  readonly orbit: OrbitControls;
  private readonly parts: { group: Group; geometry: BufferGeometry; triangles: Uint32Array; material: MeshLambertMaterial; line: LineBasicMaterial; colour: Vec }[] = [];
  private readonly name = h("div", { class: "name", hidden: true });
  private names: string[] = [];
  private lit = -1;
  /** Size of the assembled parts, and size for which the picture is wide enough. */
  private size = 1;
  private extent = 1;
  onClick: (part: number) => void = () => {};
  onRender: () => void = () => {};

  constructor(private readonly view: HTMLElement) {
    const canvas = this.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The assembly");
    view.append(canvas, this.name);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.6, 0.9, 1);
    this.camera.add(sun, sun.target);
    sun.target.position.set(0, 0, -1);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.25));
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener("change", () => this.render());
    canvas.addEventListener("pointermove", (event) => !event.buttons && this.light(this.under(event)));
    let down = [0, 0];
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("click", (event) => {
      this.light(this.under(event));
      // A drag ends with a click event too.
      if (Math.hypot(event.clientX - down[0]!, event.clientY - down[1]!) < 5) this.onClick(this.lit);
    });
    new ResizeObserver(() => this.resize()).observe(view);
  }

  readonly render = soon(() => {
    this.renderer.render(this.scene, this.camera);
    this.onRender();
  });

  show(parts: Part[], size: number) {
    for (const { group, material, line } of this.parts) {
      group.removeFromParent();
      for (const child of group.children) (child as Mesh).geometry.dispose();
      material.dispose();
      line.dispose();
    }
    this.parts.length = 0;
    this.names = parts.map(({ name }) => name);
    for (const part of parts) this.add(part);
    this.size = this.extent = size;
    this.fit();
    this.resize();
  }

  /** Fits everything into the picture, including parts that have been moved. */
  fit() {
    const far = (1.6 * this.extent) / 2 / Math.sin((this.camera.fov * Math.PI) / 360) / Math.min(1, this.camera.aspect);
    this.camera.position.set(0.62, -0.68, 0.45).normalize().multiplyScalar(far);
    [this.camera.near, this.camera.far] = [far / 1e3, far * 1e3];
    this.camera.updateProjectionMatrix();
    this.orbit.target.set(0, 0, 0);
    this.orbit.update();
  }

  private add(part: Part) {
    const indexed = new BufferGeometry();
    indexed.setAttribute("position", new BufferAttribute(part.vertices, 3));
    indexed.setIndex(new BufferAttribute(part.triangles, 1));
    const material = new MeshLambertMaterial({
      color: new Color().setRGB(...part.colour, "srgb"), flatShading: true, side: DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    const group = new Group();
    const line = new LineBasicMaterial({ color: 0x1d2733, transparent: true, opacity: 0.6 });
    group.add(new Mesh(indexed, material), new LineSegments(new EdgesGeometry(indexed, 20), line));
    this.scene.add(group);
    this.parts.push({ group, geometry: indexed, triangles: part.triangles, material, line, colour: part.colour });
  }

  /** Returns the shape of a part, and the group that moves with it. */
  shape(part: number): { group: Group; geometry: BufferGeometry; triangles: Uint32Array } | undefined {
    return this.parts[part];
  }

  /** Hides what is on the negative side of planes. */
  clip(planes: Plane[]) {
    for (const { material, line } of this.parts) material.clippingPlanes = line.clippingPlanes = planes;
  }

  /** Extent of the picture, including parts that have been moved. */
  get reach(): number {
    return this.extent;
  }

  /** Places all parts after `t` of the moves. */
  place(moves: Move[], t: number) {
    for (const { group } of this.parts) {
      group.position.set(0, 0, 0);
      group.quaternion.identity();
    }
    moves.forEach((legs, k) => legs.forEach(({ parts, way, turn }, leg) => {
      const share = Math.min(1, Math.max(0, (t - k) * legs.length - leg));
      // Slow at both ends.
      const eased = share * share * (3 - 2 * share);
      for (const part of parts) {
        const group = this.parts[part]?.group;
        if (group && turn && share) {
          const by = new Quaternion().setFromAxisAngle(new Vector3(...turn.axis), 2 * Math.PI * (turn.phase + turn.turns * eased));
          group.position.sub(new Vector3(...turn.own)).applyQuaternion(by).add(new Vector3(...turn.point));
          group.quaternion.premultiply(by);
        }
        group?.position.addScaledVector(new Vector3(...way), eased);
      }
    }));
    this.widen();
    this.render();
  }

  /** Keeps moved parts in the picture: increases the distance of the camera as needed. */
  private widen() {
    const moved = Math.max(0, ...this.parts.map(({ group }) => group.position.length()));
    const extent = Math.max(this.size, 1.6 * moved + this.size / 2);
    if (extent === this.extent) return;
    const { camera, orbit } = this;
    camera.position.sub(orbit.target).multiplyScalar(extent / this.extent).add(orbit.target);
    this.extent = extent;
    orbit.update();
  }

  /** Looks at a place, relative to the middle of the assembly, from the current direction. `radius` is half the extent to show. */
  focus(at: Vec, radius: number) {
    const { camera, orbit } = this;
    const far = (1.6 * radius) / Math.sin((camera.fov * Math.PI) / 360) / Math.min(1, camera.aspect);
    const from = camera.position.clone().sub(orbit.target).setLength(far);
    orbit.target.set(...at);
    camera.position.copy(orbit.target).add(from);
    [camera.near, camera.far] = [far / 1e3, 1e3 * (far + this.extent)];
    camera.updateProjectionMatrix();
    orbit.update();
  }

  /** Sets the opacity of each part, from 0 to 1, and the colours of parts that are not to have their own. */
  fade(opacity: (part: number) => number, paint: (part: number) => string | undefined = () => undefined) {
    this.parts.forEach(({ material, line, colour }, k) => {
      const other = paint(k);
      if (other) material.color.set(other);
      else material.color.setRGB(...colour, "srgb");
      material.opacity = opacity(k);
      const faded = material.opacity < 1;
      // The change of transparency needs another shader program.
      if (material.transparent !== faded) material.needsUpdate = true;
      material.transparent = faded;
      material.depthWrite = !faded;
      line.opacity = 0.6 * Math.min(1, 1.4 * material.opacity);
    });
    this.render();
  }

  private under(event: MouseEvent): number {
    const meshes: Object3D[] = this.parts.map(({ group }) => group.children[0]!);
    const hit = casterAt(this.renderer.domElement, this.camera, event).intersectObjects(meshes, false)[0];
    return hit ? meshes.indexOf(hit.object) : -1;
  }

  /** Highlights a part and shows its name; -1 for none. */
  light(part: number) {
    if (part === this.lit) return;
    this.lit = part;
    this.parts.forEach(({ material }, k) => material.emissive.setScalar(k === part ? 0.18 : 0));
    this.name.hidden = part < 0;
    this.name.textContent = this.names[part] ?? "";
    this.render();
  }

  private resize() {
    const { clientWidth: wide, clientHeight: high } = this.view;
    if (!wide || !high) return;
    const before = this.camera.aspect;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(wide, high);
    this.camera.aspect = wide / high;
    // A narrow window needs a larger distance.
    const change = Math.min(1, before) / Math.min(1, this.camera.aspect);
    if (change !== 1) this.camera.position.sub(this.orbit.target).multiplyScalar(change).add(this.orbit.target);
    this.camera.updateProjectionMatrix();
    this.render();
  }
}
