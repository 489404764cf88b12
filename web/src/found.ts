// How the answer was found.

import { h } from "./dom";
import type { Answer, Engine, Pair } from "./engine";
import type { State } from "./state";
import type { View } from "./view";

export class Found {
  readonly element = h("div");
  constructor(readonly engine: Engine, readonly view: View, readonly pair: () => Pair) {}
  changed(_answer: Answer | undefined) {}
  show(_state: State, _visible: boolean) {}
}
