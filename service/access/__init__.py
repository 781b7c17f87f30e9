"""Who may do what: API keys with owners and scopes, limits, and the trail of what was done."""

from service.access.caller import LOCAL, Caller, Refused, authenticate
from service.access.key import ApiKey, NewKey, Scope
from service.access.store import KeyStore, UnknownKey

__all__ = ["LOCAL", "ApiKey", "Caller", "KeyStore", "NewKey", "Refused", "Scope", "UnknownKey", "authenticate"]
