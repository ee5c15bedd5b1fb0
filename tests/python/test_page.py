"""The code of docs/python.md, from top to bottom."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_the_code_of_the_page_runs(tmp_path, monkeypatch):
    page = (ROOT / "docs" / "python.md").read_text()
    (tmp_path / "systems").symlink_to(ROOT / "systems")
    monkeypatch.chdir(tmp_path)
    names = {}
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", page, re.S | re.M))
    assert len(blocks) > 5
    for block in blocks:
        line = page[:block.start(1)].count("\n")
        exec(compile("\n" * line + block.group(1), "docs/python.md", "exec"), names)
    assert (tmp_path / "fall.svg").exists()
