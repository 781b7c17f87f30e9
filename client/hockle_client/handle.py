"""What a job's handle tells without asking the server, and its id as a part of an address."""

from __future__ import annotations

from hockle_client.documents import JobState
from hockle_client.problems import HockleError


class JobFacts:
    """A job as it was when the server was asked last; `state` is all that it said."""

    state: JobState

    @property
    def id(self) -> str:
        """By which the server knows the job."""
        return self.state.id

    @property
    def status(self) -> str:
        """One of accepted, running, successful, failed, dismissed."""
        return self.state.status

    @property
    def ended(self) -> bool:
        """Whether nothing will change any more."""
        return self.state.ended

    @property
    def progress(self) -> float:
        """The part of the run that is done, 0 to 1."""
        return self.state.progress

    @property
    def outcome(self) -> str:
        """How the run ended, in a word; empty before its end."""
        return self.state.outcome

    @property
    def message(self) -> str:
        """What the server says of the end, and what to do."""
        return self.state.message

    @property
    def label(self) -> str:
        """The word of one's own with which it was submitted."""
        return self.state.label

    def __repr__(self) -> str:
        return f"<job {self.id}: {self.status}, {self.progress:.0%}>"


def safe(name: str) -> str:
    """A name as a part of an address. Raises HockleError for what is none."""
    if not name.replace("-", "").replace("_", "").isalnum():
        raise HockleError(f"an id has letters and digits only, got {name!r}")
    return name
