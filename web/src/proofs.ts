// The proof between solids as text; loaded with the first answer between solids.

import type { Certificate, PageClaims, PageSolid } from "./answers";
import { h } from "./dom";
import { plane } from "./engine";
import { short } from "./math";
import type { Shown } from "./panel";

/** Draws both bounds. */
type Bounds = (proof: Pick<Certificate, "lower" | "upper" | "rounding">) => Element;

/** Describes the proof between solids: the facets that stop the body, and why no other pair stops it earlier. */
export function solidProof(answer: PageSolid, { solidProof: proof, bodies }: Shown, bounds: Bounds): Element[] {
  const text = (...children: (string | HTMLElement)[]) => h("p", { class: "proof" }, ...children);
  const shorter = plane(answer)?.margin ? [text("A plane parallel to d separates the bodies: a shorter proof, which is checked too.")] : [];
  if (!proof) return [text("A list of claims that covers all pairs of facets. It is built on request."), ...shorter];
  const pairs = (bodies.moving?.body.facts.triangles ?? 0) * (bodies.fixed?.body.facts.triangles ?? 0);
  const all = `all ${pairs.toLocaleString("en")} pairs of triangles`;
  const { stop, start, lower, tolerance } = proof.proof.clearance;
  if (start !== "assumed" && !("apart" in start)) {
    const how = "facets" in start ? `around triangles ${start.facets.join(" and ")}`
      : `a shell of the ${"moving_inside" in start ? "moving" : "fixed"} body is inside the other`;
    return [text(`They overlap at the start: ${how}.`), ...(proof.claims.length ? [text(`Claims about ${all}:`), table(proof.claims, pairs)] : [])];
  }
  return [
    ...(stop ? [bounds({ lower: lower ?? 0, upper: stop.distance, rounding: Math.abs(stop.distance - (lower ?? 0)) })] : []),
    text(`Of ${all} none stops the moving body ${lower === null ? "ever" : "before "}`, ...(lower === null ? [] : [h("b", {}, String(lower))]),
      ...(stop ? [`; triangles ${stop.triangles.join(" and ")} do at `, h("b", {}, String(stop.distance))] : []), tolerance ? `, both bodies being shrunk by half of ${short(tolerance, 3)}.` : "."),
    table(proof.claims, pairs),
    ...(proof.start_claims ? [text("Claims that they do not overlap at the start:"), table(proof.start_claims, pairs)] : []),
    ...shorter,
  ];
}

function table(claims: PageClaims[], pairs: number): HTMLElement {
  return h("dl", { class: "claims" }, ...claims.flatMap(({ because, given, pairs: of }) => [
    h("dt", {}, because), h("dd", {}, `${given.toLocaleString("en")} claim${given === 1 ? "" : "s"}, ${short((100 * of) / (pairs || 1), 3)} %`),
  ]));
}
