// Answers to the page match docs/answers.schema.json. Needs the example `native` (`.ci/run web` builds it).

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { answers, conform, data } from "../browser.mjs";

/** Returns the answers of the module; each must match the schema `page_` of its question. */
function told(module, questions) {
  const lines = questions.map(({ file, ...question }) => (file ? `${join(data, file)}\t` : "") + JSON.stringify(question));
  return answers(module, lines).map((line, k) => {
    const answer = JSON.parse(line);
    conform(answer.error === undefined ? `page_${questions[k].do}` : "page_error", answer);
    return answer;
  });
}

const load = (slot, name, take) => ({ do: "load", slot, name, take, file: name });
const pair = (at, direction, more = {}) => ({ moving_pose: [...at, 0, 0, 0, 1], fixed_pose: [0, 0, 0, 0, 0, 0, 1], direction, ...more });

test("convex bodies: contact, grazing, separated; proofs", () => {
  const bodies = [load("moving", "dodecahedron.off", "convex"), load("fixed", "bracket.obj", "hull")];
  const asked = [
    pair([6, 1, 9], [-0.3, 0.1, -1]), pair([6, 1, 9], [1, 0, 0]), pair([0, 0, 0], [0, 0, 1]), pair([0, 0, -20], [0, 0, -1]),
    // Any overlap of the shadows is within this tolerance.
    pair([6, 1, 9], [-0.3, 0.1, -1], { graze: 100 }),
  ];
  const casts = told("page", [...bodies, ...asked.map((one) => ({ do: "cast", ...one }))]).slice(2);
  const outcomes = casts.map(({ record, clearance }) => `${record.outcome} ${clearance.outcome}`);
  for (const one of ["contact blocked", "separated separated", "contact overlapping", "contact behind", "grazing slides"]) assert.ok(outcomes.includes(one), outcomes.join());
  const proven = told("page", [...bodies, ...asked.map((one, k) => ({ do: "verify", ...one, proof: casts[k].proof }))]).slice(2);
  assert.ok(proven.every(({ holds }) => holds));
  const { contact } = casts[0].proof;
  const lie = { contact: { ...contact, lower: contact.lower + 1 } };
  assert.equal(told("page", [...bodies, { do: "verify", ...asked[0], proof: lie }])[2].holds, false);
});

test("searches match the schema", () => {
  const bodies = ["dodecahedron.off", "bracket.obj"].map((name, k) => ({ do: "place", slot: ["moving", "fixed"][k], name, take: "convex", file: name }));
  const asked = pair([6, 1, 9], [-0.3, 0.1, -1]);
  const search = { do: "search", ...asked, solver: "cta", start: "center", until: "exit", after: pair([6, 1, 9], [-0.3, 0.101, -1]) };
  const miss = { ...search, ...pair([6, 1, 9], [1, 0, 0]), after: undefined };
  const found = told("found", [...bodies, search, { ...search, solver: "portal" }, { ...search, solver: "portal", after: undefined }, { ...search, start: "ellipsoids", until: 0.2 }, miss]).slice(2);
  assert.ok(found[0].region && found[1].tracked && !found[2].tracked && found[4].events.some(({ touch }) => touch === "separated"));
  const { sections: [moving, fixed], ranges } = found[0].events.find((event) => event.sections);
  const grid = { do: "levels", ...asked, moving_axis: moving, fixed_axis: fixed, moving_levels: ranges[0], fixed_levels: ranges[1] };
  assert.equal(told("found", [...bodies, grid])[2].values, 4);
});

test("answers about solids and open surfaces match the schema", () => {
  const pairs = [["bolt.stl", "solid", "plate.off", "solid"], ["dodecahedron.off", "convex", "plate.off", "solid"], ["bolt.stl", "solid", "plate.off", "open"]];
  const seen = new Set();
  for (const [moving, how, fixed, as] of pairs) {
    const bodies = [load("moving", moving, how), load("fixed", fixed, as)];
    for (const at of [pair([0, 0, 7], [0, 0, -1]), pair([0, 0, 7], [0, 0, 1]), pair([40, 0, 7], [0, 0, -1]), pair([0, 0, 0], [0, 0, 1])]) {
      const [, , cast, certified] = told("page", [...bodies, { do: "cast", ...at }, { do: "certify", ...at }]);
      seen.add(`${cast.record.outcome}${cast.proof ? " by a plane" : ""}`);
      const [, , checked] = told("page", [...bodies, { do: "verify", ...at, proof: certified.proof }]);
      assert.equal(checked.holds, true, checked.because);
    }
  }
  for (const one of ["blocked", "free", "free by a plane", "overlapping"]) assert.ok(seen.has(one), [...seen].join());
});

test("errors match the schema", () => {
  const refused = told("page", [load("moving", "plate.off", "convex"), { do: "cast" }, { do: "cast", ...pair([0, 0, 0], [0, 0, 1]) }, { do: "dance" }]);
  assert.ok(refused.every(({ error }) => error));
  assert.ok(refused[0].instead.includes("solid"));
});

test("assemblies", () => {
  const names = ["bolt_0", "cover", "housing", "shaft"].map((name) => `gearbox_small/${name}.off`);
  const questions = [
    ...names.map((name) => ({ do: "add", name, file: name })), { do: "parts" }, { do: "fit", tolerance: 0.1 }, { do: "along", direction: [0, 0, 1] },
    { do: "along", direction: [1, 0, 0] }, { do: "map", group: [0] }, { do: "plan" },
    { do: "audit", within: 1 },
  ];
  const all = told("assembly", questions);
  assert.ok(all.every(({ error }) => error === undefined), JSON.stringify(all.find(({ error }) => error)));
  assert.ok(all.at(-2).plan.length > 0 && all.at(-1).views.length > 0);
});
