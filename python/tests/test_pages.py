"""Examples of the documentation and of the package, run as printed."""

import doctest
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

import softlimb

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "docs" / "guide" / "python.md", ROOT / "python" / "README.md"]
# The node needs ROS 2: `test_ros2` runs it.
EXAMPLES = sorted(path for path in (ROOT / "python" / "examples").glob("*.py") if path.stem != "ros2_node")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_examples_of_a_page_print_what_it_shows(page, tmp_path, monkeypatch):
    blocks = re.findall(r"^```pycon\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert blocks, "the page has no examples"
    # Scenes are named from the root of the repository; what is written lands elsewhere.
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, page.name, str(page), 0)
    assert test.examples
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    assert runner.run(test).failed == 0


def test_examples_of_docstrings_print_what_they_show():
    modules = [importlib.import_module(f"softlimb.{path.stem}") for path in Path(softlimb.__file__).parent.glob("*.py")]
    results = [doctest.testmod(module) for module in [softlimb, *modules]]
    assert sum(result.attempted for result in results) > 0
    assert sum(result.failed for result in results) == 0


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(example, tmp_path):
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    done = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout
