// Bodies in a library of their own, made of the same files as the page's.

import type { Engine, Slot, Take } from "./engine";
import { SLOTS } from "./examples";

/** What a body was made of. */
export interface Source {
  name: string;
  take: Take;
  bytes(): Promise<ArrayBuffer>;
}

export class Placing {
  private readonly placed: Partial<Record<Slot, Source>> = {};

  constructor(private readonly engine: Engine) {}

  /** What is there already is not read again. */
  async place(sources: Record<Slot, Source>) {
    for (const slot of SLOTS) {
      const source = sources[slot];
      if (this.placed[slot] === source) continue;
      delete this.placed[slot];
      const { name, take } = source;
      await this.engine.ask({ do: "place", slot, name, take }, await source.bytes());
      this.placed[slot] = source;
    }
  }
}
