// A library, in a worker: questions go in, answers come out, in order.

import type { Pose, Vec } from "./math";

export type Slot = "moving" | "fixed";
export type Take = "convex" | "hull" | "solid" | "open";

/** What is said of a body. */
export interface BodyFacts {
  kind: "convex" | "solid";
  vertices: number;
  triangles: number;
  faces: number;
  edges: number;
  dimension: number;
  closed: boolean;
  volume: number;
  low: Vec;
  high: Vec;
  notes: string[];
}

/** A body as it is drawn, in its own frame. */
export interface Body {
  facts: BodyFacts;
  vertices: Float64Array;
  triangles: Uint32Array;
  /** The face of each triangle. */
  faces: Uint32Array;
  edges: Uint32Array;
}

export interface Feature {
  kind: "vertex" | "edge" | "face";
  /** Of the body as drawn. */
  vertices: number[];
  face?: number;
  /** By the numbers of the file. */
  file: number[];
}

export interface Certificate {
  normal: Vec;
  lower: number;
  upper: number | null;
  pairs: [number, number][];
  weights: Vec;
  rounding: number;
}

export interface Touch {
  t: number;
  normal: Vec;
  on_moving: Vec;
  on_fixed: Vec;
  moving: Feature;
  fixed: Feature;
  proof?: Certificate;
}

export interface Steps {
  solver: "cta" | "portal";
  planar_problems: number;
  supports: number;
  pivots: number;
  iterations: number;
}

export interface ConvexAnswer {
  kind: "convex";
  outcome: "contact" | "grazing" | "separated";
  first?: Touch;
  exit?: number | null;
  /** Beyond the second they never meet; `null`: nothing is known. */
  exit_bounds?: [number | null, number | null] | null;
  overlap?: number;
  sideways?: Vec;
  margin?: number;
  clearance: { kind: "blocked" | "slides" | "behind" | "separated" | "overlapping"; distance?: number };
  steps: Steps;
}

export interface SolidAnswer {
  kind: "solid";
  outcome: "free" | "blocked" | "overlapping";
  first?: Touch;
  exit: number | null;
  exit_bounds: [number, number] | null;
  /** Safe to move by. */
  distance?: number;
  /** Of `first.t`, where the faces that stop it meet in their true place. */
  bounds?: [number, number];
  /** Of the bodies shrunk by half the tolerance each. */
  shrunk_distance?: number;
  shrunk_distance_bounds?: [number, number];
  depth?: number | null;
  /** The bodies that are open, at least in part: what is inside of them is not known. */
  surfaces: ("moving" | "fixed")[];
  tolerance: number;
  precision: number;
  /** Of a plane between bodies that never meet, where there is one. */
  sideways?: Vec | null;
  margin?: number | null;
}

export type Answer = ConvexAnswer | SolidAnswer;

/** One reason of a proof between solids: how often it is given, about how many pairs of facets. */
export interface Claims {
  because: string;
  claims: number;
  pairs: number;
}

/** A proof of an answer between solids. */
export interface SolidProof {
  tolerance: number;
  /** `null`: nothing ever stops the body. */
  lower: number | null;
  stop: { shrunk_distance: number; triangles: [number, number] } | null;
  overlap: { kind: string; triangles: number[] } | null;
  start_entries: number;
  start_claims: Claims[] | null;
  claims: Claims[];
}

/** Two placed bodies and a direction. */
export interface Pair {
  moving_pose: Pose;
  fixed_pose: Pose;
  direction: Vec;
  graze?: number;
  solver?: "auto" | "cta" | "portal";
  tolerance?: number | null;
  ignore_overlaps?: boolean;
}

/** Why there is no answer, and what the same file could be taken as instead. */
export class Refused extends Error {
  constructor(
    message: string,
    readonly instead: Take[] = [],
    /** Whether the body that was there before is no more. */
    readonly gone = false,
  ) {
    super(message);
  }
}

/** What 32-bit memory holds, with the body that is built of it. */
export const MOST_MIB = 400;

/** Those of a file that somebody gave. */
export async function bytesOf(file: File): Promise<ArrayBuffer> {
  if (!file.size) throw new Refused(`${file.name}: it is empty`);
  const mib = file.size / 2 ** 20;
  if (mib > MOST_MIB) throw new Refused(`${file.name}: ${Math.ceil(mib)} MiB; a page takes files up to ${MOST_MIB} MiB, the command line larger ones`);
  return file.arrayBuffer();
}

/** An answer as the worker sends it. */
export interface Reply {
  id: number;
  text: string;
  numbers: ArrayBuffer;
  /** Milliseconds that the library took. */
  took: number;
}

interface Waiting {
  resolve(reply: Reply): void;
  reject(error: Error): void;
}

const WORKER = new URL("worker.js", import.meta.url);

export class Engine {
  private worker: Worker | undefined;
  private readonly waiting = new Map<number, Waiting>();
  private next = 1;

  /** The worker starts at once: the library is read while the page is still being made. */
  constructor(private readonly library: "colltrans" | "colltrans_assembly" | "colltrans_picture" = "colltrans") {
    this.running();
  }

  /** A question, and the bytes of a file with it. */
  async ask(question: object, file?: ArrayBuffer): Promise<{ facts: any; text: string; numbers: ArrayBuffer; took: number }> {
    const id = this.next++;
    const reply = await new Promise<Reply>((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      const text = JSON.stringify(question);
      this.running().postMessage({ id, text, file }, file ? [file] : []);
    });
    const facts = JSON.parse(reply.text);
    if (facts.error !== undefined) throw new Refused(facts.error, facts.instead, facts.gone);
    return { facts, text: reply.text, numbers: reply.numbers, took: reply.took };
  }

  async load(slot: Slot, name: string, take: Take, file?: ArrayBuffer): Promise<Body> {
    const { facts, numbers } = await this.ask({ do: "load", slot, name, take }, file);
    const body: BodyFacts = facts.body;
    let at = 0;
    const take64 = (count: number) => new Float64Array(numbers, (at += 8 * count) - 8 * count, count);
    const take32 = (count: number) => new Uint32Array(numbers, (at += 4 * count) - 4 * count, count);
    return {
      facts: body,
      vertices: take64(3 * body.vertices),
      triangles: take32(3 * body.triangles),
      faces: take32(body.triangles),
      edges: take32(2 * facts.edges),
    };
  }

  async cast(pair: Pair): Promise<{ answer: Answer; took: number }> {
    const { facts, took } = await this.ask({ do: "cast", ...pair });
    return { answer: facts, took };
  }

  /** What it holds is lost, and what it was asked has no answer; the next question starts another one. */
  stop(why: string) {
    this.worker?.terminate();
    this.worker = undefined;
    for (const waiting of this.waiting.values()) waiting.reject(new Error(why));
    this.waiting.clear();
  }

  private running(): Worker {
    if (this.worker) return this.worker;
    const worker = new Worker(WORKER, { type: "module", name: this.library });
    worker.onmessage = ({ data }: MessageEvent<Reply>) => {
      this.waiting.get(data.id)?.resolve(data);
      this.waiting.delete(data.id);
    };
    worker.onerror = (event) => this.stop(event.message || "the worker could not be started");
    this.worker = worker;
    return worker;
  }
}
