// A WebAssembly module of the library: its start, and its calls.

import { StoppedError, errorOf } from "./errors.js";

/** @internal */
interface Exports {
  memory: WebAssembly.Memory;
  question_buffer(bytes: number): number;
  ask(text: number): void;
  text(): number;
  text_length(): number;
  numbers(): number;
  numbers_length(): number;
  last_words(): number;
  last_words_length(): number;
}

/** The reply to a call: texts of failed rows, and the numbers of the answer. */
export interface Reply {
  text: string;
  numbers: ArrayBuffer;
}

/** An instance of the library. Its bodies exist in its memory alone. */
export class Library {
  private stopped: string | undefined;

  /** @internal */
  constructor(
    private readonly exports: Exports,
    /** The module of the package that it belongs to. */
    readonly name: string,
  ) {}

  /** Sends a question: numbers, and the bytes of arrays behind them. */
  call(numbers: readonly number[], ...data: (Float64Array | Uint32Array)[]): Reply {
    if (this.stopped) throw new StoppedError(this.stopped);
    try {
      const reply = this.exchange(numbers, data);
      if (reply.text && !reply.numbers.byteLength) throw errorOf(reply.text);
      return reply;
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      const words = this.bytes(this.exports.last_words(), this.exports.last_words_length());
      this.stopped = `the library stopped: ${new TextDecoder().decode(words) || error.message}`;
      throw new StoppedError(this.stopped);
    }
  }

  private exchange(numbers: readonly number[], data: (Float64Array | Uint32Array)[]): Reply {
    const head = Float64Array.from(numbers);
    const total = data.reduce((sum, part) => sum + part.byteLength, head.byteLength);
    let at = this.exports.question_buffer(total);
    for (const part of [head, ...data]) {
      this.bytes(at, part.byteLength).set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength));
      at += part.byteLength;
    }
    this.exports.ask(head.byteLength);
    const text = new TextDecoder().decode(this.bytes(this.exports.text(), this.exports.text_length()));
    const answer = this.bytes(this.exports.numbers(), this.exports.numbers_length());
    return { text, numbers: answer.slice().buffer };
  }

  /** Returns a view of the memory, which is valid until the memory grows. */
  private bytes(at: number, length: number): Uint8Array {
    return new Uint8Array(this.exports.memory.buffer, at, length);
  }
}

/** The part of Node that reads a file. */
interface Node {
  process?: { getBuiltinModule?(name: "node:fs"): { readFileSync(url: URL): Uint8Array<ArrayBuffer> } };
}

/** Starts a module from its file. Node does not fetch files.
 * @internal */
export async function load(name: string, url: URL): Promise<Library> {
  const files = url.protocol === "file:" ? (globalThis as Node).process?.getBuiltinModule?.("node:fs") : undefined;
  const { instance } = await WebAssembly.instantiate(files ? files.readFileSync(url) : await fetched(url));
  return new Library(instance.exports as unknown as Exports, name);
}

async function fetched(url: URL): Promise<ArrayBuffer> {
  const response = await fetch(url);
  if (!response.ok) throw new StoppedError(`${url.href}: ${response.status} ${response.statusText}; the file belongs next to the script`);
  // Not streamed, because static servers disagree about the content type of such files.
  return response.arrayBuffer();
}

let current: Library | undefined;

/** Makes a library the one of new bodies. The module with all questions replaces the one with casts alone. */
export function provide(library: Library) {
  if (current?.name !== "colltrans") current = library;
}

/** Returns the library of new bodies. */
export function library(): Library {
  if (!current) throw new StoppedError("the library is still loading: import colltrans or colltrans/cast");
  return current;
}
