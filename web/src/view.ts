// The view: the bodies, the arrow and the contact in three dimensions. Its content is rebuilt for every answer, by
// `body`, `contact`, `arrow` and `ground` with the elements of `shapes` (all in `view/`). `framing` chooses the camera,
// `overlay` puts labels over the picture, `handles` move bodies, and `drawing` writes a file.

import {
  AmbientLight, type BufferGeometry, Color, DirectionalLight, Group, PerspectiveCamera, Scene, type Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { aim, onPage, rounded } from "./aim";
import { palette } from "./colours";
import { h, soon } from "./dom";
import type { PageCast } from "./answers";
import { type Slot, plane, touch } from "./engine";
import type { Nearness } from "./near";
import { type Pose, type Vec, length, times, unit } from "./math";
import { type State, otherOf } from "./state";
import { type Arrow, arrow } from "./view/arrow";
import { type Bodies, type Drawn, matrixOf, placedBody } from "./view/body";
import { contact, gap } from "./view/contact";
import { type Ball, bestSide, distance, drawable, extent, seen } from "./view/framing";
import { Ground } from "./view/ground";
import type { Handles, Tool } from "./view/handles";
import { Overlay } from "./view/overlay";
import { type Frame, type Label, clear, inPicture } from "./view/shapes";

/** Everything of an answer; translucent bodies with additions of a tab; or the resting body with additions of a tab. */
export type Look = "answer" | "ghosts" | "resting";

export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(32, 1, 0.01, 1e4);
  readonly renderer: WebGLRenderer;
  private readonly orbit: OrbitControls;
  /** Loaded when a tool is first used. */
  private handles: Handles | undefined;
  private reading: Promise<void> | undefined;
  private tool: [Tool, Slot] = ["look", "moving"];
  private readonly overlay: Overlay;
  private readonly ground = new Ground();
  /** Rebuilt for every answer. */
  private readonly shown = new Group();
  /** Additions of another tab. */
  readonly extra = new Group();
  readonly frame: Frame = { origin: [0, 0, 0], size: 1, colours: palette() };
  private state: State | undefined;
  private answer: PageCast | undefined;
  private arrow: Arrow | undefined;
  private labels: Label[] = [];
  private look: Look = "answer";
  /** Labels of another tab. */
  extraLabels: Label[] = [];
  private near: Nearness | undefined;
  private fitted = false;

  onDirection: (direction: Vec, done: boolean) => void = () => {};
  onPose: (slot: Slot, pose: Pose, done: boolean) => void = () => {};

  constructor(
    private readonly host: HTMLElement,
    private readonly bodies: Bodies,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.setAttribute("aria-label", "The two bodies, the direction and the contact; arrow keys move the view, with Shift they turn it");
    canvas.setAttribute("role", "img");
    canvas.tabIndex = 0;
    host.prepend(canvas);
    this.overlay = new Overlay(host);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener("change", this.render);
    this.orbit.listenToKeyEvents(canvas);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.6, 0.9, 1);
    this.camera.add(sun, sun.target);
    sun.target.position.set(0, 0, -1);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.25), this.shown, this.extra);
    this.arrowDrag(canvas);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  readonly render = soon(() => {
    this.handles?.beforeRender();
    this.renderer.render(this.scene, this.camera);
    this.overlay.place(this.camera, [...this.labels, ...this.extraLabels], this.look === "ghosts" ? "" : `grid ${Number(this.ground.step.toPrecision(3))}`);
  });

  bodyOf(slot: Slot): Drawn | undefined {
    return this.bodies[slot];
  }

  async setTool(tool: Tool, slot: Slot) {
    this.tool = [tool, slot];
    if (!this.handles && tool === "look") return;
    await (this.reading ??= this.makeHandles());
    // Another tool may have been chosen meanwhile.
    this.handles?.set(...this.tool, this.state);
    this.render();
  }

  private async makeHandles() {
    const { Handles } = await import("./view/handles");
    const { scene, camera, orbit, render, bodies, frame } = this;
    this.handles = new Handles({ scene, camera, canvas: this.renderer.domElement, orbit, render }, bodies, frame, (...moved) => this.onPose(...moved));
  }

  /** Sets the drawing of the distance of the bodies. */
  setNear(near: Nearness | undefined) {
    this.near = near;
  }

  setLook(look: Look) {
    this.look = look;
  }

  /** Whether dragging turns the view. */
  set turns(on: boolean) {
    this.orbit.enabled = on;
  }

  themeChanged() {
    this.frame.colours = palette();
    if (this.state) this.show(this.state, this.answer);
  }

  /** Fits everything into the picture; with `along` in a view along the direction. */
  fit(state: State, answer: PageCast | undefined, along = false) {
    [this.state, this.answer] = [state, answer];
    const { moving, fixed } = this.bodies;
    if (!moving || !fixed || !drawable(state, answer, moving, fixed)) return;
    const from: Vec = along ? times(unit(state.direction), -1) : bestSide(state.direction, answer);
    this.aimAt(seen(state, answer, moving, fixed), from);
    this.show(state, answer);
  }

  /** Fits balls into the picture, in a view from a direction. */
  aimAt(balls: Ball[], from: Vec) {
    this.fitted = true;
    Object.assign(this.frame, extent(balls));
    const far = distance(this.frame.size, this.camera.fov, this.camera.aspect);
    this.orbit.target.set(0, 0, 0);
    this.camera.position.set(...times(from, far));
    this.camera.near = far / 1e3;
    this.camera.far = far * 1e3;
    this.camera.updateProjectionMatrix();
    this.orbit.update();
  }

  show(state: State, answer: PageCast | undefined) {
    [this.state, this.answer, this.arrow, this.labels] = [state, answer, undefined, []];
    const { frame, shown } = this;
    const { moving, fixed } = this.bodies;
    clear(shown, this.kept());
    if (moving && fixed) {
      if (!drawable(state, answer, moving, fixed)) return this.render();
      // The address may have started with a state that cannot be drawn.
      if (!this.fitted) return this.fit(state, answer);
    }
    const rests = this.look === "resting" ? otherOf(state.motion.body) : "fixed";
    const resting = this.bodies[rests];
    if (resting) shown.add(placedBody(resting, matrixOf(state.poses[rests], resting.middle, frame.origin), frame.colours[rests], this.look === "ghosts" ? "ghost" : "solid", frame.colours));
    if (moving && this.look !== "resting") this.addMoving(moving, state, answer);
    shown.add(this.ground.grid(frame, this.bodies, state));
    if (this.look === "answer" && moving && fixed) this.addNotes(state, answer, moving, fixed);
    this.handles?.place(state);
    this.render();
  }

  /** Draws the moving body at `t`, at its start and at its stop. */
  private addMoving(moving: Drawn, state: State, answer: PageCast | undefined) {
    const { origin, colours } = this.frame;
    const add = (t: number, how: "solid" | "ghost" | "outline") => {
      const at = matrixOf(state.poses.moving, moving.middle, origin, times(state.direction, t));
      this.shown.add(placedBody(moving, at, colours.moving, how, colours));
    };
    if (this.look === "ghosts") return add(0, "ghost");
    const t = state.t ?? 0;
    add(t, "solid");
    if (t !== 0) add(0, "outline");
    const stop = answer?.record.translation;
    if (stop !== undefined && Math.abs(stop - t) > 1e-9 * (1 + Math.abs(stop))) add(stop, "ghost");
  }

  /** Draws the contact or the separating plane, and the arrow. */
  private addNotes(state: State, answer: PageCast | undefined, moving: Drawn, fixed: Drawn) {
    const { frame, shown } = this;
    const [first, between] = [touch(answer), plane(answer)];
    if (first) {
      const { parts, label } = contact(frame, first, answer?.proof, state, { moving, fixed });
      shown.add(...parts);
      this.labels.push(label);
    } else if (between?.margin) {
      shown.add(...gap(frame, between.normal, between.margin, state, { moving, fixed }));
    }
    const near = this.near?.draw(frame);
    if (near) {
      shown.add(...near.parts);
      this.labels.push(...near.labels);
    }
    this.arrow = arrow(frame, moving, fixed, state.poses.moving, state.direction);
    shown.add(this.arrow.group);
    this.labels.push(this.arrow.label);
  }

  /** Lets the tip of the arrow follow the pointer over a sphere about the moving body. */
  private arrowDrag(canvas: HTMLCanvasElement) {
    aim(canvas, this.camera, this.orbit, () => this.arrow, (way, done) => {
      const long = length(this.state!.direction);
      const d = rounded(times(way, long), 0.003 * long);
      if (length(d) > 0) this.onDirection(d, done);
    });
  }

  /** Returns the tip of the arrow in pixels of the page, for tests. */
  tipOnPage(): [number, number] | undefined {
    return this.arrow && onPage(this.renderer.domElement, this.camera, this.arrow.tip);
  }

  /** Returns the geometries of the bodies, which stay in the graphics memory. */
  private kept(): Set<BufferGeometry> {
    return new Set(Object.values(this.bodies).flatMap(({ geometry, edges }) => [geometry, edges]));
  }

  clearExtra() {
    clear(this.extra, this.kept());
    this.extraLabels = [];
  }

  /** Half the extent of the visible scene. */
  get size(): number {
    return this.frame.size;
  }

  toScene(v: Vec): Vector3 {
    return inPicture(this.frame, v);
  }

  private resize() {
    const { clientWidth: wide, clientHeight: high } = this.host;
    if (!wide || !high) return;
    const before = this.camera.aspect;
    this.renderer.setSize(wide, high);
    this.camera.aspect = wide / high;
    // A narrow window needs a larger distance.
    const change = Math.min(1, before) / Math.min(1, this.camera.aspect);
    if (change !== 1) this.camera.position.sub(this.orbit.target).multiplyScalar(change).add(this.orbit.target);
    this.camera.updateProjectionMatrix();
    this.render();
  }

  /** Returns the picture as the text of an SVG file. */
  async drawing(): Promise<string> {
    const { drawing } = await import("./view/drawing");
    const { scene, camera, labels, host, frame } = this;
    const { clientWidth: wide, clientHeight: high } = host;
    return drawing({ scene, camera, labels, size: frame.size, wide, high, ground: getComputedStyle(host).backgroundColor, text: frame.colours.text });
  }

  /** Returns the picture as it is shown, on the page's background. */
  picture(): Promise<Blob> {
    this.renderer.render(this.scene, this.camera);
    const source = this.renderer.domElement;
    const canvas = h("canvas", { width: source.width, height: source.height });
    const context = canvas.getContext("2d")!;
    context.fillStyle = `#${new Color(getComputedStyle(this.host).backgroundColor).getHexString()}`;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, 0);
    return new Promise((resolve, reject) =>
      canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture cannot be made")))),
    );
  }
}
