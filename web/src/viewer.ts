// The viewer of an assembly's report: the parts, and how they come apart, step by step.
//
// A script without modules, put into a page that holds its data: it works from a file, offline.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, EdgesGeometry, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { h, soon } from "./dom";
import { short } from "./math";

interface Data {
  unit: string;
  size: number;
  parts: { name: string; colour: [number, number, number]; fixed: boolean; vertices: string; triangles: string }[];
  /** `way`: how far the parts are moved in the picture. */
  steps: { parts: number[]; way: [number, number, number]; along: string; travel: number }[];
}

const STYLE = `
#viewer { border: 1px solid #d7dce3; border-radius: 12px; overflow: hidden; margin: 1.2em 0; font-size: 14px; }
#viewer .view { position: relative; height: min(62vh, 34em); background: radial-gradient(circle at 50% 35%, #fdfdfe, #e6ebf2); }
#viewer canvas { position: absolute; inset: 0; display: block; touch-action: none; }
#viewer .name { position: absolute; left: 12px; top: 10px; background: #fff; border-radius: 8px; padding: 3px 10px; box-shadow: 0 1px 6px #14202d22; }
#viewer .bar { display: flex; gap: 12px; align-items: center; padding: 8px 14px; border-top: 1px solid #d7dce3; flex-wrap: wrap; }
#viewer .bar input[type=range] { flex: 1; min-width: 10em; accent-color: #0b57d0; }
#viewer button { font: inherit; border: 1px solid #d7dce3; border-radius: 8px; background: #fff; padding: 4px 11px; min-width: 40px; cursor: pointer; }
#viewer button:hover { border-color: #0b57d0; }
#viewer output { flex-basis: 100%; min-height: 1.4em; }
#viewer [hidden] { display: none; }
`;

const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

class Viewer {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(30, 1, 0.01, 1e4);
  private readonly renderer = new WebGLRenderer({ antialias: true, alpha: true });
  private readonly parts: { group: Group; material: MeshLambertMaterial }[] = [];
  private readonly name = h("div", { class: "name", hidden: true });
  private readonly said = h("output");
  private readonly slider: HTMLInputElement;
  private readonly play = h("button", { "aria-label": "Play", title: "Play" }, "▶");
  private readonly view = h("div", { class: "view" });
  private lit = -1;
  private running = 0;

  constructor(host: HTMLElement, private readonly data: Data) {
    const steps = data.steps.length;
    this.slider = h("input", { type: "range", min: 0, max: steps, step: "any", value: 0, "aria-label": "Steps of the plan" });
    const canvas = this.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The assembly");
    this.view.append(canvas, this.name);
    const jump = (by: number) => () => this.go(Math.min(steps, Math.max(0, by > 0 ? Math.floor(this.slider.valueAsNumber) + 1 : Math.ceil(this.slider.valueAsNumber) - 1)));
    host.append(
      this.view,
      h("div", { class: "bar" }, this.play,
        h("button", { "aria-label": "Step back", onclick: jump(-1) }, "‹"), h("button", { "aria-label": "Step on", onclick: jump(1) }, "›"),
        this.slider, this.said));
    for (const part of data.parts) this.add(part);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.6, 0.9, 1);
    this.camera.add(sun, sun.target);
    sun.target.position.set(0, 0, -1);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.25));
    this.camera.up.set(0, 0, 1);
    const far = (1.6 * data.size) / 2 / Math.sin((this.camera.fov * Math.PI) / 360);
    this.camera.position.set(0.62, -0.68, 0.45).normalize().multiplyScalar(far);
    [this.camera.near, this.camera.far] = [far / 1e3, far * 1e3];
    const orbit = new OrbitControls(this.camera, canvas);
    orbit.addEventListener("change", this.render);
    this.slider.addEventListener("input", () => {
      this.stop();
      this.place();
    });
    this.play.addEventListener("click", () => (this.running ? this.stop() : this.start()));
    canvas.addEventListener("pointermove", (event) => !event.buttons && this.point(event));
    canvas.addEventListener("click", (event) => this.point(event));
    new ResizeObserver(() => this.resize()).observe(this.view);
    this.resize();
    this.place();
  }

  private readonly render = soon(() => this.renderer.render(this.scene, this.camera));

  private add(part: Data["parts"][number]) {
    const indexed = new BufferGeometry();
    indexed.setAttribute("position", new BufferAttribute(new Float32Array(bytes(part.vertices)), 3));
    indexed.setIndex(new BufferAttribute(new Uint32Array(bytes(part.triangles)), 1));
    const material = new MeshLambertMaterial({
      color: new Color().setRGB(...part.colour, "srgb"), flatShading: true, side: DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    const group = new Group();
    const line = new LineBasicMaterial({ color: 0x1d2733, transparent: true, opacity: 0.6 });
    group.add(new Mesh(indexed, material), new LineSegments(new EdgesGeometry(indexed, 20), line));
    this.scene.add(group);
    this.parts.push({ group, material });
  }

  /** Everything where it is at the slider's step. */
  private place() {
    const t = this.slider.valueAsNumber;
    const { steps, parts, unit } = this.data;
    for (const { group } of this.parts) group.position.set(0, 0, 0);
    steps.forEach(({ parts, way }, k) => {
      const share = Math.min(1, Math.max(0, t - k));
      // Slow at either end.
      const eased = share * share * (3 - 2 * share);
      for (const part of parts) this.parts[part]?.group.position.addScaledVector(new Vector3(...way), eased);
    });
    const k = Math.min(steps.length - 1, Math.ceil(t) - 1);
    const step = steps[k];
    const names = (all: number[]) => all.map((part) => parts[part]?.name).join(", ");
    this.said.textContent = step
      ? `Step ${k + 1} of ${steps.length}: ${names(step.parts)} along ${step.along}${step.travel ? `, ${short(step.travel, 4)} ${unit}` : ""}`
      : `${parts.length} parts, ${steps.length} steps; point at a part for its name.`;
    this.render();
  }

  private go(t: number) {
    this.stop();
    const from = this.slider.valueAsNumber;
    const began = performance.now();
    const move = (now: number) => {
      const share = Math.min(1, (now - began) / (900 * Math.max(Math.abs(t - from), 0.3)));
      this.slider.value = String(from + (t - from) * share);
      this.place();
      this.running = share < 1 ? requestAnimationFrame(move) : 0;
      if (!this.running) this.play.textContent = "▶";
    };
    this.running = requestAnimationFrame(move);
  }

  private start() {
    const end = this.data.steps.length;
    if (this.slider.valueAsNumber >= end) this.slider.value = "0";
    this.go(end);
    this.play.textContent = "❚❚";
  }

  private stop() {
    cancelAnimationFrame(this.running);
    this.running = 0;
    this.play.textContent = "▶";
  }

  private point(event: MouseEvent) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const caster = new Raycaster();
    caster.setFromCamera(at, this.camera);
    const meshes = this.parts.map(({ group }) => group.children[0]!);
    const hit = caster.intersectObjects(meshes, false)[0];
    const part = hit ? meshes.indexOf(hit.object) : -1;
    if (part === this.lit) return;
    this.lit = part;
    this.parts.forEach(({ material }, k) => material.emissive.setScalar(k === part ? 0.18 : 0));
    this.name.hidden = part < 0;
    this.name.textContent = this.data.parts[part]?.name ?? "";
    this.render();
  }

  private resize() {
    const { clientWidth: wide, clientHeight: high } = this.view;
    if (!wide || !high) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(wide, high);
    this.camera.aspect = wide / high;
    this.camera.updateProjectionMatrix();
    this.render();
  }
}

const host = document.getElementById("viewer");
const data = document.getElementById("viewer-data")?.textContent;
if (host && data) {
  document.head.append(h("style", {}, STYLE));
  try {
    new Viewer(host, JSON.parse(data));
  } catch (error) {
    // The report has pictures of every step.
    host.replaceChildren(h("p", { style: "padding: 0 1em" }, `The assembly cannot be turned here: ${error instanceof Error ? error.message : String(error)}`));
  }
}
