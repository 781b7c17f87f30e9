"""hockle from Python: submit cases, follow jobs, read what they give."""

from hockle_client.async_ensembles import AsyncEnsemble
from hockle_client.async_jobs import AsyncJob
from hockle_client.asynchronous import AsyncClient
from hockle_client.case import Case
from hockle_client.design import Range
from hockle_client.documents import Cost, EnsembleState, Event, JobState, Link, MemberState, SobolIndex, Verdict
from hockle_client.ensembles import Ensemble
from hockle_client.jobs import Job
from hockle_client.problems import DamagedDataset, Fault, HockleError, Problem, Unreachable
from hockle_client.reading import case_of
from hockle_client.synchronous import Client

__all__ = ["AsyncClient", "AsyncEnsemble", "AsyncJob", "Case", "Client", "Cost", "DamagedDataset", "Ensemble",
           "EnsembleState", "Event", "Fault", "HockleError", "Job", "JobState", "Link", "MemberState", "Problem",
           "Range", "SobolIndex", "Unreachable", "Verdict", "case_of"]
