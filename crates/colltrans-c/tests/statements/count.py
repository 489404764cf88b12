#!/usr/bin/env python3
"""Counts the statements of the tasks, and prints the table of docs/guide/c-and-cpp.md.

Semicolons count, and heads of loops and conditions; braces and headers of functions do not.
"""

import re
from pathlib import Path

HERE = Path(__file__).parent
FILES = ["colltrans", "fcl", "coal"]


def statements(code: str) -> int:
    """Returns the number of statements."""
    code = re.sub(r"//.*", "", code)
    code, loops = re.subn(r"\bfor \([^;{}]*;[^;{}]*;[^;{}]*?\)(?= )", "", code)
    code, heads = re.subn(r"\b(for|if|while) \(", "(", code)
    return loops + heads + code.count(";")


def tasks(file: str) -> dict[str, int]:
    """Returns the number of statements of each task."""
    parts = re.split(r"^// (?:task: (.*)|end)$", (HERE / f"{file}.cpp").read_text(), flags=re.M)
    codes = zip(parts[1::2], parts[2::2], strict=True)
    return {name: statements(code) for name, code in codes if name}


def main() -> None:
    columns = [tasks(file) for file in FILES]
    for name in columns[0]:
        print(f"| {name} | {' | '.join(str(column[name]) for column in columns)} |")


if __name__ == "__main__":
    main()
