"""What a reader of a run's frames must know besides them: plain numbers, with a sentence each."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass
class Remarks:
    """What a run noticed so far. A value that is not zero becomes an attribute of the dataset, by its name here."""

    axial_stiffness: float = 0.0
    """EA (N) that the rod was given because it is held so that it has to stretch: see `physics.axial`."""

    def attributes(self) -> dict[str, float | int]:
        """The values that are not zero, by name."""
        return {name: value for name, value in asdict(self).items() if value}

    def sentences(self) -> list[str]:
        """What a user is to read, a sentence for each remark."""
        told = []
        if self.axial_stiffness:
            told.append(f"The rod is held so that it has to stretch: it has the axial stiffness EA = "
                        f"{self.axial_stiffness:.3g} N.")  # fmt: skip
        return told
