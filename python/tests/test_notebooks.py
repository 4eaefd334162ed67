"""The notebooks of the tutorials, executed cell by cell, beside the figures that the tutorials state."""

import ast
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TUTORIALS = ROOT / "docs" / "tutorial"
NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))


def executed(notebook):
    """The names of a notebook behind its last cell. As in Jupyter, the value of a last expression is shown."""
    names = {"__name__": "__main__"}
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]), cell["id"])
        shown = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, cell["id"], "exec"), names)
        if shown is not None:
            repr(eval(compile(ast.Expression(shown.value), cell["id"], "eval"), names))
    return names


def stated(page, pattern):
    """Numbers that a tutorial states."""
    [found] = re.findall(pattern, (TUTORIALS / page).read_text(encoding="utf-8"), re.MULTILINE)
    return [float(number) for number in ([found] if isinstance(found, str) else found)]


def first_run(names):
    tip = names["result"]["tip"]
    for key, row in (("error_m", "tip position, mm"), ("tracking_error_m", "tip position by pressure tracking alone, mm")):
        found = [1e3 * tip[key]["rmse"], 1e3 * tip[key]["max"]]
        assert found == pytest.approx(stated("first-run.md", rf"^{row} +(\S+) +(\S+)$"), abs=0.006)
    assert 1e3 * names["error"].max() == pytest.approx(1e3 * tip["error_m"]["max"], abs=0.5)
    assert "1000 deg" in str(names["refused"])
    one, other, again = names["errors_mm"]
    assert one == again != other


def your_own_actuator(names):
    page = "your-own-actuator.md"
    [modulus] = stated(page, r"^shear_modulus +(\d\S+) ")
    assert 1e-6 * names["MU"] == pytest.approx(modulus, abs=1e-7)
    for pressure, bend in names["table"]["bend, deg"].items():
        assert bend == pytest.approx(stated(page, rf"^ +{pressure:.3f} +\S+ +8.0000 +0.000 +(\S+) ")[0], abs=0.01)
    values = [estimate["value"] for estimate in names["fitted"]["estimates"]]
    [fitted] = stated(page, r"^shear_modulus of finger, MPa +(\S+) ")
    [offset] = stated(page, r"^pressure_offset of finger, Pa +(\S+) ")
    assert values == pytest.approx([1e6 * fitted, offset], rel=1e-5)


def a_limb_for_your_task(names):
    page = "a-limb-for-your-task.md"
    for module in names["checked"]["modules"]:
        [pressure] = stated(page, rf"^  {module['name']} +up to +(\S+) kPa of")
        assert 1e-3 * module["highest_pressure_pa"] == pytest.approx(pressure, abs=0.006)
    assert [1e3 * names["tip"]["error_m"][key] for key in ("rmse", "max")] == pytest.approx(
        stated(page, r"^The tip error of this run is (\S+) mm RMS over the whole path, and (\S+) mm at most"), abs=0.06
    )
    before, after = stated(page, r"^from (\S+) to (\S+) mm RMS, at the targets only")
    assert (names["before"], names["after"]) == (pytest.approx(before, abs=0.06), pytest.approx(after, abs=0.006))
    for phase in names["statics"]["phases"]:
        [deflection] = stated(page, rf"^{phase['name']} +0.00 +\S+ \S+ \S+ +\S+ +(\S+) ")
        assert 1e3 * phase["deflection_m"] == pytest.approx(deflection, abs=0.06)


def the_device(names):
    assert "no difference" in names["replayed"].output
    assert list(names["runs"]) == ["here"]
    link = names["runs"]["here"]["link"]
    sent = names["sent"]
    assert (sent["to_device"], sent["to_host"]) == (link["bytes_sent"], link["bytes_received"])


CHECKS = {
    "1-first-run": first_run,
    "2-your-own-actuator": your_own_actuator,
    "3-a-limb-for-your-task": a_limb_for_your_task,
    "4-the-device": the_device,
}


def test_every_tutorial_has_a_notebook():
    assert [notebook.stem for notebook in NOTEBOOKS] == sorted(CHECKS)
    summary = (ROOT / "docs" / "SUMMARY.md").read_text(encoding="utf-8")
    pages = re.findall(r"\(tutorial/(\S+?)\)", summary)
    assert len(pages) == len(NOTEBOOKS)
    for page, notebook in zip(pages, NOTEBOOKS, strict=True):
        assert f"../../docs/tutorial/{page}" in notebook.read_text(encoding="utf-8")
        assert notebook.name in (TUTORIALS / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_stored_without_outputs(notebook):
    stored = json.loads(notebook.read_text(encoding="utf-8"))
    assert (stored["nbformat"], stored["nbformat_minor"]) == (4, 5)
    identifiers = [cell["id"] for cell in stored["cells"]]
    assert len(set(identifiers)) == len(identifiers)
    for cell in stored["cells"]:
        assert cell["cell_type"] in ("code", "markdown") and isinstance(cell["source"], list)
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None


# The figures of others warn as their versions like.
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_gives_the_figures_of_its_tutorial(notebook, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib").use("agg")
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    CHECKS[notebook.stem](executed(notebook))
