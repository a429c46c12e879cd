"""Ports for masters of tests."""

import random
import socket

# Below the range from which Linux takes the ports of outgoing connections, so that none of those takes a port in between.
LOWEST, HIGHEST = 20000, 32000


def free_port():
    """The first of two consecutive unused ports, as a master needs."""
    while True:
        port = random.randrange(LOWEST, HIGHEST, 2)
        with socket.socket() as first, socket.socket() as second:
            try:
                first.bind(("127.0.0.1", port))
                second.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port
