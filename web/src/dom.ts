// Elements built by function calls.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | EventListener | undefined>;

function fill(element: Element, attributes: Attributes, children: Child[]) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(key.slice(2), value);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children.filter((child): child is Node | string => !!child));
}

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(element, attributes, children);
  return element;
}

/** Replaces the children of an element and keeps the focus. Children that stay must be passed themselves, not in a
 * wrapper, because moving them there would have ended their focus. */
export function refill(host: Element, ...children: Child[]) {
  const controls = () => [...host.querySelectorAll<HTMLElement | SVGElement>("button, input, select, [tabindex]")];
  const focused = document.activeElement as HTMLElement | SVGElement | null;
  const at = focused ? controls().indexOf(focused) : -1;
  host.replaceChildren(...children.filter((child): child is Node | string => !!child));
  if (at >= 0) (host.contains(focused) ? focused : controls()[at])?.focus({ preventScroll: true });
}

/** Returns the element of the page with an id. */
export function named<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as unknown as T;
}

/** Limits calls of a function to one per frame. */
export function soon(f: () => void): () => void {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      f();
    });
  };
}

/** Saves a file through the browser's download. */
export function save(blob: Blob, name: string) {
  const link = h("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  URL.revokeObjectURL(link.href);
}
