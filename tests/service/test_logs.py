"""Every line of the log is one JSON object, which names the job it is about."""

from __future__ import annotations

import json
import logging

import pytest

from service.logs import Json, about


@pytest.fixture
def lines(caplog):
    """What was logged, as the service writes it."""

    def written() -> list[dict]:
        return [json.loads(Json().format(record)) for record in caplog.records]

    caplog.set_level("INFO")
    return written


def test_a_line_tells_time_level_logger_and_message(lines):
    logging.getLogger("service.jobs").warning("the broker took %d of\n%s", 3, "four")
    [line] = lines()
    assert (line["level"], line["logger"], line["message"]) == ("warning", "service.jobs", "the broker took 3 of\nfour")
    assert line["time"].endswith("+00:00") and set(line) == {"time", "level", "logger", "message"}


def test_what_is_added_is_told(lines):
    logging.getLogger("x").info("refused", extra={"problem": "foreign_host"})
    assert lines()[0]["problem"] == "foreign_host"


def test_a_line_is_one_line_even_with_an_exception():
    try:
        raise ValueError("two\nlines")
    except ValueError as error:
        caught = (ValueError, error, error.__traceback__)
        record = logging.LogRecord("x", logging.ERROR, "x.py", 1, "failed", (), caught)
    text = Json().format(record)
    assert "\n" not in text and "ValueError: two\nlines" in json.loads(text)["exception"]


def test_lines_about_a_job_name_it_and_its_epoch(caplog, lines):
    with about(job="01j", epoch=3):
        inside = Json().format(logging.makeLogRecord({"msg": "claimed"}))
    outside = Json().format(logging.makeLogRecord({"msg": "idle"}))
    assert (json.loads(inside)["job"], json.loads(inside)["epoch"]) == ("01j", 3)
    assert "job" not in json.loads(outside)
