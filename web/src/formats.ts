// The formats of mesh files that the library reads. A test of `colltrans-wasm` holds this list against it.

export const EXTENSIONS = ["stl", "obj", "ply", "off"];

/** Their names, the last one after this word. */
export const names = (word: string) => EXTENSIONS.map((e) => e.toUpperCase()).join(", ").replace(/, (\w+)$/, ` ${word} $1`);

/** What an input for files accepts. */
export const ACCEPTED = EXTENSIONS.map((e) => `.${e}`).join();
