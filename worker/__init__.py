"""The Celery app, and what runs one job."""
