"""Shared helpers for files of queries: bodies, random queries from a seed, shards."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

KEYS = ["cube", "cloud", "broken"]
CORNERS = np.stack(np.meshgrid([0.0, 1], [0.0, 1], [0.0, 1]), axis=-1).reshape(-1, 3)


def write_bodies(path: Path) -> Path:
    cloud = np.random.default_rng(1).normal(size=(60, 3))
    vertices = [CORNERS.tolist(), cloud.tolist(), [[0.0, 0.0, float("nan")]]]
    pq.write_table(pa.table({"key": KEYS, "vertices": vertices}), path)
    return path


def queries(seed: int, n: int) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    turns = random.normal(size=(n, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    poses = np.hstack([random.normal(size=(n, 3)) + [0, 0, 6], turns])
    return {
        "id": [f"{seed}-{i}" for i in range(n)],
        "moving": [KEYS[i % 2] for i in range(n)],
        "fixed": ["cloud"] * n,
        "moving_pose": poses,
        "direction": random.normal(size=(n, 3)) * [0.1, 0.1, 1] - [0, 0, 1],
    }


def table_of(columns: dict[str, Any]) -> Any:
    def arrow(column: Any) -> Any:
        if isinstance(column, np.ndarray) and column.ndim == 2:
            flat = pa.array(column.reshape(-1))
            return pa.FixedSizeListArray.from_arrays(flat, column.shape[1])
        return pa.array(column)

    return pa.table({name: arrow(column) for name, column in columns.items()})


def write(path: Path, columns: dict[str, Any], **options: Any) -> Path:
    path.parent.mkdir(exist_ok=True, parents=True)
    pq.write_table(table_of(columns), path, **options)
    return path


def shards(folder: Path, count: int, rows: int) -> Path:
    for k in range(count):
        write(folder / f"shard-{k}.parquet", queries(k, rows))
    return folder


def same(one: Any, other: Any) -> bool:
    """Compares two tables; missing numbers are equal."""
    return bool(one.schema == other.schema) and str(one.to_pylist()) == str(other.to_pylist())


def ids(folder: Path) -> list[str]:
    return sorted(
        id for file in folder.rglob("*.parquet") for id in pq.read_table(file)["id"].to_pylist()
    )


def all_ids(count: int, rows: int) -> list[str]:
    return sorted(f"{k}-{i}" for k in range(count) for i in range(rows))
