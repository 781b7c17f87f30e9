"""What cannot run here, why, and what is looked at instead."""

from __future__ import annotations

import shutil
import subprocess
import sys
from argparse import REMAINDER, ArgumentParser
from typing import TYPE_CHECKING, Any

import yaml

from deploy.rehearse.compose import services
from service.settings import from_environment
from tests.docs.blocks import ROOT, Block

if TYPE_CHECKING:
    from tests.docs.page import Page


def docker(page: Page, words: list[str], shown: str) -> str:
    """No engine runs here: the rehearsal's reader looks for the services, and what runs in one runs in this process."""
    parser = ArgumentParser(prog="docker compose", exit_on_error=False)
    below = parser.add_subparsers(required=True, dest="command")
    run, up = below.add_parser("run"), below.add_parser("up")
    run.add_argument("--rm", action="store_true", required=True)
    run.add_argument("--volume", default=":")
    run.add_argument("service")
    run.add_argument("words", nargs=REMAINDER)
    for option in ("--build", "--detach"):
        up.add_argument(option, action="store_true")
    up.add_argument("--scale", default="api=1")
    assert words[1] == "compose", words
    parsed = parser.parse_args(words[2:])
    known = services(ROOT / "docker-compose.yml", secrets_of(page))
    if parsed.command == "up":
        assert parsed.scale.partition("=")[0] in known
        return ""
    host, _, inside = parsed.volume.partition(":")
    assert parsed.service in known
    page.run(" ".join(host if inside and word == inside else word for word in parsed.words))
    return ""


def helm(page: Page, words: list[str], shown: str) -> str:
    """There is no cluster: the values are the chart's, and Helm's library makes the objects with them."""
    command, name, chart, option, value = words[1:]
    assert (command, option) == ("install", "--set")
    key, _, text = value.partition("=")
    values: Any = yaml.safe_load((ROOT / chart / "values.yaml").read_text())
    for part in key.split("."):
        assert part in values, f"{chart} has no value {key}"
        values = values[part]
    try:
        import helm_python
    except ModuleNotFoundError:  # without make .venv/.deploy
        return ""
    nested: Any = text
    for part in reversed(key.split(".")):
        nested = {part: nested}
    with helm_python.Chart.load(str(ROOT / chart)) as loaded:
        assert text in "".join(loaded.render(nested, name=name, namespace="default").values())
    return ""


def pip(page: Page, words: list[str], shown: str) -> str:
    """The environment of the tests stays as it is: pip makes the package ready, and installs nothing."""
    shutil.copytree(ROOT / "client", page.folder / "client", ignore=shutil.ignore_patterns("*.egg-info", "__pycache__"))
    dry = ["--dry-run", "--no-deps", "--no-index", "--no-build-isolation", "--disable-pip-version-check", "--quiet"]
    command = [sys.executable, "-m", "pip", *words[1:], *dry]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def pytest(page: Page, words: list[str], shown: str) -> str:
    """It is what runs this."""
    return ""


def compose(page: Page, block: Block) -> None:
    """What is laid over docker-compose.yml: the rehearsal's reader and the settings take the two together."""
    whole = merged(yaml.safe_load((ROOT / "docker-compose.yml").read_text()), yaml.safe_load(block.text))
    (page.folder / "docker-compose.yml").write_text(yaml.safe_dump(whole))
    for service in services(page.folder / "docker-compose.yml", secrets_of(page)).values():
        from_environment({name: value for name, value in service.environment.items() if value is not None})


def merged(one: Any, other: Any) -> Any:
    """As an engine merges two compose files."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one | {name: merged(one[name], value) if name in one else value for name, value in other.items()}
    return [*one, *other] if isinstance(one, list) and isinstance(other, list) else other


def secrets_of(page: Page) -> dict[str, str]:
    """The variables of docker-compose.yml: what the page has written, or any."""
    file = page.folder / ".env"
    text = file.read_text() if file.exists() else "POSTGRES_PASSWORD=p\nREDIS_PASSWORD=r\n"
    return dict(line.split("=", 1) for line in text.splitlines())
