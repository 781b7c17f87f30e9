"""What was done in one seed, and what is known of its jobs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from chaos.reader import Read


@dataclass
class Record:
    """What was done in one seed, and what is known of its jobs."""

    seed: int
    accepted: dict[str, str] = field(default_factory=dict)
    """Case names by job id, of the jobs that are known to be on disk."""
    starved: set[str] = field(default_factory=set)
    """The jobs of too little memory."""
    poisoned: set[str] = field(default_factory=set)
    """The jobs whose every process is killed."""
    ensembles: set[str] = field(default_factory=set)
    """Ids of the ensembles that are known to be on disk; their jobs are among those above."""
    reads: list[Read] = field(default_factory=list)
    """What was read of jobs while they ran."""
    faults: Counter[str] = field(default_factory=Counter)
    all_ended: bool = False

    @property
    def done(self) -> int:
        """How many faults, those that poisoned jobs met not counted: they come by themselves."""
        return self.faults.total() - self.faults["poison"]
