"""Runs the notebooks and compares their text outputs with the kept ones in ``outputs.json``.

``python site/outputs.py`` reports each cell whose output differs, ``--keep`` writes the new
outputs. Pictures, HTML and standard error are not compared.
"""

import argparse
import json
import re
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).resolve().parent
KEPT = HERE / "notebooks" / "outputs.json"
#: Durations, addresses and rates differ from run to run.
VARIES = re.compile(r"0x[0-9a-f]+|\d[\d.,]* ?(s|ms|rows/s)\b|/tmp/[\w/]+")


def executed(file: Path) -> Any:
    """Runs a notebook at the root of the checkout. A cell that fails raises its error."""
    book = nbformat.read(file, as_version=4)
    where = {"metadata": {"path": str(HERE.parent)}}
    NotebookClient(book, timeout=300, resources=where).execute()
    return book


def text_outputs(book: Any) -> dict[str, str]:
    """Returns the text that each cell printed or evaluated to, by the name of the cell."""
    return {
        cell["id"]: "".join(_text(output) for output in cell["outputs"])
        for cell in book["cells"]
        if cell["cell_type"] == "code"
    }


def _text(output: Any) -> str:
    if output["output_type"] == "stream":
        text = output["text"] if output["name"] == "stdout" else ""
    else:
        data = output.get("data", {})
        text = "" if "image/png" in data else data.get("text/plain", "")
    return VARIES.sub("...", text)


def differences(name: str, book: Any) -> list[str]:
    """Returns a line for each cell whose text output is not the kept one."""
    kept = json.loads(KEPT.read_text()).get(name, {})
    found = text_outputs(book)
    return [
        f"{name}: {cell}: {found.get(cell)!r}, kept is {kept.get(cell)!r}"
        for cell in sorted(found.keys() | kept.keys())
        if found.get(cell) != kept.get(cell)
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keep", action="store_true", help="write the outputs")
    keep = parser.parse_args().keep
    books = {file.stem: executed(file) for file in sorted(KEPT.parent.glob("*.ipynb"))}
    if keep:
        outputs = {name: text_outputs(book) for name, book in books.items()}
        KEPT.write_text(json.dumps(outputs, indent=1, ensure_ascii=False) + "\n")
        return
    wrong = [line for name, book in books.items() for line in differences(name, book)]
    raise SystemExit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()
