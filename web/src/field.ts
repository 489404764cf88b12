// A field for a number. Arrow keys change it by a step that fits its size.

import { h } from "./dom";

/** Calls back with every number, and with undefined if the field is emptied. */
export function numberField(name: string, change: (x: number | undefined) => void): HTMLInputElement {
  const input = h("input", { type: "number", step: "any", "aria-label": name, inputmode: "decimal" });
  input.addEventListener("input", () => {
    const x = input.value === "" ? undefined : input.valueAsNumber;
    if (x === undefined || Number.isFinite(x)) change(x);
  });
  input.addEventListener("keydown", (event) => {
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    event.preventDefault();
    const x = input.valueAsNumber || 0;
    const step = 10 ** Math.max(-3, Math.floor(Math.log10(Math.abs(x) || 1)) - 1) * (event.shiftKey ? 10 : 1);
    const next = Number((x + (event.key === "ArrowUp" ? step : -step)).toPrecision(12));
    input.value = String(next);
    change(next);
  });
  return input;
}
