// Builds the types of answers, src/answers.ts, from their schema; the file is not committed.

import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { compile } from "json-schema-to-typescript";

const here = dirname(fileURLToPath(import.meta.url));
const schema = JSON.parse(readFileSync(join(here, "../docs/answers.schema.json"), "utf8"));
// Types do not express which fields belong to which outcome.
for (const of of Object.values(schema.$defs)) delete of.allOf;
const names = Object.keys(schema.$defs).filter((name) => name !== "fields");
// A reference with a description would become a type of its own.
const plain = JSON.parse(JSON.stringify(schema), (_, value) => (value?.$ref ? { $ref: value.$ref } : value));
const text = await compile({ $defs: plain.$defs, anyOf: names.map((name) => ({ $ref: `#/$defs/${name}` })) }, "Anything", {
  additionalProperties: false,
  format: false,
  bannerComment: "// Made by types.mjs of docs/answers.schema.json.",
});
writeFileSync(join(here, "src/answers.ts"), text);
