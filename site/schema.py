"""A page of reference from a JSON schema: a table of fields for each definition."""

import re
from collections.abc import Iterator
from typing import Any

Schema = dict[str, Any]

#: Constraints of a number, with the words before their value.
LIMITS = {"minimum": "at least", "exclusiveMinimum": "more than", "maximum": "at most"}


class Page:
    """The page about a schema. Definitions whose names begin with ``skipped`` are left out."""

    def __init__(self, schema: Schema, skipped: str) -> None:
        self.schema = schema
        self.skipped = skipped

    def text(self, title: str) -> str:
        documents = kind_of({"anyOf": self.schema["anyOf"]})
        text = [f"# {title}", "", cell(self.schema["description"]), ""]
        text += [f"A document is one of: {documents}.", ""]
        for name, value in self.schema["$defs"].items():
            if not name.startswith(self.skipped):
                text += [f"## {name}", "", *self.definition(value), ""]
        return "\n".join(text)

    def definition(self, value: Schema) -> list[str]:
        text = [cell(value["description"]), ""] if "description" in value else []
        rows = list(self.fields(value))
        if not rows:
            return [*text, f"Type: {kind_of(value)}."]
        text += ["| field | type | meaning |", "|---|---|---|"]
        text += [f"| `{field}` | {kind} | {meaning} |" for field, kind, meaning in rows]
        for rule in value.get("allOf", []):
            outcome = rule.get("if", {}).get("properties", {}).get("outcome")
            present = rule.get("then", {}).get("required")
            if outcome and present:
                text += ["", f"With outcome {kind_of(outcome)}: {', '.join(map(code, present))}."]
        return text

    def fields(self, schema: Schema, prefix: str = "") -> Iterator[tuple[str, str, str]]:
        """Yields path, type and meaning of each field, those of nested objects after their own."""
        if "items" in schema:
            yield from self.fields(schema["items"], f"{prefix}[]")
        for branch in schema.get("oneOf", []) + schema.get("anyOf", []):
            yield from self.fields(branch, prefix)
        required = schema.get("required", [])
        for name, value in schema.get("properties", {}).items():
            value = self.resolved(value)
            path = f"{prefix}.{name}".removeprefix(".")
            kind = kind_of(value) + ("" if name in required else ", optional")
            yield path, kind, cell(value.get("description", ""))
            yield from self.fields(value, path)

    def resolved(self, value: Schema) -> Schema:
        """Returns the schema of a field, which may be a field of another definition."""
        path = value.get("$ref", "").removeprefix("#/").split("/")
        if len(path) <= 2:
            return value
        named = self.schema
        for name in path:
            named = named[name]
        return named | {key: kept for key, kept in value.items() if key != "$ref"}


def kind_of(schema: Schema) -> str:
    """Returns the type of a value in words, with links to the definitions that it names."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return f"[{name}](#{name.replace('_', '-')})"
    if "const" in schema:
        return code(schema["const"])
    if "enum" in schema:
        return " or ".join(map(code, schema["enum"]))
    for choice in ("oneOf", "anyOf"):
        if choice in schema and "properties" not in schema:
            return " or ".join(dict.fromkeys(map(kind_of, schema[choice])))
    kinds = schema.get("type", "object" if "properties" in schema else "any value")
    kinds = kinds if isinstance(kinds, list) else [kinds]
    if "array" in kinds:
        count, most = schema.get("minItems"), schema.get("maxItems")
        item = schema.get("items")
        of = kind_of(item) if isinstance(item, dict) else "any value"
        of = f"({of})" if " or " in of else of
        exact = f"{count} " if count and count == most else ""
        kinds = [f"list of {exact}{of}", *(kind for kind in kinds if kind != "array")]
    limits = ", ".join(f"{words} {schema[key]}" for key, words in LIMITS.items() if key in schema)
    return " or ".join(kinds) + (f", {limits}" if limits else "")


def code(value: Any) -> str:
    return "null" if value is None else f"`{value}`"


def cell(text: str) -> str:
    """Returns text for a cell of a table, with options of the command line as code."""
    text = re.sub(r"(?<![`\w-])--[a-z-]+", r"`\g<0>`", text)
    return text.replace("|", "\\|").replace("\n", " ")
