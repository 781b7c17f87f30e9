"""The load benchmark's table: what it tells is computed from what was measured."""

from __future__ import annotations

import pytest

from benchmarks.load.table import Row, table


def test_a_ratio_is_that_of_the_medians_and_not_of_what_is_shown_of_them():
    alone = Row("status", [1.4e-6] * 3)
    queued = Row("status, queued", [1.6e-6] * 3, control=alone)
    assert queued.cells()["p50 ms"] == alone.cells()["p50 ms"] == "0.00"
    assert queued.ratio == pytest.approx(1.6 / 1.4)


def test_a_quantile_is_one_of_the_latencies_in_whatever_order_they_came():
    row = Row("status", [0.003, 0.001, 0.002])
    assert (row.quantile(0.0), row.quantile(0.5), row.quantile(0.99)) == (0.001, 0.002, 0.003)


def test_a_column_in_which_nothing_stands_is_left_out():
    head, _, line, other = table([Row("status", [0.001], "p99 <= 20 ms"), Row("case", [0.001], cpu=0.002)])
    assert head == "| what | n | p50 ms | p99 ms | CPU ms | aim |"
    assert (line, other) == ("| status | 1 | 1.00 | 1.0 |  | p99 <= 20 ms |", "| case | 1 | 1.00 | 1.0 | 2.0 |  |")
