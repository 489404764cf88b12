// The viewer of an assembly's report: the parts, and the disassembly step by step. Of the report of an audit: the pair
// that is chosen in the list of findings, a cut through it, and a filter of the list.
//
// A script without modules in a page with its data, so that it works from a file and offline.

import { type Clash, MOTION, Marker, wayOut, wayText } from "./assembly/clashes";
import { type Move, Parts } from "./assembly/parts";
import { Player } from "./assembly/player";
import { h } from "./dom";
import { short } from "./math";

interface Shapes {
  unit: string;
  size: number;
  parts: { name: string; colour: [number, number, number]; fixed: boolean; vertices: string; triangles: string }[];
}

interface PlanData extends Shapes {
  /** `legs` has the displacements of parts in the picture; `moves` is the number of those that take the parts out. */
  steps: { parts: number[]; legs: Move; moves: number; along: string; travel: number }[];
}

interface ClashData extends Shapes {
  /** One for each finding in the list; null if its parts are not in the page. */
  clashes: (Clash | null)[];
}

const STYLE = `
#viewer { border: 1px solid #d7dce3; border-radius: 12px; overflow: hidden; margin: 1.2em 0; font-size: 14px; }
#viewer .view { position: relative; height: min(62vh, 34em); background: radial-gradient(circle at 50% 35%, #fdfdfe, #e6ebf2); }
#viewer canvas { position: absolute; inset: 0; display: block; touch-action: none; }
#viewer .name { position: absolute; left: 12px; top: 10px; max-width: calc(100% - 24px); overflow-wrap: anywhere; background: #fff; color: #1d2530; border-radius: 8px; padding: 3px 10px; box-shadow: 0 1px 6px #14202d22; }
#viewer .bar { display: flex; gap: 12px; align-items: center; padding: 8px 14px; border-top: 1px solid #d7dce3; flex-wrap: wrap; }
#viewer .bar input[type=range] { flex: 1; min-width: 10em; accent-color: #0b57d0; }
#viewer button { font: inherit; border: 1px solid #d7dce3; border-radius: 8px; background: #fff; padding: 4px 11px; min-width: 40px; cursor: pointer; }
#viewer button:hover { border-color: #0b57d0; }
#viewer output { flex-basis: 100%; min-height: 1.4em; }
#viewer .cut { display: flex; gap: 12px; align-items: center; flex: 1 1 12em; min-width: 0; }
#viewer .cut label { display: flex; gap: 6px; align-items: center; white-space: nowrap; }
#viewer .cut input[type=range] { min-width: 4em; }
#viewer [hidden] { display: none; }
`;

const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

function showParts(host: HTMLElement, { parts, size }: Shapes): Parts {
  const view = h("div", { class: "view" });
  host.append(view);
  const seen = new Parts(view);
  seen.show(parts.map((part) => ({ ...part, vertices: new Float32Array(bytes(part.vertices)), triangles: new Uint32Array(bytes(part.triangles)) })), size);
  return seen;
}

function showPlan(host: HTMLElement, data: PlanData) {
  const { parts, steps, unit } = data;
  const seen = showParts(host, data);
  const moves = steps.map(({ legs }) => legs);
  const player = new Player((t) => seen.place(moves, t));
  host.append(player.element);
  const names = (all: number[]) => all.map((part) => parts[part]?.name).join(", ");
  player.show(
    steps.map((step) => `${names(step.parts)} ${step.moves > 1 ? `in ${step.moves} moves, the last ` : ""}along ${step.along}${step.travel ? `, ${short(step.travel, 4)} ${unit}` : ""}`),
    `${parts.length} parts, ${steps.length} steps; point at a part for its name.`,
  );
}

function showClashes(host: HTMLElement, data: ClashData, list: HTMLDetailsElement[]) {
  const seen = showParts(host, data);
  const marker = new Marker(seen);
  let moves: Move[] = [];
  const player = new Player((t) => seen.place(moves, t));
  player.element.append(marker.element);
  host.append(player.element);
  const show = (clash: Clash | undefined, idle: string) => {
    moves = clash ? wayOut(clash) : [];
    player.show(moves.map(() => wayText(data.parts[clash!.parts[0]]?.name)), idle, MOTION);
    marker.show(clash);
  };
  const pick = (k: number) => {
    list.forEach((entry, other) => entry.classList.toggle("shown", other === k));
    const clash = data.clashes[k] ?? undefined;
    const names = clash?.parts.map((part) => data.parts[part]?.name).join(" and ");
    show(clash, names ? `${names}; point at a part for its name.` : "The parts of this pair are not in the page, which would be too large.");
  };
  list.forEach((entry, k) => {
    // A click on an open entry closes it and shows its pair; a search of the browser opens entries without a click.
    entry.querySelector("summary")?.addEventListener("click", () => pick(k));
    entry.addEventListener("toggle", () => entry.open && !entry.classList.contains("shown") && pick(k));
  });
  if (list.length) pick(0);
  else show(undefined, "No pair interferes, touches or is too near; point at a part for its name.");
}

/** Puts a filter by kind and by name above the list of findings. */
function addFilter(list: HTMLDetailsElement[]) {
  const kinds = new Map<string, number>();
  for (const { dataset } of list) kinds.set(dataset.kind!, (kinds.get(dataset.kind!) ?? 0) + 1);
  const kind = h("select", { "aria-label": "Kind of findings" },
    h("option", { value: "" }, `all ${list.length} findings`),
    h("option", { value: "violation" }, `${list.filter(({ dataset }) => dataset.violation !== undefined).length} violations`),
    ...[...kinds].map(([name, count]) => h("option", { value: name }, `${count} ${name}`)));
  const part = h("input", { type: "search", placeholder: "part name", "aria-label": "Name of a part" });
  const shown = h("output", { "aria-live": "polite" });
  const update = () => {
    const [which, name] = [kind.value, part.value.toLowerCase()];
    const matching = list.filter((entry) => {
      const { dataset } = entry;
      const fits = (!which || (which === "violation" ? dataset.violation !== undefined : dataset.kind === which))
        && !!entry.querySelector(".names")?.textContent?.toLowerCase().includes(name);
      entry.hidden = !fits;
      return fits;
    });
    shown.textContent = which || name ? `${matching.length} shown` : "";
  };
  kind.addEventListener("change", update);
  part.addEventListener("input", update);
  list[0]?.before(h("div", { class: "filter" }, kind, part, shown));
}

const host = document.getElementById("viewer");
const data = document.getElementById("viewer-data")?.textContent;
const list = [...document.querySelectorAll<HTMLDetailsElement>("details.clash")];
if (list.length > 1) addFilter(list);
if (host && data) {
  document.head.append(h("style", {}, STYLE));
  try {
    const read = JSON.parse(data);
    if (read.clashes) showClashes(host, read, list);
    else showPlan(host, read);
  } catch (error) {
    // The report has pictures of every step, or of every finding.
    host.replaceChildren(h("p", { style: "padding: 0 1em" }, `The assembly cannot be turned here: ${error instanceof Error ? error.message : String(error)}`));
  }
}
