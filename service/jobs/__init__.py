"""The registry of jobs. A job is a row; a message to a worker is only a doorbell."""

from service.jobs.database import Database
from service.jobs.job import Dataset, Drift, Job, Limits, NewJob, Reached, new_id
from service.jobs.lifecycle import ENDED, Status
from service.jobs.registry import DeletedJob, Event, Page, Pinned, Registry, Selection, UnknownJob

__all__ = ["ENDED", "Database", "Dataset", "DeletedJob", "Drift", "Event", "Job", "Limits", "NewJob", "Page", "Pinned",
           "Reached", "Registry", "Selection", "Status", "UnknownJob", "new_id"]
