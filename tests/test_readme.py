"""What README.md and docs/guide.md name is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from service.cases import CaseSpec, shipped_cases
from service.results.schema import VARIABLES
from service.settings import Settings
from solver import Outcome

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
GUIDE = (ROOT / "docs" / "guide.md").read_text()


def test_every_path_that_the_readme_names_is_there():
    linked = [target for target in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in target]
    folders = [folder for row in re.findall(r"^\| (`.*?`) \|", README, re.M) for folder in re.findall(r"`(.*?)`", row)]
    missing = [path for path in linked + folders if not (ROOT / path).exists()]
    assert linked and folders and not missing
    assert (ROOT / "docs/pictures/goyal-2003-snapshots.png").stat().st_size < 300_000


def test_the_guide_names_every_field_of_a_case():
    schema = CaseSpec.model_json_schema()
    parts = [schema, *schema["$defs"].values()]
    names = {name for part in parts for name in part.get("properties", {})}
    # the eighteen conditions of an end are listed as v1, v2, v3 and so on
    assert [name for name in sorted(names) if not re.search(rf"`[^`]*\b{name}\b[^`]*`", GUIDE)] == []


@pytest.mark.parametrize(
    "names",
    [
        [variable.name for variable in VARIABLES],
        [outcome.value for outcome in Outcome],
        list(Settings().environment()),
        list(shipped_cases()),
    ],
    ids=["variables", "outcomes", "settings", "cases"],
)
def test_the_guide_names_everything(names):
    assert [name for name in names if f"`{name}`" not in GUIDE] == []
