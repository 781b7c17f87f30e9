"""What a reader of a run's frames must know besides them: plain numbers, with a sentence each."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass
class Remarks:
    """What a run noticed so far. A value that is not zero becomes an attribute of the dataset, by its name here."""

    def attributes(self) -> dict[str, float | int]:
        """The values that are not zero, by name."""
        return {name: value for name, value in asdict(self).items() if value}

    def sentences(self) -> list[str]:
        """What a user is to read, a sentence for each remark."""
        return []
