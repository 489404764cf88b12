"""Tests audits: columns as on the command line, and refusals."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from test_assemblies import GEARBOX, cuboid

from colltrans import Assembly, InputError, check
from colltrans.assembly import audit
from colltrans.errors import AssemblyError


def test_columns_equal_those_of_the_command_line(cli: Path) -> None:
    command: list[str | Path] = [cli, "audit", GEARBOX, "--within", "0.5", "--json"]
    told = subprocess.run(command, check=False, capture_output=True, text=True)
    assert told.returncode == 1, told.stderr
    known = json.loads(told.stdout)
    found = audit(GEARBOX, 0.5)
    assert (found.examined, found.ignored) == (known["counts"]["examined"], 0)
    assert len(found) == len(known["pairs"]) > 0
    for k, pair in enumerate(known["pairs"]):
        assert [found.parts[found.first[k]], found.parts[found.second[k]]] == pair["parts"]
        assert found.finding[k] == pair["finding"]
        assert found.violation[k] == pair["violation"]
        lengths = ("clearance", "tolerance", "distance", "depth", "wall", "least_tolerance")
        for name in (*lengths, "volume", "translation"):
            value = getattr(found, name)[k]
            if name in pair:
                assert value.tolist() == pair[name]
            else:
                assert np.isnan(value).all()
        assert found.role[k] == pair.get("role", "")
        assert (found.inner[k] < 0) == ("inner" not in pair)
        if "points" in pair:
            assert [found.point[k].tolist(), found.other_point[k].tolist()] == pair["points"]


def test_boxes_interfere_touch_or_are_near() -> None:
    parts = {
        "a": cuboid([0, 0, 0], [1, 1, 1]),
        "over": cuboid([0.75, 0, 0], [2, 1, 1]),
        "on": cuboid([0, 0, 1], [1, 1, 2]),
        "near": cuboid([-1.5, 0, 0], [-0.5, 1, 1]),
        "grain": cuboid([0.25, 0.25, 0.25], [0.5, 0.5, 0.5]),
    }
    found = audit(parts, 0.75)
    pairs = list(zip(found.first.tolist(), found.second.tolist(), strict=True))
    assert pairs[:2] == [(0, 1), (0, 4)]
    assert found.finding[:2].tolist() == ["interfering", "contained"]
    assert found.inner[:2].tolist() == [-1, 4]
    np.testing.assert_allclose(found.depth[0], 0.25)
    assert found.wall[1, 0] <= 0.25 <= found.wall[1, 1] <= 0.25 + 1e-9
    ends = found.wall_point[1] - found.other_wall_point[1]
    np.testing.assert_allclose(np.linalg.norm(ends), 0.25)
    assert np.isnan(np.delete(found.wall, 1, axis=0)).all()
    np.testing.assert_allclose(found.volume[:2].mean(axis=1), [0.25, 1 / 64], rtol=0.01)
    at = pairs.index((0, 3))
    assert found.finding[at] == "apart" and found.violation[at]
    assert found.distance[at, 0] <= 0.5 <= found.distance[at, 1]
    assert found.finding[pairs.index((0, 2))] == "touching"
    assert len(found.violations()) == int(found.violation.sum())
    # Levels replace the clearance, roles remove it.
    assembly = Assembly(parts).with_pair("a", "over", tolerance=0.3)
    relaxed = assembly.audit(0.75, levels={("*", "near"): 0.5}, allow_contact=True)
    assert ("a", "near") not in relaxed.violations()
    assert ("a", "over") not in relaxed.violations()
    assert ("a", "grain") in relaxed.violations()
    pressed = Assembly(parts).with_pair("a", "over", role="press", tolerance=0.3).audit()
    at = list(zip(pressed.first.tolist(), pressed.second.tolist(), strict=True)).index((0, 1))
    assert (pressed.role[at], pressed.tolerance[at]) == ("press", 0.3)


def test_proofs_of_all_pairs_are_checked(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    names = ["../up", "a/b", "a_b", "\0", "größe", "CON", "x" * 300]
    boxes = [
        cuboid([0, 0, 0], [1, 1, 1]),
        cuboid([0.75, 0, 0], [2, 1, 1]),
        cuboid([0, 0, 1], [1, 1, 2]),
        cuboid([-1.5, 0, 0], [-0.5, 1, 1]),
        cuboid([0.25, 0.25, 0.25], [0.5, 0.5, 0.5]),
        cuboid([3, 0, 0], [4, 1, 1]),
        cuboid([3, 0, 0.5], [4, 1, 2]),
    ]
    folder = tmp_path / "proofs"
    found = audit(dict(zip(names, boxes, strict=True)), 0.75, proofs=folder)
    files = [folder / name for of in found.proofs for name in of.values()]
    assert sorted(files) == sorted(folder.iterdir())
    assert [path.name[0] for path in tmp_path.iterdir()] == ["p"]
    kinds = {
        "apart": {"distance"},
        "touching": {"distance", "depth"},
        "contained": {"depth", "common_part"},
        "interfering": {"depth", "common_part"},
    }
    for kind, of in zip(found.finding, found.proofs, strict=True):
        assert set(of) == kinds[kind]
    assert set(found.finding) == set(kinds)
    assert not any(found.unproven) and not found.open_shells.any()
    for path in files:
        report = check.check(path.read_text(encoding="utf-8"))
        assert report.holds
    assert check.main([str(path) for path in files]) in (0, 7)
    assert capfd.readouterr().out.count(": holds: ") >= len(files)
    (folder / "bad.json").write_text("{}")
    assert check.main([str(path) for path in sorted(folder.iterdir())]) == 3
    with pytest.raises(InputError, match="not empty"):
        audit(dict(zip(names, boxes, strict=True)), proofs=folder)
    assert audit(dict(zip(names, boxes, strict=True))).proofs == ({},) * 5


def test_pairs_have_the_open_shells_of_their_parts() -> None:
    sheet = ([[-1, -1, 0.5], [2, -1, 0.5], [2, 2, 0.5], [-1, 2, 0.5]], [[0, 1, 2], [0, 2, 3]])
    found = audit({"cube": cuboid([0, 0, 0], [1, 1, 1]), "wall": sheet})
    assert found.finding.tolist() == ["interfering"]
    assert found.open_shells.tolist() == [[False, True]]


def test_invalid_arguments_are_refused() -> None:
    parts = {"a": cuboid([0, 0, 0], [1, 1, 1])}
    with pytest.raises(AssemblyError, match="clearance"):
        audit(parts, -1.0)
    with pytest.raises(AssemblyError, match="unknown part b"):
        audit(parts, levels={("a", "b"): 1.0})
    with pytest.raises(AssemblyError, match="tolerance"):
        audit(parts, tolerance=-1.0)
    with pytest.raises(InputError):
        audit(3)  # type: ignore[arg-type]
    assert len(audit(parts, 10.0)) == 0
