#!/usr/bin/env python3
"""Prints turns of phrase that readers of this field stumble over, in lines that a change adds.

    .ci/prose.py [BASE]     lines added since BASE, a revision of git (default: HEAD~1)

Reads Markdown, and comments and messages of Rust, Python and TypeScript. It refuses nothing: CONTRIBUTING.md has
the rules, and a writer may have a reason. It exits with 0 unless git fails.
"""

import re
import subprocess
import sys

#: A pattern, and what to write in its place.
PHRASES = {
    r"\b(is|are|was|were) (told|said|asked)\b": "reports, returns, computes, queries",
    r"\b(tells|says|asks) (of|that|whether|which|how|what|for)\b": "reports, states, returns, checks",
    r"(^|[.:;] )(What|Who|Whoever|Whatever|Of which) (?![^.]*\?)": "name the thing: 'the remaining cells'",
    r"\b(is|are) (no|none|nothing)\b(?! (longer|more))": "is not a, has no, cannot",
    r"\bso (many|much|long|often) \w": "give the number or the variable",
    r"\b(anew|whoever|wherein|thereby|beside|alike|yonder)\b": "again, any, next to, equal",
    r"\bthe same (of|as of)\b": "repeat the noun",
    r"\b(who|whoever) (asks|reads|calls|keeps|wants|comes|knows)\b": "the caller, the reader, the search",
    r"\bby how much\b|\bas one likes\b|\bin thought\b": "name the quantity; at will",
    r"\b(stands|goes|comes) (on|beside|there|anew|by)\b": "is in, continues, traverses",
}
KINDS = ("*.md", "*.rs", "*.py", "*.ts", "*.mjs")
#: Text of a line of a program: a comment or a string.
TEXT = re.compile(r"(?:///?!?|#:?) (.*)|\"([^\"]{12,})\"")


def added(base: str) -> list[tuple[str, int, str]]:
    """Returns the lines that were added since a revision: file, number, text."""
    command = ["git", "diff", "--unified=0", "--no-color", base, "--", *KINDS]
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    lines, file, number = [], "", 0
    for line in text.splitlines():
        if line.startswith("+++ "):
            file = line[6:]
        elif hunk := re.match(r"@@ -\S+ \+(\d+)", line):
            number = int(hunk[1])
        elif line.startswith("+"):
            lines.append((file, number, line[1:]))
            number += 1
    return lines


def prose(file: str, line: str) -> str:
    """Returns the prose of a line, without code in backquotes."""
    if not file.endswith(".md"):
        found = TEXT.search(line)
        line = next((part for part in found.groups() if part), "") if found else ""
    return re.sub(r"`[^`]*`", "`", line)


def main() -> None:
    base = sys.argv[1] if len(sys.argv) > 1 else "HEAD~1"
    count = 0
    for file, number, line in added(base):
        for pattern, instead in PHRASES.items():
            if found := re.search(pattern, prose(file, line)):
                print(f"{file}:{number}: {found[0].strip()!r}: write {instead}")
                count += 1
    print(f"{count} turns of phrase to reconsider in lines added since {base}")


if __name__ == "__main__":
    main()
