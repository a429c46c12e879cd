"""The address of a master: tcp://host:port, bulk data on the next port."""

from __future__ import annotations

import ipaddress
import re
from dataclasses import dataclass

from .errors import InvalidInput, Refused


@dataclass(frozen=True)
class Endpoint:
    control: str
    bulk: str
    is_loopback: bool
    is_ipv6: bool


def parse(text: str) -> Endpoint:
    """Raises InvalidInput."""
    found = re.fullmatch(r"tcp://(.+):(\d{1,5})", text)
    if found is None or not 1 <= int(found[2]) <= 65534:
        raise InvalidInput(f"'{text}' is not an address: expected tcp://host:port with a port between 1 and 65534 "
                           "(bulk data use the next one)")
    host, port = found[1], int(found[2])
    if host == "localhost":
        host = "127.0.0.1"
    try:
        is_loopback = ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        is_loopback = False
    return Endpoint(f"tcp://{host}:{port}", f"tcp://{host}:{port + 1}", is_loopback, host.startswith("["))


def require_keys(endpoint: Endpoint, has_keys: bool) -> None:
    """Raises Refused for unencrypted network addresses."""
    if not endpoint.is_loopback and not has_keys:
        raise Refused(f"'{endpoint.control}' is on the network, and without keys nothing is encrypted: give keys= "
                      "(made by 'tessera keys'), or use an address of this machine")
