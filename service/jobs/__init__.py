"""The registry of jobs. A job is a row; a message to a worker is only a doorbell."""

from service.jobs.database import Database
from service.jobs.job import Dataset, Drift, Job, Limits, NewJob, Reached, new_id
from service.jobs.lifecycle import ENDED, Status
from service.jobs.registry import Event, Page, Registry, Selection, UnknownJob

__all__ = ["ENDED", "Database", "Dataset", "Drift", "Event", "Job", "Limits", "NewJob", "Page", "Reached", "Registry",
           "Selection", "Status", "UnknownJob", "new_id"]
