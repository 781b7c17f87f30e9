"""The registry of jobs. A job is a row; a message to a worker is only a doorbell."""

from service.jobs.database import Database
from service.jobs.job import Dataset, Job, Limits, NewJob, Reached, new_id
from service.jobs.lifecycle import ENDED, Status
from service.jobs.registry import Page, Registry, UnknownJob

__all__ = ["ENDED", "Database", "Dataset", "Job", "Limits", "NewJob", "Page", "Reached", "Registry", "Status",
           "UnknownJob", "new_id"]
