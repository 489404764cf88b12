// The formats of mesh files that the library reads. A test of `colltrans-wasm` compares this list with the library.

export const EXTENSIONS = ["stl", "obj", "ply", "off"];

/** Returns the names, with `word` before the last one. */
export const names = (word: string) => EXTENSIONS.map((e) => e.toUpperCase()).join(", ").replace(/, (\w+)$/, ` ${word} $1`);

/** The value of `accept` for file inputs. */
export const ACCEPTED = EXTENSIONS.map((e) => `.${e}`).join();
