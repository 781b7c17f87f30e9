"""What is kept, and whether it is still good: datasets and their rows together."""

from service.store.keeper import Keeper
from service.store.verification import look, lost

__all__ = ["Keeper", "look", "lost"]
