"""Finds broken links in a folder of pages, and files that pages would fetch from other sites.

``python site/links.py FOLDER``. Links to other sites are not followed, so no network is needed.
"""

import re
import sys
from functools import cache
from html import unescape
from pathlib import Path
from urllib.parse import unquote, urlsplit

TAG = re.compile(r"<(a|link|script|img|iframe|source)\b([^>]*)>", re.IGNORECASE)
TARGET = re.compile(r"""\b(?:href|src)\s*=\s*(?:"([^"]*)"|'([^']*)')""", re.IGNORECASE)
NAME = re.compile(r"""\b(?:id|name)\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s"'>]+))""")
#: Source code of Rust: its pages are not checked, because scripts handle their links to lines.
SOURCES = re.compile(r"rust/src/")
#: A page of Rust's documentation that redirects, by a script that keeps the fragment.
LEADS_ON = re.compile(
    r'<meta http-equiv="refresh" content="0;URL=([^"]+)">.*location\.hash', re.DOTALL
)


def wrong(folder: Path) -> list[str]:
    """Returns a line for each broken link: the page, the link and the fault."""
    folder = folder.resolve()

    @cache
    def names(file: Path) -> set[str]:
        found = NAME.finditer(file.read_text(errors="replace"))
        return {unescape(next(filter(None, match.groups()), "")) for match in found}

    faults = []
    for file in sorted(folder.rglob("*.html")):
        page = file.relative_to(folder).as_posix()
        if SOURCES.match(page):
            continue
        for kind, target in targets(file.read_text(errors="replace")):
            why = fault(folder, file, kind, target, names)
            if why is not None:
                faults.append(f"{page}: {target}: {why}")
    return faults


def targets(text: str) -> set[tuple[str, str]]:
    text = re.sub(
        r"<(script|style)\b([^>]*)>.*?</\1>", r"<\1\2>", text, flags=re.DOTALL | re.IGNORECASE
    )
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    found = set()
    for tag in TAG.finditer(text):
        match = TARGET.search(tag[2])
        if match is not None:
            found.add((tag[1].lower(), unescape(match[1] or match[2] or "")))
    return found


def fault(folder: Path, file: Path, kind: str, target: str, names) -> str | None:  # type: ignore[no-untyped-def]
    """Returns the fault of a link, or None."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        fetched = kind != "a" and parts.scheme in ("http", "https", "")
        return "is fetched from elsewhere" if fetched else None
    led = file if not parts.path else Path(file.parent, unquote(parts.path)).resolve()
    if led.is_dir():
        led = led / "index.html"
    if not led.is_relative_to(folder):
        return "leads out of the site"
    if not led.is_file():
        return "leads nowhere"
    fragment = unquote(parts.fragment)
    if not fragment or led.suffix != ".html" or SOURCES.match(led.relative_to(folder).as_posix()):
        return None
    if (on := LEADS_ON.search(led.read_text(errors="replace"))) is not None:
        led = Path(led.parent, unquote(on[1])).resolve()
    # Fragments of the interactive page are queries, not places.
    if "page/" in led.relative_to(folder).as_posix() or {fragment, parts.fragment} & names(led):
        return None
    return f"there is no place #{fragment}"


if __name__ == "__main__":
    found = wrong(Path(sys.argv[1]))
    print("\n".join(found) or "every link leads somewhere")
    sys.exit(bool(found))
