"""Cases: what a simulation needs to know, read and checked, and built into the solver's scene."""

from service.cases.build import build_scene
from service.cases.case import CaseSpec
from service.cases.cost import Cost, check_cost, estimate
from service.cases.errors import MOST_ERRORS, CaseError, FieldError
from service.cases.library import apply_settings, case_schema, load_case, parse_case, shipped_case, shipped_cases
from service.cases.warnings import warnings_of

__all__ = [
    "MOST_ERRORS",
    "CaseError",
    "CaseSpec",
    "Cost",
    "FieldError",
    "apply_settings",
    "build_scene",
    "case_schema",
    "check_cost",
    "estimate",
    "load_case",
    "parse_case",
    "shipped_case",
    "shipped_cases",
    "warnings_of",
]
