// The bodies, the arrow and the contact in three dimensions.
//
// Coordinates of the scene are those of the world less `origin`, a point near the bodies, and a
// body's geometry is relative to its own middle: single precision then shows parts that lie far from
// where their coordinates begin.

import {
  AmbientLight, BufferAttribute, BufferGeometry, CircleGeometry, Color, ConeGeometry, CylinderGeometry,
  DirectionalLight, DoubleSide, FrontSide, Group, Line, LineBasicMaterial, LineDashedMaterial, LineLoop,
  LineSegments, Material, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D, PerspectiveCamera,
  PlaneGeometry, Quaternion, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { TransformControls } from "three/addons/controls/TransformControls.js";
import { aim, onPage, rounded } from "./aim";
import { type Palette, palette } from "./colours";
import { h, soon, svg } from "./dom";
import type { Answer, Body, Feature, Slot, Touch } from "./engine";
import { type Pose, type Vec, add, cross, dot, length, placed, sub, times, turned, unit } from "./math";
import type { State } from "./state";

/** Triangles of an SVG file. */
const MOST_DRAWN = 40_000;

export type Tool = "look" | "move" | "turn";

/** A body as it is drawn: its geometry about its middle, and how large it is. */
export interface Drawn {
  body: Body;
  middle: Vec;
  radius: number;
  geometry: BufferGeometry;
  edges: BufferGeometry;
}

/** The bodies there are. */
export type Bodies = Partial<Record<Slot, Drawn>>;

/** Gives back what a body holds of the graphics memory. */
export function forget(body: Drawn | undefined) {
  body?.geometry.dispose();
  body?.edges.dispose();
}

/** Where a body is, its geometry being about its middle. */
function matrixOf(pose: Pose, middle: Vec, origin: Vec, shift: Vec = [0, 0, 0]): Matrix4 {
  const at = sub(add(placed(pose, middle), shift), origin);
  const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]).normalize();
  return new Matrix4().compose(new Vector3(...at), turn, new Vector3(1, 1, 1));
}

export function drawn(body: Body): Drawn {
  const middle = times(add(body.facts.low, body.facts.high), 0.5);
  const radius = Math.max(length(sub(body.facts.high, body.facts.low)) / 2, Number.MIN_VALUE);
  const { vertices, triangles } = body;
  const relative = (indices: Uint32Array): BufferAttribute => {
    const points = new Float32Array(3 * indices.length);
    for (let k = 0; k < indices.length; k++) {
      const v = 3 * indices[k]!;
      for (let c = 0; c < 3; c++) points[3 * k + c] = vertices[v + c]! - middle[c]!;
    }
    return new BufferAttribute(points, 3);
  };
  // Corners are not shared: every facet has its own shade.
  const geometry = new BufferGeometry().setAttribute("position", relative(triangles));
  const edges = new BufferGeometry().setAttribute("position", relative(body.edges));
  return { body, middle, radius, geometry, edges };
}

/** A translucent sheet; what lies behind it is drawn first. */
function sheet(colour: string, opacity: number): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: colour, transparent: true, opacity, side: DoubleSide, depthWrite: false });
}

export class View {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(32, 1, 0.01, 1e4);
  readonly renderer: WebGLRenderer;
  private readonly orbit: OrbitControls;
  /** Read when a body is to be moved by its handles. */
  private gizmo: Promise<TransformControls> | undefined;
  private handles: TransformControls | undefined;
  private readonly handle = new Object3D();
  /** Made anew with every answer. */
  private readonly shown = new Group();
  /** What another part of the page adds. */
  readonly extra = new Group();
  private readonly labels: HTMLElement;
  private origin: Vec = [0, 0, 0];
  private size = 1;
  private colours: Palette = palette();
  private state: State | undefined;
  private answer: Answer | undefined;
  private tip: Vector3 | undefined;
  private texts: { text: string; at: Vector3; kind: string }[] = [];
  private tool: Tool = "look";
  private held: Slot = "moving";
  private plain = false;
  private meshOfGrid = "";
  /** Where the grid lies, and for what. */
  private ground: { of: unknown[]; low: number } = { of: [], low: 0 };
  private readonly axes = svg("svg", { class: "axes", viewBox: "-40 -40 80 96", "aria-hidden": "true" });

  onDirection: (direction: Vec, done: boolean) => void = () => {};
  onPose: (slot: Slot, pose: Pose, done: boolean) => void = () => {};

  constructor(
    private readonly host: HTMLElement,
    private readonly drawnBodies: Bodies,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.setAttribute("aria-label", "The two bodies, the direction and the contact");
    canvas.setAttribute("role", "img");
    canvas.tabIndex = 0;
    host.prepend(canvas);
    host.append(this.axes);
    this.labels = host.appendChild(h("div", { class: "labels", "aria-hidden": "true" }));
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener("change", this.render);
    this.orbit.listenToKeyEvents(canvas);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.6, 0.9, 1);
    this.camera.add(sun, sun.target);
    sun.target.position.set(0, 0, -1);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.25), this.shown, this.extra, this.handle);
    this.arrowDrag(canvas);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  readonly render = soon(() => {
    this.handles?.getHelper().updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
    this.placeLabels();
    this.placeAxes();
  });

  bodyOf(slot: Slot): Drawn | undefined {
    return this.drawnBodies[slot];
  }

  setTool(tool: Tool, slot: Slot) {
    this.tool = tool;
    this.held = slot;
    this.handles?.detach();
    if (tool !== "look") void this.attach();
    this.placeHandle();
    this.render();
  }

  private async attach() {
    this.gizmo ??= this.makeGizmo();
    const gizmo = await this.gizmo;
    if (this.tool === "look" || !this.drawnBodies[this.held]) return;
    gizmo.setMode(this.tool === "move" ? "translate" : "rotate");
    gizmo.attach(this.handle);
    this.render();
  }

  private async makeGizmo(): Promise<TransformControls> {
    const { TransformControls } = await import("three/addons/controls/TransformControls.js");
    const gizmo = new TransformControls(this.camera, this.renderer.domElement);
    gizmo.size = 0.8;
    gizmo.addEventListener("change", this.render);
    gizmo.addEventListener("dragging-changed", (event) => {
      this.orbit.enabled = !event.value;
      if (!event.value) this.moved(true);
    });
    gizmo.addEventListener("objectChange", () => this.moved(false));
    this.scene.add(gizmo.getHelper());
    this.handles = gizmo;
    return gizmo;
  }

  /** Only bodies and what others add; for the views of searches. */
  setPlain(plain: boolean) {
    this.plain = plain;
  }

  themeChanged() {
    this.colours = palette();
    if (this.state) this.show(this.state, this.answer);
  }

  /** Everything into the picture. `along`: seen along the direction. */
  fit(state: State, answer: Answer | undefined, along = false) {
    [this.state, this.answer] = [state, answer];
    const [moving, fixed] = [this.drawnBodies.moving, this.drawnBodies.fixed];
    if (!state || !moving || !fixed) return;
    const balls: [Vec, number][] = [
      [placed(state.poses.moving, moving.middle), moving.radius],
      [placed(state.poses.fixed, fixed.middle), fixed.radius],
    ];
    const t = this.answer?.first?.t;
    if (t !== undefined && t > 0) balls.push([add(balls[0]![0], times(state.direction, t)), moving.radius]);
    // The arrow's tip, which is a little farther out when all of it is in the picture.
    balls.push([add(balls[0]![0], times(unit(state.direction), 1.1 * moving.radius + 0.2 * (moving.radius + fixed.radius))), 0]);
    let [low, high]: [Vec, Vec] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const [at, r] of balls) {
      low = low.map((x, k) => Math.min(x, at[k]! - r)) as Vec;
      high = high.map((x, k) => Math.max(x, at[k]! + r)) as Vec;
    }
    this.origin = times(add(low, high), 0.5);
    this.size = Math.max(length(sub(high, low)) / 2, 1e-9);
    const narrow = Math.min(1, this.camera.aspect);
    const far = (0.86 * this.size) / Math.sin((this.camera.fov * Math.PI) / 360) / narrow;
    const from: Vec = along ? times(unit(state.direction), -1) : this.bestSide(state.direction);
    this.orbit.target.set(0, 0, 0);
    this.camera.position.set(...times(from, far));
    this.camera.near = far / 1e3;
    this.camera.far = far * 1e3;
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.show(state, answer);
  }

  /** From the side, so that the way is long, a little from above. */
  private bestSide(direction: Vec): Vec {
    const d = unit(direction);
    const normal = this.answer?.first?.normal;
    const candidates: Vec[] = [[-0.62, -0.68, 0.4], [0.62, -0.68, 0.4], [-0.62, 0.68, 0.4], [0.62, 0.68, 0.4]];
    const score = (v: Vec) => -Math.abs(dot(v, d)) - (normal ? 0.8 * dot(v, normal) : 0);
    return candidates.reduce((best, v) => (score(v) > score(best) ? v : best));
  }

  show(state: State, answer: Answer | undefined) {
    this.state = state;
    this.answer = answer;
    this.clear(this.shown);
    this.texts = [];
    this.tip = undefined;
    const { moving, fixed } = this.drawnBodies;
    if (fixed) this.addBody(fixed, matrixOf(state.poses.fixed, fixed.middle, this.origin), this.colours.fixed, this.plain ? "ghost" : "solid");
    if (moving) this.addMoving(moving, state, answer);
    this.addGround();
    if (!this.plain) {
      const first = answer?.first;
      if (first && moving && fixed) this.addContact(first, answer, state, moving, fixed);
      else if (answer?.sideways && answer.margin) this.addGap(answer.sideways, answer.margin, state);
      if (moving && fixed) this.addArrow(moving, fixed, state);
    }
    this.placeHandle();
    this.render();
  }

  private addMoving(moving: Drawn, state: State, answer: Answer | undefined) {
    const t = state.t ?? 0;
    const at = (t: number) => matrixOf(state.poses.moving, moving.middle, this.origin, times(state.direction, t));
    this.addBody(moving, at(this.plain ? 0 : t), this.colours.moving, this.plain ? "ghost" : "solid");
    if (this.plain) return;
    if (t !== 0) this.addBody(moving, at(0), this.colours.moving, "outline");
    const stop = answer?.first?.t;
    if (stop !== undefined && Math.abs(stop - t) > 1e-9 * (1 + Math.abs(stop))) {
      this.addBody(moving, at(stop), this.colours.moving, "ghost");
    }
  }

  private addBody(body: Drawn, matrix: Matrix4, colour: string, how: "solid" | "ghost" | "outline") {
    const group = new Group();
    group.userData = { body, how };
    group.matrixAutoUpdate = false;
    group.matrix.copy(matrix);
    if (how !== "outline") {
      const ghost = how === "ghost";
      const material = new MeshLambertMaterial({
        color: colour, flatShading: true, side: DoubleSide,
        transparent: ghost, opacity: ghost ? 0.3 : 1, depthWrite: !ghost,
        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
      });
      group.add(new Mesh(body.geometry, material));
    }
    const many = body.body.edges.length > 4e3;
    const opacity = how === "solid" ? (many ? 0.25 : 0.85) : how === "ghost" ? (many ? 0.1 : 0.5) : many ? 0.06 : 0.28;
    const line = this.colours.dark && how !== "solid" ? this.colours.way : this.colours.edge;
    group.add(new LineSegments(body.edges, new LineBasicMaterial({ color: line, transparent: true, opacity })));
    this.shown.add(group);
  }

  private inScene = (v: Vec): Vector3 => new Vector3(...sub(v, this.origin));

  private line(points: Vector3[], colour: string, dashed = false, opacity = 1, closed = false): Line {
    const geometry = new BufferGeometry().setFromPoints(points);
    const look = { color: colour, transparent: true, opacity };
    const dash = this.size / 40;
    const material = dashed
      ? new LineDashedMaterial({ ...look, dashSize: dash, gapSize: dash })
      : new LineBasicMaterial(look);
    const line = closed ? new LineLoop(geometry, material) : new Line(geometry, material);
    if (dashed) line.computeLineDistances();
    return line;
  }

  /** A rod with a head. */
  private rod(from: Vector3, to: Vector3, colour: string, width: number): Group {
    const group = new Group();
    const way = to.clone().sub(from);
    const long = way.length();
    const head = Math.min(5 * width, long / 2);
    const material = new MeshLambertMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.35 });
    const shaft = new Mesh(new CylinderGeometry(width, width, long - head, 16), material);
    shaft.position.y = (long - head) / 2;
    const cone = new Mesh(new ConeGeometry(2.4 * width, head, 24), material);
    cone.position.y = long - head / 2;
    group.add(shaft, cone);
    group.position.copy(from);
    group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way.normalize());
    return group;
  }

  private above(part: Object3D) {
    part.renderOrder = 5;
    const { material } = part as Partial<Mesh>;
    for (const one of material ? ([material].flat() as Material[]) : []) {
      one.depthTest = false;
      // So that it is drawn after what is translucent.
      one.transparent = true;
    }
  }

  private addArrow(moving: Drawn, fixed: Drawn, state: State) {
    const base = placed(state.poses.moving, moving.middle);
    const reach = 1.05 * moving.radius + 0.14 * Math.min(this.size, moving.radius + fixed.radius);
    const tip = add(base, times(unit(state.direction), reach));
    this.tip = this.inScene(tip);
    // Seen through the body it starts in.
    const arrow = this.rod(this.inScene(base), this.tip, this.colours.way, 0.0065 * this.size);
    // It is there to be dragged: nothing hides it.
    arrow.traverse((part) => this.above(part));
    this.shown.add(arrow);
    const knob = new Mesh(
      new SphereGeometry(0.024 * this.size, 24, 16),
      new MeshLambertMaterial({ color: this.colours.way, emissive: this.colours.way, emissiveIntensity: 0.2 }),
    );
    knob.position.copy(this.tip);
    this.above(knob);
    this.shown.add(knob);
    this.texts.push({ text: "d", at: this.inScene(add(base, times(unit(state.direction), reach * 1.07))), kind: "way" });
  }

  private addContact(first: Touch, answer: Answer, state: State, moving: Drawn, fixed: Drawn) {
    const point = this.inScene(first.on_fixed);
    const start = this.inScene(sub(first.on_fixed, times(state.direction, first.t)));
    this.shown.add(this.line([start, point], this.colours.way, true, 0.7));
    const n = first.normal;
    const reach = Math.min(moving.radius, fixed.radius);
    this.addDisc(point, n, 0.8 * reach);
    const from = this.inScene(sub(first.on_fixed, times(n, 0.62 * reach)));
    this.shown.add(this.rod(from, point, this.colours.normal, 0.007 * this.size));
    this.texts.push({ text: "n", at: this.inScene(sub(first.on_fixed, times(n, 0.7 * reach))), kind: "normal" });
    const dot = new Mesh(new SphereGeometry(0.013 * this.size, 24, 16), new MeshBasicMaterial({ color: this.colours.normal }));
    dot.position.copy(point);
    this.shown.add(dot);
    const along = times(state.direction, first.t);
    this.addFeature(first.fixed, fixed, matrixOf(state.poses.fixed, fixed.middle, this.origin), this.colours.fixedMark);
    this.addFeature(first.moving, moving, matrixOf(state.poses.moving, moving.middle, this.origin, along), this.colours.movingMark);
    if (answer.kind === "convex" && first.proof) this.addWitness(first, state, moving, fixed);
  }

  /** The supporting plane that proves the lower bound. */
  private addDisc(at: Vector3, normal: Vec, radius: number) {
    const disc = new Mesh(new CircleGeometry(radius, 72), sheet(this.colours.plane, 0.2));
    disc.position.copy(at);
    disc.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...normal));
    const rim = Array.from({ length: 72 }, (_, k) => {
      const a = (k * Math.PI) / 36;
      return new Vector3(radius * Math.cos(a), radius * Math.sin(a), 0).applyQuaternion(disc.quaternion).add(at);
    });
    this.shown.add(disc, this.line(rim, this.colours.plane, false, 0.8, true));
  }

  /** The three pairs of vertices that prove the upper bound, at the contact. */
  private addWitness(first: Touch, state: State, moving: Drawn, fixed: Drawn) {
    const along = times(state.direction, first.t);
    const corner = (body: Drawn, pose: Pose, v: number): Vec => {
      const { vertices } = body.body;
      return placed(pose, [vertices[3 * v]!, vertices[3 * v + 1]!, vertices[3 * v + 2]!]);
    };
    const triangles: [Vec[], string][] = [
      [first.proof!.pairs.map(([p]) => add(corner(moving, state.poses.moving, p), along)), this.colours.movingMark],
      [first.proof!.pairs.map(([, q]) => corner(fixed, state.poses.fixed, q)), this.colours.fixedMark],
    ];
    for (const [corners, colour] of triangles) {
      const at = corners.map(this.inScene);
      const geometry = new BufferGeometry().setFromPoints(at);
      this.shown.add(new Mesh(geometry, sheet(colour, 0.25)), this.line(at, colour, false, 0.9, true));
    }
  }

  /** The vertex, edge or face that touches. */
  private addFeature(feature: Feature, body: Drawn, matrix: Matrix4, colour: string) {
    const { vertices, faces } = body.body;
    const group = new Group();
    group.matrixAutoUpdate = false;
    group.matrix.copy(matrix);
    const at = (v: number) =>
      new Vector3(...[0, 1, 2].map((c) => vertices[3 * v + c]! - body.middle[c]!) as Vec);
    if (feature.kind === "face") {
      const position = body.geometry.getAttribute("position");
      const corners: Vector3[] = [];
      faces.forEach((face, k) => {
        if (face !== feature.face) return;
        for (let c = 0; c < 3; c++) corners.push(new Vector3().fromBufferAttribute(position, 3 * k + c));
      });
      const material = sheet(colour, 0.55);
      material.polygonOffset = true;
      material.polygonOffsetFactor = -1;
      material.polygonOffsetUnits = -1;
      group.add(new Mesh(new BufferGeometry().setFromPoints(corners), material));
    } else if (feature.kind === "edge" && feature.vertices.length === 2) {
      const [a, b] = feature.vertices.map(at) as [Vector3, Vector3];
      const width = 0.007 * this.size;
      const rod = new Mesh(new CylinderGeometry(width, width, a.distanceTo(b), 12), new MeshBasicMaterial({ color: colour }));
      rod.position.copy(a).lerp(b, 0.5);
      rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), b.clone().sub(a).normalize());
      group.add(rod);
    } else if (feature.vertices[0] !== undefined) {
      const ball = new Mesh(new SphereGeometry(0.02 * this.size, 20, 12), new MeshBasicMaterial({ color: colour }));
      ball.position.copy(at(feature.vertices[0]));
      group.add(ball);
    }
    this.shown.add(group);
  }

  /** The plane between bodies that never meet. */
  private addGap(normal: Vec, margin: number, state: State) {
    const { moving, fixed } = this.drawnBodies;
    if (!moving || !fixed) return;
    const from = highest(moving.body, state.poses.moving, normal);
    const middle = add(placed(state.poses.fixed, fixed.middle), [0, 0, 0]);
    const level = from + margin / 2 - dot(middle, normal);
    const at = add(middle, times(normal, level));
    const d = unit(state.direction);
    const plane = new Mesh(new PlaneGeometry(2.2 * this.size, 1.6 * fixed.radius), sheet(this.colours.plane, 0.2));
    plane.matrixAutoUpdate = false;
    plane.matrix.makeBasis(new Vector3(...d), new Vector3(...cross(normal, d)), new Vector3(...normal));
    plane.matrix.setPosition(this.inScene(at));
    const half = [1.1 * this.size, 0.8 * fixed.radius] as const;
    const corner = (a: number, b: number) =>
      this.inScene(add(at, add(times(d, a * half[0]), times(cross(normal, d), b * half[1]))));
    this.shown.add(plane, this.line([corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)], this.colours.plane, false, 0.8, true));
  }

  /** A grid under everything, with its mesh in round numbers. */
  private addGround() {
    const step = 10 ** Math.floor(Math.log10(this.size / 1.5));
    const low = this.lowest();
    const snap = (x: number) => Math.round(x / step) * step;
    const count = Math.ceil((1.5 * this.size) / step);
    const [x, y] = [snap(this.origin[0]), snap(this.origin[1])];
    const points: Vector3[] = [];
    for (let k = -count; k <= count; k++) {
      const reach = step * count;
      points.push(this.inScene([x + k * step, y - reach, low]), this.inScene([x + k * step, y + reach, low]));
      points.push(this.inScene([x - reach, y + k * step, low]), this.inScene([x + reach, y + k * step, low]));
    }
    const grid = new LineSegments(
      new BufferGeometry().setFromPoints(points),
      new LineBasicMaterial({ color: this.colours.grid, transparent: true, opacity: 0.45 }),
    );
    this.shown.add(grid);
    this.meshOfGrid = `grid ${Number(step.toPrecision(3))}`;
  }

  private lowest(): number {
    const { state } = this;
    if (!state) return 0;
    const { moving, fixed } = this.drawnBodies;
    const now = [moving, fixed, state.poses.moving.join(), state.poses.fixed.join(), this.size];
    if (!now.every((value, k) => value === this.ground.of[k])) {
      const lows = (["moving", "fixed"] as const).flatMap((slot) => {
        const body = this.drawnBodies[slot];
        return body ? [-highest(body.body, state.poses[slot], [0, 0, -1])] : [];
      });
      this.ground = { of: now, low: lows.length ? Math.min(...lows) - 0.02 * this.size : 0 };
    }
    return this.ground.low;
  }

  private placeLabels() {
    const { clientWidth: wide, clientHeight: high } = this.host;
    while (this.labels.children.length < this.texts.length) this.labels.append(h("span"));
    [...this.labels.children].forEach((element, k) => {
      const label = element as HTMLElement;
      const text = this.texts[k];
      label.hidden = !text;
      if (!text) return;
      const at = text.at.clone().project(this.camera);
      label.hidden = at.z > 1;
      label.className = text.kind;
      label.textContent = text.text;
      label.style.transform = `translate(${((at.x + 1) / 2) * wide}px, ${((1 - at.y) / 2) * high}px) translate(-50%, -50%)`;
    });
  }

  /** The axes of the world as they are seen, in a corner; those that point away first. */
  private placeAxes() {
    const turn = this.camera.quaternion.clone().invert();
    const axes = [["x", 1, 0, 0], ["y", 0, 1, 0], ["z", 0, 0, 1]] as const;
    const seen = axes.map(([name, x, y, z]) => ({ name, at: new Vector3(x, y, z).applyQuaternion(turn) }));
    seen.sort((a, b) => a.at.z - b.at.z);
    this.axes.replaceChildren(
      ...seen.flatMap(({ name, at }) => [
        svg("line", { x1: 0, y1: 0, x2: 24 * at.x, y2: -24 * at.y }),
        svg("text", { x: 33 * at.x, y: -33 * at.y + 4 }, name),
      ]),
      svg("text", { x: 0, y: 52 }, this.plain ? "" : this.meshOfGrid),
    );
  }

  private placeHandle() {
    const { state } = this;
    const body = this.drawnBodies[this.held];
    if (!state || !body || this.handles?.dragging) return;
    const matrix = matrixOf(state.poses[this.held], body.middle, this.origin);
    matrix.decompose(this.handle.position, this.handle.quaternion, this.handle.scale);
  }

  /** The gizmo has moved the handle, which is the middle of the body. */
  private moved(done: boolean) {
    const body = this.drawnBodies[this.held];
    if (!body || this.tool === "look" || !this.state) return;
    const { x, y, z, w } = this.handle.quaternion;
    const old = this.state.poses[this.held];
    const keep = this.tool === "move";
    const turn: Pose = keep ? [0, 0, 0, old[3], old[4], old[5], old[6]] : [0, 0, 0, x, y, z, w];
    const { x: a, y: b, z: c } = this.handle.position;
    const at = sub(add([a, b, c], this.origin), turned(turn, body.middle));
    const fine = 10 ** Math.ceil(4 - Math.log10(this.size));
    const round = (v: number) => Math.round(v * fine) / fine;
    const place = keep ? (at.map(round) as Vec) : at;
    this.onPose(this.held, [...place, turn[3], turn[4], turn[5], turn[6]], done);
  }

  /** The tip of the arrow follows the pointer over a sphere about the moving body. */
  private arrowDrag(canvas: HTMLCanvasElement) {
    const ends = () => {
      const { moving } = this.drawnBodies;
      if (!moving || !this.state || !this.tip || this.plain) return undefined;
      return { base: this.inScene(placed(this.state.poses.moving, moving.middle)), tip: this.tip };
    };
    aim(canvas, this.camera, this.orbit, ends, (way, done) => {
      const long = length(this.state!.direction);
      const d = rounded(times(way, long), 0.003 * long);
      if (length(d) > 0) this.onDirection(d, done);
    });
  }

  /** Where the tip of the arrow is, in pixels of the page: for tests. */
  tipOnPage(): [number, number] | undefined {
    return this.tip && onPage(this.renderer.domElement, this.camera, this.tip);
  }

  private clear(group: Group) {
    const kept = new Set<BufferGeometry>();
    for (const body of Object.values(this.drawnBodies)) kept.add(body.geometry).add(body.edges);
    group.traverse((object) => {
      const { geometry, material } = object as Partial<Mesh>;
      if (geometry && !kept.has(geometry)) geometry.dispose();
      if (material) for (const one of [material].flat() as Material[]) one.dispose();
    });
    group.clear();
  }

  clearExtra() {
    this.clear(this.extra);
  }

  toScene(v: Vec): Vector3 {
    return this.inScene(v);
  }

  get reach(): number {
    return this.size;
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

  /** The picture as lines and areas, the nearer over the farther: text of an SVG file. */
  async drawing(): Promise<string> {
    let triangles = 0;
    this.scene.traverseVisible((object) => {
      const { geometry } = object as Partial<Mesh>;
      if ((object as Mesh).isMesh) triangles += (geometry?.index ?? geometry?.getAttribute("position"))!.count / 3;
    });
    if (triangles > MOST_DRAWN) throw new Error(`${Math.round(triangles)} triangles are too many for an SVG file: the PNG has them`);
    const { SVGRenderer } = await import("three/addons/renderers/SVGRenderer.js");
    const drawing = new SVGRenderer();
    const { clientWidth: wide, clientHeight: high } = this.host;
    drawing.setSize(wide, high);
    drawing.setPrecision(2);
    const back = this.prepare();
    drawing.render(this.scene, this.camera);
    back();
    const picture = drawing.domElement as unknown as SVGSVGElement;
    picture.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    picture.style.background = getComputedStyle(this.host).backgroundColor;
    for (const { text, at } of this.texts) {
      const place = at.clone().project(this.camera);
      picture.append(svg("text", { x: (place.x * wide) / 2, y: (-place.y * high) / 2, "font-size": 14, "font-style": "italic", "text-anchor": "middle", fill: this.colours.text }, text));
    }
    return new XMLSerializer().serializeToString(picture);
  }

  /** For a renderer that draws facet after facet: what faces away is left out, edges are drawn after
   * the facets of their body, the nearer body after the farther. Returns what takes that back. */
  private prepare(): () => void {
    const undo: (() => void)[] = [];
    const eye = this.camera.position;
    this.scene.traverse((object) => {
      // Light is counted otherwise there: without the division by pi, and clipped.
      const light = object as Partial<DirectionalLight>;
      if (light.isLight) {
        const { intensity } = light;
        light.intensity = intensity! / 4;
        undo.push(() => (light.intensity = intensity!));
      }
    });
    const groups = this.shown.children.filter(({ userData }) => userData.how === "solid");
    const far = (group: Object3D) => new Vector3().setFromMatrixPosition(group.matrix).distanceTo(eye);
    groups.sort((a, b) => far(b) - far(a)).forEach((group, k) => {
      const drawn = group.userData.body as Drawn;
      const { body } = drawn;
      const [mesh, lines] = group.children as [Mesh, LineSegments];
      const [old, material] = [lines.geometry, mesh.material as Material];
      const facing = eye.clone().applyMatrix4(group.matrix.clone().invert());
      const seen = new BufferGeometry().setFromPoints(seenEdges(drawn, facing));
      lines.geometry = seen;
      if (body.facts.closed) material.side = FrontSide;
      // Bodies that are not convex may stand in each other: there depth alone decides.
      const convex = body.facts.kind === "convex";
      mesh.renderOrder = convex ? 1 + k : 1;
      lines.renderOrder = convex ? 1.5 + k : 1;
      undo.push(() => {
        seen.dispose();
        lines.geometry = old;
        material.side = DoubleSide;
        mesh.renderOrder = lines.renderOrder = 0;
      });
    });
    for (const object of this.shown.children) {
      if (groups.includes(object) || object.type === "LineSegments") continue;
      object.traverse((part) => {
        const { renderOrder } = part;
        part.renderOrder = 20 + renderOrder;
        undo.push(() => (part.renderOrder = renderOrder));
      });
    }
    return () => undo.forEach((f) => f());
  }

  /** The picture as it is shown, on the page's ground. */
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

/** Ends of the edges at a facet that looks at the eye; of a body about its middle. */
function seenEdges({ body, middle }: Drawn, eye: Vector3): Vector3[] {
  const { vertices, triangles, edges } = body;
  const at = (v: number) => new Vector3(vertices[3 * v]! - middle[0], vertices[3 * v + 1]! - middle[1], vertices[3 * v + 2]! - middle[2]);
  const key = (a: number, b: number) => Math.min(a, b) * (vertices.length / 3) + Math.max(a, b);
  const seen = new Set<number>();
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!] as const;
    const [a, b, c] = corners.map(at) as [Vector3, Vector3, Vector3];
    const normal = b.clone().sub(a).cross(c.clone().sub(a));
    if (body.facts.closed && normal.dot(eye.clone().sub(a)) <= 0) continue;
    corners.forEach((v, k) => seen.add(key(v, corners[(k + 1) % 3]!)));
  }
  const ends: Vector3[] = [];
  for (let k = 0; k < edges.length; k += 2) {
    if (seen.has(key(edges[k]!, edges[k + 1]!))) ends.push(at(edges[k]!), at(edges[k + 1]!));
  }
  return ends;
}

/** The largest `n . x` of a placed body. */
export function highest(body: Body, pose: Pose, n: Vec): number {
  const back: Pose = [0, 0, 0, -pose[3], -pose[4], -pose[5], pose[6]];
  const [x, y, z] = turned(back, n);
  let best = -Infinity;
  const { vertices } = body;
  for (let k = 0; k < vertices.length; k += 3) {
    best = Math.max(best, x * vertices[k]! + y * vertices[k + 1]! + z * vertices[k + 2]!);
  }
  return best + dot(n, [pose[0], pose[1], pose[2]]);
}

