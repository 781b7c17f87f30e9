"""One delivery: a signed POST, as the Standard Webhooks say."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
from dataclasses import dataclass

import httpcore

from service.webhooks.deliveries import Delivery
from service.webhooks.public import NotPublic, PublicOnly

TIMEOUT = {"connect": 5.0, "read": 5.0, "write": 5.0, "pool": 5.0}


@dataclass(frozen=True)
class Answer:
    """What came of a try, and whether another one makes sense."""

    text: str
    again: bool


def sign(delivery: Delivery, timestamp: int, body: bytes) -> str:
    """HMAC-SHA256 over id, time and body, keyed by the SHA-256 of the API key's secret: its owner can make the same."""
    message = f"{delivery.job_id}.{timestamp}.".encode() + body
    digest = hmac.new(bytes.fromhex(delivery.secret_sha256), message, hashlib.sha256).digest()
    return f"v1,{base64.b64encode(digest).decode()}"


def send(delivery: Delivery, timestamp: int, network: httpcore.NetworkBackend | None = None) -> Answer:
    """Tell of the job's end; redirects are not followed, and what is answered is not read."""
    body = json.dumps({"type": "job.ended", "timestamp": timestamp, "data": {
        "id": delivery.job_id, "status": delivery.status, "outcome": delivery.outcome,
        "job": f"/v1/jobs/{delivery.job_id}"}}).encode()  # fmt: skip
    headers: dict[bytes | str, bytes | str] = {
        "Content-Type": "application/json", "User-Agent": "hockle", "Connection": "close",
        "webhook-id": delivery.job_id, "webhook-timestamp": str(timestamp),
        "webhook-signature": sign(delivery, timestamp, body),
    }
    try:
        with (httpcore.ConnectionPool(network_backend=network or PublicOnly()) as pool,
              pool.stream("POST", delivery.url, headers=headers, content=body,
                          extensions={"timeout": TIMEOUT}) as response):  # fmt: skip
            return Answer(f"answered {response.status}", not 200 <= response.status < 300)
    except NotPublic as error:
        return Answer(str(error), again=False)
    except (httpcore.UnsupportedProtocol, httpcore.LocalProtocolError, ValueError) as error:
        return Answer(f"not an address: {error}", again=False)
    except (httpcore.NetworkError, httpcore.TimeoutException, httpcore.ProtocolError, OSError) as error:
        return Answer(f"not reached: {type(error).__name__}", again=True)
