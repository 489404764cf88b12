// The types of answers, from their schema: src/answers.ts, which is not kept.

import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { compile } from "json-schema-to-typescript";

const here = dirname(fileURLToPath(import.meta.url));
const schema = JSON.parse(readFileSync(join(here, "../docs/answers.schema.json"), "utf8"));
// Which fields go with which outcome is not said by types.
for (const of of Object.values(schema.$defs)) delete of.allOf;
const names = Object.keys(schema.$defs).filter((name) => name !== "fields");
// A reference with a description of its own would be a type of its own.
const plain = JSON.parse(JSON.stringify(schema), (_, value) => (value?.$ref ? { $ref: value.$ref } : value));
const text = await compile({ $defs: plain.$defs, anyOf: names.map((name) => ({ $ref: `#/$defs/${name}` })) }, "Anything", {
  additionalProperties: false,
  format: false,
  bannerComment: "// Made by types.mjs of docs/answers.schema.json.",
});
writeFileSync(join(here, "src/answers.ts"), text);
