"""``python check_lines.py CHECK_PY``: checks many proofs in one process.

Each line of standard input is a proof; each line of the output is the exit code of ``check.py`` for it, a tab, and the
first reason. 9 stands for an error that is not one of a proof: a fault of the checker.
"""

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any


def load(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location("colltrans_check", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def remembered(convex_data: Any) -> Any:
    """Returns the check of a convex body, which skips recently checked bodies: most mutants do not change them."""
    known: dict[str, Any] = {}

    def check(points: Any, content: Any) -> Any:
        name = json.dumps(content)
        if name not in known:
            found = convex_data(points, content)
            if len(known) > 64:
                known.clear()
            known[name] = found
        return known[name]

    return check


def verdict(check: Any, text: str) -> tuple[int, str]:
    try:
        report = check.check(text)
    except check.NoProofError as error:
        return 3, str(error)
    except check.RefusedError as error:
        return 6, str(error)
    except Exception as error:  # noqa: BLE001 - it is what the campaign looks for
        return 9, f"{type(error).__name__}: {error}"
    if not report.holds:
        return 1, "nothing that can be checked"
    return (7 if report.partly else 0), ""


def main() -> None:
    check = load(Path(sys.argv[1]))
    check.convex_data = remembered(check.convex_data)
    for line in sys.stdin:
        code, why = verdict(check, line.rstrip("\n"))
        print(code, why.replace("\n", " ")[:200], sep="\t", flush=True)


if __name__ == "__main__":
    main()
