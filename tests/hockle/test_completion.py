"""What a shell completes."""

from __future__ import annotations

import subprocess

import pytest

from hockle.cli import main


def test_bash_completes_commands_and_their_options(capsys, tmp_path):
    assert main(["completion", "bash"]) == 0
    script = tmp_path / "completion.bash"
    script.write_text(capsys.readouterr().out)

    def completed(*words: str) -> list[str]:
        told = f"source {script}; COMP_WORDS=({' '.join(words)} ''); COMP_CWORD={len(words)}; COMP_WORDS[{len(words)}]="
        name = "_shtab_hockle"
        asked = f"{told}; COMP_LINE='{' '.join(words)} '; {name}; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        return subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True).stdout.split()

    assert {"sweep", "again", "jobs", "serve"} <= set(completed("hockle"))


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_other_shells_have_a_script_too(capsys, shell):
    assert main(["completion", shell]) == 0
    assert "sweep" in capsys.readouterr().out
