"""Results: the dataset of a run, its contents, how it is written and read."""

from service.results.bucket import StoreUnreachable
from service.results.published import Datasets
from service.results.query import NoFrames, Ranges, SubsetTooLarge, UnknownVariable, open_dataset, subset
from service.results.schema import VARIABLES, Variable
from service.results.writer import DatasetWriter, Published

__all__ = [
    "VARIABLES",
    "DatasetWriter",
    "Datasets",
    "NoFrames",
    "Published",
    "Ranges",
    "StoreUnreachable",
    "SubsetTooLarge",
    "UnknownVariable",
    "Variable",
    "open_dataset",
    "subset",
]
