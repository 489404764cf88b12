// Bodies in a library of their own, built from the same files as those of the page.

import type { Engine, Slot, Take } from "./engine";
import { SLOTS } from "./examples";

/** The source of a body. */
export interface Source {
  name: string;
  take: Take;
  bytes(): Promise<ArrayBuffer>;
}

export class Placing {
  private readonly placed: Partial<Record<Slot, Source>> = {};

  constructor(private readonly engine: Engine) {}

  /** Sends the sources that the library does not have yet. */
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
