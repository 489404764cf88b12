// The worker: loads the library that its name specifies, and answers one question after the other.

interface Library {
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

interface Asked {
  id: number;
  text: string;
  file?: ArrayBuffer;
}

const library: Promise<Library> = load();

async function load(): Promise<Library> {
  const file = `${self.name}.wasm`;
  const response = await fetch(new URL(file, import.meta.url));
  if (!response.ok) throw new Error(`${file}: ${response.status} ${response.statusText}`);
  // Not streamed, because static servers disagree about the content type of such files.
  const { instance } = await WebAssembly.instantiate(await response.arrayBuffer());
  return instance.exports as unknown as Library;
}

let stopped: string | undefined;

self.onmessage = async ({ data }: MessageEvent<Asked>) => {
  let text: string;
  let numbers = new ArrayBuffer(0);
  let began = performance.now();
  try {
    const loaded = await library;
    if (stopped) throw new Error(stopped);
    began = performance.now();
    try {
      [text, numbers] = answer(loaded, data);
    } catch (error) {
      stopped = `the library stopped, reload the page: ${why(loaded, error)}`;
      throw new Error(stopped);
    }
  } catch (error) {
    text = JSON.stringify({ error: error instanceof Error ? error.message : String(error) });
  }
  const took = performance.now() - began;
  self.postMessage({ id: data.id, text, numbers, took }, { transfer: [numbers] });
};

/** The usual reason is that a file is too large for 32-bit memory. */
function why(loaded: Library, error: unknown): string {
  const words = new Uint8Array(loaded.memory.buffer, loaded.last_words(), loaded.last_words_length());
  const said = new TextDecoder().decode(words) || String(error);
  return loaded.memory.buffer.byteLength > 2 ** 31 ? `the file is too large for a page (${said})` : said;
}

function answer(loaded: Library, { text, file }: Asked): [string, ArrayBuffer] {
  const question = new TextEncoder().encode(text);
  const start = loaded.question_buffer(question.length + (file?.byteLength ?? 0));
  const memory = new Uint8Array(loaded.memory.buffer, start);
  memory.set(question);
  if (file) memory.set(new Uint8Array(file), question.length);
  loaded.ask(question.length);
  // The memory may have moved when it grew, so its buffer is looked up again.
  const { buffer } = loaded.memory;
  const at = loaded.text();
  const said = new Uint8Array(buffer, at, loaded.text_length());
  const from = loaded.numbers();
  return [new TextDecoder().decode(said), buffer.slice(from, from + loaded.numbers_length()) as ArrayBuffer];
}
