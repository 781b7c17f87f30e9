"""What a reader of a run's frames must know besides them: plain numbers, with a sentence each."""

from __future__ import annotations

from dataclasses import asdict, dataclass

MUCH = 0.1
"""Strain from which on a linear law and a section that does not change are worth a word."""


@dataclass
class Remarks:
    """What a run noticed so far. A value that is not zero becomes an attribute of the dataset, by its name here.

    `crossings`: how often the rod passed through itself where it may, `first_crossing` (s) the frame after the first;
    `end_hops`: how often a loop hopped over an end; both by Tw + Wr - Lk from frame to frame, so that two of opposite
    sign between frames cancel, and none is seen without topology; `unclear_jumps`: how often it was one of them, where
    frames are too far apart to tell which. `deepest_overlap` (m) of strands, and the time
    `deepest_overlap_at` (s) of its frame. `deepest_in_solid` (m) below the surface of a floor or an obstacle, if that
    is more than the rod's diameter, and the time `deepest_in_solid_at` (s) of its frame. `axial_stiffness`: EA (N) that
    the rod was given because it is held so that it has to stretch, see `physics.axial`; `end_stretch` (m): how far both
    ends together were away from where they are held, at the most, at a frame. `largest_strain`: of a rod with a law of
    stretch, at a frame, if that is more than a tenth. `energy_lost`: energy that went nowhere, over the largest that
    motion, strain and contact ever had, if that is more than a tenth. `retardation_time` (s): of the rod's material,
    with what was added to it so that the run comes to its end, see `artificial_viscosity`. `turning_loads`: frames of a
    static analysis in which forces turned with the rod; `unstable_frames`: of the others those whose equilibrium is
    unstable, and `first_unstable` (s) the time of the first. `disturbance_growth`: the logarithm of the factor by which
    a small disturbance across a straight or a plane rod would have grown, if that is much, see `measures.buckling`.
    `buckling_seed` (N/m): the load across it that the run added so that it buckles, see `physics.seed`.
    """

    crossings: int = 0
    first_crossing: float = 0.0
    end_hops: int = 0
    unclear_jumps: int = 0
    deepest_overlap: float = 0.0
    deepest_overlap_at: float = 0.0
    deepest_in_solid: float = 0.0
    deepest_in_solid_at: float = 0.0
    axial_stiffness: float = 0.0
    end_stretch: float = 0.0
    largest_strain: float = 0.0
    energy_lost: float = 0.0
    retardation_time: float = 0.0
    turning_loads: int = 0
    unstable_frames: int = 0
    first_unstable: float = 0.0
    disturbance_growth: float = 0.0
    buckling_seed: float = 0.0

    def stretched(self, strain: float, length: float) -> None:
        """At a frame, of a rod so long (m)."""
        if self.axial_stiffness:
            self.end_stretch = max(self.end_stretch, strain * length)
        elif strain > MUCH:
            self.largest_strain = max(self.largest_strain, strain)

    def sunk(self, depth: float, t: float) -> None:
        """At a frame, so deep (m) within a solid."""
        if depth > self.deepest_in_solid:
            self.deepest_in_solid, self.deepest_in_solid_at = depth, t

    def rested(self, t: float, negative_modes: int, turning: bool) -> None:
        """At a frame of a static analysis."""
        self.turning_loads += turning
        if negative_modes and not turning:
            self.first_unstable = self.first_unstable if self.unstable_frames else t
            self.unstable_frames += 1

    def attributes(self) -> dict[str, float | int]:
        """The values that are not zero, by name."""
        return {name: value for name, value in asdict(self).items() if value}

    def sentences(self) -> list[str]:
        """What a user is to read, a sentence for each remark."""
        sentences = []
        if self.crossings:
            sentences.append(
                f"The rod passed through itself {_times(self.crossings)}, first before "
                f"t = {self.first_crossing:.6g} s: give contact to hold it apart."
            )
        if self.end_hops:
            sentences.append(
                f"A loop hopped over an end of the rod {_times(self.end_hops)}: no crossing, but Tw + Wr differs from "
                "Lk by 2 turns more for each."
            )
        if self.unclear_jumps:
            sentences.append(
                f"Tw + Wr jumped by 2 turns against Lk {_times(self.unclear_jumps)}: the rod passed through itself, or "
                "a loop hopped over an end, between frames too far apart to tell which."
            )
        if self.deepest_overlap:
            sentences.append(
                f"Strands overlapped, at the most by {self.deepest_overlap:.3g} m "
                f"at t = {self.deepest_overlap_at:.6g} s."
            )
        if self.deepest_in_solid:
            sentences.append(
                f"The rod was pressed into a floor or an obstacle by up to {self.deepest_in_solid:.3g} m, more than "
                f"its diameter, at t = {self.deepest_in_solid_at:.6g} s: give it more stiffness; a straight rod that "
                "is pushed into it end first bends aside by a small load across it, which says to which side."
            )
        if self.energy_lost:
            sentences.append(
                f"Energy went nowhere, {self.energy_lost:.0%} of the largest that the rod's motion and strain had: the "
                "steps are too long for the waves that had it."
            )
        if self.retardation_time:
            sentences.append(
                "The rod by itself bends too sharply for any mesh that was tried, or has too many waves: its material "
                f"was made to resist bending, with a retardation time of {self.retardation_time:.3g} s, which damps "
                "short waves."
            )
        if self.axial_stiffness:
            sentences.append(
                "The rod is held so that it has to stretch: it has the axial stiffness EA = "
                f"{self.axial_stiffness:.3g} N. All stretch lies at its ends, which are together up to "
                f"{self.end_stretch:.2g} m away from where they are held."
            )
        if self.largest_strain:
            sentences.append(
                f"The rod was stretched or squeezed by a factor of up to {1.0 + self.largest_strain:.3g}: its law of "
                "stretch is linear, and its mass, its section, loads and drag are those per length of the rod without "
                "stretch."
            )
        if self.buckling_seed:
            sentences.append(
                "The rod is straight, its ends press it beyond its critical load, and nothing says to which side it "
                f"buckles: a load of {self.buckling_seed:.3g} N/m was added across it, which alone bends it by 1e-4 of "
                "its length at the most. A load across it of your own replaces this one."
            )
        if self.disturbance_growth:
            sentences.append(
                "The rod stays straight, or in its plane, beyond its critical load, because nothing in the case "
                "disturbs it: even the smallest disturbance would have grown large. Add a small load across it, which "
                "says to which side it buckles."
            )
        if self.unstable_frames:
            sentences.append(
                f"In {self.unstable_frames} frames, first at t = {self.first_unstable:.6g} s, the equilibrium is "
                "unstable (negative_modes): no rod stays there. Add a small load, which says to which side it leaves, "
                "or make a dynamic run."
            )
        if self.turning_loads:
            sentences.append(
                "Loads turn with the rod, or have no potential: negative_modes is counted with them held as they "
                "are, and says neither that the rod stays there nor that it leaves. A dynamic run shows it."
            )
        return sentences


def _times(number: int) -> str:
    return "once" if number == 1 else f"{number} times"
