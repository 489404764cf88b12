// The viewer of an assembly's report: the parts, and the disassembly step by step.
//
// A script without modules in a page with its data, so that it works from a file and offline.

import { type Move, Parts } from "./assembly/parts";
import { Player } from "./assembly/player";
import { h } from "./dom";
import { short } from "./math";

interface Data {
  unit: string;
  size: number;
  parts: { name: string; colour: [number, number, number]; fixed: boolean; vertices: string; triangles: string }[];
  /** `legs` has the displacements of parts in the picture; `moves` is the number of those that take the parts out. */
  steps: { parts: number[]; legs: Move; moves: number; along: string; travel: number }[];
}

const STYLE = `
#viewer { border: 1px solid #d7dce3; border-radius: 12px; overflow: hidden; margin: 1.2em 0; font-size: 14px; }
#viewer .view { position: relative; height: min(62vh, 34em); background: radial-gradient(circle at 50% 35%, #fdfdfe, #e6ebf2); }
#viewer canvas { position: absolute; inset: 0; display: block; touch-action: none; }
#viewer .name { position: absolute; left: 12px; top: 10px; background: #fff; border-radius: 8px; padding: 3px 10px; box-shadow: 0 1px 6px #14202d22; }
#viewer .bar { display: flex; gap: 12px; align-items: center; padding: 8px 14px; border-top: 1px solid #d7dce3; flex-wrap: wrap; }
#viewer .bar input[type=range] { flex: 1; min-width: 10em; accent-color: #0b57d0; }
#viewer button { font: inherit; border: 1px solid #d7dce3; border-radius: 8px; background: #fff; padding: 4px 11px; min-width: 40px; cursor: pointer; }
#viewer button:hover { border-color: #0b57d0; }
#viewer output { flex-basis: 100%; min-height: 1.4em; }
#viewer [hidden] { display: none; }
`;

const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

function show(host: HTMLElement, { parts, steps, size, unit }: Data) {
  const view = h("div", { class: "view" });
  host.append(view);
  const seen = new Parts(view);
  const moves = steps.map(({ legs }) => legs);
  const player = new Player((t) => seen.place(moves, t));
  host.append(player.element);
  seen.show(parts.map((part) => ({ ...part, vertices: new Float32Array(bytes(part.vertices)), triangles: new Uint32Array(bytes(part.triangles)) })), size);
  const names = (all: number[]) => all.map((part) => parts[part]?.name).join(", ");
  player.show(
    steps.map((step) => `${names(step.parts)} ${step.moves > 1 ? `in ${step.moves} moves, the last ` : ""}along ${step.along}${step.travel ? `, ${short(step.travel, 4)} ${unit}` : ""}`),
    `${parts.length} parts, ${steps.length} steps; point at a part for its name.`,
  );
}

const host = document.getElementById("viewer");
const data = document.getElementById("viewer-data")?.textContent;
if (host && data) {
  document.head.append(h("style", {}, STYLE));
  try {
    show(host, JSON.parse(data));
  } catch (error) {
    // The report has pictures of every step.
    host.replaceChildren(h("p", { style: "padding: 0 1em" }, `The assembly cannot be turned here: ${error instanceof Error ? error.message : String(error)}`));
  }
}
