// Elements, written as calls.

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

/** Other children; what is in focus stays so, or what is there instead of it. What was a child and is to be
 * one again comes as it is, not in a wrapper: moving it there would have ended its focus before. */
export function refill(host: Element, ...children: Child[]) {
  const controls = () => [...host.querySelectorAll<HTMLElement | SVGElement>("button, input, select, [tabindex]")];
  const focused = document.activeElement as HTMLElement | SVGElement | null;
  const at = focused ? controls().indexOf(focused) : -1;
  host.replaceChildren(...children.filter((child): child is Node | string => !!child));
  if (at >= 0) (host.contains(focused) ? focused : controls()[at])?.focus({ preventScroll: true });
}

/** The element of the page with a name. */
export function named<T extends Element = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as unknown as T;
}

/** Calls at most once a frame. */
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

/** Saves a file as the visitor's browser saves files. */
export function save(blob: Blob, name: string) {
  const link = h("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  URL.revokeObjectURL(link.href);
}
