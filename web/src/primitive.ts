// Spheres, capsules and boxes in place of files: their names, as on the command line, and a form for them.

import { h } from "./dom";
import type { Slot } from "./engine";
import { numberField } from "./field";
import { short } from "./math";

/** Checks whether a name describes a body instead of a file. */
export const isShape = (name: string) => /^(sphere|capsule|box):/.test(name);

/** Checks whether a name describes a rounded body. */
export function isRound(name: string): boolean {
  const [kind, sizes = ""] = name.split(":");
  return isShape(name) && (kind !== "box" || Number(sizes.split(",")[3] ?? 0) > 0);
}

/** Describes the body of a name and a radius. */
export function described(name: string, radius: number): string {
  const [kind] = name.split(":");
  if (kind !== "box") return `a ${kind} of radius ${short(radius)}`;
  return radius ? `a box, rounded by ${short(radius)}` : "a box";
}

interface Kind {
  title: string;
  /** The fields with their first values. */
  sizes: [label: string, size: number][];
  name(...sizes: number[]): string;
}

const KINDS: Kind[] = [
  { title: "Sphere", sizes: [["Radius", 1]], name: (r) => `sphere:${r}` },
  {
    title: "Capsule along z", sizes: [["Radius", 0.5], ["Length of the axis", 2]],
    name: (r, l = 0) => `capsule:0,0,${-l / 2 || 0},0,0,${l / 2},${r}`,
  },
  {
    title: "Box", sizes: [["Size x", 2], ["Size y", 2], ["Size z", 2], ["Rounded by", 0]],
    name: (x, y, z, r) => `box:${[x, y, z, ...(r ? [r] : [])].join()}`,
  },
];

/** Builds the form. `use` receives the name of a body. */
export function shapeForm(use: (slot: Slot, name: string) => void): HTMLElement {
  const kinds = h("select", { "aria-label": "Kind of shape" }, ...KINDS.map(({ title }, k) => h("option", { value: k }, title)));
  const fields = h("div", { class: "fields", style: "grid-template-columns: repeat(2, minmax(0, 1fr)); align-items: end" });
  const chosen = () => KINDS[Number(kinds.value)]!;
  const show = () => fields.replaceChildren(...chosen().sizes.map((size) => {
    const input = numberField(size[0], (x) => (size[1] = x ?? size[1]));
    input.value = String(size[1]);
    return h("label", {}, size[0], input);
  }));
  kinds.addEventListener("change", show);
  show();
  const button = (slot: Slot) => h("button", {
    class: "small", onclick: () => use(slot, chosen().name(...chosen().sizes.map(([, size]) => size))),
  }, `As the ${slot} body`);
  return h("details", { class: "primitive" }, h("summary", {}, "A sphere, capsule or box"),
    h("div", {}, kinds, fields, h("div", { class: "row" }, button("moving"), button("fixed"))));
}
