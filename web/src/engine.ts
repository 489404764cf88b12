// A library in a worker: takes questions and returns answers, in order.

import type {
  PageAdd, PageAlong, PageAudit, PageBody, PageCast, PageCertify, PageDraw, PageError, PageFit, PageLevels, PageLit, PageLoad,
  PageMap, PageMotion, PageParts, PagePlace, PagePlan, PageProve, PageSearch, PageVerify, Separation,
} from "./answers";
import type { Pose, Vec } from "./math";

export type Slot = "moving" | "fixed";
export type Take = PageError["instead"][number];

/** The type of the answer for each value of the field `do`. */
interface Answers {
  load: PageLoad;
  cast: PageCast;
  certify: PageCertify;
  verify: PageVerify;
  search: PageSearch;
  levels: PageLevels;
  add: PageAdd;
  parts: PageParts;
  fit: PageFit;
  along: PageAlong;
  map: PageMap;
  plan: PagePlan;
  report: { title: string };
  audit: PageAudit;
  clashes: { title: string };
  draw: PageDraw;
  place: PagePlace;
  motion: PageMotion;
  prove: PageProve;
}

/** A body as it is drawn, in its own frame. */
export interface Body {
  facts: PageBody;
  /** The vertices of the body; those of the surface of a rounded body follow. */
  vertices: Float64Array;
  triangles: Uint32Array;
  /** The face of each triangle. */
  faces: Uint32Array;
  edges: Uint32Array;
}

/** The first contact. */
export interface Touch {
  t: number;
  normal: Vec;
  /** On the fixed body. */
  point: Vec;
  /** With the vertex numbers of the files. */
  features: NonNullable<PageCast["record"]["features"]>;
  lit: PageLit;
}

export function touch(answer: PageCast | undefined): Touch | undefined {
  if (!answer) return undefined;
  const { record: { translation: t, normal, point, features }, lit } = answer;
  return t !== undefined && normal && point && features && lit ? { t, normal, point, features, lit } : undefined;
}

/** Returns the plane along the direction between bodies that never meet, if it is known. */
export const plane = (answer: PageCast | undefined): Separation | undefined =>
  answer?.proof && "separation" in answer.proof ? answer.proof.separation : undefined;

/** The start of the paper's algorithm. */
export type Start = "center" | "ellipsoids";

/** Two placed bodies and a direction. */
export interface Pair {
  moving_pose: Pose;
  fixed_pose: Pose;
  direction: Vec;
  graze?: number;
  solver?: "auto" | "cta" | "portal";
  /** For `cta`: the start of the minimisation, and the gap at which it ends. */
  start?: Start;
  until?: "exit" | number;
  tolerance?: number | null;
  ignore_overlaps?: boolean;
}

/** An error with other ways to use the same file. */
export class Refused extends Error {
  constructor(
    message: string,
    readonly instead: Take[] = [],
    /** Whether the previous body was dropped. */
    readonly gone = false,
  ) {
    super(message);
  }
}

/** Maximum size of a file, so that the file and its body fit into 32-bit memory. */
export const MOST_MIB = 400;

/** Reads the bytes of a file of the visitor. */
export async function bytesOf(file: File): Promise<ArrayBuffer> {
  if (!file.size) throw new Refused(`${file.name}: the file is empty`);
  const mib = file.size / 2 ** 20;
  if (mib > MOST_MIB) throw new Refused(`${file.name}: ${Math.ceil(mib)} MiB; the page accepts up to ${MOST_MIB} MiB; use the command line for larger files`);
  return file.arrayBuffer();
}

/** An answer as the worker sends it. */
export interface Reply {
  id: number;
  text: string;
  numbers: ArrayBuffer;
  /** Time of the library in milliseconds. */
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

  /** Starts the worker at once, so that the library loads while the page is still being built. */
  constructor(readonly library: "colltrans" | "colltrans_assembly" | "colltrans_found" | "colltrans_motion" | "colltrans_picture" | "colltrans_all") {
    this.running();
  }

  /** Sends a question, with the bytes of a file if given. */
  async ask<Do extends keyof Answers>(question: { do: Do; [field: string]: unknown }, file?: ArrayBuffer): Promise<{ facts: Answers[Do]; text: string; numbers: ArrayBuffer; took: number }> {
    const id = this.next++;
    const reply = await new Promise<Reply>((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      const text = JSON.stringify(question);
      this.running().postMessage({ id, text, file }, file ? [file] : []);
    });
    const facts: Answers[Do] | PageError = JSON.parse(reply.text);
    if ("error" in facts) throw new Refused(facts.error, facts.instead, facts.gone);
    return { facts, text: reply.text, numbers: reply.numbers, took: reply.took };
  }

  async load(slot: Slot, name: string, take: Take, file?: ArrayBuffer): Promise<Body> {
    const { facts, numbers } = await this.ask({ do: "load", slot, name, take }, file);
    const { body, points, triangles, edges } = facts;
    let at = 0;
    const take64 = (count: number) => new Float64Array(numbers, (at += 8 * count) - 8 * count, count);
    const take32 = (count: number) => new Uint32Array(numbers, (at += 4 * count) - 4 * count, count);
    return {
      facts: body,
      vertices: take64(3 * points),
      triangles: take32(3 * triangles),
      faces: take32(triangles),
      edges: take32(2 * edges),
    };
  }

  async cast(pair: Pair): Promise<{ answer: PageCast; took: number }> {
    const { facts, took } = await this.ask({ do: "cast", ...pair });
    return { answer: facts, took };
  }

  /** Stops the worker: its state is lost and pending questions fail. The next question starts another worker. */
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
