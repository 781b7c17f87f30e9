"""The tables of the documents say what the code says now."""

from __future__ import annotations

import pytest

from docs.__main__ import DOCUMENTS, HERE, written
from docs.markers import markdown, with_tables


@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_tables_are_what_the_command_writes(document):
    assert (HERE / document).read_text(encoding="utf-8") == written(document), "run `make docs`"


def test_a_table_stands_between_its_markers_and_nothing_else_changes():
    text = "before\n<!-- table: one -->\nold\n<!-- end -->\nafter\n"
    table = markdown(("a", "b"), [("|x|", "")])
    new = with_tables(text, {"one": lambda: table})
    assert new == "before\n<!-- table: one -->\n\n| a | b |\n| --- | --- |\n| \\|x\\| | |\n\n<!-- end -->\nafter\n"
    assert with_tables(new, {"one": lambda: table}) == new


@pytest.mark.parametrize("names", [[], ["one", "two"], ["other"]])
def test_a_document_and_its_tables_must_name_each_other(names):
    with pytest.raises(ValueError, match="has the tables"):
        with_tables("<!-- table: one -->\n<!-- end -->\n", dict.fromkeys(names, str))
