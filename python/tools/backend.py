"""The build backend: maturin, with docstrings in the stub of the wheels that it builds."""

from pathlib import Path
from typing import Any

import maturin
from docstrings import write_docstrings
from maturin import (  # noqa: F401
    build_editable,
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)


def build_wheel(folder: str, config: dict[str, Any] | None = None, metadata: Any = None) -> str:
    """Builds a wheel in a folder, and returns its name."""
    name: str = maturin.build_wheel(folder, config, metadata)
    write_docstrings(Path(folder) / name)
    return name
