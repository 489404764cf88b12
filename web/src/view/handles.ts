// Handles that move or turn a body about its middle; loaded on demand.

import { Object3D, type PerspectiveCamera, type Scene } from "three";
import type { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { TransformControls } from "three/addons/controls/TransformControls.js";
import type { Slot } from "../engine";
import { type Pose, type Vec, add, sub, turned } from "../math";
import type { State } from "../state";
import { type Bodies, matrixOf } from "./body";
import type { Frame } from "./shapes";

export type Tool = "look" | "move" | "turn";

interface Stage {
  scene: Scene;
  camera: PerspectiveCamera;
  canvas: HTMLCanvasElement;
  orbit: OrbitControls;
  render: () => void;
}

export class Handles {
  private readonly gizmo: TransformControls;
  /** Represents the middle of the body. */
  private readonly handle = new Object3D();
  private tool: Tool = "look";
  private held: Slot = "moving";
  private state: State | undefined;

  constructor(
    { scene, camera, canvas, orbit, render }: Stage, private readonly bodies: Bodies, private readonly frame: Frame,
    private readonly onPose: (slot: Slot, pose: Pose, done: boolean) => void,
  ) {
    const gizmo = new TransformControls(camera, canvas);
    gizmo.size = 0.8;
    gizmo.addEventListener("change", render);
    gizmo.addEventListener("dragging-changed", (event) => {
      orbit.enabled = !event.value;
      if (!event.value) this.moved(true);
    });
    gizmo.addEventListener("objectChange", () => this.moved(false));
    scene.add(this.handle, gizmo.getHelper());
    this.gizmo = gizmo;
  }

  set(tool: Tool, slot: Slot, state: State | undefined) {
    [this.tool, this.held] = [tool, slot];
    this.gizmo.detach();
    if (tool !== "look" && this.bodies[slot]) {
      this.gizmo.setMode(tool === "move" ? "translate" : "rotate");
      this.gizmo.attach(this.handle);
    }
    this.place(state);
  }

  /** Places the handles at the body. */
  place(state: State | undefined) {
    this.state = state;
    const body = this.bodies[this.held];
    if (!state || !body || this.gizmo.dragging) return;
    const matrix = matrixOf(state.poses[this.held], body.middle, this.frame.origin);
    matrix.decompose(this.handle.position, this.handle.quaternion, this.handle.scale);
  }

  beforeRender() {
    this.gizmo.getHelper().updateMatrixWorld();
  }

  private moved(done: boolean) {
    const body = this.bodies[this.held];
    if (!body || this.tool === "look" || !this.state) return;
    const { x, y, z, w } = this.handle.quaternion;
    const old = this.state.poses[this.held];
    const keep = this.tool === "move";
    const turn: Pose = keep ? [0, 0, 0, old[3], old[4], old[5], old[6]] : [0, 0, 0, x, y, z, w];
    const { x: a, y: b, z: c } = this.handle.position;
    const at = sub(add([a, b, c], this.frame.origin), turned(turn, body.middle));
    const fine = 10 ** Math.ceil(4 - Math.log10(this.frame.size));
    const round = (v: number) => Math.round(v * fine) / fine;
    const place = keep ? (at.map(round) as Vec) : at;
    this.onPose(this.held, [...place, turn[3], turn[4], turn[5], turn[6]], done);
  }
}
