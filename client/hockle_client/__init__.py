"""hockle from Python: submit cases, follow jobs, read what they give."""

from hockle_client.asynchronous import AsyncClient, AsyncJob
from hockle_client.case import Case
from hockle_client.documents import Cost, Event, JobState, Link, Verdict
from hockle_client.problems import DamagedDataset, Fault, HockleError, Problem, Unreachable
from hockle_client.reading import case_of
from hockle_client.synchronous import Client, Job

__all__ = ["AsyncClient", "AsyncJob", "Case", "Client", "Cost", "DamagedDataset", "Event", "Fault", "HockleError",
           "Job", "JobState", "Link", "Problem", "Unreachable", "Verdict", "case_of"]
